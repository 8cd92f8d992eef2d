//! Bodies that stand, slide and roll on level ground and slopes.

use super::{forces, modes, outcomes};
use crate::support::impact::robot;
use crate::support::urdf::{self, Axis, HINGE, POINT, body, collision, joint, link};
use heelstrike::impact::{Mode, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::{Defaults, Robot, State};
use serde_json::json;

const GRAVITY: f64 = 9.81;

/// A body of 2 kg on two points, 0.3 m behind and 0.1 m ahead of its center, 0.2 m below it.
fn block() -> Robot {
    robot(&body(0.05, &(collision([-0.3, -0.2], POINT) + &collision([0.1, -0.2], POINT))))
}

#[test]
fn block_stands_by_the_lever_rule() {
    let found = forces(&block(), json!({"position": {"base": {"z": 0.2}}}));
    assert_eq!(modes(&found), [[Mode::Stick; 2]]);
    let outcome = &outcomes(&found)[0];
    // Only the sum of both tangential forces is determined: here it is zero.
    assert!(!outcome.impulse_unique && outcome.proven);
    for (found, expected) in outcome.impulse.iter().zip([0.25, 0.75]) {
        assert!((found[1] - expected * 2.0 * GRAVITY).abs() < 1e-13 && found[0].abs() < 1e-14, "{outcome:?}");
    }
    assert!(outcome.velocity().all(|entry| entry.abs() < 1e-14), "{outcome:?}");
}

#[test]
fn odd_gravity_is_noted() {
    for (gravity, expected) in [
        (9.81, None),
        (981.0, Some("gravity is 981 m/s^2: 9.81 is that of the earth")),
        (-9.81, Some("gravity is negative, so it acts upward: 9.81 is that of the earth")),
    ] {
        let found = forces(&block(), json!({"position": {"base": {"z": 0.2}}, "gravity": gravity}));
        let note = found.notes.iter().find(|note| note.starts_with("gravity"));
        assert_eq!(note.map(String::as_str), expected);
    }
}

/// A wheel of radius r rolls down a slope with the acceleration g sin / (1 + I / (m r^2)); its lowest point does not
/// accelerate along the ground.
#[test]
fn wheel_rolls_down_a_slope() {
    let (radius, slope, spin) = (0.25, -0.2_f64, 3.0);
    let wheel = robot(&body(0.1, &collision([0.0; 2], "sphere radius=\"0.25\"")));
    let [sin, cos] = [slope.sin(), slope.cos()];
    let found = forces(
        &wheel,
        json!({
            "position": {"base": {"x": -radius * sin, "z": radius * cos, "pitch": 0.3}},
            "velocity": {"base": {"x": spin * radius * cos, "z": spin * radius * sin, "pitch": spin}},
            "ground": {"slope": slope},
        }),
    );
    assert_eq!(modes(&found), [[Mode::Stick]]);
    let along = -GRAVITY * sin / (1.0 + 0.1 / (2.0 * radius * radius));
    let expected = [along * cos, along * sin, along / radius];
    for (found, expected) in outcomes(&found)[0].velocity().zip(expected) {
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
}

#[test]
fn nothing_touches_in_mid_flight() {
    let found = forces(&block(), json!({"position": {"base": {"z": 3.0}}, "gravity": 1.62}));
    assert_eq!(found.analysis.as_ref().unwrap().verdict, Verdict::NoContact);
    assert_eq!(outcomes(&found)[0].velocity().collect::<Vec<_>>(), [0.0, -1.62, 0.0]);
}

/// A heel that lifts off as the foot turns takes no part; the toe about which the foot turns does.
#[test]
fn heel_leaves_while_the_foot_turns() {
    let found = forces(
        &block(),
        json!({"position": {"base": {"x": 0.0, "z": 0.2}}, "velocity": {"base": {"x": 0.2, "z": 0.1, "pitch": 1.0}}}),
    );
    let names: Vec<&str> = found.contacts.iter().map(|own| &*own.name).collect();
    assert_eq!((names, modes(&found).len()), (vec!["body/1"], 1));
    let notes = found.notes.join("\n");
    assert!(notes.contains("body/0 leaves the ground"), "{notes}");
}

/// A body of 5 kg on a thigh and a foot. The contacts hold the lower links while the body turns.
#[test]
fn what_stands_by_rates_that_cancel_stands_in_every_digit() {
    let leg = robot(&urdf::robot(&[
        link("body", 5.0, [0.0; 2], 0.05, ""),
        joint("hip", HINGE, ["body", "thigh"], [0.0; 2], ""),
        link("thigh", 1.0, [0.0, -0.2], 0.02, ""),
        joint("ankle", HINGE, ["thigh", "foot"], [0.0, -0.4], ""),
        link("foot", 0.5, [0.05, -0.03], 0.002, ""),
    ]));
    let on = |link: &str, [x, z]: [f64; 2]| json!({"link": link, "offset": [x, 0, z]});
    let heel = on("foot", [-0.05, -0.05]);
    // Contacts of the foot on level ground and on a ramp, and one with a point of the thigh, which does not turn
    // either.
    let ramp =
        json!({"ground": {"profile": [[-9, 0], [0.1, 0], [9, 1.78]]}, "contacts": [heel, on("foot", [0.15, -0.03])]});
    let kneeling = json!({"contacts": [heel, on("foot", [0.15, -0.05]), on("thigh", [0.2, -0.3])]});
    for (scene, friction) in [(&ramp, 0.8), (&kneeling, 0.8), (&kneeling, 2.0)] {
        let found = |rates: [f64; 3]| {
            let mut state = scene.clone();
            state["friction"] = json!(friction);
            state["stance"] = json!("foot");
            state["position"] = json!({"base": {"pitch": 0.3}, "joints": {"hip": -0.2, "ankle": -0.1}});
            state["velocity"] = json!({"base": {"pitch": rates[0]}, "joints": {"hip": rates[1], "ankle": rates[2]}});
            forces(&leg, state)
        };
        let exact = found([0.5, -0.5, 0.0]);
        assert!(!modes(&exact).is_empty(), "{exact:?}");
        assert!(modes(&exact).iter().all(|own| own.iter().all(|mode| *mode == Mode::Stick)), "{exact:?}");
        assert!(exact.analysis.as_ref().unwrap().proven);
        let last_bit = 0.5 * (1.0 + f64::EPSILON);
        for rates in [[0.5, -last_bit, 0.0], [0.5, -last_bit, 1e-16], [-0.5, last_bit, 0.0]] {
            let other = found(rates);
            assert_eq!(modes(&other), modes(&exact), "{rates:?} {scene}");
            assert!(other.analysis.as_ref().unwrap().proven);
        }
    }
}

/// Two soles on legs that slide or swing. All turn at one rate, which is rounding or below the resting speed.
#[test]
fn what_turns_as_one_with_a_sole_that_stands_does_not_turn() {
    let sole =
        |name: &str, height: f64| link(name, 1.0, [0.0; 2], 0.1, &collision([0.0, height], "box size=\"0.2 0.1 0.1\""));
    let along = Axis::Prismatic([0.0, 1.0]);
    let torso = || link("torso", 5.0, [0.0; 2], 0.5, "");
    let sliding = urdf::robot(&[
        torso(),
        sole("a", 0.0),
        joint("ja", along, ["torso", "a"], [-0.3, -0.95], ""),
        sole("b", 0.0),
        joint("jb", along, ["torso", "b"], [0.4, -0.95], ""),
    ]);
    let swinging = urdf::robot(&[
        torso(),
        sole("a", -0.95),
        joint("ja", HINGE, ["torso", "a"], [-0.3, 0.0], ""),
        sole("b", -0.95),
        joint("jb", HINGE, ["torso", "b"], [0.4, 0.0], ""),
        link("arm", 1.0, [0.0, -0.2], 0.1, ""),
        joint("shoulder", HINGE, ["torso", "arm"], [0.0, 0.3], ""),
    ]);
    for (robot, rates, limit, turning) in
        [(sliding, json!({"ja": 0.5, "jb": 0.5}), None, 1e-17), (swinging, json!({"shoulder": 5}), Some(1e-5), 1e-7)]
    {
        let robot = self::robot(&robot);
        let options = Options { resting_speed: limit, ..Options::default() };
        let lifted = if limit.is_none() { -0.5 } else { 0.0 };
        let [exact, turned] = [0.0, turning].map(|pitch| {
            let state = json!({"friction": 0.6, "position": {"base": {"z": 1}},
                "velocity": {"base": {"z": lifted, "pitch": pitch}, "joints": rates}});
            let state = State::from_json(&state.to_string(), &robot, &Defaults::default()).expect("a state");
            Pipeline::new(&robot, options.clone()).forces(&state).expect("an answer")
        });
        assert_eq!((modes(&exact), modes(&turned)), (vec![vec![Mode::Stick; 4]], vec![vec![Mode::Stick; 4]]));
        let margins = [&exact, &turned].map(|found| outcomes(found)[0].margin.expect("a margin"));
        assert!((margins[0] - margins[1]).abs() < 1e-4 && margins[0] > 0.1, "{margins:?}");
    }
}
