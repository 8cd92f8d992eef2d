//! Forces just after an impact.

use crate::support::impact::{modes, ramone, robot, try_impact};
use crate::support::random::Random;
use crate::support::urdf::{self, HINGE, collision, joint, link};
use heelstrike::impact::{Next, Verdict};
use heelstrike::law::Mode::{self, Separate, SlidePlus, Stick};
use heelstrike::{Defaults, Impact, Options, Pipeline, Robot, State};
use serde_json::{Value, json};
use std::fmt::Display;

fn disc() -> Robot {
    robot(&urdf::body(0.1, &collision([0.0; 2], "sphere radius=\"0.5\"")))
}

/// The forces of a state with this `resting_speed`.
fn forces(robot: &Robot, state: &Value, resting_speed: Option<f64>) -> Box<Impact> {
    let state = State::from_json(&state.to_string(), robot, &Defaults::default()).unwrap();
    Pipeline::new(robot, Options { resting_speed, ..Options::default() }).forces(&state).unwrap()
}

/// The modes of the contacts that still touch.
fn kept(next: &Next) -> Vec<Vec<Mode>> {
    next.modes.iter().map(|own| own.iter().copied().flatten().collect()).collect()
}

fn nexts(robot: &Robot, state: impl Display) -> Vec<Next> {
    let found = try_impact(robot, Options { next: true, ..Options::default() }, &state);
    let outcomes = found.unwrap_or_else(|error| panic!("{error}\n{state}")).into_analysis().unwrap().outcomes;
    outcomes.into_iter().filter_map(|outcome| outcome.next).collect()
}

/// A disc that has fallen sticks under its weight, slides on after a push, or is in the air after a bounce.
#[test]
fn disc_rests_slides_or_bounces() {
    let disc = disc();
    let after = |change: Value, impulse: Value| {
        let mut state =
            json!({"position": {"base": {"z": 0.5}}, "velocity": {"base": {"z": -1.0}}, "impulse": impulse});
        state.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        nexts(&disc, state).into_iter().map(|next| (next.verdict, next.proven, next.modes)).collect::<Vec<_>>()
    };
    let none = json!([]);
    let expected = |verdict, modes: Option<Mode>| vec![(verdict, true, vec![vec![modes]])];
    assert_eq!(after(json!({}), none.clone()), expected(Verdict::Unique, Some(Stick)));
    assert_eq!(after(json!({"gravity": -1.0}), none.clone()), expected(Verdict::Unique, Some(Separate)));
    assert_eq!(after(json!({"restitution": 0.5}), none), expected(Verdict::NoContact, None));
    // Pushed along the ground so hard that friction does not stop it.
    let push = json!([{"link": "body", "offset": [0, 0, 0], "vector": [40, 0]}]);
    assert_eq!(after(json!({}), push), expected(Verdict::Unique, Some(SlidePlus)));
}

/// A point slides while its body turns about it; its normal velocity is what rounding leaves of 0.1 - 0.1.
#[test]
fn what_rounding_leaves_does_not_bounce() {
    let disc = disc();
    let turning = |restitution: f64| {
        let rate = 1.0_f64.next_up();
        json!({
            "position": {"base": {"z": 0.4}}, "velocity": {"base": {"x": -1, "z": 0.1, "pitch": rate}},
            "contacts": [{"link": "body", "offset": [0.1, 0, -0.4]}], "friction": 0.5, "restitution": restitution,
        })
    };
    let found = nexts(&disc, turning(0.5));
    assert_eq!(found[0].modes, [[Some(Mode::SlideMinus)]]);
    assert_eq!(found, nexts(&disc, turning(0.0)));
}

/// Loops, an uncertainty and a brief answer do not change `next`, and `next` does not change the rest of the answer.
#[test]
fn next_stands_next_to_all_else() {
    let [ramone, bar] = [include_str!("../../../urdf/ramone.urdf"), include_str!("../../../urdf/five_bar.urdf")];
    let states =
        [include_str!("../../../examples/ramone_measured.json"), include_str!("../../../examples/five_bar.json")];
    for (urdf, state) in [ramone, bar].into_iter().zip(states) {
        let robot = robot(urdf);
        let [plain, next, brief] = [(false, false), (true, false), (true, true)].map(|(next, brief)| {
            try_impact(&robot, Options { next, brief, matrices: true, ..Options::default() }, state).unwrap()
        });
        let outcomes = |impact: &heelstrike::Impact| impact.analysis.as_ref().unwrap().outcomes.clone();
        let mut without = outcomes(&next);
        let found: Vec<Next> = without.iter_mut().filter_map(|own| own.next.take()).collect();
        assert_eq!((without, &next.matrices), (outcomes(&plain), &plain.matrices));
        assert_eq!(format!("{:?}", next.holds), format!("{:?}", plain.holds));
        assert_eq!(found, outcomes(&brief).into_iter().filter_map(|own| own.next).collect::<Vec<_>>());
        assert!(!found.is_empty() && found.iter().all(|own| own.verdict == Verdict::Unique), "{found:?}");
    }
}

