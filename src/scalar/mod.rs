//! The numbers that the core runs on.
//!
//! From kinematics to the slacks of the modes every algorithm is written once over [`Real`]. It neither branches on a
//! number nor takes a root, so that eight lanes, a ball, a double-double or an exact rational run the same code as
//! `f64`. Only the stage that turns numbers into signs looks inside.
//!
//! | Number | Encloses | Cost of an operation |
//! | --- | --- | --- |
//! | `f64` | nothing | 1 |
//! | [`DoubleDouble`] | nothing; 106 bits | about 20 |
//! | [`Ball`] | the exact result of its operations, over f64 or [`DoubleDouble`] | about 5, or 30 |
//! | [`Interval`] | the same, with any number of bits | an allocation, some 100 |
//! | [`Residue`] | nothing; knows whether the exact result is zero | about 20, a quotient some 500 |
//! | [`Certified`] | an enclosure and a residue of the same number | both |
//! | [`Affine`] | results for data that are known to an interval only, linear in N common causes | N |

/// Implements the operators of a number by its methods `plus`, `minus`, `times`, `over` and `negated`.
macro_rules! operators {
    ([$($parameters:tt)*] $number:ty) => {
        operators!(@ [$($parameters)*] $number, Add add plus);
        operators!(@ [$($parameters)*] $number, Sub sub minus);
        operators!(@ [$($parameters)*] $number, Mul mul times);
        operators!(@ [$($parameters)*] $number, Div div over);
        impl<$($parameters)*> std::ops::Neg for $number {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                self.negated()
            }
        }
    };
    (@ [$($parameters:tt)*] $number:ty, $operator:ident $function:ident $method:ident) => {
        impl<$($parameters)*> std::ops::$operator for $number {
            type Output = Self;
            #[inline]
            fn $function(self, other: Self) -> Self {
                self.$method(other)
            }
        }
    };
}

mod double;
mod series;
mod ball;
mod interval;
mod residue;
mod certified;
mod affine;

pub use affine::Affine;
pub use ball::Ball;
pub use certified::Certified;
pub use double::DoubleDouble;
pub use interval::Interval;
pub use residue::Residue;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the core: `Copy`, with the four operations, negation, and every `f64` exactly.
///
/// A number on the heap takes part by a `Copy` handle, as [`Interval`] does: the algorithms stay free of borrows.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The number that is exactly `value`.
    fn from_f64(value: f64) -> Self;

    /// Zero.
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// One.
    fn one() -> Self {
        Self::from_f64(1.0)
    }
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// The sign of a number that may be known inexactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Less than zero.
    Negative,
    /// Exactly zero.
    Zero,
    /// Greater than zero.
    Positive,
    /// The error does not exclude zero.
    Undecided,
}

impl Sign {
    /// The sign of a number with an absolute error of at most `error`.
    pub fn within(number: f64, error: f64) -> Self {
        if number > error {
            Sign::Positive
        } else if number < -error {
            Sign::Negative
        } else if number == 0.0 && error == 0.0 {
            Sign::Zero
        } else {
            Sign::Undecided
        }
    }
}

/// A number that knows its own sign, or that its precision does not suffice for it.
pub trait Ordered: Real {
    /// The sign; never guessed.
    fn sign(self) -> Sign;

    /// The nearest f64, or one as near as the number is known; NaN if nothing is known.
    fn to_f64(self) -> f64;

    /// Runs `work` and frees the storage of the numbers that it made; none of them may leave it.
    fn freeing<R>(work: impl FnOnce() -> R) -> R {
        work()
    }

    /// How far the number may be from [`Ordered::to_f64`], that rounding excepted; infinite if nothing is known.
    fn error(self) -> f64;
}

/// A number that has the cosine and sine of an f64 angle.
pub trait Trigonometry: Real {
    /// Cosine and sine of exactly the angle that `angle` \[rad\] is.
    fn cos_sin(angle: f64) -> [Self; 2];
}

impl Trigonometry for f64 {
    fn cos_sin(angle: f64) -> [Self; 2] {
        let (sin, cos) = libm::sincos(angle);
        [cos, sin]
    }
}

/// A number that is known up to an error.
pub trait Enclosure: Ordered {
    /// This number, known only up to a further error of at most the magnitude of `by`.
    fn widened(self, by: Self) -> Self;
}

/// A floating-point number that can be the centre of a [`Ball`].
pub trait Midpoint: Real {
    /// The greatest relative error of a product or a quotient.
    const ROUNDING: f64;

    /// Whether it is exactly zero.
    fn is_zero(self) -> bool;

    /// Whether it is a number at all.
    fn is_finite(self) -> bool;

    /// At least the absolute value.
    fn magnitude(self) -> f64;

    /// At most the absolute value.
    fn least_magnitude(self) -> f64;

    /// The sum and a bound of its error up to a relative 2^-52, which is zero if the sum is exact.
    fn sum(self, other: Self) -> (Self, f64);

    /// The sign of a number at most `radius` away.
    fn sign_within(self, radius: f64) -> Sign;

    /// The nearest f64.
    fn to_f64(self) -> f64;

    /// The greatest error of a product that was rounded to this number; its last part covers underflow.
    #[inline]
    fn rounding(self) -> f64 {
        self.magnitude() * Self::ROUNDING + f64::MIN_POSITIVE
    }

    /// The greatest error of a quotient that was rounded to this number, by a divisor no smaller than `divisor`.
    #[inline]
    fn quotient_rounding(self, _divisor: f64) -> f64 {
        self.rounding()
    }
}

#[cfg(test)]
mod exact {
    use dashu::rational::RBig;

    /// The rational that a finite f64 is.
    pub fn exact(value: f64) -> RBig {
        RBig::try_from(value).expect("finite")
    }

    pub fn magnitude(value: RBig) -> RBig {
        if value < RBig::ZERO { -value } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_within_the_error_is_undecided() {
        assert_eq!(Sign::within(1e-3, 1e-4), Sign::Positive);
        assert_eq!(Sign::within(-1e-3, 1e-4), Sign::Negative);
        assert_eq!(Sign::within(1e-5, 1e-4), Sign::Undecided);
        assert_eq!(Sign::within(0.0, 1e-4), Sign::Undecided);
        assert_eq!(Sign::within(0.0, 0.0), Sign::Zero);
        assert_eq!(Sign::within(f64::NAN, 0.0), Sign::Undecided);
        assert_eq!(Ball { mid: 1.0, radius: f64::INFINITY }.sign(), Sign::Undecided);
    }
}
