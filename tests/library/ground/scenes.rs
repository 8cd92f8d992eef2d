//! Profiles together with other parts of a scene: named contacts, slopes, a stance, uncertainty.

use super::*;
use crate::support::impact::{modes, ramone};
use crate::support::random::Random;
use crate::support::urdf::{HINGE, POINT, collision, joint, link};
use heelstrike::impact::Verdict;
use heelstrike::pipeline::Pipeline;
use heelstrike::pipeline::robust::Robustness;
use heelstrike::state::{Ground, Profile};
use std::f64::consts::FRAC_1_SQRT_2;

/// Two legs of different length below a body, each with a point foot.
fn biped() -> Robot {
    let leg = |name: &str, x: f64, length: f64| {
        let link = link(name, 1.0, [0.0, -0.3], 0.05, &collision([0.0, -length], POINT));
        link + &joint(name, HINGE, ["body", name], [x, 0.0], "")
    };
    let body = link("body", 3.0, [0.0; 2], 0.2, "");
    robot(&urdf::robot(&[body, leg("rear", -0.2, 0.8), leg("front", 0.2, 0.5)]))
}

#[test]
fn feet_on_treads_act_as_contacts_on_level_ground() {
    let robot = biped();
    let state = |ground: &str| {
        format!(
            r#"{{"position": {{"base": {{"z": 0.8}}}}, "friction": 0.6,
                "velocity": {{"base": {{"x": 0.4, "z": -0.7, "pitch": 0.3}}, "joints": {{"rear": -0.5, "front": 1.1}}}}, {ground}}}"#
        )
    };
    let stairs = impact(&robot, state(r#""ground": {"profile": [[-1, 0], [0, 0], [1e-6, 0.3], [1, 0.3]]}"#));
    let named = impact(
        &robot,
        state(r#""contacts": [{"link": "rear", "offset": [0, 0, -0.8]}, {"link": "front", "offset": [0, 0, -0.5]}]"#),
    );
    assert_close(&[stairs.contacts[0].gap, stairs.contacts[1].gap], &[0.0; 2]);
    assert_close(&[named.contacts[1].gap], &[0.3]);
    assert_same_outcomes(&stairs, &named);
}

#[test]
fn a_straight_profile_is_a_slope() {
    let biped = biped();
    for slope in [-0.6_f64, -0.1, 0.0, 0.2, 0.6] {
        let rise = 3.0 * slope.tan();
        let grounds =
            [format!(r#"{{"slope": {slope:?}}}"#), format!(r#"{{"profile": [[-3, {:?}], [3, {rise:?}]]}}"#, -rise)];
        // Feet up to half a meter above or in the ground touch, so that there are two.
        let wide = || Options { contact_tolerance: Some(0.5), ..Options::default() };
        let [sloped, straight] = grounds.map(|ground| {
            let state = format!(
                r#"{{"stance": "rear", "position": {{"base": {{"pitch": 0.1}}, "joints": {{"rear": 0.1, "front": 0.2}}}},
                    "velocity": {{"base": {{"pitch": -0.6}}, "joints": {{"rear": 0.9, "front": 0.4}}}},
                    "friction": 0.8, "restitution": 0.2, "ground": {ground}}}"#
            );
            try_impact(&biped, wide(), state).expect("within the tolerance")
        });
        assert_eq!([sloped.contacts.len(), straight.contacts.len()], [2; 2], "{slope}");
        assert_same_outcomes(&sloped, &straight);

        let (sin, cos) = slope.sin_cos();
        let flat = [-0.1 * sin, 0.1 * cos, -slope];
        let found = impact(&sole(), state(flat, [0.4, -1.0, 0.3], 1, &[[-3.0, -rise], [3.0, rise]]));
        assert_touches(&found, &[[[-0.2 * cos, -0.2 * sin], [-sin, cos]], [[0.2 * cos, 0.2 * sin], [-sin, cos]]]);
    }
}

#[test]
fn a_stance_stands_on_the_profile_at_x_0() {
    let robot = sole();
    let state = |profile: &str, more: &str| {
        format!(r#"{{"stance": "body", "friction": 1{more}, "ground": {{"profile": {profile}}}}}"#)
    };
    let raised = impact(&robot, state("[[-1, 0.25], [1, 0.75]]", r#", "position": {"base": {"pitch": 0.1}}"#));
    assert_close(&raised.contacts[0].point.components(), &[0.0, 0.5]);
    assert_eq!(raised.velocity_before, [[0.0; 2]]);
    // At the foot of a riser a stance is on the tread: the rear end stands there, and the rest of the sole is in the
    // step.
    let error =
        try_impact(&robot, Options::default(), state("[[-1, 0], [0, 0], [1e-6, 0.15], [1, 0.15]]", "")).unwrap_err();
    assert!(matches!(error.reason(), Reason::Penetration { depth, .. } if (depth - 0.15).abs() < 1e-6), "{error}");
    let error = try_impact(&robot, Options::default(), state("[[1, 0], [2, 0]]", "")).unwrap_err();
    assert_eq!(error.place(), Some("stance"));
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("shift the profile")));
    let error = try_impact(&disc(), Options::default(), state("[[-1, 0], [0, 0], [1, 1]]", "")).unwrap_err();
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("shift the profile")), "{error}");
}

/// A foot rests even if the corner of the ground is under its circle's center only up to rounding.
#[test]
fn a_circle_that_stands_on_an_edge_rests_exactly() {
    let robot = ramone();
    let mut random = Random::new(5);
    let shapes = [
        json!([[-1, 0], [0, 0], [1, -0.1]]),
        json!([[-1, -0.1], [0, 0], [1, 0]]),
        json!([[-1, -0.2], [0, 0], [1, -0.2]]),
    ];
    for profile in shapes.iter().cycle().take(300) {
        let mut angle = || random.between(-0.2, 0.2);
        let text = json!({
            "stance": "left_foot", "friction": 0.6, "ground": {"profile": profile},
            "position": {"base": {"pitch": angle()},
                "joints": {"left_hip": angle(), "left_knee": angle(), "right_hip": 1, "right_knee": -2}},
            "velocity": {"base": {"pitch": angle()}, "joints": {"left_hip": angle(), "left_knee": angle()}},
        });
        let found = impact(&robot, &text);
        let analysis = found.analysis.as_ref().expect("few contacts");
        assert_eq!(analysis.verdict, Verdict::NoImpact, "{text}");
        assert!(analysis.proven && found.notes.is_empty(), "{text}: {:?}", found.notes);
    }
}

#[test]
fn a_circle_that_stands_in_a_notch_rests_on_one_side() {
    // A disc on level ground at x = 0 touches a wall of 45 degrees at (0.5 s, 0.5 - 0.5 s), s = sin 45: the wall begins
    // where its line meets z = 0.
    let notch = 0.5 * FRAC_1_SQRT_2 - (0.5 - 0.5 * FRAC_1_SQRT_2);
    let text = format!(
        r#"{{"stance": "body", "friction": 1, "velocity": {{"base": {{"pitch": 1}}}},
            "ground": {{"profile": [[-3, 0], [{notch:?}, 0], [{:?}, 3]]}}}}"#,
        notch + 3.0
    );
    let found = impact(&disc(), &text);
    let s = FRAC_1_SQRT_2;
    assert_touches(&found, &[[[0.0, 0.0], [0.0, 1.0]], [[0.5 * s, 0.5 - 0.5 * s], [-s, s]]]);
    // It rolls at 1 rad/s: its center moves at 0.5 m/s forward, and the wall's point, (0.5 s, -0.5 s) from the center,
    // at (-0.5 s, -0.5 s) relative to it.
    assert_eq!(found.velocity_before[0], [0.0; 2]);
    let [x, z] = [0.5 - 0.5 * s, -0.5 * s];
    assert_close(&found.velocity_before[1], &[s * x + s * z, -s * x + s * z]);
}

