//! Time that each reduction saves on a robot that it serves: `true` with it, `false` without.
//!
//! `cargo bench --bench reductions` prints times; compare the two of a pair within one run, not runs with each other.

use divan::{Bencher, black_box};
use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::impact::{AnalysisOptions, ContactProblem, Friction, Scratch};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::reductions::Reductions;
use heelstrike::robot::Reduction;
use heelstrike::state::{Defaults, State};
use serde_json::{Value, json};

macro_rules! robot {
    ($folder:literal, $file:literal) => {
        (
            include_str!(concat!("../tests/data/robots/", $folder, "/", $file)),
            include_str!(concat!("../tests/data/robots/", $folder, "/reference.json")),
        )
    };
}

/// A URDF and its reference.
type Files = (&'static str, &'static str);

const A1: Files = robot!("a1", "a1.urdf");
const H1: Files = robot!("h1", "h1.urdf");
const RABBIT: Files = robot!("rabbit", "five_link_walker.urdf");
const UPKIE: Files = robot!("upkie", "upkie.urdf");

fn main() {
    divan::main();
}

fn robot((urdf, _): Files, reductions: Reductions) -> Robot {
    let description = Description::from_urdf(urdf).expect("a good file");
    Robot::reduce(&description, &Reduction { reductions, ..Reduction::default() }).expect("a good robot")
}

/// A configuration of the robot's reference, with this many of its contacts.
fn state((_, reference): Files, contacts: usize) -> Value {
    let reference: Value = serde_json::from_str(reference).expect("a good reference");
    let variant = &reference["variants"]["default"];
    let config = &variant["configs"][1];
    let part = |values: &Value, range: std::ops::Range<usize>| -> Value {
        let names = variant["coordinates"].as_array().expect("a list");
        let entry = |at: usize| (names[at].as_str().expect("a name").to_owned(), values[at].clone());
        Value::Object(range.map(entry).collect())
    };
    let coordinates = variant["coordinates"].as_array().map_or(0, Vec::len);
    let motion = |values: &Value| json!({"base": part(values, 0..3), "joints": part(values, 3..coordinates)});
    let contacts = variant["contacts"].as_array().expect("a list")[..contacts].iter();
    let contacts = contacts.map(|own| json!({"link": own["link"], "offset": own["offset"], "radius": own["radius"]}));
    json!({
        "position": motion(&config["q"]), "velocity": motion(&config["v"]), "friction": 0.8,
        "contacts": contacts.collect::<Vec<_>>(),
    })
}

fn whole_state(bencher: Bencher, files: Files, state: &Value, reductions: Reductions) {
    let robot = robot(files, reductions);
    let state = State::from_json(&state.to_string(), &robot, &Defaults::default()).expect("a good state");
    let mut pipeline =
        Pipeline::new(&robot, Options { reductions, contact_tolerance: Some(5e-3), ..Options::default() });
    pipeline.impact(&state).expect("an answer");
    bencher.bench_local(|| pipeline.impact(black_box(&state)));
}

fn analysis(bencher: Bencher, files: Files, contacts: usize, friction: Friction, reductions: Reductions) {
    let robot = robot(files, Reductions::ALL);
    let state =
        State::from_json(&state(files, contacts).to_string(), &robot, &Defaults::default()).expect("a good state");
    let impact =
        Pipeline::new(&robot, Options { matrices: true, ..Options::default() }).impact(&state).expect("an answer");
    let delassus = impact.matrices.expect("asked for").delassus.concat();
    let (friction, restitution) = (vec![friction; contacts], vec![0.0; contacts]);
    let problem = ContactProblem::new(delassus, impact.velocity_before, friction, restitution).expect("a good problem");
    let (mut scratch, asked) = (Scratch::default(), AnalysisOptions { reductions, ..AnalysisOptions::default() });
    bencher.bench_local(|| scratch.analyze(black_box(&problem), black_box(&problem), asked));
}

/// Upkie on a wheel; 34 of its joints are fixed.
#[divan::bench(args = [true, false])]
fn weld(bencher: Bencher, weld: bool) {
    whole_state(bencher, UPKIE, &state(UPKIE, 1), Reductions { weld, massless: weld, ..Reductions::ALL });
}

/// Upkie's links that have neither mass nor shape, with fixed joints welded in both cases.
#[divan::bench(args = [true, false])]
fn massless(bencher: Bencher, massless: bool) {
    whole_state(bencher, UPKIE, &state(UPKIE, 1), Reductions { massless, ..Reductions::ALL });
}

/// H1 on a foot's two corners, with its arms and the other leg held.
#[divan::bench(args = [true, false])]
fn held(bencher: Bencher, held: bool) {
    let mut state = state(H1, 2);
    let right = ["right_hip_pitch_joint", "right_knee_joint", "right_ankle_joint"];
    state["held"] = json!([&right[..], &["left_elbow_joint", "right_elbow_joint"]].concat());
    whole_state(bencher, H1, &state, Reductions { held, ..Reductions::ALL });
}

/// A1 with its 26 shapes, landing on the one foot that is lowest.
#[divan::bench(args = [true, false])]
fn reach(bencher: Bencher, reach: bool) {
    let joint = |(leg, bent): (&str, f64)| {
        [(format!("{leg}_thigh_joint"), json!(bent)), (format!("{leg}_calf_joint"), json!(-2.0 * bent))]
    };
    let joints = [("FR", 0.7), ("FL", 0.8), ("RR", 0.6), ("RL", 0.9)].into_iter().flat_map(joint);
    // Two links of 0.2 m and a sphere of 0.02 m below the hip.
    let height = 0.4 * f64::cos(0.6) + 0.02;
    let position = json!({"base": {"z": height}, "joints": Value::Object(joints.collect())});
    let velocity = json!({"base": {"x": 0.3, "z": -0.5, "pitch": 0.5}});
    let state = json!({"position": position, "velocity": velocity, "friction": 0.8});
    whole_state(bencher, A1, &state, Reductions { reach, ..Reductions::ALL });
}

/// A1 on four feet without friction.
#[divan::bench(args = [true, false])]
fn frictionless(bencher: Bencher, frictionless: bool) {
    analysis(bencher, A1, 4, Friction::ZERO, Reductions { frictionless, ..Reductions::ALL });
}

/// Rabbit on one foot.
#[divan::bench(args = [true, false])]
fn lone(bencher: Bencher, lone: bool) {
    analysis(bencher, RABBIT, 1, Friction::Finite(0.8), Reductions { lone, ..Reductions::ALL });
}
