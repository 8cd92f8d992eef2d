//! Affine forms: enclosures that keep track of the uncertain data that they depend on.

use super::ball::LIBM_ERROR;
use super::double::two_sum;
use super::{Ordered, Real, Sign, Trigonometry};

/// A number of the form `center + sum_i slopes[i] e_i +- error`, where each cause e_i is an unknown number in -1..1.
///
/// Numbers share their causes, so that effects of a common cause cancel. Between [`Ball`](super::Ball)s they do not. An
/// enclosure over intervals of half-width r is too wide only by O(r^2) (affine arithmetic: de Figueiredo and Stolfi,
/// Numerical Algorithms 2004). Every operation encloses its exact result; nonlinear terms and rounding go into `error`.
/// As with a ball, exact zeros stay exact, and a quotient by a number that may be zero is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<const N: usize> {
    center: f64,
    slopes: [f64; N],
    /// The remaining error: never negative, infinite if nothing is known.
    error: f64,
}

const ROUNDING: f64 = f64::EPSILON / 2.0;

impl<const N: usize> Affine<N> {
    /// A factor that covers the rounding in sums of N terms and in the formulas of the errors.
    const BLOW_UP: f64 = 1.0 + (4 * N + 16) as f64 * f64::EPSILON;
    /// A bound of what N products lose by underflow.
    const TINY: f64 = (N + 4) as f64 * f64::MIN_POSITIVE;

    fn unknown() -> Self {
        Self { center: 0.0, slopes: [0.0; N], error: f64::INFINITY }
    }

    fn around(center: f64, slopes: [f64; N], error: f64) -> Self {
        let error = error * Self::BLOW_UP;
        if center.is_finite() && error.is_finite() { Self { center, slopes, error } } else { Self::unknown() }
    }

    /// A number at most `radius` from `center`, whose offset is the cause number `symbol`. Causes from number N on are
    /// not tracked: their effects go into the error and do not cancel.
    pub fn varying(center: f64, radius: f64, symbol: usize) -> Self {
        let slopes = std::array::from_fn(|i| if i == symbol { radius } else { 0.0 });
        let error = if symbol < N { 0.0 } else { radius };
        if center.is_finite() && radius.is_finite() { Self { center, slopes, error } } else { Self::unknown() }
    }

    /// The cosine and sine of this angle \[rad\]; the enclosures are narrow for angles near zero.
    pub fn cos_sin_near_zero(self) -> [Self; 2] {
        // cos d is within r^2 / 4 of 1 - r^2 / 4, sin d within r^3 / 6 of d, for every |d| <= r.
        let radius = self.center.abs() + self.error();
        let square = radius * radius;
        let mut cos = Self::from_f64(1.0 - square / 4.0);
        cos.error = (square / 4.0 + f64::EPSILON) * Self::BLOW_UP;
        let mut sin = self;
        sin.error += (square * radius / 6.0 + f64::MIN_POSITIVE) * Self::BLOW_UP;
        [cos, sin]
    }

    /// The change of the number with each cause, to first order.
    pub fn slopes(&self) -> &[f64; N] {
        &self.slopes
    }

    /// The part of the error that belongs to no tracked cause.
    pub fn rest(&self) -> f64 {
        self.error
    }

    /// The smaller of the number and zero.
    pub fn min_zero(self) -> Self {
        match self.sign() {
            Sign::Negative => self,
            Sign::Zero | Sign::Positive => Self::zero(),
            Sign::Undecided => {
                let half = (self.center - self.error()) / 2.0;
                Self::around(half, [0.0; N], -half)
            }
        }
    }

    fn reach(&self) -> f64 {
        self.slopes.iter().map(|slope| slope.abs()).sum()
    }

    fn is_exact_zero(&self) -> bool {
        self.center == 0.0 && self.error == 0.0 && self.slopes.iter().all(|&slope| slope == 0.0)
    }
}

impl<const N: usize> Default for Affine<N> {
    fn default() -> Self {
        Self::zero()
    }
}

