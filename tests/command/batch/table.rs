//! Tables through the command: which format is chosen, and that a table is a stream like any other.

use super::*;

/// A header and 500 rows with a copied column that has line breaks in quotes; every tenth row is broken.
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
    // The tenth row is on line 12, after the header and a row of two lines.
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
    for other in [&["--place", "lowest"][..], &["--forces"]] {
        for options in [&["--drop", "0.1"][..], &["--ground-height", "0.1"], &["--simulated"], &["--at", "row"]] {
            batch(&[&["-"], other, options].concat(), strike(1, 0.0)).refusal(2);
        }
    }
    // A table has no room for matrices.
    batch(&["-", "--output-format", "csv", "--matrices"], strike(1, 0.0)).refusal(2);
    let study = "examples/paper/figure_7.json";
    heelstrike(&["sweep", WALKER, study, "--format", "csv", "--explain"]).refusal_with(2, "no room for --explain");
    for option in ["--brief", "--explain", "--matrices"] {
        heelstrike(&["sweep", WALKER, study, option]).refusal_with(2, "hint: write JSON: --format json");
    }
    for (options, table, words) in [
        (&["--touchdowns"][..], "q_base_z,v_base_z\n0.5,-1\n", "error: <stdin>:1:1: a column \"time\" is missing"),
        (
            &["--touchdowns"],
            "time,q_base_x,v_base_z\n0,0,-1\n",
            "error: <stdin>: the base's height, q_base_z, is missing",
        ),
        (&["--friction", "1"], "id,q_base_z,v_base_z\r1,0.5,-1\r", "a line break that is not one of this table"),
    ] {
        batch(&[&["-", "--input-format", "csv"], options].concat(), table).refusal_with(1, words);
    }
}

