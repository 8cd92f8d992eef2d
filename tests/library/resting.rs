//! Contacts that rest but for rounding, and others that depend on them: a state whose numbers are exact has the outcomes
//! of the same state with its rates off by less than f64 resolves.

use crate::support::impact::{impact, modes, robot, try_impact};
use crate::support::random::Random;
use crate::support::urdf::{self, Axis, HINGE};
use heelstrike::impact::Mode::{Separate, SlideMinus, Stick};
use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options};
use serde_json::{Value, json};

fn is_proven(impact: &Impact) -> bool {
    impact.analysis.as_ref().is_some_and(|analysis| analysis.proven)
}

/// A slide on the world, one on it and an arm: three contacts on three degrees of freedom, of which the arm's point rests
/// to 1.6e-16 m/s. The base cannot move with it.
#[test]
fn a_bolted_robot_strikes_beside_a_point_that_rests() {
    let robot = robot(&urdf::robot(&[
        urdf::link("world", 0.0, [0.0; 2], 0.0, "").replace("<inertial>", "<!--").replace("</inertial>", "-->"),
        urdf::link("first", 2.0, [0.0; 2], 1.0, ""),
        urdf::link("second", 3.0, [0.0; 2], 1.0, ""),
        urdf::link("arm", 1.0, [0.1, 0.2], 0.1, ""),
        urdf::joint("along", Axis::Prismatic([0.6, -0.8]), ["world", "first"], [0.0; 2], ""),
        urdf::joint("up", Axis::Prismatic([0.3, 1.0]), ["first", "second"], [0.0; 2], ""),
        urdf::joint("shoulder", HINGE, ["second", "arm"], [0.0; 2], ""),
    ]));
    let contact = |link: &str, offset: [f64; 3]| json!({"link": link, "offset": offset});
    let rates = [0.81, 1.705_643_157_221_622_9, 2.576_030_364_490_954_6];
    let found = impact(
        &robot,
        json!({
            "position": {"joints": {"shoulder": 0.4}}, "friction": 1.5,
            "velocity": {"joints": {"along": rates[0], "up": rates[1], "shoulder": rates[2]}},
            "contacts": [contact("first", [0.0; 3]), contact("second", [0.0; 3]), contact("arm", [0.5, 0.0, -0.2])],
        }),
    );
    assert_eq!(found.resting, [false, false, true]);
    assert!(is_proven(&found));
    // By an enumeration with linear programs.
    assert_eq!(modes(&found), [[Stick, Separate, SlideMinus]]);
}

/// A torso on two hinged legs at `rates` [x, z, pitch, left, right]; a point of the torso is between the feet.
fn squatting(rates: [f64; 5], friction: &Value) -> Value {
    let [x, z, pitch, left, right] = rates;
    let contact = |link: &str, offset: [f64; 3]| json!({"link": link, "offset": offset});
    json!({
        "position": {"base": {"z": 1}}, "friction": friction,
        "velocity": {"base": {"x": x, "z": z, "pitch": pitch}, "joints": {"left": left, "right": right}},
        "contacts": [contact("torso", [0.125, 0.0, -1.0]), contact("left_leg", [-0.25, 0.0, -1.0]),
            contact("right_leg", [0.25, 0.0, -1.0])],
    })
}

/// Both feet rest while the torso comes down, which five degrees of freedom allow in one way.
#[test]
fn a_torso_lands_between_two_feet_that_rest_to_rounding() {
    let robot = robot(&urdf::robot(&[
        urdf::link("torso", 8.0, [0.0, 0.25], 0.5, ""),
        urdf::link("left_leg", 1.0, [0.0, -0.5], 0.0625, ""),
        urdf::link("right_leg", 1.0, [0.0, -0.5], 0.0625, ""),
        urdf::joint("left", HINGE, ["torso", "left_leg"], [-0.25, 0.0], ""),
        urdf::joint("right", HINGE, ["torso", "right_leg"], [0.25, 0.0], ""),
    ]));
    let exact = [-0.5, 0.0, 0.5, -1.0, -1.0];
    for friction in [json!(0), json!(0.3), json!(0.8), json!(5), json!("infinite")] {
        let standing = impact(&robot, squatting(exact, &friction));
        assert_eq!(standing.velocity_before, [[-1.0, -0.0625], [0.0; 2], [0.0; 2]]);
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let rates = exact.map(|rate| rate + random.between(-1.0, 1.0) * f64::EPSILON);
            let resting = impact(&robot, squatting(rates, &friction));
            assert_eq!(resting.resting, [false, true, true], "seed {seed}");
            assert!(is_proven(&resting), "seed {seed} with friction {friction}");
            assert_eq!(modes(&resting), modes(&standing), "seed {seed} with friction {friction}");
        }
    }
}

/// Two points rest by the speed that is given although their body turns: then the body rests, and all of its points.
#[test]
fn two_points_at_rest_hold_their_body() {
    let robot = robot(&urdf::body(0.0625, ""));
    let contacts = [[0.0, -0.09375], [-0.125, -0.125], [0.25, -0.125]]
        .map(|[x, z]: [f64; 2]| json!({"link": "body", "offset": [x, 0.0, z]}));
    let state = json!({"position": {"base": {"z": 0.125}}, "velocity": {"base": {"x": 0.125, "pitch": 1}},
        "friction": 0.5, "contacts": contacts});
    let options = Options { resting_speed: Some(0.2), ..Options::default() };
    let found = try_impact(&robot, options, state).expect("an answer");
    let speeds: Vec<&String> = found.notes.iter().filter(|note| note.contains("hold its body")).collect();
    assert_eq!((&found.velocity_before, speeds.len()), (&vec![[0.0; 2]; 3], 1), "{:?}", found.notes);
    assert!(is_proven(&found) && found.analysis.is_some_and(|analysis| analysis.verdict == Verdict::NoImpact));
}
