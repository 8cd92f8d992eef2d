//! Which points touch level or sloped ground: shapes, tolerances, stance, named contacts, braked joints, impulses.

use super::*;
use crate::support::impact::reduced;
use crate::support::urdf::{Axis, HINGE, POINT, collision, joint, link};
use heelstrike::pipeline::Pipeline;
use heelstrike::robot::{Base, Reduction};
use heelstrike::state::{Defaults, State};

fn names(impact: &Impact) -> Vec<&str> {
    impact.contacts.iter().map(|contact| &*contact.name).collect()
}

/// A body at rest, or falling, at a height above level ground.
fn at(z: f64, fall: f64) -> Value {
    json!({"position": {"base": {"z": z}}, "velocity": {"base": {"z": -fall}}})
}

#[test]
fn shapes_touch_with_their_lowest_points() {
    let half = 0.5_f64.sqrt();
    let oblique =
        body(r#"<origin rpy="0.7853981633974483 0 0"/><geometry><cylinder radius="0.1" length="0.4"/></geometry>"#);
    let lying = r#"<origin rpy="0 1.5707963267948966 0.7853981633974483"/>
        <geometry><cylinder radius="0.1" length="0.4"/></geometry>"#;
    // Its middle line, 0.4 m long, lies along x.
    let capsule = r#"<origin rpy="0 1.5707963267948966 0"/><geometry><capsule radius="0.1" length="0.4"/></geometry>"#;
    let [aside, point] = [([0.5, 0.0], "0.2"), ([0.25, -1.0], "0")]
        .map(|(place, radius)| robot(&urdf::body(0.5, &collision(place, &format!("sphere radius=\"{radius}\"")))));
    let two = [collision([-0.3, 0.0], "sphere radius=\"0.1\""), collision([0.3, -0.05], "box size=\"0.2 0.1 0.1\"")];
    let two = robot(&urdf::body(0.5, &two.concat()));
    // The axis of the oblique cylinder rises at 45 degrees out of the plane: seen from the side its rims are ellipses
    // with half-axes R = 0.1 and R sin 45, at heights of +-0.2 cos 45. At pitch p, d = (sin p, -cos p) is straight down
    // in the body's frame, and the lowest point is (R^2 sin p, -(R^2 / 2) cos p) / k from the rim's center with k = R
    // sqrt(sin^2 + cos^2 / 2).
    let (sin, cos) = 0.4_f64.sin_cos();
    let k = 0.1 * (sin * sin + 0.5 * cos * cos).sqrt();
    let rim = [0.01 * sin / k, -0.2 * half - 0.005 * cos / k];
    let on_slope = |lift: f64| [-lift * 0.3_f64.sin(), lift * 0.3_f64.cos(), -0.3];
    let nose_down = |x: f64, lift: f64| [0.0, x * 0.1_f64.sin() + lift, 0.1];
    let line = [([-0.2 * half, -0.1], 0.0), ([0.2 * half, -0.1], 0.0)];
    let sole_corners = [([-0.2, -0.1], 0.0), ([0.2, -0.1], 0.0)];
    // Place and pitch of the body, the slope, and the points, each with the radius around it.
    for (what, robot, place, slope, points) in [
        ("flat box", &sole(), [0.0, 0.1, 0.0], 0.0, &sole_corners[..]),
        ("tilted box", &sole(), nose_down(0.2, 0.1 * 0.1_f64.cos()), 0.0, &sole_corners[1..]),
        // Uphill toward +x lifts the nose.
        ("box on a slope", &sole(), on_slope(0.1), 0.3, &sole_corners),
        ("disc", &aside, [-0.5 - 0.2 * 0.2_f64.sin(), 0.2 * 0.2_f64.cos(), 0.0], 0.2, &[([0.5, 0.0], 0.2)]),
        ("lying capsule", &body(capsule), [0.0, 0.1, 0.0], 0.0, &[([-0.2, 0.0], 0.1), ([0.2, 0.0], 0.1)]),
        ("tilted capsule", &body(capsule), nose_down(0.2, 0.1), 0.0, &[([0.2, 0.0], 0.1)]),
        ("oblique cylinder", &oblique, [0.0, 0.3 * half, 0.0], 0.0, &[([0.0, -0.3 * half], 0.0)]),
        ("pitched cylinder", &oblique, [0.0, sin * rim[0] - cos * rim[1], 0.4], 0.0, &[(rim, 0.0)]),
        // Its axis is 45 degrees off the plane: a line of its side touches, and appears with its length times cos 45.
        ("lying cylinder", &body(lying), [0.0, 0.1, 0.0], 0.0, &line),
        // The inner corner of the box acts through these two.
        ("two shapes", &two, [0.0, 0.1, 0.0], 0.0, &[([-0.3, 0.0], 0.1), ([0.4, -0.1], 0.0)]),
        ("point", &point, [0.0, 1.0, 0.0], 0.0, &[([0.25, -1.0], 0.0)]),
    ] {
        let mut state = state(place, [0.3, -1.0, 2.0], 0.5, &[]);
        state["ground"] = json!({"slope": slope});
        let found = impact(robot, &state);
        let expected = if points.len() == 1 { vec!["body"] } else { vec!["body/0", "body/1"] };
        assert_eq!(names(&found), expected, "{what}");
        let ([x, z, pitch], normal) = (place, [-f64::sin(slope), f64::cos(slope)]);
        let (sin, cos) = f64::sin_cos(pitch);
        for (contact, (center, radius)) in found.contacts.iter().zip(points) {
            let arm = [cos * center[0] + sin * center[1], cos * center[1] - sin * center[0]];
            let arm = [arm[0] - radius * normal[0], arm[1] - radius * normal[1]];
            let [point, own] = [contact.point, contact.center].map(Vector::components);
            assert_close(
                &[point, own, contact.normal().components()].concat(),
                &[[x + arm[0], z + arm[1]], *center, normal].concat(),
            );
            assert_eq!(contact.radius, *radius, "{what}");
            assert!(contact.gap.abs() < 1e-15, "{what}: {}", contact.gap);
        }
        // The body moves at (0.3, -1) m/s and pitches at 2 rad/s.
        for (contact, before) in found.contacts.iter().zip(&found.velocity_before) {
            let [vx, vz] = [0.3 + 2.0 * (contact.point.z - z), -1.0 - 2.0 * (contact.point.x - x)];
            let [nx, nz] = normal;
            assert_close(before, &[vx * nz - vz * nx, vx * nx + vz * nz]);
        }
    }
    // The contact is straight below the CoG: it stops all 2 kg m/s.
    assert_close(&outcomes(&impact(&oblique, at(0.3 * half, 1.0)))[0].impulse[0], &[0.0, 2.0]);
}

#[test]
fn a_foot_off_the_tolerance_is_open_or_refused() {
    // The size of the box robot is sqrt(0.05), so the tolerance is 2.2e-7 m.
    assert_eq!(impact(&sole(), at(0.1 + 1e-7, 0.0)).contacts.len(), 2);
    let open = impact(&sole(), at(0.1 + 1e-6, 0.0));
    assert_eq!((open.contacts.len(), open.analysis.unwrap().verdict), (0, Verdict::NoContact));
    assert!((depth(&sole(), &at(0.1 - 1e-3, 0.0)) - 1e-3).abs() < 1e-15);
    let wide = Options { contact_tolerance: Some(2e-3), ..Options::default() };
    assert_eq!(try_impact(&sole(), wide, at(0.1 - 1e-3, 0.0)).unwrap().contacts.len(), 2);
}

#[test]
fn a_stance_puts_the_rear_end_at_the_origin_at_rest() {
    let found = impact(&sole(), r#"{"stance": "body", "velocity": {"base": {"pitch": -1.0}}}"#);
    assert_eq!(found.contacts[0].point, [0.0, 0.0]);
    // The front corner, 0.4 m ahead, rises at 0.4 m/s and does not move along the ground.
    assert_eq!(found.velocity_before, [[0.0, 0.0], [0.0, 0.4]]);
    // Without a velocity it stands: no impact.
    let found = impact(&sole(), r#"{"stance": "body"}"#);
    let analysis = found.analysis.as_ref().unwrap();
    assert_eq!(analysis.verdict, Verdict::NoImpact);
    assert_eq!(analysis.outcomes[0].velocity_after, [[0.0; 2]; 2]);
    assert_eq!(velocities_after(&found), [[0.0; 3]]);
}

#[test]
fn named_contacts_are_closed_at_any_height_in_order() {
    let state = r#"{"position": {"base": {"z": 5}}, "contacts": [
        {"link": "body", "offset": [0.3, 7, -1]}, {"link": "body", "offset": [-0.3, 0, -1], "radius": 0.5}]}"#;
    let found = impact(&sole(), state);
    assert_eq!(names(&found), ["body/0", "body/1"]);
    assert_eq!([found.contacts[0].gap, found.contacts[1].gap], [4.0, 3.5]);
    assert_eq!(found.contacts[1].point, [-0.3, 3.5]);
}

#[test]
fn a_deep_foot_besides_named_contacts_is_noted() {
    let notes = |z: f64, brief: bool| {
        let place = r#"{"position": {"base": {"z": PLACE}}, "contacts": [{"link": "body", "offset": [0, 0, -1]}]}"#;
        let options = Options { brief, ..Options::default() };
        try_impact(&pendulum(1.0), options, place.replace("PLACE", &z.to_string())).unwrap().notes
    };
    let expected = "leg is 0.05 m deep in the ground, and is not among the contacts: it takes no part";
    assert_eq!(notes(0.95, false), [expected]);
    assert_eq!([notes(0.95, true), notes(0.999, false), notes(1.05, false)], [const { Vec::<String>::new() }; 3]);
}

#[test]
fn applied_impulse_leaves_velocity_before() {
    let state = r#"{"position": {"base": {"z": 0.1}}, "friction": 10,
        "impulse": [{"link": "body", "offset": [0, 0, 0], "vector": [0.5, -4]}]}"#;
    let found = impact(&sole(), state);
    assert_eq!(found.velocity_before, [[0.0; 2]; 2]);
    let (impulse, after) = only_outcome(&found);
    // The ground takes the whole impulse, and the robot stays.
    assert_close(&[impulse[0][0] + impulse[1][0], impulse[0][1] + impulse[1][1]], &[-0.5, 4.0]);
    assert_close(&after, &[0.0; 3]);
}

