//! Collision shape -> its outline in the plane: corners with a rim (see [`super::shape`]).
//!
//! ```text
//!     sphere, capsule                   projected center line + circle
//!     cylinder along the normal         center + circle
//!     cylinder in the plane, box        zonogon of the projected half axes
//!     cylinder oblique to the plane     projected center line + ellipse, the projection of its rims
//!     mesh                              convex hull of its projected vertices
//! ```

mod hull;
mod zonogon;

use super::{FootShape, Rim};
use crate::description::{Geometry, Matrix, Mesh, apply};
use crate::planar::Vector;

/// Returns the outline of `geometry`. In the body's frame, the shape's frame has its origin at `center` and its axes in
/// the columns of `rotation`. `off_axis` is the greatest angle \[rad\] at which directions count as parallel.
///
/// # Errors
/// Returns the reason if there is no outline.
pub(super) fn outline(
    geometry: &Geometry,
    rotation: &Matrix,
    center: Vector<f64>,
    off_axis: f64,
) -> Result<FootShape, String> {
    // The projection of the shape's axis `k` into the plane.
    let axis = |k: usize| Vector::new(rotation[0][k], rotation[2][k]);
    let half = |k: usize, length: f64| axis(k).map(|component| component * (0.5 * length));
    let Vector { x, z } = axis(2);
    let (in_plane, along_normal) = (libm::hypot(x, z), rotation[1][2].abs());
    let lies_along_normal = libm::atan2(in_plane, along_normal) <= off_axis;
    let lies_in_plane = libm::atan2(along_normal, in_plane) <= off_axis;
    match geometry {
        &Geometry::Sphere { radius } => Ok(FootShape::disc(center, radius)),
        &Geometry::Capsule { radius, .. } | &Geometry::Cylinder { radius, .. } if lies_along_normal => {
            Ok(FootShape::disc(center, radius))
        }
        &Geometry::Capsule { radius, length } => projected(center, &[half(2, length)], Rim::Circle { radius }),
        &Geometry::Cylinder { radius, length } if lies_in_plane => {
            projected(center, &[half(2, length), Vector::new(z * radius, -x * radius)], POINT)
        }
        &Geometry::Cylinder { radius, length } => {
            // The half diameters of the rims along the shape's x and y remain conjugate when projected.
            let half_diameters = [half(0, 2.0 * radius), half(1, 2.0 * radius)];
            projected(center, &[half(2, length)], Rim::Ellipse { half_diameters })
        }
        &Geometry::Box { size } => projected(center, &[0, 1, 2].map(|k| half(k, size[k])), POINT),
        Geometry::Mesh { file, scale, mesh } => {
            let vertices = match mesh {
                Mesh::Vertices(vertices) => vertices,
                Mesh::LeftOut { why } => return Err(why.clone()),
                Mesh::Unread => return Err("its file was not read".into()),
            };
            let project = |vertex: &[f64; 3]| {
                let [x, _, z] = apply(rotation, [0, 1, 2].map(|k| scale[k] * vertex[k]));
                center + Vector::new(x, z)
            };
            let corners = hull::corners(&vertices.iter().map(project).collect::<Vec<_>>())?;
            let mut shape = swept(corners, POINT)?;
            shape.mesh = file.rsplit(['/', '\\']).next().map(str::to_owned);
            Ok(shape)
        }
        Geometry::Unknown { .. } => Err("no shape of URDF".into()),
    }
}

/// A rim that consists of the corner alone.
const POINT: Rim = Rim::Circle { radius: 0.0 };

fn projected(center: Vector<f64>, half_sides: &[Vector<f64>], rim: Rim) -> Result<FootShape, String> {
    swept(zonogon::corners(center, half_sides), rim)
}

