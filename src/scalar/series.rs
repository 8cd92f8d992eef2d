//! The cosine and sine of an exact angle by the Taylor series, in any number type with an error bound.
//!
//! [`Interval`](super::Interval) and the ball of double-doubles share it: both need proven bounds of all their digits.

use super::Enclosure;

/// How often an angle is halved before the series. The halved angle is below 2^-r with an r for which r doublings cost
/// about as much as the terms of the series.
pub(super) fn halvings(angle: f64, bits: u32) -> u32 {
    // No halving may underflow.
    let below = (bits.isqrt() / 2).min(900) as i32;
    let exponent = if angle.is_finite() { libm::frexp(angle).1 } else { 0 };
    u32::try_from(exponent + below).unwrap_or(0)
}

/// The cosine and sine of `angle` \[rad\]. The series gives `bits` bits, of which each doubling loses up to two.
///
/// The halved angle is exact and at most 1, so that the terms of the series alternate and decrease.
pub(super) fn cos_sin<N: Enclosure>(angle: f64, halvings: u32, bits: u32) -> [N; 2] {
    if angle == 0.0 {
        return [N::one(), N::zero()];
    }
    if !angle.is_finite() {
        return [N::from_f64(f64::NAN); 2];
    }
    let angle = libm::scalbn(angle, -(halvings as i32));
    let square = N::from_f64(angle) * N::from_f64(angle);
    let fewer = f64::from(-libm::frexp(angle).1) * 2.0;
    let (mut order, mut reached) = (0.0, fewer);
    while reached <= f64::from(bits) {
        order += 2.0;
        reached += fewer + f64::from(libm::frexp(order * (order - 1.0)).1 - 1);
    }
    // All terms are multiplied by the factorial of the last, by which the sum is divided once. The last term plus all
    // omitted ones is between 1 - x^2 and 1 times the last term.
    let last = N::one().widened(square);
    let ([mut cos, mut sin], mut factorials) = ([last; 2], [N::one(); 2]);
    while order > 0.0 {
        factorials[0] = factorials[0] * N::from_f64(order * (order - 1.0));
        factorials[1] = factorials[1] * N::from_f64(order * (order + 1.0));
        (cos, sin) = (factorials[0] - cos * square, factorials[1] - sin * square);
        order -= 2.0;
    }
    (cos, sin) = (cos / factorials[0], sin / factorials[1] * N::from_f64(angle));
    for _ in 0..halvings {
        let both = sin * cos;
        (cos, sin) = (cos * cos - sin * sin, both + both);
    }
    [cos, sin]
}

#[cfg(test)]
mod tests {
    use crate::scalar::{Ball, DoubleDouble, Interval, Midpoint, Ordered, Real, Sign, Trigonometry};
    use proptest::prelude::*;

    /// Whether `truth`, which is known far better, may lie within `radius` of the sum of `mid`.
    fn near(truth: Interval, mid: &[f64], radius: f64) -> bool {
        let mid = mid.iter().fold(Interval::zero(), |sum, part| sum + Interval::from_f64(*part));
        let bound = Interval::from_f64(radius);
        (truth - mid - bound).sign() != Sign::Positive && (mid - truth - bound).sign() != Sign::Positive
    }

    fn check(angle: f64) -> std::result::Result<(), String> {
        Interval::scope(400, || {
            let truth = Interval::cos_sin(angle);
            let balls = Ball::<f64>::cos_sin(angle);
            let wide = Ball::<DoubleDouble>::cos_sin(angle);
            for ((truth, ball), wide) in truth.into_iter().zip(balls).zip(wide) {
                if angle.is_normal() && truth.error() > 1e-100 {
                    return Err(format!("the truth at {angle:e} is known to {:e}", truth.error()));
                }
                if !near(truth, &[ball.mid], ball.radius) || !near(truth, &wide.mid.parts(), wide.radius) {
                    return Err(format!("{angle:e}: {ball:?}, {wide:?}"));
                }
                let limit = [(10.0, 1e-25), (1e6, 1e-18)].into_iter().find(|(below, _)| angle.abs() < *below);
                let limit = limit.map_or(1.0, |(_, radius)| radius);
                if wide.radius > limit {
                    return Err(format!("wide at {angle:e}: {wide:?}"));
                }
            }
            Ok(())
        })
    }

    /// Angles of every magnitude, most of them ordinary.
    fn angle() -> impl Strategy<Value = f64> {
        prop_oneof![
            6 => -10.0..10.0f64,
            2 => -1e6..1e6f64,
            1 => (-1.0..1.0f64, -1070..0i32).prop_map(|(angle, k)| libm::scalbn(angle, k)),
            1 => (-1.0..1.0f64, 20..1024i32).prop_map(|(angle, k)| libm::scalbn(angle, k)),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        #[test]
        fn enclosures_hold_the_same_cosine(angle in angle()) {
            prop_assert_eq!(check(angle), Ok(()));
        }
    }

    /// Checks the assumed error of `libm`, also at its worst places, next to the multiples of pi / 4.
    #[test]
    fn libm_errs_by_less_than_assumed() {
        for turn in -3000..3000 {
            let border = f64::from(turn) * std::f64::consts::FRAC_PI_4;
            for step in [border, border.next_up(), border.next_down(), border + 1e-9] {
                check(step).unwrap();
            }
        }
        let mut state = 1u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let angle = (state >> 11) as f64 / (1u64 << 53) as f64 * 20.0 - 10.0;
            let (sin, cos) = libm::sincos(angle);
            // Double-doubles, checked above, are sharp enough.
            let wide = Ball::<DoubleDouble>::cos_sin(angle);
            for (value, wide) in [cos, sin].into_iter().zip(wide) {
                let error = (wide - Ball::from_f64(value)).to_f64().abs() + wide.radius;
                assert!(error <= f64::EPSILON * value.abs(), "{angle}: {error:e}");
            }
        }
    }

    #[test]
    fn series_gives_the_bits_asked_for() {
        for (bits, angle) in [(64, 1.0), (256, 1e6), (4096, -3.7), (300, 1e300), (300, 1e-300)] {
            let radii = Interval::scope(bits, || Interval::cos_sin(angle).map(Ordered::error));
            assert!(radii.into_iter().all(|radius| radius <= 2.0 * 0.5f64.powi(bits.min(1000) as i32)), "{radii:?}");
        }
        let digits = Interval::scope(128, || {
            let [cos, _] = Interval::cos_sin(1.0);
            let known = "54030230586813971740093660744297660373231042061792222767009725538110039477447";
            let known = known.bytes().fold(Interval::zero(), |sum, digit| {
                sum * Interval::from_f64(10.0) + Interval::from_f64(f64::from(digit - b'0'))
            });
            let scale = (0..77).fold(Interval::one(), |power, _| power * Interval::from_f64(10.0));
            let off = cos - known / scale;
            (off.sign(), off.to_f64())
        });
        assert_eq!(digits.0, Sign::Undecided);
        assert!(digits.1.abs() < 1e-36);
    }
}
