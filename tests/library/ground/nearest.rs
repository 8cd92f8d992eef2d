//! The lowest foot that does not touch, and `place: lowest`, which puts the robot on its lowest foot.

use super::{FALLING, assert_close, assert_same_outcomes, body, sole, state, step};
use crate::support::impact::{impact, robot, try_impact};
use crate::support::random::Random;
use crate::support::urdf::{self, Axis, POINT, collision, joint, link};
use heelstrike::pipeline::{Impact, NearestFoot, Options};
use heelstrike::planar::Vector;
use heelstrike::{Reason, Robot};
use serde_json::{Value, json};

const RAMONE: &str = include_str!("../../../urdf/ramone.urdf");

/// A body with a point at its CoG, and another link that is fixed to it with a point 1 m ahead and `height` above.
fn two_feet(height: f64) -> Robot {
    robot(&urdf::robot(&[
        link("body", 2.0, [0.0; 2], 0.5, &collision([0.0; 2], POINT)),
        link("other", 1.0, [0.0; 2], 0.5, &collision([1.0, height], POINT)),
        joint("weld", Axis::Fixed, ["body", "other"], [0.0; 2], ""),
    ]))
}

/// A state that moves at (0, -0.6) m/s and 0.5 rad/s, with more fields.
fn striking(z: f64, more: Value) -> Value {
    let mut state = json!({"position": {"base": {"z": z}}, "velocity": {"base": {"z": -0.6, "pitch": 0.5}}});
    state.as_object_mut().unwrap().extend(more.as_object().cloned().unwrap_or_default());
    state
}

fn nearest(impact: &Impact) -> NearestFoot {
    impact.nearest.expect("an open foot")
}

#[test]
fn near_miss_is_named_with_height_and_velocity() {
    let impact = impact(&two_feet(3e-5), striking(0.0, json!({})));
    assert_eq!(impact.contacts.len(), 1);
    let NearestFoot { link, height, velocity, .. } = nearest(&impact);
    assert_eq!(link, 1);
    assert_close(&[height, velocity[0], velocity[1]], &[3e-5, 1.5e-5, -1.1]);
    let expected = "other nearly touches, 3e-5 m above the ground: to let it touch, give the option `contact_tolerance: 3.3e-5`, or \
                    correct the pose";
    assert_eq!(impact.notes, [expected]);
}

#[test]
fn far_or_leaving_foot_is_no_near_miss() {
    for (height, up) in [(0.05, json!({})), (3e-5, json!({"velocity": {"base": {"z": 0.6}}}))] {
        let impact = impact(&two_feet(height), striking(0.0, up));
        assert_close(&[nearest(&impact).height], &[height]);
        assert!(impact.notes.is_empty(), "{:?}", impact.notes);
    }
}

#[test]
fn nearest_is_absent_when_every_foot_touches() {
    assert_eq!(impact(&two_feet(0.0), striking(0.0, json!({}))).nearest, None);
    assert_eq!(impact(&sole(), json!({"position": {"base": {"z": 0.1}}})).nearest, None);
}

#[test]
fn raised_end_of_a_flat_sole_is_an_open_foot() {
    // The rear end of the sole is 0.4 m behind the front end, which touches.
    let tilted = |pitch: f64| {
        let z = 0.2 * pitch.sin() + 0.1 * pitch.cos();
        let velocity = json!({"base": {"z": -1.0}});
        impact(&sole(), json!({"position": {"base": {"z": z, "pitch": pitch}}, "velocity": velocity}))
    };
    let heel = tilted(1e-3);
    assert_close(&[nearest(&heel).height], &[0.4 * 1e-3_f64.sin()]);
    assert!(heel.notes[0].starts_with("another point of "), "{:?}", heel.notes);
    assert_eq!(tilted(0.3).nearest, None, "a block on its edge");
}

#[test]
fn a_round_foot_has_no_other_point() {
    let ball = robot(&urdf::body(0.5, &collision([0.3, -0.4], "sphere radius=\"0.05\"")));
    for step in 0..200 {
        let angle = 0.37 * f64::from(step);
        let state = json!({"place": "lowest", "ground": {"slope": 0.3 * angle.sin()},
            "position": {"base": {"x": angle.cos(), "pitch": angle}}, "velocity": {"base": {"z": -1}}});
        let found = impact(&ball, state);
        assert_eq!((found.contacts.len(), found.nearest), (1, None));
        assert!(!found.notes.iter().any(|note| note.contains("nearly touches")), "{:?}", found.notes);
    }
}

