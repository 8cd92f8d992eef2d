//! Finds the ends of fields and records in the bytes of a table, by the rules of the csv crate. Also finds misplaced
//! quotes, which the crate accepts and by which it would join several rows.
//!
//! ```text
//! Start --"--> Quoted --"--> Closing --"--> Quoted (a doubled quote stands for one)
//!       └--any other--> Plain      └--blank--> Closed --any other--> Misplaced
//! ```

use super::flat;
use crate::read::json::line_and_column;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// How the records of a table are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Form {
    /// One JSON object per line; as a table, its keys are the names of the columns.
    #[cfg_attr(feature = "cli", value(alias = "json", alias = "jsonl", help = "One JSON object per line"))]
    Ndjson,
    /// A table with a header and commas between columns.
    #[default]
    Csv,
    /// A table with a header and tabs between columns.
    Tsv,
    /// A Parquet file (feature `columnar`, as those below).
    #[cfg_attr(feature = "cli", value(help = "A Parquet file"))]
    Parquet,
    /// An Arrow IPC file, as Feather; read also as a stream.
    #[cfg_attr(feature = "cli", value(alias = "feather", alias = "ipc"))]
    Arrow,
    /// An Arrow IPC stream.
    Arrows,
}

/// The content of a cell.
pub(super) enum Cell<'r> {
    Empty,
    Text(Cow<'r, str>),
    Number(f64),
}

/// The bytes of a record, and the form in which it is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<'r> {
    pub bytes: &'r [u8],
    pub form: Form,
}

/// Tracks quotes through the bytes of a table, because a line break inside them does not end a record.
#[derive(Debug, Clone, Copy)]
pub struct Quotes {
    inside: Inside,
    delimiter: u8,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Inside {
    /// At the start of a field.
    #[default]
    Start,
    /// In a field without quotes, where a quote is an ordinary character.
    Plain,
    /// After an opening quote.
    Quoted,
    /// After a quote that closes the field unless another quote follows.
    Closing,
    /// After a closed field, before the next delimiter.
    Closed,
    /// After text that follows a closing quote.
    Misplaced,
}

/// The state of the quotes at the end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quoting {
    /// The record ends here.
    Closed,
    /// A quote is open.
    Open,
    /// Text follows a closing quote, and nothing shows where the record ends.
    Misplaced,
}

impl Form {
    /// Returns whether the form is text; all others have typed columns.
    pub fn is_text(self) -> bool {
        matches!(self, Self::Ndjson | Self::Csv | Self::Tsv)
    }

    /// Returns what separates the fields of a record of text.
    pub fn delimiter(self) -> u8 {
        if self == Self::Tsv { b'\t' } else { b',' }
    }

    /// Creates a reader of records, which may have different numbers of fields.
    pub(super) fn csv(self) -> csv::ReaderBuilder {
        let mut builder = csv::ReaderBuilder::new();
        builder.has_headers(false).flexible(true).delimiter(self.delimiter());
        builder
    }

    /// Returns the state of quotes at the beginning of a table.
    pub fn quotes(self) -> Quotes {
        Quotes { inside: Inside::Start, delimiter: self.delimiter() }
    }
}

impl Quotes {
    /// Returns the state of quotes at the beginning of a record of the same table.
    pub fn fresh(self) -> Self {
        Self { inside: Inside::Start, ..self }
    }

    /// Returns whether a line of this byte alone is no record: a tab may separate empty fields.
    pub fn is_blank(self, byte: u8) -> bool {
        byte.is_ascii_whitespace() && byte != self.delimiter
    }

    /// Consumes `line`, the next line of the table with its line break, and returns how the quotes stand at its end.
    pub fn after(&mut self, line: &[u8]) -> Quoting {
        // Most tables have no quotes at all.
        if self.inside != Inside::Quoted && !line.contains(&b'"') {
            self.inside = Inside::Start;
            return Quoting::Closed;
        }
        for &byte in line {
            self.step(byte);
        }
        let quoting = match self.inside {
            Inside::Quoted => return Quoting::Open,
            Inside::Misplaced => Quoting::Misplaced,
            _ => Quoting::Closed,
        };
        self.inside = Inside::Start;
        quoting
    }

