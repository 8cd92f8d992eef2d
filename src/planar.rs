//! Vectors, rotations and inertias of the plane. This module defines the frame, the order of components and the
//! handedness for the whole crate.
//!
//! The plane has axes *forward* (x) and *up* (z) and the normal n = up x forward. An angle is right-handed about n: a
//! positive angle rotates up toward forward. If forward points right and up points up, this rotation is **clockwise**,
//! and the nose of a robot dips. A rotation is stored as (cos, sin) of its angle, in any number type [`Real`].

use crate::scalar::{Real, Trigonometry};
use serde::{Deserialize, Serialize, Serializer};
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A position, direction, velocity, force or impulse in the plane; `[x, z]` in JSON.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(from = "[T; 2]")]
pub struct Vector<T = f64> {
    /// Component forward.
    pub x: T,
    /// Component up.
    pub z: T,
}

/// `[tangential, normal]` components of a contact's velocity or impulse, in the contact's own axes.
pub type Pair<T> = [T; 2];

impl<T> Vector<T> {
    /// Creates the vector with the given components.
    pub const fn new(x: T, z: T) -> Self {
        Self { x, z }
    }

    /// Returns `[x, z]`.
    pub fn components(self) -> [T; 2] {
        [self.x, self.z]
    }

    /// Applies `change` to both components.
    pub fn map<U>(self, mut change: impl FnMut(T) -> U) -> Vector<U> {
        Vector { x: change(self.x), z: change(self.z) }
    }
}

impl<T: Real> Vector<T> {
    /// Returns the unit vectors forward and up.
    pub fn axes() -> [Self; 2] {
        [Self { x: T::one(), z: T::zero() }, Self { x: T::zero(), z: T::one() }]
    }

    /// Returns the zero vector.
    pub fn zero() -> Self {
        Self { x: T::zero(), z: T::zero() }
    }

    /// Returns the scalar product.
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.z * other.z
    }

    /// Rotates the vector by +90 degrees about the normal. The result is the velocity of a point with this position
    /// vector when its body rotates at 1 rad/s about the origin.
    pub fn perpendicular(self) -> Self {
        Self { x: self.z, z: -self.x }
    }
}

impl Vector<f64> {
    /// Returns the Euclidean norm.
    pub fn length(self) -> f64 {
        libm::hypot(self.x, self.z)
    }

    /// Returns the smaller value of each component.
    pub fn least(self, other: Self) -> Self {
        Self { x: self.x.min(other.x), z: self.z.min(other.z) }
    }

    /// Returns the larger value of each component.
    pub fn greatest(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), z: self.z.max(other.z) }
    }
}

impl<T: Real> Add for Vector<T> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, z: self.z + other.z }
    }
}

impl<T: Real> AddAssign for Vector<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Sub for Vector<T> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, z: self.z - other.z }
    }
}

impl<T: Real> Neg for Vector<T> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { x: -self.x, z: -self.z }
    }
}

impl<T: Real> Mul<T> for Vector<T> {
    type Output = Self;

    fn mul(self, factor: T) -> Self {
        Self { x: factor * self.x, z: factor * self.z }
    }
}

impl<T> From<[T; 2]> for Vector<T> {
    fn from([x, z]: [T; 2]) -> Self {
        Self { x, z }
    }
}

impl<T: PartialEq> PartialEq<[T; 2]> for Vector<T> {
    fn eq(&self, [x, z]: &[T; 2]) -> bool {
        self.x == *x && self.z == *z
    }
}

impl<T: Serialize> Serialize for Vector<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [&self.x, &self.z].serialize(serializer)
    }
}

#[cfg(feature = "schema")]
impl<T: schemars::JsonSchema> schemars::JsonSchema for Vector<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        <[T; 2]>::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        <[T; 2]>::json_schema(generator)
    }
}

/// A rotation about the plane's normal, as the cosine and sine of its angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation<T> {
    /// Cosine of the angle.
    pub cos: T,
    /// Sine of the angle.
    pub sin: T,
}

impl<T: Real> Rotation<T> {
    /// Returns the rotation by zero.
    pub fn identity() -> Self {
        Self { cos: T::one(), sin: T::zero() }
    }

    /// Rotates `vector`: takes components in the rotated frame and returns components in the original frame.
    #[inline]
    pub fn apply(self, Vector { x, z }: Vector<T>) -> Vector<T> {
        Vector { x: self.cos * x + self.sin * z, z: self.cos * z - self.sin * x }
    }

    /// Returns the inverse rotation.
    pub fn back(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }

    /// Returns the rotation by the sum of both angles.
    #[inline]
    pub fn then(self, other: Self) -> Self {
        Self { cos: self.cos * other.cos - self.sin * other.sin, sin: self.sin * other.cos + self.cos * other.sin }
    }
}

impl<T: Trigonometry> Rotation<T> {
    /// Creates the rotation by `angle` \[rad\]. In f64, the result has the same bits on every platform.
    pub fn by(angle: f64) -> Self {
        let [cos, sin] = T::cos_sin(angle);
        Self { cos, sin }
    }
}

/// Inertia of a rigid body about a reference point, in a fixed set of axes (the planar case of Featherstone 2008,
/// section 2.13).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia<T> {
    /// Mass \[kg\].
    pub mass: T,
    /// Mass times the vector from the reference point to the center of mass \[kg m\].
    pub first: Vector<T>,
    /// Moment of inertia about the normal through the reference point \[kg m^2\].
    pub second: T,
}

impl<T: Real> Inertia<T> {
    /// Expresses the inertia, given in the body's axes, in axes relative to which the body is rotated by `turn`.
    #[inline]
    pub fn turned(self, turn: Rotation<T>) -> Self {
        Self { first: turn.apply(self.first), ..self }
    }

    /// Moves the reference point: `arm` is the vector from the new reference point to the old one.
    #[inline]
    pub fn seen_from(self, arm: Vector<T>) -> Self {
        let shifted = self.first + arm * self.mass;
        // I + 2 h.d + m d.d; the new first moment h + m d already contains one m d.
        Self { mass: self.mass, first: shifted, second: self.second + (self.first + shifted).dot(arm) }
    }

    /// Adds the inertia of another body. Both must have the same reference point.
    #[inline]
    pub fn with(self, other: Self) -> Self {
        Self { mass: self.mass + other.mass, first: self.first + other.first, second: self.second + other.second }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_positive_angle_tips_up_toward_forward() {
        let quarter = Rotation { cos: 0.0, sin: 1.0 };
        assert_eq!(quarter.apply(Vector::new(0.0, 1.0)), Vector::new(1.0, 0.0));
        assert_eq!(quarter.apply(Vector::new(1.0, 0.0)), Vector::new(0.0, -1.0));
        assert_eq!(Vector::new(0.0, 1.0).perpendicular(), Vector::new(1.0, 0.0));
    }
}
