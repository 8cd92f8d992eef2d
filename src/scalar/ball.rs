//! Numbers with an error bound.

use super::double::{DoubleDouble, two_sum};
use super::{Enclosure, Midpoint, Ordered, Real, Sign, Trigonometry, series};

/// A real number known to lie within `radius` of `mid`.
///
/// Every operation encloses its exact result: the radius takes the operands' radii and the rounding of the midpoint.
/// Radii are rounded to nearest and then enlarged by a relative 2^-50, which covers the few roundings of each formula
/// (Rump, Acta Numerica 2010, section 9); an operation that is exact because an operand is an exact zero adds nothing,
/// so that structural zeros stay zeros. A quotient by a ball that contains zero has an infinite radius.
///
/// Cost: about 5 operations of the midpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<M = f64> {
    /// The centre.
    pub mid: M,
    /// The greatest distance of the number from the centre; never negative, infinite if nothing is known.
    pub radius: f64,
}

impl Midpoint for f64 {
    /// Half the distance from 1 to the next f64.
    const ROUNDING: f64 = f64::EPSILON / 2.0;

    #[inline]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    #[inline]
    fn magnitude(self) -> f64 {
        self.abs()
    }

    #[inline]
    fn least_magnitude(self) -> f64 {
        self.abs()
    }

    #[inline]
    fn sum(self, other: Self) -> (Self, f64) {
        let (sum, error) = two_sum(self, other);
        (sum, error.abs())
    }

    #[inline]
    fn sign_within(self, radius: f64) -> Sign {
        Sign::within(self, radius)
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}

/// Covers the roundings in the computation of a radius itself.
const BLOW_UP: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The error that the proofs assume of `libm::sincos`, relative to its result: two units in the last place. Its
/// authors (FreeBSD's msun) claim less than one, and the tests look for more at 100,000 angles.
pub(super) const LIBM_ERROR: f64 = 2.0 * f64::EPSILON;

/// Bits of the series on double-doubles, about one rounding.
const DOUBLE_DOUBLE_BITS: u32 = 106;

impl<M: Midpoint> Ball<M> {
    /// The number of which nothing is known.
    #[inline]
    fn unknown() -> Self {
        Self { mid: M::zero(), radius: f64::INFINITY }
    }

    /// A ball around `mid`; with a centre or a radius that is not finite nothing is known.
    #[inline]
    fn around(mid: M, radius: f64) -> Self {
        if mid.is_finite() && radius.is_finite() { Self { mid, radius: radius * BLOW_UP } } else { Self::unknown() }
    }

    #[inline]
    fn is_exact_zero(self) -> bool {
        self.mid.is_zero() && self.radius == 0.0
    }
}

impl<M: Midpoint> Real for Ball<M> {
    #[inline]
    fn from_f64(value: f64) -> Self {
        if value.is_finite() { Self { mid: M::from_f64(value), radius: 0.0 } } else { Self::unknown() }
    }
}

impl<M: Midpoint> Ordered for Ball<M> {
    #[inline]
    fn sign(self) -> Sign {
        self.mid.sign_within(self.radius)
    }

    #[inline]
    fn to_f64(self) -> f64 {
        if self.radius.is_finite() { self.mid.to_f64() } else { f64::NAN }
    }

    fn error(self) -> f64 {
        self.radius
    }
}

impl<M: Midpoint> Enclosure for Ball<M> {
    #[inline]
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
            // After the doublings of a huge angle only what holds for every angle is known.
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
        // Exact sums, cancellations above all, add no error.
        let (mid, error) = self.mid.sum(other.mid);
        Self::around(mid, self.radius + other.radius + error)
    }

    #[inline]
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

    #[inline]
    fn over(self, other: Self) -> Self {
        // The least magnitude in the divisor; not positive when it may be zero.
        let least = other.mid.least_magnitude() - other.radius * BLOW_UP;
        if least <= 0.0 || least.is_nan() {
            return Self::unknown();
        }
        if self.is_exact_zero() {
            return self;
        }
        let mid = self.mid / other.mid;
        let rounding = mid.quotient_rounding(least);
        // The loss of the product by underflow is divided by the divisor below.
        let tiny = if other.radius == 0.0 { 0.0 } else { f64::MIN_POSITIVE };
        let spread = (self.radius + (mid.magnitude() + rounding) * other.radius + tiny) / least;
        Self::around(mid, spread + rounding)
    }

    #[inline]
    fn negated(self) -> Self {
        Self { mid: -self.mid, radius: self.radius }
    }
}

operators!([M: Midpoint] Ball<M>);

#[cfg(test)]
mod tests {
    use super::super::exact::{exact, magnitude};
    use super::*;
    use dashu::rational::RBig;
    use proptest::prelude::*;

    fn encloses(ball: Ball, value: &RBig) -> bool {
        if ball.radius.is_infinite() {
            return true;
        }
        magnitude(exact(ball.mid) - value) <= exact(ball.radius)
    }

