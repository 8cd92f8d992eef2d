//! The oracle's arithmetic: balls of any precision, and f64 to look for borders.

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use std::cell::RefCell;
use std::cmp::Ordering;

/// A number that the oracle calculates with.
pub trait Number: Clone {
    /// The exact `value`; operations on it round to `bits` bits.
    fn new(value: f64, bits: usize) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    /// The quotient; the sign of `other` must be known and not zero.
    fn over(&self, other: &Self) -> Self;
    fn negative(&self) -> Self;
    /// Cosine and sine of an angle \[rad\].
    fn cos_sin(&self) -> [Self; 2];
    /// The number compared with zero; `None` if that is not known.
    fn sign(&self) -> Option<Ordering>;
    /// An upper bound on the magnitude, at most twice the magnitude if the sign is known.
    fn size(&self) -> f64;

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// Whether the number is certainly zero.
    fn is_zero(&self) -> bool {
        self.sign() == Some(Ordering::Equal)
    }
}

/// f64 without error bounds: its signs are guesses.
impl Number for f64 {
    fn new(value: f64, _: usize) -> Self {
        value
    }

    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn over(&self, other: &Self) -> Self {
        self / other
    }

    fn negative(&self) -> Self {
        -self
    }

    fn cos_sin(&self) -> [Self; 2] {
        [self.cos(), self.sin()]
    }

    fn sign(&self) -> Option<Ordering> {
        self.partial_cmp(&0.0)
    }

    fn size(&self) -> f64 {
        self.abs()
    }
}

/// A real number within `radius` of `mid`, which has `bits` bits.
#[derive(Debug, Clone)]
pub struct Ball {
    mid: BigFloat,
    radius: f64,
    bits: usize,
}

/// Factor above the rounding of the few f64 operations that compute a radius: 2^-46, 64 times that of one operation.
const INFLATION: f64 = 1.0 + 64.0 * f64::EPSILON;

impl Ball {
    /// The ball about `mid` with this `radius`, which was added up in f64, and with the rounding of `mid` itself.
    fn rounded(mid: BigFloat, radius: f64, bits: usize) -> Self {
        // One unit in the last place is magnitude * 2^(1 - bits), twice the error of rounding to nearest. Doubling it
        // once more costs two bits of hundreds, and makes no assumption about the rounding of the crate.
        let radius = radius + magnitude(&mid) * power_of_two(2 - bits as i32);
        // The smallest normal number covers underflow.
        let radius = if radius == 0.0 && mid.is_zero() { 0.0 } else { radius * INFLATION + f64::MIN_POSITIVE };
        Self { mid, radius, bits }
    }

    fn is_exact_zero(&self) -> bool {
        self.radius == 0.0 && self.mid.is_zero()
    }
}

/// An upper bound on |value|, larger by a few units of f64 at most; infinite if the value is not finite.
fn magnitude(value: &BigFloat) -> f64 {
    if value.is_zero() {
        return 0.0;
    }
    let Some((words, _, _, exponent, _)) = value.as_raw_parts() else { return f64::INFINITY };
    // The value is 0.m * 2^exponent, where the last word leads m.
    let lead = words.last().copied().unwrap_or(u64::MAX) as f64 * power_of_two(-64);
    lead * INFLATION * power_of_two(exponent)
}

/// 2^exponent, raised to the smallest normal number, and infinite beyond the largest power of two.
fn power_of_two(exponent: i32) -> f64 {
    match exponent {
        ..-1022 => f64::MIN_POSITIVE,
        -1022..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        1024.. => f64::INFINITY,
    }
}

impl Number for Ball {
    fn new(value: f64, bits: usize) -> Self {
        Self { mid: BigFloat::from_f64(value, bits), radius: 0.0, bits }
    }

    fn plus(&self, other: &Self) -> Self {
        if self.is_exact_zero() {
            return other.clone();
        }
        if other.is_exact_zero() {
            return self.clone();
        }
        let mid = self.mid.add(&other.mid, self.bits, RoundingMode::ToEven);
        Self::rounded(mid, self.radius + other.radius, self.bits)
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::new(0.0, self.bits);
        }
        let mid = self.mid.mul(&other.mid, self.bits, RoundingMode::ToEven);
        let radius = magnitude(&self.mid) * other.radius + (magnitude(&other.mid) + other.radius) * self.radius;
        Self::rounded(mid, radius + f64::MIN_POSITIVE, self.bits)
    }

    fn over(&self, other: &Self) -> Self {
        if self.is_exact_zero() {
            return self.clone();
        }
        let mid = self.mid.div(&other.mid, self.bits, RoundingMode::ToEven);
        // |a/b - a'/b'| <= (ra + |a/b| rb) / (|b| - rb), with a lower bound of |b|.
        let below = magnitude(&other.mid) / (INFLATION * INFLATION) - other.radius * INFLATION;
        let rounding = magnitude(&mid) * power_of_two(2 - self.bits as i32);
        let quotient = magnitude(&mid) + rounding;
        let radius =
            if below > 0.0 { (self.radius + quotient * other.radius) * INFLATION / below } else { f64::INFINITY };
        Self::rounded(mid, radius, self.bits)
    }

    fn negative(&self) -> Self {
        Self { mid: self.mid.neg(), ..*self }
    }

    fn cos_sin(&self) -> [Self; 2] {
        thread_local! {
            /// The crate's cache of digits of pi.
            static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory for a few constants"));
        }
        if self.is_exact_zero() {
            return [Self::new(1.0, self.bits), self.clone()];
        }
        CONSTANTS.with_borrow_mut(|constants| {
            let cos = self.mid.cos(self.bits, RoundingMode::ToEven, constants);
            let sin = self.mid.sin(self.bits, RoundingMode::ToEven, constants);
            // Cosine and sine change no faster than their angle.
            [cos, sin].map(|mid| Self::rounded(mid, self.radius, self.bits))
        })
    }

    fn sign(&self) -> Option<Ordering> {
        if self.is_exact_zero() {
            return Some(Ordering::Equal);
        }
        let clear = magnitude(&self.mid) > self.radius * (INFLATION * INFLATION * INFLATION);
        let side = match self.mid.sign()? {
            Sign::Pos => Ordering::Greater,
            Sign::Neg => Ordering::Less,
        };
        clear.then_some(side)
    }

    fn size(&self) -> f64 {
        (magnitude(&self.mid) + self.radius) * INFLATION
    }
}
