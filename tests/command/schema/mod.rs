//! The schemas that `heelstrike schema` prints, against the reader of inputs and the writer of results.
//!
//! Inputs: a full sample is varied in every place, and schema and reader must agree about each variant. Results: every
//! form of result that the command writes must be valid, and invalid with a field more or less.

use super::support::subject::Subject;
use super::{heelstrike_reads, list, parsed, read};
use heelstrike::read::Problem;
use heelstrike::state::{Defaults, State};
use heelstrike::write::schema;
use heelstrike::{Error, Reason};
use serde_json::{Value, json};
use std::sync::LazyLock;
use validator::is_valid;

pub mod studies;
mod validator;

pub static RAMONE: LazyLock<Subject> =
    LazyLock::new(|| Subject::new("ramone", include_str!("../../../urdf/ramone.urdf")));

fn read_state(text: &str) -> Result<State, Error> {
    State::from_json(text, &RAMONE.robot, &Defaults::default())
}

/// The command's JSON results, whatever its exit status. Each must be valid, and invalid with an unknown field in the
/// object at `place`.
fn assert_valid(schema: &Value, arguments: &[&str], stdin: &str, place: &str) -> Vec<Value> {
    let results = heelstrike_reads(&[arguments, &["--format", "json"]].concat(), stdin).lines();
    for result in &results {
        assert!(is_valid(schema, result), "{arguments:?}: {result}");
        let mut more = result.clone();
        more.pointer_mut(place).expect("an object")["unknown?"] = json!(0);
        assert!(!is_valid(schema, &more), "{arguments:?}");
    }
    results
}

/// Checks that the reader's hint on an unknown field lists exactly the schema's fields at `pointer`.
fn assert_fields<T>(schema: &Value, read: impl Fn(&str) -> Result<T, Error>, value: &Value, pointer: &str) {
    let properties = schema.pointer(pointer).and_then(Value::as_object).expect("properties");
    let error = read(&value.to_string()).err().expect("an unknown field");
    let hint = error.remedy().and_then(|hint| hint.strip_prefix("the fields here are ")).expect("the known fields");
    let list = hint.split("; ").next().expect("a part");
    let mut known: Vec<&str> = list.split(", ").collect();
    known.sort_unstable();
    assert_eq!(properties.keys().collect::<Vec<_>>(), known, "{value}");
}

/// All variants of the sample with one change: a value replaced by one of `OTHERS` or left out, or an unknown field.
fn variants(sample: &Value) -> Vec<Value> {
    const OTHERS: &str = r#"[null, true, "x", "infinite", -1, 0, 1.5, 2, [], {}, [0, 0], [0, 0, 0], [[0, 0]],
                             ["left_hip", "left_hip"]]"#;
    let mut variants = list(&parsed(OTHERS)).to_vec();
    let left_out_or_varied = |part: &Value| [None].into_iter().chain(self::variants(part).into_iter().map(Some));
    match sample {
        Value::Object(fields) => {
            for (name, field) in fields {
                for variant in left_out_or_varied(field) {
                    let mut object = fields.clone();
                    object.remove(name);
                    object.extend(variant.map(|field| (name.clone(), field)));
                    variants.push(object.into());
                }
            }
            let mut more = sample.clone();
            more["unknown?"] = json!(0);
            variants.push(more);
        }
        Value::Array(entries) => {
            for (at, entry) in entries.iter().enumerate() {
                for variant in left_out_or_varied(entry) {
                    let mut entries = entries.clone();
                    entries.splice(at..=at, variant);
                    variants.push(entries.into());
                }
            }
        }
        _ => {}
    }
    variants
}

/// Checks that schema and reader agree about every variant of the sample, except for the reader's refusals
/// `beyond_a_schema`.
fn assert_agreement<T>(
    schema: &Value,
    sample: &Value,
    read: impl Fn(&str) -> Result<T, Error>,
    beyond_a_schema: impl Fn(&Reason) -> bool,
) {
    assert!(is_valid(schema, sample), "{sample}");
    read(&sample.to_string()).map_err(|error| panic!("{error}: {sample}")).ok();
    let (mut accepted, mut refused) = (0, 0);
    for variant in variants(sample) {
        match read(&variant.to_string()) {
            Ok(_) => {
                assert!(is_valid(schema, &variant), "accepted, but not by the schema: {variant}");
                accepted += 1;
            }
            Err(error) if beyond_a_schema(error.reason()) => {}
            Err(error) => {
                assert!(!is_valid(schema, &variant), "{error}, but the schema accepts it: {variant}");
                refused += 1;
            }
        }
    }
    assert!(accepted > 20 && refused > 50, "{accepted} accepted, {refused} refused");
}

