//! Tables of results with typed columns: Parquet, and Arrow's file and stream.
//!
//! ```text
//! rows of cells --[RowSink]--> ColumnBlock, one per task --> RecordBatch --[Writer]--> bytes, some rows at a time
//! ```

use super::csv::{Cell, Columns, Kind, Row, RowSink};
use crate::read::table::{Carried, Form};
use crate::{Error, Reason, Result};
use arrow_array::builder::{ArrayBuilder, BooleanBuilder, Float64Builder, Int64Builder, StringBuilder};
use arrow_array::{Array, ArrayRef, RecordBatch, new_null_array};
use arrow_cast::cast;
use arrow_ipc::writer::{FileWriter, StreamWriter};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use arrow_select::concat::concat_batches;
use arrow_select::interleave::interleave;
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::schema::types::ColumnPath;
use std::sync::Arc;

/// Rows per write, and rows per Parquet row group.
const TOGETHER: usize = 1 << 13;
const ROW_GROUP: usize = 1 << 17;

/// A block of result rows that is being filled.
#[derive(Debug)]
pub struct ColumnBlock {
    columns: Vec<Column>,
    /// The number of rows. A column may be shorter: the empty cells at its end are not stored yet.
    rows: usize,
}

#[derive(Debug)]
enum Column {
    Text(StringBuilder),
    Number(Float64Builder),
    Integer(Int64Builder),
    Boolean(BooleanBuilder),
    /// Cells of carried column `which`; `at` has each row's array (0 is a null, k `sources[k - 1]`) and the row there.
    Carried {
        which: usize,
        sources: Vec<Arc<RecordBatch>>,
        at: Vec<(usize, usize)>,
    },
}

/// Appends the cell of row `rows` (from 0), unless it is already set.
#[inline]
fn put<B: ArrayBuilder>(builder: &mut B, rows: usize, nulls: fn(&mut B, usize), append: impl FnOnce(&mut B)) {
    if has_room(builder, rows, nulls) {
        append(builder);
    }
}

/// Fills the column with nulls up to row `rows`, and returns whether that row's cell is not set yet.
#[inline]
fn has_room<B: ArrayBuilder>(builder: &mut B, rows: usize, nulls: fn(&mut B, usize)) -> bool {
    let filled = builder.len();
    if filled < rows {
        nulls(builder, rows - filled);
    }
    filled <= rows
}

/// Finishes a column of `rows` rows; missing cells at its end are null.
fn whole<B: ArrayBuilder>(mut builder: B, rows: usize, nulls: fn(&mut B, usize)) -> ArrayRef {
    has_room(&mut builder, rows, nulls);
    builder.finish()
}

/// Replaces dictionaries by their values, of type `to`, in those rows only that lie between the ones in `at`, which may
/// be few.
fn without_dictionaries(arrays: &mut [ArrayRef], at: &mut [(usize, usize)], to: &DataType) -> Result<()> {
    let mut used = vec![(usize::MAX, 0); arrays.len()];
    for &(array, row) in &*at {
        let (first, end) = used[array];
        used[array] = (row.min(first), end.max(row + 1));
    }
    for (array, &(first, end)) in arrays.iter_mut().zip(&used).filter(|(_, (first, end))| first < end) {
        *array = cast(&array.slice(first, end - first), to).map_err(unwritable)?;
    }
    at.iter_mut().for_each(|(array, row)| *row -= used[*array].0);
    Ok(())
}

impl ColumnBlock {
    /// Creates a block of these columns without rows, with capacity for `rows`.
    pub fn new(columns: &Columns, rows: usize) -> Self {
        let column = |kind: &Kind| match *kind {
            Kind::Text => Column::Text(StringBuilder::with_capacity(rows, 8 * rows)),
            Kind::Number => Column::Number(Float64Builder::with_capacity(rows)),
            Kind::Integer => Column::Integer(Int64Builder::with_capacity(rows)),
            Kind::Boolean => Column::Boolean(BooleanBuilder::with_capacity(rows)),
            Kind::Carried(which) => Column::Carried { which, sources: Vec::new(), at: Vec::new() },
        };
        Self { columns: columns.kinds().iter().map(column).collect(), rows: 0 }
    }

