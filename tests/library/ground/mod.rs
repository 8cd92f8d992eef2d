//! Ground profiles: where feet touch steps, edges, notches and gaps, with which normals, and with which outcomes,
//! compared with cases worked out by hand.
//!
//! Signs: x forward, z up, a positive pitch dips the nose; a body that turns at w moves its point at (x, z) from the
//! CoG at w (z, -x), and an impulse (Lx, Lz) there turns it by I w = z Lx - x Lz.

mod by_hand;
mod corners;
mod depth;
mod invariances;
mod level;
mod nearest;
mod scenes;
mod soles;

use crate::support::impact::{impact, modes, outcomes, robot, try_impact, velocities_after};
use crate::support::scaled::near;
use crate::support::urdf;
use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options};
use heelstrike::planar::Vector;
use heelstrike::{Reason, Robot};
use serde_json::{Value, json};

/// A body of 2 kg and 0.5 kg m^2 with one collision shape.
fn body(shape: &str) -> Robot {
    robot(&urdf::body(0.5, &format!("<collision>{shape}</collision>")))
}

/// A box 0.4 m long and 0.2 m high.
fn sole() -> Robot {
    body(r#"<geometry><box size="0.4 0.1 0.2"/></geometry>"#)
}

/// A disc of radius 0.5 m.
fn disc() -> Robot {
    body(r#"<geometry><sphere radius="0.5"/></geometry>"#)
}

fn point() -> Robot {
    body(r#"<geometry><sphere radius="0"/></geometry>"#)
}

/// The state of a body at `[x, z, pitch]` with velocity `[x, z, pitch]` over a profile.
fn state(position: [f64; 3], velocity: [f64; 3], friction: impl Into<Value>, profile: &[[f64; 2]]) -> Value {
    let base = |[x, z, pitch]: [f64; 3]| json!({"base": {"x": x, "z": z, "pitch": pitch}});
    json!({"position": base(position), "velocity": base(velocity), "friction": friction.into(),
        "ground": {"profile": profile}})
}

const FALLING: [f64; 3] = [0.0, -1.0, 0.0];

/// Asserts equality to 64 eps, the rounding of a few operations on numbers of order one.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64]) {
    assert!(near(found, expected, 64.0 * f64::EPSILON), "{found:?} is not {expected:?}");
}

/// The point and the normal of each contact.
fn touches(impact: &Impact) -> Vec<[[f64; 2]; 2]> {
    impact.contacts.iter().map(|contact| [contact.point, contact.normal()].map(Vector::components)).collect()
}

#[track_caller]
fn assert_touches(impact: &Impact, expected: &[[[f64; 2]; 2]]) {
    assert_close(touches(impact).as_flattened().as_flattened(), expected.as_flattened().as_flattened());
}

/// The impulses and the velocity by coordinate of the only outcome, which must be proven.
fn only_outcome(impact: &Impact) -> (&[[f64; 2]], Vec<f64>) {
    let analysis = impact.analysis.as_ref().expect("an analysis");
    assert_eq!(analysis.verdict, Verdict::Unique);
    assert!(analysis.proven);
    (&analysis.outcomes[0].impulse, analysis.outcomes[0].velocity().collect())
}

fn depth(robot: &Robot, state: &Value) -> f64 {
    let error = try_impact(robot, Options::default(), state).expect_err("too deep");
    let Reason::Penetration { link, depth, .. } = error.reason() else { panic!("{error}") };
    assert_eq!(link, "body");
    *depth
}

/// The profile of a step of this rise at x = `edge`; its riser is 1e-6 m wide.
fn step(edge: f64, rise: f64) -> [[f64; 2]; 4] {
    [[-2.0, 0.0], [edge, 0.0], [edge + 1e-6, rise], [2.0, rise]]
}

#[track_caller]
fn assert_same_outcomes(one: &Impact, other: &Impact) {
    let verdict = |impact: &Impact| impact.analysis.as_ref().expect("an analysis").verdict;
    assert_eq!(verdict(one), verdict(other));
    assert_eq!(outcomes(one).len(), outcomes(other).len());
    let velocities = velocities_after(one).into_iter().zip(velocities_after(other));
    for ((a, b), (before, after)) in outcomes(one).iter().zip(outcomes(other)).zip(velocities) {
        assert_eq!(a.modes, b.modes);
        assert!(near(a.impulse.as_flattened(), b.impulse.as_flattened(), 1e-12), "{:?} {:?}", a.impulse, b.impulse);
        assert!(near(&before, &after, 1e-12), "{before:?} {after:?}");
    }
}
