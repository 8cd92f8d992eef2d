//! What the product calls proven, against an oracle in balls of 256 bits and more: what is checked with more digits than
//! f64 has belongs here.
//!
//! The oracle (`dynamics`, `oracle`, `number`) shares no code with the product: absolute poses, a dense mass matrix, one
//! linear solve per list of modes. It takes from the library only the numbers of the reduced robot and of the state.
//!
//! A million states, a third of them beside a border:
//!
//! ```text
//!     cargo test --release --test proofs -- --ignored --nocapture a_million
//! ```
//!
//! `HEELSTRIKE_STATES` and `HEELSTRIKE_THREADS` change their number and that of the threads.

mod census;
mod dynamics;
mod linear;
mod number;
mod oracle;
#[path = "../oracle/random.rs"]
#[allow(dead_code, reason = "other tests pick otherwise")]
mod random;
mod references;
mod states;

use census::{Finding, census, compare};
use heelstrike::impact::{Mode, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::{Defaults, State};
use oracle::Index;
use random::Random;
use std::time::Instant;

/// Runs a census, prints it, and fails where an answer is wrong.
fn checked(states: u64, threads: usize) -> census::Row {
    let start = Instant::now();
    let census = census(&states::models(), states, threads);
    let total = census.total();
    let count = total.random.states + total.near.states;
    let time = start.elapsed();
    println!("{census}");
    println!("{count} states in {time:.1?}, {:.2?} of a thread each", time * threads as u32 / count as u32);
    let wrong = total.random.wrong + total.near.wrong;
    assert!(wrong == 0, "{wrong} wrongly proven");
    // Beside a border an answer that is not proven may be wrong by its rounding, elsewhere not.
    assert!(total.random.different == 0, "{} wrongly decided", total.random.different);
    // What the oracle cannot tell or the product refuses proves nothing, so little of it may be among them.
    let void = total.random.unknown + total.random.refused + total.near.unknown + total.near.refused;
    assert!(void * 100 <= count, "{void} states without an answer");
    assert!(total.near.states * 3 >= count && total.random.ambiguous * 50 >= total.random.states, "{census}");
    total
}

fn environment<T: std::str::FromStr>(name: &str, default: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| value.parse().unwrap_or_else(|_| panic!("{name} is no number: {value}")))
}

fn threads() -> usize {
    environment("HEELSTRIKE_THREADS", std::thread::available_parallelism().map_or(4, usize::from))
}

#[test]
fn ten_thousand_states_are_decided_rightly() {
    checked(10_000, threads());
}

/// To be checked in each run as soon as verdicts are proven at all; until then no state is.
#[test]
#[ignore = "no verdict is proven yet"]
fn nearly_all_random_states_are_proven() {
    let total = checked(10_000, threads());
    let count = total.random.states - total.random.unknown - total.random.refused;
    assert!(total.random.proven * 100 >= count * 99, "{} of {count} proven", total.random.proven);
}

#[test]
#[ignore = "takes half an hour"]
fn a_million_states_are_decided_rightly() {
    checked(environment("HEELSTRIKE_STATES", 1_000_000), threads());
}

/// A check that never fails checks nothing.
#[test]
fn a_mistake_is_found() {
    let mut seen = [0; 3];
    for model in &states::models() {
        let mut random = Random::new(7);
        for _ in 0..40 {
            let state = model.random(&mut random);
            let Some(answer) = oracle::answer(&model.robot, &state) else { continue };
            let impact = Pipeline::new(&model.robot, Options::default()).impact(&state);
            let Ok(right) = impact.and_then(|impact| impact.analysis) else { continue };
            if !matches!(compare(&answer, &right), Finding::Proven | Finding::Same) {
                continue;
            }
            let mut mistakes = Vec::new();
            let mut flipped = right.clone();
            let mode = &mut flipped.outcomes[0].modes[0];
            *mode = if *mode == Mode::Separate { Mode::Stick } else { Mode::Separate };
            mistakes.push(flipped);
            let mut lost = right.clone();
            lost.outcomes.pop();
            mistakes.push(lost);
            // Where contacts depend on each other the index is not compared.
            if answer.outcomes.iter().all(|outcome| outcome.index != Index::Redundant) {
                let mut turned = right.clone();
                turned.outcomes[0].index = Some(turned.outcomes[0].index.map_or(1, |index| -index));
                mistakes.push(turned);
            }
            for (count, mut mistake) in seen.iter_mut().zip(mistakes) {
                mistake.proven = false;
                mistake.outcomes.iter_mut().for_each(|outcome| outcome.proven = false);
                assert!(matches!(compare(&answer, &mistake), Finding::Different(_)), "{mistake:?}");
                mistake.proven = true;
                assert!(matches!(compare(&answer, &mistake), Finding::Wrong(_)), "{mistake:?}");
                *count += 1;
            }
            // One proven outcome that is none is wrong, even where the list is not said to be complete.
            let mut single = right.clone();
            single.proven = false;
            single.verdict = Verdict::Undecided;
            single.outcomes[0].proven = true;
            assert_eq!(compare(&answer, &single), Finding::Undecided);
            single.outcomes[0].modes[0] =
                if single.outcomes[0].modes[0] == Mode::SlidePlus { Mode::SlideMinus } else { Mode::SlidePlus };
            assert!(matches!(compare(&answer, &single), Finding::Wrong(_)), "{single:?}");
        }
    }
    assert!(seen.iter().all(|&count| count > 200), "{seen:?}");
}

#[test]
fn states_are_written_as_they_are() {
    for model in &states::models() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let state = model.random(&mut random);
            let text = census::state_json(&model.robot, &state).to_string();
            let read = State::from_json(&text, &model.robot, &Defaults::default());
            let read = read.unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(oracle::answer(&model.robot, &read), oracle::answer(&model.robot, &state), "{text}");
        }
    }
}
