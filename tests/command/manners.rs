//! How the command behaves apart from its answers: usage, help, pipes, disks, colors.

use super::*;

#[test]
fn exit_status_is_two_for_wrong_usage() {
    let impact = &["impact", RAMONE, "examples/ramone.json"][..];
    for (command, options) in [
        (&["frobnicate"][..], &[][..]),
        (&["impact", RAMONE], &[]),
        (&["completions", "cmd"], &[]),
        (&["man", "nothing"], &[]),
        (impact, &["--friction", "-1"]),
        (impact, &["--friction", "much"]),
        (impact, &["--contact", "left_foot:0,0"]),
        (impact, &["--contact", "nobody:0,0,0"]),
        (impact, &["--brief", "--explain"]),
        (impact, &["--base", "swimming"]),
    ] {
        heelstrike(&[command, options].concat()).refusal_with(2, "error: ");
    }
}

#[test]
fn every_command_has_an_example_in_its_help() {
    const COMMANDS: [&str; 10] =
        ["inspect", "impact", "forces", "batch", "sweep", "solve", "accuracy", "schema", "completions", "man"];
    for command in [""].into_iter().chain(COMMANDS) {
        let arguments: Vec<&str> = [command, "--help"].into_iter().filter(|argument| !argument.is_empty()).collect();
        let help = heelstrike(&arguments).well().stdout;
        assert!(help.contains("Example") && help.contains("\n  heelstrike "), "{command:?}: {help}");
        if command.is_empty() {
            let names = help.lines().filter_map(|line| line.strip_prefix("  ")?.split_once("  "));
            let names: Vec<&str> = names.map(|(name, _)| name).collect();
            for command in COMMANDS {
                assert!(names.contains(&command), "{command}: {help}");
            }
        }
    }
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
    for (arguments, start, option) in [
        (&["completions", "bash"][..], "complete -F _heelstrike", "resting-speed"),
        (&["completions", "zsh"], "#compdef heelstrike", "resting-speed"),
        (&["completions", "fish"], "complete -c heelstrike", "resting-speed"),
        (&["completions", "elvish"], "edit:completion:arg-completer[heelstrike]", "resting-speed"),
        (&["completions", "powershell"], "Register-ArgumentCompleter", "resting-speed"),
        (&["man"], ".TH HEELSTRIKE 1", "inspect"),
        (&["man", "impact"], ".TH HEELSTRIKE-IMPACT 1", "resting\\-speed"),
    ] {
        let text = heelstrike(arguments).text();
        assert!(text.contains(start) && text.contains(option), "{arguments:?}: {text}");
    }
}

// Pipes and terminals.