impl<const N: usize> Real for Affine<N> {
    fn from_f64(value: f64) -> Self {
        if value.is_finite() { Self { center: value, slopes: [0.0; N], error: 0.0 } } else { Self::unknown() }
    }
}

impl<const N: usize> Ordered for Affine<N> {
    fn sign(self) -> Sign {
        Sign::within(self.center, self.error())
    }

    fn to_f64(self) -> f64 {
        if self.error.is_finite() { self.center } else { f64::NAN }
    }

    fn error(self) -> f64 {
        (self.reach() + self.error) * Self::BLOW_UP
    }
}

impl<const N: usize> Trigonometry for Affine<N> {
    fn cos_sin(angle: f64) -> [Self; 2] {
        if angle == 0.0 {
            return [Self::one(), Self::zero()];
        }
        let (sin, cos) = libm::sincos(angle);
        [cos, sin].map(|value| Self::around(value, [0.0; N], value.abs() * LIBM_ERROR + f64::MIN_POSITIVE))
    }
}

impl<const N: usize> Affine<N> {
    #[inline(never)]
    fn plus(self, other: Self) -> Self {
        if self.is_exact_zero() {
            return other;
        }
        if other.is_exact_zero() {
            return self;
        }
        let (center, lost) = two_sum(self.center, other.center);
        let slopes: [f64; N] = std::array::from_fn(|i| self.slopes[i] + other.slopes[i]);
        let rounding = ROUNDING * slopes.iter().map(|slope| slope.abs()).sum::<f64>();
        Self::around(center, slopes, self.error + other.error + lost.abs() + rounding)
    }

    fn minus(self, other: Self) -> Self {
        self + -other
    }

    #[inline(never)]
    fn times(self, other: Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::zero();
        }
        let (a, b) = (self.center, other.center);
        let slopes = std::array::from_fn(|i| a * other.slopes[i] + b * self.slopes[i]);
        let (reach, other_reach) = (self.reach(), other.reach());
        // The square of a cause lies in 1/2 +- 1/2; any other product of two causes lies in 0 +- 1.
        let (mut shift, mut squares) = (0.0, 0.0);
        for (one, other) in self.slopes.iter().zip(&other.slopes) {
            let square = one * other / 2.0;
            shift += square;
            squares += square.abs();
        }
        let (product, center) = (a * b, a * b + shift);
        // Each slope has the rounding of two products and their sum.
        let rounding = ROUNDING * (product.abs() + center.abs() + 2.0 * (a.abs() * other_reach + b.abs() * reach))
            + 4.0 * Self::TINY;
        let spread = (a.abs() + reach + self.error) * other.error + (b.abs() + other_reach) * self.error;
        Self::around(center, slopes, (reach * other_reach - squares) + spread + rounding)
    }

    #[inline(never)]
    fn over(self, other: Self) -> Self {
        let divisor = other.center;
        let spread = (other.reach() + other.error) * Self::BLOW_UP;
        // The least magnitude of a divisor in the enclosure.
        let least = (divisor.abs() - spread) * (1.0 - 2.0 * f64::EPSILON);
        if least <= 0.0 || least.is_nan() {
            return Self::unknown();
        }
        if self.is_exact_zero() {
            return self;
        }
        // x / y = q + w / y with w = x - q y, which is small at the center; w / y = w / c - (w / c) (y - c) / y.
        let quotient = self.center / divisor;
        let rest: [f64; N] = std::array::from_fn(|i| self.slopes[i] - quotient * other.slopes[i]);
        let reach: f64 = rest.iter().map(|slope| slope.abs()).sum();
        let of_center = ROUNDING * (quotient * divisor).abs() + Self::TINY * (1.0 + divisor.abs());
        let of_rest = ROUNDING * (quotient.abs() * other.reach() + reach) + Self::TINY;
        let error = (self.error + quotient.abs() * other.error + of_rest + of_center) / divisor.abs();
        let bound = reach / divisor.abs() + error;
        let slopes = rest.map(|slope| slope / divisor);
        let rounding = ROUNDING * (reach / divisor.abs()) + Self::TINY;
        Self::around(quotient, slopes, error + bound * (spread / least) + rounding)
    }

    fn negated(self) -> Self {
        Self { center: -self.center, slopes: self.slopes.map(|slope| -slope), error: self.error }
    }
}