    fn finish(self, schema: &SchemaRef) -> Result<RecordBatch> {
        let rows = self.rows;
        let array = |(column, field): (Column, &Arc<Field>)| -> Result<ArrayRef> {
            Ok(match column {
                Column::Text(texts) => whole(texts, rows, StringBuilder::append_nulls),
                Column::Number(numbers) => whole(numbers, rows, Float64Builder::append_nulls),
                Column::Integer(numbers) => whole(numbers, rows, Int64Builder::append_nulls),
                Column::Boolean(values) => whole(values, rows, BooleanBuilder::append_nulls),
                Column::Carried { which, sources, mut at } => {
                    at.resize(rows, (0, 0));
                    let mut arrays = vec![new_null_array(field.data_type(), 1)];
                    arrays.extend(sources.iter().map(|source| Arc::clone(source.column(which))));
                    if sources.iter().any(|source| source.column(which).data_type() != field.data_type()) {
                        without_dictionaries(&mut arrays, &mut at, field.data_type())?;
                    }
                    let arrays: Vec<&dyn Array> = arrays.iter().map(AsRef::as_ref).collect();
                    interleave(&arrays, &at).map_err(unwritable)?
                }
            })
        };
        let arrays = self.columns.into_iter().zip(schema.fields()).map(array).collect::<Result<_>>()?;
        RecordBatch::try_new(Arc::clone(schema), arrays).map_err(unwritable)
    }
}

impl RowSink for ColumnBlock {
    type Row = Self;

    fn row(&mut self, _: &Columns, fill: impl FnOnce(&mut Self)) {
        fill(self);
        self.rows += 1;
    }
}

/// A value that the column cannot hold leaves the cell empty; a cell that is set twice keeps its first value.
impl Row for ColumnBlock {
    // Inlined because the kind of cell is a constant at each call, which removes the match over it.
    #[inline(always)]
    fn set(&mut self, at: usize, cell: Cell<'_>) {
        let rows = self.rows;
        let put_text = |texts: &mut StringBuilder, text: &str| {
            if !text.is_empty() {
                put(texts, rows, StringBuilder::append_nulls, |texts| texts.append_value(text));
            }
        };
        let put_number = |numbers: &mut Float64Builder, number| {
            put(numbers, rows, Float64Builder::append_nulls, |numbers| numbers.append_value(number));
        };
        match (&mut self.columns[at], cell) {
            (Column::Text(texts), Cell::Text(text)) => put_text(texts, text),
            (Column::Number(numbers), Cell::Number(number)) => put_number(numbers, number),
            (Column::Integer(numbers), Cell::Integer(number)) => {
                put(numbers, rows, Int64Builder::append_nulls, |numbers| numbers.append_value(number));
            }
            (Column::Boolean(values), Cell::Boolean(holds)) => {
                put(values, rows, BooleanBuilder::append_nulls, |values| values.append_value(holds));
            }
            (Column::Carried { sources, at, .. }, Cell::Carried(Carried::Columns(source, row), _))
                if at.len() <= rows =>
            {
                if sources.last().is_none_or(|last| !Arc::ptr_eq(last, source)) {
                    sources.push(Arc::clone(source));
                }
                at.resize(rows, (0, 0));
                at.push((sources.len(), *row));
            }
            (Column::Text(texts), Cell::Carried(carried, which)) => {
                put_text(texts, &String::from_utf8_lossy(&carried.text(which)));
            }
            (Column::Number(numbers), Cell::Carried(carried, which)) => {
                let text = carried.text(which);
                let number = std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok());
                number.into_iter().for_each(|number| put_number(numbers, number));
            }
            _ => {}
        }
    }
}

/// Writes blocks of rows into memory, and hands over the bytes that are complete.
pub struct ColumnWriter {
    schema: SchemaRef,
    /// Blocks that are not written yet.
    waiting: Vec<RecordBatch>,
    rows: usize,
    writer: Writer,
}

enum Writer {
    Parquet(Box<ArrowWriter<Vec<u8>>>),
    Arrow(Box<FileWriter<Vec<u8>>>),
    ArrowStream(Box<StreamWriter<Vec<u8>>>),
}

/// Returns the refusal of a table that the format cannot hold.
fn unwritable(error: impl std::fmt::Display) -> Error {
    Error::new(Reason::Unsupported(format!("the results cannot be written so: {error}"))).hint("write CSV or NDJSON")
}