#[test]
fn nearest_over_a_profile_is_found_at_its_edge() {
    // The stair's edge is under the middle of the sole.
    let over = state([0.0, 0.35, 0.0], FALLING, 0.5, &step(0.0, 0.2));
    let NearestFoot { height, velocity, .. } = nearest(&impact(&sole(), over));
    assert_close(&[height, velocity[0], velocity[1]], &[0.05, 0.0, -1.0]);
}

/// The nearest foot is the nearer of two boxes over slopes, notches and spikes. Its height is the least distance of a
/// corner of one boundary from a side of the other.
#[test]
fn nearest_over_a_profile_is_at_its_distance() {
    let foot = |x: f64| collision([x, 0.0], "box size=\"0.4 1 0.2\"");
    let robot = robot(&urdf::robot(&[
        link("body", 2.0, [0.0; 2], 0.5, &foot(0.0)),
        link("other", 1.0, [0.0; 2], 0.5, &foot(1.0)),
        joint("weld", Axis::Fixed, ["body", "other"], [0.0; 2], ""),
    ]));
    let mut random = Random::new(3);
    for _ in 0..300 {
        let point = |x: i32| [0.1 * f64::from(x), random.between(-0.4, 0.4)];
        let ground: Vec<[f64; 2]> = (-30..=30).map(point).collect();
        let base = json!({"x": random.between(-1.0, 1.0), "pitch": random.between(-3.0, 3.0)});
        let mut state =
            json!({"position": {"base": base}, "friction": 1, "place": "lowest", "ground": {"profile": ground}});
        let lowest = impact(&robot, state.clone()).placement.world(0, Vector::zero()).z;
        state["position"]["base"]["z"] = json!(lowest + random.between(0.01, 1.0));
        state.as_object_mut().unwrap().remove("place");
        let found = impact(&robot, state.clone());
        let distance = |x: f64| {
            let corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1]];
            let corners = corners.map(|[along, up]| found.placement.world(0, Vector::new(x + along, up)).components());
            let beside = |points: &[[f64; 2]], sides: &[[f64; 2]]| {
                let all = points.iter().flat_map(|point| sides.windows(2).map(|side| from_side(*point, side)));
                all.fold(f64::INFINITY, f64::min)
            };
            beside(&corners, &ground).min(beside(&ground, &corners))
        };
        let (own, distances) = (nearest(&found), [0.0, 1.0].map(distance));
        assert!((own.height - distances[0].min(distances[1])).abs() < 1e-12, "{own:?} {distances:?} {state}");
        assert!((distances[own.link] - own.height).abs() < 1e-12, "{own:?} {distances:?} {state}");
    }
}

/// Returns the distance of a point from the side between two others.
fn from_side([x, z]: [f64; 2], side: &[[f64; 2]]) -> f64 {
    let ([dx, dz], [x, z]) = ([side[1][0] - side[0][0], side[1][1] - side[0][1]], [x - side[0][0], z - side[0][1]]);
    let part = ((x * dx + z * dz) / (dx * dx + dz * dz)).clamp(0.0, 1.0);
    (x - part * dx).hypot(z - part * dz)
}

#[test]
fn foot_in_the_air_is_named_with_a_remedy() {
    let impact = impact(&two_feet(0.5), striking(1e-3, json!({})));
    let expected = "nothing touches the ground: the lowest foot, body, is 0.001 m above it and moves toward it at \
                    0.6 m/s; to let it touch, put it there by `place: lowest`, or by the option `contact_tolerance: 1.1e-3`";
    assert_eq!(impact.notes, [expected]);
}

#[test]
fn lowest_foot_is_put_on_the_ground() {
    let robot = two_feet(-0.25);
    for ground in [json!({"slope": 0.0}), json!({"slope": 0.3}), json!({"profile": step(0.75, 0.2)})] {
        // The height of the base at which the second foot, 0.25 m below the first and 1 m ahead, touches.
        let rise = match &ground["slope"] {
            Value::Null => 0.45,
            slope => 0.25 + slope.as_f64().unwrap().tan(),
        };
        let placed = impact(&robot, striking(7.0, json!({"ground": ground, "place": "lowest"})));
        let by_hand = impact(&robot, striking(rise, json!({"ground": ground})));
        assert_same_outcomes(&placed, &by_hand);
        assert_eq!(&*placed.contacts[0].name, "other");
        assert_close(&[placed.contacts[0].gap], &[0.0]);
        let buried = impact(&robot, striking(-7.0, json!({"ground": ground, "place": "lowest"})));
        assert_same_outcomes(&buried, &by_hand);
    }
}

