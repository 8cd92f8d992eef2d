//! Robots of other projects (`data/robots`) and their reference values.

use super::command::read;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::ops::Range;

/// The folder of each robot, and the variant of its reference that matches how heelstrike reads the file by default.
pub const ROBOTS: [(&str, &str); 8] = [
    ("a1", "default"),
    ("acrobot", "fixed"),
    ("cartpole", "fixed_prismatic"),
    ("h1", "default"),
    ("planar_walker_torso", "rerooted"),
    ("rabbit", "default"),
    ("solo8", "default"),
    ("upkie", "default"),
];

/// A contact of a reference, with the fields that it has in states.
#[derive(Deserialize, Serialize)]
pub struct Contact {
    pub link: String,
    pub offset: [f64; 3],
    pub radius: f64,
}

/// The path of the URDF in a folder, and the variant of its reference as a `T` with the fields that a test needs.
pub fn robot_and_reference<T: DeserializeOwned>((folder, variant): (&str, &str)) -> (String, T) {
    let folder = format!("tests/data/robots/{folder}");
    let reference: Value = serde_json::from_str(&read(&format!("{folder}/reference.json"))).expect("a reference");
    let urdf = format!("{folder}/{}", reference["urdf"].as_str().expect("a file's name"));
    (urdf, serde_json::from_value(reference["variants"][variant].clone()).expect("the variant"))
}

/// The JSON of states for values of coordinates; the first `base` ones are those of the floating base.
pub fn by_name(coordinates: &[String], base: usize, values: &[f64]) -> Value {
    let part = |range: Range<usize>| -> Value { range.map(|k| (coordinates[k].clone(), json!(values[k]))).collect() };
    let mut named = json!({"joints": part(base..values.len())});
    if base > 0 {
        named["base"] = part(0..base);
    }
    named
}
