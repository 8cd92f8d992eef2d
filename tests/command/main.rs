//! The command line, run as a user runs it: what is written where, in which form, and the exit status.
//!
//! Texts for people are kept as snapshots (`INSTA_UPDATE=always cargo test --test command` renews them, then read the
//! difference); the JSON contract is checked field by field; refusals stand in tables. Numbers are checked elsewhere.

use serde_json::Value;
use support::command::{Run, command, file, finished, heelstrike, heelstrike_reads, place};

mod accuracy;
mod batch;
mod inspect;
mod manners;
mod meshes;
mod page;
mod picture;
mod refusals;
mod schema;
#[path = "../support/mod.rs"]
mod support;
mod sweep_picture;

const RAMONE: &str = "urdf/ramone.urdf";
const WALKER: &str = "urdf/minimalistic.urdf";
const BLOCK: &str = "urdf/block.urdf";

// Text for people.

#[test]
fn one_command_shows_the_outcome_of_the_example() {
    let run = heelstrike(&["impact", RAMONE, "examples/ramone.json"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("impact_ramone", run.stdout);
}

#[test]
fn explain_tells_why_every_other_combination_fails() {
    let run = heelstrike(&["impact", WALKER, "examples/minimalistic.json", "--explain", "--matrices"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("impact_minimalistic_explained", run.stdout);
}

#[test]
fn solve_tells_borders_and_families_in_words() {
    let problems = r#"
        {"id": "cone edge", "delassus": [[1, 0], [0, 1]], "velocity_before": [[-0.5, -1]], "friction": 0.5, "names": ["tip"]}
        {"id": "family", "delassus": [[2, 1], [1, 2]], "velocity_before": [[1, 0]], "friction": 2, "names": ["tip"]}"#;
    let run = heelstrike_reads(&["solve", "-", "--format", "text"], problems);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("solve_borders", run.stdout);

    let run = heelstrike_reads(&["solve", "-", "--format", "text", "--brief"], problems);
    insta::assert_snapshot!("solve_borders_brief", run.stdout);
}

#[test]
fn a_verdict_without_outcome_is_explained() {
    // A point between floor and ceiling, of which the floor alone throws back.
    let walls = r#"{"id": "walls", "mass_matrix": [[1, 0], [0, 1]], "velocity": [0, -1], "friction": 0,
        "contact_jacobian": [[1, 0], [0, 1], [-1, 0], [0, -1]], "restitution": [0.5, 0], "names": ["floor", "ceiling"]}"#;
    let run = heelstrike_reads(&["solve", "-", "--format", "text", "--brief"], walls);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("solve_without_outcome", run.stdout);
}

#[test]
fn solve_tells_three_outcomes_of_a_rod_that_may_jam() {
    let run = heelstrike(&["solve", "examples/problems/painleve_rod.json"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("solve_painleve_rod", run.stdout);
}

#[test]
fn an_uncertain_state_is_told_to_hold_or_not() {
    let run = heelstrike(&["impact", RAMONE, "examples/ramone_measured.json", "--brief"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("impact_uncertain", run.stdout);
    let run = heelstrike_reads(&["impact", RAMONE, "-", "--brief"], badly_measured());
    let line = run.stdout.lines().find(|line| line.starts_with("Holds")).expect("a line about the box");
    insta::assert_snapshot!("impact_badly_measured", line);
}

/// The example with half-widths ten times as wide.
fn badly_measured() -> String {
    std::fs::read_to_string("examples/ramone_measured.json").expect("the example").replace("1e-3", "1e-2")
}

#[test]
fn a_counterexample_can_be_fed_back() {
    let run = heelstrike_reads(&["impact", RAMONE, "-", "--format", "json"], badly_measured());
    let first: Value = serde_json::from_str(&run.stdout).expect("JSON");
    assert_eq!(first["holds"], false);
    let found = &first["counterexample"];
    let run = heelstrike_reads(&["impact", RAMONE, "-", "--format", "json"], found["state"].to_string());
    let second: Value = serde_json::from_str(&run.stdout).expect("JSON");
    let modes = |answer: &Value| -> Vec<Value> {
        answer["outcomes"].as_array().expect("a list").iter().map(|outcome| outcome["modes"].clone()).collect()
    };
    assert_eq!((&second["verdict"], &second["proven"]), (&found["verdict"], &Value::Bool(true)));
    assert_eq!(&modes(&second), found["outcomes"].as_array().expect("a list"));
    assert_ne!(modes(&second), modes(&first));
}

#[test]
fn brief_text_has_a_line_per_outcome() {
    let run = heelstrike(&["impact", BLOCK, "examples/block_jams.json", "--brief"]);
    insta::assert_snapshot!("impact_brief", run.stdout);
}

#[test]
fn a_robot_in_the_air_keeps_its_velocity() {
    let state = r#"{"position": {"base": {"z": 1}}, "velocity": {"base": {"x": 2}}, "friction": 0.5}"#;
    let run = heelstrike_reads(&["impact", BLOCK, "-"], state);
    insta::assert_snapshot!("impact_in_the_air", run.stdout);
    let result = heelstrike_reads(&["impact", BLOCK, "-", "--format", "json"], state).line();
    assert_eq!(result["verdict"], "no_contact");
    assert_eq!(result["outcomes"][0]["modes"], serde_json::json!([]));
    assert_eq!(result["outcomes"][0]["base_velocity_after"]["x"], 2.0);
}

// The JSON contract.

/// The JSON with every number as 0: what is left are the fields, their order and their shapes.
fn shape(json: &str) -> String {
    let mut shape = String::new();
    for (at, part) in json.split('"').enumerate() {
        // Every second part is in quotes.
        if at % 2 == 1 {
            shape += &format!("\"{part}\"");
            continue;
        }
        for word in part.split_inclusive(|letter| ",:[]{}".contains(letter)) {
            let value = word.trim_end_matches(|letter| ",:[]{}".contains(letter));
            shape += if value.parse::<f64>().is_ok() { "0" } else { value };
            shape += &word[value.len()..];
        }
        if part.ends_with(',') {
            shape.push('\n');
        }
    }
    shape
}

#[test]
fn results_have_the_fields_of_the_contract() {
    let bolted = r#"{"contacts": [{"link": "right_leg", "offset": [0, 0, -1]}], "velocity": {"joints": {"hip": 1}},
                     "friction": 1}"#;
    for (name, arguments, stdin) in [
        ("fields_of_impact", &["impact", RAMONE, "examples/ramone.json"][..], ""),
        ("fields_explained", &["impact", RAMONE, "examples/ramone.json", "--explain", "--matrices"], ""),
        ("fields_brief", &["impact", WALKER, "examples/minimalistic.json", "--brief"], ""),
        ("fields_of_solve", &["solve", "examples/problems/rod.json", "--explain", "--matrices"], ""),
        ("fields_bolted", &["impact", WALKER, "-", "--base", "fixed", "--matrices"], bolted),
        ("fields_of_inspect", &["inspect", "urdf/ramone_paper.urdf"], ""),
    ] {
        let run = heelstrike_reads(&[arguments, &["--format", "json"]].concat(), stdin);
        assert_eq!(run.status, 0, "{}", run.stderr);
        insta::assert_snapshot!(name, shape(&run.stdout));
    }
}

#[test]
fn a_problem_s_matrices_are_written_as_given() {
    let result = heelstrike(&["solve", "examples/problems/rod.json", "--format", "json", "--matrices"]).line();
    assert_eq!(result["contacts"], serde_json::json!([{"name": "tip", "velocity_before": [0.5, -1.0]}]));
    assert_eq!(result["delassus"], serde_json::json!([[2.0, 1.0], [1.0, 2.0]]));
}

// Commands and options.

#[test]
fn every_example_is_answered() {
    for (robot, state) in [
        (RAMONE, "examples/ramone.json"),
        (RAMONE, "examples/ramone_measured.json"),
        (RAMONE, "examples/ramone_measured_by_name.json"),
        ("urdf/ramone_paper.urdf", "examples/ramone_paper.json"),
        (WALKER, "examples/minimalistic.json"),
        ("urdf/pdw.urdf", "examples/pdw.json"),
        (BLOCK, "examples/block.json"),
        (BLOCK, "examples/block_jams.json"),
    ] {
        let run = heelstrike(&["impact", robot, state]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{state}");
    }
    for problem in ["rod", "painleve_rod", "block_from_dynamics"] {
        let run = heelstrike(&["solve", &format!("examples/problems/{problem}.json")]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{problem}");
    }
    let run = heelstrike(&["batch", WALKER, "examples/keyframes.ndjson", "--friction", "infinite"]);
    let verdicts: Vec<Value> = run.lines().iter().map(|line| line["verdict"].clone()).collect();
    assert_eq!(verdicts, ["unique", "unique", "unique", "ambiguous"]);
    assert_eq!(run.status, 0);
    assert!(run.stderr.starts_with("4 states: 3 unique, 1 ambiguous\n"), "{}", run.stderr);
}

#[test]
fn matrices_of_too_many_contacts_stand_beside_an_error() {
    let contacts: Vec<String> = (0..11).map(|k| format!(r#"{{"link": "block", "offset": [{k}, 0, 0]}}"#)).collect();
    let state = format!(r#"{{"id": 1, "friction": 1, "contacts": [{}]}}"#, contacts.join(", "));
    for command in ["impact", "batch"] {
        let run = heelstrike_reads(&[command, BLOCK, "-", "--matrices", "--format", "json"], state.as_str());
        let result = run.line();
        assert_eq!((run.status, result["delassus"].as_array().map(Vec::len)), (1, Some(22)));
        assert!(result["error"]["message"].as_str().is_some_and(|message| message.starts_with("11 contacts")));
        assert!(result.get("verdict").is_none() && result.get("outcomes").is_none());
        assert!(run.stderr.starts_with("error: ") && run.stderr.contains("11 contacts"), "{}", run.stderr);
        let without = heelstrike_reads(&[command, BLOCK, "-", "--format", "json"], state.as_str());
        let fields = without.line();
        let fields: Vec<&str> = fields.as_object().expect("an object").keys().map(String::as_str).collect();
        assert_eq!((without.status, fields), (1, vec!["error", "id", "line"]));
    }
}

#[test]
fn a_batch_answers_in_order_and_a_broken_line_in_its_place() {
    let lines = concat!(
        "{\"id\": 1, \"stance\": \"left_leg\", \"friction\": 0.5}\r\n",
        "\n",
        "{\"id\": \"k2\", \"friction\": 0.5, \"position\": {\"joints\": {\"hipp\": 1}}}\n",
        "{\"id\": 3, \"friction\": 0.5, oops\n",
        "   \n",
        "{\"id\": 4.5, \"stance\": \"left_leg\", \"friction\": 0.5}"
    );
    let run = heelstrike_reads(&["batch", "urdf/pdw.urdf", "-"], lines);
    assert_eq!(run.status, 1);
    let answers = run.lines();
    let ids: Vec<&Value> = answers.iter().map(|answer| &answer["id"]).collect();
    assert_eq!(ids, [&serde_json::json!(1), &serde_json::json!("k2"), &serde_json::json!(3), &serde_json::json!(4.5)]);
    assert_eq!(
        run.stdout.lines().nth(1),
        Some(
            r#"{"id":"k2","line":3,"error":{"message":"the robot has no joint named \"hipp\"","place":"position.joints.hipp","hint":"did you mean hip?"}}"#
        )
    );
    assert_eq!(answers[2]["line"], 4);
    let places: Vec<&str> = run.stderr.lines().filter(|line| line.starts_with(" --> ")).collect();
    assert_eq!(places, [" --> <stdin>:3:55", " --> <stdin>:4:28"], "{}", run.stderr);
}

#[test]
fn file_and_standard_input_give_the_same_bytes() {
    let lines = std::fs::read("examples/keyframes.ndjson").expect("the example");
    let from_file = heelstrike(&["batch", WALKER, "examples/keyframes.ndjson"]);
    let from_stdin = heelstrike_reads(&["batch", WALKER, "-"], lines);
    // Without friction every line is refused, by the same bytes.
    assert_eq!((from_file.status, from_stdin.status), (1, 1));
    assert_eq!(from_file.stdout, from_stdin.stdout);
    assert!(from_file.stdout.contains("friction"));
}

#[test]
fn bytes_that_are_no_text_are_refused_in_their_place() {
    let mut lines = b"{\"id\": \"\xff\"}\n".to_vec();
    lines.extend(b"{\"friction\": 1}\n");
    let run = heelstrike_reads(&["batch", BLOCK, "-"], lines);
    assert_eq!(run.status, 1);
    let answers = run.lines();
    let hint = "save it as UTF-8; iconv -f LATIN1 -t UTF-8 converts what older editors wrote";
    assert_eq!(answers[0], serde_json::json!({"line": 1, "error": {"message": "the text is not UTF-8", "hint": hint}}));
    assert_eq!(answers[1]["verdict"], "no_impact");
}

#[test]
fn a_stream_of_problems_is_answered_line_by_line_and_a_refused_one_in_its_place() {
    let good = r#"{"id": "a", "delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 1}"#;
    let bad = r#"{"id": "b", "delassus": [[2, 1], [1, 2]], "friction": 1}"#;
    let stream = format!("{good} {good}\n{bad}\n{{\"id\": \"c\", oops\n{good}\n");
    let run = heelstrike_reads(&["solve", "-", "--format", "json"], stream);
    assert_eq!(run.status, 1);
    let answers = run.lines();
    let seen: Vec<_> = answers.iter().map(|answer| (answer["id"].as_str(), answer["line"].as_u64())).collect();
    assert_eq!(
        seen,
        [(Some("a"), None), (Some("a"), None), (Some("b"), Some(2)), (Some("c"), Some(3)), (Some("a"), None)]
    );
    assert_eq!(answers[2]["error"]["message"], "\"velocity_before\" is missing");

    let list = heelstrike_reads(&["solve", "-", "--format", "json"], format!("[{good},\n{good}]"));
    assert_eq!((list.status, list.lines().len()), (0, 2));
}

#[test]
fn friction_of_the_command_line_is_for_states_that_name_none() {
    let modes = |state: &str, friction: &str| {
        let run = heelstrike_reads(&["impact", BLOCK, "-", "--format", "json", "--friction", friction], state);
        run.line()["outcomes"][0]["modes"][0].clone()
    };
    let silent = r#"{"velocity": {"base": {"x": 1, "z": -1}}}"#;
    assert_eq!(modes(silent, "0"), "slide+");
    assert_eq!(modes(silent, "infinite"), "stick");
    let told = r#"{"velocity": {"base": {"x": 1, "z": -1}}, "friction": {"block": "infinite"}}"#;
    assert_eq!(modes(told, "0"), "stick");
}

#[test]
fn a_foot_of_the_command_line_touches_by_its_height() {
    let contacts = |height: &str| {
        let state = format!(r#"{{"position": {{"base": {{"z": {height}}}}}, "friction": 1}}"#);
        let run =
            heelstrike_reads(&["impact", BLOCK, "-", "--format", "json", "--contact", "block:0,0,-0.7:0.3"], state);
        run.line()["contacts"].as_array().map(Vec::len)
    };
    assert_eq!(contacts("1"), Some(1));
    assert_eq!(contacts("1.1"), Some(0));
    let run = heelstrike(&["inspect", BLOCK, "--contact", "block:0,0,-0.7:0.3", "--format", "json"]);
    assert_eq!(run.line()["feet"][1]["centre"], serde_json::json!([0.0, -0.7]));
}

#[test]
fn the_outputs_ending_says_its_form() {
    let written = |command: &[&str], name: &str| {
        let path = file(name, "what was there before, and longer than nothing");
        let run = heelstrike(&[command, &["-o", &path]].concat());
        assert_eq!((run.status, run.stdout.as_str()), (0, ""), "{}", run.stderr);
        std::fs::read_to_string(&path).expect("it was written")
    };
    let impact = ["impact", BLOCK, "examples/block.json"];
    let solve = ["solve", "examples/problems/rod.json"];
    let batch = ["batch", WALKER, "examples/keyframes.ndjson", "--friction", "1"];
    let is_json = |text: String| text.starts_with("{\"") && text.ends_with("}\n");
    assert!(is_json(written(&impact, "a.json")));
    assert!(is_json(written(&impact, "a.ndjson")));
    assert!(written(&impact, "a.txt").starts_with("block"));
    assert!(is_json(written(&solve, "b")));
    assert!(is_json(written(&solve, "b.dat")));
    assert!(is_json(written(&batch, "c")));
    assert!(written(&[&impact[..], &["--format", "text"]].concat(), "d.json").starts_with("block"));
}
