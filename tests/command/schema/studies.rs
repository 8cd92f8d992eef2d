//! The schemas of studies and of sweeps.

use super::{RAMONE, assert_agreement, assert_fields, assert_valid, is_valid};
use heelstrike::sweep::Study;
use heelstrike::write::schema;
use heelstrike::{Error, Reason};
use serde_json::{Value, json};

/// Reads a study of RAMone completely: also its states and robots at the ends and in the middle of the range.
pub fn read(text: &str) -> Result<(), Error> {
    let study = Study::from_json(text)?;
    RAMONE.model(&study).has_own_friction().map(drop)
}

fn sample() -> Value {
    json!({
        "parameters": {"alpha": {"from": 0, "to": 1.5, "steps": 5}},
        "constants": {"k": 0.5, "m": "2*k"},
        "state": {
            "id": "k17",
            "position": {"base": {"pitch": "-alpha"}, "joints": {"left_hip": "alpha + k"}},
            "velocity": {"base": {"x": 0.1}},
            "friction": {"default": "0.1 + alpha", "left_foot": "infinite"},
            "restitution": 0.5,
            "ground": {"slope": "0.1*alpha"},
            "held": ["left_hip"],
            "rotor_inertia": {"left_knee": "0.01*k^2"},
            "contacts": [{"link": "left_foot", "offset": [0, 0, "-alpha"], "radius": 0.1}],
            "uncertainty": {"velocity": "0.1*k^2"},
            "impulse": [{"link": "torso", "offset": [0, 0, 0], "vector": [0, "alpha"]}],
        },
        "robot": {
            "links": {"left_foot": {"mass": "1 + alpha", "com": [0, 0, "k"], "inertia": 0.1, "radius": 0.02}},
            "joints": {"left_hip": {"origin": [0, 0, "0.1*alpha"]}},
        },
        "question": "impact",
    })
}

#[test]
fn schema_and_reader_of_studies_agree() {
    // A schema knows neither the names and values that exist nor the syntax of expressions.
    let beyond = |reason: &Reason| match reason {
        Reason::UnknownName { .. } | Reason::Syntax(_) | Reason::NotFinite { .. } => true,
        Reason::Inconsistent(text) => {
            !text.starts_with("expected") && !text.starts_with("a study varies") && !text.contains("is no name")
        }
        _ => false,
    };
    assert_agreement(&schema::study(), &sample(), read, beyond);
}

#[test]
fn expressions_stand_for_every_number_but_ids() {
    let schema = schema::study();
    let with = |pointer: &str, value: Value| {
        let mut study = sample();
        *study.pointer_mut(pointer).expect(pointer) = value;
        study
    };
    for pointer in [
        "/parameters/alpha/from",
        "/parameters/alpha/steps",
        "/constants/k",
        "/state/position/base/pitch",
        "/state/position/joints/left_hip",
        "/state/restitution",
        "/state/ground/slope",
        "/state/contacts/0/offset/1",
        "/state/contacts/0/radius",
        "/state/uncertainty/velocity",
        "/state/impulse/0/vector/0",
        "/robot/links/left_foot/inertia",
        "/robot/joints/left_hip/origin/2",
    ] {
        assert!(is_valid(&schema, &with(pointer, json!("2 + 2"))), "{pointer}");
        assert!(!is_valid(&schema, &with(pointer, json!(true))), "{pointer}");
        assert!(!is_valid(&schema::state(), &with(pointer, json!("2 + 2"))["state"]), "{pointer}");
    }
    let id = schema.pointer("/$defs/State/properties/id").expect("an id");
    assert!(!id.to_string().contains("Expression"), "{id}");
}

#[test]
fn the_schema_of_studies_has_the_reader_s_fields() {
    let of_robot = |robot: Value| {
        let mut study = sample();
        study["robot"] = robot;
        study
    };
    for (study, pointer) in [
        (json!({"?": 0}), "/properties"),
        (json!({"parameters": {"a": {"?": 0}}}), "/$defs/Parameter/properties"),
        (of_robot(json!({"?": 0})), "/$defs/Variation/properties"),
        (of_robot(json!({"links": {"torso": {"?": 0}}})), "/$defs/LinkVariation/properties"),
        (of_robot(json!({"joints": {"left_hip": {"?": 0}}})), "/$defs/JointVariation/properties"),
    ] {
        assert_fields(&schema::study(), read, &study, pointer);
    }
}

#[test]
fn every_form_of_sweep_is_valid() {
    let schema = schema::sweep();
    let walker = crate::walker(json!({"alpha": {"from": 0.1, "to": 1.5, "steps": 4}}));
    let mut refused = walker.clone();
    refused["state"]["friction"] = json!("sqrt(1 - alpha)");
    let mut lifting = walker.clone();
    lifting["state"] = json!({"position": {"base": {"z": "0.9 + alpha"}}, "friction": 1});
    let mut map = walker.clone();
    map["parameters"]["v"] = json!({"from": -1, "to": 1, "steps": 3});
    map["state"]["velocity"]["joints"] = json!({"hip": "v"});
    let forces = json!({"question": "forces", "parameters": {"alpha": {"from": 1.5, "to": 4, "steps": 3}},
        "state": {"position": {"joints": {"hip": 0.1}}, "place": "lowest", "gravity": 1.6, "torque": {"hip": 0.2},
                  "friction": "alpha"}});
    for (study, arguments) in [
        (&walker, &[][..]),
        (&walker, &["--explain", "--matrices"]),
        (&walker, &["--brief"]),
        (&refused, &[]),
        (&lifting, &[]),
        (&map, &[]),
        (&forces, &["--explain"]),
        (&forces, &["--brief"]),
    ] {
        let command = [&["sweep", "urdf/minimalistic.urdf", "-"], arguments].concat();
        let found = assert_valid(&schema, &command, &study.to_string(), "/regions/0").remove(0);
        let mut less = found.clone();
        less.as_object_mut().expect("an object").remove("samples");
        assert!(!is_valid(&schema, &less), "{study}");
        let mut other = found;
        other["samples"][0]["alpha"] = json!("x");
        assert!(!is_valid(&schema, &other), "{study}");
    }
}
