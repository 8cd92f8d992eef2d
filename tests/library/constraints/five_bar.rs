//! A five-bar leg (torso, two thighs, two shanks), which the tree has to cut open, compared with reduced coordinates of
//! the closed leg: the dependent rates are solved for (implicit differentiation), v = T v_red with T = [1; -K_d^-1
//! K_i].

use crate::constraints::{assert_near, flat, impact, matrices};
use crate::support::impact::{loop_impulses, modes, outcomes, robot, velocities_after};
use crate::support::mechanism::{Mechanism, Point, point};
use crate::support::scaled::{matrix, near};
use heelstrike::pipeline::Impact;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Tolerance in eps: sums of some twenty products, inverses of matrices of condition below a few thousand.
const ROUNDINGS: f64 = 1e5;

const THIGH: f64 = 0.4;
const SHANK: f64 = 0.5;
const WIDTH: f64 = 0.2;

/// Adds both thighs and the left shank of a leg that hangs this far behind the root's middle.
fn open_leg(mechanism: Mechanism, leg: &str, behind: f64) -> Mechanism {
    let left = format!("{leg}left_thigh");
    mechanism
        .with(&left, "root", [-0.5 * WIDTH - behind, 0.0], 0.8, [0.01, -0.15])
        .with(&format!("{leg}left_shank"), &left, [0.0, -THIGH], 0.4, [0.0, -0.2])
        .with(&format!("{leg}right_thigh"), "root", [0.5 * WIDTH - behind, 0.0], 0.7, [-0.01, -0.18])
}

/// Adds a whole leg. The pin joins the ends of its shanks; the foot is the end of the left one.
fn with_leg(mechanism: Mechanism, leg: &str, behind: f64) -> Mechanism {
    let (thigh, shank) = (format!("{leg}right_thigh"), format!("{leg}right_shank"));
    open_leg(mechanism, leg, behind).with(&shank, &thigh, [0.0, -THIGH], 0.3, [0.02, -0.25])
}

fn root() -> Mechanism {
    Mechanism::of(5.0, [0.02, 0.15], 0.3)
}

fn cut_at_the_pin() -> Mechanism {
    with_leg(root(), "", 0.0)
}

/// The same leg with the pin as a joint and the right knee open: the right shank is attached to the left one's end.
fn cut_at_the_knee() -> Mechanism {
    open_leg(root(), "", 0.0).with("right_shank", "left_shank", [0.0, -SHANK], 0.3, [0.02, SHANK - 0.25])
}

