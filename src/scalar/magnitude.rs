//! The sum of the magnitudes of all terms of a number.

use super::Real;

/// The sum of the magnitudes of all terms that a number was computed from, to which its rounding is relative.
///
/// After N successive operations, the rounding error is at most (N + 1) u times the magnitude, which also accounts for
/// underflow. Source: Higham 2002, section 3.1 (with sums of terms in any order).
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Magnitude(pub f64);

/// A magnitude that accounts for underflow: times the unit roundoff, it exceeds what a few products lose by underflow.
pub const UNDERFLOW: f64 = 1e20 * f64::MIN_POSITIVE;

operators!([] Magnitude);

impl Magnitude {
    #[inline]
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    #[inline]
    fn minus(self, other: Self) -> Self {
        self.plus(other)
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        Self(self.0 * other.0 + UNDERFLOW)
    }

    /// A quotient has no bound of this kind, so its magnitude is infinite.
    fn over(self, _: Self) -> Self {
        Self(f64::INFINITY)
    }

    fn negated(self) -> Self {
        self
    }
}

impl Real for Magnitude {
    fn from_f64(value: f64) -> Self {
        Self(value.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::dot;

    #[test]
    fn magnitudes_never_cancel() {
        let numbers = [3.0, -4.0, 1e-200].map(Magnitude::from_f64);
        let sum = dot(&numbers, &numbers) - Magnitude::from_f64(5.0);
        assert_eq!((sum.0, (-sum).0), (30.0, 30.0));
        // 1e-400 underflows; the magnitude accounts for its loss.
        assert!((numbers[2] * numbers[2]).0 >= UNDERFLOW && (numbers[0] / numbers[1]).0 == f64::INFINITY);
    }
}
