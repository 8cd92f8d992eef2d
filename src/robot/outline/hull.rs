//! Corners of a point cloud: the vertices of its convex hull, without those that barely protrude from a straight side.
//!
//! ```text points --parry, scaled to size one--> convex hull --drop what bulges less than 1e-6 of the size--> corners
//! ```
//!
//! A real sole has dozens of vertices along one side, which rounding moves slightly off the line. A chain of hull
//! vertices between two kept ones is replaced by its chord if none of them is farther off than [`FLAT`] (Douglas and
//! Peucker, 1973). Corners are dropped, never moved. Cost: usually O(n log h) for n points with h on the hull.

use crate::planar::Vector;
use parry2d::math::Vector as ParryVector;
use parry2d::transformation::convex_hull_idx;
use std::cmp::Ordering;

/// Largest distance of a chain from its chord at which it counts as straight, as a fraction of the hull's size. The
/// default contact tolerance is the same fraction of the robot's size.
const FLAT: f64 = 1e-6;
/// Points count as equal if their coordinates differ by less than this fraction of the largest coordinate.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Returns the corners of the convex hull of `points`, counter-clockwise from the lowest (the rearmost of several): two
/// if the points lie on a line, one if they coincide.
///
/// # Errors
/// Returns the reason if there are no corners.
pub(super) fn corners(points: &[Vector<f64>]) -> Result<Vec<Vector<f64>>, String> {
    let Some(&first) = points.first() else { return Err("it has no vertices".into()) };
    let most = |from: Vector<f64>| {
        let coordinates = points.iter().flat_map(|&point| (point - from).components());
        coordinates.fold(0.0, |most: f64, coordinate| most.max(coordinate.abs()))
    };
    let (largest, size) = (most(Vector::zero()), most(first));
    // The distance of two finite points may also exceed the range of f64.
    if points.iter().flat_map(|point| point.components()).any(|coordinate| !coordinate.is_finite()) || !size.is_finite()
    {
        return Err("its vertices leave the range of f64".into());
    }
    if size <= ROUNDING * largest {
        return Ok(vec![first]);
    }
    // parry uses fixed tolerances, so it gets points about the origin, scaled to size one by a power of two.
    let unit = |length: f64| libm::scalbn(length, -libm::ilogb(size));
    let about: Vec<Vector<f64>> = points.iter().map(|&point| (point - first).map(unit)).collect();
    let cloud: Vec<ParryVector> = about.iter().map(|&Vector { x, z }| ParryVector::new(x, z)).collect();
    let hull = convex_hull_idx(&cloud);
    let chain: Vec<Vector<f64>> = hull.iter().map(|&index| about[index]).collect();
    let mut corners: Vec<Vector<f64>> = straightened(&chain).into_iter().map(|at| points[hull[at]]).collect();
    let height = |at: &usize| (corners[*at].z, corners[*at].x);
    let lowest = (0..corners.len()).min_by(|a, b| height(a).partial_cmp(&height(b)).unwrap_or(Ordering::Equal));
    corners.rotate_left(lowest.unwrap_or(0));
    Ok(corners)
}

