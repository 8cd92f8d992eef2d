//! Feet that roll over many corners, of the foot or of the ground, between two samples, and the work of a search.
//!
//! ```text
//!     corner k --roll--> both --> corner k + 1: at each roll a stretch with two contacts, as wide as the tolerance
//! ```

use crate::support::command::file;
use crate::support::subject::Subject;
use crate::support::urdf::{body, collision};
use crate::sweep::command::{Sweep, written};
use heelstrike::pipeline::Options;
use heelstrike::sweep::{Landscape, Probe, RESOLUTION, Regime, RobotStudy, Solver, Study, Watched, brackets};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::sync::Arc;

/// The middles of the regions in which two points touch.
fn doubles(sweep: &Sweep) -> Vec<f64> {
    let double = sweep.regions.iter().filter(|region| region.contacts.as_ref().is_some_and(|all| all.len() == 2));
    double.map(|region| 0.5 * (region.from + region.to)).collect()
}

/// Asserts the middles of all regions with two contacts.
fn assert_doubles(sweep: &Sweep, expected: &[f64], within: f64) {
    let found = doubles(sweep);
    assert_eq!(found.len(), expected.len(), "{found:?} instead of {expected:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < within), "{found:?} instead of {expected:?}");
}

/// The study of a robot over its place or pitch s, at its lowest above the ground, with 20 samples.
fn lowest([from, to]: [f64; 2], position: Value, ground: Value) -> Value {
    json!({"parameters": {"s": {"from": from, "to": to, "steps": 20}}, "state": {"friction": 0.2,
        "place": "lowest", "position": {"base": position}, "velocity": {"base": {"x": 4, "z": -1}}, "ground": ground}})
}

/// The wheel's twelve corners are those of three squares. It rolls over 3 to 10 of them between two samples.
#[test]
fn every_roll_of_a_wheel_with_corners_is_seen() {
    let side = |pitch: f64| {
        format!(
            r#"<collision><origin xyz="0 0 0" rpy="0 {pitch} 0"/><geometry><box size="1 1 1"/></geometry></collision>"#
        )
    };
    let wheel = file("wheel.urdf", body(0.3, &[0.0, PI / 6.0, PI / 3.0].map(side).concat()));
    for rolls in [57, 190] {
        let range = [0.01, 0.01 + f64::from(rolls) * PI / 6.0];
        let study = lowest(range, json!({"pitch": "s"}), json!({"slope": 0}));
        // A side of the wheel is level at every multiple of 30 degrees.
        let level: Vec<f64> = (1..=rolls).map(|k| f64::from(k) * PI / 6.0).collect();
        assert_doubles(&written(&wheel, &study, &["--contact-tolerance", "1e-6"]), &level, 1e-8);
    }
}

/// A flat sole on a hill of 21 corners rolls from one to the next, and lies on each of the segments in between.
#[test]
fn every_roll_over_corners_of_the_ground_is_seen() {
    let sole = file("sole.urdf", body(0.3, &collision([0.0; 2], "box size=\"1 1 1\"")));
    let place = |k: u32| 0.02 * f64::from(k) - 0.2;
    let hill: Vec<[f64; 2]> = (0..=20).map(place).map(|x| [x, -1.25 * x * x]).collect();
    // The pitch of a sole is positive if it descends.
    let level: Vec<f64> = (0..20).map(|k| (1.25 * (place(k) + place(k + 1))).atan()).collect();
    for range in [[-0.5, 0.5], [-0.45, 0.31]] {
        let study = lowest(range, json!({"pitch": "s"}), json!({"profile": hill}));
        let within: Vec<f64> = level.iter().copied().filter(|at| (range[0]..range[1]).contains(at)).collect();
        assert_doubles(&written(&sole, &study, &["--contact-tolerance", "1e-6"]), &within, 1e-6);
    }
}

/// A round foot over a saw of ground is in each notch for a moment, and touches both of its sides.
#[test]
fn every_notch_under_a_wheel_is_seen() {
    let wheel = file("wheel.urdf", body(0.3, &collision([0.0; 2], "sphere radius=\"0.1\"")));
    let saw: Vec<[f64; 2]> = (-30..=30).map(|k| [0.05 * f64::from(k), 0.01 * f64::from(k & 1)]).collect();
    for notches in [3_i32, 9, 14] {
        let reach = 0.1 * f64::from(notches) + 0.031;
        let study = lowest([-reach, reach + 0.007], json!({"x": "s"}), json!({"profile": saw}));
        let expected: Vec<f64> = (-notches..=notches).map(|k| 0.1 * f64::from(k)).collect();
        assert_doubles(&written(&wheel, &study, &["--contact-tolerance", "1e-6"]), &expected, 1e-8);
    }
}

/// A solver that answers only so many questions.
struct Limited<'s, 'm> {
    solver: &'s mut Solver<'m>,
    left: usize,
}

impl Limited<'_, '_> {
    fn count(&mut self) {
        self.left = self.left.checked_sub(1).expect("fewer questions");
    }
}

impl Landscape for Limited<'_, '_> {
    fn regime(&mut self, at: f64) -> Arc<Regime> {
        self.count();
        self.solver.regime(&[at])
    }

    fn watched(&mut self, at: f64) -> Option<Arc<Watched>> {
        self.count();
        self.solver.watched(&[at])
    }
}

/// A wheel stands on four tips of a saw, 1e-5 m apart, whose equations are nearly the same: most inequalities are only
/// rounding there, and the outcomes are the same everywhere.
#[test]
fn signs_of_rounding_are_not_searched() {
    let saw: Vec<[f64; 2]> = (-50..=50).map(|k| [1e-5 * f64::from(k), 2e-6 * f64::from(k & 1)]).collect();
    let mut study = lowest([-4e-6, 4e-6], json!({"x": "s"}), json!({"profile": saw}));
    study["parameters"]["s"]["steps"] = json!(6);
    study["state"]["friction"] = json!("infinite");
    study["state"]["velocity"] = json!({"base": {"x": 1, "z": -1, "pitch": 0.3}});
    let wheel = Subject::new("wheel", &body(0.3, &collision([0.0; 2], "sphere radius=\"0.1\"")));
    let text = study.to_string();
    let study = Study::from_json(&text).expect("a study");
    let options = Options { contact_tolerance: Some(1e-8), ..Options::default() };
    let model = RobotStudy { options, ..wheel.model(&study) };
    let (parameter, mut solver) = (&study.parameters()[0], Solver::new(&model));
    let places: Vec<f64> = (0..parameter.steps).map(|index| parameter.sample(index)).collect();
    let samples: Vec<Probe> = places.iter().map(|&at| Probe { at, regime: solver.regime(&[at]) }).collect();
    for pair in samples.windows(2) {
        assert_eq!((pair[0].regime.contacts().len(), &pair[0].regime), (4, &pair[1].regime));
        let mut line = Limited { solver: &mut solver, left: 50 };
        assert_eq!(brackets(&mut line, &pair[0], &pair[1], RESOLUTION * parameter.range()), []);
    }
}
