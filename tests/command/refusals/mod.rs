//! Wrong, broken, hostile or absurdly large input. It is refused with little memory and time; snapshots keep the place,
//! reason and remedy word for word.
//!
//! A new case is a line of a table (`robots`, `states`, `studies`, `tables`). `files` covers what only the command
//! meets: folders, devices, bytes that are not text. `people` covers how refusals look in a terminal.

use assert_cmd::Command;
use heelstrike::Error;
use std::fmt::Write;
use std::time::Duration;

mod files;
mod people;
mod remedies;
mod robots;
mod states;
mod studies;
mod tables;

/// Limit on the command's virtual memory, its code and stacks included \[kB\].
const MEMORY: u32 = 500_000;

/// Time limit of the command; a refusal takes some milliseconds, a second at most.
const PATIENCE: Duration = Duration::from_secs(10);

/// Checks that `heelstrike` with the `arguments` refuses `input` on standard input with a short message and status 1,
/// within [`MEMORY`] and [`PATIENCE`].
fn assert_refuses(case: &str, arguments: &[&str], input: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    if cfg!(target_os = "linux") {
        command = Command::new("sh");
        let limited = format!("ulimit -v {MEMORY} && exec \"$0\" \"$@\"");
        command.args(["-c", &limited, env!("CARGO_BIN_EXE_heelstrike")]);
    }
    let output = command.args(arguments).write_stdin(input).timeout(PATIENCE).output().expect("it runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    let start: String = stderr.chars().take(2000).collect();
    assert_eq!(output.status.code(), Some(1), "{case}: {start}");
    // A batch quotes the first few of many refused lines.
    let most = if arguments[0] == "batch" { 4000 } else { 1500 };
    let is_short = stderr.len() < most && stderr.lines().any(|line| line.starts_with("error: "));
    assert!(is_short, "{case}: {} bytes: {start}", stderr.len());
}

/// The cases of a table: each line replaces the template's `@`, with `\n` as a line break.
fn lines(table: &'static str, template: &'static str) -> impl Iterator<Item = String> {
    table.trim().lines().map(|line| template.replace('@', &line.replace("\\n", "\n")))
}

/// Compares the errors of `read` for all cases with the snapshot of that name, and checks that the command with the
/// `arguments` refuses each case within its limits.
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
        assert_refuses(&format!("{name} {at}"), arguments, case);
    }
}
