//! Answers many states, one per line or row.
//!
//! ```text
//!     lines, CSV --[chunk]--> chunks of records --[run]--> Batch, one per thread --> blocks of answers, in order
//!                                                            └──[summary]--> Summary of all
//! ```
//!
//! This module opens no file. Only `run` starts threads, and only on request.

mod summary;
mod run;
mod chunk;
mod recording;
mod states;

use chunk::too_long;
pub use chunk::{Chunk, Chunks, RECORD_LIMIT};
pub use recording::{RowOrigin, recorded};
pub use run::{AHEAD, Block, RefusedRecord, run};
pub use states::States;
pub use summary::{ModeCount, MoreFriction, Nearest, Needed, OddStates, Oddity, StateRef, Summary, Verdicts};

use crate::budget::TotalBudget;
use crate::draw::{Keyframe, ListedKeyframe};
use crate::error::Location;
use crate::error::excerpt::Excerpt;
use crate::gait::{Landing, Sample, Sampled};
use crate::pipeline::{AT_REST, Impact, Options, Pipeline};
use crate::read::documents::utf8;
use crate::read::lines::StateLines;
#[cfg(feature = "columnar")]
use crate::read::table::Part;
use crate::read::table::{Carried, Header, Row, Rows};
use crate::state::{Defaults, State};
use crate::write::{self, Columns, Detail, Refused, Report, Touchdown, short_id};
use crate::{Error, Reason, Result, Robot};
use serde_json::Value;

/// What to compute for all states of a batch, and in what form.
#[derive(Debug, Clone)]
pub struct Question<'r> {
    /// The robot of all states.
    pub robot: &'r Robot,
    /// Settings of the pipeline. If the friction needed is computed, the summary includes it.
    pub options: Options,
    /// Values for states that do not give their own.
    pub defaults: Defaults,
    /// The contents of a result.
    pub detail: Detail,
    /// The total time of the states that exceed their own budget; `None` for no limit.
    pub total: Option<TotalBudget>,
    /// The columns of the input table; `None` for lines of JSON.
    pub header: Option<&'r Header>,
    /// The columns of the output table; `None` for lines of JSON.
    pub columns: Option<&'r Columns>,
    /// Whether keyframes of the states are kept for a page.
    pub keyframes: bool,
}

#[cfg(feature = "columnar")]
impl Question<'_> {
    /// A state with what all rows have in common.
    fn common(&self) -> State {
        let Defaults { friction, place_lowest, ref loops } = self.defaults;
        let mut state = State::zero(self.robot);
        state.scene.friction.default = friction;
        (state.scene.place_lowest, state.scene.loops) = (place_lowest, loops.clone());
        state
    }
}

/// Rows whose states are read before they are answered, and answered before their results are written: the processor's
/// caches keep what each of these steps needs, which saves 4 % of the time.
const TOGETHER: usize = 8;

/// Limit of the memory that is reserved for the answers to a chunk \[bytes\].
const ROOM: usize = 1 << 20;

/// Answers records, in reused memory.
pub struct Batch<'q> {
    reader: Reader<'q>,
    answerer: Answerer<'q>,
    /// The states of the last rows.
    states: [State; TOGETHER],
    /// The size of the largest answers to a chunk so far, up to [`ROOM`] \[bytes\].
    most: usize,
}

/// Answers states.
struct Answerer<'q> {
    question: &'q Question<'q>,
    pipeline: Pipeline<'q>,
    /// Whether the common data of the rows of a typed table pass [`State::check`]; their cells are checked when read.
    #[cfg(feature = "columnar")]
    are_rows_checked: bool,
}

/// Reads the states of records.
enum Reader<'q> {
    Lines(Box<StateLines<'q>>),
    Rows(Rows<'q>),
}

/// The place of a state in its input.
#[derive(Debug, Clone, Copy, Default)]
struct Around<'a> {
    /// The line on which the state begins.
    line: usize,
    /// The record; empty if an excerpt was kept instead.
    record: &'a [u8],
    excerpt: Option<&'a Excerpt>,
    carried: Option<&'a Carried>,
    /// The time of a sample \[s\].
    time: Option<f64>,
    landing: Option<&'a Landing>,
}

impl Around<'_> {
    /// The time of the state, if its input gives one \[s\].
    fn time(&self, header: Option<&Header>) -> Option<f64> {
        self.time.or_else(|| {
            let (_, value) = self.carried?.by_name(header?).find(|(name, _)| *name == "time")?;
            value.number().filter(|time| time.is_finite())
        })
    }
}

