//! Virtual model control: joint torques that imitate springs and dampers, compared with moments worked out by hand.

use super::{forces, try_forces};
use crate::support::impact::{outcomes, reduced};
use crate::support::urdf::{self, Axis, HINGE, joint, link};
use heelstrike::robot::{Base, Reduction};
use heelstrike::write::{Detail, Report};
use heelstrike::{Defaults, Impact, Robot, State};
use serde_json::{Value, json};

/// A body with an arm that reaches 0.8 m forward from its hinge, a rail below it, and a hand that turns at half the
/// arm's rate.
fn arm(base: Base) -> Robot {
    let mimic = r#"<mimic joint="hinge" multiplier="0.5" offset="0.2"/>"#;
    let elements = [
        link("body", 3.0, [0.0; 2], 0.2, ""),
        link("arm", 1.0, [0.4, 0.0], 0.05, ""),
        link("rail", 0.5, [0.0, -0.1], 0.01, ""),
        link("hand", 0.2, [0.1, 0.0], 0.001, ""),
        joint("hinge", HINGE, ["body", "arm"], [0.1, 0.3], ""),
        joint("slide", Axis::Prismatic([0.0, -1.0]), ["body", "rail"], [0.0, -0.2], ""),
        joint("wrist", HINGE, ["arm", "hand"], [0.8, 0.0], mimic),
    ];
    reduced(&urdf::robot(&elements), &Reduction { base: Some(base), ..Reduction::default() })
}

/// The result as JSON.
fn record(robot: &Robot, state: &Value, found: &Impact) -> Value {
    let state = State::from_json(&state.to_string(), robot, &Defaults::default()).unwrap();
    let report = Report::of_state(robot, &state, found, Detail::default()).unwrap();
    serde_json::to_value(report).unwrap()
}

fn near(found: &Value, expected: f64) -> bool {
    (found.as_f64().unwrap() - expected).abs() < 1e-12 * expected.abs().max(1.0)
}

#[test]
fn a_spring_that_no_joint_can_give_is_noted() {
    let robot = arm(Base::Floating);
    let notes = |a: &str, b: Value| {
        let state = json!({"position": {"base": {"z": 1.0}}, "contacts": [],
                           "virtual": [{"a": {"link": a}, "b": b, "stiffness": [1, 1]}]});
        forces(&robot, &state).notes.iter().filter(|note| note.starts_with("virtual[0] gives no torque")).count()
    };
    assert_eq!(notes("body", json!({"world": [0, 2]})), 1);
    assert_eq!(notes("arm", json!({"link": "arm", "offset": [1, 0, 0]})), 1);
    assert_eq!(notes("arm", json!({"world": [0, 2]})), 0);
    assert_eq!(notes("body", json!({"link": "arm"})), 0);
}

