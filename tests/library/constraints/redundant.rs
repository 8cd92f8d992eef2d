//! Loop rows that follow from others: noted, left out, and without effect on anything but their own impulse.

use crate::constraints::four_bar::{CRANKS, L, M, M_COUPLER, WIDTH, assert_stops, bolted, parallelogram, pin, state};
use crate::constraints::{impact, matrices, try_impact};
use crate::support::impact::{loop_impulses, velocities_after};
use crate::support::mechanism::{Mechanism, point};
use heelstrike::pipeline::Impact;
use serde_json::{Value, json};

const Q: f64 = 0.6;
const RATE: f64 = -2.0;

fn strike(mechanism: &Mechanism, loops: Value) -> Box<Impact> {
    impact(&bolted(mechanism), &state(mechanism, Q, RATE, loops))
}

/// A parallelogram with a third crank in the middle, and its loops.
fn guided_twice() -> (Mechanism, Value) {
    let mechanism = parallelogram(&[("front", 0.0), ("middle", 0.5 * WIDTH), ("rear", WIDTH)]);
    (mechanism, json!([pin("middle", 0.5 * WIDTH), pin("rear", WIDTH)]))
}

#[test]
fn a_loop_given_twice_counts_once() {
    let mechanism = parallelogram(&CRANKS);
    let once = strike(&mechanism, json!([pin("rear", WIDTH)]));
    let twice = strike(&mechanism, json!([pin("rear", WIDTH), pin("rear", WIDTH)]));
    assert_stops(&twice, Q, RATE, 2.0);
    assert_eq!(once.notes, [""; 0]);
    let note = "loops[1] (rear - coupler) is already closed along x and z by what else holds its points: that is left out, \
                its impulse is 0";
    assert_eq!(twice.notes, [note]);
    assert_eq!(loop_impulses(&twice)[0], [loop_impulses(&once)[0][0], [0.0; 2]]);
}

/// A third crank guides the coupler no more than two do: of its two rows one is new, its own angle.
#[test]
fn a_parallelogram_with_a_third_crank_still_moves() {
    let (mechanism, loops) = guided_twice();
    let found = strike(&mechanism, loops);
    assert_stops(&found, Q, RATE, 3.0);
    assert_eq!(found.notes.len(), 1, "{:?}", found.notes);
    assert!(found.notes[0].contains("already closed along"), "{:?}", found.notes);
    assert_eq!(loop_impulses(&found)[0].iter().flatten().filter(|entry| **entry == 0.0).count(), 1);
}

/// A pose of six digits leaves the loops open by 1e-7 m; its rows, taken at their word, would lock the mechanism.
#[test]
fn a_rounded_pose_does_not_lock_redundant_loops() {
    let (mechanism, loops) = guided_twice();
    let mut rounded = state(&mechanism, Q, RATE, loops.clone());
    rounded["position"]["joints"]["middle"] = json!(Q + 4e-7);
    rounded["position"]["joints"]["coupler"] = json!(-Q - 3e-7);
    let moving = matrices(&impact(&bolted(&mechanism), &rounded)).delassus[1][1];
    let expected = matrices(&strike(&mechanism, loops)).delassus[1][1];
    assert!((moving - expected).abs() < 1e-5 * expected, "{moving} {expected}");
}

/// A rear crank of a millionth of a milligram guides the coupler as a heavy one does, although nearly all that its pin
/// gives way is its own.
#[test]
fn a_light_link_hides_no_loop() {
    let mut mechanism = parallelogram(&CRANKS);
    mechanism.links[2].mass *= 1e-12;
    mechanism.links[2].moment *= 1e-12;
    let found = strike(&mechanism, json!([pin("rear", WIDTH)]));
    assert_eq!(found.notes, [""; 0]);
    let mass = (M / 3.0 + M_COUPLER) * L * L;
    let delassus = matrices(&found).delassus[1][1];
    // What the loop takes along the crank is a millionth of what it takes across: that much of the digits is lost.
    assert!((delassus * mass / (L * Q.sin()).powi(2) - 1.0).abs() < 1e6 * 64.0 * f64::EPSILON, "{delassus}");
}

/// A brace from the coupler to the ground leaves nothing free.
#[test]
fn a_braced_parallelogram_is_rigid() {
    let mechanism = parallelogram(&CRANKS);
    let coupler = [0.5 * WIDTH - 0.5 * f64::sin(Q), -0.5 * f64::cos(Q)];
    let brace = json!({"a": point("coupler", [0.5 * WIDTH, 0.0]), "b": point("root", coupler)});
    let still = state(&mechanism, Q, 0.0, json!([pin("rear", WIDTH), brace]));
    let found = impact(&bolted(&mechanism), &still);
    let delassus = &matrices(&found).delassus;
    assert!(delassus.iter().flatten().all(|entry| entry.abs() < 1e-14), "{delassus:?}");
    assert_eq!(velocities_after(&found)[0], [0.0; 3]);
    // And moving it is refused.
    let error =
        try_impact(&bolted(&mechanism), &state(&mechanism, Q, RATE, still["loops"].clone())).expect_err("refused");
    assert!(error.reason().to_string().starts_with("the velocities open loops[1] (coupler - root) at "), "{error}");
}
