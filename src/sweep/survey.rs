//! The regions of a study with one parameter, and the transitions between them.

use super::line::{Along, Bracket, Probe, RESOLUTION, Stretch, brackets, stretches};
use super::model::{RobotStudy, Solver};
use super::parallel::Workers;
use super::regime::Regime;
use super::transition::Transition;
use crate::Error;
use crate::impact::Verdict;
use serde::Serialize;
use std::sync::Arc;

/// All regions along one parameter.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Survey {
    /// The regions from the least to the greatest value. Each has positive width; neighbors differ.
    pub regions: Vec<Region>,
    /// The borders between neighboring regions.
    pub borders: Vec<RegionBorder>,
    /// Whether contacts depend on each other somewhere. Combinations without a unique solution are not followed.
    pub dependent: bool,
    /// Oddities of the states in the middle and at the ends of the range, in sentences.
    pub oddities: Vec<String>,
}

/// A stretch of the parameter with one set of outcomes.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Region {
    /// The least value of the parameter.
    pub from: f64,
    /// The greatest value of the parameter.
    pub to: f64,
    /// The regime of all points of the region.
    pub regime: Arc<Regime>,
    /// The number of its regime: from 0, in the order in which regimes first occur.
    pub kind: usize,
    /// The verdict at its middle; at a sample where something strikes if nothing does there. `None` if it is refused.
    pub verdict: Option<Verdict>,
    /// The reason why its middle is refused, if it is.
    pub refused: Option<Error>,
}

/// A border between two regions.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RegionBorder {
    /// Where it is, to [`RESOLUTION`] of the parameter's range.
    pub at: f64,
    /// What happens there.
    #[serde(flatten)]
    pub transition: Transition,
}

impl Survey {
    /// Computes the regions of `model`, whose study has one parameter; reports [`Survey::work`] pieces of work to
    /// `workers`.
    pub fn of(model: &RobotStudy, workers: Workers) -> Self {
        let Some(parameter) = model.study.parameters().first() else { return Self::default() };
        let resolution = RESOLUTION * parameter.range();
        let begin = || Solver::new(model);
        let sample = |solver: &mut Solver, index: usize| {
            let at = parameter.sample(index);
            Probe { at, regime: solver.regime(&[at]) }
        };
        let samples = workers.map(parameter.steps, begin, sample);
        let between = |solver: &mut Solver, index: usize| {
            brackets(&mut Along { solver, place: |at| vec![at] }, &samples[index], &samples[index + 1], resolution)
        };
        let found = workers.map(parameter.steps - 1, begin, between).concat();
        let (first, last) = (samples[0].clone(), samples[parameter.steps - 1].clone());
        let (stretches, brackets) = stretches(first, last, &found, resolution);

        let mut solver = begin();
        let mut kinds: Vec<Arc<Regime>> = Vec::new();
        let mut dependent = false;
        let mut region = |(index, [Probe { at: begin, regime }, _]): (usize, Stretch)| {
            let from = index.checked_sub(1).map_or(samples[0].at, |before| brackets[before].at());
            let to = brackets.get(index).map_or(parameter.to, Bracket::at);
            let kind = kinds.iter().position(|known| *known == regime).unwrap_or_else(|| {
                kinds.push(Arc::clone(&regime));
                kinds.len() - 1
            });
            // The middle may lie in a thinner region that was not found; the regime of the beginning is known.
            let middle = 0.5 * (from + to);
            let at = if solver.regime(&[middle]) == regime { middle } else { begin };
            let inside = samples.iter().filter(|sample| sample.regime == regime && (from..=to).contains(&sample.at));
            let inner = solver.inner(&[at], inside.map(|sample| vec![sample.at]));
            dependent |= inner.dependent;
            Region { from, to, regime, kind, verdict: inner.verdict, refused: inner.refused }
        };
        let regions: Vec<Region> = stretches.into_iter().enumerate().map(&mut region).collect();
        let border = |solver: &mut Solver, index: usize| {
            let bracket = &brackets[index];
            RegionBorder { at: bracket.at(), transition: Transition::at(solver, bracket, |at| vec![at]) }
        };
        let quiet = Workers { done: &|| (), ..workers };
        let borders = quiet.map(brackets.len(), begin, border);
        let mut oddities = model.oddities();
        oddities.extend(if regions.len() == 1 { model.idle_parameter() } else { None });
        Self { regions, borders, dependent, oddities }
    }

    /// Returns the number of pieces of work for a survey of `model`.
    pub fn work(model: &RobotStudy) -> usize {
        model.study.parameters().first().map_or(0, |parameter| 2 * parameter.steps - 1)
    }
}