/// A robot of one point has no size to compare heights with.
#[test]
fn a_point_mass_falls_and_lands_anywhere() {
    let robot = super::point();
    let above = impact(&robot, json!({"position": {"base": {"x": 3, "z": 0.3}}, "friction": 1}));
    assert_close(&[nearest(&above).height], &[0.3]);
    let placed = impact(
        &robot,
        json!({"position": {"base": {"x": 3, "z": 0.3}}, "velocity": {"base": {"z": -1}},
        "friction": 1, "place": "lowest"}),
    );
    assert_eq!(placed.velocity_before, [[0.0, -1.0]]);
}

#[test]
fn a_foot_beyond_both_ends_of_the_ground_is_put_on() {
    let plank =
        robot(&urdf::robot(&[link("plank", 2.0, [0.0; 2], 0.1, &collision([0.0; 2], "box size=\"1 1 0.05\""))]));
    for points in [json!([[-0.2, 0], [0.2, 0]]), json!([[-0.2, 0], [0, -0.3], [0.2, 0]])] {
        let placed = |z: f64| {
            let state = json!({"position": {"base": {"z": z}}, "velocity": {"base": {"z": -1}}, "place": "lowest",
                "friction": 1, "ground": {"profile": points}});
            impact(&plank, state)
        };
        for z in [-3.0, 0.0, 0.02, 5.0] {
            let points: Vec<f64> = placed(z).contacts.iter().flat_map(|contact| contact.point.components()).collect();
            assert_close(&points, &[-0.2, 0.0, 0.2, 0.0]);
        }
    }
}

#[test]
fn a_foot_beside_the_end_is_put_on_it_from_any_height() {
    // The ball's center is beyond the end. If the ball is lower than that, its rear foot may be the lower one over the
    // ground.
    let [ball, rear] =
        [collision([0.03, 0.0], "sphere radius=\"0.05\""), collision([-0.5, 0.3], "sphere radius=\"0.01\"")];
    let ball = robot(&urdf::robot(&[link("ball", 2.0, [0.0; 2], 0.1, &(ball + &rear))]));
    for z in [-3.0, -0.3, 0.0, 0.1, 0.5, 5.0] {
        let state = json!({"position": {"base": {"z": z}}, "velocity": {"base": {"z": -1}}, "place": "lowest",
            "friction": 1, "ground": {"profile": [[-2, 0], [0, 0]]}});
        let placed = impact(&ball, state);
        assert_eq!(placed.contacts.len(), 1);
        assert_close(&placed.contacts[0].point.components(), &[0.0, 0.0]);
    }
}

