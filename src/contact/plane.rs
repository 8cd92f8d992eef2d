//! Feet against a line through the world's origin, level or sloped.
//!
//! parry's contact manifolds (ground as half space first, the order in which they are right) say which corners of a shape
//! are within the tolerance; the corner itself, its gap and its velocity are those of the exact material point.

use super::feet::Foot;
use super::placement::Placement;
use super::point::{Point, Touch};
use crate::error::{Error, Reason, Result};
use crate::planar::{Rotation, Vector, difference, dot, scaled};
use crate::robot::FootShape;
use parry2d::math::{Pose, Vector as ParryVector};
use parry2d::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry2d::shape::{Ball, HalfSpace, Shape};

/// Solid ground below a line through the world's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    /// Turn from the world's axes to the ground's (tangent, normal).
    ground: Rotation<f64>,
}

impl Plane {
    /// The ground of this slope \[rad\], uphill toward +x, which is a turn against the pitch.
    pub fn sloped(slope: f64) -> Self {
        Self { ground: Rotation::by(-slope) }
    }

    /// The ground with these axes.
    pub(super) fn turned(ground: Rotation<f64>) -> Self {
        Self { ground }
    }

    fn normal(&self) -> Vector<f64> {
        self.ground.apply([0.0, 1.0])
    }

    /// The world's point of a circle (or, with radius 0, a point) of a body that is lowest along the normal.
    pub fn lowest(&self, placement: &Placement, point: Point) -> Vector<f64> {
        difference(placement.world(point.body, point.centre), scaled(point.radius, self.normal()))
    }

    pub(super) fn height(&self, placement: &Placement, point: Point) -> f64 {
        dot(self.normal(), self.lowest(placement, point))
    }

    /// How far a world's point lies along the tangent \[m\].
    pub(super) fn along(&self, point: Vector<f64>) -> f64 {
        dot(self.ground.apply([1.0, 0.0]), point)
    }

    /// How far heights are off by rounding alone: they are sums of a few terms of this size. On level ground it does not
    /// matter how far away the base is.
    pub(super) fn rounding(&self, placement: &Placement, size: f64) -> f64 {
        let [x, z] = placement.base();
        let [along, up] = self.normal();
        16.0 * f64::EPSILON * (size + (along * x).abs() + (up * z).abs())
    }

    pub(super) fn touch(&self, placement: &Placement, point: Point) -> Touch {
        Touch { point, ground: self.ground, gap: self.height(placement, point) }
    }

    /// The points of a foot that parry finds within `tolerance` of the ground or below it.
    ///
    /// # Errors
    /// [`Reason::Unsupported`] for a pair of shapes that parry does not serve; none of ours is.
    pub(super) fn touching(&self, foot: &Foot, placement: &Placement, tolerance: f64) -> Result<Vec<Touch>> {
        let [x, z] = self.normal();
        let ground = HalfSpace::new(ParryVector::new(x, z));
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let mut collide = |pose: Pose, shape: &dyn Shape| {
            DefaultQueryDispatcher.contact_manifolds(&pose, &ground, shape, tolerance, &mut manifolds, &mut None).map_err(
                |unsupported| Error::new(Reason::Unsupported(format!("a foot against the ground: {unsupported}"))),
            )?;
            let points = manifolds.iter().flat_map(|manifold| &manifold.points);
            Ok::<Vec<_>, Error>(points.map(|point| (point.local_p2, point.dist)).collect())
        };
        let mut points: Vec<Point> = Vec::new();
        match &foot.outline {
            FootShape::Disc { centre, radius } => {
                let found = collide(placement.pose(foot.body, *centre), &Ball::new(*radius))?;
                let near = found.iter().any(|&(_, distance)| distance <= tolerance);
                let point = Point { body: foot.body, centre: *centre, offset: foot.offset, radius: *radius };
                points.extend(near.then_some(point));
            }
            FootShape::Polygon { corners, shape } => {
                let found = collide(placement.pose(foot.body, [0.0; 2]), &*shape.0)?;
                for (at, _) in found.into_iter().filter(|&(_, distance)| distance <= tolerance) {
                    let far = |corner: &Vector<f64>| libm::hypot(corner[0] - at.x, corner[1] - at.y);
                    let nearest = corners.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
                    let point = nearest.map(|&centre| Point { body: foot.body, centre, offset: None, radius: 0.0 });
                    points.extend(point.filter(|point| !points.contains(point)));
                }
            }
        }
        Ok(points.into_iter().map(|point| self.touch(placement, point)).collect())
    }
}