#[test]
fn uncertain_state_keeps_its_contacts() {
    let with = |mut state: Value, uncertainty: Value| {
        state["uncertainty"] = uncertainty;
        impact(&disc(), state)
    };
    // A disc on an edge with uncertain pitch touches the same edge with the same normal.
    let (sin, cos) = 0.4_f64.sin_cos();
    let text = state([0.5 * sin, 0.5 * cos, 0.0], FALLING, 0.6, &[[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]]);
    let found = with(text, json!({"position": 1e-3, "velocity": 1e-3}));
    assert!(matches!(found.holds, Some(Robustness::Everywhere)), "{:?}", found.holds);
    // On a tread at 0.9 m/s: L_t = 0.9 / (1 / m + r^2 / I) = 0.9, L_n = 2. It sticks where friction is more than 0.45.
    let text = state([-1.0, 0.5, 0.0], [-0.9, -1.0, 0.0], 0.5, &[[-3.0, 0.0], [3.0, 0.0]]);
    let found = with(text, json!({"friction": 0.25}));
    let Some(Robustness::Not(other)) = &found.holds else { panic!("{:?}", found.holds) };
    let profile = Profile::new(vec![Vector::new(-3.0, 0.0), Vector::new(3.0, 0.0)]);
    assert_eq!(other.state.scene.ground, Ground::Profile(profile.unwrap()));
    let again = Pipeline::new(&disc(), Options::default()).impact(&other.state).expect("an answer");
    assert_eq!(modes(&again), other.outcomes);
}