#[test]
fn joints_alone_are_answered_where_a_foot_is_placed() {
    let table = "time,q_left_hip,q_right_hip\n0,0.2,-0.2\n0.1,0.3,-0.3\n0.2,0.4,-0.4\n";
    let options = ["batch", RAMONE, "-", "--input-format", "csv", "--velocity", "central", "--friction", "1"];
    let placed = heelstrike_reads(&[&options[..], &["--place", "lowest"]].concat(), table).well();
    assert!(placed.lines().iter().all(|line| line["contacts"][0]["name"].is_string()), "{}", placed.stdout);
    // Touchdowns need the base's height, which this table lacks.
    heelstrike_reads(&[&options[..], &["--touchdowns"]].concat(), table)
        .refusal_with(1, "without the base's, answer the rows themselves, by --place lowest or a column stance");
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
    assert!(walk("ndjson").lines().all(|line| line.contains("is taken as exactly at rest")));
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
fn torques_in_a_table_of_forces_are_refused() {
    let table = "id,q_base_z,v_base_z,knee_torque,torque_left_hip,left_knee_tau\na,0.7,0,1,50,2\n";
    let options = ["batch", RAMONE, "-", "--input-format", "csv", "--friction", "0.6"];
    let refused = heelstrike_reads(&[&options[..], &["--forces"]].concat(), table).refusal(1);
    assert!(refused.contains("column 5: torque_left_hip is a torque, and tables have no column for it"), "{refused}");
    // Columns of torque do not matter to an impact.
    heelstrike_reads(&options, table).well();
    let foreign = ["--forces", "--foreign", "torque_left_hip", "--foreign", "left_knee_tau"];
    assert!(refused.contains(&format!("{}, {}", foreign[1..3].join(" "), foreign[3..].join(" "))), "{refused}");
    heelstrike_reads(&[&options[..], &foreign].concat(), table).well();
}

#[test]
fn what_is_out_of_scale_is_noted_of_one_state_too() {
    let options = ["batch", RAMONE, "-", "--input-format", "csv", "--friction", "1", "--place", "lowest"];
    let run = heelstrike_reads(&options, "v_base_z,q_left_hip\n-1,30\n").well();
    assert!(run.stderr.contains("left_hip = 30 rad is "), "{}", run.stderr);
    let far = heelstrike_reads(&[&options[..], &["--contact", "torso:0,0,-500"]].concat(), "v_base_z\n-1\n").well();
    assert!(
        far.stderr.contains("the contact of torso is 500 m from its origin: lengths are in meters"),
        "{}",
        far.stderr
    );
    let state =
        r#"{"friction": 1, "contacts": [{"link": "left_foot", "radius": 28}], "velocity": {"base": {"z": -1}}}"#;
    let noted = heelstrike_reads(&["impact", RAMONE, "-", "--format", "json"], state).well();
    assert!(noted.stdout.contains("the contact of left_foot has a radius of 28 m"), "{}", noted.stdout);
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
    batch(&["-", "--csv-safe"], strike(1, 0.5)).refusal_with(2, "--csv-safe: it is for CSV");
}

/// A recorded walk as CSV and as flat lines of JSON, behind a blank line so that both have the same line numbers.
pub(super) fn walk() -> (String, String) {
    let table = read("examples/gait/ramone_walk.csv");
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().expect("a header").clone();
    let mut lines = "\n".to_owned();
    for row in reader.into_records() {
        let cell = |(name, cell): (&str, &str)| match cell.parse::<f64>() {
            Ok(_) => format!("{}:{cell}", json!(name)),
            Err(_) => format!("{}:{}", json!(name), json!(cell)),
        };
        lines += &format!("{{{}}}\n", names.iter().zip(&row.expect("a row")).map(cell).collect::<Vec<_>>().join(","));
    }
    (table, lines)
}

/// Options for questions about a walk.
pub(super) const WALK_QUESTIONS: [&[&str]; 4] = [
    &["--output-format", "csv"],
    &["--output-format", "csv", "--brief"],
    &["--output-format", "csv", "--touchdowns"],
    &["--brief", "--touchdowns"],
];

#[test]
fn flat_lines_of_json_are_a_table() {
    let (table, lines) = walk();
    for question in WALK_QUESTIONS {
        let run = |format: &str, input: &str| {
            let always = ["batch", RAMONE, "-", "--friction", "0.6", "--input-format", format];
            heelstrike_reads(&[&always[..], question].concat(), input).well().stdout
        };
        let expected = run("csv", &table);
        assert!(expected.len() > 500 && run("ndjson", &lines) == expected, "{question:?}");
        let reversed: String = lines
            .lines()
            .map(|line| {
                let line: serde_json::Map<String, serde_json::Value> = serde_json::from_str(line).unwrap_or_default();
                let fields =
                    line.iter().rev().map(|(key, value)| format!("{}: {value}", json!(key))).collect::<Vec<_>>();
                if fields.is_empty() { "\n".to_owned() } else { format!("{{{}}}\n", fields.join(", ")) }
            })
            .collect();
        let brief = question.contains(&"--brief");
        assert!(
            !brief || run("ndjson", &reversed).replace(' ', "") == expected,
            "{question:?} in another order of keys"
        );
    }
}

#[test]
fn fields_of_states_are_columns_or_refused() {
    let schema = parsed(&heelstrike(&["schema", "state"]).text());
    let fields: Vec<&String> = schema["properties"].as_object().expect("fields").keys().collect();
    assert!(fields.len() > 15, "{fields:?}");
    for field in fields.into_iter().filter(|field| !["id", "friction", "restitution", "stance"].contains(&&***field)) {
        let table = format!("q_base_z,v_base_z,{field}\n1,-1,0\n");
        let run = heelstrike_reads(&["batch", RAMONE, "-", "--input-format", "csv", "--friction", "0.6"], table);
        assert!(run.stderr.contains(&format!("\"{field}\" is a field of states")), "{field}: {}", run.stderr);
    }
}

#[test]
fn a_line_before_flat_ones_is_refused_alone() {
    let (_, lines) = walk();
    let arguments = ["batch", RAMONE, "-", "--friction", "0.6", "--brief", "--input-format", "ndjson"];
    let run = heelstrike_reads(&arguments, format!("12:00:01 recording started{lines}"));
    let answers = run.lines();
    assert_eq!(answers.len(), lines.trim().lines().count() + 1, "{}", run.stderr);
    assert_eq!(answers.iter().filter(|answer| !answer["error"].is_null()).count(), 1);
    assert!(!answers[0]["error"].is_null());
}

#[test]
fn broken_flat_lines_are_refused_in_their_place() {
    let lines = "{\"id\": 0, \"q_base_z\": 0.5, oops\n\
        {\"id\":1,\"q_base_z\":0.5,\"v_base_z\":-1.0,\"note\":\"a, \\\"b\\\"\",\"n\":3,\"friction\":null}\n\n\
        {\"id\":\"k2\",\"q_base_z\":\"0.5\",\"v_base_z\":-1.0}\n\
        {\"id\":3,\"q_base_z\":0.5,\"v_base_z\":-1.0,\"other\":3}\n\
        {\"id\":4,\"q_base_z\":0.5,\"v_base_z\":null}\n\
        {\"id\":5,\"q_base_z\":0.5}\n\
        {\"id\":[6],\"q_base_z\":0.5,\"v_base_z\":-1}\n\
        {\"id\":7,\"q_base_z\":0.5,\"v_base_z\":-1,\"v_base_z\":2}\n\
        {\"id\":8,\"q_base_z\":1e999,\"v_base_z\":-1}\n\
        {\"id\":9,\"q_base_z\":0.5,\"v_base_z\":-1,\"friction\":\"infinit\"}\n\
        []\n\
        {\"friction\":\"infinite\",\"v_base_z\":-1,\"n\":[1],\"note\":true,\"q_base_z\":5e-1}";
    let run = batch(&["-", "--friction", "0.5", "--refused", "ok"], lines).well();
    insta::assert_snapshot!("flat_lines", format!("{}\n{}", run.stdout, run.stderr));
    // The mark is under the key, not under its value.
    let refused = batch(&["-"], "{\"q_base_z\":1,\"v_base_z\":2,\"held\":\"x\"}\n").refusal(1);
    assert!(refused.contains("--> <stdin>:1:28\n"), "{refused}");
    batch(&["-", "--touchdowns"], "{\"q_base_z\": 0, \"position\": {}}\n")
        .refusal_with(2, "touchdowns and velocities over time need a table");
}

/// The table with tabs in place of commas.
fn with_tabs(table: &str) -> String {
    let mut writer = csv::WriterBuilder::new().delimiter(b'\t').flexible(true).from_writer(Vec::new());
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table.as_bytes());
    reader.records().for_each(|row| writer.write_record(&row.expect("a row")).expect("memory"));
    String::from_utf8(writer.into_inner().expect("memory")).expect("text")
}

