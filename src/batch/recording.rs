//! Tables whose rows depend on each other: they are read in order, and the resulting states are answered like any
//! other.

use super::chunk::{Chunks, too_long};
use super::run::Source;
use crate::error::excerpt::Excerpt;
use crate::gait::{At, Sample, Sampled, Touchdown, Touching};
use crate::read::table::{Carried, Header};
use crate::state::{Defaults, State};
use crate::write;
use crate::{Error, Reason, Result, Robot};
use serde_json::Value;
use std::io::{self, Read};

/// How many states make a task.
const STATES: usize = 16;

/// The row that a state comes from.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Its line, from 1.
    pub line: usize,
    /// Its id.
    pub id: Option<Value>,
    /// The fields to copy to the result.
    pub carried: Carried,
    /// The line, if it is refused.
    pub excerpt: Option<Excerpt>,
}

/// A state of a recording, or its refusal.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The row; for a touchdown the last one before it.
    pub origin: Origin,
    /// The state.
    pub state: Result<State>,
    /// How a touchdown was found.
    pub touchdown: Option<Landing>,
}

/// How a touchdown was found; the fields are those of [`Touchdown`].
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "documented at their origin")]
pub struct Landing {
    pub row: usize,
    pub time: f64,
    pub striking: String,
    pub shift_z: f64,
}

impl Landing {
    /// As it stands in a result.
    pub(super) fn record(&self, (at, touching): (At, Touching)) -> write::Touchdown<'_> {
        let Self { row, time, striking, shift_z } = self;
        let (at, touching) = (at.name(), touching.to_string());
        write::Touchdown {
            row: *row,
            time: *time,
            striking: striking.into(),
            shift_z: *shift_z,
            at: at.into(),
            touching,
        }
    }
}

impl From<Sampled<Origin>> for Recorded {
    fn from(sampled: Sampled<Origin>) -> Self {
        let (origin, state) = match sampled {
            Ok(Sample { source, state, .. }) => (source, Ok(state)),
            Err((source, error)) => (source, Err(error)),
        };
        Self { origin, state, touchdown: None }
    }
}

impl From<std::result::Result<Touchdown<Origin>, (Origin, Error)>> for Recorded {
    fn from(found: std::result::Result<Touchdown<Origin>, (Origin, Error)>) -> Self {
        match found {
            Ok(Touchdown { state, row, time, striking, shift_z, source }) => {
                let touchdown = Some(Landing { row, time, striking, shift_z });
                Self { origin: source, state: Ok(state), touchdown }
            }
            Err((origin, error)) => Self { origin, state: Err(error), touchdown: None },
        }
    }
}

/// The rows of a table with their times. If reading fails, the last sample is refused with [`Reason::Io`].
pub fn samples<'h, R: Read>(
    mut chunks: Chunks<R>,
    header: &'h Header,
    robot: &'h Robot,
    defaults: &'h Defaults,
) -> impl Iterator<Item = Sampled<Origin>> {
    let mut rows = header.rows();
    let mut read = move |line: usize, record: &[u8]| match rows.row(record, line) {
        Ok(None) => None,
        Ok(Some(row)) => {
            let source = Origin { line, id: row.id(), carried: row.carried(), excerpt: None };
            let sample = || Ok((row.time()?, row.state(robot, defaults)?, row.spatial()?));
            Some(match sample() {
                Ok((time, state, spatial)) => Ok(Sample { time, state, rate_over: [time; 2], spatial, source }),
                Err(error) => Err((Origin { excerpt: excerpt(record, line, &error), ..source }, error)),
            })
        }
        Err(error) => {
            let source = Origin { line, excerpt: excerpt(record, line, &error), ..Origin::default() };
            Some(Err((source, error)))
        }
    };
    let chunks = std::iter::from_fn(move || chunks.record().transpose());
    chunks.flat_map(move |chunk| match chunk {
        Ok(chunk) => {
            let mut samples: Vec<_> = chunk.records().filter_map(|(line, record)| read(line, record)).collect();
            let line = chunk.too_long;
            samples.extend(line.map(|line| Err((Origin { line, ..Origin::default() }, too_long()))));
            samples
        }
        Err(error) => vec![Err((Origin::default(), Reason::Io(error.to_string()).into()))],
    })
}

/// The line of a record that an error is about.
fn excerpt(record: &[u8], first: usize, error: &Error) -> Option<Excerpt> {
    Excerpt::around(record, first, error.location()?)
}

/// States of a recording as tasks.
#[derive(Debug)]
pub struct Recording<I> {
    states: I,
    /// Why the input ended early; reported after what came before.
    broken: Option<String>,
}

impl<I: Iterator<Item = Recorded> + Send> Recording<I> {
    /// The tasks of `states`, which come from [`samples`].
    pub fn new(states: I) -> Self {
        Self { states, broken: None }
    }
}

impl<I: Iterator<Item = Recorded> + Send> Source for Recording<I> {
    type Task = Vec<Recorded>;

    fn next(&mut self) -> io::Result<Option<Vec<Recorded>>> {
        let mut task = Vec::new();
        while self.broken.is_none() && task.len() < STATES {
            let Some(recorded) = self.states.next() else { break };
            match recorded.state.as_ref().map_err(Error::reason) {
                Err(Reason::Io(reason)) => self.broken = Some(reason.clone()),
                _ => task.push(recorded),
            }
        }
        match &self.broken {
            Some(reason) if task.is_empty() => Err(io::Error::other(reason.clone())),
            _ => Ok((!task.is_empty()).then_some(task)),
        }
    }

    fn keeps_waiting(&self) -> bool {
        false
    }
}
