//! Contacts that rest up to rounding, and contacts that depend on them: a state with exact rates has the same outcomes
//! as the state with its rates off by less than f64 resolves.

use crate::support::impact::{impact, is_proven, modes, robot, try_impact};
use crate::support::mechanism::{point, turned};
use crate::support::random::Random;
use crate::support::scaled::near;
use crate::support::urdf::{self, Axis, HINGE};
use heelstrike::impact::Mode::{Separate, SlideMinus, Stick};
use heelstrike::impact::Verdict;
use heelstrike::pipeline::{Impact, Options};
use heelstrike::{Reason, Robot};
use serde_json::{Value, json};

#[test]
fn an_exact_zero_is_not_noted() {
    let block = robot(include_str!("../../urdf/block.urdf"));
    let found = impact(&block, json!({"friction": 0.5, "velocity": {"base": {"pitch": 1}}}));
    assert_eq!((found.contacts.len(), &found.notes[..]), (1, &[][..]));
}

#[test]
fn a_speed_of_zero_with_an_uncertainty_is_no_number() {
    let disc = urdf::collision([0.0; 2], "sphere radius=\"0.5\"");
    let rolling = json!({
        "position": {"base": {"z": 0.5, "pitch": 0.3}}, "velocity": {"base": {"x": 0.5, "pitch": 1}}, "friction": 0.7,
        "uncertainty": {"position": {"base": {"pitch": 0.01}}},
    });
    let notes = impact(&robot(&urdf::robot(&[urdf::link("disc", 1.0, [0.0; 2], 0.1, &disc)])), rolling).notes;
    assert!(notes.iter().any(|note| note.starts_with("disc does not move, within the rounding")), "{notes:?}");
}

/// A slide on the world, a slide on that and an arm: three contacts on three degrees of freedom. The arm's point rests
/// up to 1.6e-16 m/s. The fixed base cannot move with it.
#[test]
fn a_bolted_robot_strikes_beside_a_point_that_rests() {
    let robot = robot(&urdf::robot(&[
        urdf::link("world", 0.0, [0.0; 2], 0.0, "").replace("<inertial>", "<!--").replace("</inertial>", "-->"),
        urdf::link("first", 2.0, [0.0; 2], 1.0, ""),
        urdf::link("second", 3.0, [0.0; 2], 1.0, ""),
        urdf::link("arm", 1.0, [0.1, 0.2], 0.1, ""),
        urdf::joint("along", Axis::Prismatic([0.6, -0.8]), ["world", "first"], [0.0; 2], ""),
        urdf::joint("up", Axis::Prismatic([0.3, 1.0]), ["first", "second"], [0.0; 2], ""),
        urdf::joint("shoulder", HINGE, ["second", "arm"], [0.0; 2], ""),
    ]));
    let rates = [0.81, 1.705_643_157_221_622_9, 2.576_030_364_490_954_6];
    let state = json!({
        "position": {"joints": {"shoulder": 0.4}}, "friction": 1.5,
        "velocity": {"joints": {"along": rates[0], "up": rates[1], "shoulder": rates[2]}},
        "contacts": [point("first", [0.0; 2]), point("second", [0.0; 2]), point("arm", [0.5, -0.2])],
    });
    let found = impact(&robot, state);
    assert_eq!(found.resting, [false, false, true]);
    assert!(is_proven(&found));
    // The expected modes come from an enumeration with linear programs.
    assert_eq!(modes(&found), [[Stick, Separate, SlideMinus]]);
}

/// The state of a torso on two hinged legs with `rates` [x, z, pitch, left, right]; a point of the torso is between the
/// feet.
fn squatting(rates: [f64; 5], friction: &Value) -> Value {
    let [x, z, pitch, left, right] = rates;
    json!({
        "position": {"base": {"z": 1}}, "friction": friction,
        "velocity": {"base": {"x": x, "z": z, "pitch": pitch}, "joints": {"left": left, "right": right}},
        "contacts": [point("torso", [0.125, -1.0]), point("left_leg", [-0.25, -1.0]), point("right_leg", [0.25, -1.0])],
    })
}

