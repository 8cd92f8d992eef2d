//! Loop rows that follow from others: noted, left out, and without effect on anything but their own impulse.

use crate::constraints::four_bar::{CRANKS, L, M, M_COUPLER, WIDTH, assert_stops, bolted, parallelogram, pin, state};
use crate::constraints::{impact, matrices, try_impact};
use crate::support::impact::{loop_impulses, velocities_after};
use crate::support::mechanism::{Mechanism, point, turned};
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

/// A third crank does not guide the coupler more than two do: of its two loop rows only one is new, that of its own
/// angle.
#[test]
fn a_parallelogram_with_a_third_crank_still_moves() {
    let (mechanism, loops) = guided_twice();
    let found = strike(&mechanism, loops);
    assert_stops(&found, Q, RATE, 3.0);
    assert_eq!(found.notes.len(), 1, "{:?}", found.notes);
    assert!(found.notes[0].contains("already closed along"), "{:?}", found.notes);
    assert_eq!(loop_impulses(&found)[0].iter().flatten().filter(|entry| **entry == 0.0).count(), 1);
}

/// A pose of six digits leaves the loops open by 1e-7 m; its loop rows, taken as exact, would lock the mechanism.
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

/// A rear crank of a millionth of a milligram guides the coupler as a heavy one does, although nearly all of the
/// mobility of its pin is its own.
#[test]
fn a_light_link_hides_no_loop() {
    let mut mechanism = parallelogram(&CRANKS);
    mechanism.links[2].mass *= 1e-12;
    mechanism.links[2].moment *= 1e-12;
    let found = strike(&mechanism, json!([pin("rear", WIDTH)]));
    assert_eq!(found.notes, [""; 0]);
    let mass = (M / 3.0 + M_COUPLER) * L * L;
    let delassus = matrices(&found).delassus[1][1];
    // The loop's impulse along the crank is a millionth of that across it, which costs as many digits.
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
    // Velocities that move it are refused.
    let error =
        try_impact(&bolted(&mechanism), &state(&mechanism, Q, RATE, still["loops"].clone())).expect_err("refused");
    assert!(error.reason().to_string().starts_with("the velocities open loops[1] (coupler - root) at "), "{error}");
}

/// A parallelogram moves on a coupler that rests. Closing it leaves 1e-33 m/s along the coupler's rows that are left
/// out.
#[test]
fn a_loop_at_rest_may_carry_one_that_moves() {
    let (mechanism, loops) = guided_twice();
    let mechanism = mechanism
        .with("crank", "coupler", [0.1, 0.2], 1.0, [0.0, -0.2])
        .with("bar", "crank", [0.0, -0.5], 1.0, [0.3, 0.0])
        .with("swing", "coupler", [0.7, 0.2], 1.0, [0.0, -0.2]);
    let mut loops = loops.as_array().expect("two pins").clone();
    loops.push(json!({"a": point("bar", [0.6, 0.0]), "b": point("swing", [0.0, -0.5])}));
    for step in 0..40 {
        let mut moving = state(&mechanism, 0.02 + 0.01 * f64::from(step), 0.0, json!(loops));
        let angle = 0.1 + 0.013 * f64::from(step);
        for (name, sign) in [("crank", 1.0), ("bar", -1.0), ("swing", 1.0)] {
            moving["position"]["joints"][name] = json!(sign * angle);
            moving["velocity"]["joints"][name] = json!(sign);
        }
        moving["contacts"] = json!([point("swing", [0.0, -0.3])]);
        let found = impact(&bolted(&mechanism), &moving);
        let expected = turned([0.0, -0.3], angle);
        let [[along, up]] = found.velocity_before[..] else { panic!("{:?}", found.velocity_before) };
        assert!((along - expected[1]).abs() < 1e-14 && (up + expected[0]).abs() < 1e-14, "{along} {up}");
    }
}

/// Two cranks that are pinned together stand still. A wheel on one of them mimics an arm, which strikes: the pin's
/// rounding in the rows of the cranks' feet does not hold the arm.
#[test]
fn what_a_loop_holds_does_not_hold_others() {
    let mechanism = Mechanism::of(1.0, [0.0; 2], 1.0)
        .with("arm", "root", [1.0, 0.1], 1.0, [0.2, 0.0])
        .with("front", "root", [-0.3, 0.4], 1.0, [0.0, -0.2])
        .with("rear", "root", [0.3, 0.4], 1.0, [0.0, -0.2])
        .with("wheel", "front", [0.1, -0.2], 1.0, [0.05, 0.0])
        .following("arm", 1.3, 0.0);
    let robot = bolted(&mechanism);
    for step in 0..40 {
        let [front, rear, arm] = [1.0, 2.3, 3.7].map(|way| (way * f64::from(step + 1)).sin());
        // The pin's place on the rear crank, whose pivot is 0.6 m ahead.
        let [x, z] = turned([0.1, -0.35], front);
        let pinned = json!([{"a": point("front", [0.1, -0.35]), "b": point("rear", turned([x - 0.6, z], -rear))}]);
        let feet = [point("front", [0.0, -0.4]), point("rear", [0.0, -0.4]), point("arm", [0.4, 0.0])];
        let state = json!({"position": {"joints": {"front": front, "rear": rear, "arm": arm}},
            "velocity": {"joints": {"arm": 1.0}}, "friction": 0.5, "loops": pinned, "contacts": feet});
        let found = impact(&robot, &state);
        let [x, z] = turned([0.4, 0.0], arm);
        let [along, up] = found.velocity_before[2];
        assert!((along - z).abs() < 1e-14 && (up + x).abs() < 1e-14, "{along} {up}, not {z} {}", -x);
        assert_eq!(found.resting, [true, true, false], "{:?}", found.notes);
        assert_eq!(crate::support::impact::outcomes(&found)[0].impulse[2][1] > 0.0, x > 0.0);
    }
}
