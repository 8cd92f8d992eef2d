//! Reads tables with typed columns: Parquet, and Arrow's file and stream.
//!
//! ```text
//!     file --[parquet, arrow-ipc]--> batches --cast once to f64, text, whole numbers--> Part --> Row
//!                                        └── other columns keep their types ──> Carried
//! ```

use super::header::{Header, Rates, TableColumn};
use super::records::{Form, Record};
use super::rows::{Row, Source};
use super::typed::{Typed, carried, unreadable};
use super::types::{content, kind};
use crate::read::documents::refuse_foreign;
use crate::{Error, Reason, Result, Robot};
use arrow_array::{RecordBatchIterator, RecordBatchReader};
use arrow_ipc::reader::{FileReader, StreamReader};
use arrow_schema::{ArrowError, DataType};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// The greatest number of rows of a part; they are answered together.
const TOGETHER: usize = 1024;

/// The first bytes of Parquet, of an Arrow file and of an Arrow stream.
const PARQUET: &[u8] = b"PAR1";
const FILE: &[u8] = b"ARROW1";
const STREAM: &[u8] = b"\xFF\xFF\xFF\xFF";

/// The fault of a file that contains more than one stream.
const JOINED: &str = "more follows the end of the stream: are several joined?";

/// A table with typed columns, read part by part.
pub struct Parts {
    batches: Box<dyn RecordBatchReader + Send>,
    /// The columns of the header; empty until it is read.
    columns: Arc<[TableColumn]>,
    /// Columns that were read, and the first of their rows that was not returned yet.
    ready: Option<(Arc<Typed>, usize)>,
    /// The number of the next row, from 1.
    next: usize,
}

/// Some consecutive rows.
#[derive(Debug, Clone)]
pub struct Part {
    columns: Arc<Typed>,
    /// The first row in `columns`, and the number of rows.
    start: usize,
    count: usize,
    /// The number of the first row in the table, from 1.
    first: usize,
}

impl Parts {
    /// Opens a file of Parquet or Arrow.
    ///
    /// # Errors
    /// Returns an error if the file is neither, or has a compression that is not supported.
    pub fn open(mut file: File, form: Form) -> Result<Self> {
        // Under either name of Arrow a file may be a stream, and a stream a file.
        let form = if form == Form::Arrows { Form::Arrow } else { form };
        let beginning = beginning(&mut file, form)?;
        file.rewind().map_err(unreadable)?;
        if form == Form::Parquet {
            let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(unreadable)?;
            return builder.with_batch_size(4 * TOGETHER).build().map(Self::new).map_err(unreadable);
        }
        // The first bytes distinguish Arrow's file and stream.
        if !beginning.starts_with(FILE) {
            return Self::arrow_stream_of(file);
        }
        guarded(|| FileReader::try_new_buffered(file, None)).map(Self::new)
    }

    /// Reads Arrow's stream; what follows its end is not read.
    ///
    /// # Errors
    /// Returns an error if the input is not such a stream.
    pub fn arrow_stream(mut input: impl Read + Send + 'static) -> Result<Self> {
        let beginning = beginning(&mut input, Form::Arrows)?;
        guarded(|| StreamReader::try_new(Cursor::new(beginning).chain(input), None)).map(Self::new)
    }

    /// Reads a file that contains one stream and nothing else.
    fn arrow_stream_of(file: File) -> Result<Self> {
        let mut reader = guarded(|| StreamReader::try_new(BufReader::new(file), None))?;
        let schema = reader.schema();
        let mut is_open = true;
        let batches = std::iter::from_fn(move || match reader.next() {
            None if std::mem::take(&mut is_open) => match reader.get_mut().read(&mut [0]) {
                Ok(0) => None,
                Ok(_) => Some(Err(ArrowError::IpcError(JOINED.into()))),
                Err(error) => Some(Err(error.into())),
            },
            next => next,
        });
        Ok(Self::new(RecordBatchIterator::new(batches, schema)))
    }

    fn new(batches: impl RecordBatchReader + Send + 'static) -> Self {
        Self { batches: Box::new(batches), columns: Arc::new([]), ready: None, next: 1 }
    }