/// Both feet rest while the torso comes down, which five degrees of freedom allow in exactly one way.
#[test]
fn a_torso_lands_between_two_feet_that_rest() {
    let robot = robot(&urdf::robot(&[
        urdf::link("torso", 8.0, [0.0, 0.25], 0.5, ""),
        urdf::link("left_leg", 1.0, [0.0, -0.5], 0.0625, ""),
        urdf::link("right_leg", 1.0, [0.0, -0.5], 0.0625, ""),
        urdf::joint("left", HINGE, ["torso", "left_leg"], [-0.25, 0.0], ""),
        urdf::joint("right", HINGE, ["torso", "right_leg"], [0.25, 0.0], ""),
    ]));
    let exact = [-0.5, 0.0, 0.5, -1.0, -1.0];
    for friction in [json!(0), json!(0.3), json!(0.8), json!(5), json!("infinite")] {
        let standing = impact(&robot, squatting(exact, &friction));
        assert_eq!(standing.velocity_before, [[-1.0, -0.0625], [0.0; 2], [0.0; 2]]);
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let rates = exact.map(|rate| rate + random.between(-1.0, 1.0) * f64::EPSILON);
            let resting = impact(&robot, squatting(rates, &friction));
            assert_eq!(resting.resting, [false, true, true], "seed {seed}");
            assert!(is_proven(&resting), "seed {seed} with friction {friction}");
            assert_eq!(modes(&resting), modes(&standing), "seed {seed} with friction {friction}");
        }
    }
}

/// The given `resting_speed` puts two points at rest although their body turns: the body then rests with all its
/// points.
#[test]
fn two_points_at_rest_hold_their_body() {
    let robot = robot(&urdf::body(0.0625, ""));
    let contacts = [[0.0, -0.09375], [-0.125, -0.125], [0.25, -0.125]].map(|at| point("body", at));
    let state = json!({"position": {"base": {"z": 0.125}}, "velocity": {"base": {"x": 0.125, "pitch": 1}},
        "friction": 0.5, "contacts": contacts});
    let options = Options { resting_speed: Some(0.2), ..Options::default() };
    let found = try_impact(&robot, options, state).expect("an answer");
    let held = found.notes.iter().filter(|note| note.contains("those at rest hold its body"));
    assert_eq!((&found.velocity_before, held.count()), (&vec![[0.0; 2]; 3], 1), "{:?}", found.notes);
    assert!(is_proven(&found) && found.analysis.is_some_and(|analysis| analysis.verdict == Verdict::NoImpact));
}

/// A foot with two contacts rests, while the braked hip keeps its rate and swings the other leg.
#[test]
fn a_held_joint_swings_a_leg_over_a_foot_at_rest() {
    let robot = robot(&urdf::robot(&[
        urdf::link("leg", 2.0, [0.0, -0.5], 0.2, ""),
        urdf::link("stand", 10.0, [0.0, -0.5], 1.0, ""),
        urdf::joint("hip", HINGE, ["leg", "stand"], [0.0; 2], ""),
    ]));
    let reach = 1.139_493_927_324_549;
    let state = json!({
        "position": {"base": {"z": 1, "pitch": -0.5}, "joints": {"hip": 0.4}}, "friction": 0.5, "held": ["hip"],
        "velocity": {"base": {"pitch": 1}, "joints": {"hip": -1}},
        "contacts": [point("stand", [-0.1, -0.98]), point("stand", [0.1, -1.0]), point("leg", [0.0, -reach])],
    });
    let found = impact(&robot, state);
    // The leg's point moves about the hip at 1 rad/s.
    let moving = [-reach * 0.5_f64.cos(), -reach * 0.5_f64.sin()];
    for (contact, expected) in found
        .contacts
        .iter()
        .zip(&found.velocity_before)
        .map(|(own, c)| (c, if own.link == 0 { moving } else { [0.0; 2] }))
    {
        assert!(near(contact, &expected, 1e-14), "{contact:?} is not {expected:?}");
    }
    assert_eq!(found.resting.iter().filter(|rests| **rests).count(), 2);
    assert!(is_proven(&found) && found.analysis.is_some_and(|analysis| analysis.verdict == Verdict::Unique));
}

