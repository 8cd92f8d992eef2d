//! Remedies that lead to the right input, not back to the same refusal or to a wrong answer.

use crate::{RAMONE, heelstrike, heelstrike_reads};

/// Runs `heelstrike` with the arguments and checks that it refuses the input with these words.
#[track_caller]
fn assert_refused(arguments: &[&str], input: &str, words: &[&str]) {
    let run = heelstrike_reads(arguments, input);
    let output = format!("{}{}", run.stdout.replace("\\\"", "\""), run.stderr);
    assert!(run.status != 0 && words.iter().all(|words| output.contains(words)), "{input}: {output}");
}

/// As [`assert_refused`], of a table.
#[track_caller]
fn assert_table_refused(options: &[&str], table: &str, words: &[&str]) {
    let arguments = ["batch", RAMONE, "-", "--input-format", "csv", "--friction", "0.8", "--place", "lowest"];
    assert_refused(&[&arguments, options].concat(), table, words);
}

#[test]
fn torques_are_refused_where_contacts_start() {
    for option in ["--forces", "--next"] {
        let table = "q_base_z,v_base_z,tau_left_hip\n0.6,-0.5,50\n";
        let words = ["tau_left_hip is a torque, and tables have no column for it"];
        assert_table_refused(&[option], table, &words);
    }
}

#[test]
fn nested_states_have_no_columns() {
    let walk = "examples/gait/ramone_walk.ndjson";
    for options in [&["--touchdowns"][..], &["--velocity", "central"], &["--foreign", "id"]] {
        let refused = heelstrike(&[&["batch", RAMONE, walk, "--friction", "0.8"], options].concat()).refusal(2);
        let hint = "hint: nested states have no columns: give a flat object with keys q_..., v_... on each line";
        assert!(refused.contains(hint), "{refused}");
    }
    let mixed = "{\"q_base_z\": 0.6, \"v_base_z\": -1}\n{\"friction\": 1, \"position\": {}}\n";
    let words = ["position", "this line is a nested state, and the first line is flat", "write all states in one form"];
    assert_refused(&["batch", RAMONE, "-", "--friction", "0.8"], mixed, &words);
}

#[test]
fn tables_without_a_header_are_refused_as_such() {
    let hint = "hint: the first line must name the columns, of q_base_x, ";
    assert_table_refused(&[], "0.6,-1,-1\n0.61,-1,0.2\n", &[hint]);
    assert_table_refused(&[], "k,0.6,-1,-1\n", &[hint]);
    assert_table_refused(&[], "q_base_z,v_base_z,1,1\n0.6,-1,2,3\n", &["column \"1\" is given twice"]);
}

#[test]
fn columns_in_other_units_are_not_renamed() {
    let hint = "numbers are in m, radians and s: convert the column";
    for name in ["q_base_z (mm)", "q_base_z[cm]", "v_base_z (mm/s)", "q_base_z_mm", "v_base_z_cm_s", "v_left_hip_rpm"] {
        assert_table_refused(&[], &format!("{name},v_base_x,q_base_x\n0.6,-1,0\n"), &[hint]);
    }
    for name in ["v_left_hip_deg_s", "v_left_hip (deg/s)", "v_left_hip (rpm)", "q_left_hip [deg]", "base_z (mm)"] {
        assert_table_refused(&[], &format!("{name},v_base_x,q_base_x\n0.6,-1,0\n"), &[hint]);
    }
    // Right units are only superfluous.
    assert_table_refused(&[], "q_base_z (m),v_base_z\n0.6,-1\n", &["hint: did you mean q_base_z?"]);
}

#[test]
fn contact_problems_name_what_was_meant() {
    let problem = r#"{"delassus": [[2, 1], [1, 2]], "velocity": [0.5, -1], "friction": 0.5}"#;
    let words = ["\"velocity_before\" is missing", "did you mean velocity_before, not velocity? it has [tangential"];
    assert_refused(&["solve", "-"], problem, &words);
    let percent = r#"{"delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 80}"#;
    let note = "the coefficient of friction is 80: was it meant in percent or degrees?";
    let output = heelstrike_reads(&["solve", "-"], percent).well();
    assert!(output.stdout.contains(note), "{}", output.stdout);
}

#[test]
fn states_get_remedies_that_were_not_followed_yet() {
    let held = r#"{"position": {"joints": {"left_hip": 0.4}}, "friction": 0.8, "place": "lowest"}"#;
    let words = ["frozen at 0.4 as asked", "hint: leave it out of the state: --hold has posed it"];
    assert_refused(&["impact", RAMONE, "-", "--hold", "left_hip=0.4"], held, &words);
    let contact =
        r#"{"friction": 0.8, "stance": "left_foot", "contacts": [{"link": "right_foot", "radius": 0.02815}]}"#;
    let words = ["one of the named contacts, on link \"left_foot\" is missing", "hint: they replace all feet"];
    assert_refused(&["impact", RAMONE, "-"], contact, &words);
    for world in [r#""world""#, r#"{"link": "world"}"#] {
        let state = format!(r#"{{"friction": 1, "virtual": [{{"a": {{"link": "torso"}}, "b": {world}}}]}}"#);
        let hint = r#"hint: name a link as {"link": NAME}, or give a place as {"world": [0, 0.5]}"#;
        assert_refused(&["forces", RAMONE, "-"], &state, &[hint]);
    }
}
