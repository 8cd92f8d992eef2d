//! The numbers that the core runs on.
//!
//! From kinematics to the slacks of the modes every algorithm is written once over [`Real`]: it neither branches on a
//! number nor takes a root, so that eight lanes, a ball, a double-double or an exact rational run the same code as `f64`.
//! [`Ball`] is the instance that knows its own rounding, over f64 or over [`DoubleDouble`], [`Interval`] the one with as many
//! digits as asked for, and [`Residue`] the one that tells only whether a number is zero; [`Certified`] carries an enclosure
//! and a residue in step, so that enough digits decide every sign. [`Affine`] is the instance for data that are themselves
//! known to an interval alone. Only the stage that turns numbers into signs looks inside.

mod affine;
mod ball;
mod certified;
mod double;
mod interval;
mod residue;
mod series;

pub use affine::Affine;
pub use ball::{Ball, Midpoint};
pub use certified::Certified;
pub use double::DoubleDouble;
pub use interval::Interval;
pub use residue::Residue;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the core: `Copy`, the four operations, negation, and every `f64` exactly.
///
/// A heap number joins by a `Copy` handle (see the tests' exact rational).
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
    /// Zero lies within the error.
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

/// A number that knows its own sign, or that its precision does not tell it.
pub trait Ordered: Real {
    /// The sign; never guessed.
    fn sign(self) -> Sign;

    /// The nearest f64, or one as near as the number is known; NaN where nothing is known.
    fn to_f64(self) -> f64;

    /// Runs `work` and frees the storage of the numbers that it made, where they have any; none may leave it.
    fn freeing<R>(work: impl FnOnce() -> R) -> R {
        work()
    }

    /// How far the number may be from [`Ordered::to_f64`], beside that rounding; infinite where nothing is known.
    fn error(self) -> f64;
}

/// A number in which the cosine and sine of an f64 angle can be told.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_is_told_only_outside_the_error() {
        assert_eq!(Sign::within(1e-3, 1e-4), Sign::Positive);
        assert_eq!(Sign::within(-1e-3, 1e-4), Sign::Negative);
        assert_eq!(Sign::within(1e-5, 1e-4), Sign::Undecided);
        assert_eq!(Sign::within(0.0, 1e-4), Sign::Undecided);
        assert_eq!(Sign::within(0.0, 0.0), Sign::Zero);
        assert_eq!(Sign::within(f64::NAN, 0.0), Sign::Undecided);
        assert_eq!(Ball { mid: 1.0, radius: f64::INFINITY }.sign(), Sign::Undecided);
    }
}
