//! f64 with an error bound.

use super::{Ordered, Real, Sign};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number known to lie within `radius` of `mid`.
///
/// Every operation encloses its exact result: the radius takes the operands' radii and the rounding of the midpoint.
/// Radii are rounded to nearest and then blown up by a relative 2^-50, which covers the few roundings of each formula
/// (Rump, Acta Numerica 2010, section 9); an operation that is exact because an operand is an exact zero adds nothing, so
/// that structural zeros stay zeros. A quotient by a ball that contains zero has an infinite radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// The centre.
    pub mid: f64,
    /// The greatest distance of the number from the centre; never negative, infinite where nothing is known.
    pub radius: f64,
}

/// Half the distance from 1 to the next f64: one rounding to nearest errs by at most this, relatively.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// Covers the roundings in the computation of a radius itself.
const BLOW_UP: f64 = 1.0 + 4.0 * f64::EPSILON;

impl Ball {
    /// A ball around `mid`; a centre that is not finite tells nothing, and a tiny rounding error covers underflow.
    fn around(mid: f64, radius: f64) -> Self {
        if mid.is_finite() && radius.is_finite() {
            Self { mid, radius: radius * BLOW_UP }
        } else {
            Self { mid: 0.0, radius: f64::INFINITY }
        }
    }

    /// The error of one operation rounded to nearest whose result is `mid`.
    fn rounding(mid: f64) -> f64 {
        mid.abs() * UNIT_ROUNDOFF + f64::MIN_POSITIVE
    }

    fn is_exact_zero(self) -> bool {
        self.mid == 0.0 && self.radius == 0.0
    }
}

impl Real for Ball {
    fn from_f64(value: f64) -> Self {
        Self { mid: value, radius: 0.0 }
    }
}

impl Ordered for Ball {
    fn sign(self) -> Sign {
        Sign::within(self.mid, self.radius)
    }

    fn to_f64(self) -> f64 {
        if self.radius.is_finite() { self.mid } else { f64::NAN }
    }
}

impl Add for Ball {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is_exact_zero() {
            return other;
        }
        if other.is_exact_zero() {
            return self;
        }
        let mid = self.mid + other.mid;
        // Knuth's two-sum: exact sums, cancellations above all, add no error.
        let part = mid - self.mid;
        let error = (self.mid - (mid - part)) + (other.mid - part);
        Self::around(mid, self.radius + other.radius + error.abs())
    }
}

impl Neg for Ball {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mid: -self.mid, radius: self.radius }
    }
}

impl Sub for Ball {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::from_f64(0.0);
        }
        let mid = self.mid * other.mid;
        let spread = self.mid.abs() * other.radius + other.mid.abs() * self.radius + self.radius * other.radius;
        Self::around(mid, spread + Self::rounding(mid))
    }
}

impl Div for Ball {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // The least magnitude in the divisor; not positive when it may be zero.
        let least = other.mid.abs() - other.radius * BLOW_UP;
        if least <= 0.0 || least.is_nan() {
            return Self { mid: 0.0, radius: f64::INFINITY };
        }
        if self.is_exact_zero() {
            return self;
        }
        let mid = self.mid / other.mid;
        let spread = (self.radius + mid.abs() * (other.radius + UNIT_ROUNDOFF * other.mid.abs())) / least;
        Self::around(mid, spread + Self::rounding(mid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use proptest::prelude::*;

    fn exact(value: f64) -> RBig {
        RBig::try_from(value).expect("finite")
    }

    fn encloses(ball: Ball, value: &RBig) -> bool {
        if ball.radius.is_infinite() {
            return true;
        }
        let distance = exact(ball.mid) - value;
        let distance = if distance < RBig::ZERO { -distance } else { distance };
        distance <= exact(ball.radius)
    }

    proptest! {
        #[test]
        fn every_operation_encloses_its_exact_result(
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

    #[test]
    fn exact_zeros_stay_exact() {
        let (zero, x) = (Ball::from_f64(0.0), Ball::from_f64(0.1) * Ball::from_f64(0.3));
        assert_eq!((zero * x).radius, 0.0);
        assert_eq!((zero / x).radius, 0.0);
        assert_eq!(Ball::from_f64(0.5) - Ball::from_f64(0.5), zero);
    }

    #[test]
    fn division_by_a_ball_around_zero_tells_nothing() {
        let around_zero = Ball { mid: 1e-20, radius: 1e-18 };
        assert!((Ball::from_f64(1.0) / around_zero).radius.is_infinite());
    }
}
