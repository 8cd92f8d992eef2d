//! Feet against a line through the world's origin, level or sloped.
//!
//! ```text
//!     bounding circle --reaches the ground?--> polygon without its rim --parry--> corners within reach of the ground
//! ```
//!
//! parry's contact manifolds (ground as half space first, the order in which they are right) say which corners of a
//! polygon are near; the rim reaches equally far from each. The point that touches, its gap and its velocity are those
//! of the exact material point, not parry's.

use super::feet::Foot;
use super::placement::Placement;
use super::point::{Circle, Point, Touch, points};
use crate::error::{Error, Reason, Result};
use crate::planar::{Rotation, Vector};
use parry2d::math::Vector as ParryVector;
use parry2d::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry2d::shape::HalfSpace;

/// Solid ground below a line through the world's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfPlane {
    /// Turn from the world's axes to the ground's (tangent, normal).
    ground: Rotation<f64>,
}

impl HalfPlane {
    pub const LEVEL: Self = Self { ground: Rotation { cos: 1.0, sin: 0.0 } };

    /// The ground of this slope \[rad\], uphill toward +x, which is a turn against the pitch.
    pub fn sloped(slope: f64) -> Self {
        Self { ground: Rotation::by(-slope) }
    }

    pub(super) fn turned(ground: Rotation<f64>) -> Self {
        Self { ground }
    }

    fn normal(&self) -> Vector<f64> {
        self.ground.apply(Vector::new(0.0, 1.0))
    }

    pub fn circle(&self, placement: &Placement, point: Point) -> Circle {
        placement.circle(point, self.normal())
    }

    /// The world's point of a rim about a corner that is lowest along the normal.
    pub fn lowest(&self, placement: &Placement, point: Point) -> Vector<f64> {
        let Circle { body, center, radius, .. } = self.circle(placement, point);
        placement.world(body, center) - self.normal() * radius
    }

    pub(super) fn height(&self, placement: &Placement, point: Point) -> f64 {
        self.normal().dot(self.lowest(placement, point))
    }

    /// How far a world's point lies along the tangent \[m\].
    pub(super) fn along(&self, point: Vector<f64>) -> f64 {
        self.ground.apply(Vector::new(1.0, 0.0)).dot(point)
    }

    /// How far heights are off by rounding alone: they are sums of a few terms of this size. On level ground it does
    /// not matter how far away the base is.
    pub(super) fn rounding(&self, placement: &Placement, size: f64) -> f64 {
        let Vector { x, z } = placement.base();
        let Vector { x: along, z: up } = self.normal();
        16.0 * f64::EPSILON * (size + (along * x).abs() + (up * z).abs())
    }

    pub(super) fn touch(&self, placement: &Placement, point: Point) -> Touch {
        Touch { circle: self.circle(placement, point), ground: self.ground, gap: self.height(placement, point) }
    }

    /// Whether a foot is so high that none of its points can be within `tolerance` \[m\] of the ground.
    pub(super) fn is_out_of_reach(&self, foot: &Foot, placement: &Placement, tolerance: f64) -> bool {
        let (center, radius) = foot.bounding_circle;
        self.normal().dot(placement.world(foot.body, center)) - radius > tolerance
    }

    /// The points of a foot within `tolerance` \[m\] of the ground or below it: at most two, the ends of the side that
    /// faces it. An error is for a pair of shapes that parry does not serve; none of ours is.
    pub(super) fn touching(&self, foot: &Foot, placement: &Placement, tolerance: f64) -> Result<Vec<Touch>> {
        let touch = |point: Point| self.touch(placement, point);
        if self.is_out_of_reach(foot, placement, tolerance) {
            return Ok(Vec::new());
        }
        let Some(polygon) = foot.outline.polygon() else {
            return Ok(points(foot).map(touch).filter(|touch| touch.gap <= tolerance).collect());
        };
        let Vector { x, z } = self.normal();
        let ground = HalfSpace::new(ParryVector::new(x, z));
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let down = placement.turned_back(foot.body, Vector::new(-x, -z));
        let prediction = tolerance + foot.outline.rim.reach(down);
        let pose = placement.pose(foot.body);
        DefaultQueryDispatcher
            .contact_manifolds(&pose, &ground, &*polygon.0, prediction, &mut manifolds, &mut None)
            .map_err(|unsupported| {
                Error::new(Reason::Unsupported(format!("a foot against the ground: {unsupported}")))
            })?;
        let mut touching: Vec<Point> = Vec::new();
        let near = manifolds.iter().flat_map(|manifold| &manifold.points).filter(|near| near.dist <= prediction);
        for at in near.map(|near| near.local_p2) {
            let far = |point: &Point| libm::hypot(point.center.x - at.x, point.center.z - at.y);
            let nearest = points(foot).min_by(|a, b| far(a).total_cmp(&far(b)));
            touching.extend(nearest.filter(|point| !touching.contains(point)));
        }
        Ok(touching.into_iter().map(touch).collect())
    }
}
