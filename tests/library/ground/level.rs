//! Which points touch the ground: shapes, slopes, tolerances, stance, contacts named by hand, held joints, impulses.

use super::{body, sole};
use crate::support::after::velocities_after;
use heelstrike::impact::{Friction, Verdict};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::robot::{FootShape, Rim};
use heelstrike::state::{Defaults, State};
use heelstrike::{Error, Reason, Robot};

fn try_impact(robot: &Robot, options: Options, state: &str) -> Result<Impact, Error> {
    let defaults = Defaults { friction: Some(Friction::Finite(0.5)), ..Defaults::default() };
    Pipeline::new(robot, options).impact(&State::from_json(state, robot, &defaults)?)
}

fn impact(robot: &Robot, state: &str) -> Impact {
    try_impact(robot, Options::default(), state).expect("a good state")
}

fn names(impact: &Impact) -> Vec<&str> {
    impact.contacts.iter().map(|contact| contact.name.as_str()).collect()
}

/// Rounding of a few operations on numbers of order one.
fn close(found: impl Into<[f64; 2]>, expected: [f64; 2]) -> bool {
    found.into().iter().zip(expected).all(|(a, b)| (a - b).abs() < 16.0 * f64::EPSILON)
}

#[test]
fn a_flat_box_touches_with_two_corners_from_rear_to_front() {
    let found = impact(&sole(), r#"{"position": {"base": {"z": 0.1}}, "velocity": {"base": {"z": -1}}}"#);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert_eq!([found.contacts[0].point, found.contacts[1].point], [[-0.2, 0.0], [0.2, 0.0]]);
    let analysis = found.analysis.as_ref().unwrap();
    assert_eq!(analysis.verdict, Verdict::Unique);
    assert_eq!(analysis.rank, 3);
    assert!(!analysis.outcomes[0].impulse_unique);
    // A flat drop: each corner takes half of the momentum.
    for impulse in &analysis.outcomes[0].impulse {
        assert!(close(*impulse, [0.0, 1.0]), "{impulse:?}");
    }
}

#[test]
fn a_tilted_box_touches_with_one_corner() {
    // Pitched by 0.1 about its front lower corner (0.2, -0.1), nose down.
    let (sin, cos) = 0.1_f64.sin_cos();
    let z = 0.2 * sin + 0.1 * cos;
    let state =
        format!(r#"{{"position": {{"base": {{"z": {z}, "pitch": 0.1}}}}, "velocity": {{"base": {{"z": -1}}}}}}"#);
    let found = impact(&sole(), &state);
    assert_eq!(names(&found), ["body"]);
    assert_eq!(found.contacts[0].centre, [0.2, -0.1]);
    assert!(close(found.contacts[0].point, [0.2 * cos - 0.1 * sin, 0.0]));
}

#[test]
fn a_box_lies_flat_on_a_slope() {
    let slope = 0.3_f64;
    let (sin, cos) = slope.sin_cos();
    // Uphill toward +x lifts the nose: pitch = -slope.
    let state = format!(
        r#"{{"position": {{"base": {{"x": {}, "z": {}, "pitch": -0.3}}}}, "ground": {{"slope": 0.3}}}}"#,
        -0.1 * sin,
        0.1 * cos
    );
    let found = impact(&sole(), &state);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert!(close(found.contacts[1].point, [0.2 * cos, 0.2 * sin]));
    assert!(close(found.contacts[0].normal(), [-sin, cos]));
}

#[test]
fn a_disc_touches_below_its_centre_along_the_normal() {
    let robot = body(r#"<origin xyz="0.5 0 0"/><geometry><sphere radius="0.2"/></geometry>"#);
    let (sin, cos) = 0.2_f64.sin_cos();
    let (x, z) = (-0.5 - 0.2 * sin, 0.2 * cos);
    let state = format!(
        r#"{{"position": {{"base": {{"x": {x}, "z": {z}}}}}, "velocity": {{"base": {{"pitch": 2.0}}}},
            "ground": {{"slope": 0.2}}}}"#
    );
    let found = impact(&robot, &state);
    assert_eq!(names(&found), ["body"]);
    assert!(close(found.contacts[0].point, [0.0, 0.0]));
    // Pitching at 2 rad/s about the root, seen from which the point is at (0.5 + 0.2 sin, -0.2 cos).
    let (rx, rz) = (0.5 + 0.2 * sin, -0.2 * cos);
    let (vx, vz) = (2.0 * rz, -2.0 * rx);
    assert!(close(found.velocity_before[0], [vx * cos + vz * sin, vz * cos - vx * sin]));
}

#[test]
fn a_lying_capsule_touches_below_both_ends_and_a_tilted_one_below_the_lower() {
    // Its centre line, 0.4 m long, lies along x.
    let capsule = r#"<origin rpy="0 1.5707963267948966 0"/><geometry><capsule radius="0.1" length="0.4"/></geometry>"#;
    let found = impact(&body(capsule), r#"{"position": {"base": {"z": 0.1}}, "velocity": {"base": {"z": -1}}}"#);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert!(close(found.contacts[0].point, [-0.2, 0.0]) && close(found.contacts[1].point, [0.2, 0.0]));
    assert_eq!([found.contacts[0].radius, found.contacts[1].radius], [0.1; 2]);

    // Nose down by 0.1 rad about its centre, whose height is then 0.2 sin + 0.1.
    let (sin, cos) = 0.1_f64.sin_cos();
    let state = format!(r#"{{"position": {{"base": {{"z": {:?}, "pitch": 0.1}}}}}}"#, 0.2 * sin + 0.1);
    let found = impact(&body(capsule), &state);
    assert_eq!(names(&found), ["body"]);
    assert!(close(found.contacts[0].point, [0.2 * cos, 0.0]));
}

#[test]
fn a_rounded_box_touches_below_the_centres_of_its_rounding() {
    let mut robot = sole();
    let corners = robot.links[0].shapes[0].corners().to_vec();
    robot.links[0].shapes = vec![FootShape::swept(corners, Rim::Circle { radius: 0.05 }).expect("convex")];
    let slope = 0.3_f64;
    let (sin, cos) = slope.sin_cos();
    let state = format!(
        r#"{{"position": {{"base": {{"x": {:?}, "z": {:?}, "pitch": -0.3}}}}, "ground": {{"slope": 0.3}}}}"#,
        -0.15 * sin,
        0.15 * cos
    );
    let found = impact(&robot, &state);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert!(close(found.contacts[0].point, [-0.2 * cos, -0.2 * sin]));
    assert!(close(found.contacts[1].point, [0.2 * cos, 0.2 * sin]));
}

#[test]
fn an_oblique_cylinder_touches_with_the_lowest_point_of_its_rim() {
    // Its axis rises at 45 degrees out of the plane, h = 0.2 and R = 0.1: seen from the side its rims are ellipses, 0.1
    // wide and 0.1 sin 45 high to each side, at heights of +-0.2 cos 45.
    let upright = r#"<origin rpy="0.7853981633974483 0 0"/><geometry><cylinder radius="0.1" length="0.4"/></geometry>"#;
    let height = 0.3 * 0.5_f64.sqrt();
    let drop = |z: f64, pitch: f64| {
        format!(
            r#"{{"position": {{"base": {{"z": {z:?}, "pitch": {pitch:?}}}}}, "velocity": {{"base": {{"z": -1}}}}}}"#
        )
    };
    let found = impact(&body(upright), &drop(height, 0.0));
    assert_eq!(names(&found), ["body"]);
    assert!(close(found.contacts[0].point, [0.0, 0.0]) && found.contacts[0].radius == 0.0);
    // Straight below the CoG: all 2 kg m/s stop.
    assert!(close(found.analysis.as_ref().unwrap().outcomes[0].impulse[0], [0.0, 2.0]));

    // Pitched by p, d = (sin p, -cos p) is straight down as the body sees it, and its lowest point is
    // (R^2 sin p, -(R^2 / 2) cos p) / k below the rim's centre, k = R sqrt(sin^2 + cos^2 / 2).
    let (sin, cos) = 0.4_f64.sin_cos();
    let k = 0.1 * (sin * sin + 0.5 * cos * cos).sqrt();
    let (x, z) = (0.01 * sin / k, -0.2 * 0.5_f64.sqrt() - 0.005 * cos / k);
    let found = impact(&body(upright), &drop(-(cos * z - sin * x), 0.4));
    assert_eq!(names(&found), ["body"]);
    assert!(close(found.contacts[0].centre, [x, z]), "{:?}", found.contacts[0]);
    assert!(found.contacts[0].gap.abs() < 1e-15);

    // Lying, its axis 45 degrees off the plane: a line of its side touches, seen at its length times cos 45.
    let lying = r#"<origin rpy="0 1.5707963267948966 0.7853981633974483"/>
        <geometry><cylinder radius="0.1" length="0.4"/></geometry>"#;
    let found = impact(&body(lying), &drop(0.1, 0.0));
    assert_eq!(names(&found), ["body/0", "body/1"]);
    let end = 0.2 * 0.5_f64.sqrt();
    assert!(close(found.contacts[0].point, [-end, 0.0]) && close(found.contacts[1].point, [end, 0.0]));
}

#[test]
fn every_shape_of_a_link_can_touch() {
    let two = r#"<origin xyz="-0.3 0 0"/><geometry><sphere radius="0.1"/></geometry></collision>
        <collision><origin xyz="0.3 0 -0.05"/><geometry><box size="0.2 0.1 0.1"/></geometry>"#;
    let found = impact(&body(two), r#"{"position": {"base": {"z": 0.1}}}"#);
    assert_eq!(names(&found), ["body/0", "body/1", "body/2"]);
    let places: Vec<f64> = found.contacts.iter().map(|contact| contact.point.x).collect();
    assert_eq!(places, [-0.3, 0.3 - 0.1, 0.3 + 0.1]);
}

#[test]
fn a_sphere_without_radius_is_a_point() {
    let robot = body(r#"<origin xyz="0.25 0 -1"/><geometry><sphere radius="0"/></geometry>"#);
    let found = impact(&robot, r#"{"position": {"base": {"z": 1}}}"#);
    assert_eq!(names(&found), ["body"]);
    assert_eq!(found.contacts[0].point, [0.25, 0.0]);
}

#[test]
fn a_foot_above_the_tolerance_is_open_and_below_it_refused() {
    // The size of the box robot is sqrt(0.05), so the tolerance is 2.2e-7 m.
    let state = |z: f64| format!(r#"{{"position": {{"base": {{"z": {z}}}}}}}"#);
    let robot = sole();
    assert_eq!(impact(&robot, &state(0.1 + 1e-7)).contacts.len(), 2);
    let open = impact(&robot, &state(0.1 + 1e-6));
    assert_eq!(open.contacts.len(), 0);
    assert_eq!(open.analysis.unwrap().verdict, Verdict::NoContact);
    let error = try_impact(&robot, Options::default(), &state(0.1 - 1e-3)).unwrap_err();
    let Reason::Penetration { link, depth, .. } = error.reason() else { panic!("{error}") };
    assert_eq!(link, "body");
    assert!((depth - 1e-3).abs() < 1e-15);
    let wide = Options { contact_tolerance: Some(2e-3), ..Options::default() };
    assert_eq!(try_impact(&robot, wide, &state(0.1 - 1e-3)).unwrap().contacts.len(), 2);
}

#[test]
fn a_stance_puts_the_rear_end_of_a_flat_side_at_the_origin_and_at_rest() {
    let found = impact(&sole(), r#"{"stance": "body", "velocity": {"base": {"pitch": -1.0}}}"#);
    assert_eq!(found.contacts[0].point, [0.0, 0.0]);
    assert_eq!(found.velocity_before[0], [0.0, 0.0]);
    // The front corner, 0.4 m ahead, rises at 0.4 m/s and does not move along the ground.
    assert_eq!(found.velocity_before[1], [0.0, 0.4]);
}

#[test]
fn a_standing_robot_has_no_impact() {
    let found = impact(&sole(), r#"{"stance": "body"}"#);
    let analysis = found.analysis.as_ref().unwrap();
    assert_eq!(analysis.verdict, Verdict::NoImpact);
    assert_eq!(analysis.outcomes[0].velocity_after, [[0.0; 2]; 2]);
    assert_eq!(velocities_after(&found), [[0.0; 3]]);
}

#[test]
fn named_contacts_are_closed_whatever_their_height_and_keep_their_order() {
    let state = r#"{"position": {"base": {"z": 5}}, "contacts": [
        {"link": "body", "offset": [0.3, 7, -1]}, {"link": "body", "offset": [-0.3, 0, -1], "radius": 0.5}]}"#;
    let found = impact(&sole(), state);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert_eq!([found.contacts[0].gap, found.contacts[1].gap], [4.0, 3.5]);
    assert_eq!(found.contacts[1].point, [-0.3, 3.5]);
}

#[test]
fn feet_from_the_options_are_detected_by_their_height() {
    let robot = body(r#"<geometry><sphere radius="0.1"/></geometry>"#);
    let feet = vec![heelstrike::state::NamedContact { link: 0, offset: [0.5, 0.0, -0.25], radius: 0.0 }];
    let options = || Options { feet: feet.clone(), ..Options::default() };
    let down = try_impact(&robot, options(), r#"{"position": {"base": {"z": 0.25}}}"#).unwrap();
    assert_eq!(down.contacts[0].point, [0.5, 0.0]);
    let up = try_impact(&robot, options(), r#"{"position": {"base": {"z": 0.3}}}"#).unwrap();
    assert!(up.contacts.is_empty());
}

#[test]
fn an_applied_impulse_counts_but_not_as_velocity_before() {
    let state = r#"{"position": {"base": {"z": 0.1}}, "friction": 10,
        "impulse": [{"link": "body", "offset": [0, 0, 0], "vector": [0.5, -4]}]}"#;
    let found = impact(&sole(), state);
    assert_eq!(found.velocity_before, [[0.0; 2]; 2]);
    let analysis = found.analysis.as_ref().unwrap();
    assert_eq!(analysis.verdict, Verdict::Unique);
    // The ground takes the whole impulse, and the robot stays.
    let taken = analysis.outcomes[0].impulse.iter().fold([0.0; 2], |sum, l| [sum[0] + l[0], sum[1] + l[1]]);
    assert!(close(taken, [-0.5, 4.0]), "{taken:?}");
    assert!(velocities_after(&found)[0].iter().all(|v| v.abs() < 16.0 * f64::EPSILON));
}

const PENDULUM: &str = r#"<robot name="p"><link name="body">
        <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="1"/></inertial></link>
    <link name="leg">
        <inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
            <inertia ixx="1" ixy="0" ixz="0" iyy="0" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 -1"/><geometry><sphere radius="0"/></geometry></collision></link>
    <joint name="hip" type="revolute"><parent link="body"/><child link="leg"/><axis xyz="0 1 0"/>
        <limit effort="0" velocity="0"/></joint></robot>"#;

#[test]
fn a_held_joint_keeps_its_rate_and_makes_one_body_of_two() {
    let robot = Robot::from_urdf(PENDULUM).unwrap();
    let state = r#"{"position": {"base": {"z": 1}}, "velocity": {"base": {"z": -1}, "joints": {"hip": 0.5}},
        "held": ["hip"], "friction": "infinite"}"#;
    let found = impact(&robot, state);
    // The foot is 1 m below the hip: turning at 0.5 rad/s moves it back.
    assert_eq!(found.velocity_before, [[-0.5, -1.0]]);
    assert_eq!(velocities_after(&found)[0][3], 0.5);
    // Two masses above each other on the contact's normal: 3 kg stop, L_n = 3 N s.
    let analysis = found.analysis.as_ref().unwrap();
    assert!((analysis.outcomes[0].impulse[0][1] - 3.0).abs() < 16.0 * f64::EPSILON);
}

#[test]
fn a_massless_leg_is_refused_with_its_joint_unless_held_or_with_a_rotor() {
    let robot = Robot::from_urdf(&PENDULUM.replace(r#"<mass value="1"/>"#, r#"<mass value="0"/>"#)).unwrap();
    let state = |more: &str| format!(r#"{{"position": {{"base": {{"z": 1}}}}, "friction": 1{more}}}"#);
    let error = try_impact(&robot, Options::default(), &state("")).unwrap_err();
    assert_eq!(error.to_string(), "the mass matrix is singular: nothing resists a motion of joint \"hip\"");
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("held") && remedy.contains("rotor_inertia")));
    assert!(try_impact(&robot, Options::default(), &state(r#", "held": ["hip"]"#)).is_ok());
    assert!(try_impact(&robot, Options::default(), &state(r#", "rotor_inertia": {"hip": 0.01}"#)).is_ok());
}

#[test]
fn slow_contacts_rest_only_where_asked() {
    let robot = sole();
    let state = r#"{"position": {"base": {"z": 0.1}}, "velocity": {"base": {"z": -1e-3}}}"#;
    let moving = impact(&robot, state);
    assert_eq!(moving.velocity_before[0], [0.0, -1e-3]);
    let options = Options { resting_speed: 1e-2, ..Options::default() };
    let resting = try_impact(&robot, options, state).unwrap();
    assert_eq!(resting.velocity_before, [[0.0; 2]; 2]);
    assert_eq!(resting.notes.len(), 2, "each contact has a note: {:?}", resting.notes);
    assert_eq!(resting.analysis.unwrap().verdict, Verdict::NoImpact);
}

#[test]
fn a_contact_without_friction_is_named() {
    let robot = Robot::from_urdf(PENDULUM).unwrap();
    let state = State::from_json(r#"{"position": {"base": {"z": 1}}}"#, &robot, &Defaults::default()).unwrap();
    let error = Pipeline::new(&robot, Options::default()).impact(&state).unwrap_err();
    assert!(error.to_string().contains("leg"), "{error}");
}
