//! The command line as a user runs it: which output goes where, in which format, and the exit status.
//!
//! Snapshots keep the text for people word for word: `INSTA_UPDATE=always cargo test --test command` renews them, then
//! read the difference. Snapshots of JSON keep its fields; tables of cases check refusals. Other test crates check
//! numbers.

use serde_json::{Value, json};
use std::fs;
use support::command::{Run, command, file, finished, heelstrike, heelstrike_reads, place, read};

mod accuracy;
mod batch;
mod budget;
mod documentation;
mod inspect;
mod manners;
mod meshes;
mod names;
mod page;
mod picture;
mod refusals;
mod schema;
#[path = "../support/mod.rs"]
mod support;

const RAMONE: &str = "urdf/ramone.urdf";
const WALKER: &str = "urdf/minimalistic.urdf";
const BLOCK: &str = "urdf/block.urdf";

/// The only line of JSON from a run, which must succeed.
#[track_caller]
fn result(arguments: &[&str], stdin: &str) -> Value {
    heelstrike_reads(&[arguments, &["--format", "json"]].concat(), stdin).well().line()
}

fn parsed(json: &str) -> Value {
    serde_json::from_str(json).unwrap_or_else(|error| panic!("{error}: {json}"))
}

#[track_caller]
fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

/// The field of each entry of a list.
fn each(list: &Value, field: &str) -> Vec<Value> {
    self::list(list).iter().map(|entry| entry[field].clone()).collect()
}

/// A study of the minimalistic walker, which turns about its trailing left foot. The parameter alpha is half the angle
/// between its legs.
fn walker(parameters: Value) -> Value {
    json!({
        "parameters": parameters,
        "state": {
            "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
            "velocity": {"base": {"pitch": -1.0}},
            "stance": "left_leg",
            "friction": "infinite"
        }
    })
}

// Text for people.

#[test]
fn texts_are_kept_word_for_word() {
    let problems = r#"
        {"id": "cone edge", "delassus": [[1, 0], [0, 1]], "velocity_before": [[-0.5, -1]], "friction": 0.5, "names": ["tip"]}
        {"id": "family", "delassus": [[2, 1], [1, 2]], "velocity_before": [[1, 0]], "friction": 2, "names": ["tip"]}"#;
    // A point mass that touches floor and ceiling at once; only the floor has restitution.
    let walls = r#"{"id": "walls", "mass_matrix": [[1, 0], [0, 1]], "velocity": [0, -1], "friction": 0,
        "contact_jacobian": [[1, 0], [0, 1], [-1, 0], [0, -1]], "restitution": [0.5, 0], "names": ["floor", "ceiling"]}"#;
    for (name, arguments, stdin) in [
        ("impact_ramone", &["impact", RAMONE, "examples/ramone.json"][..], ""),
        (
            "impact_minimalistic_explained",
            &["impact", WALKER, "examples/minimalistic.json", "--explain", "--matrices"],
            "",
        ),
        ("solve_borders", &["solve", "-", "--format", "text"], problems),
        ("solve_borders_brief", &["solve", "-", "--format", "text", "--brief"], problems),
        ("solve_without_outcome", &["solve", "-", "--format", "text", "--brief"], walls),
        ("solve_painleve_rod", &["solve", "examples/problems/painleve_rod.json"], ""),
        ("impact_brief", &["impact", BLOCK, "examples/block_jams.json", "--brief"], ""),
        ("impact_in_the_air", &["impact", BLOCK, "-"], IN_THE_AIR),
    ] {
        insta::assert_snapshot!(name, heelstrike_reads(arguments, stdin).text());
    }
    let run = heelstrike_reads(&["impact", RAMONE, "-", "--brief"], badly_measured());
    let line = run.stdout.lines().find(|line| line.starts_with("Holds")).expect("a line about the box");
    insta::assert_snapshot!("impact_badly_measured", line);
}

const IN_THE_AIR: &str = r#"{"position": {"base": {"z": 1}}, "velocity": {"base": {"x": 2}}, "friction": 0.5}"#;

/// `examples/ramone_measured.json` with ten times the half-widths of uncertainty.
fn badly_measured() -> String {
    read("examples/ramone_measured.json").replace("1e-3", "1e-2")
}

