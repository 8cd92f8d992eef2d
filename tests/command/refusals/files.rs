//! What only the command meets: folders, devices, bytes that are no text, outputs that cannot be written.

use super::super::{RAMONE, heelstrike_reads};

/// Exit status, standard output and standard error of a run.
fn run(arguments: &[&str], stdin: &[u8]) -> (i32, String, String) {
    let run = heelstrike_reads(arguments, stdin);
    (run.status, run.stdout, run.stderr)
}

#[track_caller]
fn assert_refused(arguments: &[&str], stdin: &[u8], stderr: &str) {
    let told = run(arguments, stdin);
    assert_eq!(told, (1, String::new(), stderr.to_owned()), "{arguments:?}");
}

#[test]
fn what_is_no_file_is_refused() {
    let missing = "cannot be read: No such file or directory (os error 2)\n";
    let folder = "cannot be read: Is a directory (os error 21)\n";
    assert_refused(&["inspect", "urdf/nobody.urdf"], b"", &format!("error: urdf/nobody.urdf: {missing}"));
    assert_refused(&["inspect", "urdf"], b"", &format!("error: urdf: {folder}"));
    assert_refused(&["impact", RAMONE, "examples"], b"", &format!("error: examples: {folder}"));
    assert_refused(&["solve", "nowhere/rod.json"], b"", &format!("error: nowhere/rod.json: {missing}"));
    assert_refused(
        &["inspect", "Cargo.toml/a.urdf"],
        b"",
        "error: Cargo.toml/a.urdf: cannot be read: Not a directory (os error 20)\n",
    );
}

#[test]
fn what_is_empty_is_refused() {
    let nothing = "error: <stdin>: the text holds no XML element\nhint: give the text of a URDF file, which begins with \
                   <robot\n";
    assert_refused(&["inspect", "-"], b"", nothing);
    assert_refused(&["inspect", "-"], b"\xef\xbb\xbf", nothing);
    assert_refused(&["impact", RAMONE, "-"], b"", "error: <stdin>: a state is missing\nhint: the input is empty\n");
    assert_refused(&["solve", "-"], b" \n", "error: <stdin>: a problem is missing\nhint: the input is empty\n");
    assert_eq!(run(&["batch", RAMONE, "-"], b"").0, 0);
}

#[test]
fn bytes_that_are_no_text_are_refused_with_their_place() {
    let told = |place: &str| {
        let hint = "hint: save it as UTF-8; iconv -f LATIN1 -t UTF-8 converts what older editors wrote";
        format!("error: <stdin>:{place}: the text is not UTF-8\n{hint}\n")
    };
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    assert_refused(&["inspect", "-"], png, &told("1:1"));
    assert_refused(&["inspect", "-"], b"<robot name=\"\xe9\"/>", &told("1:14"));
    assert_refused(&["impact", RAMONE, "-"], b"{\n \"id\": \"\xff\"}", &told("2:9"));
    let sixteen = b"\xff\xfe<\0r\0o\0b\0o\0t\0/\0>\0";
    assert_refused(&["inspect", "-"], sixteen, &told("1:1"));
}

#[cfg(target_os = "linux")]
#[test]
fn an_endless_file_is_refused() {
    assert_refused(&["inspect", "/dev/zero"], b"", "error: /dev/zero: more than 64 MiB are not accepted here\n");
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_told() {
    let refused = |output: &str, told: &str| {
        for arguments in [
            &["inspect", RAMONE][..],
            &["impact", RAMONE, "examples/ramone.json"],
            &["solve", "examples/problems/rod.json"],
        ] {
            let stderr = format!("error: the output cannot be written: {told}\n");
            assert_refused(&[arguments, &["-o", output]].concat(), b"", &stderr);
        }
    };
    refused("nowhere/at/all.json", "nowhere/at/all.json: No such file or directory (os error 2)");
    refused("examples", "examples: Is a directory (os error 21)");
    refused("/dev/full", "No space left on device (os error 28)");
}

#[test]
fn escape_sequences_of_a_file_do_not_reach_the_terminal() {
    let urdf = b"<robot name=\"r\"><link name=\"a\"/><link name=\"\x1b[2J\"/></robot>";
    // XML has no such character; JSON strings may hold it escaped.
    let (status, _, stderr) = run(&["inspect", "-"], urdf);
    assert_eq!((status, stderr.contains('\x1b')), (1, false), "{stderr}");
    let (status, _, stderr) = run(&["impact", RAMONE, "-"], b"{\"stance\": \"\\u001b[2J\"}");
    assert_eq!((status, stderr.contains('\x1b')), (1, false), "{stderr}");
}

#[test]
fn a_refusal_of_a_line_of_1_mb_stays_short() {
    let pad = "x".repeat(500_000);
    for state in [
        format!("{{\"id\": \"{pad}\", \"frictoin\": 1, \"more\": \"{pad}\"}}"),
        format!("{{\"{pad}{pad}\": 1}}"),
        format!("{{\"stance\": \"{pad}{pad}\"}}"),
        format!("{{\"friction\": 1, \"contacts\": {}1", "[".repeat(1_000_000)),
    ] {
        let (status, stdout, stderr) = run(&["impact", RAMONE, "-"], state.as_bytes());
        assert_eq!((status, stdout.as_str()), (1, ""));
        assert!(stderr.starts_with("error: ") && stderr.len() < 1500, "{} bytes: {stderr}", stderr.len());
    }
    let urdf = format!("<robot><link name=\"a\"/><!-- {pad} --><link nam=\"{pad}\"/></robot>");
    let (status, _, stderr) = run(&["inspect", "-"], urdf.as_bytes());
    assert!(status == 1 && stderr.len() < 1500, "{} bytes: {stderr}", stderr.len());
}
