//! Collision shape -> its outline in the plane: corners and the rim about them (see [`super::shape`]).
//!
//! ```text
//!     ball, capsule                     projected centre line + circle
//!     cylinder along the normal         centre + circle
//!     cylinder in the plane, box        zonogon of the projected half axes
//!     cylinder oblique to the plane     projected centre line + ellipse, the projection of its rims
//!     mesh                              convex hull of its projected vertices
//! ```

mod hull;
mod zonogon;

use super::{FootShape, Rim};
use crate::description::{Geometry, Matrix, Mesh, apply};
use crate::planar::Vector;

/// The outline of `geometry`, whose frame has its origin at `centre` and its axes in the columns of `rotation`, both in
/// the body's frame; `off_axis` is the greatest angle \[rad\] that still counts as parallel. Or why there is none.
pub(super) fn outline(
    geometry: &Geometry,
    rotation: &Matrix,
    centre: Vector<f64>,
    off_axis: f64,
) -> Result<FootShape, String> {
    // The shape's axis `k` in the plane.
    let axis = |k: usize| Vector::new(rotation[0][k], rotation[2][k]);
    let half = |k: usize, length: f64| axis(k).map(|component| component * (0.5 * length));
    let Vector { x, z } = axis(2);
    let (in_plane, along_normal) = (libm::hypot(x, z), rotation[1][2].abs());
    let lies_along_normal = libm::atan2(in_plane, along_normal) <= off_axis;
    let lies_in_plane = libm::atan2(along_normal, in_plane) <= off_axis;
    match geometry {
        &Geometry::Sphere { radius } => Ok(FootShape::disc(centre, radius)),
        &Geometry::Capsule { radius, .. } | &Geometry::Cylinder { radius, .. } if lies_along_normal => {
            Ok(FootShape::disc(centre, radius))
        }
        &Geometry::Capsule { radius, length } => projected(centre, &[half(2, length)], Rim::Circle { radius }),
        &Geometry::Cylinder { radius, length } if lies_in_plane => {
            projected(centre, &[half(2, length), Vector::new(z * radius, -x * radius)], POINT)
        }
        &Geometry::Cylinder { radius, length } => {
            // The rims are circles about the shape's own z axis; their half diameters along its x and y stay conjugate.
            let half_diameters = [half(0, 2.0 * radius), half(1, 2.0 * radius)];
            projected(centre, &[half(2, length)], Rim::Ellipse { half_diameters })
        }
        &Geometry::Box { size } => projected(centre, &[0, 1, 2].map(|k| half(k, size[k])), POINT),
        Geometry::Mesh { file, scale, mesh } => {
            let vertices = match mesh {
                Mesh::Vertices(vertices) => vertices,
                Mesh::LeftOut { why } => return Err(why.clone()),
                Mesh::Unread => return Err("its file was not read".into()),
            };
            let project = |vertex: &[f64; 3]| {
                let [x, _, z] = apply(rotation, [0, 1, 2].map(|k| scale[k] * vertex[k]));
                centre + Vector::new(x, z)
            };
            let corners = hull::corners(&vertices.iter().map(project).collect::<Vec<_>>())?;
            let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
            Ok(swept(corners, POINT)?.of_mesh(name))
        }
        Geometry::Unknown { .. } => Err("no shape of URDF".into()),
    }
}

/// A rim that is its corner.
const POINT: Rim = Rim::Circle { radius: 0.0 };

/// The zonogon of `half_sides` about `centre`, with `rim` about its corners.
fn projected(centre: Vector<f64>, half_sides: &[Vector<f64>], rim: Rim) -> Result<FootShape, String> {
    swept(zonogon::corners(centre, half_sides), rim)
}

