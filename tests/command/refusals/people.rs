//! How refusals are shown to people, and what a bolted robot or an asymmetric matrix means for them.

use super::super::{RAMONE, WALKER, heelstrike_reads};

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
fn an_asymmetric_delassus_matrix_is_refused_and_other_fields_are_ignored() {
    let problem = |delassus: &str| {
        let text = format!(
            r#"{{"delassus": {delassus}, "velocity_before": [[0, -1]], "friction": 1, "source": {{"a": 1, "a": 2}}}}"#
        );
        heelstrike_reads(&["solve", "-", "--format", "json"], text).status
    };
    assert_eq!(problem("[[2, 1], [1, 2]]"), 0);
    assert_eq!(problem("[[2, 1], [0.9, 2]]"), 1);
    assert_eq!(problem("[[1, 2], [2, 1]]"), 1);
}

#[test]
fn a_refusal_shows_file_line_and_place_to_people() {
    let run = heelstrike_reads(&["impact", RAMONE, "-"], "{\"friction\": 1,\n \"stanse\": \"left_foot\"}");
    assert_eq!((run.status, run.stdout.as_str()), (1, ""));
    insta::assert_snapshot!("state", run.stderr);
    let robot = "<robot name=\"r\">\n  <link name=\"a\"><inertial><mass value=\"-1\"/></inertial></link>\n</robot>";
    insta::assert_snapshot!("robot", heelstrike_reads(&["inspect", "-"], robot).stderr);
    let cut = heelstrike_reads(&["solve", "-"], "{\"id\": 1,\n \"delassus\": [[2, 1],\n  [1, 2]");
    insta::assert_snapshot!("problem", cut.stderr);
    // Of a long line what is near the place; line and column are those of the file.
    let long = format!("{{\"id\": {}1, \"stanse\": 2}}", " ".repeat(200));
    insta::assert_snapshot!("long_line", heelstrike_reads(&["impact", RAMONE, "-"], long).stderr);
    // In a list the place is that in the whole file.
    let second = "[{\"friction\": 1},\n  {\"friction\": 1, \"held\": [\"left_knie\"]}]";
    insta::assert_snapshot!("list", heelstrike_reads(&["impact", RAMONE, "-", "--brief"], second).stderr);
}

#[test]
fn of_many_refusals_the_first_are_shown_with_their_lines_and_the_last_are_counted() {
    let run = heelstrike_reads(&["solve", "-"], "{\"friction\": 1}\n".repeat(50));
    assert_eq!(run.status, 1);
    let count = |what: &str| run.stderr.matches(what).count();
    assert_eq!((count("\"delassus\" is missing"), count(" --> <stdin>:"), count("error: <stdin>:")), (50, 10, 40));
    let more = heelstrike_reads(&["solve", "-"], "{\"friction\": 1} ".repeat(150));
    assert!(more.stderr.ends_with("\nnote: 50 more were refused\n"), "{}", more.stderr);
}
