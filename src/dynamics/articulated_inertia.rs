//! Articulated-body inertia: the inertia of a body while the joints beyond it move freely.

use crate::planar::{Inertia, Vector};
use crate::scalar::Real;

/// The symmetric matrix [[moment, coupling^T], [coupling, linear]]: the inertia of a body and of all that it carries
/// while the joints beyond it move freely, about the body's origin in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArticulatedInertia<T> {
    /// Moment for a unit angular acceleration \[kg m^2\].
    pub moment: T,
    /// Force for a unit angular acceleration, moment for a unit linear one \[kg m\].
    pub coupling: Vector<T>,
    /// Force for a unit linear acceleration: entries xx, xz, zz \[kg\].
    pub linear: [T; 3],
}

impl<T: Real> ArticulatedInertia<T> {
    pub(super) fn rigid(body: Inertia<T>) -> Self {
        Self { moment: body.second, coupling: body.first.perpendicular(), linear: [body.mass, T::zero(), body.mass] }
    }

    /// Returns the force for the linear acceleration `along`.
    #[inline]
    pub(super) fn stretch(&self, along: Vector<T>) -> Vector<T> {
        let [xx, xz, zz] = self.linear;
        Vector { x: Vector::new(xx, xz).dot(along), z: Vector::new(xz, zz).dot(along) }
    }

    /// Returns the part of the inertia that a revolute joint with pivot D = moment + rotor transmits to the parent.
    /// Products are computed as u (u / D), because u u (1 / D) underflows for small masses.
    #[inline]
    pub(super) fn without_turn(&self, rotor: T, pivot: T) -> Self {
        let kept = rotor / pivot;
        let [xx, xz, zz] = self.linear;
        let Vector { x, z } = self.coupling;
        let [by_x, by_z] = [x / pivot, z / pivot];
        Self {
            moment: self.moment * kept,
            coupling: self.coupling * kept,
            linear: [xx - x * by_x, xz - x * by_z, zz - z * by_z],
        }
    }

    /// Returns the part of the inertia that a prismatic joint along `along` with pivot D transmits to the parent.
    /// Components along and across the joint are kept apart: what the joint does not transmit cancels before rounding.
    #[inline]
    pub(super) fn without_slide(&self, along: Vector<T>, rotor: T, pivot: T) -> Self {
        let across = along.perpendicular();
        let (pulled, pushed) = (self.stretch(along), self.stretch(across));
        let (same, mixed, other) = (along.dot(pulled), across.dot(pulled), across.dot(pushed));
        let (lever, side) = (along.dot(self.coupling), across.dot(self.coupling));
        let (kept, by_lever) = (rotor / pivot, lever / pivot);
        let (same, other, mixed) = (same * kept, other - mixed * (mixed / pivot), mixed * kept);
        let (lever, side, spent) = (lever * kept, side - across.dot(pulled) * by_lever, lever * by_lever);
        // `along` has length one up to rounding. The division by its square makes the formula right for any length.
        let square = along.dot(along);
        let [same, other, mixed] = [same, other, mixed].map(|entry| entry / square / square);
        let [Vector { x, z }, Vector { x: p, z: q }] = [along, across];
        let two = T::one() + T::one();
        Self {
            moment: self.moment - spent,
            coupling: along * (lever / square) + across * (side / square),
            linear: [
                same * x * x + two * (mixed * x * p) + other * p * p,
                same * x * z + mixed * (x * q + z * p) + other * p * q,
                same * z * z + two * (mixed * z * q) + other * q * q,
            ],
        }
    }

    /// Moves the reference point: `arm` is the vector from the new reference point to the old one.
    #[inline]
    pub(super) fn seen_from(self, arm: Vector<T>) -> Self {
        let lever = arm.perpendicular();
        let shifted = self.coupling + self.stretch(lever);
        // A + 2 h.l + l.M l; the new coupling h + M l already contains one M l.
        Self { moment: self.moment + (self.coupling + shifted).dot(lever), coupling: shifted, linear: self.linear }
    }

    /// Adds another inertia. Both must have the same reference point.
    #[inline]
    pub(super) fn with(self, other: Self) -> Self {
        let [[a, b, c], [d, e, f]] = [self.linear, other.linear];
        Self {
            moment: self.moment + other.moment,
            coupling: self.coupling + other.coupling,
            linear: [a + d, b + e, c + f],
        }
    }
}

/// A force and its moment about a body's origin in world axes \[N, N m\]; also an impulse or momentum \[N s, N m s\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Wrench<T> {
    pub moment: T,
    pub linear: Vector<T>,
}

impl<T: Real> Wrench<T> {
    #[inline]
    pub fn at(arm: Vector<T>, linear: Vector<T>) -> Self {
        Self { moment: arm.perpendicular().dot(linear), linear }
    }

    /// Moves the reference point: `arm` is the vector from the new reference point to the old one.
    #[inline]
    pub fn seen_from(self, arm: Vector<T>) -> Self {
        Self { moment: self.moment + arm.perpendicular().dot(self.linear), linear: self.linear }
    }

    /// Adds another wrench. Both must have the same reference point.
    #[inline]
    pub fn with(self, other: Self) -> Self {
        Self { moment: self.moment + other.moment, linear: self.linear + other.linear }
    }
}
