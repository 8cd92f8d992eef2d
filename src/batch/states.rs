//! The states of an input in any format.

use super::chunk::Chunks;
use super::recording::{RowOrigin, samples};
use super::run::RefusedRecord;
use crate::error::Location;
use crate::error::excerpt::Excerpt;
use crate::gait::Sampled;
#[cfg(feature = "columnar")]
use crate::read::table::Parts;
use crate::read::table::{Form, Header, Rates, is_flat};
use crate::state::Defaults;
use crate::{Result, Robot};
use std::io::Read;
use std::sync::atomic::AtomicBool;

/// The states of an input.
pub enum States {
    /// Lines of JSON, or a table as text.
    Text(Chunks<Box<dyn Read + Send>>, Form),
    /// A table with typed columns.
    #[cfg(feature = "columnar")]
    Columns(Parts),
}

impl States {
    /// Reads an input of text.
    ///
    /// # Errors
    /// Returns an error if the first bytes show a compressed file, a spreadsheet or the like, or if reading fails.
    pub fn of_text(input: impl Read + Send + 'static, form: Form) -> Result<Self> {
        let mut chunks = Chunks::of_table(Box::new(input) as Box<dyn Read + Send>, form);
        chunks.check_format()?;
        Ok(Self::Text(chunks, form))
    }

    /// Returns whether no states are left.
    ///
    /// # Errors
    /// Returns an error if reading fails.
    pub fn is_empty(&mut self) -> Result<bool> {
        match self {
            Self::Text(chunks, _) => chunks.is_empty(),
            #[cfg(feature = "columnar")]
            Self::Columns(parts) => parts.is_empty(),
        }
    }

    /// Returns the columns of a table; one of them must be the time if its rows are read `in_order`. `None` for lines
    /// of JSON that are not flat and for text without a line.
    ///
    /// # Errors
    /// Returns the errors of [`Header::read`] and [`Header::with_time`]; for text with the line.
    pub fn header(
        &mut self,
        robot: &Robot,
        rates: Rates,
        foreign: &[String],
        in_order: bool,
    ) -> std::result::Result<Option<Header>, RefusedRecord> {
        let refused = |error| RefusedRecord { error, excerpt: None };
        let with_time = |header: Header| if in_order { header.with_time() } else { Ok(header) };
        let (chunks, form) = match self {
            Self::Text(chunks, form) => (chunks, *form),
            #[cfg(feature = "columnar")]
            Self::Columns(parts) => {
                return parts.header(robot, rates, foreign).and_then(with_time).map(Some).map_err(refused);
            }
        };
        let first = if form == Form::Ndjson {
            let flat = chunks.peek(|line| is_flat(line).map(|flat| flat.then(|| line.to_vec())));
            flat.map(|first| first.and_then(|(line, record)| Some((line, record?))))
        } else {
            chunks.first()
        };
        let Some((line, record)) = first.map_err(refused)? else { return Ok(None) };
        let header = Header::read(&record, form, robot, rates, foreign).map_err(|error| {
            let place = error.location().unwrap_or(Location { line: 1, column: 1 });
            let place = Location { line: line + place.line - 1, ..place };
            let excerpt = Excerpt::around(&record, line, place);
            RefusedRecord { error: error.on(place.line, place.column), excerpt }
        })?;
        chunks.expect_columns(header.count());
        with_time(header).map(Some).map_err(|error| refused(error.on(line, 1)))
    }

    /// Reads the rows as samples. Sets `pauses` to whether the next row may take long to arrive.
    pub fn samples<'h>(
        self,
        header: &'h Header,
        robot: &'h Robot,
        defaults: &'h Defaults,
        pauses: &'h AtomicBool,
    ) -> Box<dyn Iterator<Item = Sampled<RowOrigin>> + Send + 'h> {
        match self {
            Self::Text(chunks, _) => Box::new(samples(chunks, header, robot, defaults, pauses)),
            #[cfg(feature = "columnar")]
            Self::Columns(parts) => Box::new(super::recording::samples_of_parts(parts, header, robot, defaults)),
        }
    }
}
