//! Double-doubles: twice the digits of f64, by error-free transforms.

use super::{Midpoint, Real, Sign};

/// The unevaluated sum `hi + lo` of two f64 with `|lo| <= ulp(hi) / 2`: about 106 bits, in the range of f64.
///
/// With u = 2^-53 and away from underflow, the relative errors are 3 u^2 / (1 - 4 u) for sums (algorithm 6), 7 u^2 for
/// products (algorithm 10) and 15 u^2 + 56 u^3 for quotients (algorithm 17), after Joldes, Muller and Popescu, "Tight
/// and rigorous error bounds for basic building blocks of double-word arithmetic", ACM TOMS 44 (2017). Products split
/// their factors (Dekker, Veltkamp) and need no fused multiply-add. Beyond 2^996, where a split overflows, the result
/// is NaN and never silently wrong. Below 2^-969 a product loses digits, by less than 2^-1022 in all.
///
/// The type itself has no error bound; [`Ball`](super::Ball) adds one. Cost: about 20 f64 operations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// The rounded sum `a + b` and its rounding error, exactly (Knuth).
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The same as [`two_sum`] for `|a| >= |b|` or `a` zero (Dekker).
#[inline]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Splits `a` into two halves of 26 bits whose sum is `a`; NaN if that overflows.
#[inline]
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// The rounded product `a * b` and its rounding error, exactly unless the error underflows.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, al * bl - (((product - ah * bh) - al * bh) - ah * bl))
}

impl Real for DoubleDouble {
    fn from_f64(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }
}

impl Midpoint for DoubleDouble {
    /// 16 u^2, which covers quotients and all other operations.
    const ROUNDING: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

    fn parts(self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    fn magnitude(self) -> f64 {
        self.hi.abs() * (1.0 + 2.0 * f64::EPSILON)
    }

    fn least_magnitude(self) -> f64 {
        self.hi.abs() * (1.0 - 2.0 * f64::EPSILON)
    }

    /// Both rounding errors of the accurate sum are known exactly, so that an exact sum has an error of zero.
    #[inline]
    fn sum(self, other: Self) -> (Self, f64) {
        let (high, high_error) = two_sum(self.hi, other.hi);
        let (low, low_error) = two_sum(self.lo, other.lo);
        let (middle, first) = two_sum(high_error, low);
        let (high, rest) = fast_two_sum(high, middle);
        let (tail, second) = two_sum(low_error, rest);
        (Self::renormalized(high, tail), first.abs() + second.abs())
    }

    /// The product that corrects a quotient may underflow, and its loss is divided by the divisor.
    fn quotient_rounding(self, divisor: f64) -> f64 {
        self.rounding() + f64::MIN_POSITIVE / divisor
    }

    fn sign_within(self, radius: f64) -> Sign {
        Sign::within(self.hi, (radius + self.lo.abs()) * (1.0 + f64::EPSILON))
    }
}

impl DoubleDouble {
    fn renormalized(a: f64, b: f64) -> Self {
        let (hi, lo) = fast_two_sum(a, b);
        Self { hi, lo }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.hi, other.hi);
        let (low, low_error) = two_sum(self.lo, other.lo);
        let (high, rest) = fast_two_sum(high, high_error + low);
        Self::renormalized(high, low_error + rest)
    }

    fn minus(self, other: Self) -> Self {
        self + -other
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        let (high, error) = two_product(self.hi, other.hi);
        Self::renormalized(high, error + (self.hi * other.lo + self.lo * other.hi))
    }

    #[inline(never)]
    fn over(self, other: Self) -> Self {
        let high = self.hi / other.hi;
        // The divisor times the first digits of the quotient (their algorithm 7), and the rest of the dividend.
        let (product, error) = two_product(other.hi, high);
        let back = Self::renormalized(product, error + other.lo * high);
        let rest = (self.hi - back.hi) + (self.lo - back.lo);
        Self::renormalized(high, rest / other.hi)
    }

    fn negated(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

operators!([] DoubleDouble);

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, magnitude};
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn rational(value: DoubleDouble) -> RBig {
        exact(value.hi) + exact(value.lo)
    }

    fn number() -> impl Strategy<Value = DoubleDouble> {
        (-1.0..1.0f64, -1.0..1.0f64, -80..80i32).prop_map(|(hi, lo, exponent)| {
            let (hi, lo) = two_sum(hi, lo * f64::EPSILON);
            let scale = f64::from(exponent).exp2();
            DoubleDouble { hi: hi * scale, lo: lo * scale }
        })
    }

    /// Whether the relative error of `value` is at most `units` u^2.
    fn within(value: DoubleDouble, truth: &RBig, units: u32) -> bool {
        let unit = exact(f64::EPSILON * f64::EPSILON / 4.0);
        magnitude(rational(value) - truth) <= magnitude(truth.clone()) * RBig::from(units) * unit
    }

    fn check_sum(a: DoubleDouble, b: DoubleDouble) -> Result<(), TestCaseError> {
        let (sum, error) = a.sum(b);
        prop_assert_eq!(sum, a + b);
        prop_assert_eq!(sum.hi, sum.hi + sum.lo);
        let rest = rational(a) + rational(b) - rational(sum);
        prop_assert!(magnitude(rest) <= exact(error * (1.0 + f64::EPSILON)));
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn operations_keep_their_published_bounds(a in number(), b in number()) {
            let (p, q) = (rational(a), rational(b));
            check_sum(a, b)?;
            prop_assert!(within(a + b, &(&p + &q), 4));
            prop_assert!(within(a - b, &(&p - &q), 4));
            prop_assert!(within(a * b, &(&p * &q), 7));
            if b.hi != 0.0 {
                prop_assert!(within(a / b, &(&p / &q), 16));
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        /// With significands of a few bits, all kinds of ties and cancellations occur.
        #[test]
        fn cancelling_sum_knows_its_error(
            a in -9..=9i32, b in -9..=9i32, c in -9..=9i32, d in -9..=9i32, i in 48..60i32, j in 48..60i32, k in -3..=3i32,
        ) {
            let number = |hi: i32, lo: i32, k: i32| {
                let (hi, lo) = two_sum(f64::from(hi), libm::scalbn(f64::from(lo), -k));
                DoubleDouble { hi, lo }
            };
            let near = DoubleDouble::from_f64(libm::scalbn(1.0, k));
            check_sum(number(a, c, i), number(b, d, j))?;
            check_sum(number(a, c, i), -number(a, d, j))?;
            check_sum(number(a, c, i) * near, number(-a, b, j) + number(d, c, 60))?;
        }
    }
}
