//! Colours that people with any colour vision tell apart, on a screen and in grey print.

/// A colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Of texts and outlines.
    Black,
    /// Bluish green.
    Green,
    /// Deep blue.
    Blue,
    /// Light blue.
    SkyBlue,
    /// Light orange.
    Orange,
    /// Reddish orange.
    Vermilion,
    /// Reddish purple.
    Purple,
    /// Yellow.
    Yellow,
    /// Of what stands behind.
    Grey,
    /// Of what stands far behind.
    Pale,
    /// Of paper.
    White,
    /// A pale fill under lines; neighbours differ in hue and in lightness.
    Tint(usize),
}

/// Light and less light in turn.
const TINTS: [&str; 14] = [
    "#EAF3FB", "#F3CFA8", "#E3F4E4", "#B4D2EA", "#FFF4CC", "#D6BCDA", "#FBE9EF", "#BAD6B0", "#E4F7F8", "#E8BDB6",
    "#F3EEFB", "#D9CF9E", "#F7EEE2", "#A9D4D2",
];

impl Colour {
    /// How many different tints there are; those of even numbers are lighter than those of odd ones.
    pub const TINTS: usize = TINTS.len();

    /// Colours for lines and marks, the most different ones first (Okabe and Ito 2008).
    pub const SERIES: [Self; 8] = [
        Self::Blue,
        Self::Vermilion,
        Self::Green,
        Self::Purple,
        Self::Orange,
        Self::SkyBlue,
        Self::Black,
        Self::Yellow,
    ];

    /// As SVG writes it.
    pub const fn hex(self) -> &'static str {
        match self {
            Self::Black => "#000000",
            Self::Green => "#009E73",
            Self::Blue => "#0072B2",
            Self::SkyBlue => "#56B4E9",
            Self::Orange => "#E69F00",
            Self::Vermilion => "#D55E00",
            Self::Purple => "#CC79A7",
            Self::Yellow => "#F0E442",
            Self::Grey => "#808080",
            Self::Pale => "#E4E4E4",
            Self::White => "#FFFFFF",
            Self::Tint(at) => TINTS[at % TINTS.len()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lightness CIE L* of a colour, 0 to 100.
    fn lightness(colour: Colour) -> f64 {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour.hex()[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
        };
        let luminance = 0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5);
        116.0 * libm::cbrt(luminance) - 16.0
    }

    #[test]
    fn neighbouring_tints_differ_in_grey_print_and_are_lighter_than_any_line() {
        let tints: Vec<f64> = (0..=TINTS.len()).map(|at| lightness(Colour::Tint(at))).collect();
        for pair in tints.windows(2) {
            assert!((pair[0] - pair[1]).abs() > 6.0, "{pair:?}");
        }
        let darkest = tints.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(darkest > lightness(Colour::SkyBlue));
    }
}
