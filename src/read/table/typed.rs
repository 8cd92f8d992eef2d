//! Typed columns of a batch, cast once to the types that states are read from.

use super::header::TableColumn;
use super::records::Cell;
use super::types::kind;
use crate::read::json::id_of;
use crate::{Error, Reason, Result, State};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_cast::cast::{CastOptions, cast_with_options};
use arrow_schema::DataType;
use serde_json::Value;
use std::sync::Arc;

/// The columns of a batch, cast to the types that states are read from.
#[derive(Debug)]
pub(super) struct Typed {
    columns: Vec<Column>,
    /// The coordinates of q, and those of v, whose columns hold finite numbers only, with these columns.
    whole: [Vec<(usize, Float64Array)>; 2],
    /// The indices of all other columns.
    pub open: Vec<usize>,
    /// The columns that are carried through, with that of the ids at their end, if there are any of these.
    pub carried: Option<Arc<RecordBatch>>,
    pub rows: usize,
}

#[derive(Debug)]
enum Column {
    Numbers(Float64Array),
    Integers(Int64Array),
    Texts(StringArray),
    /// Other numbers, as their digits.
    Digits(StringArray),
    Unread,
}

/// Returns the refusal of a file that cannot be read.
pub(super) fn unreadable(error: impl std::fmt::Display) -> Error {
    let text = error.to_string();
    let refused = Error::new(Reason::Io(format!("cannot be read: {text}")));
    refused.hint(match ["zstd", "brotli", "lzo"].iter().any(|codec| text.to_lowercase().contains(codec)) {
        true => "write it with the compression snappy, lz4 or gzip, for Arrow only lz4, or with none",
        false => "is it whole, and written in this format?",
    })
}

impl Typed {
    /// Casts the columns of a batch.
    pub fn new(batch: &RecordBatch, columns: &[TableColumn]) -> Result<Self> {
        let carried = batch.project(&carried(columns)).map_err(unreadable)?;
        let fields = columns.iter().zip(batch.columns()).zip(batch.schema_ref().fields());
        let typed = fields.map(|((column, array), field)| {
            let to = |to: DataType| -> Result<ArrayRef> {
                let exact = CastOptions { safe: false, ..CastOptions::default() };
                cast_with_options(array, &to, &exact).map_err(|error| unreadable(error).at(field.name()))
            };
            Ok(match (column, kind(array.data_type())) {
                (TableColumn::Ignored, _) => Column::Unread,
                (TableColumn::Carried, _) if field.name().trim() != "time" => Column::Unread,
                (TableColumn::Id, DataType::Int64) => {
                    Column::Integers(to(DataType::Int64)?.as_primitive::<Int64Type>().clone())
                }
                (TableColumn::Id, DataType::Float64) => Column::Digits(to(DataType::Utf8)?.as_string().clone()),
                (_, DataType::Int64 | DataType::Float64) => {
                    Column::Numbers(to(DataType::Float64)?.as_primitive::<Float64Type>().clone())
                }
                (_, DataType::Utf8 | DataType::Null) => Column::Texts(to(DataType::Utf8)?.as_string().clone()),
                (TableColumn::Carried, _) => {
                    to(DataType::Utf8).map_or(Column::Unread, |texts| Column::Texts(texts.as_string().clone()))
                }
                _ => Column::Unread,
            })
        });
        let typed = typed.collect::<Result<Vec<_>>>()?;
        // With a stance, x and z of the base must be empty: these columns are checked cell by cell.
        let least = if columns.contains(&TableColumn::Stance) { 2 } else { 0 };
        let (mut whole, mut open) = ([Vec::new(), Vec::new()], Vec::new());
        for (at, (&column, typed)) in columns.iter().zip(&typed).enumerate() {
            let coordinate = match column {
                TableColumn::Position(to) => Some((0, to)),
                TableColumn::Velocity(to) => Some((1, to)),
                _ => None,
            };
            // The fold has no branch per value.
            let is_whole = |numbers: &Float64Array| {
                let finite = || numbers.values().iter().fold(true, |finite, value| finite & value.is_finite());
                numbers.null_count() == 0 && finite()
            };
            match (coordinate, typed) {
                (Some((part, to)), Column::Numbers(numbers)) if to >= least && is_whole(numbers) => {
                    whole[part].push((to, numbers.clone()));
                }
                _ => open.push(at),
            }
        }
        let carried = (carried.num_columns() > 0).then(|| Arc::new(carried));
        Ok(Self { columns: typed, whole, open, carried, rows: batch.num_rows() })
    }

    /// Reads the coordinates whose columns hold finite numbers only, without a check per cell.
    #[inline]
    pub fn read(&self, row: usize, state: &mut State) {
        for (numbers, columns) in [&mut state.position, &mut state.velocity].into_iter().zip(&self.whole) {
            columns.iter().for_each(|(to, column)| numbers[*to] = column.value(row));
        }
    }

    pub fn cell(&self, at: usize, row: usize) -> Cell<'_> {
        match &self.columns[at] {
            Column::Numbers(_) => self.number(at, row).map_or(Cell::Empty, Cell::Number),
            Column::Texts(_) => match self.text(at, row).unwrap_or_default().trim() {
                "" => Cell::Empty,
                text => Cell::Text(text.into()),
            },
            Column::Integers(_) | Column::Digits(_) | Column::Unread => Cell::Empty,
        }
    }

    /// Returns the number in a cell of a column of numbers.
    #[inline]
    pub fn number(&self, at: usize, row: usize) -> Option<f64> {
        let Column::Numbers(numbers) = &self.columns[at] else { return None };
        numbers.is_valid(row).then(|| numbers.value(row))
    }

    /// Returns the text in a cell of a column of text, as it is.
    pub fn text(&self, at: usize, row: usize) -> Option<&str> {
        let Column::Texts(texts) = &self.columns[at] else { return None };
        texts.is_valid(row).then(|| texts.value(row))
    }

    /// Returns the id in a cell of a column of numbers; a data frame has whole ones as floats if one is missing.
    pub fn id(&self, at: usize, row: usize) -> Option<Value> {
        match &self.columns[at] {
            Column::Integers(numbers) if numbers.is_valid(row) => Some(numbers.value(row).into()),
            Column::Digits(digits) if digits.is_valid(row) => {
                let digits = digits.value(row);
                let digits = match digits.split_once('.') {
                    Some((whole, zeros)) if zeros.bytes().all(|digit| digit == b'0') => whole,
                    _ => digits,
                };
                match digits.parse::<f64>() {
                    Ok(0.0) => Some(0.into()),
                    // Large floats are written with an exponent.
                    Ok(value) if digits.contains('e') && value.fract() == 0.0 && value.abs() < -(i64::MIN as f64) => {
                        Some((value as i64).into())
                    }
                    _ => id_of(digits),
                }
            }
            _ => None,
        }
    }
}

/// Returns the indices of the columns that are copied to the results, with that of the id at the end.
pub(super) fn carried(columns: &[TableColumn]) -> Vec<usize> {
    let of = |wanted| (0..columns.len()).filter(move |&at| columns[at] == wanted);
    of(TableColumn::Carried).chain(of(TableColumn::Id)).collect()
}
