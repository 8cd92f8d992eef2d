//! Regions thinner than the grid of samples, whose places are known in closed form.
//!
//! ```text
//!     two straight legs, m = l = 1, CoG a from the hip, inertia j, infinite friction, u = cos 2 alpha, k = a (1 - a):
//!
//!     lift-off is valid   where   N(u) = (k - j)^2 - k (1 - u^2) + j (1 + u) > 0
//!     stop is valid       where   u < (k - j) / (1 - a)
//! ```
//!
//! By hand from M (v+ - v-) = J^T L with both feet down (stop: L_n = 0 of the trailing foot), and with the leading one
//! alone (lift-off: c_n+ = 0 of the trailing foot). Where neither is valid the trailing foot slides, and where both
//! are, it does as well: three outcomes.

use crate::support::command::file;
use crate::support::urdf::{body, collision};
use crate::sweep::command::{RANGE, Sweep, assert_begins, straight, sweep, written};
use serde_json::json;

/// a and k of `urdf/pdw.urdf`.
const A: f64 = 0.4;
const K: f64 = A * (1.0 - A);

const LIFT_OFF: &str = "separate/stick";
const SLIDE: &str = "slide-/stick";
const STOP: &str = "stick/stick";
const ALL: &str = "separate/stick|slide+/stick|stick/stick";

fn walker(j: f64) -> Sweep {
    sweep("urdf/pdw.urdf", &straight(Some(j)))
}

/// The leg angle of u = cos 2 alpha.
fn alpha(u: f64) -> f64 {
    0.5 * u.acos()
}

/// The zeros u of N, that of the smaller leg angle first; `None` if there are none.
fn lift_off_ends(j: f64) -> Option<[f64; 2]> {
    let root = discriminant(j).sqrt();
    (!root.is_nan()).then(|| [root, -root].map(|root| (root - j) / (2.0 * K)))
}

fn discriminant(j: f64) -> f64 {
    j * j - 4.0 * K * ((K - j) * (K - j) - K + j)
}

fn stop_begins(j: f64) -> f64 {
    (K - j) / (1.0 - A)
}

