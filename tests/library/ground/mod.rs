//! Profiles: where feet touch steps, edges, notches and gaps, with which normals, and what comes of it, against cases
//! worked by hand.
//!
//! Signs: x forward, z up, a positive pitch dips the nose; a body that turns at w moves its point at (x, z) from the
//! CoG at w (z, -x), and an impulse (Lx, Lz) there turns it by I w = z Lx - x Lz.

mod by_hand;
mod corners;
mod depth;
mod invariances;
mod level;
mod scenes;

use crate::support::after::velocities_after;
use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::planar::Vector;
use heelstrike::state::{Defaults, State};
use heelstrike::{Error, Reason, Robot};

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
    impact.contacts.iter().map(|contact| [contact.point, contact.normal()].map(Vector::components)).collect()
}

#[track_caller]
fn assert_touches(impact: &Impact, expected: &[[[f64; 2]; 2]]) {
    assert_close(touches(impact).as_flattened().as_flattened(), expected.as_flattened().as_flattened());
}

/// The impulses and the velocity by coordinate of the only outcome.
fn only_outcome(impact: &Impact) -> (&[[f64; 2]], Vec<f64>) {
    let analysis = impact.analysis.as_ref().expect("an analysis");
    assert_eq!(analysis.verdict, Verdict::Unique);
    assert!(analysis.proven);
    (&analysis.outcomes[0].impulse, analysis.outcomes[0].velocity().collect())
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
    let velocities = velocities_after(one).into_iter().zip(velocities_after(other));
    let near = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    for ((a, b), (before, after)) in outcomes.zip(velocities) {
        assert_eq!(a.modes, b.modes);
        assert!(near(a.impulse.as_flattened(), b.impulse.as_flattened()), "{:?} {:?}", a.impulse, b.impulse);
        assert!(near(&before, &after), "{before:?} {after:?}");
    }
}
