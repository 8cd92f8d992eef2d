//! The one font of all pictures, embedded so that they are the same everywhere.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

/// DejaVu Sans, whole: it has Greek letters and arrows.
pub(super) const BYTES: &[u8] = include_bytes!("DejaVuSans.ttf");
/// What an SVG asks for.
pub(super) const FAMILY: &str = "DejaVu Sans, sans-serif";
/// Its name alone.
pub(super) const NAME: &str = "DejaVu Sans";

/// The share of a font's size that capitals rise above the baseline.
pub(super) const CAPITAL: f64 = 0.73;

/// How wide a line of text is \[px\].
pub(super) fn width(text: &str, size: u32) -> f64 {
    // The font is a part of the program; were it broken, texts would only stand too close.
    let Ok(font) = FontRef::new(BYTES) else { return 0.0 };
    let (letters, metrics) = (font.charmap(), font.glyph_metrics(Size::new(size as f32), LocationRef::default()));
    let advance = |letter| letters.map(letter).and_then(|glyph| metrics.advance_width(glyph));
    text.chars().map(|letter| f64::from(advance(letter).unwrap_or(size as f32))).sum()
}

/// The text in lines of at most `room` \[px\], broken at spaces; a longer word keeps its own line.
pub(super) fn lines(text: &str, size: u32, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split(' ') {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if line.is_empty() || width(&longer, size) <= room {
                line = longer;
            } else {
                lines.push(std::mem::replace(&mut line, word.to_owned()));
            }
        }
        lines.push(line);
    }
    lines
}

/// The text without what XML cannot hold.
pub(super) fn printable(text: &str) -> String {
    text.chars().filter(|letter| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_add_up_and_grow_with_the_size() {
        assert!(width("WW", 12) > width("ii", 12));
        assert!((width("ab", 10) - width("a", 10) - width("b", 10)).abs() < 1e-4);
        assert!((width("α", 20) - 2.0 * width("α", 10)).abs() < 1e-4);
        assert!(width("α", 10) < 10.0, "it has Greek letters");
    }

    #[test]
    fn lines_are_broken_where_they_are_too_long() {
        assert_eq!(lines("one two three\nfour", 10, width("one two", 10)), ["one two", "three", "four"]);
        assert_eq!(lines("unbreakable", 10, 1.0), ["unbreakable"]);
    }
}
