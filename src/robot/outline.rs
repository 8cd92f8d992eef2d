//! Collision shape -> its outline in the plane.
//!
//! A ball is a disc, and so is a cylinder about the plane's normal. Boxes, and cylinders that lie in the plane, project to
//! a polygon with parallel sides, `{c + sum of s_i g_i, |s_i| <= 1}`, whose half sides g_i are the projected half axes;
//! walking along them in the order of their angles gives its corners. So corners of a shape that is not turned come from
//! its centre and half sizes by one sum each.

use super::FootShape;
use crate::description::{Geometry, Matrix};
use crate::planar::{Vector, difference, dot, sum};
use parry2d::math::Vector as ParryVector;
use parry2d::shape::SharedShape;

/// Half sides shorter than this part of the longest, or as nearly parallel, are rounding (a quarter turn, whose cosine is
/// 6e-17 in f64, leaves them) and would tear one corner into two.
const ROUNDING: f64 = 1e-12;

/// The outline of `geometry`, whose frame has its origin at `centre` and its axes in the columns of `rotation`, both in
/// the body's frame; `off_axis` is the greatest angle \[rad\] that still counts as parallel. Or why there is none.
pub(super) fn outline(
    geometry: &Geometry,
    rotation: &Matrix,
    centre: Vector<f64>,
    off_axis: f64,
) -> Result<FootShape, String> {
    // The shape's axis `k` in the plane.
    let axis = |k: usize| [rotation[0][k], rotation[2][k]];
    match *geometry {
        Geometry::Sphere { radius } => Ok(FootShape::Disc { centre, radius }),
        Geometry::Box { size } => {
            let half = |k: usize| axis(k).map(|component| component * (0.5 * size[k]));
            polygon(centre, &[half(0), half(1), half(2)])
        }
        Geometry::Cylinder { radius, length } => {
            let [x, z] = axis(2);
            let (in_plane, along_normal) = (libm::hypot(x, z), rotation[1][2].abs());
            if libm::atan2(in_plane, along_normal) <= off_axis {
                Ok(FootShape::Disc { centre, radius })
            } else if libm::atan2(along_normal, in_plane) <= off_axis {
                polygon(centre, &[[x * (0.5 * length), z * (0.5 * length)], [z * radius, -x * radius]])
            } else {
                let degrees = libm::atan2(in_plane, along_normal).to_degrees();
                Err(format!("its axis is {degrees:.1} degrees off the plane's normal: not handled yet"))
            }
        }
        Geometry::Capsule { .. } => Err("capsules are not handled yet".into()),
        Geometry::Mesh { .. } => Err("meshes are not handled yet".into()),
        Geometry::Unknown { .. } => Err("no shape of URDF".into()),
    }
}

/// The polygon about `centre` with these half sides: a point if all vanish, a line of two corners if all are parallel.
fn polygon(centre: Vector<f64>, half_sides: &[Vector<f64>]) -> Result<FootShape, String> {
    let sides = distinct(half_sides);
    if sides.is_empty() {
        return Ok(FootShape::Disc { centre, radius: 0.0 });
    }
    // From the lowest corner up along all sides, and back down along them.
    let count = sides.len();
    let corner = |step: usize| {
        sides.iter().enumerate().fold([0.0; 2], |corner, (index, &side)| {
            let forward = index < step && step <= index + count;
            if forward { sum(corner, side) } else { difference(corner, side) }
        })
    };
    let corners: Vec<Vector<f64>> = (0..2 * count).map(|step| sum(centre, corner(step))).collect();
    let points: Vec<ParryVector> = corners.iter().map(|&[x, z]| ParryVector::new(x, z)).collect();
    let shape = match points[..] {
        [a, b] => Some(SharedShape::segment(a, b)),
        _ => SharedShape::convex_polyline_unmodified(points),
    };
    match shape {
        Some(shape) => Ok(FootShape::Polygon { corners, shape }),
        None => Err("too small beside its distance from the body's origin".into()),
    }
}