impl ColumnWriter {
    /// Begins a table with these columns.
    ///
    /// # Errors
    /// Returns an error if the format has no type for a carried column, or if it is a text format.
    pub fn new(columns: &Columns, form: Form) -> Result<Self> {
        let field = |(name, kind): (&String, &Kind)| match *kind {
            Kind::Text => Field::new(name, DataType::Utf8, true),
            Kind::Number => Field::new(name, DataType::Float64, true),
            Kind::Integer => Field::new(name, DataType::Int64, true),
            Kind::Boolean => Field::new(name, DataType::Boolean, true),
            Kind::Carried(which) => columns.carried_field(which).with_name(name).with_nullable(true),
        };
        let fields: Vec<Field> = columns.names().iter().zip(columns.kinds()).map(field).collect();
        let schema = Arc::new(Schema::new(fields));
        let writer = match form {
            Form::Parquet => {
                let mut properties = WriterProperties::builder()
                    .set_compression(Compression::SNAPPY)
                    .set_created_by(concat!("heelstrike ", env!("CARGO_PKG_VERSION")).to_owned())
                    .set_max_row_group_row_count(Some(ROW_GROUP))
                    .set_statistics_enabled(EnabledStatistics::Chunk)
                    .set_dictionary_enabled(false);
                for field in schema.fields() {
                    let path = ColumnPath::new(vec![field.name().clone()]);
                    properties = match field.data_type() {
                        // Minima and maxima of text are useless, and so is a dictionary of ids, which all differ.
                        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => properties
                            .set_column_dictionary_enabled(path.clone(), field.name() != "id")
                            .set_column_statistics_enabled(path, EnabledStatistics::None),
                        // Consecutive lines, ids and counts differ by little.
                        data_type if data_type.is_integer() => {
                            properties.set_column_encoding(path, Encoding::DELTA_BINARY_PACKED)
                        }
                        _ => properties,
                    };
                }
                let writer = ArrowWriter::try_new(Vec::new(), Arc::clone(&schema), Some(properties.build()));
                Writer::Parquet(Box::new(writer.map_err(unwritable)?))
            }
            Form::Arrow => Writer::Arrow(Box::new(FileWriter::try_new(Vec::new(), &schema).map_err(unwritable)?)),
            Form::Ndjson | Form::Csv | Form::Tsv => return Err(unwritable("text has no types")),
            Form::Arrows => {
                Writer::ArrowStream(Box::new(StreamWriter::try_new(Vec::new(), &schema).map_err(unwritable)?))
            }
        };
        Ok(Self { schema, waiting: Vec::new(), rows: 0, writer })
    }

    /// Adds a block, and returns the bytes that are complete.
    ///
    /// # Errors
    /// Returns an error if the format cannot hold the rows.
    pub fn write(&mut self, block: ColumnBlock) -> Result<Vec<u8>> {
        let batch = block.finish(&self.schema)?;
        self.rows += batch.num_rows();
        self.waiting.push(batch);
        if self.rows < TOGETHER { Ok(Vec::new()) } else { self.flush() }
    }

    fn flush(&mut self) -> Result<Vec<u8>> {
        let batch = concat_batches(&self.schema, &std::mem::take(&mut self.waiting)).map_err(unwritable)?;
        let written = match &mut self.writer {
            _ if self.rows == 0 => Ok(()),
            Writer::Parquet(writer) => writer.write(&batch),
            Writer::Arrow(writer) => writer.write(&batch).map_err(ParquetError::from),
            Writer::ArrowStream(writer) => writer.write(&batch).map_err(ParquetError::from),
        };
        written.map_err(unwritable)?;
        self.rows = 0;
        Ok(self.taken())
    }

    /// Takes the bytes that are complete.
    fn taken(&mut self) -> Vec<u8> {
        std::mem::take(match &mut self.writer {
            Writer::Parquet(writer) => writer.inner_mut(),
            Writer::Arrow(writer) => writer.get_mut(),
            Writer::ArrowStream(writer) => writer.get_mut(),
        })
    }

    /// Ends the table, and returns its last bytes.
    ///
    /// # Errors
    /// Returns an error if the last rows cannot be written.
    pub fn finish(mut self) -> Result<Vec<u8>> {
        let mut bytes = self.flush()?;
        let finished = match &mut self.writer {
            Writer::Parquet(writer) => writer.finish().map(drop),
            Writer::Arrow(writer) => writer.finish().map_err(ParquetError::from),
            Writer::ArrowStream(writer) => writer.finish().map_err(ParquetError::from),
        };
        finished.map_err(unwritable)?;
        bytes.append(&mut self.taken());
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Robot;
    use crate::write::Layout;
    use arrow_array::cast::AsArray;

    #[test]
    fn every_column_has_a_cell_of_each_row() -> Result<()> {
        let robot = Robot::from_urdf(include_str!("../../urdf/block.urdf"))?;
        let columns = Columns::without_lines(&robot, &[], &[], &[], Layout::default());
        let mut block = ColumnBlock::new(&columns, 1);
        for verdicts in [&["unique", "none"][..], &[], &["ambiguous"]] {
            block.row(&columns, |row| verdicts.iter().for_each(|verdict| row.set(1, Cell::Text(verdict))));
        }
        let schema = ColumnWriter::new(&columns, Form::Arrow)?.schema;
        let batch = block.finish(&schema)?;
        assert_eq!((batch.num_rows(), batch.num_columns()), (3, columns.names().len()));
        let texts: Vec<_> = batch.column(1).as_string::<i32>().iter().collect();
        assert_eq!(texts, [Some("unique"), None, Some("ambiguous")]);
        Ok(())
    }
}
