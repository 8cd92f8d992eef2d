//! RAMone, a biped with a floating base: at rest on two feet, on one, and under virtual springs that bear it.

use heelstrike::impact::{Mode, Outcome, Verdict};
use heelstrike::{Defaults, Impact, Options, Pipeline, Robot, State};
use serde_json::{Value, json};
use std::error::Error;

const GRAVITY: f64 = 9.81;
/// Stiffness of the virtual spring that bears the torso \[N/m\].
const STIFFNESS: f64 = 800.0;

/// A claim in words, and whether it holds.
pub type Claim = (String, bool);

/// Checks the lecture's claims about its biped.
pub fn claims() -> Result<Vec<Claim>, Box<dyn Error>> {
    let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf"))?;
    let weight = GRAVITY * robot.bodies().iter().map(|body| body.mass).sum::<f64>();
    let standing: Value = serde_json::from_str(include_str!("../ramone_stands.json"))?;
    let forces = |state: &Value| -> Result<Box<Impact>, Box<dyn Error>> {
        let state = State::from_json(&state.to_string(), &robot, &Defaults::default())?;
        Ok(Pipeline::new(&robot, Options::default()).forces(&state)?)
    };
    let normal = |outcome: &Outcome| outcome.impulse.iter().map(|force| force[1]).sum::<f64>();
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-11 * weight;
    let mut claims = Vec::new();

    // With held joints the two contacts constrain three coordinates by four rows.
    let stands = forces(&standing)?;
    let unique = only(&stands).filter(|own| own.modes == [Mode::Stick; 2] && own.proven);
    claims.push((
        "two feet, joints held: both stick, the forces along the ground are redundant, the others bear the weight"
            .into(),
        unique.is_some_and(|own| !own.impulse_unique && near(normal(own), weight)),
    ));

    let mut lifted = standing.clone();
    lifted["position"]["joints"]["right_knee"] = json!(1.2);
    let found = forces(&lifted)?;
    let falls = only(&found).filter(|own| own.modes == [Mode::Stick] && own.proven && own.impulse_unique);
    claims.push((
        "one foot open: the other sticks alone, and bears less than the weight while the robot tips".into(),
        falls.is_some_and(|own| normal(own) > 0.0 && normal(own) < weight),
    ));

    // The normal forces on both feet follow from the lever rule.
    let weights = robot.bodies().iter().enumerate();
    let moment: f64 = weights.map(|(at, own)| GRAVITY * own.mass * stands.placement.world(at, own.com).x).sum();
    let [left, right] = [0, 1].map(|foot| stands.contacts[foot].point.x);
    let on_right = (moment - weight * left) / (right - left);
    let pressed = [weight - on_right, on_right];
    let mut springs = Vec::new();
    for link in robot.links().iter().filter(|link| link.has_inertial) {
        let body = &robot.bodies()[link.body];
        let (force, at) = (GRAVITY * body.mass, stands.placement.world(link.body, body.com));
        let mut spring = json!({"a": {"link": link.name, "offset": link.offset(body.com)}, "b": {"world": at}});
        if link.name == "torso" {
            // A spring from the torso's place, and one that keeps it upright.
            spring["stiffness"] = json!([STIFFNESS, STIFFNESS]);
            spring["target"] = json!([0.0, force / STIFFNESS]);
            spring["damping"] = json!([40.0, 40.0]);
            spring["pitch"] = json!({"stiffness": 50, "damping": 5, "target": 0});
        } else {
            spring["force"] = json!([0.0, force]);
        }
        springs.push(spring);
    }
    for (contact, force) in stands.contacts.iter().zip(pressed) {
        let foot = &robot.links()[contact.link].name;
        springs.push(json!({"a": {"link": foot}, "b": {"world": [0, 0]}, "force": [0.0, -force]}));
    }
    let mut carried = standing.clone();
    carried["held"] = json!([]);
    let collapses = forces(&carried)?;
    carried["virtual"] = json!(springs);
    let found = forces(&carried)?;
    let rests = |own: &Outcome| own.velocity().all(|entry| entry.abs() < 1e-9);
    let asks_nothing = found
        .sustained
        .as_ref()
        .and_then(|own| own.driven.unrealized)
        .is_some_and(|own| [own.fx, own.fz, own.moment].iter().all(|entry| entry.abs() < 1e-11 * weight));
    claims.push((
        "virtual springs that hold the torso, bear the legs and press the feet: at rest, nothing unrealized, the ground \
         gives what they press with"
            .into(),
        asks_nothing
            && only(&found).is_some_and(|own| {
                rests(own) && own.impulse.iter().zip(pressed).all(|(force, expected)| near(force[1], expected))
            }),
    ));
    claims.push(("without them, joints loose: it collapses".into(), only(&collapses).is_some_and(|own| !rests(own))));
    Ok(claims)
}

/// The outcome, if there is exactly one.
fn only(found: &Impact) -> Option<&Outcome> {
    let analysis = found.analysis.as_ref().filter(|own| own.verdict == Verdict::Unique);
    analysis.and_then(|own| own.outcomes.first())
}
