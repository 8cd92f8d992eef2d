//! A four-bar by hand: a parallelogram of two cranks of length l and mass m on the ground, and a coupler of mass m_c
//! that therefore does not turn. With both cranks at the angle q (positive: their ends swing back) the coupler moves at
//! l q' (-cos q, sin q), so that
//!
//! ```text
//!     M = (2/3 m + m_c) l^2        G = l^2 d d' / M,  d = (-cos q, sin q)
//! ```
//!
//! (rods of moment m l^2 / 12 about their middle). At friction 0 a coupler that comes down stops: L_n = -M q' / (l sin
//! q). The pin at crank 2 gives it f: the coupler's moments about its middle and its momentum along z are a_z + f_z = 0
//! and m_c dv_z = a_z - f_z + L_n (a from crank 1; L_n goes through the middle), so f_z = (L_n - m_c dv_z) / 2; the
//! crank's moment about its pivot, m l^2 / 3 dq' = l f . d, gives f_x.

use crate::constraints::{impact, matrices};
use crate::support::impact::{loop_impulses, reduced, velocities_after};
use crate::support::mechanism::{Mechanism, Point, point};
use crate::support::urdf::Axis;
use heelstrike::impact::Mode;
use heelstrike::pipeline::Impact;
use heelstrike::robot::{Base, Reduction, Robot};
use serde_json::{Value, json};

pub const L: f64 = 0.5;
pub const M: f64 = 1.5;
pub const M_COUPLER: f64 = 2.0;
pub const WIDTH: f64 = 0.8;

pub const CRANKS: [(&str, f64); 2] = [("front", 0.0), ("rear", WIDTH)];

/// Adds a rod of mass M and length L.
fn rod(mechanism: Mechanism, name: &str, parent: &str, origin: Point) -> Mechanism {
    mechanism.with(name, parent, origin, M, [0.0, -0.5 * L]).but(|rod| rod.moment = M * L * L / 12.0)
}

/// Cranks that hang from the root at these places, and a coupler on the first, whose middle is `WIDTH` / 2 ahead of it.
pub fn parallelogram(cranks: &[(&str, f64)]) -> Mechanism {
    let root = Mechanism::of(1.0, [0.0; 2], 1.0);
    let hung = cranks.iter().fold(root, |mechanism, &(name, x)| rod(mechanism, name, "root", [x, 0.0]));
    hung.with("coupler", cranks[0].0, [0.0, -L], M_COUPLER, [0.5 * WIDTH, 0.0])
}

pub fn bolted(mechanism: &Mechanism) -> Robot {
    reduced(&mechanism.urdf(0), &Reduction { base: Some(Base::Fixed), ..Reduction::default() })
}

/// The state with all cranks at q and q', a level coupler, and a contact point below the coupler's middle.
pub fn state(mechanism: &Mechanism, q: f64, rate: f64, loops: Value) -> Value {
    let joints = |value: f64| {
        let value = |name: &String| if name == "coupler" { -value } else { value };
        let joints: Value =
            mechanism.links[1..].iter().map(|link| (link.name.clone(), json!(value(&link.name)))).collect();
        json!({"joints": joints})
    };
    json!({"position": joints(q), "velocity": joints(rate), "friction": 0, "loops": loops,
        "contacts": [point("coupler", [0.5 * WIDTH, -0.1])]})
}

/// The loop that joins the end of a crank, whose pivot is at `x`, to the coupler.
pub fn pin(crank: &str, x: f64) -> Value {
    json!({"a": point(crank, [0.0, -L]), "b": point("coupler", [x, 0.0])})
}

/// Asserts that G is d d' times `expected`.
#[track_caller]
fn assert_delassus(found: &Impact, q: f64, expected: f64) {
    let direction = [-q.cos(), q.sin()];
    for (row, along) in matrices(found).delassus.iter().zip(direction) {
        for (entry, across) in row.iter().zip(direction) {
            assert!((entry - expected * along * across).abs() < 1e-14, "{entry}");
        }
    }
}

/// Asserts the impulse on the only loop.
#[track_caller]
fn assert_loop(found: &Impact, [x, z]: Point) {
    let [[found_x, found_z]] = loop_impulses(found)[0][..] else { panic!("{:?}", loop_impulses(found)) };
    assert!((found_x - x).abs() < 1e-13 && (found_z - z).abs() < 1e-13, "{found_x} {found_z}, not {x} {z}");
}

/// Asserts the impulse and rates of the only outcome for this many cranks, and returns the normal impulse.
#[track_caller]
pub fn assert_stops(found: &Impact, q: f64, rate: f64, cranks: f64) -> f64 {
    let mass = (cranks * M / 3.0 + M_COUPLER) * L * L;
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    assert_delassus(found, q, L * L / mass);
    let analysis = found.analysis.as_ref().expect("an answer");
    assert!(analysis.proven);
    let [outcome] = &analysis.outcomes[..] else { panic!("{:?}", analysis.outcomes) };
    assert_eq!(outcome.modes, [Mode::Stick]);
    let normal = -mass * rate / (L * q.sin());
    near(outcome.impulse[0][1], normal);
    velocities_after(found)[0].iter().for_each(|after| near(*after, 0.0));
    normal
}

#[test]
fn a_parallelogram_strikes_the_ground_as_on_paper() {
    let mechanism = parallelogram(&CRANKS);
    let robot = bolted(&mechanism);
    // sin q > 0 and q' < 0: it comes down.
    let (q, rate) = (0.6, -2.0);
    let found = impact(&robot, &state(&mechanism, q, rate, json!([pin("rear", WIDTH)])));
    let normal = assert_stops(&found, q, rate, 2.0);
    // The impulse f of the coupler on the rear crank. Both rates go from `rate` to zero.
    let change = -rate;
    let f_z = 0.5 * (normal - M_COUPLER * L * change * q.sin());
    let f_x = (M * L * change / 3.0 - f_z * q.sin()) / -q.cos();
    assert_loop(&found, [f_x, f_z]);
}

#[test]
fn a_rod_pinned_by_a_loop_is_a_pendulum() {
    // In the tree the rod's hinge can slide; the loop pins its upper end to the root. At its free end, at the angle q,
    // G = l^2 d d' / (m l^2 / 3) with d as above.
    let mechanism = Mechanism::of(1.0, [0.0; 2], 1.0)
        .with("along", "root", [0.0; 2], 0.0, [0.0; 2])
        .but(|link| link.kind = Axis::Prismatic([1.0, 0.0]))
        .with("up", "along", [0.0; 2], 0.0, [0.0; 2])
        .but(|link| link.kind = Axis::Prismatic([0.0, 1.0]));
    let mechanism = rod(mechanism, "rod", "up", [0.0; 2]);
    let (q, rate) = (0.6_f64, -2.0);
    let state = json!({"position": {"joints": {"rod": q}}, "velocity": {"joints": {"rod": rate}}, "friction": 0,
        "loops": [{"a": point("rod", [0.0; 2]), "b": point("root", [0.0; 2])}], "contacts": [point("rod", [0.0, -L])]});
    let found = impact(&bolted(&mechanism), &state);
    assert_delassus(&found, q, 3.0 / M);
    // The momentum that the rod's middle gains comes from the ground and the pivot together.
    let analysis = found.analysis.as_ref().expect("an answer");
    let normal = analysis.outcomes[0].impulse[0][1];
    let [x, z] = [-q.cos(), q.sin()].map(|along| M * 0.5 * L * -rate * along);
    assert_loop(&found, [x, z - normal]);
}
