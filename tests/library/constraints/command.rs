//! The option `--loops FILE`, and the fields of results about loops.

use crate::constraints::four_bar::{CRANKS, WIDTH, parallelogram, pin, state};
use crate::support::command::{Run, file, heelstrike_reads, place};
use serde_json::{Value, json};

/// Runs a command on the parallelogram.
fn run(command: &str, arguments: &[&str], input: &str) -> Run {
    let robot = file("robot.urdf", parallelogram(&CRANKS).urdf(0));
    heelstrike_reads(&[&[command, &robot, "-", "--base", "fixed"], arguments].concat(), input)
}

/// A file that pins the rear crank to the coupler.
fn loops() -> String {
    file("loops.json", json!([pin("rear", WIDTH)]).to_string())
}

fn open_state() -> Value {
    let mut state = state(&parallelogram(&CRANKS), 0.6, -2.0, json!([]));
    state.as_object_mut().expect("an object").remove("loops");
    state
}

#[test]
fn a_file_of_loops_serves_the_states_that_have_none() {
    let (mut own, open) = (open_state(), open_state());
    own["loops"] = json!([pin("rear", WIDTH)]);
    let mut free = open_state();
    free["loops"] = json!([]);
    let lines = |states: &[&Value]| states.iter().map(|state| format!("{state}\n")).collect::<String>();
    let alone = run("batch", &["--matrices"], &lines(&[&own, &open])).well();
    let with = run("batch", &["--matrices", "--loops", &loops()], &lines(&[&own, &open, &free])).well();
    // The answer without its first field, the number of its line.
    let answer = |line: &str| line.split_once(',').expect("an object").1.to_owned();
    let [alone, lines] = [&alone, &with].map(|run| run.stdout.lines().map(answer).collect::<Vec<_>>());
    assert_eq!(lines, [&*alone[0], &*alone[0], &*alone[1]]);
    let results = with.lines();
    assert_eq!(results[0]["outcomes"][0]["loop_impulse"].as_array().map(Vec::len), Some(1));
    assert!(results[2]["outcomes"][0].get("loop_impulse").is_none());
}

#[test]
fn a_table_takes_its_loops_from_the_file() {
    let table = "q_front,q_rear,q_coupler,v_front,v_rear,v_coupler,friction\n0.6,0.6,-0.6,-2,-2,2,0\n";
    let loops = loops();
    let contact = ["--contact", "coupler:0.4,0,-0.1", "--contact-tolerance", "10"];
    let arguments = [&["--input-format", "csv", "--loops", &loops], &contact[..]].concat();
    let result = run("batch", &arguments, table).well().line();
    let after = &result["outcomes"][0]["joint_velocity_after"];
    assert!(after["front"].as_f64().is_some_and(|rate| rate.abs() < 1e-14), "{after}");
    assert_eq!(result["outcomes"][0]["loop_impulse"].as_array().map(Vec::len), Some(1));
}

#[test]
fn people_read_the_impulses_of_loops() {
    insta::assert_snapshot!(run("impact", &["--loops", &loops()], &open_state().to_string()).well().stdout);
}

#[test]
fn files_that_hold_no_loops_are_refused() {
    let refused = |path: &str| {
        let run = run("impact", &["--loops", path], &open_state().to_string());
        assert_eq!(run.status, 1);
        run.stderr.replace(path, "loops.json")
    };
    let missing = refused(&place("missing.json"));
    assert!(missing.starts_with("error: loops.json: cannot be read: "), "{missing}");
    let broken =
        ["[\n {\"a\": {\"link\": \"raer\"}, \"b\": {\"link\": \"coupler\"}}\n]", "{\"loops\": []}", "[{\"a\": "];
    insta::assert_snapshot!(broken.map(|text| refused(&file("broken.json", text))).join("\n"));
}