/// A body with a leg of this mass, 1 m long.
fn pendulum(mass: f64) -> Robot {
    robot(&urdf::robot(&[
        link("body", 2.0, [0.0; 2], 0.5, ""),
        link("leg", mass, [0.0, -0.5], 0.0, &collision([0.0, -1.0], POINT)),
        joint("hip", HINGE, ["body", "leg"], [0.0; 2], ""),
    ]))
}

#[test]
fn a_leg_without_mass_or_friction_is_refused_by_name() {
    let answer = |more: &str| {
        let state = format!(r#"{{"position": {{"base": {{"z": 1}}}}, "friction": 1{more}}}"#);
        try_impact(&pendulum(0.0), Options::default(), state)
    };
    let error = answer("").unwrap_err();
    assert_eq!(error.to_string(), "the mass matrix is singular: nothing resists a motion of joint \"hip\"");
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("held") && remedy.contains("rotor_inertia")));
    assert!(answer(r#", "held": ["hip"]"#).is_ok() && answer(r#", "rotor_inertia": {"hip": 0.01}"#).is_ok());

    let robot = pendulum(1.0);
    let state = State::from_json(&at(1.0, 0.0).to_string(), &robot, &Defaults::default()).unwrap();
    let error = Pipeline::new(&robot, Options::default()).impact(&state).unwrap_err();
    assert!(error.to_string().contains("leg"), "{error}");
}

/// A foot that turns against the body about its axle, at the same rate, moves as the axle does, up to rounding.
#[test]
fn the_explanation_of_a_slow_contact_has_its_digits() {
    let robot = crate::support::impact::robot(&crate::support::urdf::robot(&[
        link("body", 2.0, [0.1, 0.3], 0.4, ""),
        link("foot", 1.0, [0.1, -0.2], 0.1, &collision([0.23, -0.57], "sphere radius=\"0\"")),
        joint("axle", HINGE, ["body", "foot"], [0.0; 2], ""),
    ]));
    let gamma = |rate: f64| {
        let options = Options { explain_up_to: 1, ..Options::default() };
        let state = json!({"position": {"base": {"pitch": 0.7}, "joints": {"axle": 0.4}}, "friction": "infinite",
            "velocity": {"base": {"x": 1e-11, "z": -2e-11, "pitch": rate}, "joints": {"axle": -rate}}, "place": "lowest"});
        let found = try_impact(&robot, options, state).unwrap();
        assert!(!found.resting[0], "{rate}");
        found.analysis.and_then(|analysis| analysis.explanation).expect("an explanation").gamma[0]
    };
    assert!((gamma(97.3) - gamma(0.0)).abs() < 1e-12, "{} is not {}", gamma(97.3), gamma(0.0));
}

#[test]
fn slow_contacts_rest_only_where_asked() {
    assert_eq!(impact(&sole(), at(0.1, 1e-3)).velocity_before[0], [0.0, -1e-3]);
    let options = Options { resting_speed: Some(1e-2), ..Options::default() };
    let resting = try_impact(&sole(), options, at(0.1, 1e-3)).unwrap();
    assert_eq!(resting.velocity_before, [[0.0; 2]; 2]);
    assert_eq!(resting.notes.len(), 2, "each contact has a note: {:?}", resting.notes);
    assert_eq!(resting.analysis.unwrap().verdict, Verdict::NoImpact);
}

/// In every pose the root follows the slide without moving any mass. In f64 that is zero only up to rounding.
#[test]
fn a_root_without_mass_on_a_slide_is_refused_in_every_pose() {
    let text = urdf::robot(&[
        "<link name=\"root\"/>".to_owned(),
        link("body", 5.0, [0.0; 2], 0.05, ""),
        link("leg", 1.0, [0.0, -0.25], 0.02, &collision([0.0, -0.5], POINT)),
        joint("slide", Axis::Prismatic([0.0, 1.0]), ["root", "body"], [0.0; 2], ""),
        joint("hip", HINGE, ["body", "leg"], [0.0; 2], ""),
    ]);
    let robot = reduced(&text, &Reduction { base: Some(Base::Floating), ..Reduction::default() });
    for step in 0..60 {
        let position = json!({"base": {"z": 1, "pitch": 0.0173 * f64::from(step)}, "joints": {"hip": 0.3}});
        let contacts = json!([{"link": "leg", "offset": [0, 0, -0.5]}]);
        let state =
            json!({"position": position, "velocity": {"base": {"z": -1}}, "friction": 0.5, "contacts": contacts});
        let error = try_impact(&robot, Options::default(), state).map(|_| ()).unwrap_err();
        assert!(error.to_string().starts_with("the mass matrix is singular"), "{step}: {error}");
    }
}
