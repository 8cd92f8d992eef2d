//! Contact problems of other people's software, papers and textbooks (`data/problems.json`, solved exactly) through one
//! call of `solve`: modes, velocities, least impulses and their ranges, borders, families, indices and rank. All must
//! be proven.

use heelstrike::{Mode, Outcome};
use serde::Deserialize;
use serde_json::Value;

use crate::support::answers::{Answer, answers};
use crate::support::scaled::{Differences, largest, near};

/// Relative to the largest speed before or after, or to the largest impulse.
const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Problem {
    id: String,
    velocity_before: Vec<[f64; 2]>,
    expected: Expected,
}

#[derive(Deserialize)]
struct Expected {
    outcomes: Vec<ExpectedOutcome>,
    index_sum: Option<i32>,
    rank: usize,
    #[serde(default)]
    families: Vec<ExpectedFamily>,
}

/// A family that is a segment, given by its ends.
#[derive(Deserialize)]
struct ExpectedFamily {
    modes: Vec<Mode>,
    ends: [Vec<[f64; 2]>; 2],
}

#[derive(Deserialize)]
struct ExpectedOutcome {
    modes: Vec<Mode>,
    impulse: Vec<[f64; 2]>,
    velocity_after: Vec<[f64; 2]>,
    impulse_unique: bool,
    impulse_range: Option<Vec<[[Option<f64>; 2]; 2]>>,
    border: bool,
    #[serde(default)]
    family: bool,
    index: Option<i8>,
    /// Replaces `index` if the Schur complement of the sliding contacts is singular.
    index_extended: Option<i8>,
}

#[test]
fn the_problems_of_others_have_their_outcomes() {
    let text = include_str!("../data/problems.json");
    let problems: Vec<Problem> = serde_json::from_str(text).expect("the problems are readable");
    // The field `expected` does not belong to a problem and is not read.
    let inputs: Vec<Value> = serde_json::from_str(text).expect("JSON");
    let mut differences = Differences::default();
    for (problem, answer) in problems.iter().zip(answers(&["solve", "-", "--format", "json"], &inputs)) {
        compare(problem, &answer, &mut differences);
    }
    differences.finish();
}

fn compare(problem: &Problem, answer: &Answer, differences: &mut Differences) {
    let (id, expected, report) = (&problem.id, &problem.expected, &answer.report);
    if answer.outcomes.len() != expected.outcomes.len() {
        let found: Vec<_> = answer.outcomes.iter().map(|outcome| &outcome.modes).collect();
        differences.note(id, format!("{:?}: {found:?}, {} outcomes too many or few", report.verdict, found.len()));
    }
    // The references have no index sum if the part of a contact is defined by regularization.
    let index_sum = report.index_sum.flatten().filter(|_| expected.index_sum.is_some());
    let found = (report.proven, report.rank, index_sum);
    differences.same(id, found, (Some(true), Some(expected.rank), expected.index_sum));
    differences.same(id, report.families.len(), expected.families.len());
    for (family, should) in report.families.iter().zip(&expected.families) {
        let ends: Vec<_> =
            family.corners.iter().map(|&corner| answer.outcomes[corner].velocity_after.concat()).collect();
        let same = |end: &Vec<[f64; 2]>| ends.iter().any(|found| near(found, &end.concat(), TOLERANCE));
        differences.same(id, (&family.modes, family.dimension, ends.len()), (&should.modes, 1, 2));
        differences.same(id, should.ends.each_ref().map(same), [true; 2]);
    }
    for should in &expected.outcomes {
        let after = should.velocity_after.concat();
        let within = TOLERANCE * largest(&problem.velocity_before.concat()).max(largest(&after));
        let same = |found: &&Outcome| {
            let velocity = found.velocity_after.concat();
            found.modes == should.modes && velocity.iter().zip(&after).all(|(a, b)| (a - b).abs() <= within)
        };
        let place = format!("{id}, {:?}", should.modes);
        match answer.outcomes.iter().find(same) {
            Some(found) => compare_outcome(&place, found, should, differences),
            None => differences.note(&place, format!("no outcome with these modes and the velocity {after:?}")),
        }
    }
}

fn compare_outcome(place: &str, found: &Outcome, should: &ExpectedOutcome, differences: &mut Differences) {
    let flags = (found.impulse_unique, found.border.is_some(), found.family, found.proven, found.index);
    let index = should.index.or(should.index_extended);
    differences.same(place, flags, (should.impulse_unique, should.border, should.family, true, index));
    let (impulse, least) = (found.impulse.concat(), should.impulse.concat());
    let within = TOLERANCE * largest(&least);
    differences.compare(&format!("{place}: impulse"), &impulse, &least, within);
    match (&found.impulse_range, &should.impulse_range) {
        (None, None) => {}
        (Some(found), Some(should)) => {
            let [found, should] = [found, should].map(|range| range.concat().concat());
            let bounded = |range: &[Option<f64>]| range.iter().map(Option::is_some).collect::<Vec<_>>();
            differences.same(place, bounded(&found), bounded(&should));
            let numbers = |range: &[Option<f64>]| range.iter().flatten().copied().collect::<Vec<f64>>();
            let within = TOLERANCE * largest(&numbers(&should)).max(largest(&least));
            differences.compare(&format!("{place}: range"), &numbers(&found), &numbers(&should), within);
        }
        (found, should) => differences.note(place, format!("range {found:?} instead of {should:?}")),
    }
}
