//! Finds the ends of fields and records in the bytes of a table, by the rules of the csv crate.
//!
//! ```text
//!     Start --"--> Quoted --"--> Closing --"--> Quoted (two quotes are one)
//!       └--any other--> Plain      └--any other--> Plain
//! ```

/// Tracks quotes through the bytes of a table, because a line break inside them does not end a record.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quotes(Inside);

#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Inside {
    /// At the start of a field.
    #[default]
    Start,
    /// In a field without quotes, where a quote is a character like others.
    Plain,
    /// Behind an opening quote.
    Quoted,
    /// Behind a quote that closes the field unless another follows.
    Closing,
}

impl Quotes {
    /// Whether a record ends with `line`, the next line of the table together with its line break.
    pub fn closed_after(&mut self, line: &[u8]) -> bool {
        // Most tables have no quotes at all.
        if self.0 != Inside::Quoted && !line.contains(&b'"') {
            self.0 = Inside::Start;
            return true;
        }
        for &byte in line {
            self.step(byte);
        }
        let closed = self.0 != Inside::Quoted;
        if closed {
            self.0 = Inside::Start;
        }
        closed
    }

    /// Consumes one byte; true if it separates two fields.
    fn step(&mut self, byte: u8) -> bool {
        let open = self.0 != Inside::Quoted;
        self.0 = match (self.0, byte) {
            (Inside::Start | Inside::Closing, b'"') => Inside::Quoted,
            (Inside::Quoted, b'"') => Inside::Closing,
            (Inside::Quoted, _) => Inside::Quoted,
            (_, b',' | b'\r' | b'\n') => Inside::Start,
            _ => Inside::Plain,
        };
        open && byte == b','
    }
}

/// Lines above, and the column counted from 1 in characters, at which field `index` of a record begins.
pub(super) fn place_of(record: &[u8], index: usize) -> (usize, usize) {
    let mut quotes = Quotes::default();
    let (mut field, mut lines, mut column) = (0, 0, 1);
    for &byte in record {
        if field == index {
            break;
        }
        field += usize::from(quotes.step(byte));
        if byte == b'\n' {
            (lines, column) = (lines + 1, 1);
        } else {
            // Bytes that continue a character do not count.
            column += usize::from(byte & 0xC0 != 0x80);
        }
    }
    (lines, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_quotes_ends_no_record() {
        let closed = |lines: &[&str]| {
            let mut quotes = Quotes::default();
            lines.iter().map(|line| quotes.closed_after(line.as_bytes())).collect::<Vec<_>>()
        };
        assert_eq!(closed(&["a,b\n", "\"a\n", "b\",c\n", "d\n"]), [true, false, true, true]);
        assert_eq!(closed(&["\"say \"\"hi\"\"\"\r\n", "\"\"\"\n", "\"\n"]), [true, false, true]);
        // A quote inside a plain field is a character.
        assert_eq!(closed(&["5\" pipe,1\n", "2\n"]), [true, true]);
    }

    #[test]
    fn fields_are_found_behind_quotes_and_wide_characters() {
        assert_eq!(place_of(b"a,bc,d", 2), (0, 6));
        assert_eq!(place_of(b"\"a,\"\"b\",c", 1), (0, 9));
        assert_eq!(place_of("\u{e9}\u{e9},c".as_bytes(), 1), (0, 4));
        assert_eq!(place_of(b"\"a\nbc\",d", 1), (1, 5));
    }
}
