//! Uncertain states whose boxes are worked out by hand.

use crate::support::impact::{impact, ramone, robot, try_impact};
use crate::support::urdf::{self, HINGE, collision, joint, link};
use heelstrike::Robot;
use heelstrike::impact::{Friction, Mode, Verdict};
use heelstrike::pipeline::robust::Robustness;
use heelstrike::pipeline::{Impact, Options};
use serde_json::{Value, json};

/// A ball of 2 kg, 1 kg m^2 and radius 0.5 m: 1/G_tt = 4/3 kg, 1/G_nn = 2 kg.
fn ball() -> Robot {
    robot(&urdf::body(1.0, &collision([0.0; 2], "sphere radius=\"0.5\"")))
}

/// The ball falls at 1 m/s and moves forward at 0.6 m/s; it sticks if friction is at least 0.4.
fn falling(friction: impl Into<Value>, uncertainty: Value) -> Value {
    json!({"position": {"base": {"z": 0.5}}, "velocity": {"base": {"x": 0.6, "z": -1.0}},
        "friction": friction.into(), "uncertainty": uncertainty})
}

/// Whether the answer holds on the state's box; `None` if that is unknown.
fn holds(impact: &Impact) -> Option<bool> {
    match impact.holds.as_ref().expect("the state is uncertain") {
        Robustness::Everywhere => Some(true),
        Robustness::Not(_) => Some(false),
        Robustness::Unknown => None,
    }
}

#[test]
fn ball_holds_within_its_friction_and_speed() {
    let velocity = |base: Value| json!({"velocity": {"base": base}});
    for (friction, uncertainty, expected) in [
        (json!(0.5), json!({"friction": 0.0}), true),
        (json!(0.5), json!({"friction": 0.05}), true),
        (json!(0.5), json!({"friction": 0.099}), true),
        (json!(0.5), json!({"friction": 0.101}), false),
        (json!(0.5), json!({"friction": 0.3}), false),
        // A slide remains one down to friction 0, where the box ends.
        (json!(0.0), json!({"friction": 0.1}), true),
        (json!(0.05), json!({"friction": 0.1}), true),
        (json!(0.25), json!({"friction": 0.1}), true),
        (json!(0.35), json!({"friction": 0.1}), false),
        // No number is uncertain where friction is infinite.
        (json!("infinite"), json!({"friction": 100.0}), true),
        // The place of the base has no effect. The ball slides from 0.75 m/s on, and leaves the ground from 0 m/s on.
        (json!(0.5), json!({"position": {"base": {"x": 1e9, "z": 1e9}}}), true),
        (json!(0.5), velocity(json!({"x": 0.14})), true),
        (json!(0.5), velocity(json!({"x": 0.16})), false),
        (json!(0.5), velocity(json!({"z": 0.1})), true),
        (json!(0.5), json!({"velocity": 1.0}), false),
    ] {
        let state = falling(friction, uncertainty);
        assert_eq!(holds(&impact(&ball(), &state)), Some(expected), "{state}");
    }
    let Some(Robustness::Not(found)) = impact(&ball(), falling(0.5, json!({"friction": 0.101}))).holds else {
        panic!("a counterexample")
    };
    assert_eq!((found.verdict, &found.outcomes[..]), (Verdict::Unique, &[vec![Mode::SlidePlus]][..]));
    let Some(Friction::Finite(mu)) = found.state.scene.friction.of(0) else { panic!("finite friction") };
    assert!((0.5 - 0.101..0.4).contains(&mu), "{mu}");
}

#[test]
fn no_impact_holds_on_the_whole_box() {
    let state = json!({"stance": "left_foot", "friction": 0.8, "position": {"joints": {"left_hip": 0.3, "left_knee": -0.4,
        "right_knee": -1.5}}, "velocity": {"base": {"pitch": 0.2}},
        "uncertainty": {"position": 1e-2, "velocity": 1e-2, "friction": 1e-2, "rotor_inertia": 1e-3}});
    let answer = impact(&ramone(), state);
    assert_eq!(answer.analysis.as_ref().map(|analysis| analysis.verdict), Some(Verdict::NoImpact));
    assert_eq!(holds(&answer), Some(true));
    // A ball in the air.
    let state = json!({"position": {"base": {"z": 1.0}}, "friction": 0.8, "uncertainty": {"velocity": 5.0}});
    assert_eq!(holds(&impact(&ball(), state)), Some(true));
}

#[test]
fn dependent_or_unproven_answer_stays_unknown() {
    // Both contacts are at one place, so that they are redundant.
    let twice = json!([{"link": "left_foot"}, {"link": "left_foot"}]);
    let state = json!({"velocity": {"base": {"z": -1.0}}, "friction": 0.8, "contacts": twice,
        "uncertainty": {"position": 1e-6}});
    assert_eq!(holds(&impact(&ramone(), state)), None);
    let unproven = Options { no_proof: true, ..Options::default() };
    let state = falling(0.5, json!({"friction": 0.01}));
    assert_eq!(holds(&try_impact(&ball(), unproven, state).expect("an answer")), None);
}

#[test]
fn many_uncertain_numbers_are_taken_together() {
    // A body with 24 arms has 76 uncertain numbers, more than an affine number has slopes.
    let links = (0..25).map(|k| link(format!("l{k}"), 1.0, [0.0, -0.05], 0.01, ""));
    let joints = (1..25).map(|k| joint(format!("j{k}"), HINGE, ["l0", &format!("l{k}")], [0.0, -0.1], ""));
    let star = robot(&urdf::robot(&links.chain(joints).collect::<Vec<_>>()));
    let state = json!({"position": {"base": {"pitch": 0.5}}, "velocity": {"base": {"z": -1.0}}, "friction": "infinite",
        "contacts": [{"link": "l0", "offset": [0, 0, -0.1]}],
        "uncertainty": {"position": 1e-4, "velocity": 1e-4, "rotor_inertia": 1e-4}});
    assert_eq!(holds(&impact(&star, state)), Some(true));
}