#[cfg(unix)]
#[test]
fn a_pipe_to_head_ends_quietly() {
    let problem = r#"{"delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 1}"#;
    let binary = env!("CARGO_BIN_EXE_heelstrike");
    let states = "{\"friction\": 0.5, \"velocity\": {\"base\": {\"z\": -1}}}\n".repeat(2000);
    let states = file("states.ndjson", states);
    for command in [
        format!("'{binary}' batch {BLOCK} '{states}'"),
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
fn an_output_that_takes_nothing_is_reported() {
    let problem = "examples/problems/rod.json";
    for command in [
        &["inspect", BLOCK][..],
        &["impact", BLOCK, "examples/block.json"],
        &["batch", WALKER, "examples/keyframes.ndjson", "--friction", "1"],
        &["solve", problem],
        &["solve", problem, "--format", "json"],
        &["schema", "state"],
        &["completions", "zsh"],
        &["man"],
        &["--version"],
        &["--help"],
        &["help", "batch"],
        &["impact", "--next", "--help"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").expect("a full disk");
        let unwritable = fs::File::open("Cargo.toml").expect("a file");
        for (stdout, why) in
            [(full, "No space left on device (os error 28)"), (unwritable, "Bad file descriptor (os error 9)")]
        {
            let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_heelstrike"));
            let output = child.args(command).stdout(stdout).output().expect("the command runs");
            let stderr = String::from_utf8(output.stderr).expect("UTF-8").replace("; it ends after 0 whole lines", "");
            let expected = format!("error: the output cannot be written: {why}\n");
            assert_eq!((output.status.code(), stderr), (Some(1), expected), "{command:?}");
        }
    }
}

/// `NO_COLOR` overrides `CLICOLOR_FORCE`.
#[test]
fn colors_come_only_where_they_are_wanted() {
    for arguments in [
        &["impact", BLOCK, "examples/block.json"][..],
        // Errors that quote a line of the file, and errors that do not.
        &["inspect", "Cargo.toml"],
        &["inspect", "nobody.urdf"],
        &["impact", BLOCK, "Cargo.toml"],
        &["impact", BLOCK, "nobody.json"],
    ] {
        for (variables, colored) in [
            (&[][..], false),
            (&["CLICOLOR_FORCE"], true),
            (&["NO_COLOR"], false),
            (&["NO_COLOR", "CLICOLOR_FORCE"], false),
        ] {
            let run = finished(command().args(arguments).envs(variables.iter().map(|name| (name, "1"))));
            let escapes = run.stdout.contains('\x1b') || run.stderr.contains('\x1b');
            assert_eq!(escapes, colored, "{arguments:?} {variables:?}");
        }
    }
    let text = finished(command().args(["impact", BLOCK, "examples/block.json"]).env("CLICOLOR_FORCE", "1")).stdout;
    for styled in ["\x1b[1mExactly one outcome.\x1b[0m\n", "  \x1b[2mt: along the ground, forward; "] {
        assert!(text.contains(styled), "{text}");
    }
}

#[test]
fn what_a_terminal_obeys_is_escaped_in_arguments() {
    for arguments in [&["impact", "--\u{202e}\u{1b}[2J"][..], &["inspect", RAMONE, "--base", "\u{9b}31m"]] {
        let stderr = heelstrike(arguments).refusal(2);
        assert!(stderr.contains("\\u{") && !stderr.contains(['\u{1b}', '\u{202e}', '\u{9b}']), "{stderr:?}");
    }
}

// Options of the scene.

#[test]
fn place_lowest_puts_states_on_the_ground() {
    let state = r#"{"position": {"base": {"z": 3}}, "velocity": {"base": {"z": -1}}, "friction": 1}"#;
    for command in ["impact", "batch"] {
        let verdict = |more: &[&str]| {
            let run = heelstrike_reads(&[&[command, BLOCK, "-", "--format", "json"], more].concat(), state);
            run.well().line()["verdict"].clone()
        };
        assert_eq!((verdict(&["--place", "lowest"]), verdict(&[])), (json!("unique"), json!("no_contact")));
    }
    let bolted = ["impact", WALKER, "examples/minimalistic.json", "--place", "lowest", "--base", "fixed"];
    let refusal = heelstrike(&bolted).refusal(2);
    assert!(refusal.contains("cannot be placed") && refusal.contains("on the ground by its joints"), "{refusal}");
    let above = r#"{"friction": 1, "ground": {"profile": [[-9, -5], [9, -5]]}}"#;
    let hanging = heelstrike_reads(&["impact", WALKER, "-", "--base", "fixed"], above).well().stdout;
    assert!(hanging.contains("put it there by its joints") && !hanging.contains("--place"), "{hanging}");
    let both = ["batch", RAMONE, "-", "--touchdowns", "--place", "lowest"];
    assert!(heelstrike(&both).refusal(2).contains("cannot be used with"));
}

#[test]
fn strict_limits_refuse_where_a_note_was_given() {
    let walker = fs::read_to_string(WALKER).unwrap().replace("\"continuous\"", "\"revolute\"");
    let robot = file("limited.urdf", walker.replace("</joint>", "<limit lower=\"-1\" upper=\"1\"/></joint>"));
    let state = r#"{"position": {"joints": {"hip": -45}}, "stance": "left_leg", "friction": 1}"#;
    let noted = heelstrike_reads(&["impact", &robot, "-"], state).text();
    assert!(noted.contains("Note: hip = -45 rad is outside [-1, 1]; degrees?\n"), "{noted}");
    let refused = heelstrike_reads(&["impact", &robot, "-", "--strict-limits"], state).refusal(1);
    assert!(refused.contains("position.joints.hip") && refused.contains("or do without --strict-limits"), "{refused}");
}

#[test]
fn what_rounding_left_of_zero_is_written_as_such() {
    for arguments in [
        ["forces", RAMONE, "examples/ramone_stands.json"],
        ["impact", RAMONE, "examples/stairs.json"],
        ["impact", "urdf/five_bar.urdf", "examples/five_bar.json"],
        ["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"],
        ["sweep", BLOCK, "examples/paper/figure_9.json"],
    ] {
        let text = heelstrike(&arguments).text();
        let exponent = |word: &str| word.split_once("e-")?.1.parse::<u32>().ok();
        let tiny: Vec<&str> = text.split_whitespace().filter(|word| exponent(word) > Some(13)).collect();
        assert!(tiny.is_empty(), "{arguments:?}: {tiny:?}");
        let is_at_zero = text.contains(" .. ~0 ") && text.contains("  at ~0: the normal impulse of block");
        assert_eq!(is_at_zero, arguments[1] == BLOCK, "{text}");
    }
}

#[test]
fn misplaced_files_are_refused_with_a_next_step() {
    let state = "examples/ramone.json";
    for (arguments, tip) in [
        (&[RAMONE, state][..], "name a command first: heelstrike impact urdf/ramone.urdf STATE.json"),
        (&["inspect", RAMONE, state], "a state is an option here: --state examples/ramone.json --plot pose.svg"),
        (&["impact", RAMONE, state, "-o", "a.csv"], "and tables by `batch`"),
    ] {
        heelstrike(arguments).refusal_with(2, tip);
    }
    for arguments in [&["impct", RAMONE][..], &["impact", RAMONE, state, state]] {
        let refusal = heelstrike(arguments).refusal(2);
        assert!(!refusal.contains("STATE.json\n") && !refusal.contains("--plot"), "{refusal}");
    }
}
