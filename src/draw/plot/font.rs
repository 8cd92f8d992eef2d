//! The one font of all pictures, and the sizes of texts. It is embedded so that pictures are the same on every machine.
//!
//! `DejaVuSans.ttf` is a subset of DejaVu Sans 2.37: Latin, Greek and Cyrillic letters and the symbols in use, without
//! hints and layout tables. Its license is in `DejaVuSans.license.txt`. fontTools 4 created it with
//!
//! ```text
//!     pyftsubset DejaVuSans.ttf --layout-features= --no-hinting --notdef-outline
//!         --drop-tables+=kern,GPOS,GSUB,GDEF,FFTM
//!         --unicodes=U+0020-007E,U+00A0-017F,U+0370-03FF,U+0400-045F,U+2010-2044,U+2070-209C,U+2190-2193,
//!                    U+21D2,U+2200-2265,U+FFFD
//! ```

use super::Pixel;
use crate::error::visible;
use std::borrow::Cow;
use ttf_parser::{Face, GlyphId};

const BYTES: &[u8] = include_bytes!("DejaVuSans.ttf");
/// The font family in SVG.
pub(super) const FAMILY: &str = "DejaVu Sans, sans-serif";

/// The height of capital letters as a share of the font size.
pub(super) const CAPITAL: f64 = 0.73;

/// Returns the font; it is `None` only if the program is damaged.
pub(super) fn face() -> Option<Face<'static>> {
    Face::parse(BYTES, 0).ok()
}

/// Returns the glyphs of a line with their advances, in the font's units.
pub(super) fn glyphs(face: &Face, line: &str) -> impl Iterator<Item = (GlyphId, f64)> {
    line.chars().map(|letter| {
        // The font's first glyph replaces characters that it does not contain.
        let glyph = face.glyph_index(letter).unwrap_or(GlyphId(0));
        (glyph, f64::from(face.glyph_hor_advance(glyph).unwrap_or_default()))
    })
}

/// The largest number of characters drawn of a line, and of a text of several lines.
const LINE: usize = 400;
const TEXT: usize = 4000;
/// The number of characters that a shortened text keeps at its end.
const TAIL: usize = 40;

/// Replaces the middle of a text of more than `most` characters by an ellipsis.
fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    if text.chars().nth(most).is_none() {
        return text.into();
    }
    let head: String = text.chars().take(most - TAIL - 1).collect();
    let tail = text.char_indices().nth_back(TAIL - 1).map_or("", |(start, _)| &text[start..]);
    format!("{head}…{tail}").into()
}

/// Returns a text of several lines as it is drawn.
pub(super) fn readable(text: &str) -> Cow<'_, str> {
    shortened(text, TEXT)
}

/// Returns a line as it is drawn.
pub(super) fn drawn(text: &str) -> Cow<'_, str> {
    match visible(text) {
        Cow::Borrowed(text) => shortened(text, LINE),
        Cow::Owned(text) => shortened(&text, LINE).into_owned().into(),
    }
}

/// Returns the width of a line of text \[px\].
pub(super) fn width(text: &str, size: u32) -> f64 {
    let width = |face: Face| {
        let units: f64 = glyphs(&face, &drawn(text)).map(|(_, advance)| advance).sum();
        units * f64::from(size) / f64::from(face.units_per_em())
    };
    face().map_or(0.0, width)
}

/// Breaks a text at spaces into lines of at most `room` \[px\]. A wider word has a line of its own.
pub(super) fn lines(text: &str, size: u32, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in readable(text).lines() {
        let mut line = String::new();
        for word in paragraph.split(' ').map(drawn) {
            let longer = if line.is_empty() { word.clone().into_owned() } else { format!("{line} {word}") };
            if line.is_empty() || width(&longer, size) <= room {
                line = longer;
            } else {
                lines.push(std::mem::replace(&mut line, word.into_owned()));
            }
        }
        lines.push(line);
    }
    lines
}

/// The rectangle of a text \[px\].
#[derive(Debug, Clone, Copy)]
pub struct TextBox {
    pub middle: Pixel,
    /// Half the width and half the height.
    pub half: Pixel,
}

impl TextBox {
    /// Returns half the width and half the height of a line of text in a font of this size, with a small margin.
    pub fn half_of(text: &str, size: u32) -> Pixel {
        (0.5 * width(text, size) + 3.0, 0.5 * CAPITAL * f64::from(size) + 3.0)
    }

    /// Returns the square around a point; `reach` is half its side.
    pub(super) fn around(middle: Pixel, reach: f64) -> Self {
        Self { middle, half: (reach, reach) }
    }

    /// Returns whether the rectangle lies within a panel of this size.
    pub fn is_within(&self, (width, height): Pixel) -> bool {
        let ((x, y), (across, up)) = (self.middle, self.half);
        across <= x && x <= width - across && up <= y && y <= height - up
    }

    /// Returns whether the rectangle overlaps another, or comes closer than 2 px to its left or right side.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let (dx, dy) = ((self.middle.0 - other.middle.0).abs(), (self.middle.1 - other.middle.1).abs());
        dx < self.half.0 + other.half.0 + 2.0 && dy < self.half.1 + other.half.1
    }

    /// Returns the distance of a point from the edge of the rectangle \[px\]; negative inside.
    pub fn distance(&self, (x, y): Pixel) -> f64 {
        let (across, up) = ((x - self.middle.0).abs() - self.half.0, (y - self.middle.1).abs() - self.half.1);
        if across > 0.0 || up > 0.0 { libm::hypot(across.max(0.0), up.max(0.0)) } else { across.max(up) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_subset_has_every_sign_in_use() {
        let face = face().unwrap();
        for letter in "AZaz09àŁαωΔΩж−–…±²³⁰⁴⁻⁹₀→≤≥≈∞µ°".chars() {
            assert!(face.glyph_index(letter).is_some(), "{letter}");
        }
    }

    #[test]
    fn lines_are_broken_where_they_are_too_long() {
        assert_eq!(lines("one two three\nfour", 10, width("one two", 10)), ["one two", "three", "four"]);
        assert_eq!(lines("unbreakable", 10, 1.0), ["unbreakable"]);
    }

    #[test]
    fn a_text_of_any_length_is_drawn_in_bounded_time() {
        let long = "é".repeat(100_000);
        let cut = drawn(&long);
        assert!(cut.chars().count() == LINE && cut.contains("é…é"), "{cut}");
        let [the, name, touches] = &lines(&format!("the {long} touches"), 10, 1e3)[..] else { panic!("three lines") };
        assert_eq!((&**the, name.chars().count(), &**touches), ("the", LINE, "touches"));
        assert_eq!(lines(&"a b ".repeat(100_000), 10, 1e9).concat().chars().count(), TEXT);
        assert_eq!(drawn(&long[..2 * LINE]), long[..2 * LINE]);
    }
}
