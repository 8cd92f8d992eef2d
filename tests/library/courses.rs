//! Curves of outcomes along a parameter, compared with single states, and the units of parameters.

use crate::support::scaled::largest;
use crate::sweep::command::straight;
use crate::sweep::studies::with;
use heelstrike::impact::{Explanation, Mode, Motion};
use heelstrike::sweep::{CurvePoint, RegionCurves, RobotStudy, Solver, Survey, Workers};
use serde_json::{Value, json};
use std::f64::consts::TAU;

const MINIMALISTIC: &str = include_str!("../../urdf/minimalistic.urdf");

/// Calls `ask` with a study of the minimalistic walker, which turns at `rate`, over its leg angle.
fn walk<T>(friction: Value, rate: &str, ask: impl FnOnce(&RobotStudy) -> T) -> T {
    let mut study = straight(None);
    study["parameters"]["alpha"] = json!({"from": 0.001, "to": 1.5, "steps": 40});
    study["state"]["friction"] = friction;
    study["state"]["velocity"]["base"]["pitch"] = json!(rate);
    with(MINIMALISTIC, &study, 2, ask)
}

fn curves(model: &RobotStudy) -> (Survey, Vec<RegionCurves>) {
    let survey = Survey::of(model, Workers { threads: 2, done: &|| () });
    let curves = RegionCurves::of(model, &survey, Workers { threads: 2, done: &|| () });
    (survey, curves)
}

/// Contact velocities after the impact, and impulses.
fn numbers(motion: &Motion) -> [Vec<f64>; 2] {
    [&motion.velocity_after, &motion.impulse].map(|pairs| pairs.concat())
}

fn angles(explanation: &Explanation) -> Vec<f64> {
    [&explanation.beta, &explanation.gamma].into_iter().flatten().copied().collect()
}

#[test]
fn a_curve_goes_from_border_to_border() {
    walk(json!("infinite"), "-1", |model| {
        let (survey, curves) = curves(model);
        assert_eq!(curves.len(), 4);
        for (region, RegionCurves { places }) in survey.regions.iter().zip(&curves) {
            let (first, last) = (places.first().expect("a place"), places.last().expect("a place"));
            for (inside, border) in [(first.at - region.from, "from"), (region.to - last.at, "to")] {
                assert!((0.0..1e-8).contains(&inside), "{border}: {inside}");
            }
            assert!(places.windows(2).all(|pair| pair[0].at < pair[1].at));
            let modes: Vec<Vec<Mode>> = first.outcomes.iter().map(|(modes, _)| modes.clone()).collect();
            assert_eq!(region.regime.outcomes(), Some(&modes[..]));
        }
    });
}

#[test]
fn straight_lines_stay_near_the_outcomes() {
    // Half a pixel of 200, relative to the largest number; for angles half a pixel of 100, relative to a turn.
    const SEEN: f64 = 2.5e-3;
    // Where between two places a line is compared: not at their middle, where the refinement looked.
    const SHARE: f64 = 0.3;
    let line = |a: f64, b: f64| a + SHARE * (b - a);
    // The last rate swings so fast that even points alone would not show it.
    for (friction, rate) in
        [(json!("infinite"), "-1"), (json!(1), "-1"), (json!(10), "-1"), (json!(1), "-1 - 0.3*sin(60*alpha)")]
    {
        let mut compared = 0;
        walk(friction.clone(), rate, |model| {
            let mut solver = Solver::new(model);
            for RegionCurves { places } in curves(model).1 {
                let motions = || places.iter().flat_map(|place| &place.outcomes).map(|(_, motion)| numbers(motion));
                let scales = [0, 1].map(|kind| largest(&motions().flat_map(|of| of[kind].clone()).collect::<Vec<_>>()));
                for pair in places.windows(2) {
                    let at = line(pair[0].at, pair[1].at);
                    let analysis = solver.answer(&[at]).expect("an impact").analysis.expect("an analysis");
                    assert_eq!([pair[0].outcomes.len(), pair[1].outcomes.len()], [analysis.outcomes.len(); 2]);
                    for ((modes, a), (_, b)) in pair[0].outcomes.iter().zip(&pair[1].outcomes) {
                        compared += 1;
                        let own = analysis.outcomes.iter().find(|own| own.modes == *modes).expect("the outcome");
                        let own = [own.velocity_after.concat(), own.impulse.concat()];
                        let [a, b] = [a, b].map(numbers);
                        for (kind, scale) in scales.into_iter().enumerate() {
                            for ((a, b), own) in a[kind].iter().zip(&b[kind]).zip(&own[kind]) {
                                let off = (line(*a, *b) - own).abs();
                                assert!(off <= SEEN * scale, "{friction}, {at}: {off}");
                            }
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
        assert!(compared > 160, "{friction}, {rate}: {compared}");
    }
}

#[test]
fn parameter_has_the_unit_of_its_numbers() {
    let still = json!({"position": {"base": {"z": 1}}});
    for (state, leg, unit) in [
        (json!({"position": {"base": {"pitch": "k - p"}}}), json!({}), Some("rad")),
        (json!({"position": {"base": {"pitch": "p", "x": "sin(p)"}}}), json!({}), Some("rad")),
        (json!({"position": {"base": {"z": "p"}}}), json!({}), Some("m")),
        (json!({"velocity": {"base": {"z": "-p"}}}), json!({}), Some("m/s")),
        (json!({"velocity": {"joints": {"hip": "p"}}}), json!({}), Some("rad/s")),
        (still.clone(), json!({"mass": "p"}), Some("kg")),
        (still.clone(), json!({"inertia": "p + 1"}), Some("kg m²")),
        (still.clone(), json!({"com": [0, 0, "-p"]}), Some("m")),
        // No unit: no number is the parameter, up to its sign and a constant, or two such numbers have different units.
        (json!({"position": {"base": {"pitch": "2*p"}}}), json!({}), None),
        (json!({"position": {"base": {"pitch": "p^2"}}}), json!({}), None),
        (still, json!({"mass": "p", "inertia": "p"}), None),
        (json!({"velocity": {"base": {"z": 1, "x": 0}}}), json!({"mass": "3*p"}), None),
    ] {
        let mut study = json!({"parameters": {"p": {"from": 0.1, "to": 0.9, "steps": 3}}, "constants": {"k": 0.3},
            "robot": {"links": {"left_leg": leg}}, "state": state});
        study["state"]["friction"] = json!(1);
        assert_eq!(with(MINIMALISTIC, &study, 0, |model| model.unit(0)), unit, "{study}");
    }
}
