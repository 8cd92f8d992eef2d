//! How refused lines are shown: with the place marked, and shortened if long; and inputs that are neither lines nor
//! tables.

use super::*;

#[test]
fn a_refused_line_is_shown_with_its_place_and_remedy() {
    let lines =
        strike(1, 0.0) + "{\"id\": 2,\t\"velocty\": {}}\r\n\n{\"id\": 3, \"position\": {\"base\": {\"z\": 0.25}}}\n";
    insta::assert_snapshot!("line", batch(&["-", "--friction", "1"], lines).stderr);
}

#[test]
fn a_refused_row_is_shown_with_its_place() {
    let table = "id,note,q_base_z,v_base_z\n1,\"two\nlines\",0.5,oops\n2,\u{e9},0,5,-1\n3,x,,1\n4,x,0.5,-1\n";
    let run = batch(&["-", "--input-format", "csv"], table);
    assert_eq!(run.status, 1);
    insta::assert_snapshot!("row", run.stderr);
    // Rows of a recording take another path through the code; their refusals look the same.
    let timed = table.replace("note", "time").replace("\"two\nlines\"", "\"0\n\"").replace(",x,", ",1,");
    let run = batch(&["-", "--input-format", "csv", "--touchdowns", "--friction", "1"], timed);
    assert!(run.stderr.contains("3 | \",0.5,oops\n  |       ^^^^ v_base_z\n"), "{}", run.stderr);
}

#[test]
fn a_line_that_is_cut_off_is_marked_at_its_end() {
    for end in ["", "\n", "\r\n", "  \n{}\n"] {
        let run = batch(&["-", "--friction", "1"], format!("{{\"position\": {{\"base\": {{\"z\":{end}"));
        assert!(run.stderr.contains(" --> <stdin>:1:27\n"), "{end:?}: {}", run.stderr);
    }
}

#[test]
fn a_refused_header_is_shown_on_its_own_line() {
    let table = "\n  \nid,q_base_zz,v_base_z\n1,0.5,-1\n";
    insta::assert_snapshot!("header", batch(&["-", "--input-format", "csv"], table).refusal(1));
}

#[test]
fn a_refusal_of_a_long_record_shows_a_short_piece() {
    let pad = "x".repeat(1 << 20);
    let line = format!("{{\"id\": \"{pad}\", \"frictoin\": 1, \"more\": \"{pad}\"}}\n");
    let row = format!("q_base_z,v_base_z,note,id\n0.5,oops,{pad},{pad}\n");
    let name = format!("id,q_{pad},v_base_z\n");
    for (input, arguments, shown) in [
        (line, &["-"][..], "\"frictoin\""),
        (row, &["-", "--input-format", "csv"], "0.5,oops,xxx"),
        (name, &["-", "--input-format", "csv"], "id,q_xxx"),
    ] {
        let run = batch(arguments, input);
        assert_eq!(run.status, 1);
        assert!(run.stderr.len() < 1500, "{} bytes: {}", run.stderr.len(), run.stderr);
        assert!(run.stderr.contains(shown), "{}", run.stderr);
        assert!(run.stdout.len() < 1000, "{} bytes", run.stdout.len());
    }
}

#[test]
fn a_long_id_is_cut_in_messages_and_whole_in_results() {
    let id = "é".repeat(1 << 20);
    let good = strike(1, 0.0).replace("\"id\":1", &format!("\"id\":\"{id}\""));
    let run = batch(&["-", "--friction", "1"], good.replace("-1", "\"-1\"") + &good);
    let answers = run.lines();
    assert_eq!(answers[0]["id"], format!("{}... (cut)", "é".repeat(200)));
    assert_eq!(answers[1]["id"], id);
    assert!(run.stderr.len() < 2000, "{} bytes", run.stderr.len());
}

