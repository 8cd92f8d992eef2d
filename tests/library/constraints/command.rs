//! `--loops FILE` and the fields of results.

use crate::constraints::four_bar::{WIDTH, parallelogram, pin, state};
use assert_cmd::Command;
use serde_json::{Value, json};
use std::path::PathBuf;

/// A folder with the parallelogram's URDF, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = Self(std::env::temp_dir().join(format!("heelstrike-{name}-{}", std::process::id())));
        std::fs::create_dir_all(&folder.0).expect("a folder");
        folder.write("robot.urdf", &parallelogram(&[("front", 0.0), ("rear", WIDTH)]).urdf());
        folder
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).expect("a file");
    }

    /// Exit status, standard output and standard error of a command in the folder.
    fn run(&self, arguments: &[&str], input: &str) -> (Option<i32>, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
        let output = command.current_dir(&self.0).args(arguments).write_stdin(input).output().expect("it starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        (output.status.code(), text(output.stdout), text(output.stderr))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn open_state() -> Value {
    let mut state = state(&parallelogram(&[("front", 0.0), ("rear", WIDTH)]), 0.6, -2.0, json!([]));
    state.as_object_mut().expect("an object").remove("loops");
    state
}

#[test]
fn a_file_of_loops_serves_the_states_that_have_none() {
    let folder = Folder::new("loops");
    folder.write("loops.json", &json!([pin("rear", WIDTH)]).to_string());
    let (mut own, open) = (open_state(), open_state());
    own["loops"] = json!([pin("rear", WIDTH)]);
    let mut free = open_state();
    free["loops"] = json!([]);
    let lines = |states: &[&Value]| states.iter().map(|state| format!("{state}\n")).collect::<String>();
    let batch = ["batch", "robot.urdf", "-", "--base", "fixed", "--matrices"];
    let (status, alone, _) = folder.run(&batch, &lines(&[&own, &open]));
    assert_eq!(status, Some(0));
    let (status, with, _) =
        folder.run(&[&batch[..], &["--loops", "loops.json"]].concat(), &lines(&[&own, &open, &free]));
    assert_eq!(status, Some(0));
    let (alone, with): (Vec<&str>, Vec<&str>) = (alone.lines().collect(), with.lines().collect());
    assert_eq!([with[0], with[1], with[2]], [alone[0], alone[0], alone[1]]);
    let result: Value = serde_json::from_str(with[0]).expect("JSON");
    assert_eq!(result["outcomes"][0]["loop_impulse"].as_array().map(Vec::len), Some(1));
    assert!(serde_json::from_str::<Value>(with[2]).expect("JSON")["outcomes"][0].get("loop_impulse").is_none());
}

#[test]
fn a_table_takes_its_loops_from_the_file() {
    let folder = Folder::new("loops-table");
    folder.write("loops.json", &json!([pin("rear", WIDTH)]).to_string());
    let table = "q_front,q_rear,q_coupler,v_front,v_rear,v_coupler,friction\n0.6,0.6,-0.6,-2,-2,2,0\n";
    let arguments = ["batch", "robot.urdf", "-", "--base", "fixed", "--input-format", "csv", "--loops", "loops.json"];
    let contact = ["--contact", "coupler:0.4,0,-0.1", "--contact-tolerance", "10"];
    let (status, out, err) = folder.run(&[&arguments[..], &contact].concat(), table);
    assert_eq!(status, Some(0), "{err}");
    let result: Value = serde_json::from_str(&out).expect("JSON");
    let after = &result["outcomes"][0]["joint_velocity_after"];
    assert!(after["front"].as_f64().is_some_and(|rate| rate.abs() < 1e-14), "{after}");
    assert_eq!(result["outcomes"][0]["loop_impulse"].as_array().map(Vec::len), Some(1));
}

#[test]
fn people_read_the_impulses_of_loops() {
    let folder = Folder::new("loops-text");
    folder.write("loops.json", &json!([pin("rear", WIDTH)]).to_string());
    let arguments = ["impact", "robot.urdf", "-", "--base", "fixed", "--loops", "loops.json"];
    let (status, out, err) = folder.run(&arguments, &open_state().to_string());
    assert_eq!(status, Some(0), "{err}");
    insta::assert_snapshot!(out);
}

#[test]
fn files_that_hold_no_loops_are_refused() {
    let folder = Folder::new("loops-refused");
    let arguments = ["impact", "robot.urdf", "-", "--base", "fixed", "--loops", "loops.json"];
    let refused = |text: Option<&str>| {
        if let Some(text) = text {
            folder.write("loops.json", text);
        }
        let (status, _, err) = folder.run(&arguments, &open_state().to_string());
        assert_eq!(status, Some(1));
        err
    };
    let missing = refused(None);
    assert!(missing.starts_with("error: loops.json: cannot be read: "), "{missing}");
    insta::assert_snapshot!(
        [
            refused(Some("[\n {\"a\": {\"link\": \"raer\"}, \"b\": {\"link\": \"coupler\"}}\n]")),
            refused(Some("{\"loops\": []}")),
            refused(Some("[{\"a\": ")),
        ]
        .join("\n")
    );
}
