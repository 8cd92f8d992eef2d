//! Exact rationals, for the few signs that rounding hides in data given exactly.

use super::{Ordered, Real, Sign};
use dashu_ratio::RBig;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

thread_local! {
    static VALUES: RefCell<Vec<RBig>> = const { RefCell::new(Vec::new()) };
}

/// An exact rational number, or nothing known after a division by zero.
///
/// It is a `Copy` handle into storage of its thread, which [`Exact::scope`] frees; a handle must not leave its scope.
#[derive(Debug, Clone, Copy)]
pub struct Exact(Option<usize>);

impl Exact {
    /// Runs `work` and frees the numbers that it made.
    pub fn scope<R>(work: impl FnOnce() -> R) -> R {
        let before = VALUES.with_borrow(Vec::len);
        let result = work();
        VALUES.with_borrow_mut(|values| values.truncate(before));
        result
    }

    fn keep(value: RBig) -> Self {
        VALUES.with_borrow_mut(|values| {
            values.push(value);
            Self(Some(values.len() - 1))
        })
    }

    fn combine(self, other: Self, operation: impl FnOnce(&RBig, &RBig) -> Option<RBig>) -> Self {
        let result = VALUES.with_borrow(|values| operation(values.get(self.0?)?, values.get(other.0?)?));
        result.map_or(Self(None), Self::keep)
    }
}

impl Real for Exact {
    fn from_f64(value: f64) -> Self {
        RBig::try_from(value).map_or(Self(None), Self::keep)
    }
}

impl Ordered for Exact {
    fn sign(self) -> Sign {
        let compared = || VALUES.with_borrow(|values| values.get(self.0?).map(|value| value.cmp(&RBig::ZERO)));
        match compared() {
            Some(Ordering::Less) => Sign::Negative,
            Some(Ordering::Equal) => Sign::Zero,
            Some(Ordering::Greater) => Sign::Positive,
            None => Sign::Undecided,
        }
    }

    fn to_f64(self) -> f64 {
        let value = |index: usize| VALUES.with_borrow(|values| values.get(index).map(|value| value.to_f64().value()));
        self.0.and_then(value).unwrap_or(f64::NAN)
    }
}

impl Add for Exact {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a + b))
    }
}

impl Sub for Exact {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a - b))
    }
}

impl Mul for Exact {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, |a, b| Some(a * b))
    }
}

impl Div for Exact {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.combine(other, |a, b| (*b != RBig::ZERO).then(|| a / b))
    }
}

impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        self.combine(self, |a, _| Some(-a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_loses_is_kept() {
        let third = Exact::from_f64(1.0) / Exact::from_f64(3.0);
        let rest = third * Exact::from_f64(3.0) - Exact::from_f64(1.0);
        assert_eq!(rest.sign(), Sign::Zero);
        let tenth = Exact::from_f64(0.1) - Exact::from_f64(1.0) / Exact::from_f64(10.0);
        assert_eq!(tenth.sign(), Sign::Positive, "0.1 as f64 lies above a tenth");
    }

    #[test]
    fn a_division_by_zero_is_no_number() {
        let nothing = Exact::from_f64(1.0) / Exact::from_f64(0.0);
        assert_eq!((nothing + Exact::from_f64(1.0)).sign(), Sign::Undecided);
        assert!(nothing.to_f64().is_nan());
    }

    #[test]
    fn a_scope_frees_its_numbers() {
        let outside = Exact::from_f64(2.0);
        let count = || VALUES.with_borrow(Vec::len);
        let before = count();
        let sign = Exact::scope(|| (outside * Exact::from_f64(-1.5)).sign());
        assert_eq!((sign, count()), (Sign::Negative, before));
    }
}
