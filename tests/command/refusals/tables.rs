//! Tables that are refused, by the command.

use super::limits::assert_refuses;

const BATCH: [&str; 7] = ["batch", "urdf/ramone.urdf", "-", "--input-format", "csv", "--threads", "2"];

#[test]
fn hostile_tables_are_refused_within_memory_and_time() {
    let many = |cell: &str, count: usize| vec![cell; count].join(",");
    let header = "id,q_base_z,v_base_z\n";
    for (case, table) in [
        ("a million columns of one name", many("a", 1_000_000)),
        ("a million coordinates that are not there", (0..1_000_000).map(|k| format!("q_{k},")).collect()),
        ("a row of a million cells", format!("{header}{}\n", many("1", 1_000_000))),
        ("a cell of 10 MB", format!("{header}1,{},0\n", "9".repeat(10_000_000))),
        ("a number of a million digits", format!("{header}1,{}e,0\n", "9".repeat(1_000_000))),
        ("a quote that is never closed", format!("{header}\"{}", "1,2,3\n".repeat(2_800_000))),
        ("quotes alone", "\"".repeat(10_000_000)),
        ("no bytes but zeros", "\0".repeat(10_000_000)),
        ("a header without end", "q_base_z,".repeat(5_000_000)),
    ] {
        assert_refuses(case, &BATCH, &table);
    }
}

#[test]
fn hostile_lines_are_refused_within_memory_and_time() {
    let batch = ["batch", "urdf/ramone.urdf", "-", "--threads", "2"];
    for (case, lines) in [
        ("brackets", "[".repeat(10_000_000)),
        ("objects in objects", "{\"a\":".repeat(2_000_000)),
        ("an id of 10 MB", format!("{{\"id\": \"{}\", \"a\": 1}}", "x".repeat(10_000_000))),
        ("a line of 40 MB", "x".repeat(40_000_000)),
        (
            "a million fields",
            format!("{{{}}}", (0..1_000_000).map(|k| format!("\"{k}\":0")).collect::<Vec<_>>().join(",")),
        ),
    ] {
        assert_refuses(case, &batch, &lines);
    }
}
