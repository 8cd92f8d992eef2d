//! The oracle against values known from elsewhere: the paper's models to 40 digits, Pinocchio's matrices, and a body
//! whose borders are known by hand.

use crate::balls::dynamics::problem;
use crate::balls::number::{Ball, Number};
use crate::balls::oracle::{Index, answer};
use crate::support::command::read;
use crate::support::impact::robot;
use crate::support::paper::{MODELS, REFERENCE};
use crate::support::robots::{Contact, robot_and_reference};
use crate::support::scaled::{Differences, largest};
use heelstrike::impact::Mode::{SlideMinus, SlidePlus, Stick};
use heelstrike::robot::Robot;
use heelstrike::state::{Defaults, State};
use serde_json::{Value, json};
use std::cmp::Ordering;

/// The f64 nearest to each ball, to a few units in the last place.
fn nearest<'a>(balls: impl IntoIterator<Item = &'a Ball>) -> Vec<f64> {
    let nearest = |ball: &Ball| if ball.sign() == Some(Ordering::Less) { -ball.size() } else { ball.size() };
    balls.into_iter().map(nearest).collect()
}

fn state(value: &Value, robot: &Robot) -> State {
    State::from_json(&value.to_string(), robot, &Defaults::default()).unwrap_or_else(|error| panic!("{error}\n{value}"))
}

fn parsed<T: serde::de::DeserializeOwned>(value: &Value) -> T {
    serde_json::from_value(value.clone()).expect("a value of the reference")
}

#[test]
fn the_papers_outcomes_are_found() {
    let mut differences = Differences::default();
    let mut compared = 0;
    for model in MODELS.iter().filter(|model| model.inertia.is_none()) {
        let robot = robot(&read(&format!("urdf/{}.urdf", model.urdf)));
        let [offset, radius] = if model.kneed { [0.0, 0.02815] } else { [-1.0, 0.0] };
        let contacts = model.feet().map(|link| json!({"link": link, "offset": [0, 0, offset], "radius": radius}));
        for (alpha, at) in &REFERENCE[model.name].at {
            for (friction, outcomes) in &at.outcomes {
                let place = format!("{}, alpha {alpha}, friction {friction}", model.name);
                let mut value = model.state(alpha.parse().expect("an angle"), at.pose.as_ref(), friction);
                value["contacts"] = json!(contacts);
                let state = state(&value, &robot);
                let problem = problem::<Ball>(&robot, &state, &[], None, 256).expect("a regular mass matrix");
                // As many digits as the rounding of the reference's pose leaves.
                for (found, should) in [
                    (nearest(problem.delassus.iter().flatten()), at.delassus.concat()),
                    (nearest(&problem.free), at.contact_velocity_before.to_vec()),
                ] {
                    differences.compare(&place, &found, &should, 1e-12 * largest(&should));
                }
                let mut expected: Vec<_> = outcomes.iter().map(|outcome| outcome.modes.to_vec()).collect();
                let answer = answer(&robot, &state, &[]).expect("a regular mass matrix");
                let found: Vec<_> = answer.outcomes.into_iter().map(|outcome| outcome.modes).collect();
                expected.sort();
                assert_eq!((found, answer.open), (expected, 0), "{place}");
                compared += 1;
            }
        }
    }
    differences.finish();
    assert!(compared >= 28, "{compared} compared");
}

/// Robots of other people's projects, several contacts, in configurations of all kinds.
#[test]
fn matrices_are_those_of_pinocchio() {
    let mut differences = Differences::default();
    for folder in ["rabbit", "upkie", "solo8"] {
        let (urdf, variant): (String, Value) = robot_and_reference((folder, "default"));
        let robot = robot(&read(&urdf));
        let contacts: Vec<Contact> = parsed(&variant["contacts"]);
        let mut state = state(&json!({"friction": 1.0, "contacts": contacts}), &robot);
        for (number, config) in variant["configs"].as_array().expect("configurations").iter().enumerate() {
            (state.position, state.velocity) = (parsed(&config["q"]), parsed(&config["v"]));
            let problem = problem::<Ball>(&robot, &state, &[], None, 256).expect("a regular mass matrix");
            let should = parsed::<Vec<Vec<f64>>>(&config["G"]).concat();
            let found = nearest(problem.delassus.iter().flatten());
            // The reference is f64 itself.
            let place = format!("{folder}, configuration {number}");
            differences.compare(&place, &found, &should, 1e-10 * largest(&should));
        }
    }
    differences.finish();
}

/// The block of the paper's section 4 has G = [[2, 1], [1, 2]] / kg, so that c- = -G L makes it stick with the impulse
/// L.
#[test]
fn exact_borders_are_found() {
    let robot = robot(&read("urdf/block.urdf"));
    let outcomes = |friction: Value, [x, z]: [f64; 2]| {
        let value = json!({
            "velocity": {"base": {"x": x, "z": z}},
            "friction": friction,
            "contacts": [{"link": "block", "offset": [0, 0, 0]}],
        });
        let answer = answer(&robot, &state(&value, &robot), &[]).expect("a regular mass matrix");
        assert_eq!(answer.open, 0, "{value}");
        answer.outcomes.into_iter().map(|outcome| (outcome.modes[0], outcome.index)).collect::<Vec<_>>()
    };
    // L = (1, 1) and (-1, 1) lie on the edges of the cone for friction 1, L = (1, 0) on that of infinite friction.
    assert_eq!(outcomes(json!(1.0), [-3.0, -3.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!(1.0), [1.0, -1.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!("infinite"), [-2.0, -1.0]), [(Stick, Index::Border)]);
    // One unit in the last place next to it is no border.
    let less = 1.0_f64.next_down();
    assert_eq!(outcomes(json!(1.0), [-3.0, -3.0 * less]), [(SlideMinus, Index::Sign(1))]);
    assert_eq!(outcomes(json!(1.0_f64.next_up()), [-3.0, -3.0]), [(Stick, Index::Sign(1))]);
    // At rest everything is zero; at friction 0 L_t = 0 is no inequality.
    assert_eq!(outcomes(json!(1.0), [0.0, 0.0]), [(Stick, Index::Border)]);
    assert_eq!(outcomes(json!(0.0), [-0.5, -1.0]), [(Stick, Index::Sign(1))]);
    assert_eq!(outcomes(json!(0.0), [0.5, -0.5]), [(SlidePlus, Index::Sign(1))]);
}
