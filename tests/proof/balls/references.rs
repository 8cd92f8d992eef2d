//! The oracle against values known from elsewhere: the paper's models to 40 digits, Pinocchio's matrices, and a body
//! whose borders are known by hand.

use crate::balls::dynamics::problem;
use crate::balls::number::{Ball, Number};
use crate::balls::oracle::{Index, answer};
use heelstrike::impact::Mode::{self, SlideMinus, SlidePlus, Stick};
use heelstrike::robot::Robot;
use heelstrike::state::{Defaults, State};
use serde_json::{Value, json};
use std::cmp::Ordering;

/// The f64 nearest to a ball, to a few units in the last place.
fn nearest(ball: &Ball) -> f64 {
    if ball.sign() == Some(Ordering::Less) { -ball.size() } else { ball.size() }
}

fn read(path: &str) -> String {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn document(path: &str) -> Value {
    serde_json::from_str(&read(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn state(value: &Value, robot: &Robot) -> State {
    State::from_json(&value.to_string(), robot, &Defaults::default()).unwrap_or_else(|error| panic!("{error}\n{value}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|entry| entry.as_f64().expect("a number")).collect()
}

/// Compares to `tolerance` of the largest entry of `expected`.
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, place: &str) {
    let size = expected.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
    assert_eq!(found.len(), expected.len(), "{place}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance * size, "{place}: {found:?}\nnot {expected:?}");
    }
}

/// The paper's robots pivot about the trailing foot at 1 rad/s counter-clockwise, joints at rest (`tests/paper.rs`).
#[test]
fn the_papers_outcomes_are_found() {
    let reference = document("tests/data/paper.json");
    let models = [
        ("minimalistic", "minimalistic", false),
        ("pdw_j0.04", "pdw", false),
        ("ramone_table1_script_precision", "ramone", true),
        ("ramone_as_computed_in_paper", "ramone_paper", true),
    ];
    let mut compared = 0;
    for (name, urdf, kneed) in models {
        let robot = Robot::from_urdf(&read(&format!("urdf/{urdf}.urdf"))).expect("a robot of ours");
        for (alpha, at) in reference[name]["at"].as_object().expect("states by leg angle") {
            let angle: f64 = alpha.parse().expect("an angle");
            let (links, pitch, joints, foot) = if kneed {
                // From the hip to the foot's centre: a thigh of 0.2 m and, bent back at right angles, a shank of 0.2385
                // m.
                let bend = (0.2385_f64 / 0.2).atan();
                let pose = &at["pose"];
                let hips = pose["hip"].as_array().map(|_| numbers(&pose["hip"]));
                let hips = hips.unwrap_or_else(|| vec![bend + angle, bend - angle]);
                let knee = pose["knee"].as_f64().unwrap_or(-std::f64::consts::FRAC_PI_2);
                let pitch = -pose["pitch"].as_f64().unwrap_or(0.0);
                let joints = json!({"left_hip": hips[0], "left_knee": knee, "right_hip": hips[1], "right_knee": knee});
                (["left_foot", "right_foot"], pitch, joints, json!({"offset": [0, 0, 0], "radius": 0.02815}))
            } else {
                (["left_leg", "right_leg"], -angle, json!({"hip": -2.0 * angle}), json!({"offset": [0, 0, -1]}))
            };
            let contacts = links.map(|link| {
                let mut contact = foot.clone();
                contact["link"] = json!(link);
                contact
            });
            for (friction, outcomes) in at["outcomes"].as_object().expect("outcomes by friction") {
                let place = format!("{name}, alpha {alpha}, friction {friction}");
                let state = state(
                    &json!({
                        "position": {"base": {"pitch": pitch}, "joints": joints},
                        "velocity": {"base": {"pitch": -1.0}},
                        "stance": links[0],
                        "friction": friction.parse().map_or(json!(friction), |mu: f64| json!(mu)),
                        "contacts": contacts,
                    }),
                    &robot,
                );
                let problem = problem::<Ball>(&robot, &state, 256).expect("a regular mass matrix");
                // As many digits as the posture's own rounding leaves.
                let delassus: Vec<f64> = problem.delassus.iter().flatten().map(nearest).collect();
                let rows = at["delassus"].as_array().expect("rows");
                assert_near(&delassus, &rows.iter().flat_map(numbers).collect::<Vec<_>>(), 1e-12, &place);
                let velocity: Vec<f64> = problem.free.iter().map(nearest).collect();
                assert_near(&velocity, &numbers(&at["contact_velocity_before"]), 1e-12, &place);
                let mut expected: Vec<Vec<Mode>> = outcomes
                    .as_array()
                    .expect("outcomes")
                    .iter()
                    .map(|outcome| serde_json::from_value(outcome["modes"].clone()).expect("modes"))
                    .collect();
                expected.sort();
                let answer = answer(&robot, &state).expect("a regular mass matrix");
                let found: Vec<Vec<Mode>> = answer.outcomes.iter().map(|outcome| outcome.modes.clone()).collect();
                assert_eq!((found, answer.open), (expected, 0), "{place}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 28, "{compared} compared");
}

/// Robots of other people's projects, several contacts, in postures of all kinds.
#[test]
fn matrices_are_those_of_pinocchio() {
    for folder in ["rabbit", "upkie", "solo8"] {
        let reference = document(&format!("tests/data/robots/{folder}/reference.json"));
        let urdf = reference["urdf"].as_str().expect("a file name");
        let robot = Robot::from_urdf(&read(&format!("tests/data/robots/{folder}/{urdf}"))).expect("a robot");
        let variant = &reference["variants"]["default"];
        let contacts = variant["contacts"].as_array().expect("contacts").iter();
        let contacts: Vec<Value> = contacts
            .map(|contact| json!({"link": contact["link"], "offset": contact["offset"], "radius": contact["radius"]}))
            .collect();
        let mut state = state(&json!({"friction": 1.0, "contacts": contacts}), &robot);
        for (number, config) in variant["configs"].as_array().expect("configurations").iter().enumerate() {
            state.position = numbers(&config["q"]);
            state.velocity = numbers(&config["v"]);
            let problem = problem::<Ball>(&robot, &state, 256).expect("a regular mass matrix");
            let delassus: Vec<f64> = problem.delassus.iter().flatten().map(nearest).collect();
            let rows = config["G"].as_array().expect("rows");
            let expected: Vec<f64> = rows.iter().flat_map(numbers).collect();
            // The reference is f64 itself.
            assert_near(&delassus, &expected, 1e-10, &format!("{folder}, configuration {number}"));
        }
    }
}

/// The block of the paper's section 4 has G = [[2, 1], [1, 2]] / kg, so that c- = -G L makes it stick with the impulse
/// L.
#[test]
fn exact_borders_are_told() {
    let robot = Robot::from_urdf(&read("urdf/block.urdf")).expect("a robot of ours");
    let outcomes = |friction: Value, [x, z]: [f64; 2]| {
        let value = json!({
            "velocity": {"base": {"x": x, "z": z}},
            "friction": friction,
            "contacts": [{"link": "block", "offset": [0, 0, 0]}],
        });
        let answer = answer(&robot, &state(&value, &robot)).expect("a regular mass matrix");
        assert_eq!(answer.open, 0, "{value}");
        answer.outcomes.into_iter().map(|outcome| (outcome.modes[0], outcome.index)).collect::<Vec<_>>()
    };
    // L = (1, 1) and (-1, 1) lie on the edges of the cone for friction 1, L = (1, 0) on that of infinite friction.
    assert_eq!(outcomes(json!(1.0), [-3.0, -3.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!(1.0), [1.0, -1.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!("infinite"), [-2.0, -1.0]), [(Stick, Index::Border)]);
    // One unit in the last place beside it is no border.
    let less = 1.0_f64.next_down();
    assert_eq!(outcomes(json!(1.0), [-3.0, -3.0 * less]), [(SlideMinus, Index::Sign(1))]);
    assert_eq!(outcomes(json!(1.0_f64.next_up()), [-3.0, -3.0]), [(Stick, Index::Sign(1))]);
    // At rest everything is zero; at friction 0 L_t = 0 is no inequality.
    assert_eq!(outcomes(json!(1.0), [0.0, 0.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!(0.0), [-0.5, -1.0]), [(Stick, Index::Sign(1))]);
    assert_eq!(outcomes(json!(0.0), [0.5, -0.5]), [(SlidePlus, Index::Sign(1))]);
}
