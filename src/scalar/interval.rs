//! Enclosures with any number of bits.

use super::{Enclosure, Ordered, Real, Sign, Trigonometry, series};
use dashu_float::round::mode::HalfEven;
use dashu_float::{Context, FBig, FpError, Repr, Word};
use std::cell::RefCell;

const DEFAULT_BITS: usize = 256;
/// Additional bits beyond those that the doublings of an angle lose.
const GUARD_BITS: u32 = 16;
/// Numbers beyond this binary exponent, which no robot reaches, become unknown.
const EXPONENT_LIMIT: i64 = 1 << 24;

thread_local! {
    static STORE: RefCell<Store> = const { RefCell::new(Store { values: Vec::new(), bits: DEFAULT_BITS }) };
}

struct Store {
    values: Vec<Enclosed>,
    bits: usize,
}

/// A midpoint with the bits of its scope, and the greatest distance of the number from it.
#[derive(Clone)]
struct Enclosed {
    mid: Repr<2>,
    radius: Magnitude,
}

/// A real number enclosed with as many bits as its scope has; unknown after a division by a number that may be zero.
///
/// It is a `Copy` handle into thread-local storage, which [`Interval::scope`] frees; it must not leave its scope.
#[derive(Debug, Clone, Copy, Default)]
pub struct Interval(Option<usize>);

/// Frees the numbers of a scope at its end, even on a panic.
struct Scope {
    length: usize,
    bits: usize,
}

impl Drop for Scope {
    fn drop(&mut self) {
        STORE.with_borrow_mut(|store| {
            store.values.truncate(self.length);
            store.bits = self.bits;
        });
    }
}

impl Interval {
    /// Runs `work` with numbers of `bits` bits and frees the numbers that it created.
    pub fn scope<R>(bits: usize, work: impl FnOnce() -> R) -> R {
        let _scope = STORE.with_borrow_mut(|store| {
            let outer = std::mem::replace(&mut store.bits, bits.max(2));
            Scope { length: store.values.len(), bits: outer }
        });
        work()
    }

    fn value(self) -> Option<Enclosed> {
        STORE.with_borrow(|store| store.get(self).cloned())
    }

    fn keep(value: Option<Enclosed>) -> Self {
        STORE.with_borrow_mut(|store| Self(store.push(value)))
    }

    #[inline]
    fn combine(self, other: Self, operation: impl FnOnce(&Enclosed, &Enclosed, usize) -> Option<Enclosed>) -> Self {
        STORE.with_borrow_mut(|store| {
            let result = |store: &Store| operation(store.get(self)?, store.get(other)?, store.bits);
            let value = result(store);
            Self(store.push(value))
        })
    }
}

impl Store {
    fn get(&self, number: Interval) -> Option<&Enclosed> {
        self.values.get(number.0?)
    }

    fn push(&mut self, value: Option<Enclosed>) -> Option<usize> {
        self.values.push(value.filter(Enclosed::is_sensible)?);
        Some(self.values.len() - 1)
    }
}

/// A rounded result, with a bound of its rounding error: a unit in the last place, which is twice the greatest error.
fn rounded(result: Result<dashu_float::round::Rounded<FBig<HalfEven, 2>>, FpError>, bits: usize) -> Option<Enclosed> {
    let result = result.ok()?;
    let exact = matches!(result, dashu_float::round::Rounded::Exact(_));
    let mid = result.value().into_repr();
    if mid.is_infinite() {
        return None;
    }
    let radius = if exact { Magnitude::ZERO } else { Magnitude::power(top(&mid)? - i64::try_from(bits).ok()?) };
    Some(Enclosed { mid, radius })
}

/// The least e with `|number| < 2^e`; `None` for zero.
fn top(number: &Repr<2>) -> Option<i64> {
    let (_, words) = number.significand().as_sign_words();
    let high = words.last()?;
    let digits = words.len() * Word::BITS as usize - high.leading_zeros() as usize;
    i64::try_from(number.exponent()).ok()?.checked_add(i64::try_from(digits).ok()?)
}

impl Enclosed {
    fn is_sensible(&self) -> bool {
        top(&self.mid).is_none_or(|top| top.abs() <= EXPONENT_LIMIT) && self.radius.exponent <= EXPONENT_LIMIT
    }