operators!([const N: usize] Affine<N>);

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, magnitude};
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    type Number = Affine<3>;

    /// Whether the number can be `value` if its causes are `at`.
    fn encloses(number: Number, at: [f64; 3], value: &RBig) -> bool {
        if number.error.is_infinite() {
            return true;
        }
        let linear =
            at.iter().zip(number.slopes).fold(exact(number.center), |sum, (&e, slope)| sum + exact(e) * exact(slope));
        magnitude(linear - value) <= exact(number.error)
    }

    fn cause() -> impl Strategy<Value = f64> {
        prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0f64]
    }

    proptest! {
        #[test]
        fn operations_enclose_results_of_all_causes(
            centers in prop::array::uniform3(-10.0..10.0f64),
            radii in prop::array::uniform3(prop_oneof![Just(0.0), 1e-6..1e-2f64, 0.1..3.0f64]),
            at in prop::array::uniform3(cause()),
            k in -40..40i32,
        ) {
            let scale = f64::from(k).exp2();
            let centers = [centers[0], centers[1] * scale, centers[2]];
            let radii = [radii[0], radii[1] * scale, radii[2]];
            let numbers: [Number; 3] = std::array::from_fn(|i| Affine::varying(centers[i], radii[i], i));
            let [x, y, z] = numbers;
            let [p, q, r]: [RBig; 3] = std::array::from_fn(|i| exact(centers[i]) + exact(radii[i]) * exact(at[i]));
            prop_assert!(encloses(x + y * z, at, &(&p + &q * &r)));
            prop_assert!(encloses((x - y) * (x + y) * z, at, &((&p - &q) * (&p + &q) * &r)));
            prop_assert!(encloses(x * y - y * x, at, &RBig::ZERO));
            if q != RBig::ZERO && r != RBig::ZERO {
                prop_assert!(encloses((x + z) / y, at, &((&p + &r) / &q)));
                prop_assert!(encloses((x * y - z) / (y * z), at, &((&p * &q - &r) / (&q * &r))));
            }
            let least = if p < RBig::ZERO { p } else { RBig::ZERO };
            prop_assert!(encloses(x.min_zero(), at, &least));
        }

        #[test]
        fn cosine_and_sine_enclose_every_angle(angle in -7.0..7.0f64, radius in 0.0..2.0f64, at in cause()) {
            let [cos, sin] = Affine::<1>::cos_sin(angle);
            let [cos_d, sin_d] = Affine::varying(0.0, radius, 0).cos_sin_near_zero();
            let [cos, sin] = [cos * cos_d - sin * sin_d, sin * cos_d + cos * sin_d];
            let turned = angle + radius * at;
            for (number, value) in [(cos, turned.cos()), (sin, turned.sin())] {
                let distance = (number.center + number.slopes[0] * at - value).abs();
                // The comparison itself rounds the angle.
                prop_assert!(distance <= number.error + 4.0 * f64::EPSILON * (1.0 + angle.abs()));
            }
        }
    }

    #[test]
    fn common_causes_cancel() {
        let x = Number::varying(1.0, 1e-3, 0);
        assert_eq!((x - x).error(), 0.0);
        assert!((x / x - Number::one()).error() < 1e-14);
        // x^2 - 1 has a slope of 2e-3 and a nonlinear part of 1e-6.
        let bent = x * x - Number::one();
        assert_eq!((bent.slopes[0], bent.sign()), (2e-3, Sign::Undecided));
        assert!(bent.error < 1.1e-6);
    }
}
