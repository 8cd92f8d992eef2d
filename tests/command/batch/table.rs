//! Tables through the command: which form is chosen, and that a table is a stream like any other.

use super::*;

/// A header and many rows with a carried column, in which line breaks stand in quotes; every tenth row is broken.
fn many() -> String {
    let row = |id: usize| match id {
        _ if id % 10 == 9 => format!("{id},oops,0.5,0,-1,broken\n"),
        _ if id % 7 == 3 => format!("{id},0,0.5,{},-1,\"two\nlines\"\n", id as f64 * 1.1e-3),
        _ => format!("{id},0,0.5,{},-1,one\n", id as f64 * -1.1e-3),
    };
    "id,q_base_x,q_base_z,v_base_x,v_base_z,note\n".to_owned() + &(0..500).map(row).collect::<String>()
}

#[test]
fn rows_are_answered_in_order_whatever_the_threads_and_the_way_in() {
    let table = file("rows.csv", many());
    let run = |arguments: &[&str], stdin: &str| {
        batch(&[arguments, &["--friction", "0.5", "--output-format", "csv"]].concat(), stdin)
    };
    let expected = run(&[&table, "--threads", "1"], "");
    assert_eq!(expected.status, 1);
    assert!(run(&[&table, "--threads", "4"], "").stdout == expected.stdout);
    assert!(run(&["-", "--input-format", "csv"], &many()).stdout == expected.stdout);
    let text = expected.stdout;
    let ids: Vec<usize> = text.lines().filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    assert_eq!(ids, (0..500).collect::<Vec<_>>());
    // The header and a row of two lines come before it.
    assert!(expected.stderr.contains(&format!("--> {table}:12:3\n")), "{}", expected.stderr);
    assert!(text.contains("line 12: q_base_x: "), "{text}");
}

#[test]
fn the_form_follows_the_ending_unless_it_is_said() {
    let rows = file("form.csv", "q_base_z,v_base_z,note\n0.5,-1,kept\n");
    let table = file("form-out.csv", "");
    let run = batch(&[&rows, "--friction", "1", "-o", &table], "");
    assert_eq!((run.status, run.stdout.len()), (0, 0), "{}", run.stderr);
    let first = |path: &str| std::fs::read_to_string(path).expect("written").lines().next().map(str::to_owned);
    assert!(
        first(&table)
            .is_some_and(|line| line.starts_with("id,verdict,outcome,") && line.ends_with(",note,border,family,error"))
    );
    let lines = batch(&[&rows, "--friction", "1"], "").lines();
    assert_eq!((&lines[0]["verdict"], &lines[0]["carried"]["note"]), (&json!("unique"), &json!("kept")));
    let said = batch(&[&rows, "--friction", "1", "-o", &table, "--output-format", "ndjson"], "");
    assert!(said.status == 0 && first(&table).is_some_and(|line| line.starts_with('{')));
}

#[test]
fn what_needs_a_table_in_time_is_refused_without_one() {
    for arguments in [&["-", "--touchdowns"][..], &["-", "--velocity", "central"], &["-", "--at", "row"]] {
        let run = batch(arguments, strike(1, 0.0));
        assert_eq!((run.status, run.stdout.len()), (2, 0), "{arguments:?}");
    }
    let timeless = "q_base_z,v_base_z\n0.5,-1\n";
    let run = batch(&["-", "--input-format", "csv", "--touchdowns"], timeless);
    assert_eq!((run.status, run.stdout.len()), (1, 0));
    assert!(run.stderr.starts_with("error: <stdin>:1:1: a column \"time\" is missing"), "{}", run.stderr);
}

#[test]
fn velocities_over_time_are_the_same_for_any_number_of_threads() {
    let rows: String = (0..200).map(|row| format!("{},{}\n", row as f64 * 0.01, 0.7 - row as f64 * 1e-3)).collect();
    let table = file("velocity.csv", format!("time,q_base_z\n{rows}"));
    let run = |threads: &str| {
        let run = batch(&[&table, "--velocity", "central", "--threads", threads], "");
        assert_eq!(run.status, 0, "{}", run.stderr);
        run
    };
    let alone = run("1");
    assert_eq!(alone.lines().len(), 200);
    assert!(run("4").stdout == alone.stdout);
}

#[test]
fn a_table_whose_lines_end_otherwise_is_refused_and_not_lost() {
    let table = "id,q_base_z,v_base_z\r1,0.5,-1\r2,0.5,-1\r";
    let run = batch(&["-", "--input-format", "csv", "--friction", "1"], table);
    assert_eq!((run.status, run.stdout.len()), (1, 0));
    assert!(run.stderr.contains("a line break that is not one of this table"), "{}", run.stderr);
}

#[test]
fn a_recording_without_a_touchdown_says_what_would_count() {
    let still = "time,q_base_z,v_base_z\n0,0.5,0\n0.1,0.5,0\n";
    let run = |options: &[&str]| {
        let always = ["-", "--input-format", "csv", "--friction", "1", "--touchdowns"];
        let run = batch(&[&always, options].concat(), still);
        assert_eq!((run.status, run.stdout.len()), (0, 0));
        run.stderr
    };
    let told = "no touchdown found: a foot must descend 0.0120 m or more, faster than 0.0500 m/s, to at most 0.0200 m above \
                the ground (see --drop, --ground-height)\n";
    assert_eq!(run(&[]), told);
    let told = told.replace("0.0200", "0.0300").replace("0.0120", "0.0250");
    assert_eq!(run(&["--drop", "0.025", "--ground-height", "0.03"]), told);
}

#[test]
fn a_table_has_no_room_for_matrices() {
    let arguments = ["-", "--output-format", "csv", "--matrices"];
    let run = batch(&arguments, strike(1, 0.0));
    assert_eq!((run.status, run.stdout.len()), (2, 0));
}