/// The root is given at rest. Closing the loop changes its velocity by some 1e-18 m/s, and it must still count as at
/// rest.
#[test]
fn what_rests_as_given_rests_next_to_a_loop() {
    let robot = robot(&urdf::robot(&[
        urdf::link("root", 5.5, [0.26, -0.44], 0.36, ""),
        urdf::link("first", 2.2, [-0.25, 0.01], 0.06, ""),
        urdf::link("second", 0.19, [-0.007, 0.49], 0.014, ""),
        urdf::link("third", 0.11, [-0.39, -0.42], 0.0015, ""),
        urdf::joint("j1", HINGE, ["root", "first"], [-0.098, -0.59], ""),
        urdf::joint("j2", HINGE, ["first", "second"], [-0.53, 0.36], ""),
        urdf::joint("j3", HINGE, ["second", "third"], [0.3, -0.58], ""),
    ]));
    // A point of the third link in the frame of the first.
    let on_first = |[_, j2, j3]: [f64; 3], at: [f64; 2]| {
        let [x, z] = turned(at, j3);
        let [x, z] = turned([x + 0.3, z - 0.58], j2);
        [x - 0.53, z + 0.36]
    };
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut number = || random.between(-1.0, 1.0);
        let (pitch, angles, rate) = (number(), [number(), number(), number()], number());
        let b = [number(), number()];
        let state = json!({
            "position": {"base": {"pitch": pitch}, "joints": {"j1": angles[0], "j2": angles[1], "j3": angles[2]}},
            "velocity": {"joints": {"j1": rate}}, "friction": 0.8,
            "contacts": [point("root", [-0.33, -0.5]), point("root", [0.24, -0.86])],
            "loops": [{"a": point("first", on_first(angles, b)), "b": point("third", b)}],
        });
        let found = impact(&robot, state);
        assert!(is_proven(&found), "seed {seed}");
        assert_eq!(found.analysis.expect("an analysis").verdict, Verdict::NoImpact, "seed {seed}");
    }
}

/// A torso on two legs of thigh, shank and a flat foot whose sole is 0.05 m below its ankle.
fn flat_footed() -> Robot {
    let mut parts = vec![urdf::link("torso", 10.0, [0.0, 0.25], 0.4, "")];
    for side in ["left", "right"] {
        let [thigh, shank, foot] = ["thigh", "shank", "foot"].map(|part| format!("{side}_{part}"));
        let sole = urdf::collision([0.0625, -0.03], "box size=\"0.25 0.1 0.04\"");
        parts.extend([
            urdf::link(&thigh, 1.5, [0.0, -0.18], 0.02, "") + &urdf::link(&shank, 0.8, [0.0, -0.2], 0.01, ""),
            urdf::link(&foot, 0.4, [0.06, -0.03], 0.001, &sole),
            urdf::joint(format!("{side}_hip"), HINGE, ["torso", &thigh], [0.0; 2], ""),
            urdf::joint(format!("{side}_knee"), HINGE, [&thigh, &shank], [0.0, -0.4], ""),
            urdf::joint(format!("{side}_ankle"), HINGE, [&shank, &foot], [0.0, -0.4], ""),
        ]);
    }
    robot(&urdf::robot(&parts))
}

/// The state with these angles and rates of hip and knee of each leg; ankles keep the feet level, rounded to
/// `decimals`.
fn level(angles: [[f64; 2]; 2], rates: [[f64; 2]; 2], decimals: i32) -> Value {
    let rounded = |number: f64| (number * 10_f64.powi(decimals)).round() / 10_f64.powi(decimals);
    let part = |numbers: [[f64; 2]; 2], pitch: f64| {
        let mut joints = serde_json::Map::new();
        for (side, [hip, knee]) in ["left", "right"].into_iter().zip(numbers) {
            let all = [("hip", hip), ("knee", knee), ("ankle", rounded(-pitch - hip - knee))];
            joints.extend(all.map(|(joint, own)| (format!("{side}_{joint}"), json!(own))));
        }
        json!({"base": {"pitch": pitch}, "joints": joints})
    };
    json!({"position": part(angles, 0.05), "velocity": part(rates, 1.04), "friction": 0.8})
}

/// Rates that cancel in decimals sum to some 1e-17 rad/s in f64, with which J v of the sole's other corner may round to
/// 0.
#[test]
fn the_whole_sole_stands_with_its_stance() {
    let robot = flat_footed();
    let (mut random, mut answered) = (Random::new(1), 0);
    for _ in 0..200 {
        let mut hundredth = || f64::from(random.whole(-199, 199) as i32) / 100.0;
        let [own, other, rates] = [(); 3].map(|()| [hundredth(), hundredth()]);
        let mut state = level([own, other], [rates, [0.85, 1.63]], 2);
        state["stance"] = json!("left_foot");
        // In some poses the other leg is in the ground.
        let found = match try_impact(&robot, Options::default(), &state) {
            Ok(found) => found,
            Err(error) => {
                let Reason::Penetration { link, .. } = error.reason() else { panic!("{error}") };
                assert_eq!(link, "right_foot");
                continue;
            }
        };
        answered += 1;
        assert_eq!(found.contacts.len(), 2, "{state}");
        let analysis = found.analysis.as_ref().expect("an answer");
        assert_eq!((analysis.verdict, analysis.proven), (Verdict::NoImpact, true), "{state}");
        assert_eq!(modes(&found)[0], [Stick; 2], "{state}");
    }
    assert!(answered > 50, "{answered}");
}