    /// Reads the columns' names, as [`Header::read`] does, and checks their types.
    ///
    /// # Errors
    /// Returns the errors of [`Header::read`], and an error for a column of the wrong type; they have no line.
    pub fn header(&mut self, robot: &Robot, rates: Rates, foreign: &[String]) -> Result<Header> {
        let schema = self.batches.schema();
        let names = schema.fields().iter().map(|field| field.name().trim().to_owned()).collect();
        let record = Record { bytes: b"", form: Form::Parquet };
        let mut header = Header::named(names, record, robot, rates, foreign).map_err(Error::nowhere)?;
        for (at, (&column, field)) in header.columns.iter().zip(schema.fields()).enumerate() {
            let expected = match (column, kind(field.data_type())) {
                (TableColumn::Carried | TableColumn::Ignored, _) | (_, DataType::Null | DataType::Utf8) => continue,
                (TableColumn::Stance, _) => "text",
                (_, DataType::Float64 | DataType::Int64) => continue,
                (TableColumn::Id, _) => "text or numbers",
                _ => "numbers",
            };
            let found = content(field.data_type());
            let reason = Reason::Inconsistent(format!("\"{}\" must hold {expected}, not {found}", field.name()));
            return Err(Error::new(reason).at(format!("column {}", at + 1)).hint("convert the column"));
        }
        let carried = schema.project(&carried(&header.columns)).map_err(unreadable)?;
        header.types = Some(Arc::new(carried));
        self.columns = header.columns.clone().into();
        Ok(header)
    }

    /// Returns whether no row is left.
    ///
    /// # Errors
    /// Returns an error if the next rows cannot be read.
    pub fn is_empty(&mut self) -> Result<bool> {
        while self.ready.is_none() {
            let Some(batch) = guarded(|| self.batches.next().transpose())? else { return Ok(true) };
            if batch.num_rows() > 0 {
                self.ready = Some((Arc::new(Typed::new(&batch, &self.columns)?), 0));
            }
        }
        Ok(false)
    }

    /// Returns the next rows; `None` at the end.
    ///
    /// # Errors
    /// Returns an error if the next rows cannot be read.
    pub fn part(&mut self) -> Result<Option<Part>> {
        self.is_empty()?;
        let Some((columns, start)) = self.ready.take() else { return Ok(None) };
        let rows = columns.rows;
        let (count, first) = (TOGETHER.min(rows - start), self.next);
        self.next += count;
        if start + count < rows {
            self.ready = Some((Arc::clone(&columns), start + count));
        }
        Ok(Some(Part { columns, start, count, first }))
    }
}

/// Reads the first bytes of an input. Refuses one that is empty, text, too short, or known as of another format.
fn beginning(input: &mut impl Read, form: Form) -> Result<Vec<u8>> {
    const READ: u64 = 64;
    /// No table has fewer bytes.
    const LEAST: usize = 12;
    let mut bytes = Vec::new();
    input.take(READ).read_to_end(&mut bytes).map_err(unreadable)?;
    let magics: &[&[u8]] = match form {
        Form::Parquet => &[PARQUET],
        Form::Arrow => &[FILE, STREAM],
        _ => &[STREAM],
    };
    if bytes.is_empty() {
        return Err(unreadable("it is empty").hint("was it written to its end?"));
    }
    let format = if form == Form::Parquet { "Parquet" } else { "Arrow" };
    if !magics.iter().any(|magic| bytes.starts_with(magic)) {
        refuse_foreign(&bytes)?;
        if bytes.iter().all(|byte| matches!(byte, b'\t' | b'\n' | b'\r' | b' '..)) {
            let refused = unreadable(format_args!("it is text, and not {format}"));
            return Err(refused.hint("end its name in .csv, .tsv or .ndjson, or give the command `input_format: csv`"));
        }
    }
    if bytes.len() < LEAST {
        return Err(unreadable(format_args!("it has only {} bytes, and is not {format}", bytes.len())));
    }
    Ok(bytes)
}

/// Returns what a reader returns; arrow's readers panic on some damaged files.
fn guarded<R>(read: impl FnOnce() -> std::result::Result<R, ArrowError>) -> Result<R> {
    // A reader that has panicked is not used again.
    catch_unwind(AssertUnwindSafe(read)).map_err(|_| unreadable("the file is damaged"))?.map_err(unreadable)
}

impl Part {
    /// Returns the number of rows.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the rows of the part.
    pub fn rows<'p>(&'p self, header: &'p Header) -> impl Iterator<Item = Row<'p>> {
        let source = move |at: usize| Source::Columns(&self.columns, self.start + at);
        (0..self.count).map(move |at| Row { header, source: source(at), line: self.first + at })
    }
}
