//! The numbers that the core runs on.
//!
//! From kinematics to the slacks of the modes every algorithm is written once over [`Real`]: it neither branches on a
//! number nor takes a root, so that eight lanes, a ball, a double-double or an exact rational run the same code as `f64`.
//! [`Ball`] is the instance that knows its own rounding and [`Exact`] the one that has none; only the stage that turns numbers
//! into signs looks inside.

mod ball;
mod exact;

pub use ball::Ball;
pub use exact::Exact;

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
