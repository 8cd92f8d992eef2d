//! Balls: numbers with an error bound.

use super::double::{DoubleDouble, two_sum};
use super::{Enclosure, Midpoint, Ordered, Real, Sign, Trigonometry, series};

/// A real number known to lie within `radius` of `mid`.
///
/// Every operation encloses its exact result: the new radius covers the operands' radii and the rounding of the
/// midpoint. Radii are rounded to nearest and then enlarged by a relative 2^-50, which covers the few roundings of each
/// formula (Rump, Acta Numerica 2010, section 9). An operation that is exact because an operand is an exact zero adds
/// no error, so that structural zeros stay exact. A quotient by a ball that contains zero has an infinite radius.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ball<M = f64> {
    /// The center.
    pub mid: M,
    /// The greatest distance of the number from the center: never negative, infinite if nothing is known.
    pub radius: f64,
}

impl Midpoint for f64 {
    const ROUNDING: f64 = f64::EPSILON / 2.0;

    fn parts(self) -> [f64; 2] {
        [self, 0.0]
    }

    #[inline]
    fn sum(self, other: Self) -> (Self, f64) {
        let (sum, error) = two_sum(self, other);
        (sum, error.abs())
    }
}

/// A factor that covers the roundings in the computation of a radius itself.
const BLOW_UP: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The error of `libm::sincos` that the proofs assume, relative to its result: two units in the last place. The authors
/// of the algorithm (FreeBSD's msun) claim less than one, and the tests check half of it at 100,000 angles.
pub(super) const LIBM_ERROR: f64 = 2.0 * f64::EPSILON;

/// Bits of the series on double-doubles: about one rounding.
const DOUBLE_DOUBLE_BITS: u32 = 106;

impl<M: Midpoint> Ball<M> {
    fn unknown() -> Self {
        Self { mid: M::zero(), radius: f64::INFINITY }
    }

    /// A ball around `mid`; unknown if the center or the radius is not finite.
    fn around(mid: M, radius: f64) -> Self {
        let known = mid.parts().iter().all(|part| part.is_finite()) && radius.is_finite();
        if known { Self { mid, radius: radius * BLOW_UP } } else { Self::unknown() }
    }

    /// A bound of the distance between the number and [`Ordered::to_f64`].
    pub fn error_of_nearest(self) -> f64 {
        (self.mid.parts()[1].abs() + self.radius) * BLOW_UP
    }

    fn is_exact_zero(self) -> bool {
        self.mid.parts() == [0.0; 2] && self.radius == 0.0
    }
}

impl<M: Midpoint> Real for Ball<M> {
    fn from_f64(value: f64) -> Self {
        if value.is_finite() { Self { mid: M::from_f64(value), radius: 0.0 } } else { Self::unknown() }
    }
}

impl<M: Midpoint> Ordered for Ball<M> {
    fn sign(self) -> Sign {
        self.mid.sign_within(self.radius)
    }

    fn to_f64(self) -> f64 {
        if self.radius.is_finite() { self.mid.parts()[0] } else { f64::NAN }
    }

    fn error(self) -> f64 {
        self.radius
    }
}

impl<M: Midpoint> Enclosure for Ball<M> {
    fn widened(self, by: Self) -> Self {
        Self::around(self.mid, self.radius + (by.mid.magnitude() + by.radius))
    }
}

impl Trigonometry for Ball {
    fn cos_sin(angle: f64) -> [Self; 2] {
        if angle == 0.0 {
            return [Self::one(), Self::zero()];
        }
        let (sin, cos) = libm::sincos(angle);
        [cos, sin].map(|value| Self::around(value, value.abs() * LIBM_ERROR + f64::MIN_POSITIVE))
    }
}

impl Trigonometry for Ball<DoubleDouble> {
    fn cos_sin(angle: f64) -> [Self; 2] {
        let halvings = series::halvings(angle, DOUBLE_DOUBLE_BITS);
        series::cos_sin::<Self>(angle, halvings, DOUBLE_DOUBLE_BITS)
            // After the doublings of a huge angle, only the bound that holds for every angle may be left.
            .map(|value| if value.radius <= 1.0 { value } else { Self { mid: Real::zero(), radius: 1.0 } })
    }
}

impl<M: Midpoint> Ball<M> {
    #[inline]
    fn plus(self, other: Self) -> Self {
        if self.is_exact_zero() {
            return other;
        }
        if other.is_exact_zero() {
            return self;
        }
        // Exact sums, especially cancellations, add no error.
        let (mid, error) = self.mid.sum(other.mid);
        Self::around(mid, self.radius + other.radius + error)
    }

    fn minus(self, other: Self) -> Self {
        self + -other
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::zero();
        }
        let mid = self.mid * other.mid;
        let spread =
            self.mid.magnitude() * other.radius + other.mid.magnitude() * self.radius + self.radius * other.radius;
        Self::around(mid, spread + mid.rounding())
    }

    #[inline(never)]
    fn over(self, other: Self) -> Self {
        // The least magnitude of a divisor in the ball; not positive if the divisor may be zero.
        let least = other.mid.least_magnitude() - other.radius * BLOW_UP;
        if least <= 0.0 || least.is_nan() {
            return Self::unknown();
        }
        if self.is_exact_zero() {
            return self;
        }
        let mid = self.mid / other.mid;
        let rounding = mid.quotient_rounding(least);
        // The product's loss by underflow is divided by the divisor as well.
        let tiny = if other.radius == 0.0 { 0.0 } else { f64::MIN_POSITIVE };
        let spread = (self.radius + (mid.magnitude() + rounding) * other.radius + tiny) / least;
        Self::around(mid, spread + rounding)
    }

    fn negated(self) -> Self {
        Self { mid: -self.mid, radius: self.radius }
    }
}

operators!([M: Midpoint] Ball<M>);