    fn is_exact_zero(&self) -> bool {
        self.mid.significand().is_zero() && self.radius.is_zero()
    }

    fn zero() -> Self {
        Self { mid: Repr::zero(), radius: Magnitude::ZERO }
    }

    fn sum(&self, other: &Self, bits: usize) -> Option<Self> {
        if self.is_exact_zero() {
            return Some(other.clone());
        }
        if other.is_exact_zero() {
            return Some(self.clone());
        }
        let sum = rounded(Context::new(bits).add(&self.mid, &other.mid), bits)?;
        Some(Self { radius: sum.radius + self.radius + other.radius, mid: sum.mid })
    }

    fn difference(&self, other: &Self, bits: usize) -> Option<Self> {
        if other.is_exact_zero() {
            return Some(self.clone());
        }
        let sum = rounded(Context::new(bits).sub(&self.mid, &other.mid), bits)?;
        Some(Self { radius: sum.radius + self.radius + other.radius, mid: sum.mid })
    }

    fn product(&self, other: &Self, bits: usize) -> Option<Self> {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Some(Self::zero());
        }
        let product = rounded(Context::new(bits).mul(&self.mid, &other.mid), bits)?;
        let mut radius = product.radius;
        if !self.radius.is_zero() {
            radius = radius + self.radius * (Magnitude::above(&other.mid) + other.radius);
        }
        if !other.radius.is_zero() {
            radius = radius + other.radius * Magnitude::above(&self.mid);
        }
        Some(Self { mid: product.mid, radius })
    }

    fn quotient(&self, other: &Self, bits: usize) -> Option<Self> {
        let least = Magnitude::below(&other.mid).less(other.radius)?;
        if self.is_exact_zero() {
            return Some(Self::zero());
        }
        let quotient = rounded(Context::new(bits).div(&self.mid, &other.mid), bits)?;
        let mut radius = quotient.radius;
        if !self.radius.is_zero() || !other.radius.is_zero() {
            let most = Magnitude::above(&quotient.mid) + quotient.radius;
            radius = radius + (self.radius + most * other.radius) / least;
        }
        Some(Self { mid: quotient.mid, radius })
    }

    fn sign(&self) -> Sign {
        if self.is_exact_zero() {
            Sign::Zero
        } else if Magnitude::below(&self.mid).less(self.radius).is_none() {
            Sign::Undecided
        } else if self.mid < Repr::zero() {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }
}

impl Real for Interval {
    fn from_f64(value: f64) -> Self {
        let exact = |mid: Repr<2>| (!mid.is_infinite()).then_some(Enclosed { mid, radius: Magnitude::ZERO });
        Self::keep(Repr::try_from(value).ok().and_then(exact))
    }
}

impl Ordered for Interval {
    fn sign(self) -> Sign {
        STORE.with_borrow(|store| store.get(self).map_or(Sign::Undecided, Enclosed::sign))
    }

    fn to_f64(self) -> f64 {
        self.value().map_or(f64::NAN, |value| value.mid.to_f64().value())
    }

    fn freeing<R>(work: impl FnOnce() -> R) -> R {
        Self::scope(STORE.with_borrow(|store| store.bits), work)
    }

    fn keeping<E>(work: impl FnOnce() -> Result<Vec<Self>, E>) -> Result<Vec<Self>, E> {
        let kept: Vec<Option<Enclosed>> =
            Self::freeing(|| work().map(|kept| kept.into_iter().map(Self::value).collect()))?;
        Ok(kept.into_iter().map(Self::keep).collect())
    }

    fn error(self) -> f64 {
        self.value().map_or(f64::INFINITY, |value| value.radius.to_f64())
    }
}

impl Enclosure for Interval {
    fn widened(self, by: Self) -> Self {
        self.combine(by, |value, by, _| {
            Some(Enclosed { mid: value.mid.clone(), radius: value.radius + (Magnitude::above(&by.mid) + by.radius) })
        })
    }
}