/// The half sides that remain when rounding is dropped and parallel ones are joined, all pointing up (or level and
/// forward), by rising angle from level.
fn distinct(half_sides: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let longest = half_sides.iter().map(|&side| length(side)).fold(0.0, f64::max);
    let mut sides: Vec<Vector<f64>> = Vec::with_capacity(half_sides.len());
    for &side in half_sides {
        if length(side) <= ROUNDING * longest {
            continue;
        }
        let parallel = sides.iter_mut().find(|known| sine(**known, side).abs() <= ROUNDING);
        match parallel {
            Some(known) if dot(*known, side) > 0.0 => *known = sum(*known, side),
            Some(known) => *known = difference(*known, side),
            None => sides.push(side),
        }
    }
    for side in &mut sides {
        if side[1] < 0.0 || (side[1] == 0.0 && side[0] < 0.0) {
            *side = side.map(|component| 0.0 - component);
        }
    }
    sides.sort_by(|&a, &b| 0.0_f64.total_cmp(&sine(a, b)));
    sides
}

fn length([x, z]: Vector<f64>) -> f64 {
    libm::hypot(x, z)
}

/// Sine of the angle from `a` to `b`; positive where `b` points to the left of `a`, seen with forward to the right and up
/// upward.
fn sine(a: Vector<f64>, b: Vector<f64>) -> f64 {
    let (la, lb) = (length(a), length(b));
    (a[0] / la) * (b[1] / lb) - (a[1] / la) * (b[0] / lb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Pose;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn outline_of(geometry: Geometry, rpy: [f64; 3]) -> Result<FootShape, String> {
        outline(&geometry, &Pose { xyz: [0.0; 3], rpy }.rotation(), [0.1, -0.3], 1e-3)
    }

    fn corners_of(geometry: Geometry, rpy: [f64; 3]) -> Vec<Vector<f64>> {
        match outline_of(geometry, rpy).expect("an outline") {
            FootShape::Polygon { corners, shape } => {
                if let Some(polygon) = shape.as_convex_polygon() {
                    assert_eq!(polygon.points().iter().map(|p| [p.x, p.y]).collect::<Vec<_>>(), corners);
                }
                corners
            }
            FootShape::Disc { .. } => panic!("a disc"),
        }
    }

    fn disc_of(geometry: Geometry, rpy: [f64; 3]) -> (Vector<f64>, f64) {
        match outline_of(geometry, rpy).expect("an outline") {
            FootShape::Disc { centre, radius } => (centre, radius),
            FootShape::Polygon { .. } => panic!("a polygon"),
        }
    }

    fn assert_near(corners: &[Vector<f64>], expected: &[Vector<f64>]) {
        assert_eq!(corners.len(), expected.len(), "{corners:?}");
        for (corner, expected) in corners.iter().flatten().zip(expected.iter().flatten()) {
            assert!((corner - expected).abs() < 1e-15, "{corners:?}");
        }
    }

    const SOLE: Geometry = Geometry::Box { size: [0.2, 0.1, 0.04] };
    const ROD: Geometry = Geometry::Cylinder { radius: 0.05, length: 0.4 };

    #[test]
    fn a_box_has_four_exact_corners_counter_clockwise_from_the_lowest_rear_one() {
        let expected =
            [[0.1 - 0.1, -0.3 - 0.02], [0.1 + 0.1, -0.3 - 0.02], [0.1 + 0.1, -0.3 + 0.02], [0.1 - 0.1, -0.3 + 0.02]];
        assert_eq!(corners_of(SOLE, [0.0; 3]), expected);
    }

    #[test]
    fn a_quarter_turn_leaves_four_corners() {
        // Roll: the y side stands upright. Pitch: x and z change places. Yaw: y lies forward.
        let rectangle =
            |x: f64, z: f64| [[0.1 - x, -0.3 - z], [0.1 + x, -0.3 - z], [0.1 + x, -0.3 + z], [0.1 - x, -0.3 + z]];
        assert_near(&corners_of(SOLE, [FRAC_PI_2, 0.0, 0.0]), &rectangle(0.1, 0.05));
        assert_near(&corners_of(SOLE, [0.0, 0.0, FRAC_PI_2]), &rectangle(0.05, 0.02));
        let mut corners = corners_of(SOLE, [0.0, FRAC_PI_2, 0.0]);
        // Which of the two level corners comes first is a matter of rounding.
        corners.sort_by(|a, b| (a[1] + 0.01 * a[0]).total_cmp(&(b[1] + 0.01 * b[0])));
        assert_near(&corners, &[[0.08, -0.4], [0.12, -0.4], [0.08, -0.2], [0.12, -0.2]]);
    }

    #[test]
    fn a_turned_box_is_the_hull_of_its_eight_projected_corners() {
        let cube = Geometry::Box { size: [2.0; 3] };
        let pose = Pose { xyz: [0.0; 3], rpy: [0.4, 0.3, 0.9] };
        let corners = corners_of(cube, pose.rpy);
        assert_eq!(corners.len(), 6);
        let rotation = pose.rotation();
        let all = (0..8).map(|bits| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { -1.0 } else { 1.0 }));
        let projected: Vec<_> = all
            .map(|corner| crate::description::apply(&rotation, corner))
            .map(|[x, _, z]| [0.1 + x, -0.3 + z])
            .collect();
        for (index, &corner) in corners.iter().enumerate() {
            assert!(projected.iter().any(|&other| libm::hypot(other[0] - corner[0], other[1] - corner[1]) < 1e-15));
            let side = difference(corners[(index + 1) % 6], corner);
            let left_of = |[x, z]: Vector<f64>| side[0] * z - side[1] * x;
            assert!(projected.iter().all(|&other| left_of(difference(other, corner)) > -1e-14));
        }
    }

    #[test]
    fn a_cylinder_is_a_disc_along_the_normal_and_a_rectangle_in_the_plane() {
        assert_eq!(disc_of(ROD, [FRAC_PI_2, 0.0, 0.0]), ([0.1, -0.3], 0.05));
        assert_eq!(disc_of(ROD, [-FRAC_PI_2, 0.0, 0.0]), ([0.1, -0.3], 0.05));
        let upright = corners_of(ROD, [0.0; 3]);
        assert_eq!(
            upright,
            [[0.1 - 0.05, -0.5], [0.1 + 0.05, -0.5], [0.1 + 0.05, -0.3 + 0.2], [0.1 - 0.05, -0.3 + 0.2]]
        );
    }

    #[test]
    fn an_oblique_cylinder_is_skipped_and_its_angle_told() {
        let why = outline_of(ROD, [FRAC_PI_4, 0.0, 0.0]).expect_err("oblique");
        assert_eq!(why, "its axis is 45.0 degrees off the plane's normal: not handled yet");
    }

    #[test]
    fn flat_shapes_are_lines_and_points() {
        let plate = Geometry::Box { size: [0.2, 0.1, 0.0] };
        assert_eq!(corners_of(plate, [0.0; 3]), [[0.1 - 0.1, -0.3], [0.1 + 0.1, -0.3]]);
        let wall = Geometry::Box { size: [0.0, 0.1, 0.4] };
        assert_eq!(corners_of(wall, [0.0; 3]), [[0.1, -0.5], [0.1, -0.3 + 0.2]]);
        assert_eq!(disc_of(Geometry::Box { size: [0.0, 0.1, 0.0] }, [0.0; 3]), ([0.1, -0.3], 0.0));
        assert_eq!(disc_of(Geometry::Sphere { radius: 0.0 }, [1.0, 2.0, 3.0]), ([0.1, -0.3], 0.0));
    }
}
