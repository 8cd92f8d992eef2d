//! Random states with uncertainties, mostly of RAMone on both feet, and states of their boxes.

use crate::support::impact;
use crate::support::random::Random;
use heelstrike::Robot;
use heelstrike::impact::{Friction, Mode};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::{Defaults, State};
use serde_json::{Value, json};

pub fn answer(robot: &Robot, state: &State) -> Box<Impact> {
    Pipeline::new(robot, Options::default()).impact(state).expect("an answer")
}

fn read(robot: &Robot, state: &Value) -> State {
    State::from_json(&state.to_string(), robot, &Defaults::default()).expect("a good state")
}

/// The feet of RAMone.
fn feet() -> Value {
    ["left_foot", "right_foot"].map(|link| json!({"link": link, "radius": 0.02815})).into_iter().collect()
}

fn joints(robot: &Robot, random: &mut Random, size: f64) -> Value {
    robot.joints().iter().map(|joint| (joint.name.clone(), json!(random.between(-size, size)))).collect()
}

/// Both feet on the ground, in any configuration, with any velocities of order one and friction from 0.2 to 1.5, all
/// half-widths `width`.
pub fn on_both_feet(robot: &Robot, random: &mut Random, width: f64) -> State {
    let state = json!({
        "position": {"base": {"z": 0.4, "pitch": random.between(-0.5, 0.5)}, "joints": joints(robot, random, 1.5)},
        "velocity": {"base": {"x": random.between(-1.0, 1.0), "z": random.between(-1.0, 1.0),
            "pitch": random.between(-2.0, 2.0)}, "joints": joints(robot, random, 3.0)},
        "friction": random.between(0.2, 1.5),
        "contacts": feet(),
        "uncertainty": {"position": width, "velocity": width, "friction": width},
    });
    read(robot, &state)
}

/// One foot stands on a slope while the other strikes, with most other fields of a state.
pub fn walking(robot: &Robot, random: &mut Random) -> State {
    let (positions, rates) = (joints(robot, random, 1.2), joints(robot, random, 2.0));
    let held: &[&str] = if random.once_in(2) { &["left_knee"] } else { &[] };
    let state = json!({
        "position": {"base": {"pitch": random.between(-0.5, 0.5)}, "joints": positions},
        "velocity": {"base": {"pitch": random.between(-2.0, 2.0)}, "joints": rates},
        "stance": "left_foot",
        "ground": {"slope": random.between(-0.3, 0.3)},
        "held": held,
        "rotor_inertia": {"right_knee": 0.01},
        "friction": {"default": random.between(0.2, 1.5), "right_foot": random.pick(&[json!("infinite"), json!(0.7), json!(0)])},
        "restitution": {"left_foot": 0, "right_foot": random.pick(&[0.0, 0.5])},
        "contacts": feet(),
        "uncertainty": {
            "position": {"base": {"pitch": 1e-3}, "joints": {"left_hip": 2e-3, "right_knee": 1e-3, "left_knee": 1e-3}},
            "velocity": 1e-3,
            "friction": {"default": 1e-2},
            "rotor_inertia": 1e-3,
        },
    });
    read(robot, &state)
}

