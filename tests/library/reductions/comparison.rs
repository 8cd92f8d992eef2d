//! Comparison of two answers to one state.

use crate::support::impact::{outcomes, reduced, try_impact};
use crate::support::scaled::{largest, near};
use heelstrike::Robot;
use heelstrike::impact::Outcome;
use heelstrike::pipeline::{Impact, Options};
use heelstrike::reductions::Reductions;
use heelstrike::robot::{Base, Plane, Reduction};

/// The tolerance, relative to scale.
const TOLERANCE: f64 = 1e-12;

/// The relative difference of a robot's numbers between two reductions, which round differently.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The largest difference, relative to scale, of two numbers that are each right to 1e-10.
const PROMISED: f64 = 2e-10;

/// None of the reductions, and all but one. `merge.rs` compares answers with and without `merge`.
pub const FEWER: [Reductions; 7] = [
    Reductions::NONE,
    Reductions { weld: false, ..Reductions::ALL },
    Reductions { massless: false, ..Reductions::ALL },
    Reductions { held: false, ..Reductions::ALL },
    Reductions { reach: false, ..Reductions::ALL },
    Reductions { frictionless: false, ..Reductions::ALL },
    Reductions { lone: false, ..Reductions::ALL },
];

/// A mechanism's URDF as a robot that floats in the x-z plane, whatever its joints suggest.
pub fn floating(urdf: &str, reductions: Reductions) -> Robot {
    let (plane, base) = (Some(Plane::XZ), Some(Base::Floating));
    reduced(urdf, &Reduction { plane, base, reductions, ..Reduction::default() })
}

/// The answer to a state of a robot, with its matrices.
pub fn answer(robot: &Robot, state: &serde_json::Value, reductions: Reductions) -> heelstrike::Result<Box<Impact>> {
    try_impact(robot, Options { reductions, matrices: true, ..Options::default() }, state)
}

/// Returns an error if two answers differ in contacts, verdict or modes, or in numbers by more than 1e-12 of scale, or
/// by more than what impulses far above it make of the robot's rounding. Velocities by coordinate are compared if both
/// have the same coordinates: `rate` is then the largest of them before the impact.
pub fn difference(one: &Impact, other: &Impact, rate: Option<f64>) -> Result<(), String> {
    let names = |impact: &Impact| impact.contacts.iter().map(|contact| contact.name.clone()).collect::<Vec<_>>();
    if names(one) != names(other) {
        return Err(format!("contacts {:?} and {:?}", names(one), names(other)));
    }
    let (a, b) = match (&one.analysis, &other.analysis) {
        (Some(a), Some(b)) => (a, b),
        (a, b) => return Err(format!("{a:?} and {b:?}")),
    };
    let [found, expected] = [a, b].map(|of| (of.verdict, of.rank, of.index_sum));
    if found != expected {
        return Err(format!("verdict, rank and index sum {found:?} and {expected:?}"));
    }
    if let (Some(one), Some(other)) = (a.condition, b.condition) {
        // A condition shows how many of its own digits are lost.
        compare(TOLERANCE, "conditions", &[one.recip()], &[other.recip()], 1.0)?;
    }
    let [a, b] = [one, other].map(sorted);
    let modes = |outcomes: &[&Outcome]| outcomes.iter().map(|own| own.modes.clone()).collect::<Vec<_>>();
    if modes(&a) != modes(&b) {
        return Err(format!("modes {:?} and {:?}", modes(&a), modes(&b)));
    }
    let delassus = &one.matrices.as_ref().expect("asked for").delassus;
    let mobility: Vec<f64> = (0..delassus.len()).map(|row| delassus[row][row].max(0.0).sqrt()).collect();
    let most = largest(&mobility).max(f64::MIN_POSITIVE);
    // A row with G_ii = 0 has no scale of its own.
    let mobility: Vec<f64> = mobility.into_iter().map(|own| if own > 0.0 { own } else { most }).collect();
    // The largest |c_i| / sqrt(G_ii), in sqrt J, as in the scale of margins.
    let speeds = one.velocity_before.iter().flatten().zip(&mobility);
    let speed = speeds.map(|(c, mobility)| c.abs() / mobility).fold(f64::MIN_POSITIVE, f64::max);
    for (a, b) in a.into_iter().zip(b) {
        let scaled = |rows: &[[f64; 2]], power: i32| -> Vec<f64> {
            rows.iter().flatten().zip(&mobility).map(|(entry, mobility)| entry * mobility.powi(power) / speed).collect()
        };
        let impulses = scaled(&a.impulse, 1);
        // Contacts that push against each other: relative to scale, impulses are no greater than the condition of G.
        let tolerance = (ROUNDING * largest(&impulses)).clamp(TOLERANCE, PROMISED);
        let compare = |what, a: &[f64], b: &[f64], least| compare(tolerance, what, a, b, least);
        compare("impulses", &impulses, &scaled(&b.impulse, 1), 1.0)?;
        compare("contact velocities", &scaled(&a.velocity_after, -1), &scaled(&b.velocity_after, -1), 1.0)?;
        if let Some(rate) = rate {
            let [loops, others] = [a, b]
                .map(|own| own.loop_impulse.iter().flatten().flat_map(|own| own.components()).collect::<Vec<f64>>());
            compare("impulses of loops", &loops, &others, largest(a.impulse.as_flattened()))?;
            let [velocities, others] = [a, b].map(|own| own.velocity().collect::<Vec<_>>());
            compare("velocities", &velocities, &others, rate)?;
        }
        compare("energies", &[a.energy_loss / speed / speed], &[b.energy_loss / speed / speed], 1.0)?;
    }
    Ok(())
}

/// The largest of a state's rates.
pub fn largest_rate(state: &serde_json::Value) -> f64 {
    let parts = ["base", "joints"].into_iter().filter_map(|part| state["velocity"][part].as_object());
    largest(&parts.flat_map(|part| part.values()).filter_map(serde_json::Value::as_f64).collect::<Vec<_>>())
}

fn compare(tolerance: f64, what: &str, a: &[f64], b: &[f64], least: f64) -> Result<(), String> {
    let size = least.max(largest(a)).max(largest(b));
    if near(a, b, tolerance * size) {
        return Ok(());
    }
    let far = a.iter().zip(b).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
    Err(format!("{what} {far:.1e} of scale apart: {a:?} and {b:?}"))
}

/// Outcomes, sorted by their modes.
fn sorted(impact: &Impact) -> Vec<&Outcome> {
    let mut outcomes: Vec<_> = outcomes(impact).iter().collect();
    outcomes.sort_by(|a, b| a.modes.cmp(&b.modes));
    outcomes
}