/// The regions that begin in the range.
fn within_range<const N: usize>(begins: [(f64, &'static str); N]) -> Vec<(f64, &'static str)> {
    begins.into_iter().filter(|(begin, _)| *begin < RANGE[1]).collect()
}

/// The band of sliding closes at j = k, where its borders, of two different inequalities, cross; its width is about
/// 1.25 (k - j).
#[test]
fn a_band_between_crossing_inequalities_is_found() {
    for off in [1e-2, 1e-3, 1e-4, 4e-6, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
        let j = K - off;
        let [first, last] = lift_off_ends(j).expect("it ends and begins again");
        let expected =
            within_range([(0.0, LIFT_OFF), (alpha(first), SLIDE), (alpha(stop_begins(j)), STOP), (alpha(last), ALL)]);
        let width = expected[2].0 - expected[1].0;
        assert!((0.8..1.5).contains(&(width / off)), "{width}");
        let sweep = walker(j);
        // Tolerance: 1e-12 of the range, and the rounding of numbers of about 1.
        assert_begins(&format!("a band of {width:.1e}"), &sweep, &expected, 4e-12);
        let found = sweep.regions[1].to - sweep.regions[1].from;
        assert!((found - width).abs() < 4e-12, "{found} instead of {width}");
    }
}

/// Beyond j = k the first band is one of three outcomes.
#[test]
fn a_thin_band_of_three_outcomes_is_found() {
    for off in [1e-2, 4e-6, 1e-8, 1e-10] {
        let j = K + off;
        let [first, last] = lift_off_ends(j).expect("it ends and begins again");
        let expected =
            within_range([(0.0, LIFT_OFF), (alpha(stop_begins(j)), ALL), (alpha(first), STOP), (alpha(last), ALL)]);
        assert_begins(&format!("{off:.0e}"), &walker(j), &expected, 4e-12);
    }
}

/// The band without lift-off vanishes where the two zeros of N meet. It opens at an extremum of N, as wide as the
/// square root of the distance from there.
#[test]
fn a_band_that_opens_by_an_extremum_is_found() {
    // A zero of N's discriminant (1 - 4 k) j^2 + (8 k^2 - 4 k) j + 4 k^2 - 4 k^3.
    let (two, one, zero) = (1.0 - 4.0 * K, 8.0 * K * K - 4.0 * K, 4.0 * K * K * (1.0 - K));
    let merged = (-one - (one * one - 4.0 * two * zero).sqrt()) / (2.0 * two);
    assert!(discriminant(merged).abs() < 1e-15, "{merged}");
    for off in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 3e-14] {
        let j = merged - off;
        let [first, last] = lift_off_ends(j).expect("it ends and begins again").map(alpha);
        let expected = [(0.0, LIFT_OFF), (alpha(stop_begins(j)), ALL), (first, STOP), (last, ALL)];
        let width = last - first;
        // Near a double root: an error of a few 1e-16 in N moves both ends by this error divided by the width.
        let within = 2e-15 / width + 4e-12;
        assert!(within < 0.1 * width, "{width}");
        assert_begins(&format!("a band of {width:.1e}"), &walker(j), &expected, within);
    }
    // Beyond that there is no band.
    for off in [1e-12, 1e-6] {
        let j = merged + off;
        assert_eq!(lift_off_ends(j), None);
        let expected = [(0.0, LIFT_OFF), (alpha(stop_begins(j)), ALL)];
        assert_begins("no band", &walker(j), &expected, 4e-12);
    }
}

const BLOCK: &str = "urdf/block.urdf";

/// The places where the regions of a block begin that has this height and this vertical velocity.
fn of_block(z: &str, rate: &str, arguments: &[&str]) -> Vec<f64> {
    let study = json!({"parameters": {"s": {"from": -1, "to": 1, "steps": 51}}, "state": {"friction": 0.9,
        "position": {"base": {"z": z}}, "velocity": {"base": {"x": 0.5, "z": rate}}}});
    written::<Sweep>(BLOCK, &study, arguments).regions.iter().map(|region| region.from).collect()
}

/// A foot touches the ground for a moment between two samples: (s - 0.42278)^2 is within the contact tolerance for |s -
/// 0.42278| < h.
#[test]
fn a_foot_that_grazes_the_ground_is_seen() {
    for half in [1e-5, 1e-4, 1e-3] {
        for center in [0.42278, -0.17113, 0.90311] {
            let tolerance = (half * half).to_string();
            let from = of_block(&format!("(s - {center})^2"), "-1", &["--contact-tolerance", &tolerance]);
            assert_eq!(from.len(), 3, "{half} {center}");
            let [begins, ends] = [from[1] - center + half, from[2] - center - half];
            // Heights are rounded at the size of the block.
            assert!(begins.abs() < 1e-3 * half && ends.abs() < 1e-3 * half, "{half} {center}: {from:?}");
        }
    }
}

/// A region ends where rounding decides the sign at a sample: the velocity s (s + 0.001) + 1e-17 is negative between
/// -0.001 and 0.
#[test]
fn a_region_that_ends_beside_a_sample_is_seen() {
    let from = of_block("0", "s*(s + 0.001) + 1e-17", &[]);
    assert_eq!(from.len(), 3, "{from:?}");
    assert!((from[1] + 0.001).abs() < 1e-10 && from[2].abs() < 1e-10, "{from:?}");
}

/// A cube falls on an edge. Both of its edges touch for a moment where it rolls from one to the other, up to the angle
/// at which the higher one is as far from the ground as the contact tolerance.
#[test]
fn both_corners_of_a_rolling_foot_are_seen() {
    let cube = file("cube.urdf", body(0.3, &collision([0.0; 2], "box size=\"1 1 1\"")));
    let study = json!({"parameters": {"s": {"from": -0.53, "to": 0.67, "steps": 13}}, "state": {"friction": 0.2,
        "place": "lowest", "position": {"base": {"pitch": "s"}}, "velocity": {"base": {"x": 4, "z": -1}}}});
    let Sweep { regions, .. } = written(&cube, &study, &["--contact-tolerance", "1e-4"]);
    let level: Vec<_> =
        regions.iter().filter(|region| region.contacts.as_ref().is_some_and(|all| all.len() == 2)).collect();
    assert_eq!(level.len(), 1, "{regions:?}");
    // The side is 1 m long, so that the angle is the tolerance.
    assert!([level[0].from + 1e-4, level[0].to - 1e-4].iter().all(|off| off.abs() < 1e-9), "{level:?}");
    let beside: Vec<_> =
        regions.windows(3).find(|three| three[1].from == level[0].from).into_iter().flatten().collect();
    assert_eq!(beside[0].set(), beside[2].set());
}