impl<'q> Batch<'q> {
    /// Creates a batch whose memory grows with the first records.
    pub fn new(question: &'q Question<'q>) -> Self {
        // Keyframes need what a brief result omits.
        let brief = question.detail.brief && !question.keyframes;
        // The share of the total budget limits an answer.
        let budget = question.options.budget.filter(|_| question.total.is_none());
        let options = Options { brief, budget, ..question.options.clone() };
        let pipeline = Pipeline::new(question.robot, options);
        let lines = || Reader::Lines(Box::new(StateLines::new(question.robot, &question.defaults)));
        let reader = question.header.map_or_else(lines, |header| Reader::Rows(header.rows()));
        let states = std::array::from_fn(|_| State::zero(question.robot));
        let answerer = Answerer {
            question,
            pipeline,
            #[cfg(feature = "columnar")]
            are_rows_checked: question.common().check(question.robot).is_ok(),
        };
        Self { reader, answerer, states, most: 0 }
    }

    /// Answers records that are independent of each other.
    pub fn records(&mut self, chunk: &Chunk) -> Block {
        let Self { reader, answerer, states: [state, ..], most } = self;
        let mut block = Block { out: Vec::with_capacity(*most), ..answerer.block(chunk.records().count()) };
        for (line, record) in chunk.records() {
            let around = Around { line, record, ..Around::default() };
            match reader {
                Reader::Lines(lines) => answerer.line(lines, around, &mut block),
                Reader::Rows(rows) => {
                    if let Some(row) = rows.row(record, line).transpose() {
                        answerer.row(row, state, around, &mut block);
                    }
                }
            }
        }
        if let Some(line) = chunk.too_long {
            answerer.refuse(too_long(), None, Around { line, ..Around::default() }, &mut block);
        }
        *most = block.out.len().max(*most).min(ROOM);
        block
    }

    /// Answers the rows of a part of a table with typed columns.
    #[cfg(feature = "columnar")]
    pub fn part(&mut self, part: &Part) -> Block {
        let Self { answerer, states, .. } = self;
        let mut block = answerer.block(part.count());
        let Question { robot, defaults, header, .. } = answerer.question;
        let mut rows = header.iter().flat_map(|header| part.rows(header));
        let (mut group, mut answers) = (Vec::with_capacity(TOGETHER), Vec::with_capacity(TOGETHER));
        loop {
            group.extend(states.iter_mut().zip(&mut rows).map(|(state, row)| (row, row.read(robot, defaults, state))));
            if group.is_empty() {
                return block;
            }
            let read = states.iter().zip(group.drain(..));
            answers.extend(read.map(|(state, (row, read))| (row, read.map(|()| answerer.of_row(state)))));
            for (state, (row, answer)) in states.iter().zip(answers.drain(..)) {
                let carried = row.carried();
                let around = Around { line: row.line(), carried: carried.as_ref(), ..Around::default() };
                match answer {
                    Ok(answer) => answerer.write(state, answer, around, &mut block),
                    Err(error) => answerer.refuse(error, row.id(), around, &mut block),
                }
            }
        }
    }

    /// Answers the samples of a recording.
    pub fn samples(&mut self, samples: Vec<Sampled<RowOrigin>>) -> Block {
        let mut block = self.answerer.block(samples.len());
        for sampled in samples {
            let (origin, state, time, landing) = match sampled {
                Ok(Sample { source, state, time, landing, .. }) => (source, Ok(state), Some(time), landing),
                Err((source, error)) => (source, Err(error), None, None),
            };
            let RowOrigin { line, id, carried, excerpt } = origin;
            let (carried, excerpt, landing) = (carried.as_ref(), excerpt.as_ref(), landing.as_ref());
            let around = Around { line, record: b"", excerpt, carried, time, landing };
            self.answerer.answer(state.as_ref().map_err(Error::clone), || id, around, &mut block);
        }
        block
    }
}