/// Input, its format, and the start of the message.
const FOREIGN: [(&[u8], &str, &str); 10] = [
    (b"\x1f\x8b\x08\x00", "csv", "error: <stdin>: the input is packed by gzip\nhint: unpack it: gunzip -c FILE"),
    (b"\x28\xb5\x2f\xfd", "ndjson", "error: <stdin>: the input is packed by zstd\n"),
    (b"PK\x03\x04", "csv", "error: <stdin>: the input is a zip archive, as spreadsheets are\nhint: unpack it, or save"),
    (b"PAR1", "ndjson", "error: <stdin>: the input is a Parquet file\n"),
    (b"\xff\xfei\0d\0,\0", "csv", "error: <stdin>: the text is UTF-16\nhint: save it as UTF-8"),
    (b"\xfe\xff\0{\0}", "ndjson", "error: <stdin>: the text is UTF-16\nhint: save it as UTF-8"),
    (b"q_base_z;v_base_z\n", "csv", "error: the columns are separated by semicolons, not by commas\n --> <stdin>:1:1"),
    (b"q_base_z\tv_base_z\n", "csv", "error: the columns are separated by tabs, not by commas\n --> <stdin>:1:1"),
    (b"\n{\"id\": 1}\n", "csv", "error: expected the names of the columns, found JSON\n --> <stdin>:2:1"),
    (b"\n1,2\n", "csv", "error: a column of positions, such as q_base_x, is missing\n --> <stdin>:2:1"),
];

#[test]
fn an_input_of_another_form_is_refused_as_a_whole() {
    let header = format!("\nid,\"{}", "x".repeat((1 << 24) + 1));
    let endless =
        "error: <stdin>:2:1: the record is longer than 16 MiB\nhint: is a line break or a closing quote missing?\n";
    for (input, form, expected) in FOREIGN.into_iter().chain([(header.as_bytes(), "csv", endless)]) {
        let stderr = batch(&["-", "--input-format", form], input).refusal(1);
        assert!(stderr.starts_with(expected), "{stderr}");
    }
}

#[test]
fn lines_that_are_no_states_get_a_remedy() {
    let list = "each line must hold one state; `jq -c '.[]'` takes a list apart";
    for (arguments, input, hint) in [
        (&["-"][..], "{\n  \"friction\": 1\n}\n", "each line must hold a whole state; `jq -c .` writes JSON so"),
        (&["-"][..], "[\n{\"friction\": 1}]\n", list),
        (&["-"][..], "[{\"friction\": 1}, {}]\n", list),
        (&["-"][..], "{\"friction\": 1},\n", "a line holds one state and nothing after it"),
        (&["-"][..], "id,q_base_z,v_base_z\n1,0.5,-1\n", "is this a table? then say `input_format: csv`"),
        (&["-"][..], "id\tq_base_z\tv_base_z\n1\t0.5\t-1\n", "is this a table? then say `input_format: tsv`"),
        (
            &["-"][..],
            "id;q_base_z;v_base_z\n1;0,5;-1\n",
            "is this a table? save it with commas between columns and points in numbers, and say `input_format: csv`",
        ),
        (
            &["-"][..],
            &strike(1, 0.0),
            "add \"friction\": 0.8 (or \"infinite\") to the state, or set `friction: 0.8` for all states",
        ),
        (
            &["-", "--input-format", "csv"],
            "q_base_z,v_base_z\n0.5,-1\n",
            "add a column friction, or give `friction: 0.8` (or infinite)",
        ),
    ] {
        let run = batch(arguments, input);
        assert_eq!(run.lines()[0]["error"]["hint"], hint, "{input}");
    }
}

#[test]
fn a_byte_order_mark_belongs_to_no_name_and_no_line() {
    let quoted = "\u{feff}\"id\nof the state\",\"q_base_z\",\"v_base_z\"\n1,0.5,-1\n";
    let run = batch(&["-", "--input-format", "csv", "--friction", "1"], quoted);
    assert_eq!((run.status, &run.lines()[0]["carried"]), (0, &json!({"id\nof the state": "1"})), "{}", run.stderr);
    batch(&["-", "--friction", "1"], format!("\u{feff}{}", strike(1, 0.0))).well().line();
}

