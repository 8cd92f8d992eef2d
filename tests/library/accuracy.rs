//! The suite of stiff and extreme cases: every case is answered with its condition number or refused with its reason,
//! and M and G keep their digits, compared with a reference of at least 256 bits.

use crate::support::impact::{outcomes, robot, velocities_after};
use crate::support::urdf::{self, HINGE, joint, link};
use heelstrike::accuracy::{Case, CaseStudy, CaseSubject, Expected, Factorization, Sampling, cases, of_state, study};
use heelstrike::dynamics::plan::{Configuration, Plan};
use heelstrike::dynamics::{Workspace, kinematics, kinetic_energy};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::{Defaults, State};
use heelstrike::{Reason, Robot};
use std::collections::BTreeSet;
use std::time::Duration;

/// A single run of each method, because the tests look at errors and not at times.
const ONCE: Sampling = Sampling { time: Duration::ZERO, samples: 1 };

/// The error of an entry, relative to its scale, that f64 may have if M is well conditioned.
const DIGITS: f64 = 1e-12;
/// The error that f64 may have per unit of the condition number of M.
const DIGITS_BY_CONDITION: f64 = 1e-15;

fn walk(choose: impl Fn(&Case) -> bool) {
    let chosen: Vec<Case> = cases().expect("the suite's robots are read").into_iter().filter(choose).collect();
    assert!(!chosen.is_empty());
    for case in chosen {
        let study = study(&case.name, &case.subject, &Options::default(), ONCE);
        match case.end {
            Expected::Singular => {
                let refused = study.refused.unwrap_or_else(|| panic!("{} must be refused", case.name));
                assert!(matches!(refused.reason(), Reason::Singular(_)), "{}: {refused}", case.name);
                assert!(refused.remedy().is_some(), "{}", case.name);
            }
            Expected::Answered => assert_answered(&study),
        }
    }
}

fn assert_answered(study: &CaseStudy) {
    let name = &study.name;
    assert!(study.refused.is_none(), "{name}: {:?}", study.refused);
    let answer = study.answer.as_ref().unwrap_or_else(|| panic!("{name} must be answered"));
    assert!(answer.outcomes > 0, "{name}: {answer:?}");
    assert!(answer.margin.is_none_or(f64::is_finite), "{name}: {answer:?}");
    // G has a condition number or does not have full rank.
    match study.condition.delassus {
        Some(condition) => assert!(condition.is_finite() && condition >= 1.0 - 1e-9, "{name}: {condition}"),
        None => assert!(answer.rank < Some(2 * study.contacts), "{name}: {answer:?}"),
    }
    let Some(condition) = study.condition.mass_matrix else { return };
    assert!(condition.is_finite() && condition >= 1.0 - 1e-9, "{name}: {condition}");
    let allowed = DIGITS.max(DIGITS_BY_CONDITION * condition);
    let mut seen = 0;
    for method in study.methods.iter().filter(|method| method.number == "f64" || method.number == "reference") {
        let Some(error) = method.error else { continue };
        let found = [error.mass_matrix, error.delassus].into_iter().flatten();
        // The comparison below also fails for a NaN.
        let allowed = if method.number == "reference" { 1e-60 } else { allowed };
        found.for_each(|error| assert!(error <= allowed, "{name}: {error:e} of {allowed:e} by {method:?}"));
        seen += 1;
    }
    assert_eq!(seen, 4, "{name}: three factorizations and the reference");
    let is_slow = |why: &str| why == "with more than 300 coordinates it takes seconds";
    let is_left_out = study.methods.iter().any(|method| method.left_out.is_some_and(is_slow));
    assert_eq!(is_left_out, name.starts_with("chain of 1000"), "{name}");
    let recursion = study
        .methods
        .iter()
        .find(|method| method.number == "f64" && method.factorization == Some(Factorization::ArticulatedBodies));
    // The recursion keeps them in every case: links of one size are no difficulty to it, however many are in a chain.
    let error = recursion.and_then(|method| method.error?.delassus).expect("computed");
    assert!(error <= DIGITS, "{name}: {error:e} by articulated bodies");
}

#[test]
fn chains_of_a_thousand_links_keep_their_digits() {
    walk(|case| case.name.starts_with("chain of 1000"));
}

#[test]
fn every_other_case_keeps_its_digits() {
    walk(|case| !case.name.starts_with("chain of 1000"));
}

