//! States in sustained contact: at rest, or moving without the normal velocities; with torques, virtual springs, held
//! and mimic joints, and loops.
//!
//! ```text
//!     HEELSTRIKE_STATES=1000000 cargo test --release --test proof -- --nocapture forces_are_decided_rightly
//! ```
//!
//! checks a tenth of that number of states.

use super::{dynamics, environment, loads, oracle, states};
use crate::balls::census::{Finding, compare};
use crate::balls::digits::frictions;
use crate::balls::number::{Ball, Number};
use crate::balls::states::Model;
use crate::support::digits::Truth;
use crate::support::parallel::total;
use crate::support::random::Random;
use heelstrike::ContactProblem;
use heelstrike::impact::Mode;
use heelstrike::pipeline::{Options, Pipeline, Sustained};
use heelstrike::state::State;

/// Counts of states: answered, proven, undecided, and without an answer of the oracle; with accelerations close to the
/// exact ones, and with narrow bounds of their rounding; with sliding contacts, loops, mimic joints, springs, held
/// joints; without an outcome, with one and with several. Then counts of outcomes: with balanced rows, with a balanced
/// power, and with compared digits.
const COLUMNS: [&str; 17] = [
    "seen", "proven", "open", "unknown", "close", "bounded", "slides", "loops", "mimics", "springs", "held", "none",
    "unique", "several", "rows", "powers", "digits",
];

fn check(model: &Model, random: &mut Random) -> [u64; COLUMNS.len()] {
    let Some(state) = model.sustained(random) else { return [0; COLUMNS.len()] };
    let scene = &state.scene;
    let found = match Pipeline::new(&model.robot, Options::default()).forces(&state) {
        Ok(found) => found,
        Err(error) => {
            // A contact that is meant to slide or to rest may approach by rounding.
            let error = error.to_string();
            let mut numbers = error.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
            let is_rounding = numbers.next().is_some_and(|speed| speed.abs() < 1e-25);
            assert!(is_rounding && error.ends_with("that is an impact"), "{error}");
            return [0; COLUMNS.len()];
        }
    };
    let analysis = found.analysis.as_ref().expect("few contacts");
    let sustained = found.sustained.as_ref().expect("of forces");
    let slips = &sustained.slips;
    if Some(slips.len()) != scene.contacts.as_ref().map(Vec::len) {
        return [0; COLUMNS.len()];
    }
    let Some(answer) = oracle::forces(&model.robot, &state, slips) else { return [0; COLUMNS.len()] };
    let place = || model.named(&state);
    let finding = compare(&answer, analysis);
    assert!(!matches!(finding, Finding::Wrong(_) | Finding::Different(_)), "{finding:?}, {}", place());
    let [close, bounded] = check_rounding(model, &state, &found.problem, sustained, place);
    let (mut rows, mut powers, mut digits) = (0, 0, 0);
    for outcome in analysis.outcomes.iter().filter(|outcome| outcome.proven && !outcome.family) {
        let imbalance = loads::imbalance(&model.robot, &state, outcome, -outcome.energy_loss);
        let (force, power) = imbalance.expect("a straight ground");
        assert!(force < 1e-12, "{force:e} of the terms are not balanced, {}", place());
        assert!(power.is_none_or(|power| power < 1e-12), "{power:?} of the power is not balanced, {}", place());
        for (mode, after) in outcome.modes.iter().zip(&outcome.velocity_after) {
            assert!(*mode != Mode::Stick || *after == [0.0; 2], "{after:?}, {}", place());
        }
        if outcome.impulse_unique
            && random.once_in(8)
            && let Some(truth) = oracle::truth(&model.robot, &state, Some(slips), &outcome.modes)
        {
            let fail = |difference: String| panic!("{difference}, {}", place());
            // For forces `energy_loss` is a power, which the balance above has checked.
            let truth = Truth { energy_loss: outcome.energy_loss, ..truth };
            truth.check(outcome, &frictions(&state)).unwrap_or_else(fail);
            digits += 1;
        }
        rows += 1;
        powers += u64::from(power.is_some());
    }
    let is = u64::from;
    [
        1,
        is(finding == Finding::Proven),
        is(finding == Finding::Undecided),
        is(finding == Finding::Unknown),
        is(close),
        is(bounded),
        is(slips.iter().any(|slip| slip.is_ne())),
        is(!scene.loops.is_empty()),
        is(!model.robot.mimic_joints().is_empty()),
        is(!scene.springs.is_empty()),
        is(!scene.braked.is_empty()),
        is(answer.outcomes.is_empty()),
        is(answer.outcomes.len() == 1),
        is(answer.outcomes.len() > 1),
        rows,
        powers,
        digits,
    ]
}

/// Checks that the accelerations in f64 are within the bounds of their rounding, and near the exact ones. Returns
/// whether they have all digits except the last three, and whether the bounds leave eight.
fn check_rounding(
    model: &Model,
    state: &State,
    problem: &ContactProblem,
    found: &Sustained,
    place: impl Fn() -> String,
) -> [bool; 2] {
    let own = problem.velocity_free().as_flattened();
    let exact = dynamics::problem::<Ball>(&model.robot, state, &[], Some(&found.slips), 256, false);
    let exact = exact.expect("a regular M");
    let size = own.iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
    let mut is = [true; 2];
    for ((&own, exact), &bound) in own.iter().zip(&exact.free).zip(found.rounding.as_flattened()) {
        let off = exact.minus(&Ball::new(own, 256)).size();
        assert!(off <= bound, "{own} is off by {off:e}, more than {bound:e}; {}", place());
        // f64 loses digits by the condition of M: straight legs leave eight digits, chains of unequal masses five.
        let allowed = if model.name == "chain" { 1e-3 } else { 1e-6 };
        assert!(off < allowed * size, "{own} is off by {off:e}; {}", place());
        is = [is[0] && off < 1e-13 * size, is[1] && bound < 1e-8 * size];
    }
    is
}

#[test]
fn forces_are_decided_rightly() {
    let states = environment("HEELSTRIKE_STATES", 6_000_u64) / 10;
    let models = [states::models(), states::tied_models(&mut Random::new(5))].concat();
    let counts = total(states, |seed| check(&models[seed as usize % models.len()], &mut Random::new(seed)));
    println!("{states} states: {:?}", COLUMNS.iter().zip(counts).collect::<Vec<_>>());
    let count = |name: &str| counts[COLUMNS.iter().position(|own| *own == name).expect("a column")];
    let seen = count("seen");
    assert!(seen * 100 > states * 95 && count("proven") * 100 >= seen * 99, "{counts:?}");
    // Chains lose digits, and loops have no bounds.
    assert!([("close", 85), ("bounded", 75)].iter().all(|(name, part)| count(name) * 100 > seen * part), "{counts:?}");
    let parts =
        [("slides", 3), ("springs", 3), ("loops", 50), ("mimics", 50), ("held", 50), ("powers", 3), ("digits", 20)];
    assert!(parts.iter().all(|(name, part)| count(name) * part > seen), "{counts:?}");
    assert!(["none", "unique", "several"].iter().all(|name| count(name) > 0), "{counts:?}");
}
