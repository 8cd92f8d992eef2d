//! Finds the ends of fields and records in the bytes of a table, by the rules of the csv crate, and the quotes that it
//! would take for characters: rows would be lost between them.
//!
//! ```text
//!     Start --"--> Quoted --"--> Closing --"--> Quoted (two quotes are one)
//!       └--any other--> Plain      └--blank--> Closed --any other--> Misplaced
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
    /// Behind the closed field, before the next comma.
    Closed,
    /// Behind text that follows a closing quote.
    Misplaced,
}

/// How the quotes stand at the end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quoting {
    /// The record ends here.
    Closed,
    /// A quote is open.
    Open,
    /// Text follows a closing quote, and nothing shows where the record ends.
    Misplaced,
}

impl Quotes {
    /// Consumes `line`, the next line of the table together with its line break.
    pub fn after(&mut self, line: &[u8]) -> Quoting {
        // Most tables have no quotes at all.
        if self.0 != Inside::Quoted && !line.contains(&b'"') {
            self.0 = Inside::Start;
            return Quoting::Closed;
        }
        for &byte in line {
            self.step(byte);
        }
        let quoting = match self.0 {
            Inside::Quoted => return Quoting::Open,
            Inside::Misplaced => Quoting::Misplaced,
            _ => Quoting::Closed,
        };
        self.0 = Inside::Start;
        quoting
    }

    /// Consumes one byte; true if it separates two fields.
    fn step(&mut self, byte: u8) -> bool {
        let open = matches!(self.0, Inside::Quoted | Inside::Misplaced);
        self.0 = match (self.0, byte) {
            (Inside::Start | Inside::Closing, b'"') => Inside::Quoted,
            (Inside::Quoted, b'"') => Inside::Closing,
            (Inside::Quoted | Inside::Misplaced, _) => self.0,
            (_, b',' | b'\r' | b'\n') => Inside::Start,
            (Inside::Closing | Inside::Closed, b' ' | b'\t') => Inside::Closed,
            (Inside::Closing | Inside::Closed, _) => Inside::Misplaced,
            _ => Inside::Plain,
        };
        !open && byte == b','
    }
}

/// Whether the quotes of a record of several lines hold other rows: it has not as many fields as the header has
/// `columns`, or each of its further lines would have.
pub(crate) fn swallows_rows(record: &[u8], columns: usize) -> bool {
    /// Text in quotes may have a comma by chance.
    const FEWEST: usize = 3;
    let fields = |bytes: &[u8]| {
        let mut quotes = Quotes::default();
        1 + bytes.iter().filter(|&&byte| quotes.step(byte)).count()
    };
    let lines = record.split(|&byte| byte == b'\n').skip(1);
    let mut further = lines.filter(|line| !line.trim_ascii().is_empty());
    fields(record) != columns || columns >= FEWEST && further.all(|line| fields(line) == columns)
}

/// What is wrong with the quotes of a record, and in which field.
pub(super) fn quoting_fault(record: &[u8]) -> Option<(usize, &'static str)> {
    if !record.contains(&b'"') {
        return None;
    }
    let (mut quotes, mut field) = (Quotes::default(), 0);
    for &byte in record {
        field += usize::from(quotes.step(byte));
        if quotes.0 == Inside::Misplaced {
            return Some((field, "text follows a closing quote"));
        }
    }
    (quotes.0 == Inside::Quoted).then_some((field, "a quote is not closed"))
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
        use Quoting::{Closed, Misplaced, Open};
        let after = |lines: &[&str]| {
            let mut quotes = Quotes::default();
            lines.iter().map(|line| quotes.after(line.as_bytes())).collect::<Vec<_>>()
        };
        assert_eq!(after(&["a,b\n", "\"a\n", "b\",c\n", "d\n"]), [Closed, Open, Closed, Closed]);
        assert_eq!(after(&["\"say \"\"hi\"\"\"\r\n", "\"\"\"\n", "\"\n"]), [Closed, Open, Closed]);
        // A quote inside a plain field is a character; blanks may follow a closing one.
        assert_eq!(after(&["5\" pipe,1\n", "\"a\" ,\"b\"\t\n", "2\n"]), [Closed; 3]);
        assert_eq!(
            after(&["\"a\"b,\"c\n", "\"a\n", "b,\"c\"\n", "\"d\" \"e\"\n"]),
            [Misplaced, Open, Misplaced, Misplaced]
        );
    }

    #[test]
    fn a_quoting_fault_is_found_with_its_field() {
        assert_eq!(quoting_fault(b"a,\"b\"\"\",\"c\" \n"), None);
        assert_eq!(quoting_fault(b"\"a,b\",\"c\"d,\"e"), Some((1, "text follows a closing quote")));
        assert_eq!(quoting_fault(b"a,\"b,c\n"), Some((1, "a quote is not closed")));
    }

    #[test]
    fn fields_are_found_behind_wide_characters() {
        assert_eq!(place_of(b"a,bc,d", 2), (0, 6));
        assert_eq!(place_of(b"\"a,\"\"b\",c", 1), (0, 9));
        assert_eq!(place_of("\u{e9}\u{e9},c".as_bytes(), 1), (0, 4));
        assert_eq!(place_of(b"\"a\nbc\",d", 1), (1, 5));
    }
}
