//! Sweeps, touchdowns and contact problems, as the command answers them.

use crate::robot::{Limit, Robot, friction};
use crate::values::{from_json, refused, refused_in, to_json, warn};
use crate::watch::{self, budget, interrupted, raised, shared, without_python};
use heelstrike::batch::{Batch, Question, States, Summary, recorded};
use heelstrike::budget::TotalBudget;
use heelstrike::cli::{RecordingOptions, Seconds, records, seconds, threads};
use heelstrike::impact::{AnalysisOptions, Scratch};
use heelstrike::read::Problem;
use heelstrike::read::table::{Form, Parts};
use heelstrike::sweep::{Findings, RobotStudy, Solver, Workers};
use heelstrike::write::notes;
use heelstrike::write::sweep::{Regions, SampleRecord};
use heelstrike::{Defaults, Detail, Error, Friction, Reason, Report, Study};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fs::File;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Options for the work on a study.
#[derive(Clone, Copy)]
pub struct Work {
    pub friction: Option<Friction>,
    pub threads: usize,
    pub budget: Seconds,
}

/// Sweeps a study. Returns the result of `then`, and notes for the user.
pub fn studied<T>(
    robot: &crate::robot::Model,
    text: &str,
    work: Work,
    then: impl FnOnce(&RobotStudy, &Findings, Workers) -> T,
) -> heelstrike::Result<(T, Vec<String>)> {
    let study = Study::from_json(text)?;
    Findings::check_memory(&study)?;
    let model = RobotStudy {
        study: &study,
        description: &robot.description,
        reduction: &robot.reduction,
        robot: &robot.robot,
        options: robot.options.clone(),
        defaults: Defaults { friction: work.friction, ..Defaults::default() },
    };
    let own_friction = notes::own_friction(model.has_own_friction()?.into(), "study");
    let notes = own_friction.into_iter().chain(notes::unused(&study)).collect();
    let workers = Workers { threads: work.threads, done: &|| {} };
    let done = || then(&model, &Findings::of(&model, workers), workers);
    let made = shared(work.budget).within(done).map_err(|spent| study.beyond(spent))?;
    Ok((made, notes))
}

/// Reads a budget: a number of seconds, or `None` or "infinite" for no limit.
pub fn limit(value: &Bound<'_, PyAny>) -> PyResult<Seconds> {
    if value.is_none() {
        return Ok(None);
    }
    let text = value.extract::<f64>().map_or_else(|_| value.extract::<String>(), |number| Ok(number.to_string()))?;
    seconds(&text).map_err(|expected| PyValueError::new_err(format!("budget: {expected} or None, not {text}")))
}

pub fn sweep<'py>(
    robot: &Bound<'py, Robot>,
    study: &Bound<'py, PyAny>,
    mu: Option<&Bound<'py, PyAny>>,
    count: Option<usize>,
    budget: Seconds,
) -> PyResult<Bound<'py, PyAny>> {
    let py = robot.py();
    let text = to_json(study)?;
    let work = Work { friction: mu.map(friction).transpose()?, threads: threads(count.unwrap_or(0)), budget };
    let made = |model: &RobotStudy, findings: &Findings, workers: Workers| {
        let mut out = Vec::new();
        if raised() {
            return out;
        }
        Regions::new(model.study, findings).append_head(&mut out);
        let answer = |solver: &mut Solver, index: usize| {
            let mut sample = Vec::new();
            SampleRecord::new(model, index).append_json(solver, Detail::default(), &mut sample);
            sample
        };
        let samples = workers.map(SampleRecord::count(model), || Solver::new(model), answer);
        out.extend(samples.join(&b','));
        out.extend(b"]}");
        out
    };
    let model = &robot.get().model;
    let made = without_python(py, || studied(model, &text, work, made))?;
    let (out, notes) = made.map_err(|error| refused_in(study, error))?;
    warn(py, notes)?;
    let mu = work.friction.map(|own| own.to_string());
    from_json(
        py,
        &out,
        Some((robot, "sweep", text, mu, count, budget.map(|own| own.as_secs_f64())).into_pyobject(py)?.into_any()),
    )
}

pub fn touchdowns<'py>(
    robot: &Bound<'py, Robot>,
    table: &Bound<'py, PyAny>,
    mu: Option<&Bound<'py, PyAny>>,
    recording: &RecordingOptions,
    foreign: &[String],
) -> PyResult<Bound<'py, PyAny>> {
    let py = robot.py();
    let path = table.extract::<PathBuf>().ok();
    let format = path.as_deref().and_then(records);
    let states = match (path, format) {
        (Some(path), Some(format)) if !format.is_text() => Parts::open(File::open(path)?, format).map(States::Columns),
        _ => {
            let text = py.import("heelstrike._values")?.call_method1("to_csv", (table,))?;
            States::of_text(Cursor::new(text.extract::<Vec<u8>>()?), format.unwrap_or(Form::Csv))
        }
    };
    let states = states.map_err(refused)?;
    let defaults = Defaults { friction: mu.map(friction).transpose()?, ..Defaults::default() };
    let model = &robot.get().model;
    let (out, notes) = without_python(py, || found(model, states, defaults, (recording, foreign)))?.map_err(refused)?;
    warn(py, notes)?;
    from_json(py, &out, None)
}

