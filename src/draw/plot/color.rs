//! Colors that people with any color vision can distinguish, on a screen and in gray print.

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Color {
    Black,
    Green,
    Blue,
    SkyBlue,
    Orange,
    Vermilion,
    Purple,
    Gray,
    Pale,
    White,
    /// A pale fill under lines. Tints of successive numbers differ in hue and in lightness.
    Tint(usize),
}

/// The tints, lighter and darker in turn.
const TINTS: [&str; 14] = [
    "#eaf3fb", "#f3cfa8", "#e3f4e4", "#b4d2ea", "#fff4cc", "#d6bcda", "#fbe9ef", "#bad6b0", "#e4f7f8", "#e8bdb6",
    "#f3eefb", "#d9cf9e", "#f7eee2", "#a9d4d2",
];

impl Color {
    /// The number of different tints. Even tints are lighter than odd ones.
    pub const TINTS: usize = TINTS.len();

    /// Returns the color as `#rrggbb`. The colors of lines and marks are those of Okabe and Ito (2008).
    pub const fn hex(self) -> &'static str {
        match self {
            Self::Black => "#000000",
            Self::Green => "#009e73",
            Self::Blue => "#0072b2",
            Self::SkyBlue => "#56b4e9",
            Self::Orange => "#e69f00",
            Self::Vermilion => "#d55e00",
            Self::Purple => "#cc79a7",
            Self::Gray => "#808080",
            Self::Pale => "#e4e4e4",
            Self::White => "#ffffff",
            Self::Tint(at) => TINTS[at % TINTS.len()],
        }
    }

    pub(super) fn rgb(self) -> [u8; 3] {
        [1, 3, 5].map(|at| u8::from_str_radix(&self.hex()[at..at + 2], 16).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lightness CIE L* of a color, from 0 to 100.
    fn lightness(color: Color) -> f64 {
        let [red, green, blue] = color.rgb().map(|value| {
            let value = f64::from(value) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
        });
        116.0 * libm::cbrt(0.2126 * red + 0.7152 * green + 0.0722 * blue) - 16.0
    }

    #[test]
    fn neighboring_tints_differ_in_gray_print() {
        let tints: Vec<f64> = (0..=TINTS.len()).map(|at| lightness(Color::Tint(at))).collect();
        assert!(tints.windows(2).all(|pair| (pair[0] - pair[1]).abs() > 6.0), "{tints:?}");
        assert!(tints.iter().all(|&tint| tint > lightness(Color::SkyBlue)));
    }
}
