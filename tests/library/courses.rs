//! Curves of outcomes along a parameter against single states, and the units of parameters.

use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::impact::{Explanation, Mode, Motion};
use heelstrike::pipeline::Options;
use heelstrike::robot::Reduction;
use heelstrike::state::Defaults;
use heelstrike::sweep::{CurvePoint, RESOLUTION, RegionCurves, RobotStudy, Solver, Study, Survey, Workers};
use std::f64::consts::TAU;

const MINIMALISTIC: &str = include_str!("../../urdf/minimalistic.urdf");

/// The minimalistic walker against its leg angle.
fn walk(friction: &str) -> String {
    format!(
        "{{\"parameters\": {{\"alpha\": {{\"from\": 0.001, \"to\": 1.5, \"steps\": 40}}}}, \
         \"state\": {{\"position\": {{\"base\": {{\"pitch\": \"-alpha\"}}, \"joints\": {{\"hip\": \"-2*alpha\"}}}}, \
         \"velocity\": {{\"base\": {{\"pitch\": -1}}}}, \"stance\": \"left_leg\", \"friction\": {friction}}}}}"
    )
}

/// Asks about the model of a study.
fn with<T>(study: &str, ask: impl FnOnce(&RobotStudy) -> T) -> T {
    let study = Study::from_json(study).expect("a study");
    let description = Description::from_urdf(MINIMALISTIC).expect("a description");
    let reduction = Reduction::default();
    let robot = Robot::reduce(&description, &reduction).expect("a robot");
    let options = Options { explain_up_to: 2, ..Options::default() };
    let (study, robot) = (&study, &robot);
    let description = &description;
    ask(&RobotStudy { study, description, reduction: &reduction, robot, options, defaults: Defaults::default() })
}

fn courses(model: &RobotStudy) -> (Survey, Vec<RegionCurves>) {
    let workers = Workers { threads: 2, done: &|| () };
    let survey = Survey::of(model, workers);
    let courses = RegionCurves::of(model, &survey, workers);
    (survey, courses)
}

/// All numbers of an outcome, velocities before impulses.
fn numbers(motion: &Motion) -> Vec<f64> {
    [&motion.velocity_after, &motion.impulse].into_iter().flatten().flatten().copied().collect()
}

fn angles(explanation: &Explanation) -> Vec<f64> {
    [&explanation.beta, &explanation.gamma].into_iter().flatten().copied().collect()
}

#[test]
fn a_course_goes_from_border_to_border() {
    with(&walk("\"infinite\""), |model| {
        let (survey, courses) = courses(model);
        assert_eq!(courses.len(), 4);
        for (region, RegionCurves { places }) in survey.regions.iter().zip(&courses) {
            let (first, last) = (places.first().expect("a place"), places.last().expect("a place"));
            for (inside, border) in [(first.at - region.from, "from"), (region.to - last.at, "to")] {
                assert!((0.0..=2.0 * RESOLUTION * 1.499).contains(&inside), "{border}: {inside}");
            }
            assert!(places.windows(2).all(|pair| pair[0].at < pair[1].at));
            let modes: Vec<Vec<Mode>> = first.outcomes.iter().map(|(modes, _)| modes.clone()).collect();
            assert_eq!(region.regime.outcomes(), Some(&modes[..]));
        }
    });
}

