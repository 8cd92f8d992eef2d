//! The robots of other projects (`data/robots`), with and without reductions.

use crate::support::command::read;
use crate::support::parallel::total;
use crate::support::robots::{Contact, ROBOTS, by_name, robot_and_reference};
use heelstrike::reductions::Reductions;
use heelstrike::robot::Reduction;
use serde::Deserialize;
use serde_json::{Value, json};

use super::comparison::{FEWER, answer, difference, largest_rate};
use crate::support::impact;

#[derive(Deserialize)]
struct Variant {
    coordinates: Vec<String>,
    contacts: Vec<Contact>,
    configs: Vec<Config>,
}

#[derive(Deserialize)]
struct Config {
    q: Vec<f64>,
    v: Vec<f64>,
}

/// The states of a robot's reference, each with one contact and with up to four, three kinds of friction, and joints
/// braked or not.
fn states(variant: &Variant, base: usize, joints: &[String]) -> Vec<Value> {
    let named = |values: &[f64]| by_name(&variant.coordinates, base, values);
    let held: Vec<&String> = joints.iter().step_by(2).collect();
    let mut states = Vec::new();
    for config in &variant.configs {
        for contacts in [1, 4].map(|most| &variant.contacts[..variant.contacts.len().min(most)]) {
            for friction in [json!(0.0), json!(0.8), json!("infinite")] {
                for held in [&[][..], &held[..]] {
                    states.push(json!({
                        "position": named(&config.q), "velocity": named(&config.v), "friction": friction,
                        "contacts": contacts, "held": held,
                    }));
                }
            }
        }
    }
    states
}

fn compare(name: &str, variant: &str) {
    let (urdf, variant) = robot_and_reference::<Variant>((name, variant));
    let text = read(&urdf);
    let robot = |reductions| impact::reduced(&text, &Reduction { reductions, ..Reduction::default() });
    let reduced = robot(Reductions::ALL);
    let joints: Vec<String> = reduced.joints().iter().map(|joint| joint.name.clone()).collect();
    let mut states = states(&variant, reduced.base_dofs(), &joints);
    // States with detected feet: up to six links with shapes are each the stance of one.
    for link in reduced.links().iter().filter(|link| !link.shapes.is_empty() && reduced.base_dofs() > 0).take(6) {
        let mut standing = states[2].clone();
        standing.as_object_mut().expect("an object").remove("contacts");
        for part in ["position", "velocity"] {
            standing[part]["base"] = json!({"pitch": standing[part]["base"]["pitch"]});
        }
        standing["stance"] = json!(link.name);
        states.push(standing);
    }
    let (mut compared, mut differences) = (0, Vec::new());
    for (fewer, reductions) in FEWER.into_iter().enumerate() {
        let unreduced = robot(reductions);
        for state in &states {
            match (answer(&reduced, state, Reductions::ALL), answer(&unreduced, state, reductions)) {
                (Ok(one), Ok(other)) => {
                    compared += 1;
                    let difference = difference(&one, &other, Some(largest_rate(state)));
                    differences.extend(difference.err().map(|what| format!("{fewer}: {what}\n  {state}")));
                }
                // Both refuse for the same reason: a foot is in the ground while another stands, or a joint moves
                // nothing.
                (Err(one), Err(other)) if one.to_string() == other.to_string() => {}
                (one, other) => differences.push(format!("{fewer}: {:?} and {:?}\n  {state}", one.err(), other.err())),
            }
        }
    }
    assert!(differences.is_empty(), "{name}: {} of {compared}\n{}", differences.len(), differences[0]);
    assert!(compared >= FEWER.len() * states.len() / 2, "{name}: {compared} compared");
}

#[test]
fn robots_of_others_need_none_of_what_is_left_out() {
    let [compared] = total(ROBOTS.len() as u64, |index| {
        let (name, variant) = ROBOTS[index as usize];
        compare(name, variant);
        [1]
    });
    assert_eq!(compared, 8);
}
