//! The reference: floating point of 256 bits, correctly rounded, by code that the product does not use.

use crate::scalar::Real;
use dashu_float::{FBig, round::mode::HalfEven};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Bits of a number.
pub const PRECISION: usize = 256;

type Big = FBig<HalfEven, 2>;

thread_local! {
    static VALUES: RefCell<Vec<Big>> = const { RefCell::new(Vec::new()) };
}

/// A number of [`PRECISION`] bits, or nothing known after a division by zero.
///
/// It is a `Copy` handle into storage of its thread, which [`Wide::scope`] frees; a handle must not leave its scope.
#[derive(Debug, Clone, Copy)]
pub struct Wide(Option<usize>);

impl Wide {
    /// Runs `work` and frees the numbers that it made.
    pub fn scope<R>(work: impl FnOnce() -> R) -> R {
        let before = VALUES.with_borrow(Vec::len);
        let result = work();
        VALUES.with_borrow_mut(|values| values.truncate(before));
        result
    }

    /// The nearest f64; NaN after a division by zero.
    pub fn to_f64(self) -> f64 {
        self.read(|value| value.to_f64().value()).unwrap_or(f64::NAN)
    }

    /// Cosine and sine of the f64 `angle` \[rad\].
    pub fn cos_sin(angle: f64) -> (Self, Self) {
        let pair = Self::from_f64(angle).read(Big::sin_cos);
        pair.map_or((Self(None), Self(None)), |(sin, cos)| (Self::keep(cos), Self::keep(sin)))
    }

    fn keep(value: Big) -> Self {
        VALUES.with_borrow_mut(|values| {
            values.push(value);
            Self(Some(values.len() - 1))
        })
    }

    fn read<R>(self, read: impl FnOnce(&Big) -> R) -> Option<R> {
        VALUES.with_borrow(|values| self.0.and_then(|index| values.get(index)).map(read))
    }

    fn combine(self, other: Self, operation: impl FnOnce(&Big, &Big) -> Option<Big>) -> Self {
        let result = VALUES.with_borrow(|values| operation(values.get(self.0?)?, values.get(other.0?)?));
        result.map_or(Self(None), Self::keep)
    }
}

impl Real for Wide {
    fn from_f64(value: f64) -> Self {
        Big::try_from(value).map_or(Self(None), |value| Self::keep(value.with_precision(PRECISION).value()))
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a + b))
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a - b))
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a * b))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.combine(other, |a, b| (*b != Big::ZERO).then(|| a / b))
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        self.read(|value| -value).map_or(Self(None), Self::keep)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_more_than_two_hundred_bits() {
        let tiny = Wide::from_f64(2f64.powi(-250));
        let one = Wide::one();
        assert_eq!(((one + tiny) - one).to_f64(), 2f64.powi(-250));
        let third = one / Wide::from_f64(3.0);
        assert!((third * Wide::from_f64(3.0) - one).to_f64().abs() <= 2f64.powi(-255));
        assert!((one / Wide::zero()).to_f64().is_nan());
    }

    #[test]
    fn cosine_and_sine_are_those_of_the_angle() {
        for angle in [0.0, 1e-9, 0.5, -1.4, 1e3] {
            let (cos, sin) = Wide::cos_sin(angle);
            assert!((cos * cos + sin * sin - Wide::one()).to_f64().abs() < 2f64.powi(-250), "{angle}");
            // libm errs by less than one unit in the last place.
            assert!((cos.to_f64() - angle.cos()).abs() <= f64::EPSILON, "{angle}");
            assert!((sin.to_f64() - angle.sin()).abs() <= f64::EPSILON * angle.sin().abs(), "{angle}");
        }
    }
}
