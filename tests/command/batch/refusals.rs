//! What is refused, as a person sees it: the line with the place marked, short also where the line is not; and inputs
//! that are no lines and no tables.

use super::*;

#[test]
fn a_refused_line_is_shown_with_its_place_and_remedy() {
    let lines =
        strike(1, 0.0) + "{\"id\": 2,\t\"velocty\": {}}\r\n\n{\"id\": 3, \"position\": {\"base\": {\"z\": 0.25}}}\n";
    insta::assert_snapshot!("line", batch(&["-", "--friction", "1"], lines).stderr);
}

#[test]
fn a_refused_row_is_shown_with_its_place_also_in_the_midst_of_a_row() {
    let table = "id,note,q_base_z,v_base_z\n1,\"two\nlines\",0.5,oops\n2,\u{e9},0,5,-1\n3,x,,1\n4,x,0.5,-1\n";
    let run = batch(&["-", "--input-format", "csv"], table);
    assert_eq!(run.status, 1);
    insta::assert_snapshot!("row", run.stderr);
    // Rows that follow each other in time are refused on another way, and shown alike.
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
    let run = batch(&["-", "--input-format", "csv"], "\n  \nid,q_base_zz,v_base_z\n1,0.5,-1\n");
    assert_eq!((run.status, run.stdout.len()), (1, 0));
    insta::assert_snapshot!("header", run.stderr);
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
fn a_long_id_is_cut_where_it_is_repeated_and_whole_in_its_result() {
    let id = "x".repeat(1 << 20);
    let good = format!(
        "{{\"id\": \"{id}\", \"position\": {{\"base\": {{\"z\": 0.5}}}}, \"velocity\": {{\"base\": {{\"z\": -1}}}}}}\n"
    );
    let lines = good.replace("\"z\": -1", "\"z\": \"-1\"") + &good;
    let run = batch(&["-", "--friction", "1"], lines);
    let answers = run.lines();
    assert_eq!(answers[0]["id"], format!("{}... (cut)", &id[..200]));
    assert_eq!(answers[1]["id"], id);
    assert!(run.stderr.len() < 2000, "{} bytes", run.stderr.len());
}

/// Input, its form and the message.
const FOREIGN: [(&[u8], &str, &str); 11] = [
    (b"\x1f\x8b\x08\x00", "csv", "error: <stdin>: the input is packed by gzip\nhint: unpack it: gunzip -c FILE"),
    (b"\x1f\x8b\x08\x00", "ndjson", "error: <stdin>: the input is packed by gzip\nhint: unpack it: gunzip -c FILE"),
    (b"\x28\xb5\x2f\xfd", "ndjson", "error: <stdin>: the input is packed by zstd\n"),
    (b"PK\x03\x04", "csv", "error: <stdin>: the input is a zip archive, as spreadsheets are\nhint: unpack it, or save"),
    (b"PAR1", "ndjson", "error: <stdin>: the input is a Parquet file\n"),
    (b"\xff\xfei\0d\0,\0", "csv", "error: <stdin>: the text is UTF-16\nhint: save it as UTF-8"),
    (b"\xfe\xff\0{\0}", "ndjson", "error: <stdin>: the text is UTF-16\nhint: save it as UTF-8"),
    (
        b"q_base_z;v_base_z\n0,5;-1\n",
        "csv",
        "error: the columns are parted by semicolons, not by commas\n --> <stdin>:1:1",
    ),
    (b"q_base_z\tv_base_z\n0.5\t-1\n", "csv", "error: the columns are parted by tabs, not by commas\n --> <stdin>:1:1"),
    (b"\n{\"id\": 1}\n", "csv", "error: expected the names of the columns, found JSON\n --> <stdin>:2:1"),
    (b"\n1,2\n", "csv", "error: a column of positions, such as q_base_x, is missing\n --> <stdin>:2:1"),
];

#[test]
fn an_input_of_another_form_is_refused_as_a_whole() {
    for (input, form, told) in FOREIGN {
        let run = batch(&["-", "--input-format", form], input);
        assert_eq!((run.status, run.stdout.len()), (1, 0), "{told}");
        assert!(run.stderr.starts_with(told), "{}", run.stderr);
    }
}

#[test]
fn a_header_without_end_is_told_so() {
    let header = format!("\nid,\"{}", "x".repeat((1 << 24) + 1));
    let run = batch(&["-", "--input-format", "csv"], header);
    let told =
        "error: <stdin>:2:1: the record is longer than 16 MiB\nhint: is a line break or a closing quote missing?\n";
    assert_eq!((run.status, run.stdout.len(), run.stderr.as_str()), (1, 0, told));
}

#[test]
fn lines_that_are_no_states_of_their_own_get_a_remedy() {
    let hint = |input: &str| batch(&["-"], input).lines()[0]["error"]["hint"].clone();
    let indented = "{\n  \"friction\": 1\n}\n";
    assert_eq!(hint(indented), "each line must hold a whole state; `jq -c .` writes JSON so");
    let list = "each line must hold one state; `jq -c '.[]'` takes a list apart";
    assert_eq!((hint("[\n{\"friction\": 1}]\n"), hint("[{\"friction\": 1}, {}]\n")), (list.into(), list.into()));
    assert_eq!(hint("{\"friction\": 1},\n"), "a line holds one state and nothing after it");
    assert_eq!(hint("id,q_base_z,v_base_z\n1,0.5,-1\n"), "is this a table? then say `input_format: csv`");
}

#[test]
fn missing_friction_is_told_in_the_words_of_the_form() {
    let hint = |arguments: &[&str], input: String| {
        batch(&[&["-"], arguments].concat(), input).lines()[0]["error"]["hint"].clone()
    };
    assert_eq!(hint(&[], strike(1, 0.0)), "add \"friction\": 0.8 to the state, or `friction: 0.8` (or infinite)");
    let table = "q_base_z,v_base_z\n0.5,-1\n".to_owned();
    assert_eq!(hint(&["--input-format", "csv"], table), "add a column friction, or give `friction: 0.8` (or infinite)");
}

#[test]
fn a_byte_order_mark_belongs_to_no_name_and_no_line() {
    let quoted = "\u{feff}\"id\nof the state\",\"q_base_z\",\"v_base_z\"\n1,0.5,-1\n";
    let run = batch(&["-", "--input-format", "csv", "--friction", "1"], quoted);
    assert_eq!((run.status, &run.lines()[0]["carried"]), (0, &json!({"id\nof the state": "1"})), "{}", run.stderr);
    let run = batch(&["-", "--friction", "1"], format!("\u{feff}{}", strike(1, 0.0)));
    assert_eq!((run.status, run.lines().len()), (0, 1), "{}", run.stderr);
}

#[test]
fn a_table_without_any_line_has_no_states_like_an_empty_text() {
    for input in ["", "\n \n"] {
        let run = batch(&["-", "--input-format", "csv"], input);
        assert_eq!((run.status, run.stdout.len(), run.stderr.as_str()), (0, 0, ""));
        for form in ["csv", "ndjson"] {
            let run = batch(&["-", "--input-format", form, "--output-format", "csv"], input);
            assert_eq!((run.status, run.stderr.as_str()), (0, ""));
            assert!(run.stdout.starts_with("id,verdict,") && run.stdout.ends_with(",error\n"), "the header alone");
        }
    }
}
