//! Mimic joints: M = T' M_all T and J = J_all T, with q and v of the leaders alone.

use crate::constraints::mechanism::{
    Joint, Mechanism, Part, assert_near, flat, impact, matrix, part, point, try_impact,
};
use crate::support::impact::velocities_after;
use heelstrike::impact::Mode;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use serde_json::json;

/// Rounding of sums of some twenty products each, and of their inverses; conditions are below a few hundred.
const ROUNDINGS: f64 = 1e4;

/// A thigh whose shank follows it on the same branch, a toe that follows it too, a tail that leads a slide on the other
/// leg, before which it does not stand.
fn mechanism() -> Mechanism {
    let follows = |part: Part, leader, multiplier, offset| Part { follows: Some((leader, multiplier, offset)), ..part };
    Mechanism {
        root: (3.0, [0.05, 0.1], 0.2),
        parts: vec![
            part("thigh", "root", [0.1, -0.1], 1.0, [0.0, -0.2]),
            follows(part("shank", "thigh", [0.0, -0.4], 0.7, [0.03, -0.2]), "thigh", -1.7, 0.3),
            follows(part("toe", "shank", [0.0, -0.4], 0.2, [0.05, 0.0]), "thigh", 0.25, -0.1),
            Part {
                joint: Joint::Slide([0.6, -0.8]),
                ..follows(part("pole", "root", [-0.1, -0.1], 0.5, [0.0, -0.3]), "tail", 0.125, 0.2)
            },
            part("foot", "pole", [0.0, -0.5], 0.3, [0.1, 0.0]),
            Part { joint: Joint::Turn(-1.0), ..part("tail", "thigh", [0.0, -0.1], 0.4, [-0.3, 0.0]) },
        ],
    }
}

fn strike(q: &[f64], v: &[f64]) -> serde_json::Value {
    let mut state = mechanism().state(q, v);
    state["contacts"] = json!([point("toe", [0.1, -0.05]), point("foot", [0.2, -0.05])]);
    state
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_matrices_are_those_of_the_velocity_map(
        q in prop::collection::vec(-3.0..3.0f64, 6),
        v in prop::collection::vec(-2.0..2.0f64, 6),
    ) {
        let mechanism = mechanism();
        let found = impact(&mechanism.robot(), &strike(&q, &v));
        let matrices = found.matrices.as_ref().expect("asked for");
        prop_assert_eq!(&matrices.coordinates, &["x", "z", "pitch", "thigh", "foot", "tail"]);
        let (all, map) = mechanism.tied(&q);
        let mass = map.transpose() * mechanism.mass_matrix(&all) * &map;
        let rows = [("toe", [0.1, -0.05]), ("foot", [0.2, -0.05])];
        let rows = rows.map(|(name, offset)| mechanism.point_rates(&all, name, offset) * &map);
        let jacobian = DMatrix::from_fn(4, 6, |i, j| rows[i / 2][(i % 2, j)]);
        assert_near(&matrix(&matrices.mass_matrix), &mass, ROUNDINGS);
        assert_near(&matrix(&matrices.contact_jacobian), &jacobian, ROUNDINGS);
        let inverse = mass.clone().try_inverse().expect("positive definite");
        let delassus = &jacobian * &inverse * jacobian.transpose();
        assert_near(&matrix(&matrices.delassus), &delassus, 10.0 * ROUNDINGS);

        let v = DVector::from_vec(v);
        let energy = 0.5 * v.dot(&(&mass * &v));
        prop_assert!((found.kinetic_energy - energy).abs() <= ROUNDINGS * f64::EPSILON * energy);
        let analysis = found.analysis.as_ref().expect("an answer");
        prop_assert!(analysis.proven);
        for (outcome, after) in analysis.outcomes.iter().zip(velocities_after(&found)) {
            let expected = &v + &inverse * jacobian.transpose() * flat(&outcome.impulse);
            let error = (DVector::from_vec(after.clone()) - &expected).amax() / expected.amax();
            prop_assert!(error < 100.0 * ROUNDINGS * f64::EPSILON, "{error:e}");
        }
    }
}

/// The same robot with all joints free gives M_all, which T reduces.
#[test]
fn tying_by_the_tool_s_own_free_matrices_gives_the_same() {
    let tied = mechanism();
    let mut free = tied.clone();
    free.parts.iter_mut().for_each(|part| part.follows = None);
    let q = [0.0, 0.6, 0.2, 0.5, -0.3, 0.8];
    let (all, map) = tied.tied(&q);
    let mut state = free.state(&all, &[0.0; 9]);
    state["contacts"] = json!([point("toe", [0.1, -0.05]), point("foot", [0.2, -0.05])]);
    let free = impact(&free.robot(), &state).matrices.expect("asked for");
    let found = impact(&tied.robot(), &strike(&q, &[0.0; 6])).matrices.expect("asked for");
    assert_near(&matrix(&found.mass_matrix), &(map.transpose() * matrix(&free.mass_matrix) * &map), ROUNDINGS);
    assert_near(&matrix(&found.contact_jacobian), &(matrix(&free.contact_jacobian) * &map), ROUNDINGS);
}