#[test]
fn nearest_rim_of_an_oblique_cylinder_is_found_over_a_profile() {
    let oblique = body(r#"<origin rpy="0.7 0 0"/><geometry><cylinder radius="0.05" length="0.3"/></geometry>"#);
    let profile = json!([[-0.5, 0], [0, 0], [0.3, -0.1], [0.6, 0.05], [1, 0.1]]);
    for x in (-40..=80).map(|step| 0.01 * f64::from(step)) {
        let state = json!({"position": {"base": {"x": x, "z": 0.3, "pitch": 0.3}}, "friction": 0.5,
            "ground": {"profile": profile}});
        let nearest = nearest(&impact(&oblique, state.clone()));
        let mut placed = state;
        placed["place"] = json!("lowest");
        let drop = 0.3 - impact(&oblique, placed).placement.world(0, Vector::zero()).z;
        // Slopes are at most 0.5, so that the height along a normal is at least 0.89 times the drop along z. Over a
        // corner of the ground the height of an ellipse is that to a tangent at its rim, which is less: hence 0.8.
        assert!((0.8 * drop..drop + 1e-9).contains(&nearest.height), "{x}: {nearest:?} of {drop}");
    }
}

#[test]
fn lowest_foot_beyond_the_profile_is_refused() {
    let beyond = json!({"position": {"base": {"x": 9}}, "place": "lowest", "ground": {"profile": step(0.0, 0.2)}});
    let error = try_impact(&two_feet(0.0), Options::default(), beyond).expect_err("no ground");
    assert_eq!((error.place(), error.reason().to_string().as_str()), (Some("place"), "no foot is above the ground"));
}

#[test]
fn deep_foot_is_refused_with_its_velocity() {
    let refused = |more| {
        let error = try_impact(&two_feet(-0.25), Options::default(), striking(0.0, more)).expect_err("too deep");
        let Reason::Penetration { velocity: Some(velocity), .. } = error.reason() else { panic!("{error}") };
        (*velocity, error.remedy().expect("a remedy").to_owned())
    };
    let (velocity, remedy) = refused(json!({}));
    assert_close(&velocity, &[-0.125, -1.1]);
    assert!(remedy.starts_with("raise the base by 0.25 m"), "{remedy}");
    // On a slope the base is raised along the vertical.
    let sloped = json!({"position": {"base": {"z": -1}}, "ground": {"slope": 1}});
    let error = try_impact(&two_feet(-0.25), Options::default(), striking(0.0, sloped)).expect_err("too deep");
    let raise: f64 = error.remedy().and_then(|hint| hint.split(' ').nth(4)?.parse().ok()).expect("a height");
    // The other point is 1 m ahead, where the ground is tan(1) m higher.
    assert!((raise - (1.25 + 1_f64.tan())).abs() < 1e-5, "{raise}");
    // With a stance the user cannot move the base; the foot turns about the one that stands.
    let (velocity, remedy) = refused(json!({"stance": "body", "position": {}, "velocity": {"base": {"pitch": 0.5}}}));
    assert_close(&velocity, &[-0.125, -0.5]);
    assert!(remedy.contains("stand on other") && !remedy.contains("raise"), "{remedy}");
}

/// The notes on doubtful states of two feet and of RAMone, and on similar states that are not doubtful.
#[test]
fn doubtful_scenes_are_noted_word_for_word() {
    let (high, ramone) = (two_feet(0.5), robot(RAMONE));
    let with = |more: Value| {
        let mut state = striking(0.0, json!({"friction": 1, "contacts": [{"link": "body"}]}));
        state.as_object_mut().unwrap().extend(more.as_object().cloned().unwrap_or_default());
        (&high, state)
    };
    let falling = |z: f64| with(json!({"velocity": {"base": {"z": z}}}));
    let width = |z: f64| with(json!({"uncertainty": {"velocity": {"base": {"z": z}}}}));
    let turning = |rate: f64| {
        let velocity = json!({"joints": {"left_hip": rate}});
        (&ramone, json!({"velocity": velocity, "place": "lowest", "friction": 1}))
    };
    let foot = |link: &str, radius: f64| json!({"link": link, "radius": radius});
    let named = |contacts: Value, knee: f64| {
        let joints = json!({"left_hip": 0.3, "left_knee": -0.5, "right_hip": 0.3, "right_knee": knee});
        let state = json!({"position": {"joints": joints}, "velocity": {"base": {"z": -1}}, "place": "lowest",
            "contacts": contacts, "friction": 1});
        (&ramone, state)
    };
    let [left, right] = ["left_foot", "right_foot"].map(|link| foot(link, 0.02815));
    let mut notes = String::new();
    for (what, (robot, state)) in [
        ("a slope of -0.7", with(json!({"ground": {"slope": -0.7}}))),
        ("a slope of -1", with(json!({"ground": {"slope": -1.0}}))),
        ("a fall at 100 m/s", falling(-100.0)),
        ("a fall at 500 m/s", falling(-500.0)),
        ("a hip at 100 rad/s", turning(100.0)),
        ("a hip at 286 rad/s", turning(286.0)),
        ("a half-width", width(0.1)),
        ("no half-width", width(0.0)),
        ("a contact above the body", with(json!({"contacts": [{"link": "body", "offset": [0, 0, 0.25]}]}))),
        ("two feet", named(json!([left, right]), -0.5)),
        ("a foot that is higher", named(json!([left, right]), -1.2)),
        ("a foot that is named twice", named(json!([left, left]), -0.6)),
        ("a foot without its radius", named(json!([foot("left_foot", 0.0)]), -0.6)),
    ] {
        let found: String = impact(robot, state).notes.iter().map(|note| format!("    {note}\n")).collect();
        notes += &format!("{what}\n{found}");
    }
    for tolerance in [0.9, 5.0] {
        let options = Options { contact_tolerance: Some(tolerance), ..Options::default() };
        let found = try_impact(&two_feet(0.0), options, striking(0.0, json!({"friction": 1}))).unwrap();
        notes += &format!("a tolerance of {tolerance}: {:?}\n", found.notes);
    }
    insta::assert_snapshot!(notes);
}
