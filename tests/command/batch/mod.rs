//! `heelstrike batch` as a stream: order, line numbers, threads, pipes, ends of input and output; and its summary.

use super::support::urdf;
use super::{RAMONE, Run, WALKER, file, heelstrike, heelstrike_reads, parsed, place, read};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};

#[cfg(feature = "columnar")]
mod columnar;
mod memory;
mod recording;
mod refusals;
mod resume;
mod summary;
mod table;

/// The path of a URDF of a disc of 2 kg, 1 kg m^2 and radius 0.5 m.
fn disc() -> String {
    let sphere = urdf::collision([0.0; 2], "sphere radius=\"0.5\"");
    file("disc.urdf", urdf::robot(&[urdf::link("disc", 2.0, [0.0; 2], 1.0, &sphere)]))
}

/// Runs `heelstrike batch` on a disc.
fn batch(arguments: &[&str], stdin: impl Into<Vec<u8>>) -> Run {
    heelstrike_reads(&[&["batch", &disc()], arguments].concat(), stdin)
}

/// The command `heelstrike batch` on a disc, ready to spawn.
fn batching(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    command.args(["batch", &disc()]).args(arguments);
    command
}

/// A line with a state in which the disc strikes the ground with the tangential velocity `x` \[m/s\].
fn strike(id: usize, x: f64) -> String {
    let state = json!({"id": id, "position": {"base": {"z": 0.5}}, "velocity": {"base": {"x": x, "z": -1}}});
    format!("{state}\n")
}

/// 2000 lines, none on a border. Every tenth is broken, and every seventh is followed by a blank line.
fn many() -> String {
    let line = |id: usize| match id {
        _ if id % 10 == 9 => format!("{{\"id\": {id}, oops\r\n"),
        _ if id % 7 == 3 => strike(id, id as f64 * 1.1e-3) + " \n",
        _ => strike(id, -(id as f64) * 1.1e-3),
    };
    (0..2000).map(line).collect()
}

#[test]
fn answers_come_in_order_and_refusals_in_their_place() {
    let run = batch(&["-", "--friction", "0.5"], many());
    assert_eq!(run.status, 1);
    let answers = run.lines();
    assert_eq!(answers.len(), 2000);
    let mut line = 0;
    for (id, answer) in answers.iter().enumerate() {
        line += 1;
        assert_eq!((&answer["id"], &answer["line"]), (&json!(id), &json!(line)));
        if id % 10 == 9 {
            assert_eq!(answer.get("verdict"), None);
        } else {
            assert_eq!(answer["verdict"], "unique");
            line += usize::from(id % 7 == 3);
        }
    }
}

#[test]
fn the_bytes_depend_on_neither_threads_nor_input() {
    let states = file("bytes.ndjson", many());
    let run = |threads: &str, input: &str, stdin: String| {
        let summary = place(&format!("bytes-{threads}.json"));
        let arguments = [input, "--friction", "0.5", "--threads", threads, "--summary", &summary];
        (batch(&arguments, stdin).stdout, read(&summary))
    };
    let expected = run("1", &states, String::new());
    for threads in ["2", "4", "0"] {
        assert!(run(threads, &states, String::new()) == expected, "{threads} threads, file");
        assert!(run(threads, "-", many()) == expected, "{threads} threads, pipe");
    }
    let stdin = std::fs::File::open(&states).expect("it is there");
    let output = batching(&["-", "--friction", "0.5"]).stdin(stdin).output().expect("it runs");
    assert!(output.stdout == expected.0.as_bytes(), "redirected");
}

#[test]
fn refused_lines_are_no_failure_if_asked() {
    let fails = batch(&["-"], "oops\n");
    let passes = batch(&["-", "--refused", "ok"], "oops\n");
    assert_eq!((fails.status, passes.status), (1, 0));
    assert_eq!(fails.stdout, passes.stdout);
    assert!(passes.stderr.starts_with("error: expected value\n --> <stdin>:1:1\n"), "{}", passes.stderr);
}

