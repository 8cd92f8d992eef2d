//! The numbers of the oracle: balls of any precision, and f64 to look for borders with.

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use std::cell::RefCell;
use std::cmp::Ordering;

/// What the oracle calculates with.
pub trait Number: Clone {
    /// Exactly `value`, to be calculated with in `bits` bits.
    fn new(value: f64, bits: usize) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    /// The quotient; `other` must have a sign.
    fn over(&self, other: &Self) -> Self;
    fn negative(&self) -> Self;
    /// Cosine and sine of an angle \[rad\].
    fn cos_sin(&self) -> [Self; 2];
    /// How it compares with zero; `None` if that is not known.
    fn sign(&self) -> Option<Ordering>;
    /// No less than its magnitude, and where it has a sign at most twice that.
    fn size(&self) -> f64;

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// Whether it is zero for certain.
    fn is_zero(&self) -> bool {
        self.sign() == Some(Ordering::Equal)
    }
}

/// f64 without any bound: what it says of a sign is a guess.
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

/// More than the rounding of the few f64 operations that one radius takes: 2^-46, 64 times that of one.
const INFLATION: f64 = 1.0 + 64.0 * f64::EPSILON;

impl Ball {
    /// `mid` known to `radius`, which was added up in f64, and its own rounding.
    fn rounded(mid: BigFloat, radius: f64, bits: usize) -> Self {
        // One unit in the last place, twice what rounding to nearest may do, is magnitude * 2^(1 - bits); once more
        // twice that costs two bits of hundreds, and need not rely on how well the crate rounds.
        let radius = radius + magnitude(&mid) * power_of_two(2 - bits as i32);
        // The least normal number covers what underflow took away.
        let radius = if radius == 0.0 && mid.is_zero() { 0.0 } else { radius * INFLATION + f64::MIN_POSITIVE };
        Self { mid, radius, bits }
    }

    fn is_exact_zero(&self) -> bool {
        self.radius == 0.0 && self.mid.is_zero()
    }
}

/// No less than |value|, and above it by a few units of f64 at most; infinite where it is none.
fn magnitude(value: &BigFloat) -> f64 {
    if value.is_zero() {
        return 0.0;
    }
    let Some((words, _, _, exponent, _)) = value.as_raw_parts() else { return f64::INFINITY };
    // The value is 0.m * 2^exponent, m led by the last word.
    let lead = words.last().copied().unwrap_or(u64::MAX) as f64 * power_of_two(-64);
    lead * INFLATION * power_of_two(exponent)
}

/// 2^exponent, no less where that lies below the normal numbers, infinite where above.
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
        // |a/b - a'/b'| <= (ra + |a/b| rb) / (|b| - rb), with |b| from below.
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
            /// Digits of pi that the crate keeps.
            static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory for a few constants"));
        }
        if self.is_exact_zero() {
            return [Self::new(1.0, self.bits), self.clone()];
        }
        CONSTANTS.with_borrow_mut(|constants| {
            let cos = self.mid.cos(self.bits, RoundingMode::ToEven, constants);
            let sin = self.mid.sin(self.bits, RoundingMode::ToEven, constants);
            // Neither changes faster than its angle.
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
