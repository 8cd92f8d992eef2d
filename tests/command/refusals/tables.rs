//! Tables and lines that the command refuses.

use super::assert_refuses;
use crate::RAMONE;

const CSV: &[&str] = &["--input-format", "csv"];

#[test]
fn hostile_inputs_are_refused_within_memory_and_time() {
    let many = |cell: &str, count: usize| vec![cell; count].join(",");
    let header = "id,q_base_z,v_base_z\n";
    for (options, case, input) in [
        (CSV, "a million columns of one name", many("a", 1_000_000)),
        (CSV, "a million coordinates that are not there", (0..1_000_000).map(|k| format!("q_{k},")).collect()),
        (CSV, "a row of a million cells", format!("{header}{}\n", many("1", 1_000_000))),
        (CSV, "a cell of 10 MB", format!("{header}1,{},0\n", "9".repeat(10_000_000))),
        (CSV, "a number of a million digits", format!("{header}1,{}e,0\n", "9".repeat(1_000_000))),
        (CSV, "quotes that are never closed", format!("{header}{}", "a\",\"b\n".repeat(20_000))),
        (CSV, "only quotes", "\"".repeat(10_000_000)),
        (CSV, "only zero bytes", "\0".repeat(10_000_000)),
        (CSV, "a header without end", "q_base_z,".repeat(5_000_000)),
        (&[], "brackets", "[".repeat(10_000_000)),
        (&[], "objects in objects", "{\"a\":".repeat(2_000_000)),
        (&[], "an id of 10 MB", format!("{{\"id\": \"{}\", \"a\": 1}}", "x".repeat(10_000_000))),
        (&[], "a line of 40 MB", "x".repeat(40_000_000)),
        (
            &[],
            "a million fields",
            format!("{{{}\"k\":0}}", (0..1_000_000).map(|k| format!("\"{k}\":0,")).collect::<String>()),
        ),
    ] {
        assert_refuses(case, &[&["batch", RAMONE, "-", "--threads", "2"], options].concat(), &input);
    }
}
