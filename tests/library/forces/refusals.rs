//! States that are refused because they are not in sustained contact, and similar ones that are answered.

use super::{rod, try_forces};
use crate::support::impact::{outcomes, robot};
use crate::support::urdf::{self, HINGE, body, collision, joint, link};
use serde_json::json;

#[test]
fn contact_that_approaches_is_an_impact() {
    let state = json!({"velocity": {"base": {"z": -0.2}}, "contacts": [{"link": "rod", "offset": [0, 0, 0]}]});
    let error = try_forces(&rod(1.0, 1.0), &state).unwrap_err();
    assert!(error.to_string().contains("rod approaches the ground at 0.2 m/s"), "{error}");
    assert!(error.remedy().unwrap().contains("`impact`"), "{error}");
    let state = json!({"impulse": [{"link": "rod", "vector": [0, 1]}]});
    assert_eq!(try_forces(&rod(1.0, 1.0), &state).unwrap_err().place(), Some("impulse"));
}

#[test]
fn wheel_on_a_corner_may_stand_but_not_roll() {
    let wheel = robot(&body(0.1, &collision([0.0; 2], "sphere radius=\"0.25\"")));
    let profile = json!({"profile": [[-1, -1], [0, 0], [1, -1]]});
    let standing = json!({"position": {"base": {"z": 0.25}}, "ground": profile});
    assert!(try_forces(&wheel, &standing).is_ok());
    let mut rolling = standing;
    rolling["velocity"] = json!({"base": {"x": 0.25, "pitch": 1.0}});
    let error = try_forces(&wheel, &rolling).unwrap_err();
    assert_eq!(error.place(), Some("ground.profile"), "{error}");
}

#[test]
fn circles_of_other_radii_at_one_place_are_refused() {
    let circles = |radii: [f64; 2], spin: f64| {
        let shapes = radii.map(|radius| collision([0.0, radius], &format!("sphere radius=\"{radius}\"")));
        try_forces(&robot(&body(0.1, &shapes.concat())), json!({"velocity": {"base": {"pitch": spin}}}))
    };
    assert!(circles([0.3, 0.3], 2.0).is_ok());
    assert!(circles([0.3, 0.1], 0.0).is_ok());
    let error = circles([0.3, 0.1], 2.0).unwrap_err();
    assert!(error.to_string().contains("circles of different radii touch the ground at one place"), "{error}");
}

#[test]
fn uncertainty_leaves_what_is_zero_to_rounding() {
    // A rolling wheel: the velocity of its lowest point is zero up to rounding.
    let wheel = robot(&body(0.1, &collision([0.0; 2], "sphere radius=\"0.3\"")));
    let mut state = json!({"position": {"base": {"z": 0.3, "pitch": 0.3}},
        "velocity": {"base": {"x": 0.3 * 0.7, "z": 1e-17, "pitch": 0.7}}});
    let without = try_forces(&wheel, &state).unwrap();
    state["uncertainty"] = json!({"friction": 0.01});
    let with = try_forces(&wheel, &state).unwrap();
    assert_eq!(format!("{:?}", with.sustained.unwrap().slips), format!("{:?}", without.sustained.unwrap().slips));
    assert!(with.notes.iter().any(|note| note.starts_with("the uncertainty is ignored")));
    let others: Vec<_> = with.notes.iter().filter(|note| !note.starts_with("the uncertainty is ignored")).collect();
    assert_eq!(others, without.notes.iter().collect::<Vec<_>>());
}

/// Two points that differ only by rounding are one place, about which the body may turn.
#[test]
fn places_apart_by_rounding_do_not_stop_a_turn() {
    let at = |x: f64| json!({"link": "rod", "offset": [x, 0, -0.3]});
    let state = |contacts: serde_json::Value| {
        json!({"position": {"base": {"z": 0.3}}, "velocity": {"base": {"x": 2.0 * -0.3 + 1.0, "z": 2.0 * 0.1, "pitch": 2.0}},
            "contacts": contacts})
    };
    let free = |contacts| try_forces(&rod(1.0, 1.0), state(contacts)).unwrap().problem.velocity_free().to_vec();
    let one = free(json!([at(0.1)]));
    let two = free(json!([at(0.1), at(0.1_f64.next_up())]));
    // omega^2 times the arm: upward by 1.2, backward by 0.4 m/s^2.
    assert!((one[0][1] - (1.2 - 9.81)).abs() < 1e-14 && (one[0][0] + 0.4).abs() < 1e-14, "{one:?}");
    assert!(two.iter().zip([one[0], one[0]]).all(|(two, one)| (two[1] - one[1]).abs() < 1e-14), "{two:?} {one:?}");
}

#[test]
fn what_leaves_the_range_of_f64_has_a_remedy() {
    let massless = robot(&urdf::robot(&[
        link("base", 1.0, [0.0; 2], 1.0, ""),
        link("leaf", 1e-300, [0.0; 2], 1e-300, ""),
        joint("hinge", HINGE, ["base", "leaf"], [0.0; 2], ""),
    ]));
    let heavy = json!({"gravity": 1e308, "contacts": [], "velocity": {"base": {"x": 1.0}}});
    let found = try_forces(&rod(1.0, 1.0), &heavy).expect("within the range");
    assert_eq!(outcomes(&found)[0].velocity().collect::<Vec<_>>(), [0.0, -1e308, 0.0]);
    let error =
        try_forces(&massless, json!({"torque": {"hinge": 1e30}, "contacts": []})).expect_err("beyond the range");
    assert_eq!(error.to_string(), "an acceleration must be a finite number, not inf");
    assert!(error.remedy().is_some_and(|remedy| remedy.contains("too large for the masses")), "{error}");
}