    /// Consumes one byte; returns whether it separates two fields.
    fn step(&mut self, byte: u8) -> bool {
        let open = matches!(self.inside, Inside::Quoted | Inside::Misplaced);
        self.inside = match (self.inside, byte) {
            (Inside::Start | Inside::Closing, b'"') => Inside::Quoted,
            (Inside::Quoted, b'"') => Inside::Closing,
            (Inside::Quoted | Inside::Misplaced, _) => self.inside,
            (_, b'\r' | b'\n') => Inside::Start,
            (_, byte) if byte == self.delimiter => Inside::Start,
            (Inside::Closing | Inside::Closed, b' ' | b'\t') => Inside::Closed,
            (Inside::Closing | Inside::Closed, _) => Inside::Misplaced,
            _ => Inside::Plain,
        };
        !open && byte == self.delimiter
    }

    /// Returns whether the quotes of a record with several lines contain other rows: the record has not `columns`
    /// fields, as the header has, or each of its lines would have.
    pub(crate) fn enclose_rows(self, record: &[u8], columns: usize) -> bool {
        /// With fewer columns, text in quotes may have the right number of delimiters by chance.
        const FEWEST: usize = 3;
        let fields = |bytes: &[u8]| {
            let mut quotes = self.fresh();
            1 + bytes.iter().filter(|&&byte| quotes.step(byte)).count()
        };
        // The fields of a line, and the delimiters that would separate further ones if its last open quote were none.
        let without_quote = |line: &[u8]| {
            let mut quotes = self.fresh();
            line.iter().fold((1, 0), |(fields, open), &byte| match quotes.step(byte) {
                true => (fields + 1, 0),
                false => (fields, open + usize::from(byte == self.delimiter)),
            })
        };
        let mut lines = record.split(|&byte| byte == b'\n');
        let (closed, open) = lines.next().map_or((0, 0), without_quote);
        let mut further = lines.filter(|line| !line.trim_ascii().is_empty());
        fields(record) != columns
            || columns >= FEWEST && closed + open == columns && further.all(|line| fields(line) == columns)
    }
}

impl Record<'_> {
    /// Returns the index of a field with misplaced quotes, and what is wrong with them; `None` if there is none.
    pub fn quoting_fault(self) -> Option<(usize, &'static str)> {
        if self.form == Form::Ndjson || !self.bytes.contains(&b'"') {
            return None;
        }
        let (mut quotes, mut field) = (self.form.quotes(), 0);
        for &byte in self.bytes {
            field += usize::from(quotes.step(byte));
            if quotes.inside == Inside::Misplaced {
                return Some((field, "text follows a closing quote"));
            }
        }
        (quotes.inside == Inside::Quoted).then_some((field, "a quote is not closed"))
    }

    /// Returns where this field begins: the number of lines above, and the column in characters from 1.
    pub fn place_of(self, index: usize, name: &str) -> (usize, usize) {
        if self.form == Form::Ndjson {
            return (0, flat::column_of(self.bytes, name, false));
        }
        let (mut quotes, mut field) = (self.form.quotes(), 0);
        let is_before = |&&byte: &&u8| {
            let is_before = field < index;
            field += usize::from(quotes.step(byte));
            is_before
        };
        let start = self.bytes.iter().take_while(is_before).count();
        let (line, column) = line_and_column(self.bytes, start);
        (line - 1, column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_quotes_ends_no_record() {
        use Quoting::{Closed, Misplaced, Open};
        let after = |lines: &[&str]| {
            let mut quotes = Form::Csv.quotes();
            lines.iter().map(|line| quotes.after(line.as_bytes())).collect::<Vec<_>>()
        };
        assert_eq!(after(&["a,b\n", "\"a\n", "b\",c\n", "d\n"]), [Closed, Open, Closed, Closed]);
        assert_eq!(after(&["\"say \"\"hi\"\"\"\r\n", "\"\"\"\n", "\"\n"]), [Closed, Open, Closed]);
        // A quote inside a plain field is an ordinary character; blanks may follow a closing quote.
        assert_eq!(after(&["5\" pipe,1\n", "\"a\" ,\"b\"\t\n", "2\n"]), [Closed; 3]);
        assert_eq!(
            after(&["\"a\"b,\"c\n", "\"a\n", "b,\"c\"\n", "\"d\" \"e\"\n"]),
            [Misplaced, Open, Misplaced, Misplaced]
        );
    }
}