/// The answers to the touchdowns of a table, as a JSON list, and notes for the user.
fn found(
    model: &crate::robot::Model,
    mut states: States,
    defaults: Defaults,
    (recording, foreign): (&RecordingOptions, &[String]),
) -> heelstrike::Result<(Vec<u8>, Vec<String>)> {
    let (robot, feet) = (&model.robot, &model.options.feet[..]);
    let header = states.header(robot, recording.rates(), foreign, true).map_err(|refused| refused.error)?;
    let header = header
        .ok_or_else(|| Error::new(Reason::Missing("a header, or a flat object on each line".into())))?
        .with_base()?;
    let question = Question {
        robot,
        options: model.options.clone(),
        defaults: defaults.clone(),
        detail: Detail::default(),
        total: model.budget.map(|each| TotalBudget::new(budget(Some(each)), None)),
        header: Some(&header),
        columns: None,
        keyframes: false,
    };
    let (thresholds, dropped, seen) = (recording.thresholds(robot, feet)?, Mutex::default(), Mutex::default());
    let pauses = AtomicBool::new(false);
    let rows = states.samples(&header, robot, &defaults, &pauses).take_while(|_| !interrupted());
    let rows = recording.chosen(Box::new(rows), &header, (robot, feet), thresholds, (&dropped, &seen))?;
    let (mut source, mut batch, mut lines) = (recorded(rows, &pauses), Batch::new(&question), Vec::new());
    let mut summary = Summary::default();
    while let Some(states) = source()? {
        let block = batch.samples(states);
        lines.extend(block.out);
        summary.merge(block.summary);
        if interrupted() {
            break;
        }
    }
    drop(source);
    let (dropped, seen) = (dropped.into_inner().unwrap_or_default(), seen.into_inner().unwrap_or_default());
    let of_table = notes::missing(&header).into_iter().chain(notes::left_out(&header, &dropped));
    let nothing = (summary.states == 0).then(|| recording.nothing_found(thresholds, &seen));
    let of_states = notes::own_friction(summary.own_friction, "state").into_iter().chain(summary.of_touchdowns());
    let of_motion = seen.notes(robot, thresholds);
    let total = notes::beyond_budget(question.total.as_ref());
    let refused = summary.refused;
    let refused = (refused > 0).then(|| format!("{refused} of {} touchdowns are refused: see `error`", summary.states));
    let notes = of_table.chain(of_states).chain(of_motion).chain(nothing).chain(refused).chain(total).collect();
    let lines: Vec<&[u8]> = lines.trim_ascii_end().split(|&byte| byte == b'\n').collect();
    Ok(([b"[", &*lines.join(&b','), b"]"].concat(), notes))
}

/// Every outcome of a contact problem that is given as matrices, as `heelstrike solve` writes it.
///
/// `G` is the Delassus matrix [1/kg], (2 n, 2 n), with a tangential and a normal row per contact; `c` the contact
/// velocities before [m/s], (n, 2) or (2 n,); `friction` one number from 0 to inf, or one per contact; `restitution`
/// one number from 0 to 1, or one per contact. What is not decided after `budget` seconds of processor time, None for
/// no limit, is undecided. Raises Refused.
#[pyfunction]
#[pyo3(signature = (G, c, friction, restitution = None, *, explain = false, budget = Limit(Some(Duration::from_secs(10)))))]
#[expect(non_snake_case, reason = "the name of the Delassus matrix")]
pub fn solve<'py>(
    py: Python<'py>,
    G: &Bound<'py, PyAny>,
    c: &Bound<'py, PyAny>,
    friction: &Bound<'py, PyAny>,
    restitution: Option<&Bound<'py, PyAny>>,
    explain: bool,
    budget: Limit,
) -> PyResult<Bound<'py, PyAny>> {
    let text = py.import("heelstrike._values")?.call_method1("problem", (G, c, friction, restitution))?;
    let text: String = text.extract()?;
    let detail = Detail { explain, ..Detail::default() };
    let solved = || {
        let problem = Problem::from_json(&text, &Defaults::default())?;
        let asked = AnalysisOptions { rejections: explain.into(), ..AnalysisOptions::default() };
        let analysis =
            watch::budget(budget.0).within(|| Scratch::default().analyze(&problem.contact, &problem, asked))?;
        let mut out = Vec::new();
        Report::of_problem(&problem, &analysis, detail).append_json(detail, &mut out);
        Ok(out)
    };
    from_json(py, &without_python(py, solved)?.map_err(refused)?, None)
}