/// `next` equals the forces of a state with the velocities after the impact.
#[test]
fn next_is_forces_at_the_velocities_after() {
    let walker = robot(include_str!("../../../urdf/minimalistic.urdf"));
    let (mut random, mut verdicts) = (Random::new(11), [0; 3]);
    for case in 0..300 {
        let mut between = |low: f64, high: f64| random.between(low, high);
        let (pitch, both) = (between(-1.3, 1.3), case % 3 > 0);
        let hip = if both { 2.0 * pitch } else { between(-1.0, 1.0) };
        let state = json!({
            "position": {"base": {"pitch": pitch}, "joints": {"hip": hip}},
            "velocity": {"base": {"x": between(-1.0, 1.0), "z": between(-2.0, 0.0), "pitch": between(-2.0, 2.0)},
                         "joints": {"hip": between(-2.0, 2.0)}},
            "friction": if case % 4 == 0 { json!("infinite") } else { json!(between(0.0, 3.0)) },
            "restitution": if case % 5 == 0 { 0.4 } else { 0.0 },
            "place": "lowest",
            "torque": {"hip": between(-5.0, 5.0)},
        });
        let state = State::from_json(&state.to_string(), &walker, &Defaults::default()).unwrap();
        let found = Pipeline::new(&walker, Options { next: true, ..Options::default() }).impact(&state).unwrap();
        for outcome in &found.analysis.as_ref().unwrap().outcomes {
            let next = outcome.next.as_ref().unwrap();
            let velocity = outcome.velocity().collect();
            let after = State { velocity, position: state.position.clone(), ..state.clone() };
            let options = Options { resting_speed: Some(1e-9), ..Options::default() };
            let forces = Pipeline::new(&walker, options).forces(&after).unwrap();
            let analysis = forces.analysis.as_ref().unwrap();
            assert_eq!(
                (next.verdict, next.proven, kept(next)),
                (analysis.verdict, true, modes(&forces)),
                "{outcome:?}"
            );
            verdicts[next.modes.len().min(2)] += 1;
        }
    }
    assert!(verdicts.iter().all(|&count| count > 2), "{verdicts:?}");
}

/// Rounding leaves the robot a pitch rate of 1e-16 rad/s, with which the feet of braked legs do not move relative to
/// each other.
#[test]
fn held_legs_stand_on_both_feet_after_an_impact() {
    let ramone = ramone();
    for (x, friction) in [0.0, 0.02, 0.05].into_iter().flat_map(|x| [(x, json!(0.8)), (x, json!("infinite"))]) {
        let state = json!({
            "position": {"joints": {"left_hip": 0.4, "left_knee": -0.3, "right_hip": -0.4, "right_knee": 0.3}},
            "velocity": {"base": {"x": x, "z": -0.5}}, "place": "lowest", "friction": friction,
            "held": ["left_hip", "left_knee", "right_hip", "right_knee"],
        });
        let found = nexts(&ramone, state);
        let [Next { verdict: Verdict::Unique, proven: true, modes, .. }] = &found[..] else { panic!("{found:?}") };
        assert_eq!(modes, &[[Some(Stick); 2]], "{x} {friction}");
    }
}

/// An arm that is bolted to the world has more contact rows than joints. It stands with rates of 1e-16 rad/s, or of
/// 1e-13 rad/s if its impulse is not unique.
#[test]
fn what_an_impact_stops_stands_as_it_would_without_rates() {
    let links = "<link name=\"world\"/>".to_owned() + &link("l", 1.0, [0.15, -0.2], 0.01, "");
    let arm = robot(&urdf::robot(&[links, joint("j", HINGE, ["world", "l"], [0.0; 2], "")]));
    let mut random = Random::new(3);
    let mut stands = 0;
    for case in 0..200 {
        let mut between = |low: f64, high: f64| random.between(low, high);
        let friction = if case % 3 == 0 { json!("infinite") } else { json!(between(0.1, 3.0)) };
        let mut state = json!({
            "position": {"joints": {"j": between(-3.0, 3.0)}}, "velocity": {"joints": {"j": between(-1.0, 1.0)}},
            "contacts": [{"link": "l", "offset": [between(-0.5, 0.5), 0, between(-0.5, 0.5)]}],
            "friction": if case % 7 == 0 { json!(0) } else { friction }, "torque": {"j": between(-5.0, 5.0)},
        });
        let outcomes = try_impact(&arm, Options { next: true, ..Options::default() }, &state).unwrap();
        for outcome in outcomes.into_analysis().unwrap().outcomes.iter().filter(|own| own.modes == [Stick]) {
            state["velocity"] = json!({});
            let next = outcome.next.as_ref().unwrap();
            assert_eq!((next.proven, kept(next)), (true, modes(&forces(&arm, &state, None))), "{state}");
            stands += usize::from(next.verdict == Verdict::Unique);
        }
    }
    assert!(stands > 10, "{stands}");
}

/// A robot on both feet of braked legs, with rates that are noise below the resting speed.
#[test]
fn rates_below_the_resting_speed_are_zero_where_a_robot_stands() {
    let ramone = ramone();
    let joints = json!({"left_hip": 0.4, "left_knee": -0.3, "right_hip": -0.4, "right_knee": 0.3});
    let forces = |velocity: Value, resting_speed: Option<f64>| {
        let state = json!({
            "position": {"joints": joints}, "velocity": velocity, "place": "lowest", "friction": "infinite",
            "held": ["left_hip", "left_knee", "right_hip", "right_knee"],
        });
        forces(&ramone, &state, resting_speed)
    };
    let noise = json!({"base": {"x": 1.3e-17, "z": -2.1e-17, "pitch": 5e-17}});
    let found = forces(noise, Some(1e-6));
    assert_eq!(modes(&found), [[Stick; 2]]);
    assert_eq!(modes(&forces(json!({}), None)), modes(&found));
    assert!(found.notes.iter().any(|note| note == "all rates are taken as zero (resting speed 0.000001 m/s)"));
    // A joint that moves is not noise; no rate is then taken as zero.
    let moving = forces(json!({"base": {"pitch": 5e-17}, "joints": {"left_hip": 0.1}}), Some(1e-6));
    assert!(!moving.notes.iter().any(|note| note.starts_with("all rates")), "{:?}", moving.notes);
}
