//! Proven answers against an oracle in balls of 256 bits and more. Checks with more digits than f64 belong here.
//!
//! The oracle (`poses`, `dynamics`, `loads`, `oracle`, `number`) shares no code with the product: absolute poses, a
//! dense mass matrix, one linear solve per combination of modes. From the library it takes only the numbers of the
//! reduced robot and of the state.
//!
//! To check a million states, a third of them next to a border:
//!
//! ```text
//!     HEELSTRIKE_STATES=1000000 cargo test --release --test proof -- --nocapture states_are_decided_rightly
//! ```
//!
//! A state that fails is printed as `heelstrike impact` reads it.

mod census;
mod digits;
mod dynamics;
mod linear;
mod loads;
mod number;
mod oracle;
mod poses;
mod states;
mod sustained;

use crate::support::random::Random;
use census::{Census, Finding, KINDS, compare};
use heelstrike::impact::{Mode, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use oracle::Index;

#[test]
fn states_are_decided_rightly() {
    let census = Census::of(&states::models(), environment("HEELSTRIKE_STATES", 3_000));
    census.print();
    for kind in KINDS {
        let [number, unknown, refused, proven] =
            ["number", "unknown", "refused", "proven"].map(|column| census.count(kind, column));
        let answered = number - unknown - refused;
        assert!(proven * 1000 >= answered * 999, "{proven} of {answered} {kind} states proven");
    }
    // A state without an answer tests nothing, so few may lack one.
    let (count, void) = (census.all("number"), census.all("unknown") + census.all("refused"));
    assert!(void * 200 <= count, "{void} states without an answer");
    let [near, random] = ["near", "random"].map(|kind| census.count(kind, "number"));
    assert!(near * 3 >= count, "{near} of {count} states are next to a border");
    let several = census.count("random", "several");
    assert!(several * 50 >= random, "{several} of {random} have several outcomes");
}

/// Random trees have forms that no robot file has.
#[test]
fn states_of_random_trees_are_decided_rightly() {
    let trees: Vec<_> = (0..40).map(|seed| states::tree(&mut Random::new(seed))).collect();
    let census = Census::of(&trees, environment("HEELSTRIKE_STATES", 1_200));
    census.print();
    let [number, proven] = ["number", "proven"].map(|column| census.all(column));
    assert!(number >= 1_200 && proven * 100 >= number * 98, "{proven} of {number} states proven");
}

/// The number in an environment variable, or the default.
pub fn environment<T: std::str::FromStr>(name: &str, default: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| value.parse().unwrap_or_else(|_| panic!("{name} is no number: {value}")))
}

/// The comparison must report a wrong mode, a missing outcome and a wrong index.
#[test]
fn a_mistake_is_found() {
    let mut seen = [0; 3];
    for model in &states::models() {
        let mut random = Random::new(7);
        for _ in 0..40 {
            let state = model.random(&mut random);
            let Some(answer) = oracle::answer(&model.robot, &state, &[]) else { continue };
            let impact = Pipeline::new(&model.robot, Options::default()).impact(&state);
            let Ok(right) = impact.and_then(|impact| impact.into_analysis()) else { continue };
            if !matches!(compare(&answer, &right), Finding::Proven | Finding::Same) {
                continue;
            }
            let mut mistakes = vec![right.clone(), right.clone()];
            let mode = &mut mistakes[0].outcomes[0].modes[0];
            *mode = if *mode == Mode::Separate { Mode::Stick } else { Mode::Separate };
            mistakes[1].outcomes.pop();
            // The index of redundant contacts is not compared.
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
            // A proven outcome that does not exist is wrong even if the list of outcomes is undecided.
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