impl Trigonometry for Interval {
    /// Computes with more bits, since the doublings lose some, and rounds the results to the bits of the scope.
    fn cos_sin(angle: f64) -> [Self; 2] {
        let bits = STORE.with_borrow(|store| store.bits);
        let wanted = u32::try_from(bits).unwrap_or(u32::MAX / 4);
        let halvings = series::halvings(angle, wanted);
        let raised = wanted.saturating_add(2 * halvings + GUARD_BITS);
        let values = Self::scope(raised as usize, || series::cos_sin::<Self>(angle, halvings, raised).map(Self::value));
        values.map(|value| {
            Self::keep(value.and_then(|Enclosed { mid, radius }| {
                let fewer = rounded(Context::new(bits).add(&mid, &Repr::zero()), bits)?;
                Some(Enclosed { radius: fewer.radius + radius, mid: fewer.mid })
            }))
        })
    }
}

impl Interval {
    fn plus(self, other: Self) -> Self {
        self.combine(other, Enclosed::sum)
    }

    fn minus(self, other: Self) -> Self {
        self.combine(other, Enclosed::difference)
    }

    fn times(self, other: Self) -> Self {
        self.combine(other, Enclosed::product)
    }

    fn over(self, other: Self) -> Self {
        self.combine(other, Enclosed::quotient)
    }

    fn negated(self) -> Self {
        self.combine(self, |value, _, _| Some(Enclosed { mid: -value.mid.clone(), radius: value.radius }))
    }
}

operators!([] Interval);

/// A factor that covers the roundings of one operation on bounds.
const UP: f64 = 1.0 + 4.0 * f64::EPSILON;
const DOWN: f64 = 1.0 - 4.0 * f64::EPSILON;
/// The bits of an f64's significand.
const DIGITS: u32 = 53;
/// The exponent bits of an f64 hold its exponent plus this.
const BIAS: i64 = 1023;

/// A bound `significand * 2^exponent` of a magnitude, with a larger exponent range than f64. It is an upper bound and
/// rounds upward, except in [`Magnitude::below`] and [`Magnitude::less`].
///
/// The significand is zero or lies in \[1, 2).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Magnitude {
    significand: f64,
    exponent: i64,
}

impl Magnitude {
    const ZERO: Self = Self { significand: 0.0, exponent: 0 };

    fn is_zero(self) -> bool {
        self.significand == 0.0
    }

    fn power(exponent: i64) -> Self {
        Self { significand: 1.0, exponent }
    }

    /// The bound `significand * 2^exponent` of a significand that is any positive normal number.
    #[inline]
    fn normalized(significand: f64, exponent: i64) -> Self {
        let bits = significand.to_bits();
        let shift = (bits >> (DIGITS - 1)) as i64 - BIAS;
        let kept = bits & ((1 << (DIGITS - 1)) - 1) | ((BIAS as u64) << (DIGITS - 1));
        // The exponent is bounded from below. A larger upper bound is valid, and lower bounds do not get that small.
        Self { significand: f64::from_bits(kept), exponent: (exponent + shift).max(-4 * EXPONENT_LIMIT) }
    }

    /// 2^-shift, for a shift of 0 to 63.
    fn down(shift: i64) -> f64 {
        f64::from_bits(((BIAS - shift) as u64) << (DIGITS - 1))
    }

    /// The top bits of a number, their exponent, and whether the number has no others.
    #[inline]
    fn leading(number: &Repr<2>) -> (u64, i64, bool) {
        let (_, words) = number.significand().as_sign_words();
        let Some(&high) = words.last() else { return (0, 0, true) };
        let low = if words.len() > 1 { words[words.len() - 2] } else { 0 };
        // The two top words as one integer.
        let both = (u128::from(high) << Word::BITS) | u128::from(low);
        let dropped = (128 - both.leading_zeros()).saturating_sub(DIGITS);
        let significand = both >> dropped;
        let all = words.len() <= 2 && significand << dropped == both;
        let words_below = words.len() as i64 - 2;
        let exponent = number.exponent() as i64 + words_below * i64::from(Word::BITS) + i64::from(dropped);
        (significand as u64, exponent, all)
    }

    /// An upper bound of a number's magnitude.
    fn above(number: &Repr<2>) -> Self {
        let (significand, exponent, all) = Self::leading(number);
        let significand = if all { significand } else { significand + 1 };
        if significand == 0 { Self::ZERO } else { Self::normalized(significand as f64, exponent) }
    }

