//! The page of a study. It shows the samples; with one parameter, also both sides and the middle of every region.
//!
//! ```text
//!     a region         |.........|.........|      the sides are farther from the borders than these are uncertain
//! ```

use super::{MOST, Page, PageAxis, PageRegion, PageState, Weight};
use crate::draw::plot::{Color, Rendered, significant};
use crate::draw::sweep::{different, fills_along, fills_of_map};
use crate::draw::{Forward, Keyframe};
use crate::error::visible;
use crate::state::State;
use crate::sweep::{
    BorderCurve, Findings, Map, Parameter, RESOLUTION, Regime, Region, RobotStudy, Solver, Survey, Workers,
};
use crate::write::sweep::{MapRegion, MapSweep, RegionRecord, Sweep};

/// The distance of the sides of a region from its borders, as a share of the parameter's range.
const AWAY: f64 = 4.0 * RESOLUTION;

/// The values of the parameters at which a page shows the state of a study.
#[derive(Debug, Clone)]
pub struct Stops {
    /// The values of each parameter. The page has a state for each combination.
    values: Vec<Vec<f64>>,
    /// For each parameter, n if the page shows one of n samples.
    every: Vec<usize>,
}

impl Stops {
    /// Chooses the stops of a study.
    pub fn new(model: &RobotStudy, findings: &Findings) -> Self {
        let parameters = model.study.parameters();
        let mut every = vec![1; parameters.len()];
        let samples = |every: &[usize]| -> Vec<Vec<f64>> {
            let samples = parameters.iter().zip(every).map(|(parameter, every)| {
                let last = parameter.steps - 1;
                (0..last).step_by(*every).chain([last]).map(|index| parameter.sample(index)).collect()
            });
            samples.collect()
        };
        let mut values = samples(&every);
        while values.iter().map(Vec::len).product::<usize>() > MOST {
            // Thin out the parameter with the most stops until the page is small enough.
            let last = values.len() - 1;
            every[if values[0].len() < values[last].len() { last } else { 0 }] += 1;
            values = samples(&every);
        }
        if let (Findings::Along(survey), [parameter], [values]) = (findings, parameters, &mut values[..]) {
            // Add both sides and the middle of every region.
            let away = AWAY * parameter.range();
            values.extend(survey.regions.iter().flat_map(|&Region { from, to, .. }| {
                let sides = [from + away, 0.5 * (from + to), to - away];
                sides.into_iter().filter(move |side| from < *side && *side < to)
            }));
            values.sort_unstable_by(f64::total_cmp);
            values.dedup();
        }
        Self { values, every }
    }

    /// Returns the number of stops.
    pub fn count(&self) -> usize {
        self.values.iter().map(Vec::len).product()
    }

    /// Returns the values of the parameters at a stop. The last parameter changes fastest.
    fn point(&self, mut index: usize) -> Vec<f64> {
        let mut point = vec![0.0; self.values.len()];
        for (value, values) in point.iter_mut().zip(&self.values).rev() {
            *value = values[index % values.len()];
            index /= values.len();
        }
        point
    }

    fn note(&self, parameters: &[Parameter]) -> Option<String> {
        let thinned = parameters.iter().zip(&self.every).filter(|(_, every)| **every > 1);
        let parts: Vec<String> =
            thinned.map(|(parameter, every)| format!("one of {every} samples of {}", parameter.name)).collect();
        (!parts.is_empty()).then(|| format!("this page stops at {}", parts.join(" and ")))
    }
}

impl Page {
    /// Creates the page of a study from its findings, stops and picture. Each stop is reported to `workers`.
    pub fn of_study(
        model: &RobotStudy,
        found: &Findings,
        stops: &Stops,
        rendered: Rendered,
        forward: Forward,
        workers: Workers,
    ) -> Self {
        let parameters = model.study.parameters();
        let look = |solver: &mut _, index| look(model, solver, &stops.point(index));
        let seen = workers.map(stops.count(), || Solver::new(model), look);
        let (regions, notes) = match &forward.findings(found) {
            Findings::Along(survey) => along(Sweep::new(model.study, survey), survey),
            Findings::Map(map) => areas(MapSweep::new(model.study, map), map),
        };
        let state = |(index, (mut keyframe, regime)): (usize, (Keyframe, Regime))| {
            keyframe.face(forward);
            let region = match found {
                Findings::Along(survey) => {
                    let at = stops.point(index)[0];
                    let region = survey.regions.partition_point(|region| region.to <= at);
                    Some(region.min(survey.regions.len().saturating_sub(1)))
                }
                Findings::Map(map) => map.areas.iter().position(|area| *area.regime == regime),
            };
            PageState { region, keyframe, name: None }
        };
        let states: Vec<PageState> = seen.into_iter().enumerate().map(state).collect();
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let title = format!("{} against {}{}", visible(&model.robot.name), names.join(" and "), forward.remark());
        let axis = |(name, values): (&str, &Vec<f64>)| PageAxis { name: name.to_owned(), values: values.clone() };
        let axes = names.into_iter().zip(&stops.values).map(axis).collect();
        let notes = stops.note(parameters).into_iter().chain(notes).collect();
        Self { title, axes, regions, notes, ..Self::of(&states, Weight::ALIKE, rendered) }
    }
}

/// Returns the keyframe and the regime at a point. The uncertainty of the state is ignored.
fn look(model: &RobotStudy, solver: &mut Solver, point: &[f64]) -> (Keyframe, Regime) {
    let seen = solver.at(point, |robot, state, pipeline| {
        let state = State { uncertainty: None, ..state };
        let impact = pipeline.answer(&state)?;
        Ok((Keyframe::of_impact(robot, &model.options.feet, &state, &impact), Regime::of(&Ok(impact))))
    });
    seen.unwrap_or_else(|error| (Keyframe::refused(error.clone()), Regime::of(&Err(error))))
}

fn along(sweep: Sweep, survey: &Survey) -> (Vec<PageRegion>, Vec<String>) {
    let border = |at: Option<usize>, side: &str| {
        let border = sweep.borders.get(at?)?;
        let sides = [at?, at? + 1].map(|at| (&*sweep.regions[at].letter, &sweep.regions[at].happening));
        let at = sweep.place(border.at, |at| significant(at, 9).to_string());
        Some([format!("{side}, at {at}"), border.transition.in_words(sides)])
    };
    let fills = fills_along(survey);
    let region = |(at, region): (usize, &RegionRecord)| PageRegion {
        name: region.letter.clone(),
        fill: fills[survey.regions[at].kind].hex(),
        borders: [border(at.checked_sub(1), "below"), border(Some(at), "above")].into_iter().flatten().collect(),
    };
    (sweep.regions.iter().enumerate().map(region).collect(), sweep.notes)
}

fn areas(sweep: MapSweep, map: &Map) -> (Vec<PageRegion>, Vec<String>) {
    let region = |(region, fill): (&MapRegion, Color)| {
        let border = |border: &BorderCurve| {
            let sides = border.sides.map(|at| (&*sweep.regions[at].letter, &sweep.regions[at].happening));
            let beyond = match sides.map(|(letter, _)| letter) {
                [left, right] if left == region.letter => right,
                [left, right] if right == region.letter => left,
                _ => return None,
            };
            Some([format!("toward {beyond}"), border.transition.in_words(sides)])
        };
        let borders = different(sweep.borders.iter().filter_map(border));
        PageRegion { name: region.letter.clone(), fill: fill.hex(), borders }
    };
    (sweep.regions.iter().zip(fills_of_map(map)).map(region).collect(), sweep.notes)
}
