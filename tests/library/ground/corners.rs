//! Which points of feet touch, that each is found once, and with which normals.

use super::*;
use crate::support::urdf::{HINGE, collision, joint, link};
use std::f64::consts::FRAC_1_SQRT_2;

/// Asserts that there is one contact, and its normal.
#[track_caller]
fn assert_normal(found: &Impact, [x, z]: [f64; 2]) {
    let [contact] = &found.contacts[..] else { panic!("{:?}", touches(found)) };
    let own = contact.normal();
    assert!((own.x - x).abs() < 1e-9 && (own.z - z).abs() < 1e-9, "{own:?} is not {x}, {z}");
}

#[test]
fn corners_push_along_the_middle_of_what_both_allow() {
    // A point on the edge of a step has the normal halfway between those of tread and riser.
    let edge = [[-2.0, 0.0], [0.0, 0.0], [1e-9, -2.0], [2.0, -2.0]];
    let s = FRAC_1_SQRT_2;
    assert_normal(&impact(&point(), state([0.0; 3], FALLING, 1, &edge)), [s, s]);
    // A level sole whose toe ends at the edge lies flat and has the tread's normal. With its heel on the edge and the
    // rest over the void, all normals between those of riser and tread are possible.
    let flat = impact(&sole(), state([-0.2, 0.1, 0.0], FALLING, 1, &edge));
    assert_touches(&flat, &[[[-0.4, 0.0], [0.0, 1.0]], [[0.0, 0.0], [0.0, 1.0]]]);
    assert_normal(&impact(&sole(), state([0.2, 0.1, 0.0], FALLING, 1, &edge)), [s, s]);
    // The heel of a sole that is pitched by -0.4 (nose up) allows normals at -0.4 to pi/2 - 0.4 from upright toward +x,
    // the edge allows 0 to pi/2. The middle of what both allow is pi/4 - 0.2.
    let (sin, cos) = 0.4_f64.sin_cos();
    // The heel is at (-0.2, -0.1) in the body, turned to (cos x + sin' z, cos z - sin' x) with sin' = sin(-0.4).
    let heel = [-0.2 * cos + 0.1 * sin, -0.1 * cos - 0.2 * sin];
    let tilted = impact(&sole(), state([-heel[0], -heel[1], -0.4], FALLING, 1, &edge));
    let angle = std::f64::consts::FRAC_PI_4 - 0.2;
    assert_normal(&tilted, [angle.sin(), angle.cos()]);
}

