//! The samples of a study, as JSON objects or as rows of a table.

use crate::read::table::Carried;
use crate::state::NamedContact;
use crate::sweep::{Parameter, Regime, RobotStudy, Solver};
use crate::write::text_row::number_text;
use crate::write::{Columns, Detail, ErrorObject, Kind, Layout, Report, RowSink, append_line};
use crate::{Impact, Result};
use serde::Serialize;
use serde_json::json;

/// A sample of a study, given by the values of the parameters.
#[derive(Debug, Clone)]
pub struct SampleRecord<'a> {
    /// The parameters.
    pub parameters: &'a [Parameter],
    /// The parameters' values.
    pub point: Vec<f64>,
    /// The sample's number, from 0.
    pub index: usize,
}

/// The record of a refused sample.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct RefusedSample {
    /// Why.
    error: ErrorObject,
}

impl<'a> SampleRecord<'a> {
    /// Creates sample number `index` of a study; the last parameter changes fastest.
    pub fn new(model: &RobotStudy<'a>, index: usize) -> Self {
        let (parameters, mut rest) = (model.study.parameters(), index);
        let mut point = vec![0.0; parameters.len()];
        for (parameter, value) in parameters.iter().zip(&mut point).rev() {
            *value = parameter.sample(rest % parameter.steps);
            rest /= parameter.steps;
        }
        Self { parameters, point, index }
    }

    /// Returns the number of samples of a study.
    pub fn count(model: &RobotStudy) -> usize {
        model.study.parameters().iter().map(|parameter| parameter.steps).product()
    }

    /// Returns whether the sample has an answer, not a refusal.
    pub fn is_answered(&self, solver: &mut Solver) -> bool {
        solver.at(&self.point, |_, state, pipeline| pipeline.outcomes(&state)?.analyzed().map(drop)).is_ok()
    }

    /// Appends `{"alpha": ..., "result": {...}}` without a line break; returns whether the sample was answered.
    pub fn append_json(&self, solver: &mut Solver, detail: Detail, out: &mut Vec<u8>) -> bool {
        let mut result = Vec::new();
        let answered = solver.at(&self.point, |robot, state, pipeline| -> Result<()> {
            let impact = pipeline.answer(&state)?;
            Report::of_state(robot, &state, &impact, detail)?.append_json(detail, &mut result);
            impact.analyzed().map(drop)
        });
        let refused = answered.err();
        if let Some(error) = refused.as_ref().filter(|_| result.is_empty()) {
            append_line(&mut result, &RefusedSample { error: ErrorObject::new(error) });
        }
        out.push(b'{');
        for (parameter, value) in self.parameters.iter().zip(&self.point) {
            out.extend(format!("{}:{},", json!(parameter.name), json!(value)).bytes());
        }
        out.extend(b"\"result\":".iter().chain(result.trim_ascii_end()).chain(b"}"));
        refused.is_none()
    }

    /// Appends the sample's rows; `letter` gives the letter of its regime. Returns whether the sample was answered.
    pub fn append_rows(
        &self,
        solver: &mut Solver,
        columns: &Columns,
        letter: impl Fn(&Regime) -> String,
        out: &mut impl RowSink,
    ) -> bool {
        let values = || self.point.iter().map(|&value| number_text(value));
        let carried = |impact: &Result<Box<Impact>>| Carried::new(values().chain([letter(&Regime::of(impact))]));
        let answered = solver.at(&self.point, |_, state, pipeline| {
            let impact = pipeline.answer(&state);
            let carried = carried(&impact);
            let impact = impact?;
            columns.append_result((state.id.as_ref(), None, None), &impact, Some(&carried), out)
        });
        let Err(error) = answered else { return true };
        let sentence = ErrorObject::new(&error).to_string();
        columns.append_error((None, None, Some(&carried(&Err(error)))), &sentence, out);
        false
    }
}

/// Creates the columns of a batch with these `contacts`, then the parameters and the letter of the region. The study
/// says whether impacts or forces are asked about.
pub fn columns<'c>(
    model: &'c RobotStudy,
    feet: &[NamedContact],
    contacts: impl Iterator<Item = &'c str>,
    layout: Layout,
) -> Columns {
    let parameters = model.study.parameters().iter().map(|parameter| (parameter.name.as_str(), Kind::Number));
    let through: Vec<_> = parameters.chain([("region", Kind::Text)]).collect();
    let layout = Layout { aspect: model.study.question(), ..layout };
    Columns::without_lines(model.robot, feet, &contacts.collect::<Vec<_>>(), &through, layout)
}
