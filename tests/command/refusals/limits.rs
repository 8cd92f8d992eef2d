//! The command with little memory and time.

use assert_cmd::Command;
use std::time::Duration;

/// What the command may take of memory, its code and stacks included \[kB\].
const MEMORY: u32 = 500_000;

/// After so long it counts as hanging; a refusal takes some milliseconds, a second at most.
const PATIENCE: Duration = Duration::from_secs(10);

/// Checks that `heelstrike` with the `arguments` refuses `input` on standard input in short words, with status 1,
/// within memory and time.
pub fn assert_refuses(case: &str, arguments: &[&str], input: &str) {
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        let limited = format!("ulimit -v {MEMORY} && exec \"$0\" \"$@\"");
        shell.args(["-c", &limited, env!("CARGO_BIN_EXE_heelstrike")]);
        shell
    } else {
        Command::new(env!("CARGO_BIN_EXE_heelstrike"))
    };
    let output = command.args(arguments).write_stdin(input).timeout(PATIENCE).output().expect("it runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    let start: String = stderr.chars().take(2000).collect();
    assert_eq!(output.status.code(), Some(1), "{case}: {start}");
    assert!(stderr.starts_with("error: ") && stderr.len() < 2000, "{case}: {} bytes: {start}", stderr.len());
}