#[test]
fn many_rejections_are_listed_nearest_first() {
    // Three uncoupled contacts (G is the identity), and three at one point, where some combinations have no margin.
    let rows = |row: [i32; 2]| (0..3).flat_map(|_| [[row[0], 0], [0, row[1]]]).collect::<Vec<_>>();
    let unit = |at: usize| (0..6).map(|other| i32::from(at == other)).collect::<Vec<_>>();
    let alone = json!({"delassus": (0..6).map(unit).collect::<Vec<_>>(), "friction": 0.8,
        "velocity_before": [[0.5, -1], [-0.7, -0.4], [0.1, -0.2]]});
    let together = json!({"mass_matrix": [[1, 0], [0, 2]], "velocity": [1, -1], "friction": 0.3,
        "contact_jacobian": rows([1, 1])});
    for problem in [alone, together] {
        let solve = |format| heelstrike_reads(&["solve", "-", "--explain", "--format", format], problem.to_string());
        let (text, answer) = (solve("text").text(), solve("json").line());
        let (listed, more) =
            text.split_once("fails, because\n").and_then(|(_, rest)| rest.split_once("  ... ")).expect("a table");
        let margins: Vec<f64> = listed
            .lines()
            .map(|line| line.split_whitespace().nth(3).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NEG_INFINITY))
            .collect();
        assert_eq!(margins.len(), 20, "{text}");
        assert!(margins.is_sorted_by(|near, far| near >= far), "{text}");
        let all = list(&answer["rejected"]);
        let nearest = all.iter().filter_map(|rejection| rejection["margin"].as_f64()).fold(f64::NEG_INFINITY, f64::max);
        assert!((nearest - margins[0]).abs() < 1e-5 && all.len() > 40, "{nearest} {text}");
        assert!(more.starts_with(&format!("{} more, none closer to zero", all.len() - 20)), "{more}");
        // The table of what each combination would have been has a header and the same 20 rows.
        let after = more.split("what each would have been").nth(1).and_then(|rest| rest.split("\n\n").nth(1));
        assert_eq!(after.map(|table| table.lines().count()), Some(1 + 20), "{text}");
    }
}

#[test]
fn a_counterexample_can_be_fed_back() {
    let impact = |state: &str| heelstrike_reads(&["impact", RAMONE, "-", "--format", "json"], state).line();
    let first = impact(&badly_measured());
    assert_eq!(first["holds"], false);
    // A table has no column for the counterexample, so the summary counts it.
    let lines = format!("{}\n", parsed(&badly_measured())).repeat(2);
    let summary = heelstrike_reads(&["batch", RAMONE, "-", "--output-format", "csv"], lines).well().stderr;
    assert!(summary.contains("outcomes that do not hold within the state's uncertainty: 2\n"), "{summary}");
    let found = &first["counterexample"];
    let second = impact(&found["state"].to_string());
    assert_eq!((&second["verdict"], &second["proven"]), (&found["verdict"], &json!(true)));
    let modes = each(&second["outcomes"], "modes");
    assert_eq!(modes, list(&found["outcomes"]));
    assert_ne!(modes, each(&first["outcomes"], "modes"));
}

// The JSON contract.

/// The JSON with every number replaced by 0, so that only fields, their order and their nesting remain.
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
        let run = heelstrike_reads(&[arguments, &["--format", "json"]].concat(), stdin).well();
        insta::assert_snapshot!(name, shape(&run.stdout));
    }
}

#[test]
fn a_problem_s_matrices_are_written_as_given() {
    let result = result(&["solve", "examples/problems/rod.json", "--matrices"], "");
    assert_eq!(result["contacts"], json!([{"name": "tip", "velocity_before": [0.5, -1.0]}]));
    assert_eq!(result["delassus"], json!([[2.0, 1.0], [1.0, 2.0]]));
}

// Commands and options.

#[test]
fn every_example_is_answered() {
    for (command, examples) in [
        (&["impact", RAMONE][..], &["ramone", "ramone_measured", "ramone_measured_by_name"][..]),
        (&["impact", "urdf/ramone_paper.urdf"], &["ramone_paper"]),
        (&["impact", WALKER], &["minimalistic"]),
        (&["impact", "urdf/pdw.urdf"], &["pdw"]),
        (&["impact", BLOCK], &["block", "block_jams"]),
        (&["solve"], &["problems/rod", "problems/painleve_rod", "problems/block_from_dynamics"]),
    ] {
        for example in examples {
            heelstrike(&[command, &[&format!("examples/{example}.json")]].concat()).text();
        }
    }
    let run = heelstrike(&["batch", WALKER, "examples/keyframes.ndjson", "--friction", "infinite"]).well();
    assert_eq!(each(&run.lines().into(), "verdict"), ["unique", "unique", "unique", "ambiguous"]);
    assert!(run.stderr.starts_with("4 states: 3 unique, 1 ambiguous\n"), "{}", run.stderr);
}

#[test]
fn too_many_contacts_have_matrices_and_an_error() {
    let contacts: Vec<Value> = (0..17).map(|k| json!({"link": "block", "offset": [k, 0, 0]})).collect();
    let state = json!({"id": 1, "friction": 1, "contacts": contacts}).to_string();
    for command in ["impact", "batch"] {
        let arguments = [command, BLOCK, "-", "--format", "json", "--matrices"];
        let run = heelstrike_reads(&arguments, state.as_str());
        let result = run.line();
        assert_eq!((run.status, list(&result["delassus"]).len()), (1, 34));
        assert!(result["error"]["message"].as_str().is_some_and(|message| message.starts_with("17 contacts")));
        assert!(result.get("verdict").is_none() && result.get("outcomes").is_none());
        assert!(run.stderr.starts_with("error: ") && run.stderr.contains("17 contacts"), "{}", run.stderr);
        let without = heelstrike_reads(&arguments[..5], state.as_str());
        let fields = without.line();
        let fields: Vec<&str> = fields.as_object().expect("an object").keys().map(String::as_str).collect();
        assert_eq!((without.status, fields), (1, vec!["error", "id", "line"]));
    }
}

