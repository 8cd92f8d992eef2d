//! Tables through the command: which form is chosen, and that a table is a stream like any other.

use super::*;

/// A header and many rows with a carried column, in which line breaks stand in quotes; every tenth row is broken.
pub(super) fn many() -> String {
    let row = |id: usize| match id {
        _ if id % 10 == 9 => format!("{id},oops,0.5,0,-1,broken\n"),
        _ if id % 7 == 3 => format!("{id},0,0.5,{},-1,\"two\nlines\"\n", id as f64 * 1.1e-3),
        _ => format!("{id},0,0.5,{},-1,one\n", id as f64 * -1.1e-3),
    };
    "id,q_base_x,q_base_z,v_base_x,v_base_z,note\n".to_owned() + &(0..500).map(row).collect::<String>()
}

#[test]
fn rows_are_answered_in_order_for_any_threads() {
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
    let rows = csv::Reader::from_reader(text.as_bytes()).into_records().map(|row| row.expect("a row"));
    let lines: Vec<usize> = rows.map(|row| row[1].parse().expect("a line")).collect();
    let breaks = |id: usize| (0..id).filter(|id| id % 7 == 3 && id % 10 != 9).count();
    assert_eq!(lines, (0..500).map(|id| 2 + id + breaks(id)).collect::<Vec<_>>());
    // The header and a row of two lines come before it.
    assert!(expected.stderr.contains(&format!("--> {table}:12:3\n")), "{}", expected.stderr);
    assert!(text.contains("line 12: q_base_x: "), "{text}");
}

#[test]
fn the_form_follows_the_ending_unless_it_is_given() {
    let rows = file("form.csv", "q_base_z,v_base_z,note\n0.5,-1,kept\n");
    let table = file("form-out.csv", "");
    let run = batch(&[&rows, "--friction", "1", "-o", &table], "");
    assert_eq!((run.status, run.stdout.len()), (0, 0), "{}", run.stderr);
    let written = read(&table);
    let header = written.lines().next().expect("a header");
    assert!(
        header.starts_with("id,line,verdict,outcome,") && header.ends_with(",note,border,family,families,error,notes"),
        "{header}"
    );
    let lines = batch(&[&rows, "--friction", "1"], "").lines();
    assert_eq!((&lines[0]["verdict"], &lines[0]["carried"]["note"]), (&json!("unique"), &json!("kept")));
    let given = batch(&[&rows, "--friction", "1", "-o", &table, "--output-format", "ndjson"], "");
    assert!(given.status == 0 && read(&table).starts_with('{'));
}

#[test]
fn options_that_need_a_table_are_refused_without_one() {
    for options in [&["--touchdowns"][..], &["--velocity", "central"], &["--at", "row"]] {
        batch(&[&["-"], options].concat(), strike(1, 0.0)).refusal(2);
    }
    // A table has no room for matrices.
    batch(&["-", "--output-format", "csv", "--matrices"], strike(1, 0.0)).refusal(2);
    for (options, table, words) in [
        (&["--touchdowns"][..], "q_base_z,v_base_z\n0.5,-1\n", "error: <stdin>:1:1: a column \"time\" is missing"),
        (&["--friction", "1"], "id,q_base_z,v_base_z\r1,0.5,-1\r", "a line break that is not one of this table"),
    ] {
        let stderr = batch(&[&["-", "--input-format", "csv"], options].concat(), table).refusal(1);
        assert!(stderr.contains(words), "{stderr}");
    }
}

#[test]
fn feet_at_rest_take_little_room_in_tables() {
    let walk = |format: &str| {
        heelstrike(&["batch", RAMONE, "examples/gait/ramone_walk.csv", "--friction", "0.6", "--output-format", format])
            .well()
            .stdout
    };
    let table = walk("csv");
    let cells: Vec<&str> = table.lines().skip(1).filter_map(|row| row.rsplit(',').next()).collect();
    assert_eq!(cells.len(), 102);
    for note in cells {
        assert!(note.contains("_foot is taken as exactly at rest") && !note.contains("m/s"), "{note}");
    }
    assert!(walk("ndjson").lines().all(|line| line.contains("at rest although it moves at ")));
}

