//! Outputs of runs that were killed, cut off or refused: `--resume` continues them to the same bytes or leaves them.

use super::*;
use crate::support::random::Random;
use std::fs;

/// The runs that are interrupted: the output's name, the input and the options.
fn cases() -> [(&'static str, String, &'static [&'static str]); 4] {
    let lines: String = many().lines().take(200).map(|line| format!("{line}\n")).collect();
    let table: String = table::many().lines().take(200).map(|line| format!("{line}\n")).collect();
    // A disc that falls and stops repeatedly.
    let fall = |row: usize| format!("{row},0,{},0\n", 0.5 + 0.1 * (9 - (row % 20).min(9)) as f64);
    let falls = "time,q_base_x,q_base_z,q_base_pitch\n".to_owned() + &(0..400).map(fall).collect::<String>();
    [
        ("lines.ndjson", lines.clone(), &["--brief"]),
        ("lines.csv", lines, &["--output-format", "csv"]),
        ("table.csv", table, &["--input-format", "csv", "--output-format", "csv"]),
        ("falls.ndjson", falls, &["--input-format", "csv", "--touchdowns", "--velocity", "backward"]),
    ]
}

/// Runs a batch into `output`.
fn into(output: &str, input: &str, options: &[&str]) -> Run {
    batch(&[&["-", "--friction", "0.5", "-o", output], options].concat(), input)
}

#[test]
fn a_cut_output_is_continued_to_the_same_bytes() {
    let mut random = Random::new(17);
    for (name, input, options) in cases() {
        let (whole, cut) = (place(&format!("whole-{name}")), place(&format!("cut-{name}")));
        let undisturbed = into(&whole, &input, options);
        let expected = fs::read(&whole).expect("an output");
        assert!(expected.len() > 1000, "{name}: {}", expected.len());
        for round in 0..8 {
            let end = if round < 2 { 0 } else { random.whole(0, expected.len() as i64) as usize };
            // A run that was stopped leaves a `.part` file; a run whose input ended early leaves the output itself.
            let there = if round % 2 == 0 { format!("{cut}.part") } else { cut.clone() };
            fs::write(&there, &expected[..end]).expect("a file");
            let run = into(&cut, &input, &[options, &["--resume"]].concat());
            assert_eq!(run.status, undisturbed.status, "{name}, {end} bytes: {}", run.stderr);
            assert!(fs::read(&cut).expect("an output") == expected, "{name}, {end} bytes");
            assert!(!fs::exists(format!("{cut}.part")).expect("known"), "{name}");
            fs::remove_file(&cut).expect("it is there");
        }
    }
}

#[test]
fn rows_of_one_state_are_continued_together() {
    // Each state has three outcomes, so three rows.
    let state: serde_json::Value = serde_json::from_str(&read("examples/minimalistic.json")).expect("JSON");
    let (states, output) = (file("three.ndjson", format!("{state}\n").repeat(5)), place("three.csv"));
    let run = |more: &[&str]| heelstrike(&[&["batch", WALKER, &states, "-o", &output], more].concat()).well();
    run(&[]);
    let expected = read(&output);
    assert_eq!(expected.lines().count(), 1 + 5 * 3);
    let ends = expected.match_indices('\n').map(|(end, _)| end + 1);
    for end in ends.skip(1).flat_map(|end| [end, end - 40]) {
        fs::write(&output, &expected[..end]).expect("a file");
        run(&["--resume"]);
        assert!(read(&output) == expected, "{end} bytes");
    }
}

#[test]
fn a_refusal_of_a_cut_line_leaves_no_rest() {
    let (output, states) = (place("rest.ndjson"), (0..3).map(|id| strike(id, 0.0)).collect::<String>());
    let options = &["--brief", "--resume"];
    into(&output, &states, options);
    let expected = read(&output);
    // The refusal is longer than the answer.
    let cut = format!("{}{}", strike(0, 0.0).repeat(2), r#"{"id": 2, "position": {"joints": {"#);
    let _ = fs::remove_file(&output);
    into(&output, &cut.replace("\"id\":0", "\"id\":1").replacen("\"id\":1", "\"id\":0", 1), options);
    assert!(read(&output).len() > expected.len(), "{}", read(&output));
    into(&output, &states, options);
    assert_eq!(read(&output), expected);
}

#[test]
fn two_runs_do_not_write_one_file() {
    let output = place("locked.ndjson");
    let mut first = batching(&["-", "--friction", "0.5", "-o", &output]);
    let mut first = first.stdin(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it runs");
    let mut stdin = first.stdin.take().expect("a pipe");
    stdin.write_all(strike(1, 0.0).as_bytes()).expect("it reads");
    while fs::metadata(format!("{output}.part")).map_or(0, |part| part.len()) == 0 {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    for more in [&[][..], &["--resume"]] {
        let stderr = into(&output, &strike(2, 0.0), more).refusal(1);
        assert!(stderr.contains("another run is writing it"), "{stderr}");
    }
    drop(stdin);
    assert!(first.wait().expect("it ends").success());
    assert!(read(&output).starts_with("{\"id\":1,"), "{}", read(&output));
}

#[test]
fn a_killed_run_is_continued_to_the_same_bytes() {
    for (format, count) in [("ndjson", 3), ("csv", 3)] {
        let (states, output) = (file(&format!("{format}.in"), many()), place(&format!("killed.{format}")));
        let options = [&states, "--friction", "0.5", "--output-format", format];
        let expected = batch(&options, "");
        for round in 1..=count {
            let _ = fs::remove_file(&output);
            let part = format!("{output}.part");
            let mut command = batching(&options);
            command.args(["-o", &output, "--threads", "2"]).stdout(Stdio::null()).stderr(Stdio::null());
            let mut child = command.spawn().expect("it runs");
            let least = (round * expected.stdout.len() / 8) as u64;
            let written = || fs::metadata(&part).map_or(0, |part| part.len());
            while child.try_wait().expect("known").is_none() && written() < least {
                std::thread::sleep(std::time::Duration::from_micros(200));
            }
            let _ = child.kill();
            child.wait().expect("it ends");
            let run = batch(&[&options[..], &["-o", &output, "--resume"]].concat(), "");
            assert_eq!((run.status, read(&output) == expected.stdout), (1, true), "{format} {round}: {}", run.stderr);
        }
    }
}

#[test]
fn a_summary_of_a_resumed_run_is_of_all_states() {
    let (_, input, _) = &cases()[0];
    let (output, summary) = (place("all.ndjson"), place("all.json"));
    into(&output, input, &["--summary", &summary]);
    let (expected, whole) = (read(&summary), read(&output));
    fs::rename(&output, format!("{output}.part")).expect("a file");
    fs::write(format!("{output}.part"), &whole[..whole.len() / 2]).expect("a file");
    into(&output, input, &["--summary", &summary, "--resume"]);
    assert_eq!((read(&summary), read(&output)), (expected, whole));
}

#[test]
fn answers_of_another_run_are_not_continued() {
    let (_, input, _) = &cases()[0];
    let output = place("other.ndjson");
    into(&output, input, &[]);
    let before = read(&output);
    // The other runs have shorter answers, longer ones, or answers to another state.
    for (input, options) in [
        (input.as_str(), &["--brief", "--resume"][..]),
        (input.as_str(), &["--explain", "--resume"]),
        (&strike(1, 0.0), &["--resume"]),
    ] {
        into(&output, input, options).refusal_with(1, "it was begun with other answers");
        assert_eq!(read(&output), before);
    }
    assert_eq!(batch(&["-", "--resume"], "").status, 2, "an output is needed");
}

/// A strike and 149 states at rest, more than `--resume` answers again.
fn strike_and_rest(speed: f64) -> String {
    strike(0, speed) + &(1..150).map(|id| strike(id, 0.0).replace("-1", "0")).collect::<String>()
}

/// Kills a run once it has answered all of `input`.
fn killed(output: &str, input: &str, options: &[&str]) {
    let _ = fs::remove_file(output);
    let mut command = batching(&[&["-", "--friction", "0.5", "-o", output], options].concat());
    let mut child = command.stdin(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it runs");
    let mut stdin = child.stdin.take().expect("a pipe");
    stdin.write_all(input.as_bytes()).expect("it reads");
    let answered = || fs::read(format!("{output}.part")).is_ok_and(|part| lines(&part) >= lines(input.as_bytes()));
    while !answered() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().expect("it runs");
    child.wait().expect("it ends");
}

fn lines(text: &[u8]) -> usize {
    text.iter().filter(|&&byte| byte == b'\n').count()
}

#[test]
fn a_killed_run_is_continued_by_the_same_alone() {
    let (output, input) = (place("same.ndjson"), strike_and_rest(1.0));
    let (part, record) = (format!("{output}.part"), format!("{output}.run"));
    killed(&output, &input, &[]);
    let begun = read(&part);
    let refused = |run: Run, what: &str| {
        run.refusal_with(1, &format!("{part}: it was begun {what}: give what it was begun with"));
        assert!(read(&part) == begun && !fs::exists(&output).expect("known"), "{what}");
    };
    // The other runs differ in the first answer or in none; the last hundred answers are of states at rest.
    let over = |input: &str, options: &[&str]| into(&output, input, &[&["--resume"], options].concat());
    refused(over(&strike_and_rest(2.0), &[]), "over another input");
    refused(over(&input.replacen("0.5", "0.50", 1), &[]), "over another input");
    refused(over(&input[..input.len() - 2], &[]), "over another input");
    let option = |option: [&str; 2]| {
        let friction = if option[0] == "--friction" { &[][..] } else { &["--friction", "0.5"] };
        batch(&[&["-", "-o", &output, "--resume"], friction, &option].concat(), input.as_str())
    };
    for other in [["--friction", "0.4"], ["--budget", "5"], ["--contact-tolerance", "1e-5"], ["--place", "lowest"]] {
        refused(option(other), "with other options");
    }
    let heavier = file("heavier.urdf", read(&disc()).replacen("2", "2.5", 1));
    let arguments = ["batch", &heavier, "-", "--friction", "0.5", "-o", &output, "--resume"];
    refused(heelstrike_reads(&arguments, input.as_str()), "with another robot");

    let run = option(["--threads", "1"]).well();
    assert!(run.stderr.contains("49 states were answered by an earlier run"), "{}", run.stderr);
    assert_eq!(read(&output), batch(&["-", "--friction", "0.5"], input).stdout);
    assert!(!fs::exists(&part).expect("known") && !fs::exists(&record).expect("known"));
}

#[test]
fn answers_without_a_record_are_all_compared() {
    let (output, input) = (place("whole.ndjson"), strike_and_rest(1.0));
    into(&output, &input, &[]).well();
    let whole = read(&output);
    into(&output, &strike_and_rest(2.0), &["--resume"])
        .refusal_with(1, &format!("{output}: it was begun with other answers"));
    assert_eq!(read(&output), whole);
    // The record of a `.part` file does not count for a whole file next to it.
    killed(&output, &strike_and_rest(2.0), &[]);
    fs::remove_file(format!("{output}.part")).expect("a part");
    fs::write(&output, &whole).expect("a file");
    into(&output, &strike_and_rest(2.0), &["--resume"]).refusal(1);
    assert_eq!(read(&output), whole);
    into(&output, &(input + &strike(150, 0.0)), &["--resume"]).well();
    assert_eq!(lines(read(&output).as_bytes()), 151);
    assert!(!fs::exists(format!("{output}.run")).expect("known"));
}

#[test]
fn a_refused_input_replaces_no_old_result() {
    let kept = file("kept.ndjson", "an old result");
    for arguments in [
        &["batch", &disc(), "-"][..],
        &["impact", "urdf/block.urdf", "-", "--format", "json"],
        &["impact", "urdf/block.urdf", "-", "--format", "text"],
        &["solve", "-"],
        &["sweep", "urdf/block.urdf", "-"],
    ] {
        let run = heelstrike_reads(&[arguments, &["-o", &kept]].concat(), "{\"frictoin\": 1}\n");
        assert_eq!((run.status, read(&kept).as_str()), (1, "an old result"), "{arguments:?}");
        assert!(!fs::exists(format!("{kept}.part")).expect("known"), "{arguments:?}");
    }
    // With `--refused ok` refusals are answers, which replace the old result.
    batch(&["-", "-o", &kept, "--refused", "ok"], "oops\n").well();
    assert!(read(&kept).starts_with("{\"line\":1,\"error\""));
}

/// A limit on the size of files makes writing fail as on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_old_result_and_a_part() {
    let states = file("disk.ndjson", many());
    let output = file("disk.out.ndjson", "an old result");
    let whole = batch(&[&states, "--friction", "0.5"], "").stdout;
    for (blocks, resume) in [("8", None), ("200", None), ("400", Some("--resume"))] {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let disc = disc();
        let arguments = ["batch", &disc, &states, "--friction", "0.5", "-o", &output].into_iter().chain(resume);
        let mut shell = Command::new("bash");
        let run =
            shell.args(["-c", &script, env!("CARGO_BIN_EXE_heelstrike")]).args(arguments).output().expect("it runs");
        let stderr = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(1) && stderr.contains("--resume continues them"), "{stderr}");
        let there = lines(&fs::read(format!("{output}.part")).expect("a part"));
        assert!(stderr.contains(&format!("it ends after {there} whole lines")), "{there}: {stderr}");
        assert_eq!(read(&output), "an old result");
    }
    assert_eq!(batch(&[&states, "--friction", "0.5", "-o", &output, "--resume"], "").status, 1);
    assert!(read(&output) == whole);
    assert!(batch(&[&states, "--friction", "0.5", "-o", "-", "--resume"], "").stdout == whole);
    // Columnar output cannot be continued, so no part is left.
    #[cfg(feature = "columnar")]
    {
        let output = place("disk.parquet");
        let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
        let arguments = ["batch", &disc(), &states, "--friction", "0.5", "-o", &output];
        let mut shell = Command::new("bash");
        let run =
            shell.args(["-c", script, env!("CARGO_BIN_EXE_heelstrike")]).args(arguments).output().expect("it runs");
        let stderr = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(1) && !stderr.contains("it ends after"), "{stderr}");
        assert!(!fs::exists(format!("{output}.part")).expect("known"), "{stderr}");
    }
}
