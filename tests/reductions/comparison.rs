//! Two answers to one question.

use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::impact::{Analysis, Outcome};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::reductions::Reductions;
use heelstrike::robot::{Base, Reduction};
use heelstrike::state::{Defaults, State};

/// Of scale.
const TOLERANCE: f64 = 1e-12;

/// Without any reduction, and without each alone.
pub const FEWER: [Reductions; 6] = [
    Reductions::NONE,
    Reductions { weld: false, ..Reductions::ALL },
    Reductions { massless: false, ..Reductions::ALL },
    Reductions { held: false, ..Reductions::ALL },
    Reductions { reach: false, ..Reductions::ALL },
    Reductions { frictionless: false, ..Reductions::ALL },
];

/// A description as a robot.
pub fn robot(description: &Description, base: Option<Base>, reductions: Reductions) -> Robot {
    Robot::reduce(description, &Reduction { base, reductions, ..Reduction::default() }).expect("a good robot")
}

/// The answer to a state of a robot, with its matrices.
pub fn answer(robot: &Robot, state: &serde_json::Value, reductions: Reductions) -> heelstrike::Result<Impact> {
    let state = State::from_json(&state.to_string(), robot, &Defaults::default())?;
    let options = Options { reductions, matrices: true, ..Options::default() };
    Pipeline::new(robot, options).impact(&state)
}

/// What differs between two answers: contacts, verdict, modes, or numbers beyond 1e-12 of scale. Velocities by coordinate
/// are compared where the coordinates are the `same`.
pub fn difference(one: &Impact, other: &Impact, same_coordinates: bool) -> Result<(), String> {
    let names = |impact: &Impact| impact.contacts.iter().map(|contact| contact.name.clone()).collect::<Vec<_>>();
    if names(one) != names(other) {
        return Err(format!("contacts {:?} and {:?}", names(one), names(other)));
    }
    let (a, b) = match (&one.analysis, &other.analysis) {
        (Ok(a), Ok(b)) => (a, b),
        (a, b) => return Err(format!("{a:?} and {b:?}")),
    };
    if a.verdict != b.verdict || (a.rank, a.index_sum) != (b.rank, b.index_sum) {
        return Err(format!("{} and {}", words(a), words(b)));
    }
    let [a, b] = [one, other].map(sorted);
    let modes = |outcomes: &[(usize, &Outcome)]| outcomes.iter().map(|own| own.1.modes.clone()).collect::<Vec<_>>();
    if modes(&a) != modes(&b) {
        return Err(format!("modes {:?} and {:?}", modes(&a), modes(&b)));
    }
    let delassus = &one.matrices.as_ref().expect("asked for").delassus;
    let mobility: Vec<f64> = (0..delassus.len()).map(|row| delassus[row][row].max(0.0).sqrt()).collect();
    // sqrt J, as margins are measured.
    let speeds = one.velocity_before.iter().flatten().zip(&mobility).filter(|(_, mobility)| **mobility > 0.0);
    let speed = speeds.map(|(c, mobility)| c.abs() / mobility).fold(f64::MIN_POSITIVE, f64::max);
    for ((at, a), (bt, b)) in a.into_iter().zip(b) {
        let scaled = |rows: &[[f64; 2]], power: i32| -> Vec<f64> {
            rows.iter().flatten().zip(&mobility).map(|(entry, mobility)| entry * mobility.powi(power) / speed).collect()
        };
        near("impulses", &scaled(&a.impulse, 1), &scaled(&b.impulse, 1), 1.0)?;
        near("contact velocities", &scaled(&a.velocity_after, -1), &scaled(&b.velocity_after, -1), 1.0)?;
        if same_coordinates {
            near("velocities", &one.velocity_after[at], &other.velocity_after[bt], f64::MIN_POSITIVE)?;
        }
        near("energies", &[a.energy_loss / speed / speed], &[b.energy_loss / speed / speed], 1.0)?;
    }
    Ok(())
}

fn near(what: &str, a: &[f64], b: &[f64], least: f64) -> Result<(), String> {
    let size = a.iter().chain(b).fold(least, |size, entry| size.max(entry.abs()));
    // A NaN is near nothing.
    match a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE * size) {
        true => Ok(()),
        false => {
            let far = a.iter().zip(b).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
            Err(format!("{what} {far:.1e} of scale apart: {a:?} and {b:?}"))
        }
    }
}

/// Outcomes in the order of their modes, each with its place.
fn sorted(impact: &Impact) -> Vec<(usize, &Outcome)> {
    let outcomes = &impact.analysis.as_ref().expect("compared already").outcomes;
    let mut outcomes: Vec<_> = outcomes.iter().enumerate().collect();
    outcomes.sort_by(|(_, a), (_, b)| a.modes.cmp(&b.modes));
    outcomes
}

fn words(analysis: &Analysis) -> String {
    format!("{:?} of rank {}, sum {:?}", analysis.verdict, analysis.rank, analysis.index_sum)
}
