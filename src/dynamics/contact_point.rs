//! A material point in touch with the ground, as the dynamics need it.

use super::workspace::Workspace;
use crate::planar::{Rotation, Vector};
use crate::scalar::Real;

/// A material point in touch with the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint<T = f64> {
    /// The body, an index into the plan's bodies (those of [`Robot::bodies`](crate::Robot)).
    pub body: usize,
    /// The point, or the centre of the circle, in the body's frame \[m\].
    pub centre: Vector<T>,
    /// Radius of the circle \[m\]: the point is at centre - radius * normal.
    pub radius: T,
    /// Turn from the world's axes to the ground's (tangent, normal) at the contact.
    pub ground: Rotation<T>,
}

impl<T: Real> ContactPoint<T> {
    /// The ground's unit tangent and normal in the world's axes.
    pub fn axes(&self) -> [Vector<T>; 2] {
        Vector::axes().map(|axis| self.ground.apply(axis))
    }

    /// The point from its body's origin, in the world's axes \[m\].
    pub fn arm(&self, workspace: &Workspace<T>) -> Vector<T> {
        let [_, normal] = self.axes();
        workspace.rotation[self.body].apply(self.centre) - normal * self.radius
    }
}