impl Answerer<'_> {
    /// Answers a line of JSON, unless it is blank.
    fn line(&mut self, lines: &mut StateLines, around: Around<'_>, block: &mut Block) {
        // The line break is removed so that an error at the end of a truncated line is not located on the next line.
        let record = around.record.trim_ascii_end();
        if record.is_empty() {
            return;
        }
        let state = lines.read(record).map_err(|error| {
            // The error's location counts within the line alone.
            with_remedy(error, record).relocated(|place| Location { line: around.line, ..place })
        });
        self.answer(state, || utf8(record).ok().and_then(State::id_in), Around { record, ..around }, block);
    }

    /// An empty block for the answers to this number of records.
    fn block(&self, #[cfg_attr(not(feature = "columnar"), expect(unused_variables))] records: usize) -> Block {
        Block {
            #[cfg(feature = "columnar")]
            columns: self
                .question
                .columns
                .filter(|columns| !columns.form().is_text())
                .map(|columns| write::ColumnBlock::new(columns, records)),
            summary: Summary { question: self.question.options.aspect, ..Summary::default() },
            ..Block::default()
        }
    }

    /// Answers a row of a table.
    fn row(&mut self, row: Result<Row<'_>>, state: &mut State, around: Around<'_>, block: &mut Block) {
        let Question { robot, defaults, header, .. } = self.question;
        match row {
            Ok(row) => {
                let carried = row.carried();
                let around = Around { carried: carried.as_ref(), ..around };
                let read = row.read(robot, defaults, state);
                self.answer(read.map(|()| &*state), || row.id(), around, block);
            }
            Err(error) => self.refuse(error, header.and_then(|header| header.id_in(around.record)), around, block),
        }
    }

    /// Answers a state, or refuses it with the id that `unread` returns.
    fn answer(
        &mut self,
        state: Result<&State>,
        unread: impl FnOnce() -> Option<Value>,
        around: Around<'_>,
        block: &mut Block,
    ) {
        match state {
            Ok(state) => {
                let answer = self.impact(state);
                self.write(state, answer, around, block);
            }
            Err(error) => self.refuse(error, unread(), around, block),
        }
    }

    /// Answers a state within its share of the total budget.
    fn impact(&mut self, state: &State) -> Result<Box<Impact>> {
        self.within_budget(|pipeline| pipeline.answer(state))
    }

    /// As [`Answerer::impact`] for the state of a row of a typed table.
    #[cfg(feature = "columnar")]
    fn of_row(&mut self, state: &State) -> Result<Box<Impact>> {
        if !self.are_rows_checked {
            return self.impact(state);
        }
        self.within_budget(|pipeline| pipeline.answer_checked(state))
    }

    fn within_budget<R>(&mut self, answer: impl FnOnce(&mut Pipeline) -> R) -> R {
        match &self.question.total {
            Some(total) => total.within(|| answer(&mut self.pipeline)),
            None => answer(&mut self.pipeline),
        }
    }

    /// Appends the answer to a state, or its refusal.
    fn write(&mut self, state: &State, answer: Result<Box<Impact>>, around: Around<'_>, block: &mut Block) {
        if let Err(error) = self.result(state, answer, around, block) {
            self.refuse(error, state.id.clone(), around, block);
        }
    }

    /// Appends the result of a state.
    fn result(
        &mut self,
        state: &State,
        answer: Result<Box<Impact>>,
        around: Around<'_>,
        block: &mut Block,
    ) -> Result<()> {
        let Question { robot, ref options, detail, header, columns, .. } = *self.question;
        block.summary.own_friction += u64::from(state.scene.has_own_friction(self.question.defaults.friction));
        // The contacts of a touchdown are found, not named by the input.
        let own_contacts = state.scene.contacts.is_some() && around.landing.is_none();
        block.summary.own_contacts += u64::from(own_contacts && !options.feet.is_empty());
        // The error is only borrowed, because it is large.
        let impact = answer.as_ref().map_err(|error| match error.reason() {
            Reason::Missing(_) if header.is_some() && error.place() == Some("friction") => {
                error.clone().hint("add a column friction, or give `friction: 0.8` (or infinite)")
            }
            _ => error.clone(),
        })?;
        let landing = around.landing.zip(around.time);
        let touchdown = landing.and_then(|(landing, time)| Touchdown::of(robot, state, landing, around.line, time));
        if let Some(columns) = columns {
            let named = (state.id.as_ref(), Some(around.line), touchdown.as_ref());
            match block.rows() {
                run::Rows::Text(rows) => columns.append_result(named, impact, around.carried, rows)?,
                #[cfg(feature = "columnar")]
                run::Rows::Columns(rows) => columns.append_result(named, impact, around.carried, rows)?,
            }
        } else {
            let mut report = Report::of_state(robot, state, impact, detail)?;
            (report.line, report.touchdown) = (Some(around.line), touchdown);
            let fields = header.zip(around.carried).into_iter().flat_map(|(header, carried)| {
                carried.by_name(header).filter(|(name, _)| !detail.brief || header.is_foreign(name))
            });
            let mut fields = fields.map(|(name, value)| (name.to_owned(), value)).peekable();
            report.carried = fields.peek().is_some().then(|| fields.collect());
            report.append_json(detail, &mut block.out);
        }
        self.keep(state.id.as_ref(), around, block, || {
            Keyframe::of_impact(robot, &self.question.options.feet, state, impact)
        });
        if let Some(landing) = around.landing {
            block.summary.early += u64::from(landing.is_early);
            block.summary.slowed += u64::from(landing.is_slowed);
            block.summary.deep += u64::from(landing.is_deep);
            block.summary.crowded += u64::from(landing.is_crowded);
        }
        let place = || StateRef { id: state.id.clone().map(short_id), line: around.line };
        if !impact.notes.is_empty() {
            // Notes on odd numbers come first in the list.
            let odd = state.oddities(robot);
            // The verdict already states that nothing touches.
            let mut others = impact.notes.iter().skip(odd.len()).filter(|_| !impact.contacts.is_empty());
            let other = others.find(|note| !note.contains(AT_REST)).cloned();
            let of = |what| OddStates { states: 1, first: Some(Oddity { state: place(), what }) };
            block.summary.odd_states.add(odd.into_iter().next().map(of).unwrap_or_default());
            block.summary.noted.add(other.map(of).unwrap_or_default());
        }
        match impact.analyzed() {
            Ok(analysis) => {
                block.summary.no_strike +=
                    u64::from(around.landing.is_some() && analysis.verdict == crate::impact::Verdict::NoImpact);
                block.summary.count(place, impact, analysis);
            }
            // The result contains this error next to the matrices.
            Err(error) => block.refuse(error, around),
        }
        answer.map(|impact| self.pipeline.recycle(impact))
    }

    fn refuse(&self, error: Error, id: Option<Value>, around: Around<'_>, block: &mut Block) {
        self.keep(id.as_ref(), around, block, || Keyframe::refused(error.clone()));
        let refused = Refused::new(id, around.line, &error);
        match self.question.columns {
            Some(columns) => match block.rows() {
                run::Rows::Text(rows) => columns.append_refused(&refused, around.carried, rows),
                #[cfg(feature = "columnar")]
                run::Rows::Columns(rows) => columns.append_refused(&refused, around.carried, rows),
            },
            None => write::append_line(&mut block.out, &refused),
        }
        block.refuse(error, around);
    }

    /// Keeps a keyframe of the state, if requested.
    fn keep(&self, id: Option<&Value>, around: Around<'_>, block: &mut Block, keyframe: impl FnOnce() -> Keyframe) {
        if self.question.keyframes {
            let id = id.cloned().map(short_id);
            let time = around.time(self.question.header);
            block.keyframes.push(ListedKeyframe { line: around.line, id, time, keyframe: keyframe() });
        }
    }
}

