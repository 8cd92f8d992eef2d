//! Cases whose box is worked out on paper.

use crate::uncertainty::states::{impact, ramone, read};
use heelstrike::impact::{Friction, Mode, Verdict};
use heelstrike::pipeline::robust::{Counterexample, Robustness};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::{Robot, state::State};
use serde_json::{Value, json};

/// A ball of 2 kg, 1 kg m^2 and radius 0.5 m: 1/G_tt = 4/3 kg, 1/G_nn = 2 kg.
fn ball() -> Robot {
    let urdf = r#"<robot name="ball"><link name="ball">
        <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <collision><geometry><sphere radius="0.5"/></geometry></collision>
    </link></robot>"#;
    Robot::from_urdf(urdf).expect("a good robot")
}

/// The ball falls at 1 m/s and goes at `speed`, which needs a friction of `speed` / 1.5.
fn falling(robot: &Robot, speed: f64, friction: f64, uncertainty: Value) -> State {
    let state = json!({"position": {"base": {"z": 0.5}}, "velocity": {"base": {"x": speed, "z": -1.0}},
        "friction": friction, "uncertainty": uncertainty});
    read(robot, &state).expect("a good state")
}

fn holds(impact: &Impact) -> Option<bool> {
    match impact.holds.as_ref().expect("the state is uncertain") {
        Robustness::Everywhere => Some(true),
        Robustness::Not(_) => Some(false),
        Robustness::Unknown => None,
    }
}

fn counterexample(impact: &Impact) -> &Counterexample {
    match &impact.holds {
        Some(Robustness::Not(found)) => found,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_ball_sticks_as_far_as_its_friction_reaches() {
    let robot = ball();
    let of = |width: f64| impact(&robot, &falling(&robot, 0.6, 0.5, json!({"friction": width})));
    // 0.4 is needed.
    assert_eq!(
        [0.0, 0.05, 0.099, 0.101, 0.3].map(|width| holds(&of(width))),
        [true, true, true, false, false].map(Some)
    );
    let other = of(0.101);
    let found = counterexample(&other);
    assert_eq!((found.verdict, &found.outcomes[..]), (Verdict::Unique, &[vec![Mode::SlidePlus]][..]));
    let Some(Friction::Finite(mu)) = found.state.scene.friction.of(0) else { panic!("finite friction") };
    assert!((0.5 - 0.101..0.4).contains(&mu), "{mu}");
}

#[test]
fn widths_of_the_base_s_place_do_nothing_and_those_of_its_velocity_do() {
    let robot = ball();
    let of = |uncertainty| holds(&impact(&robot, &falling(&robot, 0.6, 0.5, uncertainty)));
    assert_eq!(of(json!({"position": {"base": {"x": 1e9, "z": 1e9}}})), Some(true));
    // It slides from 0.75 m/s on, and leaves the ground from 0 m/s on.
    assert_eq!(of(json!({"velocity": {"base": {"x": 0.14}}})), Some(true));
    assert_eq!(of(json!({"velocity": {"base": {"x": 0.16}}})), Some(false));
    assert_eq!(of(json!({"velocity": {"base": {"z": 0.1}}})), Some(true));
    assert_eq!(of(json!({"velocity": 1.0})), Some(false));
}

#[test]
fn friction_ends_at_zero() {
    let robot = ball();
    let of = |friction: f64| holds(&impact(&robot, &falling(&robot, 0.6, friction, json!({"friction": 0.1}))));
    // A slide stays one down to no friction at all.
    assert_eq!([0.0, 0.05, 0.25, 0.35].map(of), [true, true, true, false].map(Some));
}

#[test]
fn no_number_is_uncertain_where_friction_is_infinite() {
    let robot = ball();
    let state = json!({"position": {"base": {"z": 0.5}}, "velocity": {"base": {"x": 0.6, "z": -1.0}},
        "friction": "infinite", "uncertainty": {"friction": 100.0}});
    assert_eq!(holds(&impact(&robot, &read(&robot, &state).expect("a good state"))), Some(true));
}

#[test]
fn a_foot_at_rest_rests_on_the_whole_box() {
    let robot = ramone();
    let state = json!({"stance": "left_foot", "friction": 0.8, "position": {"joints": {"left_hip": 0.3, "left_knee": -0.4,
        "right_knee": -1.5}}, "velocity": {"base": {"pitch": 0.2}},
        "uncertainty": {"position": 1e-2, "velocity": 1e-2, "friction": 1e-2, "rotor_inertia": 1e-3}});
    let answer = impact(&robot, &read(&robot, &state).expect("a good state"));
    assert_eq!(answer.analysis.as_ref().map(|analysis| analysis.verdict), Some(Verdict::NoImpact));
    assert_eq!(holds(&answer), Some(true));
}

#[test]
fn without_contact_everything_holds() {
    let robot = ball();
    let state = json!({"position": {"base": {"z": 1.0}}, "friction": 0.8, "uncertainty": {"velocity": 5.0}});
    assert_eq!(holds(&impact(&robot, &read(&robot, &state).expect("a good state"))), Some(true));
}

#[test]
fn dependent_contacts_and_unproven_answers_stay_unknown() {
    let robot = ramone();
    // Both contacts are at one place.
    let twice = json!([{"link": "left_foot"}, {"link": "left_foot"}]);
    let state = json!({"velocity": {"base": {"z": -1.0}}, "friction": 0.8, "contacts": twice,
        "uncertainty": {"position": 1e-6}});
    assert_eq!(holds(&impact(&robot, &read(&robot, &state).expect("a good state"))), None);
    let state = falling(&ball(), 0.6, 0.5, json!({"friction": 0.01}));
    let unproven = Options { no_proof: true, ..Options::default() };
    assert_eq!(holds(&Pipeline::new(&ball(), unproven).impact(&state).expect("an answer")), None);
}

#[test]
fn many_uncertain_numbers_are_taken_together() {
    // A body with 24 arms has 76 of them, more than any affine number has slopes.
    let link = |k: usize| {
        format!(
            "<link name=\"l{k}\"><inertial><origin xyz=\"0 0 -0.05\"/><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" \
             ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial></link>"
        )
    };
    let joint = |k: usize| {
        format!(
            "<joint name=\"j{k}\" type=\"continuous\"><parent link=\"l0\"/><child link=\"l{k}\"/>\
             <axis xyz=\"0 1 0\"/><origin xyz=\"0 0 -0.1\"/></joint>"
        )
    };
    let urdf: String = (0..25).map(link).chain((1..25).map(joint)).collect();
    let robot = Robot::from_urdf(&format!("<robot name=\"star\">{urdf}</robot>")).expect("a good robot");
    let state = json!({"position": {"base": {"pitch": 0.5}}, "velocity": {"base": {"z": -1.0}}, "friction": "infinite",
        "contacts": [{"link": "l0", "offset": [0, 0, -0.1]}],
        "uncertainty": {"position": 1e-4, "velocity": 1e-4, "rotor_inertia": 1e-4}});
    assert_eq!(holds(&impact(&robot, &read(&robot, &state).expect("a good state"))), Some(true));
}
