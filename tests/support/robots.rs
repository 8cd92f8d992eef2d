//! The robots of other people's projects (`data/robots`) and their references.

use super::command::read;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Their folders, and which variant of the reference is the robot as it is read.
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

/// The URDF in a folder and that variant of its reference; variants differ in their fields.
pub fn robot_and_reference<T: DeserializeOwned>((folder, variant): (&str, &str)) -> (String, T) {
    let folder = format!("tests/data/robots/{folder}");
    let reference: Value = serde_json::from_str(&read(&format!("{folder}/reference.json"))).expect("a reference");
    let urdf = read(&format!("{folder}/{}", reference["urdf"].as_str().expect("a file's name")));
    (urdf, serde_json::from_value(reference["variants"][variant].clone()).expect("the variant"))
}