/// Asserts that the kinetic energy after each outcome, summed link by link, is the energy before minus `energy_loss`.
fn assert_energy(name: &str, robot: &Robot, state: &State) -> Box<Impact> {
    let impact = Pipeline::new(robot, Options::default()).impact(state).expect("an answer");
    let (plan, mut configuration, mut workspace) =
        (Plan::new(robot, &[], &[]), Configuration::default(), Workspace::default());
    configuration.set(&plan, &state.position);
    kinematics(&plan, &configuration, &mut workspace);
    assert!(outcomes(&impact).iter().any(|outcome| outcome.energy_loss > 0.0));
    for (outcome, after) in outcomes(&impact).iter().zip(velocities_after(&impact)) {
        let (energy, left) =
            (kinetic_energy(&plan, &after, &workspace, &mut Vec::new()), impact.kinetic_energy - outcome.energy_loss);
        assert!((energy - left).abs() <= DIGITS * impact.kinetic_energy, "{name}: {energy} {left}");
    }
    impact
}

#[test]
fn velocities_keep_their_digits_in_chains() {
    for case in cases().expect("read").into_iter().filter(|case| case.name.starts_with("chain of 100 links")) {
        let CaseSubject::State(subject) = &case.subject else { panic!("a state") };
        let impact = assert_energy(&case.name, &subject.0, &subject.1);
        let effort = impact.analyzed().expect("few contacts").effort;
        // f64 decides most combinations, but a straight chain has signs that are exactly zero.
        assert!(2 * effort.bound > effort.combinations(), "{}: {effort:?}", case.name);
        for (outcome, after) in outcomes(&impact).iter().zip(velocities_after(&impact)) {
            // The first contact is at the root's origin and moves as the base does.
            for (base, contact) in after.iter().zip(outcome.velocity_after[0]) {
                assert!((base - contact).abs() <= DIGITS, "{}: {base} {contact}", case.name);
            }
        }
    }
}

#[test]
fn mimic_joints_take_their_part_of_the_impact() {
    let link = |name: &str, z: f64| link(name, 1.0, [0.0, z], 0.1, "");
    let follows = r#"<mimic joint="hip" multiplier="-2" offset="0.1"/>"#;
    let robot = robot(&urdf::robot(&[
        [link("torso", 0.2), link("thigh", -0.2), link("shin", -0.2)].concat(),
        joint("hip", HINGE, ["torso", "thigh"], [0.0; 2], ""),
        joint("knee", HINGE, ["thigh", "shin"], [0.0, -0.5], follows),
    ]));
    let state = r#"{"friction": 0.7, "contacts": [{"link": "shin", "offset": [0, 0, -0.5]}],
        "position": {"joints": {"hip": 0.4}}, "velocity": {"base": {"x": 0.3, "z": -1}, "joints": {"hip": 0.5}}}"#;
    let state = State::from_json(state, &robot, &Defaults::default()).expect("a state");
    let impact = assert_energy("mimic", &robot, &state);
    assert!(impact.analysis.expect("outcomes").proven);
    assert_compared("mimic", &robot, &state);
}

/// Asserts that every method that supports mimic joints and loops keeps its digits of M, G and the outcomes.
fn assert_compared(name: &str, robot: &Robot, state: &State) {
    let study = of_state(name, robot, state, &Options::default(), ONCE);
    assert!(study.answer.as_ref().is_some_and(|answer| answer.proven), "{name}: {:?}", study.refused);
    let mut tried = 0;
    for method in study.methods.iter().filter(|method| method.factorization.is_some() && method.left_out.is_none()) {
        let allowed = match method.number {
            "f32" => 1e-4,
            "f64" => DIGITS,
            "double-double" => 1e-28,
            _ => 1e-60,
        };
        let error = method.error.expect("an error");
        let found = [error.mass_matrix, error.delassus, error.outcome].into_iter().flatten();
        found.for_each(|error| assert!(error <= allowed, "{name}: {error:e} by {method:?}"));
        tried += usize::from(method.number == "reference" || error.mass_matrix.is_some() && error.outcome.is_some());
    }
    let left_out = study.methods.iter().filter(|method| method.left_out.is_some()).count();
    assert!(tried >= 4 && left_out >= 3, "{name}: {:?}", study.methods);
}

#[test]
fn loops_impulses_and_restitution_are_compared() {
    let robot = robot(include_str!("../../urdf/five_bar.urdf"));
    let text = include_str!("../../examples/five_bar.json").replace(
        r#""friction": 0.6"#,
        r#""friction": 0.6, "restitution": 0.3, "impulse": [{"link": "torso", "vector": [0.2, -0.1]}]"#,
    );
    let state = State::from_json(&text, &robot, &Defaults::default()).expect("a state");
    assert_compared("five bar", &robot, &state);
}

#[test]
fn no_case_stands_twice() {
    let names: Vec<String> = cases().expect("read").into_iter().map(|case| case.name).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
}
