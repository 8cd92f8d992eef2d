//! Formats of states and of their answers.

use super::Failure;
use super::output::check_ending;
use crate::read::table::Form;
#[cfg(feature = "columnar")]
use crate::read::table::Parts;
#[cfg(feature = "columnar")]
use crate::write::{ColumnWriter, ColumnarFormat, Columns};
#[cfg(not(feature = "columnar"))]
use crate::{Error, Reason};
use clap::ValueEnum;
#[cfg(feature = "columnar")]
use std::fs::File;
use std::path::Path;

/// The format of an input or output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RecordFormat {
    /// One JSON object per line
    #[value(alias = "json", alias = "jsonl")]
    Ndjson,
    /// A table with a header and commas between columns
    Csv,
    /// A table with a header and tabs between columns
    Tsv,
    /// A Parquet file
    Parquet,
    /// An Arrow IPC file, as Feather; read also as a stream
    #[value(alias = "feather", alias = "ipc")]
    Arrow,
    /// An Arrow IPC stream
    Arrows,
}

impl RecordFormat {
    /// The table that a file's ending means; endings are the names of formats.
    pub fn table(path: &Path) -> Option<Self> {
        let named = Self::from_str(path.extension()?.to_str()?, true).ok();
        named.filter(|format| *format != Self::Ndjson)
    }

    /// What is `chosen` by the option of this name, or by the ending of a file, which may be written; else lines of JSON.
    pub(super) fn of(file: (Option<&Path>, bool), chosen: Option<Self>, option: &str) -> Result<Self, Failure> {
        let (path, _) = file;
        let format = chosen.or_else(|| path.and_then(Self::table)).unwrap_or(Self::Ndjson);
        if chosen.is_none() && format == Self::Ndjson {
            check_ending(file, "states and answers are .ndjson, .csv, .tsv, .parquet or .arrow", option)?;
        }
        #[cfg(not(feature = "columnar"))]
        if !format.is_text() {
            let error = format.absent();
            return Err(Failure::Usage(path.map_or(error.clone(), |path| error.in_file(path.display().to_string()))));
        }
        Ok(format)
    }

    /// The refusal of a format that this build does not have.
    #[cfg(not(feature = "columnar"))]
    pub fn absent(self) -> Error {
        let reason = Reason::Unsupported("this build has no Parquet and no Arrow".into());
        let hint =
            "build it with `cargo install --path . --features columnar`, or take the command of the Python package";
        Error::new(reason).hint(hint)
    }

    /// How records are written.
    pub fn form(self) -> Form {
        match self {
            Self::Ndjson => Form::Ndjson,
            Self::Csv => Form::Csv,
            Self::Tsv => Form::Tsv,
            Self::Parquet | Self::Arrow | Self::Arrows => Form::Columns,
        }
    }

    /// Whether it is text.
    pub fn is_text(self) -> bool {
        self.form() != Form::Columns
    }

    /// The table in a file that is no text.
    ///
    /// # Errors
    /// As [`Parts`] has them.
    #[cfg(feature = "columnar")]
    pub fn parts(self, file: File) -> crate::Result<Parts> {
        if self == Self::Parquet { Parts::parquet(file) } else { Parts::arrow(file) }
    }

    /// A writer of these columns, unless they are written as text.
    #[cfg(feature = "columnar")]
    pub fn writer(self, columns: &Columns) -> crate::Result<Option<ColumnWriter>> {
        let format = match self {
            Self::Ndjson | Self::Csv | Self::Tsv => return Ok(None),
            Self::Parquet => ColumnarFormat::Parquet,
            Self::Arrow => ColumnarFormat::Arrow,
            Self::Arrows => ColumnarFormat::ArrowStream,
        };
        ColumnWriter::new(columns, format).map(Some)
    }
}
