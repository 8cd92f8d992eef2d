//! Mimic joints: M = T' M_all T and J = J_all T, with q and v of the joints that mimic no other.

use crate::constraints::{assert_near, assert_struck, impact, matrices, try_impact};
use crate::support::impact::{modes, robot, velocities_after};
use crate::support::mechanism::{Mechanism, point};
use crate::support::urdf::Axis;
use heelstrike::impact::Mode;
use heelstrike::pipeline::Impact;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Tolerance in eps: sums of some twenty products each, and inverses of matrices of condition below a few hundred.
const ROUNDINGS: f64 = 1e4;

/// A thigh that its shank and toe mimic on the same branch, and a tail that a slide on the other leg mimics although
/// the tail comes later.
fn mechanism() -> Mechanism {
    Mechanism::of(3.0, [0.05, 0.1], 0.2)
        .with("thigh", "root", [0.1, -0.1], 1.0, [0.0, -0.2])
        .with("shank", "thigh", [0.0, -0.4], 0.7, [0.03, -0.2])
        .following("thigh", -1.7, 0.3)
        .with("toe", "shank", [0.0, -0.4], 0.2, [0.05, 0.0])
        .following("thigh", 0.25, -0.1)
        .with("pole", "root", [-0.1, -0.1], 0.5, [0.0, -0.3])
        .following("tail", 0.125, 0.2)
        .but(|pole| pole.kind = Axis::Prismatic([0.6, -0.8]))
        .with("foot", "pole", [0.0, -0.5], 0.3, [0.1, 0.0])
        .with("tail", "thigh", [0.0, -0.1], 0.4, [-0.3, 0.0])
        .but(|tail| tail.kind = Axis::Revolute(-1.0))
}

/// The state at these coordinates of the independent joints, with contacts at toe and foot.
fn state(mechanism: &Mechanism, q: &[f64], v: &[f64]) -> Value {
    let (all, map) = mechanism.tied(q);
    let mut state = mechanism.state(0, &all, (map * DVector::from_row_slice(v)).as_slice(), &[]);
    state["contacts"] = json!([point("toe", [0.1, -0.05]), point("foot", [0.2, -0.05])]);
    state["friction"] = json!(0.7);
    state
}

fn strike(mechanism: &Mechanism, state: &Value) -> Box<Impact> {
    impact(&robot(&mechanism.urdf(0)), state)
}

const Q: [f64; 6] = [0.0, 0.6, 0.2, 0.5, -0.3, 0.8];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_matrices_are_those_of_the_velocity_map(
        q in prop::collection::vec(-3.0..3.0f64, 6),
        v in prop::collection::vec(-2.0..2.0f64, 6),
    ) {
        let mechanism = mechanism();
        let found = strike(&mechanism, &state(&mechanism, &q, &v));
        prop_assert_eq!(&matrices(&found).coordinates, &["x", "z", "pitch", "thigh", "foot", "tail"]);
        let (all, map) = mechanism.tied(&q);
        let mass = map.transpose() * mechanism.mass_matrix(&all) * &map;
        let rows = [("toe", [0.1, -0.05]), ("foot", [0.2, -0.05])];
        let rows = rows.map(|(name, offset)| mechanism.point_rates(&all, name, offset) * &map);
        let jacobian = DMatrix::from_fn(4, 6, |i, j| rows[i / 2][(i % 2, j)]);
        assert_struck(&found, &mass, &jacobian, &DVector::from_vec(v), ROUNDINGS);
        prop_assert!(found.analysis.as_ref().expect("an answer").proven);
    }
}

#[test]
fn a_held_mimicked_joint_holds_its_mimic_joints() {
    let mechanism = mechanism();
    let mut state = state(&mechanism, &Q, &[0.1, -1.0, 0.3, 0.7, -0.2, 0.4]);
    state["held"] = json!(["thigh"]);
    let found = strike(&mechanism, &state);
    assert_eq!(matrices(&found).coordinates, ["x", "z", "pitch", "foot", "tail"]);
    let (all, map) = mechanism.tied(&Q);
    let map = map.remove_column(3);
    let mass = map.transpose() * mechanism.mass_matrix(&all) * &map;
    assert_near(&matrices(&found).mass_matrix, &mass, ROUNDINGS);
    assert!(found.analysis.as_ref().expect("an answer").proven);
    assert!(velocities_after(&found).iter().all(|after| after[3] == 0.7));
}

#[test]
fn a_rotor_at_a_mimic_joint_counts_squared() {
    let mechanism = mechanism();
    let mut state = state(&mechanism, &Q, &[0.0; 6]);
    let mass = |state: &Value| matrices(&strike(&mechanism, state)).mass_matrix[3][3];
    let without = mass(&state);
    state["rotor_inertia"] = json!({"shank": 0.5, "thigh": 0.25});
    assert!((mass(&state) - without - (0.25 + 1.7 * 1.7 * 0.5)).abs() < 1e-14);
}

#[test]
fn a_mimic_joint_has_no_coordinate() {
    let state = json!({"position": {"joints": {"shank": 0.1}}, "friction": 1});
    let error = try_impact(&robot(&mechanism().urdf(0)), &state).expect_err("refused");
    assert_eq!(error.reason().to_string(), "joint \"shank\" has no coordinate: it follows joint \"thigh\"");
    assert_eq!((error.place(), error.remedy()), (Some("position.joints.shank"), Some("name thigh instead")));
}

/// Signs are proven for exactly multiplier q + offset, not for its rounding. One mimic joint turns by 3 q, and three
/// joints on it turn back by q each, so that the last link is level for every q. Its contact point, straight behind the
/// CoG of all, has no tangential velocity. Nothing couples t and n there, so that it has none after the impact: it
/// sticks without friction.
#[test]
fn the_angle_of_a_mimic_joint_is_exact() {
    let angle = 0.1_f64;
    assert_ne!(angle.mul_add(3.0, -(3.0 * angle)), 0.0, "the product is rounded");
    let lead = Mechanism::of(1.0, [0.0; 2], 0.1).with("lead", "root", [0.0; 2], 1.0, [0.0; 2]);
    let hubs =
        [("thrice", "root", 3.0), ("first", "thrice", -1.0), ("second", "first", -1.0), ("third", "second", -1.0)];
    let mechanism = hubs.into_iter().fold(lead, |mechanism, (name, parent, multiplier)| {
        mechanism.with(name, parent, [0.0; 2], 1.0, [0.0; 2]).following("lead", multiplier, 0.0)
    });
    let mut state = state(&mechanism, &[0.0, 0.0, 0.0, angle], &[0.0, -1.0, 0.7, 0.3]);
    state["contacts"] = json!([point("third", [-0.5, 0.0])]);
    state["friction"] = json!(0);
    let found = strike(&mechanism, &state);
    assert!(found.analysis.as_ref().expect("an answer").proven);
    assert_eq!(modes(&found), [[Mode::Stick]]);
}