/// Merges neighboring corners that are equal in f64.
fn swept(mut corners: Vec<Vector<f64>>, rim: Rim) -> Result<FootShape, String> {
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    FootShape::swept(corners, rim).ok_or_else(|| "its corners are not distinct in f64".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Pose;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, TAU};

    const CENTER: Vector<f64> = Vector { x: 0.1, z: -0.3 };
    const SOLE: Geometry = Geometry::Box { size: [0.2, 0.1, 0.04] };
    const ROD: Geometry = Geometry::Cylinder { radius: 0.05, length: 0.4 };
    const CAPSULE: Geometry = Geometry::Capsule { radius: 0.05, length: 0.4 };

    fn outline_of(geometry: &Geometry, rpy: [f64; 3]) -> FootShape {
        outline(geometry, &Pose { xyz: [0.0; 3], rpy }.rotation(), CENTER, 1e-3).expect("an outline")
    }

    /// Asserts that the outline has these corners in order, up to `off`, and a circle of this radius about each.
    #[track_caller]
    fn assert_outline(geometry: &Geometry, rpy: [f64; 3], off: f64, corners: &[Vector<f64>], radius: f64) {
        let shape = outline_of(geometry, rpy);
        let far = |(a, b): (&Vector<f64>, &Vector<f64>)| (a.x - b.x).abs().max((a.z - b.z).abs()) > off;
        let differs = shape.corners().len() != corners.len() || shape.corners().iter().zip(corners).any(far);
        assert!(!differs, "{geometry:?} {rpy:?}: {:?}", shape.corners());
        assert_eq!(shape.rim, Rim::Circle { radius });
    }

    fn rectangle(x: f64, z: f64) -> [Vector<f64>; 4] {
        [[0.1 - x, -0.3 - z], [0.1 + x, -0.3 - z], [0.1 + x, -0.3 + z], [0.1 - x, -0.3 + z]].map(Vector::from)
    }

    fn mesh(vertices: &[[f64; 3]], scale: [f64; 3]) -> Geometry {
        Geometry::Mesh { file: "package://p/sole.stl".into(), scale, mesh: Mesh::Vertices(vertices.into()) }
    }

    fn eight(half: [f64; 3]) -> Vec<[f64; 3]> {
        (0..8).map(|bits| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { -half[k] } else { half[k] })).collect()
    }

    #[test]
    fn outlines_have_the_corners_worked_by_hand() {
        let (unturned, rolled) = ([0.0; 3], [FRAC_PI_2, 0.0, 0.0]);
        let line = |a: [f64; 2], b: [f64; 2]| [a, b].map(Vector::from);
        assert_outline(&SOLE, unturned, 0.0, &rectangle(0.1, 0.02), 0.0);
        // With roll, the y side is vertical. With yaw, y points forward.
        assert_outline(&SOLE, rolled, 1e-15, &rectangle(0.1, 0.05), 0.0);
        assert_outline(&SOLE, [0.0, 0.0, FRAC_PI_2], 1e-15, &rectangle(0.05, 0.02), 0.0);
        assert_outline(&ROD, rolled, 0.0, &[CENTER], 0.05);
        assert_outline(&ROD, [-FRAC_PI_2, 0.0, 0.0], 0.0, &[CENTER], 0.05);
        assert_outline(&ROD, unturned, 0.0, &rectangle(0.05, 0.2), 0.0);
        assert_outline(&CAPSULE, rolled, 0.0, &[CENTER], 0.05);
        assert_outline(&CAPSULE, unturned, 0.0, &line([0.1, -0.5], [0.1, -0.3 + 0.2]), 0.05);
        // Rolled by 60 degrees, the center line appears at half its length.
        assert_outline(&CAPSULE, [FRAC_PI_3, 0.0, 0.0], 1e-15, &line([0.1, -0.4], [0.1, -0.2]), 0.05);
        let flat = |x, z| Geometry::Box { size: [x, 0.1, z] };
        assert_outline(&flat(0.2, 0.0), unturned, 0.0, &line([0.1 - 0.1, -0.3], [0.1 + 0.1, -0.3]), 0.0);
        assert_outline(&flat(0.0, 0.4), unturned, 0.0, &line([0.1, -0.5], [0.1, -0.3 + 0.2]), 0.0);
        // The box is thinner than a mesh's side may bulge; its lower side is the sole.
        assert_outline(&flat(0.2, 2e-8), unturned, 0.0, &rectangle(0.1, 1e-8), 0.0);
        assert_outline(&flat(0.0, 0.0), unturned, 0.0, &[CENTER], 0.0);
        // The shape is so short that both ends are equal in f64.
        assert_outline(&Geometry::Capsule { radius: 0.05, length: 1e-17 }, unturned, 0.0, &[CENTER], 0.05);
        assert_outline(&flat(1e-18, 0.4), unturned, 0.0, &line([0.1, -0.5], [0.1, -0.3 + 0.2]), 0.0);
        assert_outline(&Geometry::Sphere { radius: 0.0 }, [1.0, 2.0, 3.0], 0.0, &[CENTER], 0.0);

        // Pitch exchanges x and z. Rounding decides which of the two level corners comes first.
        let mut corners = outline_of(&SOLE, [0.0, FRAC_PI_2, 0.0]).corners().to_vec();
        corners.sort_by(|a, b| (a.z + 0.01 * a.x).total_cmp(&(b.z + 0.01 * b.x)));
        let expected = [[0.08, -0.4], [0.12, -0.4], [0.08, -0.2], [0.12, -0.2]].map(Vector::from);
        assert!(corners.len() == 4 && corners.iter().zip(expected).all(|(&a, b)| (a - b).length() < 1e-15));
    }

    #[test]
    fn a_mesh_has_its_hull_scaled_along_its_own_axes() {
        let sole = mesh(&eight([0.1, 0.05, 0.02]), [1.0; 3]);
        assert_outline(&sole, [0.0; 3], 0.0, outline_of(&SOLE, [0.0; 3]).corners(), 0.0);
        let turned = outline_of(&SOLE, [0.4, 0.3, 0.9]);
        assert_eq!(turned.corners().len(), 6);
        assert_outline(&sole, [0.4, 0.3, 0.9], 1e-15, turned.corners(), 0.0);
        assert_eq!(outline_of(&sole, [0.0; 3]).mesh.as_deref(), Some("sole.stl"));

        // A wedge whose tip points forward and down, seen from the side after scaling.
        let wedge = [[0.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 0.5, 1.0]];
        let cases: [([f64; 3], &[[f64; 2]]); 4] = [
            ([1.0; 3], &[[1.1, -1.3], [0.1, 0.7], [0.1, -0.3]]),
            ([-0.5, 3.0, 0.25], &[[-0.4, -0.55], [0.1, -0.3], [0.1, -0.05]]),
            ([1.0, 1.0, 0.0], &[[0.1, -0.3], [1.1, -0.3]]),
            ([0.0; 3], &[[0.1, -0.3]]),
        ];
        for (scale, corners) in cases {
            let corners: Vec<_> = corners.iter().copied().map(Vector::from).collect();
            assert_outline(&mesh(&wedge, scale), [0.0; 3], 1e-15, &corners, 0.0);
        }
    }

    #[test]
    fn outlines_reach_as_far_as_the_surface_in_space() {
        // The rims of a cylinder, sampled by angle: the sampling error is 1 - cos of half a step.
        let turns = || (0..4000).map(|step| (f64::from(step) * TAU / 4000.0).sin_cos());
        let rims = [-0.2, 0.2].into_iter().flat_map(|z| turns().map(move |(sin, cos)| [0.05 * cos, 0.05 * sin, z]));
        let shapes =
            [(ROD, rims.collect::<Vec<_>>()), (Geometry::Box { size: [0.2, 0.4, 0.6] }, eight([0.1, 0.2, 0.3]))];
        for rpy in [[0.7, 0.3, 0.2], [FRAC_PI_4, 0.0, 0.0], [1.5, 0.1, -2.0], [0.1, FRAC_PI_2, 0.4], [0.01, 0.0, 0.0]] {
            let rotation = Pose { xyz: [0.0; 3], rpy }.rotation();
            for (geometry, surface) in &shapes {
                let shape = outline_of(geometry, rpy);
                let seen = surface.iter().map(|&point| apply(&rotation, point)).map(|[x, _, z]| Vector::new(x, z));
                for direction in (0..24).map(|step| (0.1 + f64::from(step)).sin_cos()).map(|(s, c)| Vector::new(c, s)) {
                    let tip = |&corner: &Vector<f64>| corner - CENTER + shape.rim.support(direction);
                    let farther = |a: &Vector<f64>, b: &Vector<f64>| a.dot(direction).total_cmp(&b.dot(direction));
                    let farthest = shape.corners().iter().map(tip).max_by(farther).expect("a corner");
                    let sampled = seen.clone().max_by(farther).expect("a point");
                    let off = (farthest - sampled).dot(direction).abs();
                    assert!(off < 1e-7, "{geometry:?} {rpy:?} {direction:?}: {off}");
                    // The point lies on the surface itself, and is not only equally far along the direction.
                    let nearest = seen.clone().map(|at| (farthest - at).length()).fold(f64::MAX, f64::min);
                    assert!(nearest < 1e-4, "{geometry:?} {rpy:?} {direction:?}: {nearest}");
                }
            }
        }
    }
}
