//! The rectangle that a text takes.

use super::{Pixel, font};

/// \[px\].
#[derive(Debug, Clone, Copy)]
pub struct TextBox {
    pub middle: Pixel,
    /// Half its width and height.
    pub half: Pixel,
}

impl TextBox {
    /// Half the width and height of a line of text in a font of this size, with a small margin.
    pub fn half_of(text: &str, size: u32) -> Pixel {
        (0.5 * font::width(text, size) + 3.0, 0.5 * font::CAPITAL * f64::from(size) + 3.0)
    }

    /// A square around a point.
    pub(super) fn around(middle: Pixel, reach: f64) -> Self {
        Self { middle, half: (reach, reach) }
    }

    /// Whether it lies within a panel of this size.
    pub fn is_within(&self, (width, height): Pixel) -> bool {
        let ((x, y), (across, up)) = (self.middle, self.half);
        across <= x && x <= width - across && up <= y && y <= height - up
    }

    /// Whether it covers another one, or almost touches its side.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let (dx, dy) = ((self.middle.0 - other.middle.0).abs(), (self.middle.1 - other.middle.1).abs());
        dx < self.half.0 + other.half.0 + 2.0 && dy < self.half.1 + other.half.1
    }

    /// The distance of a point from its edge; negative inside.
    pub fn distance(&self, (x, y): Pixel) -> f64 {
        let (across, up) = ((x - self.middle.0).abs() - self.half.0, (y - self.middle.1).abs() - self.half.1);
        if across > 0.0 || up > 0.0 { libm::hypot(across.max(0.0), up.max(0.0)) } else { across.max(up) }
    }
}
