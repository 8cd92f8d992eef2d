//! How the command behaves beside its answers: usage, help, pipes, disks, colours.

use super::*;
use std::io::Read;
use std::process::Stdio;

#[test]
fn exit_status_is_two_for_wrong_usage_alone() {
    for usage in [
        &["frobnicate"][..],
        &["impact", RAMONE],
        &["impact", RAMONE, "examples/ramone.json", "--friction", "-1"],
        &["impact", RAMONE, "examples/ramone.json", "--friction", "much"],
        &["impact", RAMONE, "examples/ramone.json", "--contact", "left_foot:0,0"],
        &["impact", RAMONE, "examples/ramone.json", "--contact", "nobody:0,0,0"],
        &["impact", RAMONE, "examples/ramone.json", "--brief", "--explain"],
        &["impact", RAMONE, "examples/ramone.json", "--base", "swimming"],
    ] {
        let run = heelstrike(usage);
        assert_eq!((run.status, run.stdout.as_str()), (2, ""), "{usage:?}");
        assert!(run.stderr.contains("error: "), "{usage:?}");
    }
    for refused in [
        &["impact", "urdf/nobody.urdf", "examples/ramone.json"][..],
        &["impact", RAMONE, "examples/nobody.json"],
        &["impact", RAMONE, "examples"],
        &["impact", RAMONE, "/dev/null"],
        &["batch", RAMONE, "examples/nobody.ndjson"],
        &["impact", RAMONE, "examples/ramone.json", "-o", "nowhere/at/all.json"],
    ] {
        let run = heelstrike(refused);
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{refused:?}");
        assert!(run.stderr.starts_with("error: "), "{refused:?}");
    }
    let empty = heelstrike_reads(&["batch", RAMONE, "-"], "\n\n");
    assert_eq!((empty.status, empty.stdout.as_str(), empty.stderr.as_str()), (0, "", ""));
}

#[test]
fn every_command_has_an_example_in_its_help() {
    for command in ["", "inspect", "impact", "batch", "solve", "schema", "completions", "man"] {
        let arguments: Vec<&str> = [command, "--help"].into_iter().filter(|argument| !argument.is_empty()).collect();
        let run = heelstrike(&arguments);
        assert_eq!(run.status, 0);
        assert!(run.stdout.contains("Example"), "{command:?}");
        assert!(run.stdout.contains("\n  heelstrike "), "{command:?}");
    }
}

#[test]
fn every_command_of_the_help_is_one() {
    let help = heelstrike(&["--help"]).stdout;
    let commands: Vec<&str> =
        help.lines().filter_map(|line| line.strip_prefix("  ")?.split_once("  ")).map(|(name, _)| name).collect();
    for command in ["inspect", "impact", "batch", "solve", "schema", "completions"] {
        assert!(commands.contains(&command), "{command}: {help}");
    }
    assert!(!commands.contains(&"man"), "for those who package the tool");
}

#[test]
fn the_version_names_the_commit_where_it_is_known() {
    let version = heelstrike(&["--version"]).stdout;
    let rest = version.strip_prefix(concat!("heelstrike ", env!("CARGO_PKG_VERSION"))).expect("the version").trim_end();
    let commit = rest.strip_prefix(" (").and_then(|rest| rest.strip_suffix(')'));
    assert!(rest.is_empty() || commit.is_some_and(|hash| hash.len() == 12), "{version}");
}