fn swept(corners: Vec<Vector<f64>>, rim: Rim) -> Result<FootShape, String> {
    FootShape::swept(corners, rim).ok_or_else(|| "its corners are not distinct in f64".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Pose;

    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4};

    fn outline_of(geometry: Geometry, rpy: [f64; 3]) -> Result<FootShape, String> {
        outline(&geometry, &Pose { xyz: [0.0; 3], rpy }.rotation(), Vector::new(0.1, -0.3), 1e-3)
    }

    fn polygon_of(geometry: Geometry, rpy: [f64; 3]) -> (Vec<Vector<f64>>, Rim) {
        let shape = outline_of(geometry, rpy).expect("an outline");
        if let Some(polygon) = shape.polygon().and_then(|polygon| polygon.as_convex_polygon()) {
            assert_eq!(polygon.points().iter().map(|p| Vector::new(p.x, p.y)).collect::<Vec<_>>(), shape.corners());
        }
        (shape.corners().to_vec(), shape.rim())
    }

    fn corners_of(geometry: Geometry, rpy: [f64; 3]) -> Vec<Vector<f64>> {
        let (corners, rim) = polygon_of(geometry, rpy);
        assert_eq!(rim, POINT);
        corners
    }

    fn disc_of(geometry: Geometry, rpy: [f64; 3]) -> (Vector<f64>, f64) {
        match polygon_of(geometry, rpy) {
            (corners, Rim::Circle { radius }) if corners.len() == 1 => (corners[0], radius),
            other => panic!("{other:?} is no disc"),
        }
    }

    fn assert_near(corners: &[Vector<f64>], expected: &[Vector<f64>]) {
        assert_eq!(corners.len(), expected.len(), "{corners:?}");
        for (corner, expected) in
            corners.iter().flat_map(|at| at.components()).zip(expected.iter().flat_map(|at| at.components()))
        {
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
        let rectangle = |x: f64, z: f64| {
            [[0.1 - x, -0.3 - z], [0.1 + x, -0.3 - z], [0.1 + x, -0.3 + z], [0.1 - x, -0.3 + z]].map(Vector::from)
        };
        assert_near(&corners_of(SOLE, [FRAC_PI_2, 0.0, 0.0]), &rectangle(0.1, 0.05));
        assert_near(&corners_of(SOLE, [0.0, 0.0, FRAC_PI_2]), &rectangle(0.05, 0.02));
        let mut corners = corners_of(SOLE, [0.0, FRAC_PI_2, 0.0]);
        // Which of the two level corners comes first is a matter of rounding.
        corners.sort_by(|a, b| (a.z + 0.01 * a.x).total_cmp(&(b.z + 0.01 * b.x)));
        assert_near(
            &corners,
            &[Vector::new(0.08, -0.4), Vector::new(0.12, -0.4), Vector::new(0.08, -0.2), Vector::new(0.12, -0.2)],
        );
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
            .map(|[x, _, z]| Vector::new(0.1 + x, -0.3 + z))
            .collect();
        for (index, &corner) in corners.iter().enumerate() {
            assert!(projected.iter().any(|&other| libm::hypot(other.x - corner.x, other.z - corner.z) < 1e-15));
            let side = corners[(index + 1) % 6] - corner;
            let left_of = |Vector { x, z }: Vector<f64>| side.x * z - side.z * x;
            assert!(projected.iter().all(|&other| left_of(other - corner) > -1e-14));
        }
    }

    #[test]
    fn a_cylinder_is_a_disc_along_the_normal_and_a_rectangle_in_the_plane() {
        assert_eq!(disc_of(ROD, [FRAC_PI_2, 0.0, 0.0]), (Vector::new(0.1, -0.3), 0.05));
        assert_eq!(disc_of(ROD, [-FRAC_PI_2, 0.0, 0.0]), (Vector::new(0.1, -0.3), 0.05));
        let upright = corners_of(ROD, [0.0; 3]);
        assert_eq!(
            upright,
            [[0.1 - 0.05, -0.5], [0.1 + 0.05, -0.5], [0.1 + 0.05, -0.3 + 0.2], [0.1 - 0.05, -0.3 + 0.2]]
        );
    }

    #[test]
    fn a_capsule_is_a_disc_along_the_normal_and_else_its_centre_line_with_its_radius() {
        let capsule = Geometry::Capsule { radius: 0.05, length: 0.4 };
        assert_eq!(disc_of(capsule.clone(), [FRAC_PI_2, 0.0, 0.0]), (Vector::new(0.1, -0.3), 0.05));
        let round = Rim::Circle { radius: 0.05 };
        assert_eq!(
            polygon_of(capsule.clone(), [0.0; 3]),
            (vec![Vector::new(0.1, -0.5), Vector::new(0.1, -0.3 + 0.2)], round)
        );
        // Rolled by 60 degrees the centre line is seen at half its length.
        let (corners, rim) = polygon_of(capsule, [FRAC_PI_3, 0.0, 0.0]);
        assert_near(&corners, &[Vector::new(0.1, -0.4), Vector::new(0.1, -0.2)]);
        assert_eq!(rim, round);
    }

    /// How far the outline reaches from (0.1, -0.3) along `direction`, and its point there.
    fn farthest(shape: &FootShape, direction: Vector<f64>) -> (f64, Vector<f64>) {
        let along = |point: Vector<f64>| (point - Vector::new(0.1, -0.3)).dot(direction);
        let tip = |&corner: &Vector<f64>| corner + shape.rim().support(direction);
        let point = shape.corners().iter().map(tip).max_by(|&a, &b| along(a).total_cmp(&along(b))).expect("a corner");
        (along(point), point)
    }

    #[test]
    fn every_outline_reaches_as_far_as_the_points_of_its_surface_in_space() {
        // Rims of a cylinder and circles of a ball by their angle: 1 - cos of half a step is what sampling misses.
        const STEPS: u32 = 4000;
        let turns = || (0..STEPS).map(|step| (f64::from(step) * std::f64::consts::TAU / f64::from(STEPS)).sin_cos());
        let (radius, length) = (0.05, 0.4);
        let rims = || [-0.5 * length, 0.5 * length].into_iter().flat_map(move |z| turns().map(move |(s, c)| (s, c, z)));
        let cylinder: Vec<[f64; 3]> = rims().map(|(sin, cos, z)| [radius * cos, radius * sin, z]).collect();
        let shapes = [
            (Geometry::Cylinder { radius, length }, cylinder),
            (Geometry::Box { size: [0.2, 0.4, 0.6] }, eight([0.1, 0.2, 0.3])),
        ];
        for rpy in [[0.7, 0.3, 0.2], [FRAC_PI_4, 0.0, 0.0], [1.5, 0.1, -2.0], [0.1, FRAC_PI_2, 0.4], [0.01, 0.0, 0.0]] {
            let rotation = Pose { xyz: [0.0; 3], rpy }.rotation();
            for (geometry, surface) in &shapes {
                let shape = outline_of(geometry.clone(), rpy).expect("an outline");
                let seen: Vec<Vector<f64>> =
                    surface.iter().map(|&point| apply(&rotation, point)).map(|[x, _, z]| Vector::new(x, z)).collect();
                for direction in (0..24).map(|step| (0.1 + f64::from(step)).sin_cos()).map(|(s, c)| Vector::new(c, s)) {
                    let (reach, point) = farthest(&shape, direction);
                    let sampled = seen.iter().map(|&at| at.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
                    assert!((reach - sampled).abs() < 1e-7, "{geometry:?} {rpy:?} {direction:?}: {reach}, {sampled}");
                    // The point is one of the surface, not merely as high as one.
                    let apart = |at: &Vector<f64>| point - Vector::new(0.1, -0.3) - *at;
                    let nearest = seen.iter().map(|at| libm::hypot(apart(at).x, apart(at).z)).fold(f64::MAX, f64::min);
                    assert!(nearest < 1e-4, "{geometry:?} {rpy:?} {direction:?}: {nearest}");
                }
            }
        }
    }

    fn mesh(vertices: Vec<[f64; 3]>, scale: [f64; 3]) -> Geometry {
        Geometry::Mesh { file: "package://p/sole.stl".into(), scale, mesh: Mesh::Vertices(vertices.into()) }
    }

    /// The corners of a box of these half sizes.
    fn eight(half: [f64; 3]) -> Vec<[f64; 3]> {
        (0..8).map(|bits| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { -half[k] } else { half[k] })).collect()
    }

    fn sole() -> Vec<[f64; 3]> {
        eight([0.1, 0.05, 0.02])
    }

    #[test]
    fn a_mesh_of_a_box_is_that_box() {
        let corners = corners_of(mesh(sole(), [1.0; 3]), [0.0; 3]);
        assert_eq!(corners, corners_of(SOLE, [0.0; 3]));
        let turned = [0.4, 0.3, 0.9];
        let corners = corners_of(mesh(sole(), [1.0; 3]), turned);
        assert_near(&corners, &corners_of(SOLE, turned));
        assert_eq!(outline_of(mesh(sole(), [1.0; 3]), [0.0; 3]).expect("an outline").mesh(), Some("sole.stl"));
    }

    #[test]
    fn a_mesh_is_scaled_and_mirrored_along_its_own_axes() {
        // A wedge whose tip points forward and down, seen from the side; as seen after the factors.
        let wedge = || vec![[0.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 0.5, 1.0]];
        let corners = |scale| corners_of(mesh(wedge(), scale), [0.0; 3]);
        assert_near(&corners([1.0; 3]), &[Vector::new(1.1, -1.3), Vector::new(0.1, 0.7), Vector::new(0.1, -0.3)]);
        assert_near(
            &corners([-0.5, 3.0, 0.25]),
            &[Vector::new(-0.4, -0.55), Vector::new(0.1, -0.3), Vector::new(0.1, -0.05)],
        );
        assert_near(&corners([1.0, 1.0, 0.0]), &[Vector::new(0.1, -0.3), Vector::new(1.1, -0.3)]);
        assert_eq!(disc_of(mesh(wedge(), [0.0; 3]), [0.0; 3]), (Vector::new(0.1, -0.3), 0.0));
    }

    #[test]
    fn flat_shapes_are_lines_and_points() {
        let plate = Geometry::Box { size: [0.2, 0.1, 0.0] };
        assert_eq!(corners_of(plate, [0.0; 3]), [[0.1 - 0.1, -0.3], [0.1 + 0.1, -0.3]]);
        let wall = Geometry::Box { size: [0.0, 0.1, 0.4] };
        assert_eq!(corners_of(wall, [0.0; 3]), [[0.1, -0.5], [0.1, -0.3 + 0.2]]);
        assert_eq!(disc_of(Geometry::Box { size: [0.0, 0.1, 0.0] }, [0.0; 3]), (Vector::new(0.1, -0.3), 0.0));
        assert_eq!(disc_of(Geometry::Sphere { radius: 0.0 }, [1.0, 2.0, 3.0]), (Vector::new(0.1, -0.3), 0.0));
    }
}