#[test]
fn spring_to_the_world_gives_its_moments() {
    let robot = arm(Base::Floating);
    let state = json!({
        "position": {"base": {"x": 0.5, "z": 1.0}, "joints": {"hinge": 0.0, "slide": 0.25}},
        "velocity": {"base": {"z": 0.3}, "joints": {"hinge": 2.0}},
        "torque": {"hinge": 7.0},
        "contacts": [],
        "virtual": [
            {"a": {"link": "arm", "offset": [0.6, 0, 0]}, "b": {"world": [1.0, 1.0]},
             "stiffness": [100, 200], "damping": [10, 20], "target": [0.1, 0.2], "force": [1, 2]},
            {"a": {"link": "rail"}, "b": {"world": [0, 0]}, "stiffness": [0, 50]},
        ],
    });
    let found = forces(&robot, &state);
    let record = record(&robot, &state, &found);
    // The point is at (1.2, 1.3); the arm, which goes forward, turns it down: v = (0, 0.3 - 0.6 * 2).
    let force = [1.0 + 100.0 * (0.1 - 0.2), 2.0 + 200.0 * (0.2 - 0.3) - 20.0 * (0.3 - 1.2)];
    let own = &record["virtual"][0];
    assert!((0..2).all(|axis| near(&own["force"][axis], force[axis])), "{own}");
    // About the hinge, 0.6 m behind, a lift turns the arm up: against the pitch.
    let hinge = -0.6 * force[1];
    assert!(near(&own["torque"]["hinge"], hinge) && near(&own["torque"]["slide"], 0.0), "{own}");
    // The rail's end at z = 1 - 0.2 - 0.25 is pulled down, along the slide.
    let down = 50.0 * 0.55;
    assert!(near(&record["virtual"][1]["torque"]["slide"], down), "{record}");
    assert!(near(&record["torque"]["hinge"], 7.0 + hinge) && near(&record["torque"]["slide"], down), "{record}");
    // The base is 0.7 m behind the first point and 0.3 m below it; the second point is straight below the base.
    let about = 0.3 * force[0] - 0.7 * force[1];
    let unrealized = &record["unrealized"];
    assert!(near(&unrealized["fx"], force[0]) && near(&unrealized["fz"], force[1] - down), "{unrealized}");
    assert!(near(&unrealized["moment"], about), "{unrealized}");
    // The unrealized part is not applied: the robot moves as under the joint torques alone.
    let mut alone = state.clone();
    alone["torque"] = record["torque"].clone();
    alone.as_object_mut().unwrap().remove("virtual");
    let of = |state: &Value| outcomes(&forces(&robot, state))[0].velocity().collect::<Vec<_>>();
    for (one, other) in of(&state).into_iter().zip(of(&alone)) {
        assert!((one - other).abs() < 1e-11 * other.abs().max(1.0), "{one} {other}");
    }
}

#[test]
fn spring_between_links_asks_nothing_of_pairs() {
    // A spring between the pitches of two links gives opposite moments, which the joints between them supply
    // completely.
    let robot = arm(Base::Floating);
    let state = json!({
        "position": {"base": {"pitch": 0.7}, "joints": {"hinge": 0.4}},
        "velocity": {"base": {"pitch": 0.7}, "joints": {"hinge": 2.0}},
        "contacts": [],
        "virtual": [{"a": {"link": "hand"}, "b": {"link": "body", "offset": [0.1, 0, 0]},
            "pitch": {"stiffness": 50, "damping": 5, "target": 0.1}, "moment": 3}],
    });
    let record = record(&robot, &state, &forces(&robot, &state));
    // The hand is turned by 0.4 + (0.5 * 0.4 + 0.2) relative to the body, at 2 + 1 rad/s. The coordinate moves both
    // joints.
    let moment = 3.0 + 50.0 * (0.1 - 0.8) - 5.0 * 3.0;
    let own = &record["virtual"][0];
    assert!(near(&own["moment"], moment) && near(&own["torque"]["hinge"], 1.5 * moment), "{own}");
    for entry in ["fx", "fz", "moment"] {
        assert!(near(&record["unrealized"][entry], 0.0), "{record}");
    }
}

#[test]
fn bolted_robot_leaves_nothing_unrealized() {
    let robot = arm(Base::Fixed);
    let spring = json!([{"a": {"link": "hand", "offset": [0.1, 0, 0.2]}, "b": {"world": [0, 2]}, "stiffness": [9, 9]}]);
    let state = json!({"contacts": [], "virtual": spring});
    let record = record(&robot, &state, &forces(&robot, &state));
    assert!(record["unrealized"].is_null() && record["torque"]["hinge"].as_f64().unwrap().abs() > 1.0, "{record}");
}

