//! Refused loops: wrong names, poses and velocities that leave them open, massless coordinates that only they hold.

use crate::constraints::four_bar::{CRANKS, WIDTH, bolted, parallelogram, pin, state};
use crate::constraints::try_impact;
use heelstrike::{Defaults, Options, Pipeline, State};
use serde_json::{Value, json};
use std::fmt::Write;

/// A robot that stands in a simulation has rates of rounding, which open its loops by as much.
#[test]
fn rates_below_the_resting_speed_open_no_loop() {
    let mechanism = parallelogram(&CRANKS);
    let robot = bolted(&mechanism);
    let mut noisy = state(&mechanism, 0.6, -2.0, json!([pin("rear", WIDTH)]));
    noisy["velocity"] = json!({"joints": {"front": -2e-17, "rear": 1e-17, "coupler": 3e-17}});
    assert!(try_impact(&robot, &noisy).is_err());
    let state = State::from_json(&noisy.to_string(), &robot, &Defaults::default()).unwrap();
    let options = Options { resting_speed: Some(1e-9), ..Options::default() };
    assert!(Pipeline::new(&robot, options).impact(&state).is_ok());
}

/// A braked crank and a free one hold the loop's points at rest, while an arm turns. The noise of their rates is taken
/// away, and the rounding that remains does not count as opening the loop.
#[test]
fn a_loop_that_is_brought_to_rest_is_closed() {
    let mechanism = parallelogram(&CRANKS).with("arm", "root", [0.0, 0.5], 1.0, [0.0, -0.2]);
    let robot = bolted(&mechanism);
    for at in 0..50 {
        let q = 0.02 * f64::from(at) - 0.5;
        let mut state = state(&mechanism, q, 0.0, json!([pin("rear", WIDTH)]));
        state["velocity"] = json!({"joints": {"front": 3e-4, "arm": 1.0}});
        state["held"] = json!(["rear", "coupler"]);
        try_impact(&robot, &state).unwrap_or_else(|error| panic!("{q}: {error}"));
    }
}

#[test]
fn state_that_breaks_a_loop_is_refused() {
    let mechanism = parallelogram(&CRANKS);
    let robot = bolted(&mechanism);
    let sound = state(&mechanism, 0.6, -2.0, json!([pin("rear", WIDTH)]));
    let ends = |end: &str, value: Value| {
        let mut pins = json!([pin("rear", WIDTH)]);
        pins[0][end] = value;
        json!({"loops": pins})
    };
    let rate = json!({"joints": {"front": -2.0, "rear": -1.0, "coupler": 2.0}});
    let mut refusals = String::new();
    for (what, change) in [
        ("an unknown link", ends("a", json!({"link": "raer", "offset": [0, 0, 0]}))),
        ("an unknown field", ends("c", json!({}))),
        ("one end", json!({"loops": [{"a": {"link": "rear"}}]})),
        ("no link", ends("b", json!({}))),
        ("an offset of two numbers", ends("b", json!({"link": "coupler", "offset": [0, 0]}))),
        ("257 loops", json!({"loops": vec![pin("rear", WIDTH); 257]})),
        ("no list", json!({"loops": {}})),
        // The rear crank is 0.1 rad further: its end is 2 l sin(0.05) away.
        ("an open pose", json!({"position": {"joints": {"front": 0.6, "rear": 0.7, "coupler": -0.6}}})),
        ("opening velocities", json!({"velocity": rate})),
        // Rates of braked joints are not corrected: a loop of braked joints alone must already be closed.
        ("opening braked joints", json!({"velocity": rate, "held": ["front", "rear", "coupler"]})),
    ] {
        let mut state = sound.clone();
        state.as_object_mut().expect("an object").extend(change.as_object().expect("an object").clone());
        let error = try_impact(&robot, &state).expect_err(what);
        let (place, remedy) = (error.place().unwrap_or_default(), error.remedy().unwrap_or_default());
        writeln!(refusals, "{what}\n    {place}: {}\n    {remedy}", error.reason()).expect("a string takes all");
    }
    insta::assert_snapshot!("broken_loops", refusals);
}

#[test]
fn a_massless_coordinate_that_only_a_loop_holds() {
    let mut mechanism = parallelogram(&CRANKS);
    (mechanism.links[2].mass, mechanism.links[2].moment) = (0.0, 0.0);
    let state = state(&mechanism, 0.6, -2.0, json!([pin("rear", WIDTH)]));
    let error = try_impact(&bolted(&mechanism), &state).expect_err("refused");
    let reason = "the mass matrix is singular: nothing resists a motion of joint \"rear\"";
    let remedy = "it needs inertia of its own, whatever the loops hold: give its links a mass or it a `rotor_inertia`, \
                  however small, or name it in `held`";
    assert_eq!(error.reason().to_string(), reason);
    let found = error.remedy().unwrap_or_default();
    assert!(found.starts_with("link \"") && found.ends_with(&format!(" has no <inertial>: {remedy}")), "{found}");
}
