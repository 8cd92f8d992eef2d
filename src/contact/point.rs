//! A material point of a body, and the contact that it makes.

use super::Contact;
use super::face::PARALLEL;
use super::feet::Foot;
use crate::dynamics::{Arm, ContactPoint};
use crate::planar::{Rotation, Vector};
use crate::robot::{Rim, Robot};
use crate::scalar::Real;
use crate::state::NamedContact;
use std::cmp::Ordering;

/// A corner of a foot, or a named contact point, with the rim about it. It is fixed to a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub body: usize,
    pub center: Vector<f64>,
    /// The center in the link's own 3-D frame \[m\], if it was named there.
    pub offset: Option<[f64; 3]>,
    pub rim: Rim,
}

/// A circle that touches the ground, or a point if the radius is 0. It is fixed to a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Circle {
    pub body: usize,
    pub center: Vector<f64>,
    /// The center in the link's own 3-D frame \[m\], if it was named there.
    pub offset: Option<[f64; 3]>,
    pub radius: f64,
}

/// Where a circle or point meets the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    pub circle: Circle,
    /// Rotation from the world's axes to the ground's (tangent, normal) there.
    pub ground: Rotation<f64>,
    /// Height of the material point, center - radius * normal, above the ground \[m\].
    pub gap: f64,
}

impl Touch {
    pub fn by_gap(&self, other: &Self) -> Ordering {
        self.gap.total_cmp(&other.gap)
    }
}

impl Point {
    pub(super) fn named(robot: &Robot, contact: &NamedContact) -> Self {
        let link = &robot.links[contact.link];
        let (center, offset) = (link.point(contact.offset), Some(contact.offset));
        Self { body: link.body, center, offset, rim: Rim::Circle { radius: contact.radius } }
    }
}

pub(crate) fn points(foot: &Foot) -> impl Iterator<Item = Point> {
    (0..foot.outline.corners().len()).map(|at| point(foot, at))
}

/// Returns a corner of a foot with its rim.
pub(super) fn point(foot: &Foot, corner: usize) -> Point {
    let center = foot.outline.corners()[corner];
    Point { body: foot.body, center, offset: foot.offset, rim: foot.outline.rim }
}

impl Contact {
    /// Returns the unit normal of the ground in the world, toward the robot.
    pub fn normal(&self) -> Vector<f64> {
        self.ground.apply(Vector::new(0.0, 1.0))
    }

    /// Returns the unit tangent of the ground in the world: the normal rotated clockwise.
    pub fn tangent(&self) -> Vector<f64> {
        self.ground.apply(Vector::new(1.0, 0.0))
    }

    /// Returns the material contact point in the form that the dynamics take.
    pub fn point_of(&self) -> ContactPoint {
        ContactPoint { body: self.body, center: self.center, radius: self.radius, ground: self.ground }
    }

    /// Returns whether both contacts have the same circle of the same link and body, with any normals.
    pub fn has_circle_of(&self, other: &Self) -> bool {
        (self.link, self.body, self.center, self.radius) == (other.link, other.body, other.center, other.radius)
    }

    /// Returns whether both contacts have the same circle and the same normal. At a ground edge the normal is computed
    /// from positions, so it is compared up to rounding.
    pub fn is_the_same_as(&self, other: &Self) -> bool {
        let is_parallel = || (self.normal() - other.normal()).length() <= PARALLEL;
        self.has_circle_of(other) && (self.ground == other.ground || is_parallel())
    }

    /// Returns the material contact point in any number type. A named point is computed from the digits as given.
    pub fn exact_point<T: Real>(&self, robot: &Robot, ground: Rotation<T>) -> ContactPoint<T> {
        let center = match self.offset {
            Some(offset) => robot.links[self.link].point(offset),
            None => self.center.map(T::from_f64),
        };
        ContactPoint { body: self.body, center, radius: T::from_f64(self.radius), ground }
    }

    /// Returns the arm of the contact for bounds of rounding.
    pub fn arm(&self, robot: &Robot) -> Arm {
        // The sum of the magnitudes of all terms in the center's coordinates.
        let stretch = match self.offset {
            Some(offset) => robot.links[self.link].stretch(offset),
            None => self.center.x.abs() + self.center.z.abs(),
        };
        Arm { body: self.body, length: stretch + self.radius }
    }
}
