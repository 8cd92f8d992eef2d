//! Tables whose rows depend on each other. They are read in order; their states are then answered like any others.

use super::chunk::{Chunks, too_long};
use crate::error::excerpt::Excerpt;
use crate::gait::{Sample, Sampled};
#[cfg(feature = "columnar")]
use crate::read::table::Parts;
use crate::read::table::{Carried, Header, Row};
use crate::state::Defaults;
use crate::{Error, Reason, Result, Robot};
use serde_json::Value;
use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// States per task, at most.
const STATES: usize = 16;

/// The row from which a state comes; for a touchdown the last row before it.
#[derive(Debug, Clone, Default)]
pub struct RowOrigin {
    /// The line of the row, from 1.
    pub line: usize,
    /// The id of the row's state.
    pub id: Option<Value>,
    /// The fields that are copied to the result.
    pub carried: Option<Carried>,
    /// The shortened line, if the row is refused.
    pub excerpt: Option<Excerpt>,
}

/// Reads the rows of a table as samples. If reading fails, the last sample is refused with [`Reason::Io`]. Sets
/// `pauses` to whether the next row may take long to arrive.
pub(super) fn samples<'h, R: Read + Send>(
    mut chunks: Chunks<R>,
    header: &'h Header,
    robot: &'h Robot,
    defaults: &'h Defaults,
    pauses: &'h AtomicBool,
) -> impl Iterator<Item = Sampled<RowOrigin>> {
    let mut rows = header.rows();
    let mut read = move |line: usize, record: &[u8]| {
        let row = rows.row(record, line).transpose()?;
        Some(sample(row, robot, defaults).map_err(|(mut source, error)| {
            source.line = line;
            source.id = source.id.or_else(|| header.id_in(record));
            source.excerpt = error.location().and_then(|place| Excerpt::around(record, line, place));
            (source, error)
        }))
    };
    let chunks = std::iter::from_fn(move || {
        let chunk = chunks.record().transpose();
        pauses.store(chunks.keeps_waiting(), Relaxed);
        chunk
    });
    chunks.flat_map(move |chunk| match chunk {
        Ok(chunk) => {
            let mut samples: Vec<_> = chunk.records().filter_map(|(line, record)| read(line, record)).collect();
            let line = chunk.too_long;
            samples.extend(line.map(|line| Err((RowOrigin { line, ..RowOrigin::default() }, too_long()))));
            samples
        }
        Err(error) => vec![Err((RowOrigin::default(), error))],
    })
}

/// Reads the rows of a table with typed columns as samples.
#[cfg(feature = "columnar")]
pub(super) fn samples_of_parts<'h>(
    mut parts: Parts,
    header: &'h Header,
    robot: &'h Robot,
    defaults: &'h Defaults,
) -> impl Iterator<Item = Sampled<RowOrigin>> {
    std::iter::from_fn(move || parts.part().transpose()).flat_map(move |part| match part {
        Ok(part) => part.rows(header).map(|row| sample(Ok(row), robot, defaults)).collect(),
        Err(error) => vec![Err((RowOrigin::default(), error))],
    })
}

/// Reads a row and its time.
fn sample(row: Result<Row>, robot: &Robot, defaults: &Defaults) -> Sampled<RowOrigin> {
    let row = row.map_err(|error| (RowOrigin::default(), error))?;
    let source = RowOrigin { line: row.line(), id: row.id(), carried: row.carried(), excerpt: None };
    // The state is read first, which refuses rows of too few fields.
    let read = || Ok((row.state(robot, defaults)?, row.time()?, row.spatial()?));
    match read() {
        Ok((state, time, spatial)) => Ok(Sample { time, state, rate_over: [time; 2], spatial, landing: None, source }),
        Err(error) => Err((source, error)),
    }
}

/// Groups the states of a recording into tasks; the result returns `None` at the end. A task ends early if `pauses`,
/// which [`States::samples`](super::States::samples) sets, says that the next row may take long. An error that ends the
/// samples early is returned after all states before it.
pub fn recorded(
    mut samples: impl Iterator<Item = Sampled<RowOrigin>> + Send,
    pauses: &AtomicBool,
) -> impl FnMut() -> Result<Option<Vec<Sampled<RowOrigin>>>> + Send {
    let mut broken: Option<Error> = None;
    move || {
        let mut task = Vec::new();
        while broken.is_none() && task.len() < STATES && (task.is_empty() || !pauses.load(Relaxed)) {
            match samples.next() {
                None => break,
                Some(Err((_, error))) if matches!(error.reason(), Reason::Io(_)) => broken = Some(error),
                Some(sampled) => task.push(sampled),
            }
        }
        match &broken {
            Some(error) if task.is_empty() => Err(error.clone()),
            _ => Ok((!task.is_empty()).then_some(task)),
        }
    }
}
