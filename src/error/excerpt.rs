//! The line that a refusal is about, with the place marked. A long line is cut to what is near the place.

use crate::error::Location;
use crate::error::visible::controls_terminal;
use std::ops::Range;

/// The greatest length of a line that is shown whole \[bytes\].
const WHOLE: usize = 160;
/// The number of characters of a longer line that are kept before the place.
const BEFORE: usize = 50;
/// The number of characters that are kept from the place on.
const AFTER: usize = 70;
/// The greatest length of a character in UTF-8 \[bytes\].
const WIDEST: usize = 4;
/// Replaces what was cut from a line.
const CUT: &str = "...";

/// A line, or the part of a long line that is near a place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    /// The line, with `...` where it is cut.
    pub text: String,
    /// The bytes of `text` with the word, string or tag at the place; empty at the line's end.
    pub mark: Range<usize>,
    /// Whether the line's beginning was cut.
    pub starts_later: bool,
}

impl Excerpt {
    /// Returns the line of `text` that contains `place`; `text` begins on line `first`. Bytes that are not UTF-8 and
    /// characters that a terminal would interpret are each replaced by one character. `None` if there is no such line,
    /// or if it is empty.
    pub fn around(text: &[u8], first: usize, place: Location) -> Option<Self> {
        let line = text.split(|&byte| byte == b'\n').nth(place.line.checked_sub(first)?)?;
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let line = line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line);
        if line.is_empty() {
            return None;
        }
        let ahead = place.column.saturating_sub(1);
        let kept = if line.len() <= WHOLE { 0..line.len() } else { near(line, ahead) };
        let left = line[..kept.start].iter().filter(|&&byte| begins(byte)).count();
        let shown = |letter: char| if letter != '\t' && controls_terminal(letter) { '\u{fffd}' } else { letter };
        let middle: String = String::from_utf8_lossy(&line[kept.clone()]).chars().map(shown).collect();
        let (before, after) = (if kept.start > 0 { CUT } else { "" }, if kept.end < line.len() { CUT } else { "" });
        let marked = token(&middle, ahead.saturating_sub(left));
        let mark = before.len() + marked.start..before.len() + marked.end;
        Some(Self { text: format!("{before}{middle}{after}"), mark, starts_later: kept.start > 0 })
    }
}

/// Returns whether the byte begins a character.
fn begins(byte: u8) -> bool {
    byte & 0xC0 != 0x80
}

/// Returns the range of bytes of `line` around the character that follows `ahead` others.
fn near(line: &[u8], ahead: usize) -> Range<usize> {
    let mut beginnings = (0..line.len()).filter(|&at| begins(line[at]));
    let start = match ahead.checked_sub(BEFORE) {
        Some(passed) => beginnings.nth(passed).unwrap_or(line.len().saturating_sub(WIDEST * BEFORE)),
        None => 0,
    };
    let end = (start..line.len()).filter(|&at| begins(line[at])).nth(BEFORE + AFTER).unwrap_or(line.len());
    start..end.min(start + WIDEST * (BEFORE + AFTER))
}

/// Returns the range of bytes of the word, string or tag that begins after `ahead` characters.
fn token(line: &str, ahead: usize) -> Range<usize> {
    let start = line.char_indices().nth(ahead).map_or(line.len(), |(offset, _)| offset);
    let rest = &line[start..];
    let length = match rest.chars().next() {
        Some('"') => closing_quote(rest),
        Some('<') => rest.find('>').map_or(rest.len(), |end| end + 1),
        Some(first) => {
            let ends = |c: char| c.is_whitespace() || ",:;[]{}\"<>".contains(c);
            rest.find(ends).unwrap_or(rest.len()).max(first.len_utf8())
        }
        None => 0,
    };
    start..start + length
}

/// Returns the length of the JSON string at the beginning of `text`.
fn closing_quote(text: &str) -> usize {
    let mut escaped = false;
    let end = text.char_indices().skip(1).find(|&(_, c)| {
        let closes = c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
        closes
    });
    end.map_or(text.len(), |(offset, _)| offset + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(text: &[u8], first: usize, line: usize, column: usize) -> Option<(String, String)> {
        let excerpt = Excerpt::around(text, first, Location { line, column })?;
        let marked = excerpt.text[excerpt.mark].to_owned();
        Some((excerpt.text, marked))
    }

    #[test]
    fn the_whole_word_is_marked() {
        let marked = |line: &str, column| around(line.as_bytes(), 1, 1, column).map(|(_, marked)| marked).unwrap();
        assert_eq!(marked(r#"{"é\"x": -1.5e3, "b": {}}"#, 2), r#""é\"x""#);
        assert_eq!(marked(r#"{"a": -1.5e3, "b": {}}"#, 7), "-1.5e3");
        assert_eq!(marked(r#"{"a": 1"#, 1), "{");
        assert_eq!(marked(r#"  <mass value="-1"/></inertial>"#, 3), r#"<mass value="-1"/>"#);
        assert_eq!(marked("k1,0.4,oops,1", 8), "oops");
        assert_eq!(marked(r#"{"a": "open"#, 7), r#""open"#);
        assert_eq!(marked("short", 99), "");
    }

    #[test]
    fn the_line_is_found_from_where_the_text_begins() {
        assert_eq!(around(b"a\r\n\"b\nc\",d\r\n", 7, 9, 4), Some(("c\",d".into(), "d".into())));
        assert_eq!(around(b"\xEF\xBB\xBFa,b", 1, 1, 3), Some(("a,b".into(), "b".into())));
        for (text, line) in [(&b""[..], 1), (b"a\n\n", 2), (b"a", 3), (b"a", 0)] {
            assert_eq!(around(text, 1, line, 1), None, "{text:?}");
        }
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        let pad = "é".repeat(500_000);
        let line = format!("{pad},oops,{pad}");
        let (text, marked) = around(line.as_bytes(), 1, 1, 500_002).unwrap();
        assert_eq!(marked, "oops");
        assert_eq!(text.chars().count(), 3 + BEFORE + AFTER + 3);
        assert!(text.starts_with("...é") && text.ends_with("é..."), "{text}");
        let (text, marked) = around(line.as_bytes(), 1, 1, 1).unwrap();
        assert!(text.starts_with('é') && text.ends_with("é..."), "{text}");
        assert!(text.contains(&marked));
        for hostile in [vec![0x80; 1_000_000], vec![0xFF; 1_000_000], b"x".repeat(1_000_000)] {
            for column in [1, 60, 1_000_000, 2_000_000] {
                let (text, _) = around(&hostile, 1, 1, column).unwrap();
                assert!(text.chars().count() <= WIDEST * (BEFORE + AFTER) + 6, "{}", text.len());
            }
        }
    }
}
