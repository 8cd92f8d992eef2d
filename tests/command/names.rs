//! Names and ids with control characters: text output escapes them, so that no terminal obeys them.

use super::*;

/// A line break, the C1 control sequence introducer and a right-to-left override, as XML writes them.
const NAME: &str = "a&#10;b&#x9b;2J&#x202e;c";
/// [`NAME`] as JSON writes it.
const KEY: &str = "a\\nb\\u009b2J\\u202ec";
/// [`NAME`] as text output shows it.
const SHOWN: &str = "a\\nb\\u{9b}2J\\u{202e}c";

/// The path of a URDF of the block whose robot and link are named [`NAME`].
fn robot() -> String {
    let urdf = read(BLOCK).replace("name=\"block\"", &format!("name=\"{NAME}\""));
    file("names.urdf", urdf)
}

#[track_caller]
fn assert_shown(text: &str, what: &str) {
    let obeyed = |letter: &char| letter.is_control() && *letter != '\n' || ('\u{202a}'..='\u{2069}').contains(letter);
    assert_eq!(text.chars().find(obeyed), None, "{what}: {text:?}");
    assert!(!text.contains("\nb\\u"), "{what}: {text}");
}

#[test]
fn names_that_a_terminal_obeys_are_escaped() {
    let robot = robot();
    let state = format!(
        "{{\"id\": \"k\\u001b[31m{KEY}\", \"velocity\": {{\"base\": {{\"x\": 0.5, \"z\": -1}}}}, \
                         \"friction\": 0.9}}"
    );
    let study = "{\"parameters\": {\"v\": {\"from\": 0.1, \"to\": 1, \"steps\": 3}}, \
                  \"state\": {\"velocity\": {\"base\": {\"x\": \"v\", \"z\": -1}}, \"friction\": 0.9}}";
    let explained = [&["impact", &robot, "-", "--explain", "--matrices"][..], &["batch", &robot, "-"]];
    for (arguments, stdin) in [
        (&["inspect", &robot][..], ""),
        (explained[0], &state),
        (&["sweep", &robot, "-"], study),
        (&["accuracy", &robot, "-"], &state),
    ] {
        let run = heelstrike_reads(arguments, stdin).well();
        assert_shown(&(run.stdout.clone() + &run.stderr), arguments[0]);
        assert!(run.stdout.contains(SHOWN), "{arguments:?}: {}", run.stdout);
    }
    let batch = heelstrike_reads(explained[1], format!("{state}\n{state}\n")).well();
    assert_shown(&batch.stderr, "the summary");
    assert!(batch.stderr.contains(&format!("k\\u{{1b}}[31m{SHOWN} (line 1)")), "{}", batch.stderr);
    // JSON output keeps the names themselves.
    assert!(batch.lines()[0]["contacts"][0]["name"].as_str().expect("a name").contains('\u{9b}'));
}

#[test]
fn refusals_of_hostile_names_are_escaped() {
    let robot = robot();
    let state = |fields: &str| format!("{{\"friction\": 1, {fields}}}");
    let nobody = format!("\"held\": [\"{KEY}\"]");
    for (stdin, shown) in [
        (state(&nobody), SHOWN),
        (state(&format!("\"{KEY}\": 1")), SHOWN),
        (state("\"stance\": \"x\u{9b}\u{202e}\""), "x\\u{9b}\\u{202e}"),
        (state("\"stance\": \"\\u001b[2J\""), "\\u{1b}[2J"),
        (state("\u{9b}"), "\u{fffd}"),
    ] {
        let refusal = heelstrike_reads(&["impact", &robot, "-"], stdin).refusal(1);
        assert_shown(&refusal, shown);
        assert!(refusal.contains(shown), "{refusal}");
    }
    let joint = |name: &str| format!("<joint name=\"{name}\" type=\"fixed\"><parent link=\"{name}\"/></joint></robot>");
    let mesh = format!("<mesh filename=\"{NAME}.stl\"/>");
    for urdf in [
        read(BLOCK).replace("</robot>", &joint(NAME)),
        read(BLOCK).replace("<sphere radius=\"0\"/>", &mesh),
        "<robot name=\"r\"><\u{9b}\u{202e}></robot>".to_string(),
        // XML does not allow U+001B; JSON allows it as an escape.
        "<robot name=\"r\"><link name=\"a\"/><link name=\"\u{1b}[2J\"/></robot>".to_string(),
    ] {
        let run = heelstrike(&["inspect", &file("refused.urdf", urdf)]);
        assert_shown(&(run.stdout + &run.stderr), "a URDF");
    }
}
