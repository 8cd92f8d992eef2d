//! Vectors, rotations and inertias of the plane; frame, order and handedness are stated here, once.
//!
//! The plane has axes *forward* (x) and *up* (z) and the normal n = up x forward. A vector is `[forward, up]`. An angle
//! is right-handed about n, so a positive one turns up toward forward: **clockwise** seen with forward to the right and up
//! upward, the nose of a robot dips. A rotation is held as the pair (cos, sin) of such an angle; nothing here takes the
//! cosine of anything, so any [`Real`] will do.

use crate::scalar::Real;

/// A vector of the plane, `[forward, up]`.
pub type Vector<T> = [T; 2];

/// A turn about the plane's normal by the angle whose cosine and sine it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation<T> {
    /// Cosine of the angle.
    pub cos: T,
    /// Sine of the angle.
    pub sin: T,
}

impl<T: Real> Rotation<T> {
    /// The turn by nothing.
    pub fn identity() -> Self {
        Self { cos: T::one(), sin: T::zero() }
    }

    /// `vector`, given in the turned frame, in the axes it was turned from.
    pub fn apply(self, [x, z]: Vector<T>) -> Vector<T> {
        [self.cos * x + self.sin * z, self.cos * z - self.sin * x]
    }

    /// The turn by the sum of both angles.
    pub fn then(self, other: Self) -> Self {
        Self { cos: self.cos * other.cos - self.sin * other.sin, sin: self.sin * other.cos + self.cos * other.sin }
    }
}

impl Rotation<f64> {
    /// The turn by `angle` \[rad\], the same bits on every platform.
    pub fn by(angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { cos, sin }
    }
}

/// Velocity of a point at `arm` from an axis that turns at 1 rad/s about the plane's normal.
pub fn turned<T: Real>([x, z]: Vector<T>) -> Vector<T> {
    [z, -x]
}

/// `a + b`.
pub fn sum<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1]]
}

/// `a - b`.
pub fn difference<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1]]
}

/// `factor * a`.
pub fn scaled<T: Real>(factor: T, a: Vector<T>) -> Vector<T> {
    [factor * a[0], factor * a[1]]
}

/// Inner product.
pub fn dot<T: Real>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// Inertia of a rigid body about a point, in axes that do not turn with it
/// (the planar case of Featherstone 2008, section 2.13).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia<T> {
    /// Mass \[kg\].
    pub mass: T,
    /// Mass times the position of the CoG from the point \[kg m\].
    pub first: Vector<T>,
    /// Moment of inertia about the normal through the point \[kg m^2\].
    pub second: T,
}

impl<T: Real> Inertia<T> {
    /// The same body about a point from which the old one is seen at `arm`.
    pub fn seen_from(self, arm: Vector<T>) -> Self {
        let shifted = sum(self.first, scaled(self.mass, arm));
        // I + 2 h.d + m d.d, with the new first moment h + m d in place of one h.
        Self { mass: self.mass, first: shifted, second: self.second + dot(sum(self.first, shifted), arm) }
    }

    /// Both bodies as one; they must be given about the same point.
    pub fn with(self, other: Self) -> Self {
        Self { mass: self.mass + other.mass, first: sum(self.first, other.first), second: self.second + other.second }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_positive_angle_tips_up_toward_forward() {
        let quarter = Rotation { cos: 0.0, sin: 1.0 };
        assert_eq!(quarter.apply([0.0, 1.0]), [1.0, 0.0]);
        assert_eq!(quarter.apply([1.0, 0.0]), [0.0, -1.0]);
        assert_eq!(turned([0.0, 1.0]), [1.0, 0.0]);
    }

    #[test]
    fn inertia_moves_by_steiner() {
        let at_cog = Inertia { mass: 2.0, first: [0.0, 0.0], second: 0.5 };
        let moved = at_cog.seen_from([3.0, 4.0]);
        assert_eq!(moved, Inertia { mass: 2.0, first: [6.0, 8.0], second: 50.5 });
        assert_eq!(moved.seen_from([-3.0, -4.0]), at_cog);
    }
}
