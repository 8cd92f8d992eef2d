//! The paper's models through their URDF files and the command, against `data/paper.json` (40-digit values): matrices,
//! the three cases and every outcome.
//!
//! Both sides use different coordinates; [`to_reference`] holds the transformation.

use std::sync::LazyLock;

use heelstrike::{Mode, Outcome, Verdict};
use nalgebra::DMatrix;
use serde_json::Value;

use crate::support::answers::{Answer, answers};
use crate::support::command::{file, read};
use crate::support::paper::{At, MODELS, Model, REFERENCE};
use crate::support::scaled::{Differences, largest, matrix};

/// Relative to the largest entry, contact velocity or impulse of the case.
const TOLERANCE: f64 = 1e-11;

/// A state of the reference and what the binary answers for it.
struct Case {
    model: &'static Model,
    place: String,
    friction: &'static str,
    reference: &'static At,
    answer: Answer,
}

/// Every state of the reference at every friction it is given for, answered once for all tests of this file.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let mut cases = Vec::new();
    for model in &MODELS {
        let (mut listed, mut states) = (Vec::new(), Vec::new());
        for (alpha, at) in &REFERENCE[model.name].at {
            for friction in at.outcomes.keys() {
                listed.push((format!("{}, alpha {alpha}, friction {friction}", model.name), friction, at));
                states.push(model.state(alpha.parse().expect("an angle"), at.pose.as_ref(), friction));
            }
        }
        for ((place, friction, reference), answer) in listed.into_iter().zip(impact(model, &states)) {
            cases.push(Case { model, place, friction, reference, answer });
        }
    }
    cases
});

/// Runs `impact` on a model's states.
fn impact(model: &Model, states: &[Value]) -> Vec<Answer> {
    let robot = urdf(model);
    answers(&["impact", &robot, "-", "--format", "json", "--matrices", "--explain"], states)
}

/// The path of the model's URDF file; one with another inertia is derived from the project's.
fn urdf(model: &Model) -> String {
    let source = format!("urdf/{}.urdf", model.urdf);
    let Some(inertia) = model.inertia else { return source };
    let text = read(&source);
    let of_file = "iyy=\"0.04\"";
    assert_eq!(text.matches(of_file).count(), 2, "{source}: the inertia of two legs");
    // Each call writes the same content.
    file(&format!("{}.urdf", model.name), text.replace(of_file, &format!("iyy=\"{inertia}\"")))
}

/// T of q_reference = T q_tool. Reference: angles counter-clockwise, the walkers' legs absolute [x, y, trailing,
/// leading]. Tool: pitch clockwise, joints relative.
fn to_reference(kneed: bool) -> DMatrix<f64> {
    let dofs = if kneed { 7 } else { 4 };
    let mut transformation = DMatrix::identity(dofs, dofs);
    transformation[(2, 2)] = -1.0;
    if !kneed {
        transformation[(3, 2)] = -1.0;
    }
    transformation
}

/// Modes in one order, to compare as sets.
fn sorted(mut modes: Vec<Vec<Mode>>) -> Vec<Vec<Mode>> {
    modes.sort();
    modes
}

/// The modes of all outcomes.
fn found(answer: &Answer) -> Vec<Vec<Mode>> {
    sorted(answer.outcomes.iter().map(|outcome| outcome.modes.clone()).collect())
}

/// Impulse and velocity after of a combination of modes, whether it is an outcome or rejected.
fn combination(answer: &Answer, modes: [Mode; 2]) -> Option<(Vec<f64>, Vec<f64>)> {
    if let Some(Outcome { impulse, velocity_after, .. }) = answer.outcomes.iter().find(|o| o.modes == modes) {
        return Some((impulse.concat(), velocity_after.concat()));
    }
    let rejected = answer.report.rejected.iter().flatten().find(|rejected| *rejected.modes == modes)?;
    Some((rejected.impulse.as_ref()?.concat(), rejected.velocity_after.as_ref()?.concat()))
}