#[test]
fn many_refusals_do_not_flood_standard_error() {
    // The first three of each kind are shown, and twenty in total.
    let kind = |at: usize| format!("{{\"position\": {{\"x{at}\": 0}}}}\n");
    let others: String = (0..30).map(kind).collect();
    let run = batch(&["-"], "oops\n".repeat(1000) + &kind(0) + &others);
    assert_eq!((run.status, run.lines().len()), (1, 1031));
    let shown = |what: &str| run.stderr.matches(what).count();
    assert_eq!(
        [shown("error: "), shown("error: expected value"), shown("position.x0\n"), shown("position.x15\n")],
        [20, 3, 2, 1]
    );
    assert_eq!(shown("note: further refusals like this stand in the output alone: expected value\n"), 1);
    let end = "\nnote: further refusals stand in the output alone\n1031 states: 1031 refused\n";
    assert!(run.stderr.ends_with(end), "{}", run.stderr);
}

#[test]
fn refusals_that_differ_in_numbers_are_of_one_kind() {
    let stance = |link: &str| format!("{{\"stance\": \"{link}\"}}\n");
    let deep = |height: u32| format!("{{\"position\": {{\"base\": {{\"z\": 0.{height}}}}}, \"friction\": 1}}\n");
    let input = stance("lef_foot").repeat(4) + &stance("rigt_foot") + &(11..20).map(deep).collect::<String>();
    let run = batch(&["-"], input);
    let shown = |what: &str| run.stderr.matches(what).count();
    assert_eq!([shown("error: "), shown("named \"rigt_foot\""), shown("alone: ")], [3 + 1 + 3, 1, 2], "{}", run.stderr);
}

#[test]
fn an_input_without_states_is_refused() {
    let missing = "error: <stdin>: a state is missing\nhint: the input is empty\n";
    let no_rows = missing.replace("input is empty", "table has a header and no rows");
    for (format, input, expected) in [
        ("ndjson", "", missing),
        ("ndjson", "\n \r\n\n", missing),
        ("csv", "\n \n", missing),
        ("csv", "q_base_x,q_base_z,q_base_pitch,v_base_x,v_base_z,v_base_pitch\n\n", &no_rows),
    ] {
        let kept = file("kept.csv", "an old result");
        let run = batch(&["-", "--input-format", format, "-o", &kept], input);
        assert_eq!((run.refusal(1).as_str(), read(&kept).as_str()), (expected, "an old result"), "{input:?}");
    }
    let part = batch(&["-", "--refused", "ok"], "");
    assert_eq!((part.status, &*part.stdout, &*part.stderr), (0, "", ""));
}

#[test]
fn line_ends_may_be_of_either_kind_or_missing() {
    let expected = batch(&["-", "--friction", "1"], strike(1, 0.0) + &strike(2, 0.1)).stdout;
    for end in ["\n", "\r\n", "\n\n"] {
        let lines = (strike(1, 0.0) + strike(2, 0.1).trim_end()).replace('\n', end);
        let run = batch(&["-", "--friction", "1"], lines);
        let expected = if end == "\n\n" { expected.replace("\"line\":2", "\"line\":3") } else { expected.clone() };
        assert_eq!((run.status, run.stdout == expected), (0, true), "{end:?}");
    }
}

#[test]
fn a_long_line_is_read() {
    let blanks = " ".repeat(1 << 20);
    let run =
        batch(&["-", "--friction", "1"], strike(1, 0.0).replace(", ", &blanks).replace(':', &format!(":{blanks}")));
    assert_eq!((run.status, &run.lines()[0]["verdict"]), (0, &json!("unique")));
}

#[test]
fn an_endless_line_is_refused_and_the_rest_goes_on() {
    let line = format!("{}\n", "x".repeat((1 << 24) + 1));
    let run = batch(&["-", "--friction", "1"], strike(1, 0.0) + &line + &strike(3, 0.0));
    assert_eq!(run.status, 1);
    let refused = json!({"line": 2, "error": {"message": "the record is longer than 16 MiB",
        "hint": "is a line break or a closing quote missing?"}});
    assert_eq!((&run.lines()[1], &run.lines()[2]["id"]), (&refused, &json!(3)));
}

