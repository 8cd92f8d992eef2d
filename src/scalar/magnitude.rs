//! What the terms of a number add up to if none cancels another.

use super::Real;

/// The sum of the magnitudes of all terms that a number was computed from: what its rounding is relative to.
///
/// A result of N operations, one on top of the other, is off by no more than (N + 1) u times its magnitude, and by what
/// underflowed, which counts as a magnitude here. Source: Higham 2002, section 3.1 (with sums of terms in any order).
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Magnitude(pub f64);

/// Divided by the roundoff, it covers the underflow of a few products.
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

    /// A quotient has no bound of this kind.
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
        // 1e-400 underflows, and is off by no more than its bound.
        assert!((numbers[2] * numbers[2]).0 >= UNDERFLOW && (numbers[0] / numbers[1]).0 == f64::INFINITY);
    }
}