#[test]
fn schema_and_reader_of_states_agree() {
    let scene = json!({
        "id": "k17",
        "position": {"base": {"x": 0.0, "z": 0.44, "pitch": 0.0}, "joints": {"left_hip": 0.7}},
        "velocity": {"base": {"x": 0.1}, "joints": {"left_hip": 0.0}},
        "friction": {"default": 0.8, "left_foot": "infinite"},
        "restitution": {"default": 0, "left_foot": 1},
        "ground": {"slope": 0.1},
        "held": ["left_hip", "left_knee"],
        "rotor_inertia": {"left_knee": 0.01},
        "contacts": [{"link": "left_foot", "offset": [0, 0, -0.1], "radius": 0.1}],
        "loops": [{"a": {"link": "left_foot", "offset": [0, 0, -0.1]}, "b": {"link": "torso"}}],
        "uncertainty": {
            "position": {"base": {"x": 0, "z": 0, "pitch": 0.1}, "joints": {"left_hip": 0.1}}, "velocity": 0.1,
            "friction": {"default": 0.1, "left_foot": 0}, "rotor_inertia": {"left_hip": 0.1},
        },
        "impulse": [{"link": "torso", "offset": [0, 0, 0], "vector": [0, 0]}],
        "gravity": 9.81,
        "torque": {"left_knee": 1.5},
    });
    let standing = json!({"id": 1, "stance": "left_foot", "friction": 0.8, "restitution": 0.5,
        "position": {"base": {"pitch": 0.1}}, "ground": {"profile": [[-1, 0], [1, 0.5], [2, 0.5]]},
        "uncertainty": {"friction": 0.1, "rotor_inertia": 0.1}});
    // A schema knows neither the robot's names nor that a stance places the base.
    let beyond = |reason: &Reason| matches!(reason, Reason::UnknownName { .. } | Reason::Inconsistent(_));
    let shape = |reason: &Reason| matches!(reason, Reason::Inconsistent(text) if text.starts_with("expected"));
    for sample in [scene, standing] {
        assert_agreement(&schema::state(), &sample, read_state, |reason| beyond(reason) && !shape(reason));
    }
}

#[test]
fn schema_and_reader_of_problems_agree() {
    let contact = json!({"id": "rod", "delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1.0]],
        "friction": [0.8], "restitution": [0.0], "names": ["tip"]});
    let dynamics = json!({"mass_matrix": [[2, 0], [0, 2]], "contact_jacobian": [[1, 0], [0, 1]], "velocity": [0, -1],
        "friction": "infinite", "restitution": 0.5});
    let defaults = Defaults { friction: Some(heelstrike::impact::Friction::Infinite), ..Defaults::default() };
    let read = |text: &str| Problem::from_json(text, &defaults);
    // A schema does not know whether the matrices fit each other and are those of a mechanism.
    let beyond = |reason: &Reason| match reason {
        Reason::Inconsistent(text) => !text.starts_with("expected") && !text.starts_with("the problem has both"),
        Reason::OutOfRange { what, .. } => what != "friction" && what != "restitution",
        Reason::Singular(_) => true,
        _ => false,
    };
    for sample in [contact, dynamics] {
        assert_agreement(&schema::problem(), &sample, read, beyond);
    }
}

