//! The paper's models through their URDF files and the command line, against `data/paper.json` (40-digit values):
//! matrices, the three cases, every outcome, the regions of the leg angle, the paper's Table 2 and its single body.
//!
//! Both sides use different coordinates; [`to_reference`] holds the transformation.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::LazyLock;

use heelstrike::{Mode, Outcome, Verdict};
use nalgebra::DMatrix;
use serde_json::{Value, json};

use crate::support::answers::{Answer, answers};
use crate::support::command::{file, read};
use crate::support::paper::{At, MODELS, Model, REFERENCE};
use crate::support::scaled::{Differences, largest, matrix};

/// To this share of the largest entry, contact velocity or impulse of the case.
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
    // A file per call: its content is always the same.
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

/// The numbers of the combination of modes, be it an outcome or rejected: impulse and velocity after.
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

/// Leading foot stopped, friction infinite; the reference lists c_x, c_y, L_x, L_y of the trailing foot alone.
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
            // The leading foot's impulse from c_le+ = 0, for the case's largest impulse: G_le,le L_le = -(c_le +
            // G_le,tr L_tr).
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

/// In the middle of every region and just inside its ends the outcomes are the region's: so the borders lie where the
/// reference has them.
#[test]
fn regions_of_the_leg_angle_are_the_reference_s() {
    const BESIDE: f64 = 1e-8;
    let mode = |name: &str| Mode::ALL.into_iter().find(|mode| mode.to_string() == name).expect("a mode");
    let list = |modes: &str| modes.split('/').map(mode).collect();
    let mut differences = Differences::default();
    for model in &MODELS {
        let (mut states, mut expected) = (Vec::new(), Vec::new());
        for (friction, regions) in &REFERENCE[model.name].regions {
            let start = |index: usize| regions.get(index).map(|(start, _)| start.parse::<f64>().expect("an angle"));
            for (index, (from, outcomes)) in regions.iter().enumerate() {
                let from: f64 = from.parse().expect("an angle");
                let next = start(index + 1);
                let middle = 0.5 * (from + next.unwrap_or(FRAC_PI_2));
                // The two outer ends are limits of the study, not borders.
                let first = (index > 0).then_some(from + BESIDE);
                for alpha in [first, Some(middle), next.map(|next| next - BESIDE)].into_iter().flatten() {
                    states.push(model.state(alpha, None, friction));
                    expected.push(sorted(outcomes.split('|').map(list).collect()));
                }
            }
        }
        for ((state, should), answer) in states.iter().zip(expected).zip(impact(model, &states)) {
            differences.same(state["id"].as_str().expect("a name"), found(&answer), should);
        }
    }
    differences.finish();
}

/// Table 2 prints c of lift-off, L of stop, c_x and L_x of the slide, in 1e-4 m/s and 1e-4 N s, for alpha = 0.5.
#[test]
fn table_2_comes_out_to_its_printed_digits() {
    const UNIT: f64 = 1e-4;
    const ROUNDED: f64 = 0.5e-3;
    // Exact is 0.82681, which rounds to 0.827: the paper's 0.826 is one off in its last digit.
    const LAST_DIGIT: f64 = 1e-3;
    let at = |case: &&Case| case.model.urdf == "ramone_paper" && case.place.contains("alpha 0.5,");
    let answer = &CASES.iter().find(at).expect("the state of Table 2").answer;
    let of = |trailing| combination(answer, [trailing, Mode::Stick]).expect("listed with its numbers");
    let (lift_off, stop, slide) = (of(Mode::Separate).1, of(Mode::Stick).0, of(Mode::SlidePlus));
    let mut differences = Differences::default();
    for (place, is, printed, digits) in [
        ("lift-off, c_x", lift_off[0], 0.826, LAST_DIGIT),
        ("lift-off, c_y", lift_off[1], -0.032, ROUNDED),
        ("stop, L_x", stop[0], -0.116, ROUNDED),
        ("stop, L_y", stop[1], -0.043, ROUNDED),
        ("slide, c_x", slide.1[0], 0.582, ROUNDED),
        ("slide, L_x", slide.0[0], -0.033, ROUNDED),
    ] {
        differences.compare(place, &[is / UNIT], &[printed], digits);
    }
    differences.finish();
}

/// With the center of percussion in the foot, at j = 0.24, all outcomes touch at alpha = pi/4. The f64 nearest to it
/// lies next to that point, and is reported as one.
#[test]
fn the_degenerate_walker_is_proven() {
    let model = MODELS.iter().find(|model| model.name == "pdw_j0.24").expect("the walker");
    let Answer { outcomes, report } = impact(model, &[model.state(FRAC_PI_4, None, "infinite")]).remove(0);
    let least = outcomes.iter().filter_map(|outcome| outcome.margin).fold(f64::INFINITY, f64::min);
    // pi/4 is off by 6e-17.
    assert!(report.proven == Some(true) && (0.0..1e-15).contains(&least), "{report:#?} {outcomes:#?}");
}

/// The paper's section 4: one body of mass 1 and inertia 1 with its CoG at (-1, 1) from the contact, G = [[2, 1], [1,
/// 2]]. An external impulse L_ext acts like the velocity before G L_ext; each region of its angle has its own outcomes.
#[test]
fn the_single_body_ends_as_its_region_says() {
    let model = Model { name: "block", urdf: "block", inertia: None, kneed: false };
    // Modes with impulse and velocity after: sticking takes L_ext up; sliding has L_n = 0 and c_n = 0 = G_nt (L_t +
    // L_ext,t) + G_nn L_ext,n.
    type Ends<'a> = &'a [(Mode, [f64; 2], [f64; 2])];
    let regions: [(&str, [f64; 2], Ends); 4] = [
        ("A", [1.0, 2.0], &[(Mode::Separate, [0.0, 0.0], [1.0, 2.0])]),
        ("B", [-7.0, -2.0], &[(Mode::SlideMinus, [2.0, 0.0], [-3.0, 0.0])]),
        ("C", [-1.0, -2.0], &[(Mode::Stick, [0.0, 1.0], [0.0, 0.0])]),
        (
            "E",
            [1.75, 0.5],
            &[
                (Mode::Separate, [0.0, 0.0], [1.75, 0.5]),
                (Mode::Stick, [-1.0, 0.25], [0.0, 0.0]),
                (Mode::SlidePlus, [-0.5, 0.0], [0.75, 0.0]),
            ],
        ),
    ];
    let state = |&(region, [x, z], _): &(&str, [f64; 2], Ends)| json!({"id": region, "velocity": {"base": {"x": x, "z": z}}, "friction": "infinite"});
    let states: Vec<Value> = regions.iter().map(state).collect();
    let mut differences = Differences::default();
    for ((region, before, ends), mut answer) in regions.into_iter().zip(impact(&model, &states)) {
        let delassus = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        differences.compare_matrix(&format!("{region}: G"), &answer.report.delassus, &delassus, TOLERANCE);
        answer.outcomes.sort_by(|a, b| a.modes.cmp(&b.modes));
        differences.same(region, found(&answer), ends.iter().map(|end| vec![end.0]).collect());
        for (outcome, (mode, impulse, velocity)) in answer.outcomes.iter().zip(ends) {
            let place = format!("{region}, {mode}");
            let (is, within) = (outcome.impulse.concat(), TOLERANCE * largest(impulse));
            differences.compare(&format!("{place}: L"), &is, impulse, within);
            let (is, within) = (outcome.velocity_after.concat(), TOLERANCE * largest(&before));
            differences.compare(&format!("{place}: c after"), &is, velocity, within);
        }
    }
    differences.finish();
}
