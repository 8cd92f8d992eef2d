//! Distances of compliant contact from the rigid outcomes, and the parameters on which they depend.

use super::frozen::{CompliantRun, TOLERANCE, run};
use super::ground::SoftGround;
use super::moving;
use crate::accuracy::computation::Computation;
use crate::accuracy::quantile;
use crate::budget::{is_spent, within};
use crate::dynamics::kinetic_energy;
use crate::impact::{ContactProblem, Outcome};
use crate::law::Mode;
use crate::pipeline::assembly::{Assembly, Elimination};
use crate::pipeline::exact::ExactState;
use crate::pipeline::{Options, Pipeline};
use crate::planar::Pair;
use crate::robot::Robot;
use crate::state::State;
use crate::{Reason, Result};
use serde::Serialize;

/// A run is near an outcome if it ends within this distance of it, as a part of the speed before the impact.
pub const NEAR: f64 = 0.01;

const DAMPING_RATIOS: [f64; 6] = [0.05, 0.3, 1.0, 3.0, 10.0, f64::INFINITY];
const STIFFNESS_RATIOS: [f64; 3] = [0.1, 1.0, 10.0];
const TANGENTIAL_DAMPING: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const TOLERANCES: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10];
const STIFFNESSES: [f64; 5] = [1e4, 1e6, 1e8, 1e10, 1e12];

/// Compliant contact next to the outcomes of one state.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The rigid outcomes, in the order of the analysis.
    pub outcomes: Vec<Target>,
    /// Runs that the integrator aborted, or that did not end; they are not counted elsewhere.
    pub unsettled: usize,
    /// All runs, then those of each value of each parameter.
    pub groups: Vec<Group>,
    /// The effect of the integrator's tolerance, on a ground of damping ratio 1 with equal springs and dampers.
    pub tolerances: Vec<ByTolerance>,
    /// The effect of stiffness while the robot moves, on the same ground; empty for a robot with loops.
    pub stiffnesses: Vec<ByStiffness>,
}

/// A rigid outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Target {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// Its index.
    pub index: Option<i8>,
    /// Runs that end nearest to it.
    pub nearest: usize,
    /// Runs that end near it.
    pub near: usize,
}

/// Runs that share a value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Group {
    /// The parameter; `None` for all runs.
    pub parameter: Option<&'static str>,
    /// Its value; `None` if it is infinite, or for all runs.
    pub value: Option<f64>,
    /// Number of runs.
    pub runs: usize,
    /// Distance to the nearest outcome, least, median and greatest: sqrt(T(v - v_outcome) / T(v before)), T the kinetic
    /// energy; NaN, in JSON null, where there are no runs.
    #[cfg_attr(feature = "schema", schemars(with = "[Option<f64>; 3]"))]
    pub distance: [f64; 3],
    /// Runs per outcome that end nearest to it.
    pub nearest: Vec<usize>,
    /// The share of runs that end near no outcome.
    pub near_none: f64,
}

/// A run by the integrator's tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ByTolerance {
    /// The relative tolerance.
    pub tolerance: f64,
    /// Steps that it took.
    pub steps: usize,
    /// Distance from the run of the finest tolerance.
    pub change: f64,
    /// Distance to the nearest outcome.
    pub distance: f64,
}

/// A run of the moving robot by the ground's stiffness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ByStiffness {
    /// k_n \[N/m\].
    pub stiffness: f64,
    /// Distance from the run with the configuration frozen; `None` if the integrator gave up.
    pub change: Option<f64>,
    /// Distance to the nearest outcome.
    pub distance: Option<f64>,
}

/// The outcome that is nearest to the end of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestOutcome {
    /// The index of the outcome.
    pub outcome: usize,
    /// The distance to it.
    pub distance: f64,
}

