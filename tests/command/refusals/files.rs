//! Refusals that only the command meets: folders, devices, bytes that are not text, outputs that cannot be written.

use crate::{RAMONE, heelstrike_reads};

const IMPACT: &[&str] = &["impact", RAMONE, "-"];
const INSPECT: &[&str] = &["inspect", "-"];

#[test]
fn what_cannot_be_read_is_refused() {
    let absent = "cannot be read: No such file or directory (os error 2)\n";
    let missing = &*format!("{absent}hint: a name begins in the folder where the command runs\n");
    let folder = "cannot be read: Is a directory (os error 21)\nhint: name a file in it\n";
    let near = &*format!("{absent}hint: did you mean ramone.json?\n");
    let no_folder = "cannot be read: Not a directory (os error 20)\n";
    let nothing = "the text holds no XML element\nhint: give the text of a URDF file, which begins with <robot\n";
    let endless = "more than 64 MiB are not accepted here\n";
    let state = "a state is missing\nhint: the input is empty\n";
    let problem = "a problem is missing\nhint: the input is empty\n";
    let study = "a study is missing\nhint: the input is empty\n";
    for (arguments, stdin, place, reason) in [
        (&["inspect", "urdf/nobody.urdf"][..], &b""[..], "urdf/nobody.urdf", missing),
        (&["inspect", "urdf"], b"", "urdf", folder),
        (&["inspect", "Cargo.toml/a.urdf"], b"", "Cargo.toml/a.urdf", no_folder),
        (&["impact", "urdf/nobody.urdf", "examples/ramone.json"], b"", "urdf/nobody.urdf", missing),
        (&["impact", RAMONE, "examples/nobody.json"], b"", "examples/nobody.json", missing),
        (&["impact", RAMONE, "examples/ramon.json"], b"", "examples/ramon.json", near),
        (&["impact", RAMONE, "examples"], b"", "examples", folder),
        (&["batch", RAMONE, "examples"], b"", "examples", folder),
        (&["batch", RAMONE, "examples/nobody.ndjson"], b"", "examples/nobody.ndjson", missing),
        (&["solve", "nowhere/rod.json"], b"", "nowhere/rod.json", missing),
        (INSPECT, b"", "<stdin>", nothing),
        (INSPECT, b"\xef\xbb\xbf", "<stdin>", nothing),
        #[cfg(target_os = "linux")]
        (&["inspect", "/dev/zero"], b"", "/dev/zero", endless),
        (&["impact", RAMONE, "/dev/null"], b"", "/dev/null", state),
        (&["sweep", RAMONE, "-"], b" \n", "<stdin>", study),
        (IMPACT, b"", "<stdin>", state),
        (&["solve", "-"], b" \n", "<stdin>", problem),
        (IMPACT, b" [ ]\n", "<stdin>", "a state is missing\nhint: the list is empty\n"),
    ] {
        let stderr = heelstrike_reads(arguments, stdin).refusal(1);
        assert_eq!(stderr, format!("error: {place}: {reason}"), "{arguments:?}");
    }
}

#[test]
fn near_fields_and_odd_endings_are_refused() {
    let problem = |field: &str| {
        let text = r#"{"delassus": [[2, 1], [1, 2]], "velocity_before": [[0.5, -1]], "friction": 0.9, "FIELD": {"a": 1, "a": 2}}"#;
        heelstrike_reads(&["solve", "-"], text.replace("FIELD", field))
    };
    let refused = problem("restituion").refusal(1);
    assert!(
        refused.contains("unknown field \"restituion\"") && refused.contains("did you mean restitution?"),
        "{refused}"
    );
    // These fields are ignored: a comment, where it comes from, and short names that resemble known ones.
    for field in ["notes", "named", "comment", "source"] {
        problem(field).well();
    }
    for ending in ["csv.gz", "xls", "pq"] {
        let output = format!("examples/none.{ending}");
        let refused = heelstrike_reads(&["batch", RAMONE, "-", "-o", &output], "{}").refusal(2);
        assert!(refused.contains("name a file with one of these endings, or say --output-format"), "{refused}");
    }
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let hint = "hint: save it as UTF-8; iconv -f LATIN1 -t UTF-8 converts what older editors wrote";
    for (arguments, stdin, place) in [
        (INSPECT, &b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..], "1:1"),
        (INSPECT, b"<robot name=\"\xe9\"/>", "1:14"),
        (IMPACT, b"{\n \"id\": \"\xff\"}", "2:9"),
    ] {
        let stderr = heelstrike_reads(arguments, stdin).refusal(1);
        assert_eq!(stderr, format!("error: <stdin>:{place}: the text is not UTF-8\n{hint}\n"), "{stdin:?}");
    }
    for (stdin, words) in [
        (&b"\xff\xfe<\0r\0o\0b\0o\0t\0/\0>\0"[..], ["the text is UTF-16", "iconv -f UTF-16 -t UTF-8"]),
        (b"\0{\0\"", ["the text is UTF-16", "iconv -f UTF-16 -t UTF-8"]),
        (b"\x1f\x8b\x08", ["the input is packed by gzip", "gunzip -c FILE"]),
    ] {
        for arguments in [INSPECT, IMPACT, &["solve", "-"], &["batch", RAMONE, "-"]] {
            let stderr = heelstrike_reads(arguments, stdin).refusal(1);
            assert!(words.iter().all(|words| stderr.contains(words)), "{arguments:?}: {stderr}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_reported() {
    for (output, reason) in [
        ("nowhere/at/all.json", "nowhere/at/all.json: its folder is not there"),
        ("examples", "examples: Is a directory (os error 21)"),
        ("/dev/full", "No space left on device (os error 28)"),
    ] {
        for arguments in [
            &["inspect", RAMONE][..],
            &["impact", RAMONE, "examples/ramone.json"],
            &["solve", "examples/problems/rod.json"],
        ] {
            let stderr = heelstrike_reads(&[arguments, &["-o", output]].concat(), "").refusal(1);
            assert_eq!(stderr, format!("error: the output cannot be written: {reason}\n"), "{arguments:?}");
        }
    }
}
