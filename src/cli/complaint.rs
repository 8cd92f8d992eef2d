//! Errors on standard error, coloured where a person looks.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet, normalize_untrusted_str};
use heelstrike::Error;
use heelstrike::error::Location;
use std::io::Write;
use std::ops::Range;

/// The longest line that is shown \[bytes\]; of a long one only what is near the place.
const LONGEST_LINE: usize = 1 << 21;

/// Writes `error: file:line:column: place: reason` and, where there is a remedy, `hint: remedy`.
pub(super) fn complain(error: &Error) {
    write(&[Group::with_title(Level::ERROR.primary_title(error.to_string()))]);
    if let Some(remedy) = error.remedy() {
        write(&[hint(remedy)]);
    }
}

/// Writes the reason, the line of `text` that it is about with the place marked, and the remedy.
///
/// `text` is the whole text of the error's file. Without a line and column in it this is [`complain`].
pub(super) fn complain_within(error: &Error, text: &str) {
    let Some((location, line)) = error.location().and_then(|location| Some((location, shown_line(text, location)?)))
    else {
        return complain(error);
    };
    let mut mark = AnnotationKind::Primary.span(token(line, location.column));
    if let Some(place) = error.place() {
        mark = mark.label(normalize_untrusted_str(place));
    }
    let file = error.file().map(normalize_untrusted_str);
    let snippet = Snippet::source(line).line_start(location.line).path(file).annotation(mark);
    let mut report = vec![Level::ERROR.primary_title(error.reason().to_string()).element(snippet)];
    report.extend(error.remedy().map(hint));
    write(&report);
}

/// Writes `note: ` and the text.
pub(super) fn note(text: &str) {
    write(&[Group::with_title(Level::NOTE.primary_title(text))]);
}

fn hint(remedy: &str) -> Group<'_> {
    Group::with_title(Level::HELP.with_name("hint").secondary_title(normalize_untrusted_str(remedy)))
}

fn write(report: &[Group<'_>]) {
    let told = Renderer::styled().render(report);
    // anstream takes the colours out where nobody wants them; where nobody reads standard error there is nobody to tell
    // that it cannot be written.
    let _ = writeln!(anstream::stderr().lock(), "{told}");
}

/// The line of the place, if the text has it and it can be shown.
fn shown_line(text: &str, location: Location) -> Option<&str> {
    let line = text.lines().nth(location.line.checked_sub(1)?)?;
    (line.len() <= LONGEST_LINE && !line.is_empty()).then_some(line)
}

/// The bytes of the word, string or tag that begins at the character `column`, counted from 1.
fn token(line: &str, column: usize) -> Range<usize> {
    let start = line.char_indices().nth(column.saturating_sub(1)).map_or(line.len(), |(offset, _)| offset);
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

/// The length of the JSON string at the beginning of `text`.
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

    #[test]
    fn the_whole_word_is_marked() {
        let marked = |line: &'static str, column| &line[token(line, column)];
        assert_eq!(marked(r#"{"é\"x": -1.5e3, "b": {}}"#, 2), r#""é\"x""#);
        assert_eq!(marked(r#"{"a": -1.5e3, "b": {}}"#, 7), "-1.5e3");
        assert_eq!(marked(r#"{"a": 1"#, 1), "{");
        assert_eq!(marked(r#"  <mass value="-1"/></inertial>"#, 3), r#"<mass value="-1"/>"#);
        assert_eq!(marked("k1,0.4,oops,1", 8), "oops");
        assert_eq!(marked(r#"{"a": "open"#, 7), r#""open"#);
        assert_eq!(marked("short", 99), "");
    }
}