#[test]
fn the_schema_of_states_has_the_reader_s_fields() {
    for (value, pointer) in [
        (json!({"?": 0}), "/properties"),
        (json!({"position": {"?": 0}}), "/$defs/Coordinates/properties"),
        (json!({"velocity": {"base": {"?": 0}}}), "/$defs/Base/properties"),
        (json!({"ground": {"?": 0}}), "/$defs/Ground/properties"),
        (json!({"contacts": [{"?": 0}]}), "/$defs/Contact/properties"),
        (json!({"loops": [{"?": 0}]}), "/$defs/Loop/properties"),
        (json!({"loops": [{"a": {"?": 0}}]}), "/$defs/LinkPoint/properties"),
        (json!({"impulse": [{"?": 0}]}), "/$defs/AppliedImpulse/properties"),
        (json!({"virtual": [{"?": 0}]}), "/$defs/Spring/properties"),
        (json!({"virtual": [{"a": {"link": "torso"}, "b": {"?": 0}}]}), "/$defs/SpringEnd/properties"),
        (
            json!({"virtual": [{"a": {"link": "torso"}, "b": {"world": [0, 0]}, "pitch": {"?": 0}}]}),
            "/$defs/PitchSpring/properties",
        ),
        (json!({"uncertainty": {"?": 0}}), "/$defs/Uncertainty/properties"),
        (json!({"uncertainty": {"position": {"?": 0}}}), "/$defs/NamedHalfWidths/properties"),
        (json!({"uncertainty": {"velocity": {"base": {"?": 0}}}}), "/$defs/BaseHalfWidths/properties"),
    ] {
        assert_fields(&schema::state(), read_state, &value, pointer);
    }
}

#[test]
fn a_target_needs_a_stiffness() {
    for (spring, is_complete) in [
        (json!({"target": [0, 1]}), false),
        (json!({"target": [0, 1], "stiffness": [0, 0]}), true),
        (json!({"pitch": {"target": 1}}), false),
        (json!({"pitch": {"target": 1, "stiffness": 5}}), true),
    ] {
        let mut whole = json!({"a": {"link": "torso"}, "b": {"world": [0, 0]}});
        whole.as_object_mut().expect("an object").extend(spring.as_object().expect("an object").clone());
        let state = json!({"virtual": [whole]});
        assert_eq!(is_valid(&schema::state(), &state), is_complete, "{state}");
        assert_eq!(read_state(&state.to_string()).is_ok(), is_complete, "{state}");
    }
}

#[test]
fn every_example_is_valid() {
    for (folder, at_least, schema) in [
        ("examples", 7, schema::state()),
        ("examples/problems", 3, schema::problem()),
        ("examples/paper", 16, schema::study()),
        ("examples/lecture", 1, schema::study()),
    ] {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "json" || ending == "ndjson"));
        assert!(paths.len() >= at_least, "{folder}");
        for path in paths {
            let path = path.to_str().expect("UTF-8");
            for value in serde_json::Deserializer::from_str(&read(path)).into_iter::<Value>() {
                let value = value.unwrap_or_else(|error| panic!("{path}: {error}"));
                // A file of a figure holds a study or a state.
                let is_state = folder == "examples/paper" && value.get("parameters").is_none();
                let schema = if is_state { &schema::state() } else { &schema };
                assert!(is_valid(schema, &value), "{path}: {value}");
            }
        }
    }
}

#[test]
fn every_form_of_result_is_valid() {
    let ramone = ["impact", "urdf/ramone.urdf", "examples/ramone.json"];
    let measured = ["impact", "urdf/ramone.urdf", "examples/ramone_measured.json"];
    let badly = super::badly_measured();
    let pdw = ["batch", "urdf/pdw.urdf", "-"];
    let rod = ["solve", "examples/problems/rod.json"];
    let lines = "{\"id\": 1, \"stance\": \"left_leg\", \"friction\": 0.5}\n{\"id\": \"k2\", \"frict\": 0.5}\n";
    let contacts: Vec<Value> = (0..11).map(|k| json!({"link": "left_leg", "offset": [k, 0, 0]})).collect();
    let many = json!({"id": 1, "friction": 1, "contacts": contacts}).to_string();
    let mut seen = 0;
    for (arguments, input) in [
        (&ramone[..], ""),
        (&[&ramone[..], &["--explain", "--matrices"]].concat(), ""),
        (&[&ramone[..], &["--brief"]].concat(), ""),
        (&[&ramone[..], &["--next"]].concat(), ""),
        (&[&ramone[..], &["--next", "--brief"]].concat(), ""),
        (&measured, ""),
        (&[&measured[..], &["--brief"]].concat(), ""),
        (&["impact", "urdf/ramone.urdf", "-"], &badly),
        (&pdw, lines),
        (&[&pdw[..], &["--brief"]].concat(), lines),
        (&[&pdw[..], &["--matrices"]].concat(), &many),
        (&[&pdw[..], &["--base", "fixed"]].concat(), "{\"friction\": 1}"),
        (&rod, ""),
        (&[&rod[..], &["--explain", "--matrices"]].concat(), ""),
        (&["solve", "examples/problems/painleve_rod.json", "--explain"], ""),
    ] {
        seen += assert_valid(&schema::result(), arguments, input, "").len();
    }
    assert_eq!(seen, 17);
}

