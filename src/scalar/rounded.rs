//! An f64 with an error bound.

use super::{Ordered, Real, Sign};

/// A number that lies within `error` of `value`: a [`Ball`](super::Ball) whose operations do not check for overflow.
///
/// Errors are rounded to nearest; a relative 1e-6 covers their own rounding. A result beyond the range of f64 has an
/// error that is infinite or NaN, which leaves the sign undecided. A known number times an exact zero is an exact zero.
/// Source: Higham 2002, chapter 3.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Rounded {
    /// The rounded number.
    pub value: f64,
    /// The greatest distance of the exact number from `value`, up to its own rounding.
    pub error: f64,
}

const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// A factor that covers the rounding of the errors themselves, over thousands of successive operations.
const SLACK: f64 = 1.0 + 1e-6;

impl Rounded {
    /// The greatest possible magnitude of the number.
    #[inline]
    fn reach(self) -> f64 {
        self.value.abs() + self.error
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        let value = self.value + other.value;
        // Sums do not underflow.
        Self { value, error: self.error + other.error + UNIT_ROUNDOFF * value.abs() }
    }

    #[inline]
    fn minus(self, other: Self) -> Self {
        self + -other
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        let (value, [own, others]) = (self.value * other.value, [self.reach(), other.reach()]);
        let error = self.value.abs() * other.error + self.error * others + UNIT_ROUNDOFF * value.abs();
        // Every product may underflow, except one with an exact zero.
        let least = if own < others { own } else { others };
        Self { value, error: error + if least == 0.0 { 0.0 } else { f64::MIN_POSITIVE } }
    }

    #[inline]
    fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        // The least magnitude of the divisor; not positive, or NaN, if the divisor may be zero.
        let least = other.value.abs() - other.error * SLACK;
        let underflow = if self.reach() == 0.0 { 0.0 } else { f64::MIN_POSITIVE };
        let spread = self.error + value.abs() * other.error + underflow;
        let error = spread / least + UNIT_ROUNDOFF * value.abs() + underflow;
        Self { value, error: if least > 0.0 { error } else { f64::INFINITY } }
    }

    #[inline]
    fn negated(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

operators!([] Rounded);

impl Real for Rounded {
    #[inline]
    fn from_f64(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    #[inline]
    fn scaled(self, factor: f64) -> Self {
        let (value, [own, others]) = (self.value * factor, [self.reach(), factor.abs()]);
        let error = self.error * others + UNIT_ROUNDOFF * value.abs();
        let least = if own < others { own } else { others };
        Self { value, error: error + if least == 0.0 { 0.0 } else { f64::MIN_POSITIVE } }
    }
}

impl Ordered for Rounded {
    #[inline]
    fn sign(self) -> Sign {
        Sign::within(self.value, self.error())
    }

    /// The value, even if its error is infinite: rejected combinations are printed with it.
    #[inline]
    fn to_f64(self) -> f64 {
        self.value
    }

    #[inline]
    fn error(self) -> f64 {
        self.error * SLACK
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, magnitude};
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    /// Whether `truth` lies within the error of the number.
    fn encloses(found: Rounded, truth: RBig) -> bool {
        !found.error().is_finite() || magnitude(exact(found.value) - truth) <= exact(found.error())
    }

    proptest! {
        #[test]
        fn operations_enclose_exact_results(
            [a, b, c] in prop::array::uniform3((1.0..2.0f64, -700..700i32, any::<bool>())),
            [off_a, off_b] in prop::array::uniform2((-1.0..1.0f64, -60..-2i32)),
        ) {
            let [a, b, c] = [a, b, c].map(|(part, bits, minus)| libm::scalbn(if minus { -part } else { part }, bits));
            // Numbers that differ from their exact counterparts by at most their errors.
            let near = |value: f64, (part, bits): (f64, i32)| {
                let off = libm::scalbn(part * value, bits);
                (Rounded { value, error: off.abs() }, exact(value) + exact(off))
            };
            let ((x, p), (y, q), z) = (near(a, off_a), near(b, off_b), Rounded::from_f64(c));
            let r = exact(c);
            for (found, truth) in [
                (x * y, &p * &q),
                (x.scaled(c), &p * &r),
                (x * y + z * x, &p * &q + &r * &p),
                (x - x * y, &p - &p * &q),
                (x / y, &p / &q),
                (x / y * y - x, RBig::ZERO),
                (-z / (x * y), -&r / (&p * &q)),
            ] {
                let is_enclosed = found.value.is_finite() && encloses(found, truth);
                // Beyond the range of f64, nothing is known.
                prop_assert!(is_enclosed || found.sign() == Sign::Undecided, "{found:?}");
            }
        }
    }

    #[test]
    fn zeros_stay_zeros_and_doubt_stays_doubt() {
        let [zero, third] = [Rounded::zero(), Rounded::one() / Rounded::from_f64(3.0)];
        for number in [zero * third, zero / third, third * zero + zero, -zero - zero * zero, third.scaled(0.0)] {
            assert_eq!(number.sign(), Sign::Zero);
        }
        let unknown = Rounded { value: 1.0, error: f64::INFINITY };
        let vague = third * Rounded::from_f64(3.0) - Rounded::one();
        for number in [
            zero * unknown,
            unknown.scaled(0.0),
            zero / unknown,
            zero / vague,
            third / vague,
            unknown - unknown,
            third / zero,
        ] {
            assert_eq!(number.sign(), Sign::Undecided, "{number:?}");
        }
        // A product that underflows is not zero.
        let tiny = Rounded::from_f64(1e-200);
        assert_eq!([tiny * tiny, tiny.scaled(1e-200)].map(Ordered::sign), [Sign::Undecided; 2]);
    }
}
