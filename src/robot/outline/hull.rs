//! The corners of a cloud of points: the vertices of its convex hull, without those that no contact can tell from a straight
//! side.
//!
//! ```text
//!     points --parry, scaled to size one--> convex hull --drop what bulges less than 1e-6 of the size--> corners
//! ```
//!
//! A real sole is meshed with dozens of vertices along one side, which rounding (f32, or six decimals of a text) leaves a
//! little off the line. The chain of hull vertices between two kept ones is replaced by its chord where none of it is
//! farther off than [`FLAT`] (Douglas and Peucker, 1973); corners are dropped, never moved, so a side loses at most that
//! much, and what is kept are points of the file. In n points with h on the hull: n log h as a rule.

use crate::planar::{Vector, difference};
use parry2d::math::Vector as ParryVector;
use parry2d::transformation::convex_hull_idx;

/// What a chain may bulge and still be a straight side, as part of the hull's size: as much as the default contact tolerance
/// is of the robot's size.
const FLAT: f64 = 1e-6;

/// Coordinates that differ by less than this part of the largest one are the same point.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The corners of the convex hull of `points`, counter-clockwise; two if the points lie on a line, one if they coincide. Or
/// why there are none.
pub(super) fn corners(points: &[Vector<f64>]) -> Result<Vec<Vector<f64>>, String> {
    let Some(&first) = points.first() else { return Err("it has no vertices".into()) };
    if points.iter().flatten().any(|coordinate| !coordinate.is_finite()) {
        return Err("its vertices leave the range of f64".into());
    }
    let largest = points.iter().flatten().fold(0.0, |largest: f64, coordinate| largest.max(coordinate.abs()));
    let size = points.iter().fold(0.0, |size: f64, &point| {
        let [x, z] = difference(point, first);
        size.max(x.abs()).max(z.abs())
    });
    if size <= ROUNDING * largest {
        return Ok(vec![first]);
    }
    // parry compares with fixed tolerances: it is given points of size one, exactly scaled, about the origin.
    let unit = |length: f64| libm::scalbn(length, -libm::ilogb(size));
    let about: Vec<Vector<f64>> = points.iter().map(|&point| difference(point, first).map(unit)).collect();
    let cloud: Vec<ParryVector> = about.iter().map(|&[x, z]| ParryVector::new(x, z)).collect();
    let hull = convex_hull_idx(&cloud);
    let chain: Vec<Vector<f64>> = hull.iter().map(|&index| about[index]).collect();
    Ok(straightened(&chain).into_iter().map(|at| points[hull[at]]).collect())
}

/// The indices of the points of a closed convex chain that are kept.
fn straightened(chain: &[Vector<f64>]) -> Vec<usize> {
    // A farthest point from anywhere is no point within a side.
    let farthest = |from: Vector<f64>| {
        let far = |&at: &usize| {
            let [x, z] = difference(chain[at], from);
            libm::hypot(x, z)
        };
        (0..chain.len()).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
    };
    let start = farthest(chain[0]);
    let opposite = (farthest(chain[start]) + chain.len() - start) % chain.len();
    let at = |step: usize| (start + step) % chain.len();

    let mut kept = vec![start];
    // Pieces of the chain still to be looked at, the next one last.
    let mut pieces = vec![(opposite, chain.len()), (0, opposite)];
    while let Some((from, to)) = pieces.pop() {
        let (a, b) = (chain[at(from)], chain[at(to)]);
        let off = |&step: &usize| bulge(a, b, chain[at(step)]);
        match (from + 1..to).max_by(|x, y| off(x).total_cmp(&off(y))) {
            Some(middle) if off(&middle) > FLAT => pieces.extend([(middle, to), (from, middle)]),
            _ if to < chain.len() => kept.push(at(to)),
            _ => {}
        }
    }
    kept
}

/// How far `point` is from the segment between `a` and `b`.
fn bulge(a: Vector<f64>, b: Vector<f64>, point: Vector<f64>) -> f64 {
    let (side, arm) = (difference(b, a), difference(point, a));
    let length = libm::hypot(side[0], side[1]);
    if length == 0.0 {
        return libm::hypot(arm[0], arm[1]);
    }
    (side[0] * arm[1] - side[1] * arm[0]).abs() / length
}
