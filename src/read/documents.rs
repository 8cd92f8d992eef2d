//! Splits a text into JSON objects: one object, several in a row, or a list of them.

use crate::error::Location;
use crate::read::json::line_and_column;
use crate::{Error, Reason, Result};
use serde::de::IgnoredAny;

/// One object of a text that may hold several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Document<'t> {
    /// The object's text, even if it is malformed.
    pub text: &'t str,
    /// The line on which it begins, from 1.
    pub line: usize,
    /// The column of that line in which it begins, from 1.
    pub column: usize,
}

impl Document<'_> {
    /// Moves an error of this document to its place in the whole text.
    pub fn locate(&self, error: Error) -> Error {
        match error.location() {
            Some(Location { line: 1, column }) => error.on(self.line, self.column + column - 1),
            Some(Location { line, column }) => error.on(self.line + line - 1, column),
            None => error.on(self.line, self.column),
        }
    }
}

/// Returns the objects of `text` in order: one, several with or without line breaks between them, or a list. A
/// malformed object extends to the next line that begins with `{`, where the next object is assumed to begin.
pub fn documents(text: &str) -> impl Iterator<Item = Document<'_>> {
    let start = text.len() - text.trim_start().len();
    let within = if text[start..].starts_with('[') { Within::FreshList } else { Within::Stream };
    let at = start + usize::from(within != Within::Stream);
    Documents { text, at, within, counted: 0, line: 1, column: 1 }
}

const UTF_16: &str = "save it as UTF-8, or turn it by iconv -f UTF-16 -t UTF-8";

/// First bytes of other formats, each with the reason and the hint of its refusal.
const FOREIGN: [(&[u8], &str, &str); 10] = [
    (b"\xFF\xFE", "the text is UTF-16", UTF_16),
    (b"\xFE\xFF", "the text is UTF-16", UTF_16),
    (b"\x1F\x8B", "the input is packed by gzip", "unpack it: gunzip -c FILE | heelstrike ... with - for FILE"),
    (b"\x28\xB5\x2F\xFD", "the input is packed by zstd", "unpack it: zstdcat FILE | heelstrike ... with - for FILE"),
    (b"\xFD7zXZ\0", "the input is packed by xz", "unpack it: xzcat FILE | heelstrike ... with - for FILE"),
    (b"BZh", "the input is packed by bzip2", "unpack it: bzcat FILE | heelstrike ... with - for FILE"),
    (b"PK\x03\x04", "the input is a zip archive, as spreadsheets are", "unpack it, or save the sheet as CSV"),
    (b"PAR1", "the input is a Parquet file", "`heelstrike batch` reads it under a name that ends in .parquet"),
    (b"ARROW1", "the input is an Arrow file", "`heelstrike batch` reads it under a name that ends in .arrow"),
    (
        b"\xFF\xFF\xFF\xFF",
        "the input is an Arrow stream",
        "`heelstrike batch` reads it under a name that ends in .arrows",
    ),
];

/// Refuses an input whose first bytes show that it is not plain UTF-8 text, but compressed or a spreadsheet, say.
pub(crate) fn refuse_foreign(beginning: &[u8]) -> Result<()> {
    let known = FOREIGN.iter().find(|(magic, ..)| beginning.starts_with(magic));
    let (what, remedy) = match (known, beginning) {
        (Some(&(_, what, remedy)), _) => (what, remedy),
        // In UTF-16 without a byte order mark every second byte is zero, if the text begins with ASCII.
        (None, [0, 1..=u8::MAX, 0, ..] | [1..=u8::MAX, 0, 1..=u8::MAX, ..]) => ("the text is UTF-16", UTF_16),
        _ => return Ok(()),
    };
    Err(Error::new(Reason::Unsupported(what.into())).hint(remedy))
}

