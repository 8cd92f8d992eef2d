//! Profiles: where feet touch steps, edges, notches and gaps, with which normals, and what comes of it, against cases
//! worked by hand.
//!
//! Signs: x forward, z up, a positive pitch dips the nose; a body that turns at w moves its point at (x, z) from the CoG at
//! w (z, -x), and an impulse (Lx, Lz) there turns it by I w = z Lx - x Lz.

use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::scene::{Ground, Profile};
use heelstrike::state::{Defaults, State};
use heelstrike::uncertain::Holds;
use heelstrike::{Error, Reason, Robot};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// A body of 2 kg and 0.5 kg m^2 with one collision shape.
fn body(shape: &str) -> Robot {
    let text = format!(
        r#"<robot name="body"><link name="body">
            <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="1"/></inertial>
            <collision>{shape}</collision>
        </link></robot>"#
    );
    Robot::from_urdf(&text).expect("a good robot")
}

/// A box 0.4 m long and 0.2 m high.
fn sole() -> Robot {
    body(r#"<geometry><box size="0.4 0.1 0.2"/></geometry>"#)
}

/// A disc of radius 0.5 m.
fn disc() -> Robot {
    body(r#"<geometry><sphere radius="0.5"/></geometry>"#)
}

fn point() -> Robot {
    body(r#"<geometry><sphere radius="0"/></geometry>"#)
}

fn try_impact(robot: &Robot, options: Options, state: &str) -> Result<Impact, Error> {
    Pipeline::new(robot, options).impact(&State::from_json(state, robot, &Defaults::default())?)
}

fn impact(robot: &Robot, state: &str) -> Impact {
    try_impact(robot, Options::default(), state).unwrap_or_else(|error| panic!("{error}: {state}"))
}

/// The body at `[x, z, pitch]` with velocity `[x, z, pitch]` over a profile.
fn state(position: [f64; 3], velocity: [f64; 3], friction: &str, profile: &[[f64; 2]]) -> String {
    state_on(position, velocity, friction, &format!(r#"{{"profile": {profile:?}}}"#))
}

fn state_on(position: [f64; 3], velocity: [f64; 3], friction: &str, ground: &str) -> String {
    let ([x, z, pitch], [u, w, rate]) = (position, velocity);
    format!(
        r#"{{"position": {{"base": {{"x": {x:?}, "z": {z:?}, "pitch": {pitch:?}}}}},
            "velocity": {{"base": {{"x": {u:?}, "z": {w:?}, "pitch": {rate:?}}}}},
            "friction": {friction}, "ground": {ground}}}"#
    )
}

const FALLING: [f64; 3] = [0.0, -1.0, 0.0];

/// Rounding of a few operations on numbers of order one.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64]) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 64.0 * f64::EPSILON);
    assert!(near && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

/// Points and normals of all contacts.
fn touches(impact: &Impact) -> Vec<[[f64; 2]; 2]> {
    impact.contacts.iter().map(|contact| [contact.point, contact.normal()]).collect()
}

#[track_caller]
fn assert_touches(impact: &Impact, expected: &[[[f64; 2]; 2]]) {
    assert_close(touches(impact).as_flattened().as_flattened(), expected.as_flattened().as_flattened());
}

/// The impulses and the velocity by coordinate of the only outcome.
fn only_outcome(impact: &Impact) -> (&[[f64; 2]], &[f64]) {
    let analysis = impact.analysis.as_ref().expect("an analysis");
    assert_eq!(analysis.verdict, Verdict::Unique);
    assert!(analysis.proven);
    (&analysis.outcomes[0].impulse, &impact.velocity_after[0])
}

fn depth(robot: &Robot, state: &str) -> f64 {
    let error = try_impact(robot, Options::default(), state).expect_err("too deep");
    let Reason::Penetration { link, depth, .. } = error.reason() else { panic!("{error}") };
    assert_eq!(link, "body");
    *depth
}

/// A step down of `height` at x = `edge`, its riser 1e-6 m wide.
fn step_down(edge: f64, height: f64) -> [[f64; 2]; 4] {
    [[-2.0, 0.0], [edge, 0.0], [edge + 1e-6, -height], [2.0, -height]]
}

/// A step up.
fn step_up(edge: f64, height: f64) -> [[f64; 2]; 4] {
    [[-2.0, 0.0], [edge, 0.0], [edge + 1e-6, height], [2.0, height]]
}

#[test]
fn a_sole_across_an_edge_stands_on_its_corner_and_on_the_edge() {
    let found = impact(&sole(), &state([0.0, 0.1, 0.0], FALLING, "0.5", &step_down(0.1, 0.2)));
    assert_touches(&found, &[[[-0.2, 0.0], [0.0, 1.0]], [[0.1, 0.0], [0.0, 1.0]]]);
    assert_close(&found.contacts[1].centre, &[0.1, -0.1]);
    // The CoG is between both: the box stops. L1 + L2 = 2 kg * 1 m/s, and 0.2 L1 = 0.1 L2 keeps it from turning. What both
    // could squeeze along the ground is free, and least at none.
    let (impulse, after) = only_outcome(&found);
    assert_close(impulse.as_flattened(), &[0.0, 2.0 / 3.0, 0.0, 4.0 / 3.0]);
    assert_close(after, &[0.0; 3]);
}

#[test]
fn a_sole_whose_weight_is_beyond_the_edge_tips_over_it() {
    let found = impact(&sole(), &state([0.0, 0.1, 0.0], FALLING, "0", &step_down(-0.1, 0.2)));
    assert_touches(&found, &[[[-0.2, 0.0], [0.0, 1.0]], [[-0.1, 0.0], [0.0, 1.0]]]);
    // The edge, 0.1 m behind the CoG, alone: L = 1 / (1 / m + x^2 / I) = 1 / 0.52, I w = 0.1 L; the rear corner rises.
    let (impulse, after) = only_outcome(&found);
    let l = 1.0 / 0.52;
    assert_close(impulse.as_flattened(), &[0.0, 0.0, 0.0, l]);
    assert_close(after, &[0.0, l / 2.0 - 1.0, 0.1 * l / 0.5]);
}

#[test]
fn a_tilted_sole_on_an_edge_touches_along_its_own_normal() {
    // The middle of the sole on the edge, the nose 0.3 rad down beyond it.
    let (sin, cos) = 0.3_f64.sin_cos();
    let place = [0.1 * sin, 0.1 * cos, 0.3];
    let found = impact(&sole(), &state(place, FALLING, "\"infinite\"", &step_down(0.0, 1.0)));
    assert_touches(&found, &[[[0.0, 0.0], [sin, cos]]]);
    // Seen along t = (cos, -sin) and n = (sin, cos): c = (sin, -cos). The normal goes through the CoG, 0.1 m away:
    // L_n = m cos, L_t = -sin / (1 / m + 0.1^2 / I) = -sin / 0.52; the point at -0.1 n turns it by I w = -0.1 L_t.
    let (impulse, after) = only_outcome(&found);
    let [t, n] = [-sin / 0.52, 2.0 * cos];
    assert_close(&impulse[0], &[t, n]);
    assert_close(after, &[(t * cos + n * sin) / 2.0, -1.0 + (n * cos - t * sin) / 2.0, -0.1 * t / 0.5]);
}

#[test]
fn a_disc_strikes_a_convex_corner_along_the_line_to_its_centre() {
    for angle in [-0.7, -0.2, 0.4, 1.2] {
        let (sin, cos) = f64::sin_cos(angle);
        // A ridge too steep for the disc to touch beside its top.
        let ridge = [[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]];
        let found = impact(&disc(), &state([0.5 * sin, 0.5 * cos, 0.0], FALLING, "\"infinite\"", &ridge));
        assert_touches(&found, &[[[0.0, 0.0], [sin, cos]]]);
        // c = (sin, -cos); G_tt = 1 / m + r^2 / I = 0.5 + 0.25 / 0.5.
        let (impulse, after) = only_outcome(&found);
        let [t, n] = [-sin, 2.0 * cos];
        assert_close(&impulse[0], &[t, n]);
        assert_close(after, &[(t * cos + n * sin) / 2.0, -1.0 + (n * cos - t * sin) / 2.0, -0.5 * t / 0.5]);
    }
}

#[test]
fn a_disc_in_a_notch_touches_both_sides() {
    let found = impact(&disc(), &state([0.0, 0.5 * SQRT_2, 0.0], FALLING, "0", &[[-3.0, 3.0], [0.0, 0.0], [3.0, 3.0]]));
    let r = 0.5 * FRAC_1_SQRT_2;
    let s = FRAC_1_SQRT_2;
    assert_touches(&found, &[[[-r, r], [s, s]], [[r, r], [-s, s]]]);
    assert_eq!([&found.contacts[0].name, &found.contacts[1].name], ["body/0", "body/1"]);
    // Both push up by L / sqrt 2 and take 2 kg m/s.
    let (impulse, after) = only_outcome(&found);
    assert_close(impulse.as_flattened(), &[0.0, SQRT_2, 0.0, SQRT_2]);
    assert_close(after, &[0.0; 3]);
}

#[test]
fn a_point_in_a_notch_touches_both_sides_and_stops() {
    let found = impact(&point(), &state([0.0; 3], FALLING, "0", &[[-3.0, 3.0], [0.0, 0.0], [3.0, 3.0]]));
    let s = FRAC_1_SQRT_2;
    assert_touches(&found, &[[[0.0, 0.0], [s, s]], [[0.0, 0.0], [-s, s]]]);
    assert_close(only_outcome(&found).1, &[0.0; 3]);
}

#[test]
fn a_toe_against_a_riser_touches_tread_and_riser() {
    // The box pushes its toe into the corner of the step: treads carry it, the riser takes its forward momentum.
    let stairs = [[-2.0, 0.0], [0.2, 0.0], [0.2 + 1e-9, 0.5], [2.0, 0.5]];
    let found = impact(&sole(), &state([0.0, 0.1, 0.0], [1.0, -1.0, 0.0], "0", &stairs));
    let up = [0.0, 1.0];
    let points: Vec<[f64; 2]> = found.contacts.iter().map(|contact| contact.point).collect();
    assert_close(points.as_flattened(), &[-0.2, 0.0, 0.2, 0.0, 0.2, 0.0, 0.2, 0.2]);
    assert_eq!([found.contacts[0].normal(), found.contacts[1].normal()], [up, up]);
    for contact in &found.contacts[2..] {
        let [x, z] = contact.normal();
        assert!(x == -1.0 && (z - 2e-9).abs() < 1e-15, "{:?}", contact.normal());
    }
    // A riser of 1e-9 m a half metre leans by 2e-9.
    let after = only_outcome(&found).1;
    assert!(after.iter().all(|speed| speed.abs() < 1e-8), "{after:?}");
}

/// Two legs of different length below a body, each with a point foot.
const BIPED: &str = r#"<robot name="biped">
    <link name="body"><inertial><mass value="3"/><inertia ixx="1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="1"/></inertial></link>
    <link name="rear"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 -0.8"/><geometry><sphere radius="0"/></geometry></collision></link>
    <link name="front"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 -0.5"/><geometry><sphere radius="0"/></geometry></collision></link>
    <joint name="rear" type="revolute"><origin xyz="-0.2 0 0"/><parent link="body"/><child link="rear"/><axis xyz="0 1 0"/>
        <limit effort="0" velocity="0"/></joint>
    <joint name="front" type="revolute"><origin xyz="0.2 0 0"/><parent link="body"/><child link="front"/><axis xyz="0 1 0"/>
        <limit effort="0" velocity="0"/></joint></robot>"#;

#[track_caller]
fn assert_same_outcomes(one: &Impact, other: &Impact) {
    let analyses = [one, other].map(|impact| impact.analysis.as_ref().expect("an analysis"));
    assert_eq!(analyses[0].verdict, analyses[1].verdict);
    assert_eq!(analyses[0].outcomes.len(), analyses[1].outcomes.len());
    let outcomes = analyses[0].outcomes.iter().zip(&analyses[1].outcomes);
    let velocities = one.velocity_after.iter().zip(&other.velocity_after);
    let near = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    for ((a, b), (before, after)) in outcomes.zip(velocities) {
        assert_eq!(a.modes, b.modes);
        assert!(near(a.impulse.as_flattened(), b.impulse.as_flattened()), "{:?} {:?}", a.impulse, b.impulse);
        assert!(near(before, after), "{before:?} {after:?}");
    }
}

#[test]
fn feet_on_different_treads_act_as_contacts_named_on_level_ground() {
    let robot = Robot::from_urdf(BIPED).expect("a good robot");
    let state = |ground: &str| {
        format!(
            r#"{{"position": {{"base": {{"z": 0.8}}}}, "friction": 0.6,
                "velocity": {{"base": {{"x": 0.4, "z": -0.7, "pitch": 0.3}}, "joints": {{"rear": -0.5, "front": 1.1}}}}, {ground}}}"#
        )
    };
    let stairs = impact(&robot, &state(r#""ground": {"profile": [[-1, 0], [0, 0], [1e-6, 0.3], [1, 0.3]]}"#));
    let named = impact(
        &robot,
        &state(r#""contacts": [{"link": "rear", "offset": [0, 0, -0.8]}, {"link": "front", "offset": [0, 0, -0.5]}]"#),
    );
    assert_close(&[stairs.contacts[0].gap, stairs.contacts[1].gap], &[0.0; 2]);
    assert_close(&[named.contacts[1].gap], &[0.3]);
    assert_same_outcomes(&stairs, &named);
}

#[test]
fn a_straight_profile_is_a_slope() {
    let biped = Robot::from_urdf(BIPED).expect("a good robot");
    for slope in [-0.6_f64, -0.1, 0.0, 0.2, 0.6] {
        let rise = 3.0 * slope.tan();
        let grounds =
            [format!(r#"{{"slope": {slope:?}}}"#), format!(r#"{{"profile": [[-3, {:?}], [3, {rise:?}]]}}"#, -rise)];
        // Feet half a metre or less above and in the ground touch, so that there are two.
        let wide = || Options { contact_tolerance: Some(0.5), ..Options::default() };
        let state = |ground: &String| {
            format!(
                r#"{{"stance": "rear", "position": {{"base": {{"pitch": 0.1}}, "joints": {{"rear": 0.1, "front": 0.2}}}},
                    "velocity": {{"base": {{"pitch": -0.6}}, "joints": {{"rear": 0.9, "front": 0.4}}}},
                    "friction": 0.8, "restitution": 0.2, "ground": {ground}}}"#
            )
        };
        let [sloped, straight] =
            grounds.each_ref().map(|ground| try_impact(&biped, wide(), &state(ground)).expect("within the tolerance"));
        assert_eq!([sloped.contacts.len(), straight.contacts.len()], [2; 2], "{slope}");
        assert_same_outcomes(&sloped, &straight);

        let (sin, cos) = slope.sin_cos();
        let flat = [-0.1 * sin, 0.1 * cos, -slope];
        let found = impact(&sole(), &state_on(flat, [0.4, -1.0, 0.3], "1", &grounds[1]));
        assert_touches(&found, &[[[-0.2 * cos, -0.2 * sin], [-sin, cos]], [[0.2 * cos, 0.2 * sin], [-sin, cos]]]);
    }
}

#[test]
fn a_stance_stands_on_the_profile_at_x_0() {
    let robot = sole();
    let state = |profile: &str, more: &str| {
        format!(r#"{{"stance": "body", "friction": 1{more}, "ground": {{"profile": {profile}}}}}"#)
    };
    let raised = impact(&robot, &state("[[-1, 0.25], [1, 0.75]]", r#", "position": {"base": {"pitch": 0.1}}"#));
    assert_close(&raised.contacts[0].point, &[0.0, 0.5]);
    assert_eq!(raised.velocity_before, [[0.0; 2]]);
    // Of the two segments at the foot of a riser it is the tread; the rear end stands there, and the rest is in the step.
    let error =
        try_impact(&robot, Options::default(), &state("[[-1, 0], [0, 0], [1e-6, 0.15], [1, 0.15]]", "")).unwrap_err();
    assert!(matches!(error.reason(), Reason::Penetration { depth, .. } if (depth - 0.15).abs() < 1e-6), "{error}");
    let error = try_impact(&robot, Options::default(), &state("[[1, 0], [2, 0]]", "")).unwrap_err();
    assert_eq!(error.place(), Some("stance"));
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("shift the profile")));
}

#[test]
fn a_circle_that_stands_in_a_notch_rests_on_one_side() {
    // The notch is at (0.5 - 0.5 sin, ...) = where the disc that stands level at x = 0 touches a wall at 45 degrees, too.
    let away = 0.5 * (FRAC_1_SQRT_2 + FRAC_1_SQRT_2 - 1.0);
    let notch = 0.5 * FRAC_1_SQRT_2 - (0.5 - 0.5 * FRAC_1_SQRT_2);
    assert!(away > 0.0);
    let text = format!(
        r#"{{"stance": "body", "friction": 1, "velocity": {{"base": {{"pitch": 1}}}},
            "ground": {{"profile": [[-3, 0], [{notch:?}, 0], [{:?}, 3]]}}}}"#,
        notch + 3.0
    );
    let found = impact(&disc(), &text);
    let s = FRAC_1_SQRT_2;
    assert_touches(&found, &[[[0.0, 0.0], [0.0, 1.0]], [[0.5 * s, 0.5 - 0.5 * s], [-s, s]]]);
    // It rolls at 1 rad/s: the centre at 0.5 m/s forward; the wall's point, at (0.5 s, -0.5 s) from there, moves by
    // (-0.5 s, -0.5 s) more.
    assert_eq!(found.velocity_before[0], [0.0; 2]);
    let [x, z] = [0.5 - 0.5 * s, -0.5 * s];
    assert_close(&found.velocity_before[1], &[s * x + s * z, -s * x + s * z]);
}

#[test]
fn over_a_gap_and_beyond_an_end_there_is_nothing() {
    let gap = [[-1.0, 0.0], [-0.1, 0.0], [-0.1 + 1e-6, -5.0], [0.1 - 1e-6, -5.0], [0.1, 0.0], [1.0, 0.0]];
    let over = impact(&point(), &state([0.0; 3], FALLING, "1", &gap));
    assert!(over.contacts.is_empty());
    assert_eq!(over.analysis.unwrap().verdict, Verdict::NoContact);
    assert_eq!(over.notes.len(), 1);
    assert!(over.notes[0].contains("the nearest foot, body, is 0.09999"), "{:?}", over.notes);
    // A sole bridges it: both edges carry.
    let bridge = impact(&sole(), &state([0.0, 0.1, 0.0], FALLING, "1", &gap));
    assert_eq!(bridge.contacts.len(), 4);
    let beyond = impact(&sole(), &state([1.1, 0.1, 0.0], FALLING, "1", &gap));
    assert_touches(&beyond, &[[[0.9, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]]);
    assert_eq!(beyond.notes, ["body reaches beyond the end of the ground's profile at x = 1.0 m: there is no ground"]);
    let above = impact(&sole(), &state([1.1, 0.2, 0.0], FALLING, "1", &gap));
    assert!(above.contacts.is_empty() && above.notes.len() == 1, "{:?}", above.notes);
}

#[test]
fn a_foot_in_the_ground_is_refused_with_its_depth() {
    let near = |depth: f64, expected: f64| assert!((depth - expected).abs() < 2e-6, "{depth} is not {expected}");
    let level = [0.0; 3];
    // Its toe is 0.02 m in the riser.
    near(depth(&sole(), &state([0.02, 0.1, 0.0], level, "1", &step_up(0.2, 0.5))), 0.02);
    // It is 0.05 m in the tread, and then as a whole far below it.
    near(depth(&sole(), &state([-1.0, 0.05, 0.0], level, "1", &step_up(0.2, 0.5))), 0.05);
    near(depth(&sole(), &state([-1.0, -0.9, 0.0], level, "1", &step_up(0.2, 0.5))), 1.0);
    // Below the upper tread, where a lower one would still be far beneath.
    near(depth(&sole(), &state([-1.0, -0.2, 0.0], level, "1", &step_down(0.5, 3.0))), 0.3);
    // A disc, its centre above and below the ground.
    near(depth(&disc(), &state([-1.0, 0.4, 0.0], level, "1", &step_up(0.2, 0.5))), 0.1);
    near(depth(&disc(), &state([-1.0, -0.3, 0.0], level, "1", &step_up(0.2, 0.5))), 0.8);
    // A ridge pokes 0.03 m into a sole whose corners are free.
    near(depth(&sole(), &state([0.0, 0.1, 0.0], level, "1", &[[-1.0, -5.0], [0.0, 0.03], [1.0, -5.0]])), 0.03);
    // A thin pillar goes right through: no corner is inside of anything, and the shortest way out is along the box.
    let pillar = [[-1.0, -5.0], [-0.01, -5.0], [-0.009, 5.0], [0.009, 5.0], [0.01, -5.0], [1.0, -5.0]];
    let found = depth(&sole(), &state([0.0, 0.1, 0.0], level, "1", &pillar));
    assert!((0.1..0.25).contains(&found), "{found}");
}

#[test]
fn a_greater_tolerance_accepts_what_is_as_deep() {
    let text = state([0.0, 0.099, 0.0], FALLING, "0.5", &step_down(0.1, 0.2));
    assert!(try_impact(&sole(), Options::default(), &text).is_err());
    let wide = Options { contact_tolerance: Some(2e-3), ..Options::default() };
    let found = try_impact(&sole(), wide, &text).expect("within the tolerance");
    assert_touches(&found, &[[[-0.2, -1e-3], [0.0, 1.0]], [[0.1, -1e-3], [0.0, 1.0]]]);
    assert_close(&found.contacts.iter().map(|contact| contact.gap).collect::<Vec<_>>(), &[-1e-3; 2]);
}

#[test]
fn corners_on_corners_push_along_the_middle_of_what_both_allow() {
    // A point on the edge of a step: halfway between tread and riser.
    let edge = [[-2.0, 0.0], [0.0, 0.0], [1e-9, -2.0], [2.0, -2.0]];
    let s = FRAC_1_SQRT_2;
    let found = impact(&point(), &state([0.0; 3], FALLING, "1", &edge));
    assert_eq!(found.contacts.len(), 1);
    let [x, z] = found.contacts[0].normal();
    assert!((x - s).abs() < 1e-9 && (z - s).abs() < 1e-9);
    // A level sole whose toe ends at the edge: it lies flat, so the tread's normal. Its heel on the edge, the rest over the
    // void: all of the quarter between riser and tread.
    let flat = impact(&sole(), &state([-0.2, 0.1, 0.0], FALLING, "1", &edge));
    assert_touches(&flat, &[[[-0.4, 0.0], [0.0, 1.0]], [[0.0, 0.0], [0.0, 1.0]]]);
    let hung = impact(&sole(), &state([0.2, 0.1, 0.0], FALLING, "1", &edge));
    assert_eq!(hung.contacts.len(), 1);
    let [x, z] = hung.contacts[0].normal();
    assert!((x - s).abs() < 1e-9 && (z - s).abs() < 1e-9);
    // The heel of a sole that is pitched by -0.4 (nose up) allows -0.4 to pi/2 - 0.4 from upright toward +x; the edge 0 to
    // pi/2. The middle of both is pi/4 - 0.2.
    let (sin, cos) = 0.4_f64.sin_cos();
    // The heel at (-0.2, -0.1) of the body, turned: (cos x + sin' z, cos z - sin' x) with sin' = sin(-0.4).
    let heel = [-0.2 * cos + 0.1 * sin, -0.1 * cos - 0.2 * sin];
    let tilted = impact(&sole(), &state([-heel[0], -heel[1], -0.4], FALLING, "1", &edge));
    let angle = std::f64::consts::FRAC_PI_4 - 0.2;
    assert_eq!(tilted.contacts.len(), 1);
    let [x, z] = tilted.contacts[0].normal();
    assert!((x - angle.sin()).abs() < 1e-9 && (z - angle.cos()).abs() < 1e-9, "{x} {z}");
}

#[test]
fn a_spot_touches_once() {
    // Whatever the overhang, from well beyond the tolerance to nothing and back, and whether the sole is a hair above or in
    // the tread: two contacts with the tread's normal.
    for overhang in [-1e-3, -1e-7, -1e-9, -1e-15, 0.0, 1e-15, 1e-9, 1e-7, 1e-3] {
        for height in [-1e-9, -1e-16, 0.0, 1e-16, 1e-9] {
            let text = state([-0.2 + overhang, 0.1 + height, 0.0], FALLING, "1", &step_down(0.0, 0.5));
            let found = impact(&sole(), &text);
            assert_eq!(found.contacts.len(), 2, "{overhang} {height}: {:?}", touches(&found));
            for contact in &found.contacts {
                assert_eq!(contact.normal(), [0.0, 1.0], "{overhang} {height}");
                assert!((contact.gap - height).abs() < 1e-15, "{overhang} {height}: {}", contact.gap);
            }
        }
    }
}

#[test]
fn a_plate_without_thickness_lies_on_an_edge() {
    let plate = body(r#"<geometry><box size="0.4 0.1 0"/></geometry>"#);
    for height in [-1e-9, 0.0, 1e-9] {
        let found = impact(&plate, &state([0.0, height, 0.2], FALLING, "1", &step_down(0.0, 0.5)));
        assert_eq!(found.contacts.len(), 1, "{height}");
        assert_close(&found.contacts[0].normal(), &[0.2_f64.sin(), 0.2_f64.cos()]);
    }
}

/// A cylinder of radius 0.2 m and 0.5 m long whose axis is `yaw` off the plane's normal, toward x: its ends are ellipses,
/// 0.2 cos(yaw) by 0.2 m, at 0.25 sin(yaw) before and behind the CoG.
fn oblique(yaw: f64) -> Robot {
    body(&format!(
        r#"<origin rpy="1.5707963267948966 0 {yaw:?}"/><geometry><cylinder radius="0.2" length="0.5"/></geometry>"#
    ))
}

#[test]
fn an_oblique_cylinder_meets_segments_and_corners() {
    let yaw = 0.7_f64;
    let (robot, half, reach) = (oblique(yaw), 0.2 * yaw.cos(), 0.25 * yaw.sin());
    let near = |found: &Impact, expected: &[[[f64; 2]; 2]]| {
        let (found, expected) = (touches(found), expected.as_flattened().as_flattened());
        let found = found.as_flattened().as_flattened();
        assert!(
            found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
            "{found:?}"
        );
    };
    // Flat on a tread, and with its middle on an edge.
    let up = [0.0, 1.0];
    near(
        &impact(&robot, &state([-1.0, 0.2, 0.0], FALLING, "1", &step_down(0.0, 1.0))),
        &[[[-1.0 - reach, 0.0], up], [[-1.0 + reach, 0.0], up]],
    );
    near(
        &impact(&robot, &state([0.0, 0.2, 0.0], FALLING, "1", &step_down(0.0, 1.0))),
        &[[[-reach, 0.0], up], [[0.0, 0.0], up]],
    );
    // The front end at 45 degrees of its ellipse, (half cos s, 0.2 sin s) with s = -pi/4, on a ridge: its normal there is
    // along (cos s / half, sin s / 0.2).
    let s = FRAC_1_SQRT_2;
    let out = [s / half, -s / 0.2];
    let size = f64::hypot(out[0], out[1]);
    let place = [-reach - half * s, 0.2 * s, 0.0];
    let ridge = [[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]];
    near(&impact(&robot, &state(place, FALLING, "1", &ridge)), &[[[0.0, 0.0], [-out[0] / size, -out[1] / size]]]);
    // On a slope up: the front end reaches hypot(half sin, 0.2 cos) along the normal.
    let (sin, cos) = 0.5_f64.sin_cos();
    let far = f64::hypot(half * sin, 0.2 * cos);
    let place = [-reach - far * sin, far * cos, 0.0];
    let found = impact(&robot, &state(place, FALLING, "1", &[[-4.0 * cos, -4.0 * sin], [4.0 * cos, 4.0 * sin]]));
    let point = [-far * sin + half * half * sin / far, far * cos - 0.2 * 0.2 * cos / far];
    near(&found, &[[point, [-sin, cos]]]);
    // Sunk: by as much as it is too low.
    assert!((depth(&robot, &state([-1.0, 0.15, 0.0], [0.0; 3], "1", &step_down(0.0, 1.0))) - 0.05).abs() < 1e-12);
    assert!((depth(&robot, &state([0.0, 0.15, 0.0], [0.0; 3], "1", &ridge)) - 0.05).abs() < 1e-12);
    assert!((depth(&robot, &state([-1.0, -0.3, 0.0], [0.0; 3], "1", &step_down(0.0, 1.0))) - 0.5).abs() < 1e-12);
}

#[test]
fn a_box_of_uncertainty_keeps_the_contacts_of_its_state() {
    let with =
        |state: String, uncertainty: &str| state.replacen('{', &format!(r#"{{"uncertainty": {uncertainty}, "#), 1);
    // A disc on an edge, its pitch uncertain: the same edge with the same normal.
    let (sin, cos) = 0.4_f64.sin_cos();
    let text = state([0.5 * sin, 0.5 * cos, 0.0], FALLING, "0.6", &[[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]]);
    let found = impact(&disc(), &with(text, r#"{"position": 1e-3, "velocity": 1e-3}"#));
    assert!(matches!(found.holds, Some(Holds::Everywhere)), "{:?}", found.holds);
    // On a tread at 0.9 m/s: L_t = 0.9 / (1 / m + r^2 / I) = 0.9, L_n = 2. It sticks where friction is more than 0.45.
    let text = state([-1.0, 0.5, 0.0], [-0.9, -1.0, 0.0], "0.5", &[[-3.0, 0.0], [3.0, 0.0]]);
    let found = impact(&disc(), &with(text, r#"{"friction": 0.25}"#));
    let Some(Holds::Not(other)) = &found.holds else { panic!("{:?}", found.holds) };
    assert_eq!(other.state.scene.ground, Ground::Profile(Profile::new(vec![[-3.0, 0.0], [3.0, 0.0]]).unwrap()));
    let again = Pipeline::new(&disc(), Options::default()).impact(&other.state).expect("an answer");
    let modes: Vec<_> = again.analysis.unwrap().outcomes.into_iter().map(|outcome| outcome.modes).collect();
    assert_eq!(modes, other.outcomes);
}

#[test]
fn contacts_named_by_hand_take_the_nearest_ground() {
    let robot = point();
    let named = |x: f64, z: f64, radius: f64| {
        let text = format!(
            r#"{{"friction": 1, "contacts": [{{"link": "body", "offset": [{x}, 0, {z}], "radius": {radius}}}],
                "ground": {{"profile": [[-1, 0], [1, 0], [2, -1]]}}}}"#
        );
        let contact = impact(&robot, &text).contacts[0].clone();
        ([contact.normal()[0], contact.normal()[1], contact.gap], contact.point)
    };
    let s = FRAC_1_SQRT_2;
    assert_eq!(named(0.0, 2.0, 0.5), ([0.0, 1.0, 1.5], [0.0, 1.5]));
    assert_eq!(named(0.0, -0.25, 0.0), ([0.0, 1.0, -0.25], [0.0, -0.25]));
    assert_close(&named(2.0, 0.0, 0.0).0, &[s, s, s]);
    // Nearest to the corner, at 0.4 rad; and on it, in the middle of both normals.
    let (sin, cos) = 0.4_f64.sin_cos();
    assert_close(&named(1.0 + sin, cos, 0.5).0, &[sin, cos, 0.5]);
    let eighth = std::f64::consts::FRAC_PI_8;
    assert_close(&named(1.0, 0.0, 0.0).0, &[eighth.sin(), eighth.cos(), 0.0]);
    // Beyond an end the last segment goes on.
    assert_eq!(named(-5.0, 0.5, 0.0), ([0.0, 1.0, 0.5], [-5.0, 0.5]));
}

/// A walker over stairs, seen in a mirror where `mirrored` is -1: a box and a disc for feet.
#[derive(Debug, Clone)]
struct Walker {
    x: f64,
    pitch: f64,
    hips: [f64; 2],
    rates: [f64; 5],
    /// Width and rise of each step, from x = -1.3 on.
    steps: Vec<(f64, f64)>,
}

impl Walker {
    fn any() -> impl Strategy<Value = Self> {
        let steps = prop::collection::vec((0.15..0.6, prop_oneof![-0.2..0.2, Just(0.0)]), 16);
        let rates = prop::array::uniform5(-1.0..1.0);
        let pitch = prop_oneof![Just(0.0), -0.4..0.4];
        let hips = (prop_oneof![Just(0.0), -0.6..0.6], -0.6..0.6);
        (-0.5..0.5, pitch, hips, rates, steps).prop_map(
            |(x, pitch, (one, other), rates, steps): (f64, f64, _, _, _)| {
                // The box is level half the time.
                let hip = if one == 0.0 { -pitch } else { one };
                Self { x, pitch, hips: [hip, other], rates, steps }
            },
        )
    }

    fn profile(&self) -> Vec<[f64; 2]> {
        let mut points = vec![[-1.3, 0.0]];
        for &(width, rise) in &self.steps {
            let [x, z] = points[points.len() - 1];
            points.push([x + width, z]);
            points.push([x + width + 0.01, z + rise]);
        }
        points
    }

    fn robot(mirrored: f64) -> Robot {
        let leg = |name: &str, x: f64, foot: &str| {
            format!(
                r#"<link name="{name}"><inertial><origin xyz="{} 0 -0.2"/><mass value="1"/>
                    <inertia ixx="1" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="1"/></inertial>
                    <collision><origin xyz="{} 0 -0.5"/><geometry>{foot}</geometry></collision></link>
                <joint name="{name}" type="revolute"><origin xyz="{} 0 -0.1"/><parent link="body"/><child link="{name}"/>
                    <axis xyz="0 1 0"/><limit effort="0" velocity="0"/></joint>"#,
                mirrored * 0.02,
                mirrored * 0.03,
                mirrored * x
            )
        };
        let legs = [leg("one", 0.2, r#"<box size="0.24 0.1 0.06"/>"#), leg("two", -0.15, r#"<sphere radius="0.07"/>"#)];
        let text = format!(
            r#"<robot name="walker"><link name="body"><inertial><origin xyz="{} 0 0.1"/><mass value="4"/>
                <inertia ixx="1" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="1"/></inertial></link>{}</robot>"#,
            mirrored * 0.05,
            legs.concat()
        );
        Robot::from_urdf(&text).expect("a good robot")
    }

    fn state(&self, mirrored: f64, height: f64, profile: &[[f64; 2]], shift: [f64; 2]) -> String {
        let [u, w, rate, one, two] = self.rates;
        let m = mirrored;
        format!(
            r#"{{"friction": 0.7, "ground": {{"profile": {profile:?}}},
                "position": {{"base": {{"x": {:?}, "z": {:?}, "pitch": {:?}}}, "joints": {{"one": {:?}, "two": {:?}}}}},
                "velocity": {{"base": {{"x": {:?}, "z": {w:?}, "pitch": {:?}}}, "joints": {{"one": {:?}, "two": {:?}}}}}}}"#,
            m * self.x + shift[0],
            height + shift[1],
            m * self.pitch,
            m * self.hips[0],
            m * self.hips[1],
            m * u,
            m * rate,
            m * one,
            m * two
        )
    }

    /// The height at which the walker touches, half of the tolerance above the one at which it is refused.
    fn landed(&self, robot: &Robot) -> f64 {
        let profile = self.profile();
        let (mut low, mut high) = (-5.0, 5.0);
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            match try_impact(robot, Self::options(), &self.state(1.0, middle, &profile, [0.0; 2])) {
                Ok(_) => high = middle,
                Err(_) => low = middle,
            }
        }
        high + 0.5 * Self::TOLERANCE
    }

    const TOLERANCE: f64 = 1e-6;

    fn options() -> Options {
        Options { contact_tolerance: Some(Self::TOLERANCE), ..Options::default() }
    }
}

fn sorted(mut numbers: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    // By coarse digits, so that rounding does not change the order.
    numbers.sort_by(|a, b| {
        let coarse = |row: &Vec<f64>| row.iter().map(|entry| (entry * 1e6).round() as i64).collect::<Vec<_>>();
        coarse(a).cmp(&coarse(b))
    });
    numbers
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_on_a_segment_change_nothing(walker in Walker::any(), cuts in prop::collection::vec(0.0..1.0, 32)) {
        let robot = Walker::robot(1.0);
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let mut fine = Vec::new();
        for (pair, cut) in profile.windows(2).zip(&cuts) {
            let [[x, z], [to_x, to_z]] = [pair[0], pair[1]];
            fine.push([x, z]);
            fine.push([x + cut * (to_x - x), z + cut * (to_z - z)]);
        }
        fine.push(profile[profile.len() - 1]);
        fine.dedup_by(|a, b| a[0] <= b[0]);
        let answer = |profile: &[[f64; 2]]| {
            try_impact(&robot, Walker::options(), &walker.state(1.0, height, profile, [0.0; 2])).expect("it touches")
        };
        let (coarse, fine) = (answer(&profile), answer(&fine));
        prop_assert!(!coarse.contacts.is_empty());
        prop_assert_eq!(coarse.contacts.len(), fine.contacts.len());
        assert_same_outcomes(&coarse, &fine);
    }

    #[test]
    fn a_shifted_scene_is_the_same(walker in Walker::any(), shift in prop::array::uniform2(-3.0..3.0)) {
        let robot = Walker::robot(1.0);
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let shifted: Vec<[f64; 2]> = profile.iter().map(|[x, z]| [x + shift[0], z + shift[1]]).collect();
        let answer = |profile: &[[f64; 2]], shift| {
            try_impact(&robot, Walker::options(), &walker.state(1.0, height, profile, shift)).expect("it touches")
        };
        let (here, there) = (answer(&profile, [0.0; 2]), answer(&shifted, shift));
        prop_assert_eq!(here.contacts.len(), there.contacts.len());
        // Risers 0.01 m wide turn by the rounding of their ends.
        assert_same_outcomes(&here, &there);
    }

    #[test]
    fn a_mirrored_scene_has_the_mirrored_outcomes(walker in Walker::any()) {
        let (robot, image) = (Walker::robot(1.0), Walker::robot(-1.0));
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let mirrored: Vec<[f64; 2]> = profile.iter().rev().map(|[x, z]| [-x, *z]).collect();
        let answer = |robot: &Robot, sign: f64, profile: &[[f64; 2]]| {
            try_impact(robot, Walker::options(), &walker.state(sign, height, profile, [0.0; 2])).expect("it touches")
        };
        let (one, other) = (answer(&robot, 1.0, &profile), answer(&image, -1.0, &mirrored));
        let flip = |impact: &Impact, sign: f64| -> Vec<Vec<f64>> {
            let of = |v: &Vec<f64>| v.iter().enumerate().map(|(at, v)| if at == 1 { *v } else { sign * v }).collect();
            impact.velocity_after.iter().map(of).collect()
        };
        prop_assert_eq!(one.contacts.len(), other.contacts.len());
        let (a, b) = (sorted(flip(&one, 1.0)), sorted(flip(&other, -1.0)));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.as_slice().concat().iter().zip(b.as_slice().concat()) {
            prop_assert!((a - b).abs() < 1e-10, "{:?} {:?}", one.velocity_after, other.velocity_after);
        }
    }
}