#[test]
fn tabs_separate_columns_as_commas_do() {
    let (table, _) = walk();
    let [input, output] = ["walk.tsv", "answers.tsv"].map(|name| file(name, with_tabs(&table)));
    for question in WALK_QUESTIONS {
        let always = ["batch", RAMONE, "--friction", "0.6"];
        let expected = heelstrike(&[&always, &["examples/gait/ramone_walk.csv"][..], question].concat()).well().stdout;
        let answers = heelstrike(&[&always, &[&*input][..], question].concat()).well().stdout;
        assert!(answers == expected, "{question:?}");
        if question.contains(&"csv") {
            let question = question.iter().filter(|word| !word.contains("output-format") && **word != "csv").copied();
            let question = [&always, &[&*input, "-o", &output][..], &question.collect::<Vec<_>>()].concat();
            heelstrike(&question).well();
            assert!(read(&output) == with_tabs(&expected), "{question:?}");
            assert_eq!(heelstrike(&[&question[..], &["--resume"]].concat()).status, 0);
            assert!(read(&output) == with_tabs(&expected), "resumed {question:?}");
        }
    }
    let run = batch(&["-", "--input-format", "tsv", "--friction", "0.5", "--output-format", "tsv"], with_tabs(&many()));
    let expected = batch(&["-", "--input-format", "csv", "--friction", "0.5", "--output-format", "csv"], many());
    assert!(run.status == 1 && run.stdout == with_tabs(&expected.stdout));
    // A line of tabs is a row of empty cells, and a blank after a closing quote belongs to the cell.
    let table = "note\tq_base_z\tv_base_z\n\t\t\n\n\"a\tb\" \t0.5\t-1\n";
    let run = batch(&["-", "--input-format", "tsv", "--friction", "1", "--refused", "ok"], table).well();
    let lines = run.lines();
    assert_eq!(
        [&lines[0]["line"], &lines[1]["line"], &lines[1]["carried"]["note"]],
        [&json!(2), &json!(4), &json!("a\tb ")]
    );
    assert!(lines.len() == 2 && lines[0]["error"]["place"] == "q_base_z", "{lines:?}");
    for (format, table, words) in [
        ("csv", "q_base_z\tv_base_z\n0.5\t-1\n", "separated by tabs, not by commas"),
        ("tsv", "q_base_z,v_base_z\n0.5,-1\n", "if these are commas, say --input-format csv"),
    ] {
        batch(&["-", "--input-format", format], table).refusal_with(1, words);
    }
}