/// Both feet are meant to stand. The digits of the pose lift one of them, or noise of the rates moves one.
#[test]
fn feet_that_nearly_stand_are_noted() {
    let robot = flat_footed();
    let standing = level([[0.3, -0.6], [0.5, -1.0]], [[0.0; 2]; 2], 2);
    let with = |knee: f64, rate: f64| {
        let mut state = standing.clone();
        // Makes the right leg as long as the left one, to 2e-5 m.
        let long = 0.4 * (0.35_f64.cos() + 0.25_f64.cos());
        let hip = (long / 0.8).acos();
        state["position"]["joints"]["right_hip"] = json!(hip - 0.05);
        state["position"]["joints"]["right_knee"] = json!(-2.0 * hip + knee);
        state["position"]["joints"]["right_ankle"] = json!(hip - knee);
        state["velocity"] = json!({"base": {"pitch": rate}, "joints": {"left_hip": 1.234_567_891_234e-9 - rate, "right_hip": 1.234_567_891_234e-9 - rate}});
        state["place"] = json!("lowest");
        impact(&robot, state)
    };
    let noted = |found: &Impact, what: &str| found.notes.iter().any(|note| note.contains(what));
    let open = with(1e-4, 0.0);
    assert!(noted(&open, "_foot nearly touches, "), "{:?}", open.notes);
    let noisy = with(0.0, 0.5);
    assert!(noted(&noisy, "_foot/0 moves at ") && noted(&noisy, "if it stands"), "{:?}", noisy.notes);
}

/// Two legs whose hips differ in height by rounding, as exporters write them.
#[test]
fn feet_at_nearly_the_same_place_are_noted() {
    let leg = |side: &str, height: f64| {
        let foot = urdf::collision([0.02, -0.5], urdf::POINT);
        let hip = urdf::joint(format!("{side}_hip"), HINGE, ["torso", side], [0.0, height], "");
        urdf::link(side, 1.0, [0.01, -0.2], 0.05, &foot) + &hip
    };
    let found = |height: f64| {
        let torso = urdf::link("torso", 5.0, [0.03, 0.1], 0.2, "");
        let robot = robot(&urdf::robot(&[torso, leg("left", -0.002_617_400_551_670_56), leg("right", height)]));
        let state = json!({"place": "lowest", "friction": 0.5, "position": {"base": {"pitch": 0.1}},
            "velocity": {"base": {"x": 0.3, "z": -1, "pitch": 0.2}}});
        impact(&robot, state)
    };
    let heights = [-0.002_617_400_551_670_56, -0.002_617_400_551_670_58, -0.002_617_4, -0.002_617];
    let expected = [
        None,
        Some("left and right are at the same place except for last digits; the outcome may depend on those digits"),
        Some("left and right are 5.5e-10 m apart; the outcome may depend on this distance"),
        Some("left and right are 4.0e-7 m apart; the outcome may depend on this distance"),
    ];
    for (height, expected) in heights.into_iter().zip(expected) {
        let found = found(height);
        let note = found.notes.iter().find(|note| note.contains("the outcome may depend on"));
        let is_right = match (note, expected) {
            (Some(note), Some(expected)) => note.starts_with(expected),
            (note, expected) => note.is_none() && expected.is_none(),
        };
        assert!(found.contacts.len() == 2 && is_right, "{height}: {:?}", found.notes);
    }
}

#[test]
fn a_slide_that_strikes_by_rounding_is_noted() {
    let block = robot(&urdf::body(0.5, &urdf::collision([0.3, -0.4], urdf::POINT)));
    let noted = |rate: f64| {
        let state = json!({"friction": 0.5, "position": {"base": {"pitch": 0.3}}, "place": "lowest",
            "velocity": {"base": {"x": 1.0, "z": rate, "pitch": 0.7}}});
        let found = impact(&block, state);
        let [_, normal] = found.velocity_before[0];
        (normal, found.notes.iter().any(|note| note.contains("rounding decides whether it strikes")))
    };
    let (carried, _) = noted(0.0);
    // Changes z by units in the last place of the velocity that the turn gives the foot.
    let beside = (1..9).map(|units| noted(-carried * (1.0 + f64::from(units) * f64::EPSILON)));
    let (own, is_noted) = beside.into_iter().find(|(own, _)| *own != 0.0).expect("more than rounding");
    assert!(own.abs() < 1e-15 && is_noted, "{own}");
    assert!(!noted(1e-3 - carried).1);
    // The velocity is zero in f64, but not in exact numbers.
    assert_eq!(noted(-carried), (0.0, true));
}