#[test]
fn a_spot_touches_once() {
    // Two contacts with the tread's normal, whether the overhang is within the tolerance or beyond, and whether the
    // sole is slightly above the tread or in it.
    for overhang in [-1e-3, -1e-7, -1e-9, -1e-15, 0.0, 1e-15, 1e-9, 1e-7, 1e-3] {
        for height in [-1e-9, -1e-16, 0.0, 1e-16, 1e-9] {
            let text = state([-0.2 + overhang, 0.1 + height, 0.0], FALLING, 1, &step(0.0, -0.5));
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
        let found = impact(&plate, state([0.0, height, 0.2], FALLING, 1, &step(0.0, -0.5)));
        assert_eq!(found.contacts.len(), 1, "{height}");
        assert_close(&found.contacts[0].normal().components(), &[0.2_f64.sin(), 0.2_f64.cos()]);
    }
}

/// A cylinder of radius 0.2 m and 0.5 m long whose axis is 0.7 rad off the plane's normal, toward x. Its ends are
/// ellipses with half-axes 0.2 cos 0.7 and 0.2 m, at 0.25 sin 0.7 before and behind the CoG.
#[test]
fn an_oblique_cylinder_meets_segments_and_corners() {
    let cylinder = r#"<geometry><cylinder radius="0.2" length="0.5"/></geometry>"#;
    let robot = body(&format!(r#"<origin rpy="1.5707963267948966 0 0.7"/>{cylinder}"#));
    let (half, reach) = (0.2 * 0.7_f64.cos(), 0.25 * 0.7_f64.sin());
    let near = |place: [f64; 3], profile: &[[f64; 2]], expected: &[[[f64; 2]; 2]]| {
        let found = touches(&impact(&robot, state(place, FALLING, 1, profile)));
        let numbers = found.as_flattened().iter().zip(expected.as_flattened());
        let near = numbers.flat_map(|(a, b)| a.iter().zip(b)).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(found.len() == expected.len() && near, "{found:?}");
    };
    // Flat on a tread, and with its middle on an edge.
    let up = [0.0, 1.0];
    near([-1.0, 0.2, 0.0], &step(0.0, -1.0), &[[[-1.0 - reach, 0.0], up], [[-1.0 + reach, 0.0], up]]);
    near([0.0, 0.2, 0.0], &step(0.0, -1.0), &[[[-reach, 0.0], up], [[0.0, 0.0], up]]);
    // The front end touches a ridge at 45 degrees of its ellipse, (half cos s, 0.2 sin s) with s = -pi/4. Its outward
    // normal there is along (cos s / half, sin s / 0.2).
    let s = FRAC_1_SQRT_2;
    let out = [s / half, -s / 0.2];
    let size = f64::hypot(out[0], out[1]);
    let place = [-reach - half * s, 0.2 * s, 0.0];
    let ridge = [[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]];
    near(place, &ridge, &[[[0.0, 0.0], [-out[0] / size, -out[1] / size]]]);
    // On a slope up: the front end reaches hypot(half sin, 0.2 cos) along the normal.
    let (sin, cos) = 0.5_f64.sin_cos();
    let far = f64::hypot(half * sin, 0.2 * cos);
    let place = [-reach - far * sin, far * cos, 0.0];
    let point = [-far * sin + half * half * sin / far, far * cos - 0.2 * 0.2 * cos / far];
    near(place, &[[-4.0 * cos, -4.0 * sin], [4.0 * cos, 4.0 * sin]], &[[point, [-sin, cos]]]);
    // Sunk cylinders: the depth is how much they are too low.
    let sunk = |[x, z]: [f64; 2], profile: &[[f64; 2]]| depth(&robot, &state([x, z, 0.0], [0.0; 3], 1, profile));
    let depths =
        [sunk([-1.0, 0.15], &step(0.0, -1.0)), sunk([0.0, 0.15], &ridge), sunk([-1.0, -0.3], &step(0.0, -1.0))];
    for (found, expected) in depths.into_iter().zip([0.05, 0.05, 0.5]) {
        assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
    }
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
        ([contact.normal().x, contact.normal().z, contact.gap], contact.point.components())
    };
    let s = FRAC_1_SQRT_2;
    assert_eq!(named(0.0, 2.0, 0.5), ([0.0, 1.0, 1.5], [0.0, 1.5]));
    assert_eq!(named(0.0, -0.25, 0.0), ([0.0, 1.0, -0.25], [0.0, -0.25]));
    assert_close(&named(2.0, 0.0, 0.0).0, &[s, s, s]);
    // The corner is nearest, in the direction of 0.4 rad; on the corner, the normal is in the middle of both.
    let (sin, cos) = 0.4_f64.sin_cos();
    assert_close(&named(1.0 + sin, cos, 0.5).0, &[sin, cos, 0.5]);
    let eighth = std::f64::consts::FRAC_PI_8;
    assert_close(&named(1.0, 0.0, 0.0).0, &[eighth.sin(), eighth.cos(), 0.0]);
    // Beyond an end the last segment is continued.
    assert_eq!(named(-5.0, 0.5, 0.0), ([0.0, 1.0, 0.5], [-5.0, 0.5]));
}

#[test]
fn a_circle_on_a_corner_of_the_ground_touches_it() {
    let down = [[-2.0, 0.0], [0.0, 0.0], [2.0, -0.4]];
    let on = |profile: &[[f64; 2]], x: f64| impact(&disc(), state([x, 0.5, 0.0], FALLING, 0.5, profile));
    // At the edge of a step, where a slope begins, and at both ends of the ground; the normal is that of the level
    // segment.
    for (profile, x) in [(&step(0.0, -1.0)[..], 0.0), (&down, 0.0), (&[[-2.0, 0.0], [0.25, 0.0]], 0.25)] {
        assert_touches(&on(profile, x), &[[[x, 0.0], [0.0, 1.0]]]);
    }
    assert_touches(&on(&[[0.25, 0.0], [2.0, 0.0]], 0.25), &[[[0.25, 0.0], [0.0, 1.0]]]);
    // A stance is placed on such a corner.
    let stance = r#"{"stance": "body", "friction": 0.5, "ground": {"profile": [[-1, -1], [0, 0], [1, -0.5]]}}"#;
    assert_eq!(impact(&disc(), stance).velocity_before, [[0.0; 2]]);
}

/// Angles that cancel up to rounding leave a sole tilted by 1e-17 rad. On this tilt, sticking contacts could balance
/// with impulses of 1e16 N s.
#[test]
fn a_level_sole_across_an_edge_has_the_normal_of_its_tread() {
    let foot = collision([0.0, -0.4], "box size=\"0.3 0.1 0.04\"");
    let robot = robot(&urdf::robot(&[
        link("torso", 5.0, [0.02, 0.2], 0.2, ""),
        link("thigh", 1.0, [0.0, -0.2], 0.02, ""),
        link("foot", 1.0, [0.02, -0.2], 0.02, &foot),
        joint("hip", HINGE, ["torso", "thigh"], [0.0; 2], ""),
        joint("knee", HINGE, ["thigh", "foot"], [0.0, -0.4], ""),
    ]));
    for (pitch, hip) in (50..90).map(|step| 0.01 * f64::from(step)).map(|pitch| (pitch, 0.3 - 7.0 * pitch)) {
        let base = json!({"x": 0.4 * f64::sin(pitch + hip) + 0.02, "pitch": pitch});
        let joints = json!({"hip": hip, "knee": -(pitch + hip)});
        let velocity = json!({"base": {"x": 0.3, "z": -1, "pitch": 0.4}, "joints": {"hip": -0.7, "knee": 0.2}});
        let state = json!({"position": {"base": base, "joints": joints}, "velocity": velocity,
            "friction": "infinite", "place": "lowest", "ground": {"profile": step(0.0, -0.5)}});
        let found = impact(&robot, state);
        assert_eq!(found.contacts.len(), 2, "{pitch}");
        assert!(found.contacts.iter().all(|contact| contact.normal() == [0.0, 1.0]), "{:?}", touches(&found));
        let pushes = outcomes(&found).iter().flat_map(|own| own.impulse.as_flattened());
        assert!(pushes.fold(0.0, |most: f64, own| most.max(own.abs())) < 1e3, "{pitch}: {:?}", outcomes(&found));
    }
}
