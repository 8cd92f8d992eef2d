//! The command line, run as a user runs it: what is written where, in which form, and the exit status.
//!
//! Texts for people are kept as snapshots (`INSTA_UPDATE=always cargo test --test command` renews them, then read the
//! difference); the JSON contract is checked field by field; refusals stand in tables. Numbers are checked elsewhere.

use assert_cmd::Command;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::io::Read;
use std::process::Stdio;

mod accuracy;
mod batch;
mod hostile_input;
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

/// What a run left behind.
struct Run {
    status: i32,
    stdout: String,
    stderr: String,
}

fn heelstrike(args: &[&str]) -> Run {
    heelstrike_reads(args, "")
}

fn heelstrike_reads(args: &[&str], stdin: impl Into<Vec<u8>>) -> Run {
    finished(command().args(args).write_stdin(stdin))
}

fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
    command
}

fn finished(command: &mut Command) -> Run {
    let output = command.output().expect("the command runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    Run { status: output.status.code().expect("no signal"), stdout: text(output.stdout), stderr: text(output.stderr) }
}

impl Run {
    /// The lines of standard output as JSON.
    fn lines(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect()
    }

    /// The only line of standard output as JSON.
    fn line(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{}{}", self.stdout, self.stderr);
        serde_json::from_str(&self.stdout).expect("JSON")
    }
}

/// The keys of an object in their order.
fn keys(object: &str) -> Vec<String> {
    struct Keys(Vec<String>);
    struct KeysVisitor;
    impl<'de> Visitor<'de> for KeysVisitor {
        type Value = Keys;
        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("an object")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Keys, A::Error> {
            let mut keys = Vec::new();
            while let Some((key, IgnoredAny)) = map.next_entry()? {
                keys.push(key);
            }
            Ok(Keys(keys))
        }
    }
    impl<'de> Deserialize<'de> for Keys {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_map(KeysVisitor)
        }
    }
    let Keys(keys) = serde_json::from_str(object).expect("an object");
    keys
}

/// The keys of a value; their order is lost.
fn key_set(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

fn sorted<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let mut names = names.to_vec();
    names.sort_unstable();
    names
}

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
    insta::assert_snapshot!(run.stdout, @r"
    contact problem (cone edge): tip touches the ground.

    Exactly one outcome.
      1  tip sticks, on a border   (margin 0)

    contact problem (family): tip touches the ground.

    Two outcomes are equally valid.
      1  tip sticks, on a border, the end of a family   (margin 0)
      2  tip slides forward, on a border, the end of a family
    ");
}