/// RAMone whose right knee mimics the left one.
pub fn with_coupled_knees() -> Robot {
    let urdf = include_str!("../../../urdf/ramone.urdf");
    let knee = urdf.find(r#"<joint name="right_knee""#).expect("a right knee");
    let end = knee + urdf[knee..].find("</joint>").expect("its end");
    let mimic = r#"<mimic joint="left_knee" multiplier="-0.7" offset="0.2"/>"#;
    impact::robot(&[&urdf[..end], mimic, &urdf[end..]].concat())
}

/// Both feet on the ground, and a rotor at the mimic joint.
pub fn on_coupled_knees(robot: &Robot, random: &mut Random) -> State {
    let mut state = on_both_feet(robot, random, 1e-3);
    state.scene.rotor_inertia = vec![0.0, 0.0, 0.0, 0.02];
    state.uncertainty.as_mut().expect("an uncertain state").rotor_inertia = vec![0.0, 0.0, 0.0, 1e-3];
    state
}

/// The five-bar leg with contacts at its pin and at a point of its torso, any motion that keeps it closed, and an
/// impulse on its torso.
pub fn five_bar(robot: &Robot, random: &mut Random) -> State {
    let mut state: Value = serde_json::from_str(include_str!("../../../examples/five_bar.json")).expect("an example");
    state["position"]["base"]["pitch"] = json!(random.between(-0.5, 0.5));
    state["velocity"]["base"] =
        json!({"x": random.between(-1.0, 1.0), "z": random.between(-1.0, 1.0), "pitch": random.between(-2.0, 2.0)});
    state["friction"] = json!(random.between(0.2, 1.5));
    state["contacts"] =
        json!([{"link": "left_shank", "offset": [0, 0, -0.5]}, {"link": "torso", "offset": [0.3, 0, -0.6]}]);
    state["impulse"] = json!([{"link": "torso", "vector": [random.between(-0.1, 0.1), random.between(-0.1, 0.1)]}]);
    state["uncertainty"] = json!({"position": {"base": {"pitch": 1e-3}}, "velocity": {"base": {"x": 1e-3, "pitch": 1e-3}},
        "friction": 1e-2});
    read(robot, &state)
}

/// The lists of modes of a proven answer, sorted.
pub fn modes(found: &Impact) -> Vec<Vec<Mode>> {
    assert!(found.analysis.as_ref().expect("outcomes").proven);
    let mut modes = impact::modes(found);
    modes.sort();
    modes
}

/// A state of the box; `place` gives the place in each interval, from -1 to 1.
pub fn in_the_box(robot: &Robot, state: &State, mut place: impl FnMut() -> f64) -> State {
    let mut other = state.clone();
    let known = other.uncertainty.take().expect("an uncertain state");
    let placed = state.scene.stance.is_some();
    for (coordinate, (position, width)) in other.position.iter_mut().zip(&known.position).enumerate() {
        // x and z of the base stay, so that detected contacts keep touching.
        if coordinate >= robot.base_dofs().min(2) {
            *position += width * place();
        }
    }
    for (coordinate, (velocity, width)) in other.velocity.iter_mut().zip(&known.velocity).enumerate() {
        if !(placed && coordinate < 2) {
            *velocity += width * place();
        }
    }
    let links: Vec<usize> = other.scene.contacts.iter().flatten().map(|contact| contact.link).collect();
    for link in links {
        if let Some(Friction::Finite(mu)) = other.scene.friction.of(link) {
            let moved = Friction::Finite((mu + known.friction.of(link).unwrap_or(0.0) * place()).max(0.0));
            other.scene.friction.links.insert(link, moved);
        }
    }
    for (joint, width) in known.rotor_inertia.iter().enumerate().filter(|(_, width)| **width > 0.0) {
        other.scene.rotor_inertia.resize(robot.joints().len() + robot.mimic_joints().len(), 0.0);
        other.scene.rotor_inertia[joint] = (other.scene.rotor_inertia[joint] + width * place()).max(0.0);
    }
    other
}

/// Asserts that the other state is in the box of the first one, up to a rounding of its ends.
pub fn assert_in_the_box(state: &State, other: &State) {
    let known = state.uncertainty.as_ref().expect("an uncertain state");
    let within = |a: &[f64], b: &[f64], widths: &[f64]| {
        a.iter().zip(b).zip(widths).all(|((a, b), width)| (a - b).abs() <= width + f64::EPSILON * (a.abs() + width))
    };
    assert!(within(&state.position, &other.position, &known.position));
    assert!(within(&state.velocity, &other.velocity, &known.velocity));
    let rotors = |state: &State| {
        let joints = known.rotor_inertia.len();
        state.scene.rotor_inertia.iter().copied().chain(std::iter::repeat(0.0)).take(joints).collect::<Vec<f64>>()
    };
    assert!(within(&rotors(state), &rotors(other), &known.rotor_inertia));
    for contact in other.scene.contacts.iter().flatten() {
        let width = known.friction.of(contact.link).unwrap_or(0.0);
        match (state.scene.friction.of(contact.link), other.scene.friction.of(contact.link)) {
            (Some(Friction::Finite(a)), Some(Friction::Finite(b))) => assert!(within(&[a], &[b], &[width]) && b >= 0.0),
            (one, other) => assert_eq!(one, other),
        }
    }
}
