//! Rows of results as text, for CSV and TSV.

use super::csv::{Cell, Columns, Row, RowSink};
use std::ops::Range;

/// A row of text that is being filled.
pub struct TextRow {
    guarded: bool,
    /// The text of all cells, in the order in which they were set.
    text: Vec<u8>,
    /// For each column, the range of its text.
    cells: Vec<Range<usize>>,
}

impl Row for TextRow {
    fn set(&mut self, at: usize, cell: Cell<'_>) {
        let start = self.text.len();
        let mut guarded = |bytes: &[u8]| {
            let quote = self.guarded && is_formula(bytes);
            self.text.extend(b"'".iter().filter(|_| quote).chain(bytes));
        };
        match cell {
            Cell::Text(text) => guarded(text.as_bytes()),
            Cell::Number(number) => append_number(number, &mut self.text),
            Cell::Integer(number) => guarded(number.to_string().as_bytes()),
            Cell::Boolean(holds) => guarded(holds.to_string().as_bytes()),
            Cell::Carried(carried, which) => guarded(&carried.text(which)),
        }
        self.cells[at] = start..self.text.len();
    }
}

impl RowSink for Vec<u8> {
    type Row = TextRow;

    fn row(&mut self, columns: &Columns, fill: impl FnOnce(&mut TextRow)) {
        let cells = vec![0..0; columns.names().len()];
        let mut row = TextRow { guarded: columns.layout.guarded, text: Vec::new(), cells };
        fill(&mut row);
        let mut writer = csv::WriterBuilder::new();
        let mut writer = writer.delimiter(columns.form().delimiter()).buffer_capacity(1 << 10).from_writer(self);
        // Writing into memory cannot fail.
        let _ = writer.write_record(row.cells.into_iter().map(|cell| &row.text[cell]));
    }
}

/// Appends the shortest digits that read back as the same number, as JSON does.
fn append_number(number: f64, out: &mut Vec<u8>) {
    if number.is_finite() {
        // Writing into memory cannot fail.
        let _ = serde_json::to_writer(out, &number);
    } else {
        out.extend(number.to_string().into_bytes());
    }
}

/// Returns the text of [`append_number`].
pub(super) fn number_text(number: f64) -> String {
    let mut digits = Vec::new();
    append_number(number, &mut digits);
    String::from_utf8_lossy(&digits).into_owned()
}

/// Returns whether a spreadsheet would read the text of a cell as a formula.
fn is_formula(text: &[u8]) -> bool {
    let is_number = || std::str::from_utf8(text).is_ok_and(|text| text.parse::<f64>().is_ok());
    matches!(text.first(), Some(b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r')) && !is_number()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_notation_of_json() {
        for (number, text) in [
            (5e-5, "0.00005"),
            (5.46e16, "5.46e+16"),
            (1.0, "1.0"),
            (-0.0, "-0.0"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(number_text(number), text);
        }
    }
}
