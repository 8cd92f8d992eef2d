//! Pictures of answers as SVG, and the answers as text for people.

use crate::robot::{Asked, Model};
use crate::study::{Work, studied};
use crate::values::refused;
use crate::watch::without_python;
use heelstrike::cli::threads;
use heelstrike::draw::robot::picture;
use heelstrike::draw::{Forward, sweep};
use heelstrike::pipeline::Aspect;
use heelstrike::write::sweep::Regions;
use heelstrike::write::{Palette, Subject, text};
use heelstrike::{Detail, Inspection};
use pyo3::prelude::*;
use std::time::Duration;

/// A picture as SVG, if there is something to draw, and text.
type Shown = (Option<String>, String);

pub fn robot(model: &Model) -> Shown {
    let Model { robot, options, .. } = model;
    let text = Inspection::new(robot, &options.feet).text(&Palette::default(), true);
    (picture::robot(robot, &options.feet, Forward::Along).svg(), text)
}

/// Answers a state or a study again, and draws the answer. A study has a number of threads and a budget \[s\].
pub fn answer(
    py: Python<'_>,
    model: &Model,
    (kind, question): (&str, &str),
    friction: Option<&str>,
    (count, budget): (Option<usize>, Option<f64>),
) -> PyResult<Shown> {
    let friction = friction.and_then(|friction| friction.parse().ok());
    let Model { robot, options, .. } = model;
    let made = || {
        if kind == "sweep" {
            let budget = budget.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
            let work = Work { friction, threads: threads(count.unwrap_or(0)), budget };
            let drawn = studied(model, question, work, |study, findings, workers| {
                let text = Regions::new(study.study, findings).text(robot.name(), &Palette::default());
                (sweep::of(study, findings, Forward::Along, workers).svg(), text)
            });
            return Ok(drawn?.0);
        }
        let aspect = if kind == "forces" { Aspect::Forces } else { Aspect::Impact };
        let asked = Asked { aspect, friction, detail: Detail::default(), next: false };
        let shown = model.answer(question, asked, |state, impact, report| {
            let subject = Subject::of_state(robot, state, impact);
            let text = text(report, &subject, Detail::default(), &Palette::default());
            (
                picture::impact(robot, &options.feet, state, impact, Forward::Along).and_then(|picture| picture.svg()),
                text,
            )
        });
        Ok(shown?.1)
    };
    without_python(py, made)?.map_err(refused)
}
