//! What fuzzing found outside the analysis, one test for each.

use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::{Defaults, State};
use heelstrike::{Result, Robot};

fn impact(urdf: &str, state: &str) -> Result<Box<Impact>> {
    let robot = Robot::from_urdf(urdf)?;
    let state = State::from_json(state, &robot, &Defaults::default())?;
    Pipeline::new(&robot, Options::default()).impact(&state)
}

/// The change by the impulse was taken from the sum with a velocity next to which it vanishes, and the contact was
/// shown to separate and to press at once.
#[test]
fn an_impulse_is_not_lost_beside_a_great_velocity() {
    let state = r#"{"friction": 0.5, "stance": "right_foot",
        "position": {"base": {"pitch": 0.4}, "joints": {"left_hip": 0.5, "left_knee": 0.4, "right_knee": 2.0}},
        "velocity": {"base": {"pitch": -3e112}}, "contacts": [{"link": "right_foot"}],
        "impulse": [{"link": "left_thigh", "offset": [0.8, 0, -2.0], "vector": [-0.9, 1.0]}]}"#;
    let analysis =
        impact(include_str!("../../urdf/ramone.urdf"), state).expect("an answer").analysis.expect("outcomes");
    assert!(analysis.proven && analysis.verdict != Verdict::None);
    assert_eq!(analysis.index_sum, Some(1));
}

/// Heights were taken to be rounded as the distance is: whatever the depth, far away every foot touched.
#[test]
fn a_far_base_does_not_change_which_feet_touch() {
    let block = include_str!("../../urdf/block.urdf");
    let at = |x: f64, z: f64, slope: f64| {
        let state = format!(
            r#"{{"friction": 1, "position": {{"base": {{"x": {x:?}, "z": {z:?}}}}}, "ground": {{"slope": {slope}}}}}"#
        );
        impact(block, &state)
    };
    assert_eq!(at(-3e173, 10.0, 0.0).expect("above the ground").contacts.len(), 0);
    assert!(at(-3e173, -10.0, 0.0).expect_err("in the ground").to_string().contains("deep in the ground"));
    let lost = at(-3e173, 10.0, 0.1).expect_err("nobody knows where the ground is").to_string();
    assert!(lost.contains("so far from the world's origin"), "{lost}");
}

/// Without a contact nobody asked whether the velocity after the impulse is a number.
#[test]
fn an_impulse_beyond_all_numbers_is_refused() {
    let state = r#"{"friction": 1, "position": {"base": {"z": 9}}, "impulse": [{"link": "block", "offset": [9, 0, 0], "vector": [0, 1e308]}]}"#;
    let refused = impact(include_str!("../../urdf/block.urdf"), state).expect_err("an infinite velocity").to_string();
    assert!(refused.contains("a velocity after the applied impulses"), "{refused}");
}
