//! The outcomes of each region along the parameter, at points so close that straight lines between them look smooth.
//!
//! ```text
//!     Region --even points from border to border--> halved until the middle lies on the line --> RegionCurves
//! ```

use super::line::RESOLUTION;
use super::model::{RobotStudy, Solver};
use super::parallel::Workers;
use super::regime::Regime;
use super::survey::{Region, Survey};
use crate::impact::{Analysis, Explanation, Motion, Outcome};
use crate::law::Mode;
use std::f64::consts::PI;

/// The outcomes of one region, at ascending values of the parameter.
#[derive(Debug, Clone, Default)]
pub struct RegionCurves {
    /// The points at the region's ends and as many between them as the curves need.
    pub places: Vec<CurvePoint>,
}

/// The outcomes at one value of the parameter.
#[derive(Debug, Clone)]
pub struct CurvePoint {
    /// The value of the parameter.
    pub at: f64,
    /// The modes and motion of every outcome, in the order of modes, which all points of a region share.
    pub outcomes: Vec<(Vec<Mode>, Motion)>,
    /// The paper's section 4 for each contact, if it was requested and G is regular.
    pub explanation: Option<Explanation>,
}

/// The number of even intervals in the whole range, and the least number in a region.
const EVEN: f64 = 160.0;
const LEAST: f64 = 8.0;

/// An interval is halved if its middle is farther off the line than this fraction of the largest value.
const STRAIGHT: f64 = 5e-4;

/// The number of times that an interval is halved, at most.
const HALVINGS: usize = 7;

/// Scales of deviations: the largest velocity after the impact and largest impulse of each contact, at all points.
type Scales = Vec<f64>;

impl RegionCurves {
    /// Computes the curves of all regions found in `model`. Reports [`RegionCurves::work`] pieces of work to `workers`.
    pub fn of(model: &RobotStudy, survey: &Survey, workers: Workers) -> Vec<Self> {
        let Some(parameter) = model.study.parameters().first() else { return Vec::new() };
        let range = parameter.range();
        let regions = survey.regions.iter().enumerate();
        let places = regions.map(|(index, region)| even(region, range).into_iter().map(move |at| (index, at)));
        let all: Vec<(usize, f64)> = places.flatten().collect();
        let begin = || Solver::new(model);
        let places = workers.map(all.len(), begin, |solver, k| {
            let (region, at) = all[k];
            CurvePoint::of(solver, at, &survey.regions[region].regime)
        });
        let scales = |region: &Region| vec![0.0; 2 * region.regime.contacts().len()];
        let mut scales: Vec<Scales> = survey.regions.iter().map(scales).collect();
        for ((region, _), place) in all.iter().zip(&places) {
            place.iter().for_each(|place| place.widen(&mut scales[*region]));
        }
        let more = workers.map(all.len(), begin, |solver, k| {
            let region = all[k].0;
            match (&places[k], places.get(k + 1)) {
                (Some(a), Some(Some(b))) if region == all[k + 1].0 => {
                    between(solver, (a, b), &survey.regions[region].regime, &scales[region], HALVINGS)
                }
                _ => Vec::new(),
            }
        });
        let mut courses = vec![Self::default(); survey.regions.len()];
        for (((region, _), place), more) in all.iter().zip(places).zip(more) {
            courses[*region].places.extend(place.into_iter().chain(more));
        }
        courses
    }

    /// Returns the number of pieces of work for the curves of a survey of `model`.
    pub fn work(model: &RobotStudy, survey: &Survey) -> usize {
        let range = model.study.parameters().first().map_or(0.0, |parameter| parameter.range());
        2 * survey.regions.iter().map(|region| even(region, range).len()).sum::<usize>()
    }
}

/// Returns evenly spaced places in a region, from just inside one border to just inside the other.
fn even(region: &Region, range: f64) -> Vec<f64> {
    let width = region.to - region.from;
    let inside = (RESOLUTION * range).min(0.25 * width);
    let (from, to) = (region.from + inside, region.to - inside);
    let count = (EVEN * width / range).ceil().max(LEAST);
    (0..=count as usize).map(|k| from + (to - from) * (k as f64 / count)).collect()
}

/// Returns the points between two neighbors that straight lines need.
fn between(
    solver: &mut Solver,
    (a, b): (&CurvePoint, &CurvePoint),
    regime: &Regime,
    scales: &Scales,
    halvings: usize,
) -> Vec<CurvePoint> {
    let at = 0.5 * (a.at + b.at);
    let halvings = halvings.checked_sub(1).filter(|_| a.at < at && at < b.at);
    let middle = halvings.and_then(|_| CurvePoint::of(solver, at, regime));
    let (Some(halvings), Some(middle)) = (halvings, middle.filter(|point| !point.is_on_line(a, b, scales))) else {
        return Vec::new();
    };
    let mut found = between(solver, (a, &middle), regime, scales, halvings);
    let right = between(solver, (&middle, b), regime, scales, halvings);
    found.push(middle);
    found.extend(right);
    found
}

impl CurvePoint {
    /// Returns the outcomes at `at`; `None` if they are not those of the regime.
    fn of(solver: &mut Solver, at: f64, regime: &Regime) -> Option<Self> {
        let answer = solver.answer(&[at]);
        let same = Regime::of(&answer) == *regime;
        let analysis: Analysis = answer.ok().filter(|_| same)?.analysis?;
        let motion = |Outcome { modes, impulse, velocity_after, .. }| (modes, Motion { impulse, velocity_after });
        let mut outcomes: Vec<(Vec<Mode>, Motion)> =
            analysis.outcomes.into_iter().filter(|outcome| outcome.decided).map(motion).collect();
        outcomes.sort_by(|(a, _), (b, _)| a.cmp(b));
        Some(Self { at, outcomes, explanation: analysis.explanation })
    }

    /// Returns the velocity after the impact and the impulse of each contact in turn, outcome by outcome.
    fn numbers(&self) -> impl Iterator<Item = [f64; 2]> {
        let motions = self.outcomes.iter().map(|(_, motion)| motion.velocity_after.iter().zip(&motion.impulse));
        motions.flatten().flat_map(|(velocity, impulse)| [*velocity, *impulse])
    }

    fn widen(&self, scales: &mut Scales) {
        let count = scales.len();
        for (k, number) in self.numbers().enumerate() {
            scales[k % count] = number.iter().fold(scales[k % count], |most, entry| most.max(entry.abs()));
        }
    }

    /// Returns whether the point is visibly on the straight line between its neighbors.
    fn is_on_line(&self, a: &Self, b: &Self, scales: &Scales) -> bool {
        let ends = a.numbers().zip(b.numbers());
        let straight = self.numbers().zip(ends).zip(scales.iter().cycle()).all(|((pair, (a, b)), scale)| {
            (0..2).all(|axis| (pair[axis] - 0.5 * (a[axis] + b[axis])).abs() <= STRAIGHT * scale)
        });
        let angles = |place: &Self| -> Vec<f64> {
            place.explanation.iter().flat_map(|angles| angles.beta.iter().chain(&angles.gamma).copied()).collect()
        };
        let turns = angles(self).into_iter().zip(angles(a).into_iter().zip(angles(b)));
        straight
            && turns.into_iter().all(|(angle, (a, b))| {
                // Whole turns are removed, because an angle that leaves pi continues at -pi.
                let off = libm::remainder(angle - a, 2.0 * PI) + libm::remainder(angle - b, 2.0 * PI);
                off.abs() <= STRAIGHT * 2.0 * PI
            })
    }
}