#[test]
fn straight_lines_between_places_stay_by_the_outcomes() {
    // Off by less than half a pixel of 200; angles of a hundred.
    const SEEN: f64 = 2.5e-3;
    for friction in ["\"infinite\"", "1", "10"] {
        with(&walk(friction), |model| {
            let mut solver = Solver::new(model);
            for RegionCurves { places } in courses(model).1 {
                let all = || places.iter().flat_map(|place| &place.outcomes).map(|(_, motion)| numbers(motion));
                let half = all().next().map_or(0, |first| first.len() / 2);
                let largest = |range: std::ops::Range<usize>| {
                    all()
                        .flat_map(|all| all[range.clone()].to_vec())
                        .fold(0.0, |most: f64, number| most.max(number.abs()))
                };
                let scales = [largest(0..half), largest(half..2 * half)];
                for pair in places.windows(2) {
                    // A third, which is no place that was looked at.
                    let share = 0.3;
                    let at = pair[0].at + share * (pair[1].at - pair[0].at);
                    let analysis = solver.impact(&[at]).expect("an impact").analysis.expect("an analysis");
                    let line = |a: f64, b: f64| a + share * (b - a);
                    let ends = pair[0].outcomes.iter().zip(&pair[1].outcomes);
                    for ((modes, a), (_, b)) in ends {
                        let own =
                            analysis.outcomes.iter().find(|outcome| outcome.modes == *modes).expect("the outcome");
                        let (velocity_after, impulse) = (own.velocity_after.clone(), own.impulse.clone());
                        let own = numbers(&Motion { velocity_after, impulse });
                        for (index, ((a, b), own)) in numbers(a).iter().zip(numbers(b)).zip(own).enumerate() {
                            let off = (line(*a, b) - own).abs();
                            assert!(off <= SEEN * scales[index / half], "{friction}, {at}: {off}");
                        }
                    }
                    let explained = |place: &CurvePoint| angles(place.explanation.as_ref().expect("regular"));
                    let own = angles(&analysis.explanation.expect("regular"));
                    for ((a, b), own) in explained(&pair[0]).into_iter().zip(explained(&pair[1])).zip(own) {
                        let b = a + libm::remainder(b - a, TAU);
                        let off = libm::remainder(line(a, b) - own, TAU).abs();
                        assert!(off <= 2.0 * SEEN * TAU, "{friction}, {at}: {off}");
                    }
                }
            }
        });
    }
}

#[test]
fn courses_are_the_same_for_any_number_of_threads() {
    with(&walk("1"), |model| {
        let survey = Survey::of(model, Workers { threads: 1, done: &|| () });
        let places = |threads: usize| -> Vec<f64> {
            let courses = RegionCurves::of(model, &survey, Workers { threads, done: &|| () });
            courses.iter().flat_map(|course| &course.places).map(|place| place.at).collect()
        };
        assert_eq!(places(1), places(5));
    });
}

#[test]
fn a_parameter_has_the_unit_of_the_numbers_that_it_is() {
    let of = |state: &str, robot: &str| {
        let study = format!(
            "{{\"parameters\": {{\"p\": {{\"from\": 0.1, \"to\": 0.9, \"steps\": 3}}}}, \"constants\": {{\"k\": 0.3}}, \
             \"robot\": {{{robot}}}, \"state\": {{{state}, \"friction\": \"{}\"}}}}",
            if state.contains("mu") { "p" } else { "1" }
        );
        with(&study, |model| model.unit(0))
    };
    let links = |fields: &str| format!("\"links\": {{\"left_leg\": {{{fields}}}}}");
    let base = |kind: &str, value: &str| format!("\"{kind}\": {{\"base\": {{{value}}}}}");
    let still = base("position", "\"z\": 1");
    for (state, robot, unit) in [
        (base("position", "\"pitch\": \"k - p\""), String::new(), Some("rad")),
        (base("position", "\"pitch\": \"p\", \"x\": \"sin(p)\""), String::new(), Some("rad")),
        (base("position", "\"z\": \"p\""), String::new(), Some("m")),
        (base("velocity", "\"z\": \"-p\""), String::new(), Some("m/s")),
        ("\"velocity\": {\"joints\": {\"hip\": \"p\"}}".to_owned(), String::new(), Some("rad/s")),
        (still.clone(), links("\"mass\": \"p\""), Some("kg")),
        (still.clone(), links("\"inertia\": \"p + 1\""), Some("kg m²")),
        (still.clone(), links("\"com\": [0, 0, \"-p\"]"), Some("m")),
        // Not the parameter itself, or no unit, or two.
        (base("position", "\"pitch\": \"2*p\""), String::new(), None),
        (base("position", "\"pitch\": \"p^2\""), String::new(), None),
        (still.clone(), links("\"mass\": \"p\", \"inertia\": \"p\""), None),
        (base("position", "\"z\": 1, \"x\": 0").replace("position", "velocity"), links("\"mass\": \"3*p\""), None),
    ] {
        assert_eq!(of(&state, &robot), unit, "{state} {robot}");
    }
}