/// Returns the distance between the effects of two impulses in the energy norm, as a part of the speed before the
/// impact, whose kinetic energy is `energy`.
pub fn distance(problem: &ContactProblem, energy: f64, a: &[Pair<f64>], b: &[Pair<f64>]) -> f64 {
    let gap: Vec<f64> = a.iter().zip(b).flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let rows = gap.len();
    let entry = |at: usize| gap[at / rows] * problem.delassus(at / rows, at % rows) * gap[at % rows];
    let twice: f64 = (0..rows * rows).map(entry).sum();
    // Rounding may make the sum slightly negative.
    (0.5 * twice.max(0.0) / energy).sqrt()
}

/// Returns the outcome that a run ends nearest to; `None` if there is no outcome.
pub fn landing(
    problem: &ContactProblem,
    outcomes: &[Outcome],
    energy: f64,
    run: &CompliantRun,
) -> Option<NearestOutcome> {
    let distances = outcomes.iter().map(|outcome| distance(problem, energy, &run.impulse, &outcome.impulse));
    let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(outcome, distance)| NearestOutcome { outcome, distance })
}

/// Runs a robot's state through every combination of the parameters; `None` if it has no outcome to compare with.
///
/// # Errors
/// Returns the errors of [`Pipeline::impact`]; an error for more contacts than a run takes, or if the integrator gives
/// up on a run that the studies of tolerance and stiffness need; and [`BeyondBudget`](crate::Reason::BeyondBudget).
pub fn compare(robot: &Robot, state: &State, options: &Options) -> Result<Option<Comparison>> {
    within(options.budget, || {
        let comparison = comparison(robot, state, options);
        if is_spent() { Err(Reason::BeyondBudget.into()) } else { comparison }
    })
}

