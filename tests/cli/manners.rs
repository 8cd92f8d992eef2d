//! How the command behaves beside its answers: usage, help, pipes, disks, colours.

use super::*;

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
    for command in
        [&["--help"][..], &["inspect", "--help"], &["impact", "--help"], &["batch", "--help"], &["solve", "--help"]]
    {
        let run = heelstrike(command);
        assert_eq!(run.status, 0);
        assert!(run.stdout.contains("Example"), "{command:?}");
        assert!(run.stdout.contains("\n  heelstrike "), "{command:?}");
    }
}

// Pipes and terminals.

#[test]
fn a_closed_pipe_ends_quietly() {
    let states = "{\"friction\": 0.5, \"velocity\": {\"base\": {\"z\": -1}}}\n".repeat(2000);
    let path = std::env::temp_dir().join(format!("heelstrike-pipe-{}.ndjson", std::process::id()));
    std::fs::write(&path, states).expect("writable");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_heelstrike"))
        .args(["batch", BLOCK, path.to_str().expect("UTF-8")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut stderr).expect("UTF-8");
    let status = child.wait().expect("it ends");
    std::fs::remove_file(path).expect("it was ours");
    assert_eq!((status.code(), stderr.as_str()), (Some(0), ""));
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
}
