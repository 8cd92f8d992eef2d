//! Tables whose rows depend on each other: they are read in order, and the resulting states are answered like any
//! other.

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

/// How many states make a task at most.
const STATES: usize = 16;

/// The row that a state comes from; for a touchdown the last one before it.
#[derive(Debug, Clone, Default)]
pub struct RowOrigin {
    /// Its line, from 1.
    pub line: usize,
    /// The id of its state.
    pub id: Option<Value>,
    /// The fields to copy to the result.
    pub carried: Option<Carried>,
    /// The line, if it is refused.
    pub excerpt: Option<Excerpt>,
}

/// The rows of a table with their times. If reading fails, the last sample is refused with [`Reason::Io`]. `pauses` becomes
/// whether the next row may take long to arrive.
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

/// The same of columns with types.
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

/// A row with its time.
fn sample(row: Result<Row>, robot: &Robot, defaults: &Defaults) -> Sampled<RowOrigin> {
    let row = row.map_err(|error| (RowOrigin::default(), error))?;
    let source = RowOrigin { line: row.line(), id: row.id(), carried: row.carried(), excerpt: None };
    let read = || Ok((row.time()?, row.state(robot, defaults)?, row.spatial()?));
    match read() {
        Ok((time, state, spatial)) => Ok(Sample { time, state, rate_over: [time; 2], spatial, landing: None, source }),
        Err(error) => Err((source, error)),
    }
}

/// Gives the states of a recording, as many at once as a thread answers, and `None` at the end. The samples are of rows of
/// which [`States::samples`](super::States::samples) says by `pauses` whether the next one may take long to arrive; why they
/// ended early is reported after what came before.
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