#[test]
fn a_verdict_without_outcome_is_explained() {
    // A point between floor and ceiling, of which the floor alone throws back.
    let walls = r#"{"id": "walls", "mass_matrix": [[1, 0], [0, 1]], "velocity": [0, -1], "friction": 0,
        "contact_jacobian": [[1, 0], [0, 1], [-1, 0], [0, -1]], "restitution": [0.5, 0], "names": ["floor", "ceiling"]}"#;
    let run = heelstrike_reads(&["solve", "-", "--format", "text", "--brief"], walls);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!(run.stdout, @"
    contact problem (walls): floor and ceiling touch the ground.

    No outcome is consistent: no impulse brings every contact to what is asked of it, since they depend on each other, or nothing that may move moves them.
    ");
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
    insta::assert_snapshot!(run.stdout, @r"
    ramone (alpha = 0.5, measured to three digits): left_foot and right_foot touch the ground.
    Kinetic energy before the impact: 0.996114 J.

    Exactly one outcome.
    Holds on the whole box of the uncertainty: yes.
      1  left_foot slides forward, right_foot sticks   (margin 0.000108945, index +1)
    ");
    let run = heelstrike_reads(&["impact", RAMONE, "-", "--brief"], badly_measured());
    let line = run.stdout.lines().find(|line| line.starts_with("Holds")).expect("a line about the box");
    insta::assert_snapshot!(line, @"Holds on the whole box of the uncertainty: no; a state in it (--format json) has: left_foot lifts off, right_foot sticks.");
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
    insta::assert_snapshot!(run.stdout, @r"
    block (leaves the ground, or jams): block touches the ground.
    Kinetic energy before the impact: 1.525 J.

    Three outcomes are equally valid.
      1  block lifts off   (margin 0.235294, index +1)
      2  block sticks   (margin 0.352941, index +1)
      3  block slides forward   (margin 0.470588, index -1)
    ");
}

#[test]
fn a_robot_in_the_air_keeps_its_velocity() {
    let state = r#"{"position": {"base": {"z": 1}}, "velocity": {"base": {"x": 2}}, "friction": 0.5}"#;
    let run = heelstrike_reads(&["impact", BLOCK, "-"], state);
    insta::assert_snapshot!(run.stdout, @r"
    block: nothing touches the ground.
    Kinetic energy before the impact: 2 J.

    No contact: the ground gives no impulse.

      velocity after
      x               m/s    2.00000
      z               m/s          0
      pitch           rad/s        0

    Note: nothing touches the ground: the lowest foot, block, is 1.0 m above it
    Left out (see `heelstrike inspect`): 1 shape out of reach, gravity, Coriolis forces, joint limits.
    ");
    let result = heelstrike_reads(&["impact", BLOCK, "-", "--format", "json"], state).line();
    assert_eq!(result["verdict"], "no_contact");
    assert_eq!(result["outcomes"][0]["modes"], serde_json::json!([]));
    assert_eq!(result["outcomes"][0]["base_velocity_after"]["x"], 2.0);
}

// The JSON contract.

/// Fields of every result of a robot, in the contract's order.
const RESULT: [&str; 11] = [
    "id",
    "verdict",
    "proven",
    "contacts",
    "outcomes",
    "kinetic_energy",
    "no_slip_consistent",
    "index_sum",
    "condition",
    "rank",
    "left_out",
];

#[test]
fn a_result_has_exactly_the_fields_of_the_contract_in_its_order() {
    let run = heelstrike(&["impact", RAMONE, "examples/ramone.json", "--format", "json"]);
    assert_eq!(keys(&run.stdout), RESULT);
    let result = run.line();
    let contact = &result["contacts"][0];
    assert_eq!(key_set(contact), sorted(&["link", "name", "point", "normal", "gap", "velocity_before"]));
    assert_eq!(
        key_set(&result["outcomes"][0]),
        sorted(&[
            "modes",
            "impulse",
            "velocity_after",
            "base_velocity_after",
            "joint_velocity_after",
            "energy_loss",
            "impulse_unique",
            "friction_needed",
            "index",
            "margin",
            "proven"
        ])
    );
    assert_eq!(key_set(&result["outcomes"][0]["base_velocity_after"]), sorted(&["x", "z", "pitch"]));
    assert_eq!(
        key_set(&result["outcomes"][0]["joint_velocity_after"]),
        sorted(&["left_hip", "left_knee", "right_hip", "right_knee"])
    );
}

#[test]
fn explain_and_matrices_add_their_fields_and_no_others() {
    let run = heelstrike(&["impact", RAMONE, "examples/ramone.json", "--format", "json", "--explain", "--matrices"]);
    assert_eq!(
        keys(&run.stdout),
        [
            "id",
            "verdict",
            "proven",
            "contacts",
            "outcomes",
            "rejected",
            "kinetic_energy",
            "no_slip_consistent",
            "explain",
            "index_sum",
            "condition",
            "rank",
            "left_out",
            "coordinates",
            "mass_matrix",
            "contact_jacobian",
            "delassus"
        ]
    );
    let result = run.line();
    let combinations = |list: &str| result[list].as_array().expect("a list").len();
    assert_eq!(combinations("outcomes") + combinations("rejected"), 16);
    assert_eq!(key_set(&result["rejected"][0]), sorted(&["modes", "because", "margin", "impulse", "velocity_after"]));
    assert_eq!(key_set(&result["explain"]), ["beta", "gamma", "region"]);
    assert_eq!(result["explain"]["region"].as_array().map(Vec::len), Some(2));
    assert_eq!(
        result["coordinates"],
        serde_json::json!(["x", "z", "pitch", "left_hip", "left_knee", "right_hip", "right_knee"])
    );
    let shape = |name: &str| (result[name].as_array().map(Vec::len), result[name][0].as_array().map(Vec::len));
    assert_eq!(shape("mass_matrix"), (Some(7), Some(7)));
    assert_eq!(shape("contact_jacobian"), (Some(4), Some(7)));
    assert_eq!(shape("delassus"), (Some(4), Some(4)));
}

#[test]
fn a_brief_result_has_modes_index_and_margin_alone() {
    let run = heelstrike(&["impact", WALKER, "examples/minimalistic.json", "--format", "json", "--brief"]);
    assert_eq!(keys(&run.stdout), ["id", "verdict", "proven", "outcomes"]);
    let result = run.line();
    assert_eq!(result["outcomes"].as_array().map(Vec::len), Some(3));
    assert_eq!(key_set(&result["outcomes"][0]), ["index", "margin", "modes"]);
    assert_eq!(result["outcomes"][1]["modes"], serde_json::json!(["stick", "stick"]));
}

#[test]
fn a_result_of_solve_lacks_the_robots_fields() {
    let run = heelstrike(&["solve", "examples/problems/rod.json", "--format", "json", "--explain", "--matrices"]);
    assert_eq!(
        keys(&run.stdout),
        [
            "id",
            "verdict",
            "proven",
            "contacts",
            "outcomes",
            "rejected",
            "no_slip_consistent",
            "explain",
            "index_sum",
            "condition",
            "rank",
            "delassus"
        ]
    );
    let result = run.line();
    assert_eq!(result["contacts"], serde_json::json!([{"name": "tip", "velocity_before": [0.5, -1.0]}]));
    assert!(result["outcomes"][0].get("base_velocity_after").is_none());
    assert!(result["outcomes"][0].get("joint_velocity_after").is_none());
    assert_eq!(result["delassus"], serde_json::json!([[2.0, 1.0], [1.0, 2.0]]));
}

#[test]
fn a_bolted_robot_has_no_base_velocity() {
    let state = r#"{"contacts": [{"link": "right_leg", "offset": [0, 0, -1]}], "velocity": {"joints": {"hip": 1}},
                    "friction": 1}"#;
    let run = heelstrike_reads(&["impact", WALKER, "-", "--base", "fixed", "--format", "json", "--matrices"], state);
    let result = run.line();
    assert!(result["outcomes"][0].get("base_velocity_after").is_none());
    assert_eq!(key_set(&result["outcomes"][0]["joint_velocity_after"]), ["hip"]);
    assert_eq!(result["coordinates"], serde_json::json!(["hip"]));
    assert!(result.get("id").is_none());
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
        assert_eq!((without.status, key_set(&without.line())), (1, vec!["error", "id", "line"]));
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
    assert!(from_file.stdout.contains("--friction"));
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
    let folder = std::env::temp_dir().join(format!("heelstrike-cli-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let written = |command: &[&str], name: &str| {
        let path = folder.join(name);
        std::fs::write(&path, "what was there before, and longer than nothing").expect("writable");
        let run = heelstrike(&[command, &["-o", path.to_str().expect("UTF-8")]].concat());
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
    std::fs::remove_dir_all(folder).expect("it was ours");
}
