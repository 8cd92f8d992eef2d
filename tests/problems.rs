//! Contact problems of other people's software, papers and textbooks (`data/problems.json`, solved exactly) through one
//! `solve`. Those with the tag `family` or `border` need only be answered here.

use serde::Deserialize;
use serde_json::{Value, json};

#[path = "support/binary.rs"]
mod binary;
#[path = "support/scaled.rs"]
mod scaled;

use binary::{Answer, Outcome, answers};
use scaled::{Differences, largest, matrix};

/// To this share of the largest speed before or after, or of the largest impulse.
const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Problem {
    id: String,
    tags: Vec<String>,
    delassus: Vec<Vec<f64>>,
    velocity_before: Vec<[f64; 2]>,
    friction: Value,
    restitution: Value,
    expected: Expected,
}

#[derive(Deserialize)]
struct Expected {
    outcomes: Vec<ExpectedOutcome>,
    index_sum: Option<i64>,
    rank: usize,
}

#[derive(Deserialize)]
struct ExpectedOutcome {
    modes: Vec<String>,
    impulse: Vec<[f64; 2]>,
    velocity_after: Vec<[f64; 2]>,
    impulse_unique: bool,
    index: Option<i64>,
    /// In place of `index` where the Schur complement of the sliding contacts is singular.
    index_extended: Option<i64>,
}

impl Problem {
    /// The friction of a contact; infinity for `infinite`.
    fn friction(&self, contact: usize) -> f64 {
        let friction = self.friction.get(contact).unwrap_or(&self.friction);
        friction.as_f64().unwrap_or(f64::INFINITY)
    }

    fn tagged(&self, tag: &str) -> bool {
        self.tags.iter().any(|given| given == tag)
    }
}

#[test]
fn the_problems_of_others_have_exactly_their_outcomes() {
    let problems: Vec<Problem> =
        serde_json::from_str(include_str!("data/problems.json")).expect("the problems are readable");
    let inputs: Vec<Value> = problems
        .iter()
        .map(|problem| {
            json!({
                "id": problem.id,
                "delassus": problem.delassus,
                "velocity_before": problem.velocity_before,
                "friction": problem.friction,
                "restitution": problem.restitution,
            })
        })
        .collect();
    let mut differences = Differences::default();
    let mut compared = 0;
    for (problem, answer) in problems.iter().zip(answers(&["solve", "-", "--format", "json"], &inputs)) {
        match answer {
            Err(refusal) => differences.note(&problem.id, refusal),
            Ok(_) if problem.tagged("family") || problem.tagged("border") => {}
            Ok(answer) => {
                compare(problem, &answer, &mut differences);
                compared += 1;
            }
        }
    }
    eprintln!("{compared} of {} problems compared", problems.len());
    differences.finish();
}

fn compare(problem: &Problem, answer: &Answer, differences: &mut Differences) {
    let (id, expected) = (&problem.id, &problem.expected);
    let mut found: Vec<_> = answer.outcomes.iter().map(|outcome| &outcome.modes).collect();
    let mut should: Vec<_> = expected.outcomes.iter().map(|outcome| &outcome.modes).collect();
    found.sort();
    should.sort();
    if found != should {
        differences.note(id, format!("{:?}: {found:?} instead of {should:?}", answer.verdict));
    }
    if answer.rank != Some(expected.rank) {
        differences.note(id, format!("rank {:?} instead of {}", answer.rank, expected.rank));
    }
    if let (Some(is), Some(should)) = (answer.index_sum, expected.index_sum)
        && is != should
    {
        differences.note(id, format!("index sum {is} instead of {should}"));
    }
    for outcome in &expected.outcomes {
        let Some(found) = answer.outcomes.iter().find(|found| found.modes == outcome.modes) else { continue };
        let place = format!("{id}, {}", outcome.modes.join("/"));
        compare_outcome(&place, problem, found, outcome, differences);
    }
}

fn compare_outcome(
    place: &str,
    problem: &Problem,
    found: &Outcome,
    should: &ExpectedOutcome,
    differences: &mut Differences,
) {
    let (before, after) = (problem.velocity_before.concat(), should.velocity_after.concat());
    let within = TOLERANCE * largest(&before).max(largest(&after));
    differences.compare(&format!("{place}: velocity"), &found.velocity_after.concat(), &after, within);
    if found.impulse_unique != should.impulse_unique {
        differences.note(place, format!("impulse_unique {}", found.impulse_unique));
    }
    if let (Some(is), Some(should)) = (found.index, should.index.or(should.index_extended))
        && is != should
    {
        differences.note(place, format!("index {is} instead of {should}"));
    }
    let (impulse, least) = (found.impulse.concat(), should.impulse.concat());
    if should.impulse_unique {
        differences.compare(&format!("{place}: impulse"), &impulse, &least, TOLERANCE * largest(&least));
        return;
    }
    // The impulse must explain the velocity, lie in its cones and be the least one.
    let reached = matrix(&problem.delassus) * nalgebra::DVector::from_vec(impulse.clone());
    let reached: Vec<f64> = before.iter().zip(&reached).map(|(before, gained)| before + gained).collect();
    differences.compare(&format!("{place}: c + G L"), &reached, &after, within);
    let size = TOLERANCE * largest(&impulse);
    for (contact, (mode, &[tangential, normal])) in should.modes.iter().zip(&found.impulse).enumerate() {
        if let Some(excess) = outside(mode, problem.friction(contact), tangential, normal).filter(|&by| by > size) {
            differences
                .note(place, format!("contact {contact}: {:?} leaves its cone by {excess:e}", [tangential, normal]));
        }
    }
    let squares = |impulse: &[f64]| impulse.iter().map(|entry| entry * entry).sum::<f64>();
    if squares(&impulse) > squares(&least) * (1.0 + 1e-6) {
        differences.note(place, format!("not the least impulse: {impulse:?} instead of {least:?}"));
    }
}

/// By how much an impulse violates what its contact's mode allows.
fn outside(mode: &str, friction: f64, tangential: f64, normal: f64) -> Option<f64> {
    let infinite = friction.is_infinite();
    let violations = match mode {
        "separate" => [tangential.abs(), normal.abs()],
        "stick" if infinite => [-normal, 0.0],
        "stick" => [-normal, tangential.abs() - friction * normal],
        "slide+" if infinite => [normal.abs(), tangential],
        "slide-" if infinite => [normal.abs(), -tangential],
        "slide+" => [-normal, (tangential + friction * normal).abs()],
        "slide-" => [-normal, (tangential - friction * normal).abs()],
        _ => [f64::INFINITY; 2],
    };
    violations.into_iter().reduce(f64::max)
}
