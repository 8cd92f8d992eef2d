//! Two answers to one question.

use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::impact::{Analysis, Outcome};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::reductions::Reductions;
use heelstrike::robot::{Base, Plane, Reduction};
use heelstrike::state::{Defaults, State};

/// Of scale.
const TOLERANCE: f64 = 1e-12;

/// Without any reduction, and without each alone.
pub const FEWER: [Reductions; 7] = [
    Reductions::NONE,
    Reductions { weld: false, ..Reductions::ALL },
    Reductions { massless: false, ..Reductions::ALL },
    Reductions { held: false, ..Reductions::ALL },
    Reductions { reach: false, ..Reductions::ALL },
    Reductions { frictionless: false, ..Reductions::ALL },
    Reductions { lone: false, ..Reductions::ALL },
];

/// A description as a robot.
pub fn robot(description: &Description, reductions: Reductions) -> Robot {
    Robot::reduce(description, &Reduction { reductions, ..Reduction::default() }).expect("a good robot")
}

/// A mechanism's URDF as a robot that floats in the x-z plane, whatever its joints suggest.
pub fn floating(urdf: &str, reductions: Reductions) -> Robot {
    let description = Description::from_urdf(urdf).expect("a good file");
    let (plane, base) = (Some(Plane::XZ), Some(Base::Floating));
    Robot::reduce(&description, &Reduction { plane, base, reductions, ..Reduction::default() }).expect("a good robot")
}

/// The answer to a state of a robot, with its matrices.
pub fn answer(robot: &Robot, state: &serde_json::Value, reductions: Reductions) -> heelstrike::Result<Impact> {
    let state = State::from_json(&state.to_string(), robot, &Defaults::default())?;
    let options = Options { reductions, matrices: true, ..Options::default() };
    Pipeline::new(robot, options).impact(&state)
}

/// What differs between two answers: contacts, verdict, modes, or numbers beyond 1e-12 of scale. Velocities by
/// coordinate are compared where both have the same coordinates: `rate` is the largest of them before the impact.
pub fn difference(one: &Impact, other: &Impact, rate: Option<f64>) -> Result<(), String> {
    let names = |impact: &Impact| impact.contacts.iter().map(|contact| contact.name.clone()).collect::<Vec<_>>();
    if names(one) != names(other) {
        return Err(format!("contacts {:?} and {:?}", names(one), names(other)));
    }
    let (a, b) = match (&one.analysis, &other.analysis) {
        (Some(a), Some(b)) => (a, b),
        (a, b) => return Err(format!("{a:?} and {b:?}")),
    };
    if a.verdict != b.verdict || (a.rank, a.index_sum) != (b.rank, b.index_sum) {
        return Err(format!("{} and {}", words(a), words(b)));
    }
    if let (Some(one), Some(other)) = (a.condition, b.condition) {
        // It reports how many of its own digits are lost.
        near("conditions", &[one.recip()], &[other.recip()], 1.0)?;
    }
    let [a, b] = [one, other].map(sorted);
    let modes = |outcomes: &[&Outcome]| outcomes.iter().map(|own| own.modes.clone()).collect::<Vec<_>>();
    if modes(&a) != modes(&b) {
        return Err(format!("modes {:?} and {:?}", modes(&a), modes(&b)));
    }
    let delassus = &one.matrices.as_ref().expect("asked for").delassus;
    let mobility: Vec<f64> = (0..delassus.len()).map(|row| delassus[row][row].max(0.0).sqrt()).collect();
    let largest = mobility.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    // A row that nothing moves has no size of its own.
    let mobility: Vec<f64> = mobility.into_iter().map(|own| if own > 0.0 { own } else { largest }).collect();
    // sqrt J, as margins are measured.
    let speeds = one.velocity_before.iter().flatten().zip(&mobility);
    let speed = speeds.map(|(c, mobility)| c.abs() / mobility).fold(f64::MIN_POSITIVE, f64::max);
    for (a, b) in a.into_iter().zip(b) {
        let scaled = |rows: &[[f64; 2]], power: i32| -> Vec<f64> {
            rows.iter().flatten().zip(&mobility).map(|(entry, mobility)| entry * mobility.powi(power) / speed).collect()
        };
        near("impulses", &scaled(&a.impulse, 1), &scaled(&b.impulse, 1), 1.0)?;
        near("contact velocities", &scaled(&a.velocity_after, -1), &scaled(&b.velocity_after, -1), 1.0)?;
        if let Some(rate) = rate {
            let [loops, others] = [a, b]
                .map(|own| own.loop_impulse.iter().flatten().flat_map(|own| own.components()).collect::<Vec<f64>>());
            let largest = a.impulse.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
            near("impulses of loops", &loops, &others, largest)?;
            let [velocities, others] = [a, b].map(|own| own.velocity().collect::<Vec<_>>());
            near("velocities", &velocities, &others, rate)?;
        }
        near("energies", &[a.energy_loss / speed / speed], &[b.energy_loss / speed / speed], 1.0)?;
    }
    Ok(())
}

/// The largest of a state's rates.
pub fn largest_rate(state: &serde_json::Value) -> f64 {
    let parts = ["base", "joints"].into_iter().filter_map(|part| state["velocity"][part].as_object());
    parts
        .flat_map(|part| part.values())
        .filter_map(serde_json::Value::as_f64)
        .fold(0.0, |most, rate| most.max(rate.abs()))
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
fn sorted(impact: &Impact) -> Vec<&Outcome> {
    let outcomes = &impact.analysis.as_ref().expect("compared already").outcomes;
    let mut outcomes: Vec<_> = outcomes.iter().collect();
    outcomes.sort_by(|a, b| a.modes.cmp(&b.modes));
    outcomes
}

fn words(analysis: &Analysis) -> String {
    format!("{:?} of rank {}, sum {:?}", analysis.verdict, analysis.rank, analysis.index_sum)
}