#[test]
fn held_joint_carries_its_load_through() {
    // The braked hinge holds the mimic joint at the wrist, too: only the slide moves; springs on the arm have no
    // effect.
    let robot = arm(Base::Fixed);
    let rail = json!({"a": {"link": "rail"}, "b": {"world": [0, 0]}, "stiffness": [0, 50]});
    let hand = json!({"a": {"link": "hand"}, "b": {"world": [3, 1]}, "stiffness": [70, 80]});
    let state = |springs: Value| json!({"contacts": [], "held": ["hinge"], "virtual": springs});
    let [one, both] = [json!([rail]), json!([rail, hand])].map(|springs| forces(&robot, state(springs)));
    let [slide, same] = [&one, &both].map(|found| outcomes(found)[0].velocity().collect::<Vec<_>>());
    assert_eq!(slide, same);
    // The rail falls along the slide, and its end, 0.2 m below the ground's origin, is pulled up by 10 N.
    assert!((slide[1] - (9.81 - 10.0 / 0.5)).abs() < 1e-13, "{slide:?}");
    let note = "hinge is held: its torque is carried by what holds it";
    let has_note = |found: &Impact| found.notes.iter().any(|own| own.contains(note));
    assert!(has_note(&both) && !has_note(&one), "{:?}", both.notes);
}

#[test]
fn negative_stiffness_and_damping_are_noted() {
    let robot = arm(Base::Floating);
    let spring = |more: Value| {
        let mut spring = json!({"a": {"link": "arm"}, "b": {"link": "body"}});
        spring.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        forces(&robot, json!({"contacts": [], "virtual": [spring]})).notes.clone()
    };
    let odd = [json!({"stiffness": [0, -9], "damping": [1, 1]}), json!({"pitch": {"stiffness": 5, "damping": -1}})];
    for (more, what) in odd.into_iter().zip(["stiffness, which pushes away", "damping, which speeds up"]) {
        let notes = spring(more);
        assert!(
            matches!(&notes[..], [note] if note.starts_with(&format!("virtual[0] has a negative {what}"))),
            "{notes:?}"
        );
    }
    assert_eq!(spring(json!({"stiffness": [0, 9], "force": [0, -1]})), Vec::<String>::new());
}

#[test]
fn springs_are_refused_with_place_and_remedy() {
    let robot = arm(Base::Floating);
    let (arm, origin, axes) = (json!({"link": "arm"}), json!({"world": [0, 0]}), "one number along x and one along z");
    let two_ends = json!({"a": arm, "b": {"link": "body", "world": [0, 0]}});
    let pitched = json!({"a": arm, "b": origin, "pitch": {"force": 5}});
    let stiff = json!({"a": arm, "b": {"world": [0, 1e300]}, "stiffness": [0, 1e300]});
    let aimless = json!({"a": arm, "b": origin, "target": [0, 0.5], "damping": [1, 1]});
    let level = json!({"a": arm, "b": origin, "pitch": {"target": 0.1}});
    for (spring, place, reason, remedy) in [
        (json!({"b": origin}), "virtual[0]", "\"a\" is missing", "two ends"),
        (json!({"a": arm}), "virtual[0]", "\"b\" is missing", "two ends"),
        (json!({"a": {"link": "arn"}, "b": origin}), "virtual[0].a.link", "arn", "did you mean arm?"),
        (
            json!({"a": arm, "b": {}}),
            "virtual[0].b",
            "\"link\" is missing",
            "name a link as {\"link\": NAME}, or give a place",
        ),
        (two_ends, "virtual[0].b.world", "either on a link or in the world", "leave out either"),
        (json!({"a": arm, "b": {"world": [0, 0, 0]}}), "virtual[0].b.world", "found 3 entries", axes),
        (json!({"a": arm, "b": origin, "stiffness": 5}), "virtual[0].stiffness", "a list of 2 numbers", axes),
        (pitched, "virtual[0].pitch.force", "unknown field", "stiffness, damping, target"),
        (aimless, "virtual[0].target", "no stiffness", "leave the target out"),
        (level, "virtual[0].pitch.target", "no stiffness", "leave the target out"),
        (stiff, "virtual", "the force of a virtual spring", "SI units"),
    ] {
        let error = try_forces(&robot, json!({"contacts": [], "virtual": [spring]})).unwrap_err();
        assert_eq!(error.place(), Some(place), "{error}");
        assert!(error.to_string().contains(reason), "{error}");
        assert!(error.remedy().is_some_and(|own| own.contains(remedy)), "{error}: {:?}", error.remedy());
    }
}