/// A rod of mass m and length l on a floating hub of mass m, and a second rod on its end that follows with multiplier
/// -2 (a folding leg). By hand, at the posture q = 0 with both rods straight down, rods with their mass in the far end:
/// with hip rate w, the first turns at w and the second at -w; their ends move forward at -l w and -l w + l w = 0. So
/// M_qq = m l^2, M_xq = -m l, M_xx = 3 m.
#[test]
fn a_folding_leg_by_hand() {
    let (m, l) = (2.0, 0.5);
    let rod = |name, parent, origin| Part { moment: 0.0, ..part(name, parent, origin, m, [0.0, -l]) };
    let mechanism = Mechanism {
        root: (m, [0.0, 0.0], 1.0),
        parts: vec![
            rod("hip", "root", [0.0, 0.0]),
            Part { follows: Some(("hip", -2.0, 0.0)), ..rod("knee", "hip", [0.0, -l]) },
        ],
    };
    let found = impact(&mechanism.robot(), &mechanism.state(&[0.0; 4], &[0.0; 4]));
    let mass = found.matrices.expect("asked for").mass_matrix;
    // Pitching the whole at w moves the ends at -l w and -2 l w: M_pitch,q = m (l l + 0).
    assert_eq!(mass[3], [-m * l, 0.0, m * l * l, m * l * l]);
    assert_eq!(mass[0][0], 3.0 * m);
}

#[test]
fn a_held_leader_holds_its_followers() {
    let mechanism = mechanism();
    let mut state = strike(&[0.0, 0.6, 0.2, 0.5, -0.3, 0.8], &[0.1, -1.0, 0.3, 0.7, -0.2, 0.4]);
    state["held"] = json!(["thigh"]);
    let found = impact(&mechanism.robot(), &state);
    let matrices = found.matrices.as_ref().expect("asked for");
    assert_eq!(matrices.coordinates, ["x", "z", "pitch", "foot", "tail"]);
    let (all, map) = mechanism.tied(&[0.0, 0.6, 0.2, 0.5, -0.3, 0.8]);
    let map = map.remove_column(3);
    assert_near(&matrix(&matrices.mass_matrix), &(map.transpose() * mechanism.mass_matrix(&all) * &map), ROUNDINGS);
    let analysis = found.analysis.as_ref().expect("an answer");
    assert!(analysis.proven);
    assert!(velocities_after(&found).iter().all(|after| after[3] == 0.7));
}

#[test]
fn a_rotor_at_a_follower_counts_by_the_square_of_its_multiplier() {
    let mechanism = mechanism();
    let mut state = strike(&[0.0, 0.6, 0.2, 0.5, -0.3, 0.8], &[0.0; 6]);
    let without = impact(&mechanism.robot(), &state).matrices.expect("asked for").mass_matrix;
    state["rotor_inertia"] = json!({"shank": 0.5, "thigh": 0.25});
    let with = impact(&mechanism.robot(), &state).matrices.expect("asked for").mass_matrix;
    assert!((with[3][3] - without[3][3] - (0.25 + 1.7 * 1.7 * 0.5)).abs() < 1e-14);
}

#[test]
fn a_follower_has_no_coordinate() {
    let mechanism = mechanism();
    let robot = mechanism.robot();
    let state = json!({"position": {"joints": {"shank": 0.1}}, "friction": 1});
    let error = try_impact(&robot, &state).expect_err("refused");
    assert_eq!(
        (error.place(), error.reason().to_string().as_str(), error.remedy()),
        (
            Some("position.joints.shank"),
            "joint \"shank\" has no coordinate: it follows joint \"thigh\"",
            Some("name thigh instead")
        )
    );
}

/// Signs are proven for exactly multiplier q + offset, not for its rounding: one follower turns by 3 q, three on it
/// turn back by q each, so that the last is level for every q. Its point, straight behind the CoG of all, then has no
/// tangential velocity at all and, since nothing couples t and n there, neither has it after the impact: frictionless,
/// it sticks.
#[test]
fn the_angle_of_a_follower_is_exact() {
    let angle = 0.1_f64;
    assert_ne!(angle.mul_add(3.0, -(3.0 * angle)), 0.0, "the product is rounded");
    let hub = |name, parent, multiplier| Part {
        follows: Some(("lead", multiplier, 0.0)),
        ..part(name, parent, [0.0, 0.0], 1.0, [0.0, 0.0])
    };
    let mechanism = Mechanism {
        root: (1.0, [0.0, 0.0], 0.1),
        parts: vec![
            part("lead", "root", [0.0, 0.0], 1.0, [0.0, 0.0]),
            hub("thrice", "root", 3.0),
            hub("first", "thrice", -1.0),
            hub("second", "first", -1.0),
            hub("third", "second", -1.0),
        ],
    };
    let mut state = mechanism.state(&[0.0, 0.0, 0.0, angle], &[0.0, -1.0, 0.7, 0.3]);
    state["contacts"] = json!([point("third", [-0.5, 0.0])]);
    state["friction"] = json!(0);
    let analysis = impact(&mechanism.robot(), &state).analysis.expect("an answer");
    assert!(analysis.proven);
    assert_eq!(analysis.outcomes.iter().map(|outcome| outcome.modes.clone()).collect::<Vec<_>>(), [[Mode::Stick]]);
}