#[test]
fn completions_and_man_pages_are_written() {
    for (shell, sign) in [
        ("bash", "complete -F _heelstrike"),
        ("zsh", "#compdef heelstrike"),
        ("fish", "complete -c heelstrike"),
        ("elvish", "edit:completion:arg-completer[heelstrike]"),
        ("powershell", "Register-ArgumentCompleter"),
    ] {
        let run = heelstrike(&["completions", shell]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
        assert!(run.stdout.contains(sign) && run.stdout.contains("resting-speed"), "{shell}");
    }
    assert_eq!(heelstrike(&["completions", "cmd"]).status, 2);

    for (page, title, within) in [
        (&["man"][..], ".TH HEELSTRIKE 1", "inspect"),
        (&["man", "impact"], ".TH HEELSTRIKE-IMPACT 1", "resting\\-speed"),
    ] {
        let run = heelstrike(page);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
        assert!(run.stdout.contains(title) && run.stdout.contains(within), "{}", run.stdout);
    }
    assert_eq!(heelstrike(&["man", "nothing"]).status, 2);
}

// Pipes and terminals.

#[test]
fn a_closed_pipe_ends_quietly() {
    let states = "{\"friction\": 0.5, \"velocity\": {\"base\": {\"z\": -1}}}\n".repeat(2000);
    let path = file("states.ndjson", states);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_heelstrike"))
        .args(["batch", BLOCK, &path])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut stderr).expect("UTF-8");
    let status = child.wait().expect("it ends");
    assert_eq!((status.code(), stderr.as_str()), (Some(0), ""));
}

#[cfg(unix)]
#[test]
fn head_sees_the_first_lines_and_nothing_else_is_told() {
    let problem = r#"{"delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 1}"#;
    let binary = env!("CARGO_BIN_EXE_heelstrike");
    for command in [
        format!("'{binary}' solve - --format json"),
        format!("'{binary}' solve -"),
        format!("yes '{{\"friction\": 0.5}}' | head -20000 | '{binary}' batch {BLOCK} -"),
        format!("'{binary}' schema result"),
        format!("'{binary}' completions bash"),
    ] {
        let script = format!("{{ {command}; echo $? >&2; }} | head -1");
        let mut shell = assert_cmd::Command::new("sh");
        let run = finished(shell.args(["-c", &script]).write_stdin(problem.repeat(5000)));
        assert_eq!((run.status, run.stdout.lines().count(), run.stderr.as_str()), (0, 1, "0\n"), "{command}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_by_every_command() {
    let problem = "examples/problems/rod.json";
    for command in [
        &["inspect", BLOCK][..],
        &["impact", BLOCK, "examples/block.json"],
        &["solve", problem],
        &["solve", problem, "--format", "json"],
        &["schema", "state"],
        &["completions", "zsh"],
        &["man"],
        &["--version"],
        &["--help"],
        &["help", "batch"],
    ] {
        let full = std::fs::File::options().write(true).open("/dev/full").expect("a full disk");
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_heelstrike"));
        let output = child.args(command).stdout(full).output().expect("the command runs");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "{command:?}");
        assert_eq!(
            stderr, "error: the output cannot be written: No space left on device (os error 28)\n",
            "{command:?}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let run = heelstrike(&["impact", BLOCK, "examples/block.json", "-o", "/dev/full"]);
    assert_eq!(run.status, 1);
    assert!(run.stderr.starts_with("error: the output cannot be written: "), "{}", run.stderr);
}

#[test]
fn colours_come_only_where_they_are_wanted() {
    let arguments = ["impact", BLOCK, "examples/block.json"];
    let coloured = |run: Run| run.stdout.contains('\x1b') || run.stderr.contains('\x1b');
    assert!(!coloured(heelstrike(&arguments)));
    assert!(!coloured(finished(command().args(["impact", BLOCK, "nobody.json"]))));
    assert!(coloured(finished(command().args(arguments).env("CLICOLOR_FORCE", "1"))));
    assert!(!coloured(finished(command().args(arguments).env("NO_COLOR", "1"))));

    // Errors likewise, with a line and without; where both are set, NO_COLOR wins.
    for refused in [&["inspect", "Cargo.toml"][..], &["inspect", "nobody.urdf"], &["impact", BLOCK, "Cargo.toml"]] {
        assert!(!coloured(finished(command().args(refused))), "{refused:?}");
        assert!(coloured(finished(command().args(refused).env("CLICOLOR_FORCE", "1"))), "{refused:?}");
        assert!(!coloured(finished(command().args(refused).env("NO_COLOR", "1"))), "{refused:?}");
    }
}
