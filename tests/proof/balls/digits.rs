//! Every printed number of a proven outcome against balls of 832 bits, relative to its scale. `HEELSTRIKE_DIGITS`
//! sets the number of states.

use super::loads::imbalance;
use super::states::{Model, chain, models, tied_models, tree};
use super::{environment, oracle};
use crate::support::digits::{PROMISED, Truth};
use crate::support::parallel::total;
use crate::support::random::Random;
use heelstrike::impact::Friction;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::{Named, Scene, State};

/// Compares the outcomes of a random state; returns the numbers of compared and of unproven outcomes.
fn compare(model: &Model, random: &mut Random) -> [u64; 2] {
    let mut state = model.random(random);
    state.scene.impulses.clear();
    let impact = Pipeline::new(&model.robot, Options::default()).impact(&state);
    let Ok(analysis) = impact.and_then(|impact| impact.into_analysis()) else { return [0; 2] };
    let mut counts = [0; 2];
    for outcome in analysis.outcomes.iter().filter(|outcome| outcome.impulse_unique) {
        let Some(truth) = oracle::truth(&model.robot, &state, None, &outcome.modes) else { continue };
        if outcome.proven {
            counts[0] += 1;
            let fail = |difference: String| panic!("{difference}, {}", model.named(&state));
            truth.check(outcome, &frictions(&state)).unwrap_or_else(fail);
            let worst = truth.worst_rate(outcome);
            assert!(worst <= PROMISED, "{worst:e}, {}", model.named(&state));
        } else {
            counts[1] += 1;
        }
    }
    counts
}

pub fn frictions(state: &State) -> Vec<Friction> {
    let contacts = state.scene.contacts.as_deref().unwrap_or_default();
    contacts.iter().map(|contact| state.scene.friction.of(contact.link).expect("a friction")).collect()
}

#[test]
fn digits_of_states_are_right() {
    let trees = (0..10).map(|seed| tree(&mut Random::new(seed)));
    let models: Vec<Model> = models().into_iter().chain(trees).collect();
    let [compared, marked] = total(environment("HEELSTRIKE_DIGITS", 600), |seed| {
        compare(&models[seed as usize % models.len()], &mut Random::new(seed))
    });
    println!("{compared} outcomes of robots, {marked} marked");
    assert!(compared > 300 && marked * 100 < compared, "{compared} compared, {marked} marked");
}

#[test]
fn digits_of_chains_of_unequal_links_are_right() {
    let [compared, marked] = total(environment("HEELSTRIKE_DIGITS", 200), |seed| {
        let mut random = Random::new(seed);
        // Every third chain is so long that articulated bodies alone solve it.
        let length = if seed % 3 == 2 { 26 } else { 10 };
        compare(&chain(length, &mut random), &mut random)
    });
    println!("{compared} outcomes of chains, {marked} marked");
    assert!(compared > 150 && marked * 100 < compared, "{compared} compared, {marked} marked");
}

/// Checks M (v+ - v-) = J^T L + K^T l, where v- is the velocity that the loops leave.
#[test]
fn impulses_of_loops_balance_the_momentum() {
    let tied = tied_models(&mut Random::new(5));
    let model = tied.iter().find(|model| model.name == "five_bar").expect("a robot with a loop");
    let mut balanced = 0;
    for seed in 0..environment("HEELSTRIKE_DIGITS", 400) {
        let mut random = Random::new(seed);
        let Some(mut state) = model.sustained(&mut random) else { continue };
        (state.scene.torque, state.scene.springs) = (Vec::new(), Vec::new());
        // No velocity of the base opens a loop.
        state.velocity.iter_mut().take(2).for_each(|rate| *rate += random.between(-2.0, 0.5));
        let mut pipeline = Pipeline::new(&model.robot, Options::default());
        let mut outcomes = |state: &State| {
            let impact = pipeline.impact(state).and_then(|impact| impact.into_analysis());
            impact.map_or_else(|_| Vec::new(), |analysis| analysis.outcomes)
        };
        let untouched = Scene { contacts: Some(Vec::new()), ..state.scene.clone() };
        let before = outcomes(&State { scene: untouched, ..state.clone() });
        let scene = Scene { gravity: Some(0.0), ..state.scene.clone() };
        let still = State { velocity: vec![0.0; model.robot.dofs()], scene, ..state.clone() };
        for outcome in outcomes(&state).into_iter().filter(|outcome| outcome.proven) {
            let change = |after: &Option<Named>, before: &Option<Named>| -> Option<Named> {
                let (after, before) = (after.as_ref()?, before.as_ref()?);
                let entries = after.iter().zip(before.values());
                Some(entries.map(|((name, after), before)| (name.to_owned(), after - before)).collect())
            };
            let mut jump = outcome;
            jump.base_velocity_after = change(&jump.base_velocity_after, &before[0].base_velocity_after);
            jump.joint_velocity_after = change(&jump.joint_velocity_after, &before[0].joint_velocity_after);
            // A jump that is only rounding does not balance.
            if jump.loop_impulse.iter().flatten().all(|own| own.length() < 1e-3) {
                continue;
            }
            let (off, _) = imbalance(&model.robot, &still, &jump, 0.0).expect("a straight ground");
            assert!(off < PROMISED, "{off:e} is not balanced, {}", model.named(&state));
            balanced += 1;
        }
    }
    assert!(balanced > 50, "{balanced}");
}

/// The check must report impulses and an energy that are off by 3e-10.
#[test]
fn a_digit_that_is_off_is_found() {
    let models = models();
    let mut found = 0;
    for seed in 0..40 {
        let model = &models[seed as usize % models.len()];
        let mut state = model.random(&mut Random::new(seed));
        state.scene.impulses.clear();
        let impact = Pipeline::new(&model.robot, Options::default()).impact(&state);
        let Ok(analysis) = impact.and_then(|impact| impact.into_analysis()) else { continue };
        for outcome in analysis.outcomes.iter().filter(|outcome| outcome.impulse_unique && outcome.energy_loss != 0.0) {
            let Some(truth) = oracle::truth(&model.robot, &state, None, &outcome.modes) else { continue };
            let mut off = truth.impulse.clone();
            off.iter_mut().flatten().for_each(|entry| *entry *= 1.0 + 3e-10);
            let impulses = Truth { impulse: off, ..truth };
            assert!(impulses.check(outcome, &frictions(&state)).is_err());
            let energy = Truth { impulse: Vec::new(), energy_loss: impulses.energy_loss * (1.0 + 3e-10), ..impulses };
            assert!(energy.check(outcome, &[]).is_err());
            found += 1;
        }
    }
    assert!(found > 20, "{found}");
}
