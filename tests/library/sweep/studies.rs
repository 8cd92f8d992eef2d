//! Random studies: robots of this repository, with poses and velocities that are linear in the parameter, all kinds of
//! friction, and variations of the robots.

use crate::support::random::Random;
use crate::support::subject::Subject;
use heelstrike::pipeline::Options;
use heelstrike::sweep::{RobotStudy, Study};
use serde_json::{Value, json};

/// The planar robots of this repository without loops.
pub fn subjects() -> Vec<Subject> {
    let files = [
        ("minimalistic", include_str!("../../../urdf/minimalistic.urdf")),
        ("pdw", include_str!("../../../urdf/pdw.urdf")),
        ("ramone", include_str!("../../../urdf/ramone.urdf")),
        ("ramone_paper", include_str!("../../../urdf/ramone_paper.urdf")),
        ("block", include_str!("../../../urdf/block.urdf")),
        ("rabbit", include_str!("../../data/robots/rabbit/five_link_walker.urdf")),
        ("walker with torso", include_str!("../../data/robots/planar_walker_torso/PlanarWalkerWithTorso.urdf")),
        ("acrobot", include_str!("../../data/robots/acrobot/Acrobot.urdf")),
        ("cartpole", include_str!("../../data/robots/cartpole/cartpole.urdf")),
    ];
    files.into_iter().map(|(name, text)| Subject::new(name, text)).collect()
}

/// Calls `ask` with the model of a study; combinations are explained for up to `explain_up_to` contacts.
pub fn with<T>(urdf: &str, study: &Value, explain_up_to: usize, ask: impl FnOnce(&RobotStudy) -> T) -> T {
    let (subject, text) = (Subject::new("", urdf), study.to_string());
    let study = Study::from_json(&text).expect("a study");
    ask(&RobotStudy { options: Options { explain_up_to, ..Options::default() }, ..subject.model(&study) })
}

/// A constant, or a linear function of the parameter p.
fn linear(random: &mut Random, size: f64) -> Value {
    let constant = random.between(-size, size);
    match random.once_in(3) {
        true => json!(constant),
        false => json!(format!("{constant} + {}*p", random.between(-size, size))),
    }
}

/// A linear function of the parameter p that is positive and near `value` for p from -1 to 1.
fn near(random: &mut Random, value: f64) -> Value {
    json!(format!("{}*(1 + {}*p)", value.max(0.01), random.between(-0.8, 0.8)))
}

fn friction(random: &mut Random) -> Value {
    match random.whole(0, 5) {
        0 => json!(0),
        1 | 2 => json!(random.between(0.05, 2.0)),
        3 => json!(format!("0.7 + {}*p", random.between(-0.6, 0.6))),
        _ => json!("infinite"),
    }
}

/// A random study with this many samples.
pub fn study(subject: &Subject, random: &mut Random, steps: usize) -> Value {
    let robot = &subject.robot;
    let links: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
    let shaped = robot.links().iter().filter(|link| !link.shapes.is_empty()).map(|link| link.name.as_str());
    let shaped: Vec<&str> = shaped.collect();
    let floats = robot.base_dofs() == 3;
    let standing = floats && !shaped.is_empty() && !random.once_in(4);

    let mut state = json!({});
    for (name, size) in [("position", 1.2), ("velocity", 2.0)] {
        let joints = robot.joints().iter().map(|joint| (joint.name.clone(), linear(random, size)));
        state[name]["joints"] = joints.collect();
        let base = if standing { &["pitch"][..] } else { &["pitch", "x", "z"] };
        for coordinate in base.iter().filter(|_| floats) {
            state[name]["base"][coordinate] = linear(random, size);
        }
    }
    if standing {
        state["stance"] = json!(random.pick(&shaped));
    }
    if !standing || random.once_in(2) {
        let mut places: Vec<&str> = if standing { shaped } else { links.clone() };
        if standing {
            // The stance needs a contact of its own.
            places.retain(|link| state["stance"] == **link || random.once_in(2));
        }
        let order = random.permutation(places.len());
        let count = if standing { places.len() } else { random.whole(1, 3) as usize };
        let contacts = order.into_iter().take(count).map(|at| {
            let offset = [linear(random, 0.5), json!(0), linear(random, 0.5)];
            let radius = random.pick(&[json!(0), json!(0.05), json!("0.1+0.05*p")]);
            json!({"link": places[at], "offset": offset, "radius": radius})
        });
        state["contacts"] = contacts.collect();
    }
    state["friction"] = if random.once_in(3) {
        let mut by_link = json!({"default": friction(random)});
        by_link[random.pick(&links)] = friction(random);
        by_link
    } else {
        friction(random)
    };
    if random.once_in(5) {
        state["restitution"] = random.pick(&[json!(0.5), json!("0.5+0.4*p")]);
    }
    if random.once_in(5) {
        state["ground"] = json!({"slope": linear(random, 0.3)});
    }
    let mut study = json!({"parameters": {"p": {"from": -1, "to": 1, "steps": steps}}, "state": state});
    if random.once_in(3) {
        study["robot"] = variation(subject, random);
    }
    study
}

/// A random variation of the robot: numbers of a link that has mass, and the place of a joint.
fn variation(subject: &Subject, random: &mut Random) -> Value {
    let massive: Vec<_> = subject.description.links.iter().filter(|link| link.inertial.is_some()).collect();
    let link = random.pick(&massive);
    let mut fields = json!({});
    if random.once_in(2) {
        fields["mass"] = near(random, link.inertial.as_ref().map_or(0.0, |inertial| inertial.mass));
    }
    if random.once_in(2) {
        fields["com"] = json!([linear(random, 0.3), 0, linear(random, 0.3)]);
    }
    if fields == json!({}) || random.once_in(2) {
        fields["inertia"] = near(random, 0.2);
    }
    let mut robot = json!({"links": {link.name.clone(): fields}});
    let moving: Vec<&str> = subject.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    if random.once_in(2) && !moving.is_empty() {
        robot["joints"] = json!({random.pick(&moving): {"origin": [linear(random, 0.3), 0, linear(random, 0.3)]}});
    }
    robot
}