#[test]
fn velocities_are_the_same_for_any_threads() {
    let rows: String = (0..200).map(|row| format!("{},{}\n", row as f64 * 0.01, 0.7 - row as f64 * 1e-3)).collect();
    let table = file("velocity.csv", format!("time,q_base_z\n{rows}"));
    let run = |threads: &str| batch(&[&table, "--velocity", "central", "--threads", threads], "").well();
    let alone = run("1");
    assert_eq!(alone.lines().len(), 200);
    assert!(run("4").stdout == alone.stdout);
}

#[test]
fn the_note_of_no_touchdown_says_what_would_count() {
    let still =
        "time,q_base_x,q_base_z,q_base_pitch,v_base_x,v_base_z,v_base_pitch\n0,0,0.5,0,0,0,0\n0.1,0,0.5,0,0,0,0\n";
    let note = |options: &[&str]| {
        let always = ["-", "--input-format", "csv", "--friction", "1", "--touchdowns"];
        batch(&[&always, options].concat(), still).refusal(0)
    };
    let expected = "no touchdown found: a foot must descend 0.0120 m or more, faster than 0.0500 m/s, to at most 0.0200 m above \
                    the ground (see --drop, --ground-height)\n";
    assert_eq!(note(&[]), expected);
    let expected = expected.replace("0.0200", "0.0300").replace("0.0120", "0.0250");
    assert_eq!(note(&["--drop", "0.025", "--ground-height", "0.03"]), expected);
}

#[test]
fn formulas_are_text_in_safe_tables() {
    let table = "id,q_base_z,v_base_x,v_base_z,friction,@note\n=1+1,0.5,-0.5,-1,0.8,+a\n-7,0.5,-0.5,-1,0.8,-1e3\n\
                 =x,0.5,oops,-1,0.8,\"-a,b\"\n";
    let arguments = ["-", "--input-format", "csv", "--output-format", "csv", "--refused", "ok"];
    let cells = |more: &[&str]| -> Vec<Vec<String>> {
        let run = batch(&[&arguments[..], more].concat(), table).well();
        let rows = csv::ReaderBuilder::new().has_headers(false).from_reader(run.stdout.as_bytes()).into_records();
        rows.map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect()
    };
    let (plain, safe) = (cells(&[]), cells(&["--csv-safe"]));
    let note = plain[0].iter().position(|name| name == "@note").expect("the copied column");
    assert_eq!([0, 1, 2, 3].map(|row| plain[row][note].as_str()), ["@note", "+a", "-1e3", "-a,b"]);
    assert_eq!([0, 1, 2, 3].map(|row| safe[row][note].as_str()), ["'@note", "'+a", "-1e3", "'-a,b"]);
    assert_eq!([1, 2, 3].map(|row| safe[row][0].as_str()), ["'=1+1", "-7", "'=x"]);
    // Nothing else differs, numbers below zero included.
    for (row, (plain, safe)) in plain.iter().zip(&safe).enumerate() {
        let differ = plain.iter().zip(safe).filter(|(plain, safe)| plain != safe);
        assert_eq!(differ.count(), [1, 2, 0, 2][row], "{safe:?}");
    }
    assert!(plain[1].iter().any(|cell| cell.starts_with("-0.")), "{plain:?}");
    for (id, cell) in [("\\t=1", "'\t=1,"), ("\\r=1", "\"'\r=1\",")] {
        let state = strike(1, 0.5).replace("\"id\":1", &format!("\"id\":\"{id}\""));
        let table = batch(&["-", "--friction", "1", "--output-format", "csv", "--csv-safe"], state).well().stdout;
        assert!(table.lines().nth(1).is_some_and(|row| row.starts_with(cell)), "{table:?}");
    }
    let refusal = batch(&["-", "--csv-safe"], strike(1, 0.5)).refusal(2);
    assert!(refusal.contains("--csv-safe: it is for CSV"), "{refusal}");
}