fn comparison(robot: &Robot, state: &State, options: &Options) -> Result<Option<Comparison>> {
    let mut pipeline = Pipeline::new(robot, options.clone());
    let impact = pipeline.impact(state)?;
    let (problem, energy) = (&impact.problem, impact.kinetic_energy);
    // An undecided outcome has no numbers to compare with.
    let decided = impact.analysis.iter().flat_map(|analysis| &analysis.outcomes).filter(|outcome| outcome.decided);
    let outcomes = &*decided.cloned().collect::<Vec<_>>();
    if outcomes.is_empty() || problem.contacts() == 0 || energy <= 0.0 {
        return Ok(None);
    }
    let prepared = pipeline.prepare(state)?;
    let exact = pipeline.exact(state, &prepared);
    let (mut landings, mut unsettled) = (Vec::new(), 0);
    for &damping_ratio in &DAMPING_RATIOS {
        for &stiffness_ratio in &STIFFNESS_RATIOS {
            for &tangential_damping in &TANGENTIAL_DAMPING {
                let ground = SoftGround { damping_ratio, stiffness_ratio, tangential_damping };
                match run(problem, ground, TOLERANCE) {
                    Ok(run) if run.ended => {
                        landings.extend(landing(problem, outcomes, energy, &run).map(|landing| (ground, landing)));
                    }
                    _ => unsettled += 1,
                }
            }
        }
    }
    let group = |parameter, value: Option<f64>, chosen: &dyn Fn(&SoftGround) -> bool| {
        let chosen = || landings.iter().filter(|(ground, _)| chosen(ground)).map(|(_, landing)| landing);
        let mut distances: Vec<f64> = chosen().map(|landing| landing.distance).collect();
        distances.sort_by(f64::total_cmp);
        let runs = distances.len();
        let near_none = distances.iter().filter(|distance| **distance > NEAR).count();
        let nearest = |outcome| chosen().filter(|landing| landing.outcome == outcome).count();
        Group {
            parameter,
            value: value.filter(|value| value.is_finite()),
            runs,
            distance: [0.0, 0.5, 1.0].map(|share| quantile(&distances, share)),
            nearest: (0..outcomes.len()).map(nearest).collect(),
            near_none: near_none as f64 / runs.max(1) as f64,
        }
    };
    let mut groups = vec![group(None, None, &|_| true)];
    type Pick = fn(&SoftGround) -> f64;
    let parameters: [(&'static str, &[f64], Pick); 3] = [
        ("damping ratio", &DAMPING_RATIOS, |ground| ground.damping_ratio),
        ("k_t/k_n", &STIFFNESS_RATIOS, |ground| ground.stiffness_ratio),
        ("d_t/d_n", &TANGENTIAL_DAMPING, |ground| ground.tangential_damping),
    ];
    for (name, values, pick) in parameters {
        groups.extend(values.iter().map(|&value| group(Some(name), Some(value), &|ground| pick(ground) == value)));
    }
    let targets = outcomes.iter().enumerate().map(|(at, outcome)| Target {
        modes: outcome.modes.clone(),
        index: outcome.index,
        nearest: groups[0].nearest[at],
        near: landings.iter().filter(|(_, landing)| landing.outcome == at && landing.distance <= NEAR).count(),
    });
    Ok(Some(Comparison {
        outcomes: targets.collect(),
        unsettled,
        tolerances: by_tolerance(problem, outcomes, energy)?,
        stiffnesses: by_stiffness_of_moving(&exact, problem, outcomes, energy)?,
        groups,
    }))
}

/// The ground in the studies of tolerance and stiffness.
const PLAIN: SoftGround = SoftGround { damping_ratio: 1.0, stiffness_ratio: 1.0, tangential_damping: 1.0 };

fn by_tolerance(problem: &ContactProblem, outcomes: &[Outcome], energy: f64) -> Result<Vec<ByTolerance>> {
    let finest = run(problem, PLAIN, 1e-12)?;
    let row = |tolerance| {
        let run = run(problem, PLAIN, tolerance)?;
        let change = distance(problem, energy, &run.impulse, &finest.impulse);
        let landing = landing(problem, outcomes, energy, &run);
        Ok(landing.map(|landing| ByTolerance { tolerance, steps: run.steps, change, distance: landing.distance }))
    };
    TOLERANCES.into_iter().filter_map(|tolerance| row(tolerance).transpose()).collect()
}

fn by_stiffness_of_moving(
    state: &ExactState,
    problem: &ContactProblem,
    outcomes: &[Outcome],
    energy: f64,
) -> Result<Vec<ByStiffness>> {
    let mut computation = Computation::<f64>::new(state);
    if computation.assembly.is_constrained() {
        // The equation of motion has no loop forces: only impulses keep a loop closed here.
        return Ok(Vec::new());
    }
    computation.place();
    computation.by_ltl();
    let Computation { mut assembly, velocity: mut before, .. } = computation;
    for (before, change) in before.iter_mut().zip(state.change(&mut assembly)) {
        *before += change;
    }
    let mut after = |impulses: &[Pair<f64>]| {
        let mut velocity = before.clone();
        for (contact, &impulse) in impulses.iter().enumerate() {
            assembly.add_contact_impulse(Elimination::Ltl, contact, impulse, &mut velocity);
        }
        velocity
    };
    let frozen = after(&run(problem, PLAIN, TOLERANCE)?.impulse);
    let outcomes: Vec<Vec<f64>> = outcomes.iter().map(|outcome| after(&outcome.impulse)).collect();
    let Assembly { plan, workspace, .. } = &assembly;
    let apart = |a: &[f64], b: &[f64]| {
        let gap: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        (kinetic_energy(plan, &gap, workspace, &mut Vec::new()).max(0.0) / energy).sqrt()
    };
    let row = |stiffness| {
        // If the integrator gives up, the row is empty and the study goes on.
        let end = moving::run(state, (&assembly, &before), problem, PLAIN, stiffness).ok();
        let nearest = |end: &Vec<f64>| outcomes.iter().map(|outcome| apart(end, outcome)).fold(f64::INFINITY, f64::min);
        let change = end.as_ref().map(|end| apart(end, &frozen));
        ByStiffness { stiffness, change, distance: end.as_ref().map(nearest) }
    };
    Ok(STIFFNESSES.map(row).to_vec())
}