#[test]
fn carried_json_is_copied_as_it_stands() {
    let carried = format!(
        r#"{{"big":123456789012345678901234567890,"huge":1e400,"deep":{}{},"escaped":"\u0041"}}"#,
        "[".repeat(200),
        "]".repeat(200)
    );
    let row = format!(r#"{{"q_base_z":0.5,"v_base_z":-1,{}"#, &carried[1..]);
    let run = batch(&["-", "--friction", "1"], format!("{row}\n")).well();
    assert!(run.stdout.contains(&format!(r#""carried":{carried}"#)), "{}", run.stdout);
    // A carriage return is replaced, because some readers take it as the end of a line.
    let run = batch(&["-", "--friction", "1"], "{\"q_base_z\":0.5,\"v_base_z\":-1,\"list\":[1,\r2]}\n").well();
    assert!(run.stdout.contains(r#""carried":{"list":[1, 2]}"#), "{}", run.stdout);
}

#[test]
fn a_stray_quote_costs_no_row_but_its_own() {
    let row = |id: usize| format!("{id},0.5,-1,{}note\n", if id % 400 == 50 { "\"" } else { "" });
    let table = "id,q_base_z,v_base_z,note\n".to_owned() + &(0..1000).map(row).collect::<String>();
    for threads in ["1", "4"] {
        let run = batch(&["-", "--input-format", "csv", "--friction", "1", "--threads", threads], table.as_str());
        let answers = run.lines();
        assert_eq!((run.status, answers.len()), (1, 1000));
        for (id, answer) in answers.iter().enumerate() {
            assert_eq!(answer["line"], id + 2);
            let quoted = answer["error"]["message"] == "a quote is not closed";
            let named = answer["id"].as_str() == Some(id.to_string().as_str());
            assert!(if id % 400 == 50 { quoted } else { named }, "{answer}");
        }
        assert!(run.stderr.contains("\n1000 states: 997 unique, 3 refused\n"), "{}", run.stderr);
    }
}

#[test]
fn quotes_around_several_rows_cost_only_their_own() {
    let row = |id: usize| match id {
        100 => "\"100,0.5,-1,note\n".to_owned(),
        130 => "130,0.5,-1,note\"\n".to_owned(),
        150 => "150,0.5,-1,\"note\n".to_owned(),
        180 => "180,0.5,-1,note\"\n".to_owned(),
        // A quoted cell of two lines is not two rows.
        _ if id % 50 == 40 => format!("{id},0.5,-1,\"a note,\nof two lines\"\n"),
        _ => format!("{id},0.5,-1,note\n"),
    };
    let table = "id,q_base_z,v_base_z,note\n".to_owned() + &(0..200).map(row).collect::<String>();
    let run = batch(&["-", "--input-format", "csv", "--friction", "1"], table);
    let answers = run.lines();
    let refused: Vec<usize> = (0..answers.len()).filter(|&at| answers[at].get("error").is_some()).collect();
    assert_eq!((answers.len(), refused), (200, vec![100, 150]), "{}", run.stderr);
}

#[test]
fn a_column_that_resembles_a_missing_one_is_refused() {
    let given = "q_base_x,q_base_pitch,v_base_x,v_base_pitch";
    let table = |columns: &str| {
        format!("q_base_z,{columns}\n{}\n", vec!["0.5"; 1 + columns.matches(',').count() + 1].join(","))
    };
    let arguments = ["-", "--input-format", "csv", "--friction", "1"];
    for (columns, hint) in [
        ("V_BASE_Z", "did you mean v_base_z? if not, give --foreign V_BASE_Z"),
        ("v-base-z", "did you mean v_base_z?"),
        ("base_z", "did you mean v_base_z?"),
        ("base_z_vel", "did you mean v_base_z?"),
        ("v_base_z,restituion", "did you mean restitution?"),
        ("v_base_z,ID,Stance", "did you mean id? also stance for Stance; if not"),
        ("pitch", "did you mean q_base_pitch? or v_base_pitch?"),
    ] {
        let given = if columns == "pitch" { "v_base_z" } else { given };
        batch(&arguments, table(&format!("{given},{columns}"))).refusal_with(1, &format!("\nhint: {hint}"));
    }
    // These columns resemble no missing one, or are given as foreign.
    for (columns, more) in [
        ("v_base_z,base_z,a_base_z,tau_base_z,phase", &[][..]),
        ("v_base_z,Time", &["--foreign", "Time"]),
        ("v_base_z,q_wheel,v_after_base_z", &["--foreign", "q_wheel", "--foreign", "v_after_base_z"]),
    ] {
        batch(&[&arguments, more].concat(), table(&format!("{given},{columns}"))).text();
    }
    // With `--brief` only the columns given as foreign are copied.
    for (brief, carried) in [(&[][..], json!({"Time": "0.5", "phase": "0.5"})), (&["--brief"], json!({"Time": "0.5"}))]
    {
        let asked = [&arguments[..], &["--foreign", "Time"], brief].concat();
        let line = &batch(&asked, table(&format!("{given},v_base_z,Time,phase"))).lines()[0];
        assert_eq!(line["carried"], carried, "{line}");
    }
    // An acceleration and a force are not taken for the missing velocity.
    batch(&arguments, table(&format!("{given},a_base_z,tau_base_z"))).well();
    batch(&[&arguments[..], &["--foreign", "nobody"]].concat(), table(given))
        .refusal_with(1, "column \"nobody\", given as foreign, is missing");
}