/// Ends of the loop: (link, point) of a and b.
type Ends = [(&'static str, Point); 2];
const PIN: Ends = [("left_shank", [0.0, -SHANK]), ("right_shank", [0.0, -SHANK])];
const HIND_PIN: Ends = [("hind_left_shank", [0.0, -SHANK]), ("hind_right_shank", [0.0, -SHANK])];
const KNEE: Ends = [("right_thigh", [0.0, -THIGH]), ("right_shank", [0.0, SHANK])];

/// The coordinates of the tree that is cut at the pin, from the pitch and the angles of both thighs: the foot is where
/// two circles about the knees meet.
fn closed(pitch: f64, left: f64, right: f64) -> Vec<f64> {
    let down = |angle: f64, length: f64| [-length * f64::sin(angle), -length * f64::cos(angle)];
    let [a, b] = [(-0.5 * WIDTH, left), (0.5 * WIDTH, right)].map(|(x, angle)| {
        let [dx, dz] = down(angle, THIGH);
        [x + dx, dz]
    });
    let apart = [b[0] - a[0], b[1] - a[1]];
    let distance = apart[0].hypot(apart[1]);
    let drop = (SHANK * SHANK - 0.25 * distance * distance).sqrt();
    // The intersection below the knees.
    let foot = [0.5 * (a[0] + b[0]) + drop * apart[1] / distance, 0.5 * (a[1] + b[1]) - drop * apart[0] / distance];
    let angle = |knee: [f64; 2]| f64::atan2(-(foot[0] - knee[0]), -(foot[1] - knee[1]));
    vec![0.3, 0.9, pitch, left, angle(a) - left, right, angle(b) - right]
}

/// The rows K = J_a - J_b of the loop.
fn loop_rows(mechanism: &Mechanism, q: &[f64], [a, b]: Ends) -> DMatrix<f64> {
    mechanism.point_rates(q, a.0, a.1) - mechanism.point_rates(q, b.0, b.1)
}

/// T, from the rates of x, z, pitch and both thighs (columns 3 and 5) to those of the tree.
fn velocity_map(rows: &DMatrix<f64>) -> DMatrix<f64> {
    let (kept, solved) = ([0, 1, 2, 3, 5], [4, 6]);
    let dependent = rows.select_columns(&solved).try_inverse().expect("bent knees") * rows.select_columns(&kept);
    DMatrix::from_fn(7, 5, |i, j| match solved.iter().position(|&row| row == i) {
        Some(row) => -dependent[(row, j)],
        None => f64::from(kept[j] == i),
    })
}

fn named(ends: Ends) -> Value {
    let [a, b] = ends.map(|(link, offset)| point(link, offset));
    json!({"a": a, "b": b})
}

const FEET: [(&str, [f64; 2]); 2] = [("left_shank", [0.0, -SHANK]), ("root", [0.3, -0.5])];

/// J of the feet.
fn jacobian(mechanism: &Mechanism, q: &[f64]) -> DMatrix<f64> {
    let feet = FEET.map(|(name, offset)| mechanism.point_rates(q, name, offset));
    DMatrix::from_fn(4, q.len(), |i, j| feet[i / 2][(i % 2, j)])
}

fn state(mechanism: &Mechanism, q: &[f64], v: &[f64], loops: &[Ends]) -> Value {
    let mut state = mechanism.state(0, q, v, &[]);
    state["friction"] = json!(0.7);
    state["contacts"] = FEET.map(|(link, offset)| point(link, offset)).into_iter().collect();
    state["loops"] = loops.iter().copied().map(named).collect();
    state
}

fn strike(mechanism: &Mechanism, q: &[f64], v: &[f64], loops: &[Ends]) -> Box<Impact> {
    proven(impact(&robot(&mechanism.urdf(0)), &state(mechanism, q, v, loops)))
}

/// Random q and v of the tree that is cut at the pin, which keep its loop closed.
fn case() -> impl Strategy<Value = (Vec<f64>, DVector<f64>)> {
    let rates = prop::array::uniform5(-1.0..1.0f64);
    (-0.5..0.5f64, -0.2..0.7f64, -0.7..0.2f64, rates)
        .prop_map(|(pitch, left, right, rates)| kept(closed(pitch, left, right), rates))
}

fn kept(q: Vec<f64>, rates: [f64; 5]) -> (Vec<f64>, DVector<f64>) {
    let v = velocity_map(&loop_rows(&cut_at_the_pin(), &q, PIN)) * DVector::from_row_slice(&rates);
    (q, v)
}

fn proven(found: Box<Impact>) -> Box<Impact> {
    assert!(found.analysis.as_ref().expect("an answer").proven);
    found
}

#[track_caller]
fn assert_vectors_near(found: &[f64], expected: &[f64], size: f64) {
    assert!(near(found, expected, ROUNDINGS * f64::EPSILON * size), "{found:?} {expected:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn the_leg_strikes_as_without_the_loop((q, v) in case()) {
        let mechanism = cut_at_the_pin();
        let rows = loop_rows(&mechanism, &q, PIN);
        let map = velocity_map(&rows);
        let found = strike(&mechanism, &q, v.as_slice(), &[PIN]);
        let matrices = matrices(&found);

        // M and J are those of the open tree.
        let (mass, jacobian) = (mechanism.mass_matrix(&q), jacobian(&mechanism, &q));
        assert_near(&matrices.mass_matrix, &mass, ROUNDINGS);
        assert_near(&matrices.contact_jacobian, &jacobian, ROUNDINGS);
        // G is that of the closed leg in reduced coordinates.
        let reduced = (map.transpose() * &mass * &map).try_inverse().expect("positive definite");
        let feet = &jacobian * &map;
        assert_near(&matrices.delassus, &(&feet * &reduced * feet.transpose()), ROUNDINGS);

        let energy = 0.5 * v.dot(&(&mass * &v));
        prop_assert!((found.kinetic_energy - energy).abs() <= ROUNDINGS * f64::EPSILON * energy);
        for ((outcome, after), loops) in outcomes(&found).iter().zip(velocities_after(&found)).zip(loop_impulses(&found)) {
            let (after, impulse) = (DVector::from_vec(after), flat(&outcome.impulse));
            let size = after.amax().max(v.amax());
            // v+ = T (v_red + M_red^-1 J_red' L).
            let expected = &v + &map * &reduced * feet.transpose() * &impulse;
            assert_vectors_near(after.as_slice(), expected.as_slice(), size);
            assert_vectors_near((&rows * &after).as_slice(), &[0.0; 2], size);
            // M (v+ - v-) = J' L + K' l.
            let given = jacobian.transpose() * &impulse + rows.transpose() * flat(&loops);
            assert_vectors_near((&mass * (&after - &v)).as_slice(), given.as_slice(), 10.0 * size);
            // Impulses of loops do no work.
            let left = 0.5 * after.dot(&(&mass * &after));
            prop_assert!((energy - left - outcome.energy_loss).abs() <= ROUNDINGS * f64::EPSILON * energy);
        }
    }

    #[test]
    fn where_the_loop_is_cut_does_not_matter((q, v) in case()) {
        let one = strike(&cut_at_the_pin(), &q, v.as_slice(), &[PIN]);
        // The right shank's coordinate is now its angle from the left shank.
        let turned = |list: &[f64]| {
            let mut list = list.to_vec();
            list[6] = list[5] + list[6] - list[3] - list[4];
            list
        };
        let other = strike(&cut_at_the_knee(), &turned(&q), &turned(v.as_slice()), &[KNEE]);
        prop_assert_eq!(modes(&one), modes(&other));
        assert_near(&matrices(&other).delassus, &matrix(&matrices(&one).delassus), ROUNDINGS);
        for (one, other) in velocities_after(&one).iter().zip(velocities_after(&other)) {
            assert_vectors_near(&other, &turned(one), 10.0);
        }
    }

    /// Two five-bar legs, one behind the other: the order of loops and of their ends changes only the order and the
    /// sign of their impulses.
    #[test]
    fn loop_impulses_follow_order_and_ends((q, v) in case()) {
        let mechanism = with_leg(cut_at_the_pin(), "hind_", 0.7);
        let both = |list: &[f64]| [list, &list[3..]].concat();
        let loops = [[PIN, HIND_PIN], [HIND_PIN, [PIN[1], PIN[0]]]];
        let [one, other] = loops.map(|loops| strike(&mechanism, &both(&q), &both(v.as_slice()), &loops));
        prop_assert_eq!(modes(&one), modes(&other));
        for (one, other) in loop_impulses(&one).iter().zip(loop_impulses(&other)) {
            assert_vectors_near(&[other[1].map(|entry| -entry), other[0]].concat(), &one.concat(), 10.0);
        }
        for (one, other) in velocities_after(&one).iter().zip(velocities_after(&other)) {
            assert_vectors_near(&other, one, 10.0);
        }
    }

    /// An impulse on a link of the loop leaves the velocity that it gives the closed leg in reduced coordinates.
    #[test]
    fn applied_impulses_act_through_the_loop((q, v) in case(), push in prop::array::uniform2(-2.0..2.0f64)) {
        let mechanism = cut_at_the_pin();
        let map = velocity_map(&loop_rows(&mechanism, &q, PIN));
        let mut state = state(&mechanism, &q, v.as_slice(), &[PIN]);
        state["contacts"] = json!([]);
        let mut applied = point("right_shank", [0.1, -0.2]);
        applied["vector"] = json!(push);
        state["impulse"] = json!([applied]);
        let found = impact(&robot(&mechanism.urdf(0)), &state);
        let mass = mechanism.mass_matrix(&q);
        let reduced = (map.transpose() * &mass * &map).try_inverse().expect("positive definite");
        let arm = mechanism.point_rates(&q, "right_shank", [0.1, -0.2]) * &map;
        let expected = &v + &map * reduced * arm.transpose() * DVector::from_row_slice(&push);
        assert_vectors_near(&velocities_after(&found)[0], expected.as_slice(), 10.0);
        prop_assert_eq!(loop_impulses(&found)[0].len(), 1);
    }

    /// With a stance, the rates that close a loop are taken from the joints, and the foot stays at rest.
    #[test]
    fn a_stance_rests_although_its_leg_is_closed((q, mut v) in case(), noise in -1e-4..1e-4f64) {
        let mechanism = cut_at_the_pin();
        v[4] += noise;
        let mut state = state(&mechanism, &q, v.as_slice(), &[PIN]);
        state["stance"] = json!("left_shank");
        for field in ["position", "velocity"] {
            state[field]["base"] = json!({"pitch": state[field]["base"]["pitch"]});
        }
        let found = proven(impact(&robot(&mechanism.urdf(0)), &state));
        prop_assert_eq!(found.velocity_before[0], [0.0; 2]);
        for after in velocities_after(&found) {
            let opens = loop_rows(&mechanism, &q, PIN) * DVector::from_vec(after);
            assert_vectors_near(opens.as_slice(), &[0.0; 2], 10.0);
        }
    }
}

#[test]
fn a_rate_with_noise_is_mended_by_the_least_energy() {
    let mechanism = cut_at_the_pin();
    let (q, mut v) = kept(closed(0.1, 0.4, -0.3), [0.2, -1.0, 0.3, 0.5, -0.4]);
    v[6] += 1e-3;
    let found = impact(&robot(&mechanism.urdf(0)), &state(&mechanism, &q, v.as_slice(), &[PIN]));
    let note = &found.notes[0];
    assert!(note.starts_with("loops[0] (left_shank - right_shank) opens at 5.0e-4 m/s before the impact"), "{note}");
    let (rows, mass) = (loop_rows(&mechanism, &q, PIN), mechanism.mass_matrix(&q));
    let inverse = mass.try_inverse().expect("positive definite");
    let mobility = (&rows * &inverse * rows.transpose()).try_inverse().expect("independent rows");
    let mended = &v - inverse * rows.transpose() * mobility * &rows * &v;
    let expected = jacobian(&mechanism, &q) * mended;
    assert_vectors_near(found.velocity_before.as_flattened(), expected.as_slice(), 10.0);
}
