//! The option `--no-reduction`, and what results say about reductions.

use crate::support::command::heelstrike_reads;
use crate::support::impact::{impact, robot};
use crate::support::urdf;
use heelstrike::Impact;
use heelstrike::write::LeftOutRecord;
use serde_json::{Value, json};

const RAMONE: &str = "urdf/ramone.urdf";

fn run(arguments: &[&str], input: &Value) -> Value {
    heelstrike_reads(arguments, input.to_string()).well().line()
}

fn state(friction: Value) -> Value {
    json!({
        "position": {"base": {"pitch": 0.05}, "joints": {"left_hip": 1.2, "left_knee": -1.5, "right_hip": 0.3}},
        "velocity": {"base": {"pitch": 0.5}, "joints": {"right_hip": 1.0}},
        "stance": "right_foot", "held": ["left_knee"], "friction": friction,
    })
}

/// What and why of those entries that are about the scene, not about the file.
fn left_out(result: &Value) -> Vec<[&str; 2]> {
    let all = result["left_out"].as_array().expect("a list").iter();
    let entries = all.map(|entry| ["what", "why"].map(|field| entry[field].as_str().expect("text")));
    entries.filter(|[_, why]| !why.contains("welded") && *why != "do not enter an impact").collect()
}

#[test]
fn a_result_lists_what_its_scene_did_not_need() {
    let held = ["joint \"left_knee\"", "braked: it keeps its rate and has no column"];
    let high = ["1 shape out of reach", "too high to reach the ground"];
    for (friction, more) in [
        (json!(0.0), Some(["tangential impulse of right_foot", "friction 0"])),
        (json!(0.8), None),
        (json!("infinite"), Some(["friction cone of right_foot", "infinite friction"])),
    ] {
        let result = run(&["impact", RAMONE, "-", "--format", "json"], &state(friction));
        let expected: Vec<_> = [held, high].into_iter().chain(more).collect();
        assert_eq!(left_out(&result), expected);
    }
}

#[test]
fn reductions_are_switched_off_together_or_by_name() {
    let of = |option: &str| run(&["impact", RAMONE, "-", "--format", "json", "--matrices", option], &state(json!(0.0)));
    let columns = |result: &Value| result["coordinates"].as_array().expect("a list").len();
    let (held, all) = (of("--no-reduction=held,frictionless"), of("--no-reduction"));
    assert_eq!(left_out(&held), [["1 shape out of reach", "too high to reach the ground"]]);
    assert_eq!((columns(&held), columns(&of("--no-reduction=weld"))), (7, 6));
    assert_eq!(columns(&all), 7);
    let why = "fixed: it has no coordinate, and moves a body of its own, left_foot";
    assert!(left_out(&all).contains(&["joint \"left_ankle\"", why]), "{all}");
    assert_eq!(held["outcomes"][0]["modes"], all["outcomes"][0]["modes"]);
}

#[test]
fn inner_points_are_reported_and_listed_ones_kept() {
    // A plate and a piece of rubber are welded to a foot at the same level; the rubber has another friction.
    let foot = |name: &str, width: f64| {
        urdf::link(name, 1.0, [0.0; 2], 0.1, &urdf::collision([0.0; 2], &format!("box size=\"{width} 0.1 0.2\"")))
    };
    let weld = |to: &str| urdf::joint(format!("to_{to}"), urdf::Axis::Fixed, ["foot", to], [0.0; 2], "");
    let feet = [foot("foot", 0.4), foot("plate", 0.2), foot("rubber", 0.3), weld("plate"), weld("rubber")];
    let robot = robot(&urdf::robot(&feet));
    let mut state = json!({"position": {"base": {"z": 0.1}}, "velocity": {"base": {"z": -1.0}},
        "friction": {"default": 0.5, "rubber": 0.7}});
    let found = impact(&robot, &state);
    let names = |impact: &Impact| impact.contacts.iter().map(|contact| contact.name.to_string()).collect::<Vec<_>>();
    assert_eq!(names(&found), ["foot/0", "foot/1", "rubber/0", "rubber/1"]);
    let merged = [
        "2 contact points next to foot/0, foot/1",
        "the outer points of the same body on straight ground act for them",
    ];
    let left_out = LeftOutRecord::of_impact(&robot, &found);
    assert!(left_out.iter().any(|left| [&*left.what, &*left.why] == merged), "{left_out:?}");
    state["contacts"] = json!([-0.2, 0.0, 0.2].map(|x| json!({"link": "foot", "offset": [x, 0.0, -0.1]})));
    assert_eq!(names(&impact(&robot, &state)), ["foot/0", "foot/1", "foot/2"]);
    // The contact of a stance is not merged.
    let standing = impact(&robot, json!({"stance": "plate", "friction": 0.5}));
    assert_eq!((names(&standing).join(" "), standing.stance), ("foot/0 foot/1 plate".to_owned(), Some(2)));
}

#[test]
fn inspect_shows_the_bodies_that_are_not_welded() {
    let bodies = |options: &[&str]| {
        let arguments = [&["inspect", RAMONE, "--format", "json"], options].concat();
        run(&arguments, &Value::Null)["bodies"].as_array().expect("a list").len()
    };
    assert_eq!((bodies(&[]), bodies(&["--no-reduction=weld"]), bodies(&["--no-reduction=held"])), (5, 7, 5));
}