/// Adds a hint to the error if the line is one of a table, or holds no whole state or several.
fn with_remedy(error: Error, record: &[u8]) -> Error {
    // The names of a table's columns begin like this.
    let is_column = |name: &[u8]| name.starts_with(b"q_") || name.starts_with(b"v_");
    let hint = match error.reason() {
        _ if record.trim_ascii_start().starts_with(b"[") => {
            "each line must hold one state; `jq -c '.[]'` takes a list apart"
        }
        Reason::Syntax(reason) if reason.starts_with("EOF while parsing") => {
            "each line must hold a whole state; `jq -c .` writes JSON so"
        }
        Reason::Syntax(reason) if reason == "trailing characters" => "a line holds one state and nothing after it",
        Reason::Syntax(_) if record.split(|byte| b",;\t".contains(byte)).any(is_column) => {
            match record.iter().find(|byte| b",;\t".contains(byte)) {
                Some(b';') => {
                    "is this a table? save it with commas between columns and points in numbers, and say \
                     `input_format: csv`"
                }
                Some(b'\t') => "is this a table? then say `input_format: tsv`",
                _ => "is this a table? then say `input_format: csv`",
            }
        }
        _ => return error,
    };
    error.hint(hint)
}

impl Block {
    /// Counts and stores a refusal.
    fn refuse(&mut self, error: Error, around: Around<'_>) {
        self.summary.states += 1;
        self.summary.refused += 1;
        let place = error.location();
        let kept = |place| around.excerpt.cloned().or_else(|| Excerpt::around(around.record, around.line, place));
        let excerpt = place.and_then(kept);
        let error = if place.is_some() { error } else { error.on(around.line, 1) };
        self.refused.push(RefusedRecord { error, excerpt });
    }
}
