//! Feet against a line through the world's origin, level or sloped.
//!
//! ```text
//!     foot whose bounding circle reaches the ground --> corners with their rims --sole--> rearmost and foremost
//! ```
//!
//! The contact point, its gap and its velocity are those of a material point, without approximation.

use super::feet::Foot;
use super::placement::Placement;
use super::point::{Circle, Point, Touch, point, points};
use super::sole::sole;
use crate::planar::{Rotation, Vector};

/// Solid ground below a line through the world's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfPlane {
    /// Rotation from the world's axes to the ground's (tangent, normal).
    ground: Rotation<f64>,
    tangent: Vector<f64>,
    pub(super) normal: Vector<f64>,
}

impl HalfPlane {
    pub const LEVEL: Self = Self {
        ground: Rotation { cos: 1.0, sin: 0.0 },
        tangent: Vector { x: 1.0, z: 0.0 },
        normal: Vector { x: 0.0, z: 1.0 },
    };

    /// Creates ground of this slope \[rad\]. A positive slope rises toward +x, and is a negative pitch.
    pub fn sloped(slope: f64) -> Self {
        Self::turned(Rotation::by(-slope))
    }

    pub(super) fn turned(ground: Rotation<f64>) -> Self {
        let [tangent, normal] = Vector::axes().map(|axis| ground.apply(axis));
        Self { ground, tangent, normal }
    }

    pub fn circle(&self, placement: &Placement, point: Point) -> Circle {
        placement.circle(point, self.normal)
    }

    /// Returns the lowest point of a corner's rim along the normal, in the world \[m\].
    pub fn lowest(&self, placement: &Placement, point: Point) -> Vector<f64> {
        let Circle { body, center, radius, .. } = self.circle(placement, point);
        placement.world(body, center) - self.normal * radius
    }

    pub(super) fn height(&self, placement: &Placement, point: Point) -> f64 {
        self.normal.dot(self.lowest(placement, point))
    }

    /// Returns the coordinate along the tangent of a point in the world \[m\].
    pub(super) fn along(&self, point: Vector<f64>) -> f64 {
        self.tangent.dot(point)
    }

    /// Bounds the rounding of heights \[m\], which are sums of a few terms of this size. On level ground the base's x
    /// does not count.
    pub(super) fn rounding(&self, placement: &Placement, size: f64) -> f64 {
        let Vector { x, z } = placement.base();
        let Vector { x: along, z: up } = self.normal;
        16.0 * f64::EPSILON * (size + (along * x).abs() + (up * z).abs())
    }

    pub(super) fn touch(&self, placement: &Placement, point: Point) -> Touch {
        Touch { circle: self.circle(placement, point), ground: self.ground, gap: self.height(placement, point) }
    }

    /// Returns a lower bound on the height of all points of a foot \[m\].
    pub(super) fn least_gap(&self, foot: &Foot, placement: &Placement) -> f64 {
        let (center, radius) = foot.bounding_circle;
        self.normal.dot(placement.world(foot.body, center)) - radius
    }

    /// Returns the rearmost and the foremost corner on which a foot stands, or one if they are the same. Corners at
    /// most `highest` \[m\] above the plane are on it.
    pub(super) fn sole(&self, foot: &Foot, placement: &Placement, highest: f64) -> impl Iterator<Item = Point> {
        let place = |at: usize| {
            let lowest = self.lowest(placement, point(foot, at));
            Vector::new(self.along(lowest), self.normal.dot(lowest))
        };
        let ends = sole(foot.outline.corners().len(), place, highest, foot.bumps);
        let both = ends.map(|[rear, front]| [Some(rear), (front != rear).then_some(front)]);
        both.into_iter().flatten().flatten().map(|at| point(foot, at))
    }

    /// Passes to `found` the contacts of a foot within `tolerance` \[m\] of the ground, at most two. Returns the depth
    /// \[m\] of a foot that is deeper as an error.
    pub(super) fn touching(
        &self,
        foot: &Foot,
        placement: &Placement,
        tolerance: f64,
        mut found: impl FnMut(Touch),
    ) -> Result<(), f64> {
        // Fast path for a single corner, because most robots have round feet.
        if foot.outline.corners().len() == 1 {
            let touch = self.touch(placement, point(foot, 0));
            if touch.gap < -tolerance {
                return Err(-touch.gap);
            }
            if touch.gap <= tolerance {
                found(touch);
            }
            return Ok(());
        }
        if self.least_gap(foot, placement) > tolerance {
            return Ok(());
        }
        let depth = -self.clearance(foot, placement);
        if depth > tolerance {
            return Err(depth);
        }
        self.sole(foot, placement, tolerance).map(|point| self.touch(placement, point)).for_each(found);
        Ok(())
    }

    /// Returns the height of a foot's lowest point above the ground \[m\].
    pub(super) fn clearance(&self, foot: &Foot, placement: &Placement) -> f64 {
        points(foot).map(|point| self.height(placement, point)).fold(f64::INFINITY, f64::min)
    }
}
