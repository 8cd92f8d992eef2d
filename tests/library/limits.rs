//! Joints outside the limits of the robot's file, which are noted, or refused with `strict_limits`; other doubtful
//! input.

use crate::support::impact::{ramone, reduced, robot, try_impact};
use crate::support::urdf::{self, Axis, HINGE, joint, link};
use heelstrike::Robot;
use heelstrike::pipeline::Options;
use heelstrike::robot::{Base, Reduction};
use serde_json::json;
use std::fmt::Write;

/// A body with the joint `hip`, which has this limit, and the joint `calf`, which mimics it with multiplier 3.
fn limited(axis: Axis, limit: &str) -> Robot {
    let mimic = r#"<mimic joint="hip" multiplier="3"/>"#;
    let parts = [
        link("body", 2.0, [0.0; 2], 0.5, ""),
        link("leg", 1.0, [0.0, -0.1], 0.5, ""),
        link("tail", 1.0, [0.0, -0.1], 0.5, ""),
        joint("hip", axis, ["body", "leg"], [0.0; 2], "").replace(r#"lower="-9" upper="9""#, limit),
        joint("calf", HINGE, ["body", "tail"], [0.0; 2], mimic),
    ];
    robot(&urdf::robot(&parts))
}

#[test]
fn doubtful_angles_and_limits_are_noted() {
    let at = |hip: f64, pitch: f64| json!({"position": {"base": {"pitch": pitch}, "joints": {"hip": hip}}});
    let slide = Axis::Prismatic([0.0, 1.0]);
    let within = r#"lower="-2" upper="2.5""#;
    let mut notes = String::new();
    for (axis, limit, hip, pitch) in [
        (HINGE, within, -2.25, 0.0),
        (HINGE, within, -25.0, 0.0),
        (slide, within, 2.75, 0.0),
        // Beyond the limit by the rounding of f32, which is not noted, and by more.
        (HINGE, within, f64::from(2.5_f32.next_up()), 0.0),
        (HINGE, within, 2.5 + 1e-5, 0.0),
        (HINGE, r#"lower="0" upper="0""#, 2.75, 0.0),
        (HINGE, r#"lower="2" upper="-2""#, 2.75, 0.0),
        (HINGE, r#"lower="x" upper="1""#, 2.75, 0.0),
        // A missing end of a limit is 0.
        (HINGE, r#"upper="2""#, -0.5, 0.0),
        (HINGE, "", 2.75, 0.0),
        (HINGE, "", 30.0, -90.0),
        // Wheels make many turns, and simulators print angles with many digits: only whole numbers look like degrees.
        (HINGE, "", 30.01, 6.0),
        (slide, "", 30.0, 0.0),
        // The base of a robot with legs does not turn so far.
        (HINGE, "", 6.0, -12.34),
    ] {
        let found = try_impact(&limited(axis, limit), Options::default(), at(hip, pitch)).expect("an answer").notes;
        let found = found.iter().filter(|note| note.contains(" = "));
        let found: String = found.map(|note| format!("    {note}\n")).collect();
        writeln!(notes, "{axis:?} {limit}: {hip}, pitch {pitch}\n{found}").expect("a string takes all");
    }
    insta::assert_snapshot!(notes);
    // Neither does a hip that carries a knee.
    let joints = json!({"left_hip": -28.65, "left_knee": 57.3});
    let state = json!({"position": {"base": {"z": 2}, "joints": joints}, "friction": 1});
    let notes = try_impact(&ramone(), Options::default(), state).expect("an answer").notes;
    let odd: Vec<_> = notes.iter().filter(|note| note.contains("more than a turn")).collect();
    assert_eq!(odd, ["left_hip = -28.65 rad is more than a turn; degrees?"]);
}

#[test]
fn friction_in_percent_or_degrees_is_noted() {
    let is_noted = |friction: &str| {
        let state = format!(r#"{{"position": {{"base": {{"z": 2}}}}, "friction": {friction}}}"#);
        let notes = try_impact(&ramone(), Options::default(), state).expect("an answer").notes;
        notes.iter().any(|note| note.contains("in percent or degrees?"))
    };
    assert!(["70", "{\"left_foot\": 35}"].into_iter().all(is_noted));
    // Large numbers stand for infinite friction.
    assert!(!["2.5", "1000", "\"infinite\""].into_iter().any(is_noted));
}

#[test]
fn a_deep_foot_has_the_remedy_of_its_robot() {
    let remedy = |robot: &Robot, state| {
        let error = try_impact(robot, Options::default(), state).expect_err("in the ground");
        error.remedy().expect("a remedy").to_owned()
    };
    let degrees = json!({"position": {"base": {"z": -1, "pitch": 90}}});
    assert!(remedy(&ramone(), degrees).ends_with("pitch = 90 rad is more than a turn; degrees?"));
    // Friction puts no foot into the ground.
    let percent = remedy(&ramone(), json!({"position": {"base": {"z": -1}}, "friction": 80}));
    assert!(!percent.contains("friction"), "{percent}");
    let reduction = Reduction { base: Some(Base::Fixed), ..Reduction::default() };
    let bolted = reduced(include_str!("../../urdf/ramone.urdf"), &reduction);
    assert!(remedy(&bolted, json!({})).starts_with("the robot is bolted to the world: "));
}

#[test]
fn laws_of_links_without_a_foot_are_noted() {
    let robot = limited(HINGE, "");
    let notes = |scene: serde_json::Value| {
        let impact = try_impact(&robot, Options::default(), scene).expect("an answer");
        impact.notes.into_iter().filter(|note| note.contains("no effect")).collect::<Vec<_>>()
    };
    let given = json!({"friction": {"default": 1, "leg": 0.5}, "restitution": {"tail": 0.5},
        "uncertainty": {"friction": {"tail": 0.1}}});
    let expected = [
        "friction is given to leg, which has no foot: it has no effect",
        "restitution is given to tail, which has no foot: it has no effect",
        "uncertainty of friction is given to tail, which has no foot: it has no effect",
    ];
    assert_eq!(notes(given), expected);
    let named = json!({"friction": {"default": 1, "leg": 0.5}, "contacts": [{"link": "leg"}]});
    assert!(notes(named).is_empty());
}

#[test]
fn strict_limits_refuse_with_place_and_remedy() {
    for upper in ["2.5", "inf"] {
        let robot = limited(HINGE, &format!(r#"lower="-2" upper="{upper}""#));
        let options = Options { strict_limits: true, ..Options::default() };
        let state = |hip: f64| json!({"position": {"joints": {"hip": hip}}});
        let error = try_impact(&robot, options.clone(), state(-2.25)).expect_err("outside");
        assert_eq!(error.place(), Some("position.joints.hip"));
        assert_eq!(error.reason().to_string(), format!("hip = -2.25 rad is outside [-2, {upper}]"));
        assert!(error.remedy().is_some_and(|remedy| remedy.contains("`strict_limits`")));
        assert!(try_impact(&robot, options, state(2.25)).is_ok());
    }
}