#[test]
fn every_form_of_forces_is_valid() {
    let stands = ["forces", "urdf/ramone.urdf", "examples/ramone_stands.json"];
    let paradoxes = ["forces", "urdf/block.urdf", "examples/painleve.json"];
    let mut verdicts = Vec::new();
    for (arguments, input) in [
        (&stands[..], ""),
        (&[&stands[..], &["--explain", "--matrices"]].concat(), ""),
        (&[&stands[..], &["--brief"]].concat(), ""),
        (&paradoxes, ""),
        (
            &["forces", "urdf/ramone.urdf", "-", "--friction", "1"],
            r#"{"position": {"base": {"z": 2}}, "virtual": [{"a": {"link": "torso"}, "b": {"link": "left_foot"}, "stiffness": [0, 9], "pitch": {"damping": 1}},
                {"a": {"link": "torso", "offset": [0, 0, 1]}, "b": {"world": [0, 1]}, "force": [3, 0], "moment": 2}]}"#,
        ),
        (&["forces", "urdf/block.urdf", "-"], "{\"friction\": 1, \"velocity\": {\"base\": {\"z\": -1}}}"),
        // Copied fields of a flat line keep their types.
        (
            &["batch", "urdf/block.urdf", "-", "--forces", "--friction", "1"],
            "{\"q_base_z\": 2, \"v_base_z\": 0, \"phase\": 3, \"left\": true}\n",
        ),
    ] {
        let found = assert_valid(&schema::forces(), arguments, input, "");
        verdicts.extend(found.iter().map(|own| own["verdict"].as_str().unwrap_or("refused").to_owned()));
    }
    assert_eq!(verdicts, ["unique", "unique", "unique", "none", "ambiguous", "no_contact", "refused", "no_contact"]);
}

#[test]
fn every_form_of_a_report_on_accuracy_is_valid() {
    let schema = schema::accuracy();
    for arguments in [
        // Regular, and with compliant contact.
        &["urdf/ramone.urdf", "examples/ramone.json"][..],
        &["--no-proof", "--case", "friction infinite, biped"],
        // Refused; without a condition number; given as matrices.
        &["--case", "massless feet"],
        &["--case", "coincident feet"],
        &["--case", "Hilbert"],
        // A method left out.
        &["urdf/five_bar.urdf", "examples/five_bar.json"],
    ] {
        let mut less =
            assert_valid(&schema, &[&["accuracy", "--time", "0"], arguments].concat(), "", "/studies/0").remove(0);
        less["studies"][0].as_object_mut().expect("an object").remove("methods");
        assert!(!is_valid(&schema, &less), "{arguments:?}");
    }
}

#[test]
fn the_command_prints_every_schema() {
    for (name, expected) in [
        ("state", schema::state()),
        ("result", schema::result()),
        ("forces", schema::forces()),
        ("problem", schema::problem()),
        ("study", schema::study()),
        ("sweep", schema::sweep()),
        ("accuracy", schema::accuracy()),
    ] {
        let printed = parsed(&heelstrike_reads(&["schema", name], "").stdout);
        assert_eq!(printed, expected);
        assert_eq!(printed["$schema"], "https://json-schema.org/draft/2020-12/schema");
    }
    assert_eq!(heelstrike_reads(&["schema", "gait"], "").stdout, "");
    // A field without a value is left out and never null: `holds` does not allow null.
    let mut waiting = vec![schema::result()];
    let mut holds = Vec::new();
    while let Some(value) = waiting.pop() {
        holds.extend(value.pointer("/properties/holds/enum").cloned());
        let within: Vec<Value> = value.as_object().into_iter().flat_map(|own| own.values().cloned()).collect();
        waiting.extend(value.as_array().cloned().unwrap_or(within));
    }
    assert!(!holds.is_empty() && holds.iter().all(|own| *own == json!([true, false, "unknown"])), "{holds:?}");
}