/// Returns the indices of the points of a closed convex chain that are kept.
fn straightened(chain: &[Vector<f64>]) -> Vec<usize> {
    // The point farthest from any given point is always a corner.
    let farthest = |from: Vector<f64>| {
        let far = |&at: &usize| (chain[at] - from).length();
        (0..chain.len()).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
    };
    let start = farthest(chain[0]);
    let opposite = (farthest(chain[start]) + chain.len() - start) % chain.len();
    let at = |step: usize| (start + step) % chain.len();

    let mut kept = vec![start];
    // Parts of the chain that are still to be examined, the next one last.
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

/// Returns the distance of `point` from the line through `a` and `b`, or from `a` if these coincide.
fn bulge(a: Vector<f64>, b: Vector<f64>, point: Vector<f64>) -> f64 {
    let (side, arm) = (b - a, point - a);
    let length = side.length();
    if length == 0.0 {
        return arm.length();
    }
    (side.x * arm.z - side.z * arm.x).abs() / length
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudorandom numbers from -1 to 1, the same in every run.
    fn numbers(mut seed: u64) -> impl FnMut() -> f64 {
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// Asserts that points lie at most `beyond` outside the corners, and that the corners are points and turn left.
    fn assert_hull(points: &[Vector<f64>], corners: &[Vector<f64>], beyond: f64) {
        assert!(corners.iter().all(|corner| points.contains(corner)));
        for (at, &a) in corners.iter().enumerate() {
            let (b, c) = (corners[(at + 1) % corners.len()], corners[(at + 2) % corners.len()]);
            let side = b - a;
            let left = |point: Vector<f64>| side.x * (point - a).z - side.z * (point - a).x;
            assert!(corners.len() <= 2 || left(c) > 0.0, "{a:?} {b:?} {c:?}");
            let outside = points.iter().map(|&point| -left(point) / side.length()).fold(0.0, f64::max);
            assert!(outside <= beyond, "{outside} outside {a:?} {b:?}");
        }
    }

    #[test]
    fn finely_meshed_sole_has_four_corners() {
        // The sole is tilted, so that rounding to f32 or to seven decimals moves every vertex off the line.
        let (sin, cos) = 0.3_f64.sin_cos();
        let sole = |round: fn(f64) -> f64| -> Vec<Vector<f64>> {
            let along = (0..=50).map(|step| f64::from(step) / 250.0 - 0.1);
            let both = along.flat_map(|x| [[x, -0.02], [x, 0.02]]);
            both.map(|[x, z]| Vector::new(cos * x + sin * z, cos * z - sin * x).map(round)).collect()
        };
        for round in [|x| x, |x| f64::from(x as f32), |x: f64| (x * 1e7).round() / 1e7] {
            let points = sole(round);
            let found = corners(&points).expect("a hull");
            assert_eq!(found.len(), 4);
            assert_hull(&points, &found, 1e-6 * 0.2);
        }
    }

    #[test]
    fn clouds_of_any_size_keep_their_hulls() {
        for (seed, scale) in [(1, 1.0), (2, 1e-9), (3, 1e12), (4, 1e-100)] {
            let mut next = numbers(seed);
            for count in [3, 4, 10, 300] {
                let points: Vec<Vector<f64>> =
                    (0..count).map(|_| Vector::new(next() * scale, next() * scale)).collect();
                let found = corners(&points).expect("a hull");
                assert_hull(&points, &found, 4e-6 * scale);
            }
        }
    }

    #[test]
    fn fine_round_mesh_keeps_its_shape() {
        let turn = |step: u32| (f64::from(step % 50_000) * std::f64::consts::TAU / 5e4).sin_cos();
        let points: Vec<Vector<f64>> =
            (0..100_000).map(turn).map(|(sin, cos)| Vector::new(0.3 * cos, 0.3 * sin)).collect();
        let found = corners(&points).expect("a hull");
        // A chord over the angle a deviates from the circle by r (1 - cos(a / 2)).
        assert!((500..5_000).contains(&found.len()), "{}", found.len());
        assert_hull(&points[..50_000], &found, 1e-6);
    }

    #[test]
    fn points_lines_and_copies_have_their_ends_alone() {
        assert_eq!(corners(&[Vector::new(0.3, 0.1); 5]), Ok(vec![Vector::new(0.3, 0.1)]));
        // These points differ only by the rounding of their coordinates.
        assert_eq!(corners(&[Vector::new(1e9, 1e9), Vector::new(1e9 + 1e-7, 1e9)]), Ok(vec![Vector::new(1e9, 1e9)]));
        let line: Vec<Vector<f64>> =
            (0..100).map(|step| f64::from(step % 34)).map(|t| Vector::new(0.1 * t, -0.3 * t)).collect();
        let mut ends = corners(&line).expect("a line");
        ends.sort_by(|a, b| a.x.total_cmp(&b.x));
        assert_eq!(ends, [line[0], line[33]]);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector::from);
        let copies: Vec<Vector<f64>> = square.into_iter().cycle().take(40).collect();
        assert_eq!(corners(&copies).expect("a square").len(), 4);
        assert_eq!(corners(&[]), Err("it has no vertices".into()));
        let endless = [Vector::zero(), Vector::new(f64::INFINITY, 0.0)];
        assert_eq!(corners(&endless), Err("its vertices leave the range of f64".into()));
    }
}