    /// A lower bound of a number's magnitude.
    fn below(number: &Repr<2>) -> Self {
        let (significand, exponent, _) = Self::leading(number);
        if significand == 0 { Self::ZERO } else { Self::normalized(significand as f64, exponent) }
    }

    /// A lower bound of `self - other`; `None` unless it is positive.
    fn less(self, other: Self) -> Option<Self> {
        if self.is_zero() {
            return None;
        }
        if other.is_zero() {
            return Some(self);
        }
        let significand = match self.exponent - other.exponent {
            64.. => self.significand,
            shift @ 0..64 => self.significand - other.significand * Self::down(shift),
            _ => return None,
        };
        (significand > 0.0).then(|| Self::normalized(significand * DOWN, self.exponent))
    }

    /// The bound as an f64: infinite above the range of f64, and the least normal number below it.
    fn to_f64(self) -> f64 {
        if self.is_zero() {
            0.0
        } else if self.exponent < -1022 {
            f64::MIN_POSITIVE
        } else {
            libm::scalbn(self.significand, i32::try_from(self.exponent).unwrap_or(i32::MAX))
        }
    }
}

impl Magnitude {
    #[inline]
    fn plus(self, other: Self) -> Self {
        if self.is_zero() {
            return other;
        }
        if other.is_zero() {
            return self;
        }
        let (high, low) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = high.exponent - low.exponent;
        let low = if shift < 64 { low.significand * Self::down(shift) } else { 0.0 };
        Self::normalized((high.significand + low) * UP, high.exponent)
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        Self::normalized(self.significand * other.significand * UP, self.exponent + other.exponent)
    }

    /// Divides by a lower bound of the divisor, which is not zero.
    #[inline]
    fn over(self, other: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        Self::normalized(self.significand / other.significand * UP, self.exponent - other.exponent)
    }
}

operators!(@ [] Magnitude, Add add plus);
operators!(@ [] Magnitude, Mul mul times);
operators!(@ [] Magnitude, Div div over);

#[cfg(test)]
mod tests {
    use super::super::tests::{Bounded, exact};
    use super::*;
    use dashu_ratio::RBig;

    impl Bounded for Interval {
        fn bounds(self) -> Option<[RBig; 2]> {
            let Enclosed { mid, radius } = self.value()?;
            let power = RBig::from(2u8).pow(radius.exponent as isize);
            Some([mid.try_into().expect("finite"), exact(radius.significand) * power])
        }
    }

    #[test]
    fn results_have_the_bits_of_their_scope() {
        for bits in [100, 1000, 4096] {
            let (off, wide) = Interval::scope(bits, || {
                let number = Interval::from_f64;
                let tiny = (0..bits / 10).fold(number(1.0), |product, _| product * number(1.0 / 1024.0));
                let off = number(1.0) / number(3.0) * (number(1.0) + tiny * number(1e6)) * number(3.0) - number(1.0);
                (off.sign(), (number(1.0) / number(3.0)).error())
            });
            assert_eq!(off, Sign::Positive);
            assert!(wide <= 0.5f64.powi(bits.min(1022) as i32));
        }
    }

    #[test]
    fn endless_powers_become_unknown() {
        Interval::scope(64, || {
            for start in [3.0, 1.0 / 3.0] {
                let last = (0..80).fold(Interval::from_f64(start), |power, _| power * power);
                assert_eq!(last.sign(), Sign::Undecided);
            }
        });
    }

    #[test]
    fn scope_frees_its_numbers() {
        let count = || STORE.with_borrow(|store| (store.values.len(), store.bits));
        let outside = Interval::from_f64(2.0);
        let before = count();
        let sign = Interval::scope(99, || (outside * Interval::from_f64(-1.5)).sign());
        assert_eq!((sign, count()), (Sign::Negative, before));
        let product = || Ok::<_, ()>(vec![outside * Interval::from_f64(-1.5) * Interval::from_f64(4.0)]);
        let kept = Interval::keeping(product).unwrap();
        assert_eq!((kept[0].to_f64(), count().0), (-12.0, before.0 + 1));
    }
}