#[test]
fn matrices_are_those_of_the_paper() {
    let mut differences = Differences::default();
    for case in CASES.iter() {
        let (place, at, answer) = (&case.place, case.reference, &case.answer.report);
        let turn = to_reference(case.model.kneed);
        let joints: &[&str] =
            if case.model.kneed { &["left_hip", "left_knee", "right_hip", "right_knee"] } else { &["hip"] };
        let coordinates: Vec<&str> = answer.coordinates.iter().flat_map(|all| all.iter()).map(String::as_str).collect();
        differences.same(place, coordinates, [&["x", "z", "pitch"], joints].concat());
        let touching: Vec<_> = answer.contacts.iter().filter_map(|contact| contact.link.as_deref()).collect();
        differences.same(place, &touching[..], &case.model.feet());
        let mass = turn.transpose() * matrix(&at.mass_matrix) * &turn;
        differences.compare_matrix(&format!("{place}: M"), &answer.mass_matrix, &mass, TOLERANCE);
        let jacobian = matrix(&at.contact_jacobian) * &turn;
        differences.compare_matrix(&format!("{place}: J"), &answer.contact_jacobian, &jacobian, TOLERANCE);
        differences.compare_matrix(&format!("{place}: G"), &answer.delassus, &matrix(&at.delassus), TOLERANCE);
        let (before, should) = (case.answer.velocity_before(), &at.contact_velocity_before);
        differences.compare(&format!("{place}: c before"), &before, should, TOLERANCE * largest(should));
    }
    differences.finish();
}

/// The three cases of the trailing foot, with the leading foot stopped and infinite friction. The reference lists c_x,
/// c_y, L_x, L_y of the trailing foot alone.
#[test]
fn the_three_cases_are_among_outcomes_and_rejections() {
    let mut differences = Differences::default();
    for case in CASES.iter().filter(|case| case.friction == "infinite") {
        for (name, &[c_x, c_y, l_x, l_y]) in &case.reference.three_cases {
            let place = format!("{}: {name}", case.place);
            let trailing = match name.as_str() {
                "lift_off" => Mode::Separate,
                "stop" => Mode::Stick,
                "slide" if c_x > 0.0 => Mode::SlidePlus,
                "slide" => Mode::SlideMinus,
                _ => panic!("{place}: what case is this?"),
            };
            let Some((impulse, velocity)) = combination(&case.answer, [trailing, Mode::Stick]) else {
                differences.note(&place, format!("{trailing}, stick is not listed with its numbers"));
                continue;
            };
            // The leading foot's impulse follows from c_le+ = 0: G_le,le L_le = -(c_le + G_le,tr L_tr).
            let delassus = matrix(&case.reference.delassus);
            let before = &case.reference.contact_velocity_before;
            let pull = [2, 3].map(|row| before[row] + delassus[(row, 0)] * l_x + delassus[(row, 1)] * l_y);
            let (a, b, d) = (delassus[(2, 2)], delassus[(2, 3)], delassus[(3, 3)]);
            let leading = [b * pull[1] - d * pull[0], b * pull[0] - a * pull[1]].map(|l| l / (a * d - b * b));

            let should = [l_x, l_y, leading[0], leading[1]];
            differences.compare(&format!("{place}: L"), &impulse, &should, TOLERANCE * largest(&should));
            let should = [c_x, c_y, 0.0, 0.0];
            let size = largest(&should).max(largest(before));
            differences.compare(&format!("{place}: c after"), &velocity, &should, TOLERANCE * size);
        }
    }
    differences.finish();
}

#[test]
fn every_outcome_is_found_and_no_other() {
    let mut differences = Differences::default();
    for case in CASES.iter() {
        let (place, expected, answer) = (&case.place, &case.reference.outcomes[case.friction], &case.answer);
        let modes = expected.iter().map(|outcome| outcome.modes.to_vec()).collect();
        differences.same(place, found(answer), sorted(modes));
        let verdict = if expected.len() == 1 { Verdict::Unique } else { Verdict::Ambiguous };
        differences.same(place, (answer.report.verdict, answer.report.index_sum), (Some(verdict), Some(Some(1))));
        for outcome in expected {
            let Some(found) = answer.outcomes.iter().find(|found| found.modes == outcome.modes) else { continue };
            let place = format!("{place}: {:?}", outcome.modes);
            let size = largest(&outcome.velocity_after).max(largest(&case.reference.contact_velocity_before));
            let velocity = found.velocity_after.concat();
            differences.compare(&format!("{place}: c after"), &velocity, &outcome.velocity_after, TOLERANCE * size);
            let size = largest(&outcome.impulse);
            differences.compare(&format!("{place}: L"), &found.impulse.concat(), &outcome.impulse, TOLERANCE * size);
            differences.same(&place, (found.impulse_unique, &found.border), (true, &None));
        }
    }
    differences.finish();
}
