//! Tables for people: text is aligned to the left, and numbers are aligned by their decimal points.

use crate::error::visible;
use crate::planar::Pair;
use std::fmt::Write;

type OptionalPair = Option<Pair<f64>>;

/// Columns of equal length, each with a head.
#[derive(Debug, Default)]
pub(crate) struct Table {
    columns: Vec<Column>,
}

#[derive(Debug)]
struct Column {
    /// The head, then the cells.
    cells: Vec<String>,
    to_the_right: bool,
}

impl Table {
    /// Adds a column of text, all of which is made [`visible`].
    pub(crate) fn text<C: Into<String>>(mut self, head: &str, cells: impl IntoIterator<Item = C>) -> Self {
        let cells = std::iter::once(head.to_owned()).chain(cells.into_iter().map(Into::into));
        let cells = cells.map(|cell| visible(&cell).into_owned()).collect();
        self.columns.push(Column { cells, to_the_right: false });
        self
    }

    /// Adds a column of numbers with the decimals that give its largest number six digits. `-` stands for a missing
    /// number, and `~0` for a rounding residue of zero next to numbers of magnitude `scale`.
    pub(crate) fn numbers(self, head: &str, scale: f64, numbers: impl IntoIterator<Item: Into<Option<f64>>>) -> Self {
        let numbers: Vec<Option<f64>> = numbers.into_iter().map(Into::into).collect();
        let largest = self::scale(numbers.iter().flatten().copied().filter(|&number| !is_residue(number, scale)));
        self.column(head, scale, largest, numbers)
    }

    /// Adds a column for each of the two entries of pairs.
    pub(crate) fn pairs(
        self,
        heads: [&str; 2],
        scale: f64,
        pairs: impl IntoIterator<Item: Into<OptionalPair>>,
    ) -> Self {
        let pairs: Vec<OptionalPair> = pairs.into_iter().map(Into::into).collect();
        let entries = |axis: usize| pairs.iter().map(move |pair| pair.map(|pair| pair[axis]));
        self.numbers(heads[0], scale, entries(0)).numbers(heads[1], scale, entries(1))
    }

    /// Creates a table of numbers with the same decimals in all columns, without heads.
    pub(crate) fn matrix(rows: &[Vec<f64>]) -> Self {
        let largest = scale(rows.iter().flatten().copied());
        let columns = 0..rows.first().map_or(0, Vec::len);
        columns.fold(Self::default(), |table, column| {
            let entries = rows.iter().map(|row| row.get(column).copied()).collect();
            table.column("", largest, largest, entries)
        })
    }

    fn column(mut self, head: &str, scale: f64, largest: f64, numbers: Vec<Option<f64>>) -> Self {
        let cell = |number: &Option<f64>| match *number {
            None => "-".to_owned(),
            Some(number) if is_residue(number, scale) => "~0".to_owned(),
            Some(number) => within(number, largest),
        };
        let cells = std::iter::once(head.to_owned()).chain(numbers.iter().map(cell)).collect();
        self.columns.push(Column { cells, to_the_right: true });
        self
    }

    /// Writes the table, indented and without blanks at the ends of lines. Heads are left out if all are empty.
    pub(crate) fn write(&self, out: &mut String) {
        let first = usize::from(self.columns.iter().all(|column| column.cells[0].is_empty()));
        let rows = self.columns.iter().map(|column| column.cells.len()).max().unwrap_or(0);
        let width = |column: &Column| column.cells.iter().map(|cell| cell.chars().count()).max();
        let widths: Vec<usize> = self.columns.iter().filter_map(width).collect();
        for row in first..rows {
            let mut line = String::new();
            for (column, &width) in self.columns.iter().zip(&widths) {
                let cell = column.cells.get(row).map_or("", String::as_str);
                let blanks = " ".repeat(width - cell.chars().count());
                let (before, after) = if column.to_the_right { (blanks.as_str(), "") } else { ("", blanks.as_str()) };
                line.extend(["  ", before, cell, after]);
            }
            // Writing into a string cannot fail.
            let _ = writeln!(out, "{}", line.trim_end());
        }
    }
}

/// Returns the largest magnitude.
pub(crate) fn scale(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |largest, number| largest.max(number.abs()))
}

/// Returns whether `value` is a rounding residue of zero, next to numbers of magnitude `scale`.
pub(crate) fn is_residue(value: f64, scale: f64) -> bool {
    value != 0.0 && value.abs() < 1e-13 * scale
}

/// Formats a single number with six digits, or four and an exponent, without trailing zeros.
pub(crate) fn number(value: f64) -> String {
    let text = within(value, value.abs());
    match text.split_once('e') {
        Some((digits, exponent)) => format!("{}e{exponent}", without_zeros(digits)),
        None => without_zeros(&text).to_owned(),
    }
}

fn without_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Formats `value` with the decimals that give `largest` six digits; an exact zero is "0".
fn within(value: f64, largest: f64) -> String {
    const DIGITS: i32 = 6;
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(value.is_finite() && largest.is_finite()) {
        return format!("{value:.3e}");
    }
    let magnitude = libm::log10(largest).floor() as i32;
    let decimals = DIGITS - 1 - magnitude;
    // So small next to the largest number that these decimals would show at most two of its digits.
    let vanishes = value.abs() < 0.5 * 10f64.powi(2 - decimals);
    if !(-4..DIGITS).contains(&magnitude) || vanishes {
        return format!("{value:.3e}");
    }
    format!("{value:.*}", decimals.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_points_below_each_other() {
        let mut out = String::new();
        let table = Table::default().text("name", ["a", "long name"]).numbers("value", 1.0, [Some(-12.5), None]);
        table.numbers("small", 1.0, [0.001, 1.0]).write(&mut out);
        assert_eq!(
            out,
            "  name          value    small\n  a          -12.5000  0.00100\n  long name         -  1.00000\n"
        );
        out.clear();
        Table::default().numbers("", 1.0, [0.0, 1e-17, 0.25]).write(&mut out);
        assert_eq!(out, "         0\n        ~0\n  0.250000\n");
    }

    #[test]
    fn extremes_have_exponents_or_names() {
        let numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0000826, 10.5, 300.0, 1234567.0].map(number);
        assert_eq!(numbers, ["NaN", "inf", "-inf", "8.26e-5", "10.5", "300", "1.235e6"]);
        let within = [(f64::NAN, 0.0), (1.0, f64::INFINITY), (1e-9, 1.0)].map(|(value, most)| within(value, most));
        assert_eq!(within, ["NaN", "1.000e0", "1.000e-9"]);
    }
}
