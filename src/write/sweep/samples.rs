//! The samples of a study, each as an object or as rows of a table.

use super::super::Columns;
use super::super::{Detail, ErrorObject, Report, append_line};
use crate::pipeline::Pipeline;
use crate::read::table::Carried;
use crate::state::NamedContact;
use crate::state::State;
use crate::sweep::{Regime, RobotStudy, Solver};
use crate::{Result, Robot};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::value::RawValue;

/// A sample: the parameters' values and the result there.
#[derive(Debug, Clone)]
pub struct Sample<'a> {
    /// The parameters' names.
    pub names: Vec<&'a str>,
    /// Their values.
    pub point: Vec<f64>,
    /// Its number, from 0.
    pub index: usize,
}

/// The record of a refused sample.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct RefusedSample {
    /// Why.
    error: ErrorObject,
}

impl<'a> Sample<'a> {
    /// Sample number `index` of a study; the last parameter changes fastest.
    pub fn new(model: &RobotStudy<'a>, index: usize) -> Self {
        let mut rest = index;
        let parameters = model.study.parameters();
        let mut point = vec![0.0; parameters.len()];
        for (parameter, value) in parameters.iter().zip(&mut point).rev() {
            *value = parameter.sample(rest % parameter.steps);
            rest /= parameter.steps;
        }
        Self { names: parameters.iter().map(|parameter| parameter.name.as_str()).collect(), point, index }
    }

    /// How many samples a study has.
    pub fn count(model: &RobotStudy) -> usize {
        model.study.parameters().iter().map(|parameter| parameter.steps).product()
    }

    /// Appends `{"alpha": ..., "result": {...}}` without a line break; returns whether it was answered.
    pub fn append_json(&self, solver: &mut Solver, detail: Detail, out: &mut Vec<u8>) -> bool {
        let mut result = Vec::new();
        let answered = solver.at(&self.point, |robot, state, pipeline| {
            answer(robot, &state, pipeline, detail, |report| report.append_json(detail, &mut result))
        });
        if let Err(error) = &answered
            && result.is_empty()
        {
            append_line(&mut result, &RefusedSample { error: ErrorObject::new(error) });
        }
        let result = String::from_utf8(result).ok().and_then(|text| RawValue::from_string(text.trim_end().into()).ok());
        append_line(out, &SampleRecord { sample: self, result: result.as_deref() });
        // The line break is the list's.
        out.pop();
        answered.is_ok()
    }

    /// Appends the rows of the sample, with the letter that `letter` gives to its regime; returns whether it was
    /// answered.
    pub fn append_rows(
        &self,
        solver: &mut Solver,
        columns: &Columns,
        letter: impl Fn(&Regime) -> String,
        out: &mut Vec<u8>,
    ) -> bool {
        let values = || self.point.iter().map(|value| format!("{value:?}"));
        let answered = solver.at(&self.point, |robot, state, pipeline| {
            let impact = pipeline.impact(&state);
            let carried = Carried::new(values().chain([letter(&Regime::of(&impact))]));
            let impact = impact?;
            columns.append_result(&Report::of_state(robot, &state, &impact, Detail::default())?, Some(&carried), out)
        });
        match answered {
            Ok(()) => true,
            Err(error) => {
                let regime = Regime::of(&Err(error.clone()));
                let carried = Carried::new(values().chain([letter(&regime)]));
                columns.append_error(None, "", &ErrorObject::new(&error), Some(&carried), out);
                false
            }
        }
    }
}

/// Reports a state.
fn answer(
    robot: &Robot,
    state: &State,
    pipeline: &mut Pipeline<'_>,
    detail: Detail,
    write: impl FnOnce(&Report),
) -> Result<()> {
    let impact = pipeline.impact(state)?;
    write(&Report::of_state(robot, state, &impact, detail)?);
    impact.analysed().map(drop)
}

/// The columns of a table of samples: those of a batch, then the parameters and the region's letter; `contacts` are
/// those that occur.
pub fn columns<'c>(model: &'c RobotStudy, feet: &[NamedContact], contacts: impl Iterator<Item = &'c str>) -> Columns {
    let parameters = model.study.parameters().iter().map(|parameter| parameter.name.as_str());
    Columns::with(model.robot, feet, contacts, parameters.chain(["region"]), false)
}

/// A sample with its result.
struct SampleRecord<'a> {
    sample: &'a Sample<'a>,
    result: Option<&'a RawValue>,
}

impl Serialize for SampleRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (name, value) in self.sample.names.iter().zip(&self.sample.point) {
            map.serialize_entry(name, value)?;
        }
        map.serialize_entry("result", &self.result)?;
        map.end()
    }
}
