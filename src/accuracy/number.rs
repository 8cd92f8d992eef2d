//! The kinds of numbers that are compared.

use crate::scalar::{Ball, DoubleDouble, Midpoint, Real, Trigonometry};

/// A kind of number in which a state's contact problem can be computed from the state's f64s.
pub trait Number: Trigonometry {
    /// Returns two f64s whose sum is the number, the larger one first.
    fn parts(self) -> [f64; 2];
}

/// f32 has about half the digits of f64, and is used for comparison only.
impl Real for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Trigonometry for f32 {
    fn cos_sin(angle: f64) -> [Self; 2] {
        let (sin, cos) = libm::sincosf(angle as f32);
        [cos, sin]
    }
}

impl Trigonometry for DoubleDouble {
    fn cos_sin(angle: f64) -> [Self; 2] {
        Ball::<DoubleDouble>::cos_sin(angle).map(|ball| ball.mid)
    }
}

impl Number for f32 {
    fn parts(self) -> [f64; 2] {
        [f64::from(self), 0.0]
    }
}

impl<T: Midpoint + Trigonometry> Number for T {
    fn parts(self) -> [f64; 2] {
        Midpoint::parts(self)
    }
}
