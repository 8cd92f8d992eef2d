//! Input that is wrong, broken, hostile or absurdly large. Each is refused with its place, reason and remedy, kept word
//! for word as a snapshot, in bounded time and memory: the command has 500 MB for each, and some seconds, which no case
//! comes near to.
//!
//! A new case is a line of a table (`robots`, `states`, `studies`, `tables`). `files` holds what only the command
//! meets: folders, devices, bytes that are no text. `people` holds how refusals look in a terminal.

use heelstrike::Error;
use std::fmt::Write;

mod files;
mod limits;
mod people;
mod robots;
mod states;
mod studies;
mod tables;

/// The cases of a table: a line each, in which `\n` is a line break.
fn lines(table: &'static str, case: impl Fn(&str) -> String) -> impl Iterator<Item = String> {
    table.trim().lines().map(move |line| case(&line.replace("\\n", "\n")))
}

/// Compares what `read` says of each case with the snapshot of that name, and checks that the command with the
/// `arguments` refuses each within its limits.
fn assert_refused(
    name: &str,
    cases: impl Iterator<Item = String>,
    arguments: &[&str],
    read: impl Fn(&str) -> Result<(), Error>,
) {
    let cases: Vec<String> = cases.collect();
    let mut refusals = String::new();
    for case in &cases {
        let start: String = case.chars().take(200).collect();
        let error = read(case).expect_err(&start);
        let remedy = error.remedy().map_or(String::new(), |remedy| format!("\n    hint: {remedy}"));
        writeln!(refusals, "{start:?}\n    {error}{remedy}").expect("a string takes all");
    }
    insta::assert_snapshot!(name, refusals);
    for (at, case) in cases.iter().enumerate() {
        limits::assert_refuses(&format!("{name} {at}"), arguments, case);
    }
}