/// Returns the bytes as text without a byte order mark; an error has the location of the first byte that is not UTF-8.
pub fn utf8(bytes: &[u8]) -> Result<&str> {
    refuse_foreign(bytes)?;
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(broken) => {
            let valid = String::from_utf8_lossy(&bytes[..broken.valid_up_to()]);
            let (line, column) = line_and_column(valid.as_bytes(), valid.len());
            Err(Error::new(Reason::Syntax("the text is not UTF-8".into()))
                .hint("save it as UTF-8; iconv -f LATIN1 -t UTF-8 converts what older editors wrote")
                .on(line, column))
        }
    }
}

/// What the next object is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Within {
    Stream,
    /// A list before its first entry.
    FreshList,
    List,
}

struct Documents<'t> {
    text: &'t str,
    at: usize,
    within: Within,
    /// The byte whose location is `line` and `column`.
    counted: usize,
    line: usize,
    column: usize,
}

impl<'t> Iterator for Documents<'t> {
    type Item = Document<'t>;

    fn next(&mut self) -> Option<Document<'t>> {
        self.skip_blanks();
        if self.within != Within::Stream && self.text[self.at..].starts_with(']') {
            self.at += 1;
            self.within = Within::Stream;
            self.skip_blanks();
        }
        match self.within {
            Within::List if self.text[self.at..].starts_with(',') => {
                self.at += 1;
                self.skip_blanks();
            }
            // Neither a comma nor the end of the list follows: the rest cannot be split.
            Within::List => {
                self.within = Within::Stream;
                return Some(self.take(self.text.len()));
            }
            Within::FreshList => self.within = Within::List,
            Within::Stream if self.at == self.text.len() => return None,
            Within::Stream => {}
        }
        let rest = &self.text[self.at..];
        let mut values = serde_json::Deserializer::from_str(rest).into_iter::<IgnoredAny>();
        let length = match values.next() {
            Some(Ok(_)) => values.byte_offset(),
            _ if self.within == Within::Stream => rest.find("\n{").map_or(rest.len(), |newline| newline + 1),
            _ => {
                self.within = Within::Stream;
                rest.len()
            }
        };
        Some(self.take(self.at + length))
    }
}

impl<'t> Documents<'t> {
    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.text[self.at..].trim_start().len();
    }

    fn take(&mut self, end: usize) -> Document<'t> {
        // Counting continues from the last document, so that many documents on one line take linear time.
        let (lines, column) = line_and_column(&self.text.as_bytes()[self.counted..], self.at - self.counted);
        self.line += lines - 1;
        self.column = if lines == 1 { self.column + column - 1 } else { column };
        self.counted = self.at;
        let text = &self.text[self.at..end];
        self.at = end;
        Document { text, line: self.line, column: self.column }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texts with their lines and columns.
    type Places = &'static [(&'static str, usize, usize)];

    #[test]
    fn a_text_is_split_into_its_objects() {
        let cases: [(&str, Places); 10] = [
            (" {} {\n}\n\n{}\n", &[("{}", 1, 2), ("{\n}", 1, 5), ("{}", 4, 1)]),
            ("  \n", &[]),
            ("[\n{\"a\": 1},\n {}]\n", &[("{\"a\": 1}", 2, 1), ("{}", 3, 2)]),
            ("[]", &[]),
            // A broken list ends with a broken entry.
            ("[{} {}]", &[("{}", 1, 2), ("{}]", 1, 5)]),
            ("[{},", &[("{}", 1, 2), ("", 1, 5)]),
            ("[{}", &[("{}", 1, 2), ("", 1, 4)]),
            ("[", &[("", 1, 2)]),
            // After a broken object the next line is tried.
            ("{\"a\":\n{\"b\": 1}\n", &[("{\"a\":\n", 1, 1), ("{\"b\": 1}", 2, 1)]),
            ("{\"a\" 1}\n{}\n", &[("{\"a\" 1}\n", 1, 1), ("{}", 2, 1)]),
        ];
        for (text, expected) in cases {
            let parts: Vec<_> = documents(text).map(|part| (part.text, part.line, part.column)).collect();
            assert_eq!(parts, expected, "{text}");
        }
    }
}
