//! The numbers that are compared, and what each needs in addition to [`Real`]: its angles, and itself as f64s.

use crate::planar::Rotation;
use crate::scalar::{Ball, DoubleDouble, Interval, Ordered, Real, Trigonometry};

/// A number that a state can be computed in, from its f64s on.
pub trait Number: Real {
    /// Cosine and sine of an f64 angle \[rad\], as exactly as this number holds them.
    fn rotation(angle: f64) -> Rotation<Self>;

    /// f64s whose sum is the number, the larger one first.
    fn parts(self) -> [f64; 2];
}

/// Half the digits of f64, for comparison only.
impl Real for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Number for f32 {
    fn rotation(angle: f64) -> Rotation<Self> {
        let (sin, cos) = libm::sincosf(angle as f32);
        Rotation { cos, sin }
    }

    fn parts(self) -> [f64; 2] {
        [f64::from(self), 0.0]
    }
}

impl Number for f64 {
    fn rotation(angle: f64) -> Rotation<Self> {
        Rotation::by(angle)
    }

    fn parts(self) -> [f64; 2] {
        [self, 0.0]
    }
}

impl Number for DoubleDouble {
    fn rotation(angle: f64) -> Rotation<Self> {
        let [cos, sin] = Ball::<DoubleDouble>::cos_sin(angle).map(|ball| ball.mid);
        Rotation { cos, sin }
    }

    fn parts(self) -> [f64; 2] {
        crate::scalar::Midpoint::parts(self)
    }
}

impl Number for Interval {
    fn rotation(angle: f64) -> Rotation<Self> {
        let [cos, sin] = Self::cos_sin(angle);
        Rotation { cos, sin }
    }

    fn parts(self) -> [f64; 2] {
        let head = self.to_f64();
        [head, (self - Self::from_f64(head)).to_f64()]
    }
}
