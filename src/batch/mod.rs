//! Many states, one line each.
//!
//! Nothing here opens a file: lines come in, lines go out.

use crate::documents::utf8;
use crate::pipeline::{Options, Pipeline};
use crate::report::{self, Detail, Refused, Report};
use crate::state::{Defaults, State};
use crate::{Error, Result, Robot};

/// Answers lines of NDJSON, one state each, one after the other.
#[derive(Debug)]
pub struct Batch<'r> {
    robot: &'r Robot,
    pipeline: Pipeline<'r>,
    defaults: Defaults,
    detail: Detail,
}

/// What became of a line.
#[derive(Debug, Clone)]
pub enum Answer {
    /// It is blank and has no line in the output.
    Blank,
    /// Its result was written.
    Result,
    /// An object with the error was written in its place, or the matrices and the error; a line and column in the error are those of the line alone.
    Refused(Error),
}

impl<'r> Batch<'r> {
    /// A batch of states of `robot`.
    pub fn new(robot: &'r Robot, options: Options, defaults: Defaults, detail: Detail) -> Self {
        Self { robot, pipeline: Pipeline::new(robot, options), defaults, detail }
    }

    /// Answers one line and appends the answer, a line of JSON, to `out`; `number` counts from 1.
    pub fn line(&mut self, number: usize, line: &[u8], out: &mut Vec<u8>) -> Answer {
        if line.trim_ascii().is_empty() {
            return Answer::Blank;
        }
        match utf8(line).and_then(|text| self.result(text, out)) {
            Ok(None) => Answer::Result,
            Ok(Some(error)) => Answer::Refused(error),
            Err(error) => {
                let id = std::str::from_utf8(line).ok().and_then(State::id_in);
                report::append_line(out, &Refused::new(id, number, &error));
                Answer::Refused(error)
            }
        }
    }

    /// Appends the result of one state to `out`; gives the error that stands in it beside the matrices, if any.
    fn result(&mut self, text: &str, out: &mut Vec<u8>) -> Result<Option<Error>> {
        let state = State::from_json(text, self.robot, &self.defaults)?;
        let impact = self.pipeline.impact(&state)?;
        Report::of_state(self.robot, &state, &impact, self.detail)?.append_json(self.detail, out);
        Ok(impact.analysis.err())
    }
}