    proptest! {
        #[test]
        fn operations_enclose_exact_results(
            a in -1e3..1e3f64, b in -1e3..1e3f64, c in -1e-3..1e-3f64, k in -60..60i32,
        ) {
            let b = b * f64::from(k).exp2();
            let (x, y, z) = (Ball::from_f64(a), Ball::from_f64(b), Ball::from_f64(c));
            let (p, q, r) = (exact(a), exact(b), exact(c));
            prop_assert!(encloses(x * y + z, &(&p * &q + &r)));
            prop_assert!(encloses((x + y) * (z - x), &((&p + &q) * (&r - &p))));
            if c != 0.0 && b != 0.0 {
                prop_assert!(encloses((x + z) / y / z, &((&p + &r) / &q / &r)));
            }
        }
    }

    fn wide(hi: f64, lo: f64) -> Ball<DoubleDouble> {
        Ball::from_f64(hi) + Ball::from_f64(lo)
    }

    fn wide_encloses(ball: Ball<DoubleDouble>, value: &RBig) -> bool {
        if ball.radius.is_infinite() {
            return true;
        }
        let [hi, lo] = ball.mid.parts().map(exact);
        magnitude(hi + lo - value) <= exact(ball.radius)
    }

    proptest! {
        #[test]
        fn operations_on_double_doubles_enclose_exact_results(
            a in -1e3..1e3f64, b in -1e3..1e3f64, c in -1e-3..1e-3f64, d in -1e-15..1e-15f64, k in -300..300i32,
        ) {
            let (b, e) = (b * f64::from(k).exp2(), d * f64::from(k).exp2());
            let (x, y, z) = (wide(a, d), wide(b, e), wide(c, d / 1e3));
            let (p, q, r) = (exact(a) + exact(d), exact(b) + exact(e), exact(c) + exact(d / 1e3));
            prop_assert!(wide_encloses(x, &p) && wide_encloses(y, &q) && wide_encloses(z, &r));
            prop_assert!(wide_encloses(x * y + z, &(&p * &q + &r)));
            prop_assert!(wide_encloses((x + y) * (z - x), &((&p + &q) * (&r - &p))));
            prop_assert!(wide_encloses(x * y - y * z, &(&p * &q - &q * &r)));
            if b != 0.0 && c != 0.0 {
                let (quotient, truth) = ((x + z) / y / z, (&p + &r) / &q / &r);
                prop_assert!(wide_encloses(quotient, &truth));
                prop_assert!(wide_encloses((quotient - x) / (quotient * y), &((&truth - &p) / (&truth * &q))));
            }
        }

        #[test]
        fn underflow_is_enclosed(a in 1.0..2.0f64, b in 1.0..2.0f64, i in -1074..100i32, j in -1074..100i32) {
            let (a, b) = (libm::scalbn(a, i), libm::scalbn(b, j));
            let (p, q) = (exact(a), exact(b));
            let (x, y) = (Ball::<f64>::from_f64(a), Ball::<f64>::from_f64(b));
            prop_assert!(encloses(x * y, &(&p * &q)) && encloses(x / y, &(&p / &q)));
            prop_assert!(encloses(x * x / y, &(&p * &p / &q)) && encloses(y / (x * y), &(RBig::ONE / &p)));
            let (x, y) = (Ball::<DoubleDouble>::from_f64(a), Ball::<DoubleDouble>::from_f64(b));
            prop_assert!(wide_encloses(x * y, &(&p * &q)) && wide_encloses(x / y, &(&p / &q)));
            prop_assert!(wide_encloses(x * x / y, &(&p * &p / &q)));
            prop_assert!(wide_encloses((x + y) * (x + y) / y, &((&p + &q) * (&p + &q) / &q)));
        }
    }

    #[test]
    fn double_doubles_keep_twice_the_digits() {
        let third = Ball::<DoubleDouble>::one() / Ball::from_f64(3.0);
        assert!(third.radius < 1e-30 && third.radius > 0.0);
        let off = third * Ball::from_f64(3.0) * wide(1.0, 1e-28) - Ball::one();
        assert_eq!(off.sign(), Sign::Positive);
        assert_eq!(wide(0.1, 1e-20) - wide(0.1, 1e-20), Ball::zero());
    }

    #[test]
    fn nonfinite_numbers_are_undecided() {
        for value in [f64::NAN, f64::INFINITY] {
            assert!(Ball::<f64>::from_f64(value).radius.is_infinite());
            assert!(Ball::<DoubleDouble>::from_f64(value).radius.is_infinite());
        }
        let huge = Ball::<DoubleDouble>::from_f64(f64::MAX);
        assert_eq!([huge + huge, huge * huge, huge / huge].map(Ordered::sign), [Sign::Undecided; 3]);
    }

    #[test]
    fn exact_zeros_stay_exact() {
        let (zero, x) = (Ball::<f64>::from_f64(0.0), Ball::from_f64(0.1) * Ball::from_f64(0.3));
        assert_eq!((zero * x).radius, 0.0);
        assert_eq!((zero / x).radius, 0.0);
        assert_eq!(Ball::from_f64(0.5) - Ball::from_f64(0.5), zero);
    }

    #[test]
    fn quotient_by_a_ball_around_zero_is_unknown() {
        let around_zero = Ball { mid: 1e-20, radius: 1e-18 };
        assert!((Ball::from_f64(1.0) / around_zero).radius.is_infinite());
    }
}