/// A sole slides flat on a stair, over its edge. If the sole rotates, the normal at the edge rotates with it.
#[test]
fn a_sole_that_turns_over_an_edge_is_refused() {
    let sole = robot(&urdf::body(0.5, &collision([0.0; 2], "box size=\"0.4 0.1 0.2\"")));
    let slides = |turn: f64| {
        let state = json!({"position": {"base": {"z": 0.1}}, "friction": 0.5,
            "velocity": {"base": {"x": 1.0, "z": 0.125 * turn, "pitch": turn}},
            "ground": {"profile": [[-1, 0], [0.125, 0], [0.126, -1], [1, -1]]}});
        try_forces(&sole, &state)
    };
    assert_eq!(slides(0.0).expect("an answer").contacts.len(), 2);
    let reason = slides(0.5).expect_err("it turns").to_string();
    assert!(reason.contains("moves over a corner of the ground"), "{reason}");
}

/// Two links of 0.5 m hang straight down, and a loop pins their end 1 m below their hinge. Their rates keep the loop
/// closed, but the rotation of each link pulls the end up with 0.5 omega^2.
#[test]
fn a_loop_that_moves_through_its_dead_point_is_refused() {
    let leg = |name: &str, shape: &str| link(name, 1.0, [0.0, -0.25], 0.02, shape);
    let tri = robot(&urdf::robot(&[
        link("root", 5.0, [0.0; 2], 0.05, ""),
        leg("upper", ""),
        leg("lower", &collision([0.0, -0.5], "sphere radius=\"0\"")),
        joint("hip", HINGE, ["root", "upper"], [0.0; 2], ""),
        joint("knee", HINGE, ["upper", "lower"], [0.0, -0.5], ""),
    ]));
    let state = |rate: f64| {
        json!({"position": {"base": {"z": 1}}, "friction": 0.5,
            "velocity": {"base": {"x": 0.5 * rate - 0.2 * rate}, "joints": {"hip": rate, "knee": -2.0 * rate}},
            "loops": [{"a": {"link": "lower", "offset": [0, 0, -0.5]}, "b": {"link": "root", "offset": [0, 0, -1]}}]})
    };
    let error = try_forces(&tri, state(1.0)).unwrap_err();
    assert!(error.to_string().contains("no acceleration keeps loops[0] (lower - root) closed"), "{error}");
    assert!(error.to_string().contains("part at 1 m/s^2"), "{error}");
    assert!(try_forces(&tri, state(0.0)).is_ok(), "at rest it stays closed");
}

/// A coupler on three parallel cranks of one length: one loop follows from the others, whether they move, hang or are
/// locked.
#[test]
fn loops_that_follow_from_others_are_no_dead_points() {
    let crank = |name: &str, at: f64| {
        link(name, 1.0, [0.0, -0.2], 0.01, "") + &joint(format!("j{name}"), HINGE, ["world", name], [at, 0.0], "")
    };
    let cranks = [("a", 0.0), ("b", 0.4), ("c", 0.8)].map(|(name, at)| crank(name, at)).concat();
    let coupler = link("coupler", 2.0, [0.4, 0.0], 0.1, "");
    let pin = joint("jd", HINGE, ["a", "coupler"], [0.0, -0.4], "");
    let robot = robot(&urdf::robot(&["<link name=\"world\"/>".to_owned(), cranks, coupler, pin]));
    let end = |name: &str, at: f64| json!({"a": {"link": name, "offset": [0, 0, -0.4]}, "b": {"link": "coupler", "offset": [at, 0, 0]}});
    for (angle, rate, held, gravity) in [
        (0.3, 3.0, json!([]), 9.81),
        (0.3, 3.0, json!([]), 0.0),
        (0.0, 0.0, json!([]), 9.81),
        (0.0, 3.0, json!([]), 9.81),
        (0.3, 0.0, json!(["ja"]), 9.81),
        (0.7, 30.0, json!(["ja"]), 9.81),
        (0.7, 1e4, json!([]), 0.0),
    ] {
        // The exact pose, and one whose rounding to five digits leaves the loops open.
        for off in [[0.0; 2], [3e-6, -4e-6]] {
            let state = json!({
                // The coupler stays level: its hinge turns back by the same angle.
                "position": {"joints": {"ja": angle, "jb": angle + off[0], "jc": angle + off[1], "jd": -angle}},
                "velocity": {"joints": {"ja": rate, "jb": rate, "jc": rate, "jd": -rate}},
                "held": held, "gravity": gravity, "loops": [end("b", 0.4), end("c", 0.8)], "contacts": [],
            });
            let found = try_forces(&robot, &state);
            assert!(found.is_ok(), "{:?}\n{state}", found.err());
        }
    }
}
