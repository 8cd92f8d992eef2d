//! Drawings of small robots, compared with values computed by hand.

use super::*;
use crate::{Defaults, Options, Pipeline};

/// A ball of 2 kg with radius 0.5 m, and on it an arm of 1 m that ends in a point foot.
const ARM: &str = r#"<robot name="arm">
    <link name="ball">
        <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <collision><geometry><sphere radius="0.5"/></geometry></collision>
    </link>
    <link name="arm">
        <inertial><origin xyz="0 0 0.5"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 1"/><geometry><sphere radius="0"/></geometry></collision>
    </link>
    <joint name="shoulder" type="continuous"><axis xyz="0 1 0"/><parent link="ball"/><child link="arm"/></joint>
</robot>"#;

fn drawn(state: &str) -> Drawing {
    let robot = Robot::from_urdf(ARM).unwrap();
    let state = State::from_json(state, &robot, &Defaults::default()).unwrap();
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
    Drawing::of_impact(&robot, &[], &state, &impact)
}

#[test]
fn bodies_are_where_the_state_places_them() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let drawing = drawn(&format!(
        r#"{{"position": {{"base": {{"x": 3, "z": 0.5}}, "joints": {{"shoulder": {quarter}}}}}, "friction": 1}}"#
    ));
    let [ball, arm] = &drawing.bodies[..] else { panic!("{drawing:?}") };
    let center = Vector::new(3.0, 0.5);
    assert_eq!((ball.origin, ball.com.map(|com| ball.world(com)), ball.is_last), (center, Some(center), false));
    assert!(ball.bones.is_empty(), "the joint is at its center");
    // A positive angle turns the arm from up to forward.
    let near = |a: Vector, b: [f64; 2]| (a - b.into()).length() < 1e-12;
    assert!(near(arm.bones[0], [4.0, 0.5]) && near(arm.world(arm.com.unwrap()), [3.5, 0.5]) && arm.is_last);
    assert_eq!(drawing.joints, [center]);
    let Extent { low, high } = drawing.extent();
    assert!(near(low, [2.5, 0.0]) && near(high, [4.0, 1.0]));
    assert!(near(drawing.contacts[0].point, [3.0, 0.0]));
}

#[test]
fn arrows_on_a_slope_are_in_the_worlds_axes() {
    let slope = 0.25_f64;
    let (sin, cos) = libm::sincos(slope);
    let state = format!(
        r#"{{"stance": "ball", "velocity": {{"base": {{"pitch": 0}}}}, "friction": 0, "ground": {{"slope": {slope}}},
            "impulse": [{{"link": "ball", "offset": [0, 0, 0], "vector": [0, -3]}}]}}"#
    );
    let drawing = drawn(&state);
    let [contact] = &drawing.contacts[..] else { panic!("{drawing:?}") };
    assert!((contact.normal.x + sin).abs() < 1e-12 && (contact.normal.z - cos).abs() < 1e-12);
    let Vector { x, z } = drawing.outcomes[0].impulse[0];
    assert!((x / z + libm::tan(slope)).abs() < 1e-9, "without friction it is along the normal: {x} {z}");
    assert_eq!(drawing.applied[0].vector, Vector::new(0.0, -3.0));
    let [left, right] = drawing.ground[..] else { panic!("{drawing:?}") };
    assert!(((right.z - left.z) / (right.x - left.x) - libm::tan(slope)).abs() < 1e-4);
}