// Ends.

fn spawned(threads: &str, more: &[&str]) -> (Child, ChildStdin) {
    let mut command = batching(&["-", "--friction", "1", "--threads", threads]);
    command.args(more).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("it runs");
    let stdin = child.stdin.take().expect("piped");
    (child, stdin)
}

#[test]
fn an_answer_does_not_wait_for_the_next_line() {
    for threads in ["1", "2"] {
        let (mut child, mut stdin) = spawned(threads, &[]);
        let mut answers = BufReader::new(child.stdout.take().expect("piped")).lines();
        for id in 0..3 {
            stdin.write_all(strike(id, 0.0).as_bytes()).expect("it reads");
            let answer = answers.next().expect("an answer").expect("UTF-8");
            assert_eq!(parsed(&answer)["id"], id);
        }
        drop(stdin);
        assert!(answers.next().is_none());
        assert!(child.wait().expect("it ends").success());
    }
}

/// The first rows of a file are read twice, but standard input only once, even if the folder has a file named `-`.
#[test]
fn standard_input_is_read_once_where_a_file_has_its_name() {
    let folder = place("folder");
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(format!("{folder}/-"), "").expect("a file");
    let table = read("examples/gait/ramone_walk.csv");
    let robot = std::path::absolute("urdf/ramone.urdf").expect("a path");
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    command.arg("batch").arg(robot).args(["-", "--input-format", "csv", "--friction", "0.6", "--brief"]);
    let output = command.current_dir(&folder).write_stdin(table.clone()).output().expect("it runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout).lines().count(), table.lines().count() - 1);
}

#[test]
fn a_row_of_a_recording_waits_for_the_next_one_alone() {
    for threads in ["1", "2"] {
        let (mut child, mut stdin) = spawned(threads, &["--input-format", "csv", "--velocity", "backward"]);
        let mut answers = BufReader::new(child.stdout.take().expect("piped")).lines();
        stdin.write_all(b"time,q_base_z\n0,0.7\n").expect("it reads");
        for row in 1..20 {
            stdin.write_all(format!("{row},{}\n", 0.7 - 0.01 * f64::from(row)).as_bytes()).expect("it reads");
            let answer = answers.next().expect("an answer").expect("UTF-8");
            assert_eq!(parsed(&answer)["line"], row + 1);
        }
        drop(stdin);
        assert!(answers.next().is_some() && answers.next().is_none());
        assert!(child.wait().expect("it ends").success());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_what_was_written() {
    let expected =
        "error: the output cannot be written: No space left on device (os error 28); it ends after 0 whole lines\n";
    for threads in ["1", "4"] {
        let options = ["--friction", "1", "--threads", threads];
        let run = batch(&[&options[..], &["-", "-o", "/dev/full"]].concat(), strike(1, 0.0));
        assert_eq!((run.status, run.stderr.as_str()), (1, expected));
        let full = std::fs::File::options().write(true).open("/dev/full").expect("Linux has it");
        let states = file(&format!("full-{threads}.ndjson"), strike(1, 0.0));
        let output = batching(&options).arg(states).stdout(full).output().expect("it runs");
        assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(1), expected));
    }
}

#[test]
fn a_silent_batch_sees_that_its_output_has_ended() {
    let full = &["-o", "/dev/full"][..];
    let outputs: &[&[&str]] = if cfg!(target_os = "linux") { &[&[], full] } else { &[&[]] };
    for (threads, output) in ["1", "4"].into_iter().flat_map(|threads| outputs.iter().map(move |own| (threads, *own))) {
        let (mut child, mut stdin) = spawned(threads, output);
        drop(child.stdout.take());
        // A process that another test is just starting holds the pipe for a moment.
        std::thread::sleep(std::time::Duration::from_millis(300));
        stdin.write_all(strike(1, 0.0).as_bytes()).expect("it reads");
        let (status, stderr) = ended(&mut child);
        let reason = "error: the output cannot be written: No space left on device";
        let expected = if output.is_empty() { (0, "") } else { (1, reason) };
        assert!(status == Some(expected.0) && stderr.starts_with(expected.1), "{threads} threads: {stderr}");
        assert!(stderr.is_empty() == output.is_empty(), "{stderr}");
        drop(stdin);
    }
}

/// Exit status and standard error of a process that must end although its input is still open.
fn ended(child: &mut Child) -> (Option<i32>, String) {
    let mut stderr = child.stderr.take().expect("piped");
    let (sent, received) = std::sync::mpsc::channel();
    // Standard error ends with the process.
    std::thread::spawn(move || {
        let mut text = String::new();
        stderr.read_to_string(&mut text).map(|_| sent.send(text))
    });
    let text = received.recv_timeout(std::time::Duration::from_secs(20));
    if text.is_err() {
        child.kill().expect("ours");
    }
    let text = text.expect("it does not wait for the next line");
    (child.wait().expect("it ends").code(), text)
}

#[test]
fn no_input_or_other_output_is_replaced() {
    let states = file("spared.ndjson", strike(1, 0.0));
    for arguments in [[&states, "-o", &states], [&states, "--summary", &states]] {
        assert_eq!(batch(&arguments, "").status, 1, "{arguments:?}");
    }
    // An input is not replaced either if it has the name of a temporary file next to the output.
    for ending in [".part", ".run"] {
        let input = file(&format!("whole.ndjson{ending}"), strike(1, 0.0));
        let output = place("whole.ndjson");
        batch(&[&input, "-o", &output], "").refusal_with(1, "is an input of this command");
        assert_eq!(read(&input), strike(1, 0.0));
    }
    let both = place("both.ndjson");
    let folder = Path::new(&both).parent().expect("a folder");
    let around = folder.join("..").join(folder.file_name().expect("a name")).join("both.ndjson");
    for summary in [&both, around.to_str().expect("UTF-8")] {
        assert_eq!(batch(&[&states, "-o", &both, "--summary", summary], "").status, 2);
    }
    assert_eq!(read(&states), strike(1, 0.0));
    let dash = batch(&["-", "--summary", "-"], "");
    assert!(dash.status == 2 && dash.stderr.contains("--summary: "), "{}", dash.stderr);
}

#[cfg(unix)]
#[test]
fn what_a_link_will_name_is_written() {
    let (link, target) = (place("link.ndjson"), place("target.ndjson"));
    for path in [&link, &target] {
        let _ = std::fs::remove_file(path);
    }
    std::os::unix::fs::symlink("target.ndjson", &link).expect("linked");
    batch(&["-", "--friction", "1", "-o", &link], strike(1, 0.0)).well();
    assert!(std::fs::symlink_metadata(&link).expect("it is there").is_symlink() && read(&target).starts_with('{'));
}

#[cfg(unix)]
#[test]
fn standard_input_is_not_replaced_under_any_name() {
    let states = file("redirected.ndjson", strike(1, 0.0));
    let link = format!("{states}.link");
    let _ = std::fs::remove_file(&link);
    std::fs::hard_link(&states, &link).expect("linked");
    for arguments in [&["-o", &states][..], &["-o", &link], &["--summary", &link], &[]] {
        let mut command = batching(&["-", "--friction", "1"]);
        command.args(arguments).stdin(std::fs::File::open(&states).expect("it is there"));
        if arguments.is_empty() {
            // As with `cat f >> f`, the batch would read its own output without end.
            command.stdout(std::fs::File::options().append(true).open(&states).expect("it is there"));
        }
        let output = command.output().expect("it runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && stderr.contains("is an input of this command"), "{stderr}");
    }
    assert_eq!(read(&states), strike(1, 0.0));
}
