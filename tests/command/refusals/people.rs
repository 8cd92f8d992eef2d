//! How refusals look in a terminal, and fields that a bolted robot cannot have.

use crate::{RAMONE, WALKER, heelstrike_reads};

#[test]
fn what_a_bolted_robot_cannot_have_is_refused() {
    for (state, place) in [
        (r#"{"position": {"base": {"pitch": 0}}}"#, "position.base"),
        (r#"{"velocity": {"base": {}}}"#, "velocity.base"),
        (r#"{"stance": "right_leg"}"#, "stance"),
    ] {
        let run = heelstrike_reads(&["batch", WALKER, "-", "--base", "fixed"], state);
        assert_eq!((run.status, run.line()["error"]["place"].as_str()), (1, Some(place)), "{state}");
    }
}

#[test]
fn the_file_is_named_also_where_its_text_is_right() {
    let deep = r#"{"friction": 1, "position": {"base": {"z": -5}}}"#;
    let study = format!(r#"{{"parameters": {{"a": {{"from": 0, "to": 1, "steps": 3}}}}, "state": {deep}}}"#);
    for (command, input) in [("accuracy", deep), ("impact", deep), ("sweep", &study)] {
        let stderr = heelstrike_reads(&[command, RAMONE, "-"], input).stderr;
        assert!(stderr.contains("<stdin>"), "{command}: {stderr}");
    }
}

#[test]
fn a_refusal_shows_people_file_line_and_place() {
    // Only the part of a long line near the place is shown; line and column refer to the file.
    let long = &format!("{{\"id\": {}1, \"stanse\": 2}}", " ".repeat(200));
    for (name, arguments, stdin) in [
        ("state", &["impact", RAMONE, "-"][..], "{\"friction\": 1,\n \"stanse\": \"left_foot\"}"),
        (
            "robot",
            &["inspect", "-"],
            "<robot name=\"r\">\n  <link name=\"a\"><inertial><mass value=\"-1\"/></inertial></link>\n</robot>",
        ),
        ("problem", &["solve", "-"], "{\"id\": 1,\n \"delassus\": [[2, 1],\n  [1, 2]"),
        ("long_line", &["impact", RAMONE, "-"], long),
    ] {
        insta::assert_snapshot!(name, heelstrike_reads(arguments, stdin).refusal(1));
    }
    // For an entry of a list, line and column refer to the whole file as well.
    let second = "[{\"friction\": 1},\n  {\"friction\": 1, \"held\": [\"left_knie\"]}]";
    insta::assert_snapshot!("list", heelstrike_reads(&["impact", RAMONE, "-", "--brief"], second).stderr);
}

#[test]
fn only_the_first_of_many_refusals_show_their_lines() {
    let run = heelstrike_reads(&["solve", "-"], "{\"friction\": 1}\n".repeat(50));
    assert_eq!(run.status, 1);
    let count = |what: &str| run.stderr.matches(what).count();
    assert_eq!((count("\"delassus\" is missing"), count(" --> <stdin>:"), count("error: <stdin>:")), (50, 10, 40));
    let more = heelstrike_reads(&["solve", "-"], "{\"friction\": 1} ".repeat(150));
    assert!(more.stderr.ends_with("\nnote: 50 more were refused\n"), "{}", more.stderr);
}