#[test]
fn tables_in_brief_lack_impulses_and_velocities() {
    let run = |brief: &[&str]| -> (Vec<String>, Vec<csv::StringRecord>) {
        let always = ["batch", WALKER, "examples/keyframes.ndjson", "--friction", "infinite", "--output-format", "csv"];
        let table = heelstrike(&[&always, brief].concat()).well().stdout;
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let names = reader.headers().expect("a header").iter().map(str::to_owned).collect();
        (names, reader.records().map(|row| row.expect("a row")).collect())
    };
    for next in [&[][..], &["--next"]] {
        let ((names, rows), (short, in_brief)) = (run(next), run(&[next, &["--brief"]].concat()));
        let is_long =
            |name: &str| name.starts_with("p_") || name.starts_with("v_after_") || matches!(name, "border" | "notes");
        let kept: Vec<usize> = (0..names.len()).filter(|&at| !is_long(&names[at])).collect();
        assert_eq!(short, kept.iter().map(|&at| names[at].clone()).collect::<Vec<_>>());
        let expected: Vec<Vec<&str>> = rows.iter().map(|row| kept.iter().map(|&at| &row[at]).collect()).collect();
        assert_eq!(in_brief.iter().map(|row| row.iter().collect::<Vec<_>>()).collect::<Vec<_>>(), expected);
        assert!(expected.len() > 4);
    }
}

#[test]
fn samples_of_a_study_are_a_table_with_tabs_too() {
    let study = |more: &[&str]| {
        heelstrike(&[&["sweep", WALKER, "examples/paper/figure_7.json", "--format"], more].concat()).well().stdout
    };
    for brief in [&[][..], &["--brief"]] {
        let [table, tabs] = ["csv", "tsv"].map(|format| study(&[&[format], brief].concat()));
        assert!(table.lines().count() > 50 && tabs == with_tabs(&table), "{brief:?}");
    }
}

#[test]
#[cfg(not(feature = "columnar"))]
fn a_build_without_parquet_says_how_to_get_it() {
    for arguments in [
        &["batch", RAMONE, "states.parquet"][..],
        &["batch", RAMONE, "-", "--input-format", "arrow"],
        &["batch", RAMONE, "examples/gait/ramone_walk.csv", "-o", "x.arrows"],
        &["sweep", WALKER, "examples/paper/figure_7.json", "-o", "x.parquet"],
    ] {
        let refusal = heelstrike(arguments).refusal(2);
        assert!(refusal.contains("--features columnar") && refusal.contains("no Parquet and no Arrow"), "{refusal}");
    }
}

#[test]
fn a_table_says_whether_an_answer_holds() {
    let states = [0.1, 0.4].map(|width| {
        format!("{{\"velocity\": {{\"base\": {{\"x\": 1, \"z\": -1}}}}, \"friction\": 0.7, \"uncertainty\": {{\"friction\": {width}}}}}\n")
    });
    let run = |arguments: &[&str]| {
        let arguments = [&["urdf/block.urdf", "-", "--output-format", "csv"], arguments].concat();
        crate::support::command::heelstrike_reads(&[&["batch"], &arguments[..]].concat(), states.concat())
    };
    let (full, brief) = (run(&[]), run(&["--brief"]));
    let ends: Vec<bool> = full.stdout.lines().skip(1).map(|row| row.ends_with("holds: true")).collect();
    assert_eq!(ends, [true, false], "{}", full.stdout);
    assert!(full.stdout.ends_with("holds: false\n"), "{}", full.stdout);
    assert!(
        !full.stderr.contains("whether they hold") && brief.stderr.contains("whether they hold: 2;"),
        "{}",
        brief.stderr
    );
}