#[test]
fn bytes_that_are_no_text_are_refused_in_their_place() {
    let run = heelstrike_reads(&["batch", BLOCK, "-"], b"{\"id\": \"\xff\"}\n{\"friction\": 1}\n");
    assert_eq!(run.status, 1);
    let answers = run.lines();
    let hint = "save it as UTF-8; iconv -f LATIN1 -t UTF-8 converts what older editors wrote";
    assert_eq!(answers[0], json!({"line": 1, "error": {"message": "the text is not UTF-8", "hint": hint}}));
    assert_eq!(answers[1]["verdict"], "no_impact");
}

#[test]
fn a_stream_of_problems_is_answered_in_order() {
    let good = r#"{"id": "a", "delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 1}"#;
    let bad = r#"{"id": "b", "delassus": [[2, 1], [1, 2]], "friction": 1}"#;
    let solve = |stream: String| heelstrike_reads(&["solve", "-", "--format", "json"], stream);
    let run = solve(format!("{good} {good}\n{bad}\n{{\"id\": \"c\", oops\n{good}\n"));
    assert_eq!(run.status, 1);
    let answers = json!(run.lines());
    assert_eq!(each(&answers, "id"), ["a", "a", "b", "c", "a"]);
    assert_eq!(json!(each(&answers, "line")), json!([null, null, 2, 3, null]));
    assert_eq!(answers[2]["error"]["message"], "\"velocity_before\" is missing");

    assert_eq!(solve(format!("[{good},\n{good}]")).well().lines().len(), 2);
}

#[test]
fn friction_of_the_command_line_is_a_default() {
    let silent = r#"{"velocity": {"base": {"x": 1, "z": -1}}}"#;
    let named = r#"{"velocity": {"base": {"x": 1, "z": -1}}, "friction": {"block": "infinite"}}"#;
    for (state, friction, mode) in [(silent, "0", "slide+"), (silent, "infinite", "stick"), (named, "0", "stick")] {
        let result = result(&["impact", BLOCK, "-", "--friction", friction], state);
        assert_eq!(result["outcomes"][0]["modes"][0], mode, "{state}, {friction}");
    }
}

#[test]
fn a_foot_of_the_command_line_touches_by_its_height() {
    let foot = ["--contact", "block:0.5,0,-0.7:0.3"];
    for (height, contacts) in [(1.0, 1), (1.1, 0)] {
        let state = json!({"position": {"base": {"z": height}}, "friction": 1}).to_string();
        let result = result(&["impact", BLOCK, "-", foot[0], foot[1]], &state);
        assert_eq!(list(&result["contacts"]).len(), contacts, "{height}");
    }
    let state = r#"{"friction": 1, "contacts": [{"link": "block", "offset": [0, 0, -1]}]}"#;
    let study = format!(r#"{{"parameters": {{"v": {{"from": 0, "to": 1, "steps": 2}}}}, "state": {state}}}"#);
    for (command, input, what) in [("impact", state, "state"), ("batch", state, "state"), ("sweep", &study, "study")] {
        let noted = heelstrike_reads(&[command, BLOCK, "-", foot[0], foot[1]], input).well().stderr;
        let words = format!("feet given by --contact are not used where a {what} names its contacts, as one does here");
        assert!(noted.contains(&words), "{command}: {noted}");
    }
    assert_eq!(result(&["inspect", BLOCK, foot[0], foot[1]], "")["feet"][1]["centre"], json!([0.5, -0.7]));
}

#[test]
fn the_outputs_ending_determines_its_form() {
    let impact = &["impact", BLOCK, "examples/block.json"][..];
    let as_text = &[impact, &["--format", "text"]].concat();
    let solve = &["solve", "examples/problems/rod.json"];
    let batch = &["batch", WALKER, "examples/keyframes.ndjson", "--friction", "1"];
    let sweep = &["sweep", WALKER, "examples/paper/figure_7.json"];
    for (command, name, [start, end]) in [
        (impact, "a.json", ["{\"", "}\n"]),
        (impact, "a.ndjson", ["{\"", "}\n"]),
        (impact, "a.txt", ["block", ""]),
        (&["inspect", BLOCK], "A.JSON", ["{\"", "}\n"]),
        (solve, "b", ["{\"", "}\n"]),
        (solve, "b.dat", ["{\"", "}\n"]),
        (batch, "c", ["{\"", "}\n"]),
        (as_text, "d.json", ["block", ""]),
        (sweep, "e.json", ["{\"", "}\n"]),
        (sweep, "e.ndjson", ["{\"", "}\n"]),
        (sweep, "e.csv", ["id,verdict,", "\n"]),
        (sweep, "e.txt", ["minimalistic against alpha", "\n"]),
        (sweep, "e", ["minimalistic against alpha", "\n"]),
    ] {
        let path = file(name, "what was there before, and longer than nothing");
        let run = heelstrike(&[command, &["-o", &path]].concat()).well();
        let written = read(&path);
        assert!(run.stdout.is_empty() && written.starts_with(start) && written.ends_with(end), "{name}: {written}");
    }
}
