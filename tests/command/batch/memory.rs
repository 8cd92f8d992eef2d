//! The memory of a batch does not grow with the number of lines.

use super::*;

/// Peak resident memory of a batch of this many lines, as the kernel counts it \[kB\].
#[cfg(target_os = "linux")]
fn peak(lines: usize, arguments: &[&str]) -> u64 {
    let mut command = batching(&["-", "--friction", "0.5", "--threads", "4"]);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = command.spawn().expect("it runs");
    let header = if arguments.contains(&"csv") { "id,q_base_z,v_base_x,v_base_z\n" } else { "" };
    let line = move |id: usize| match (header.is_empty(), id % 10) {
        (true, 9) => "oops\n".to_owned(),
        (true, _) => strike(id, id as f64 * 1e-6),
        (false, 9) => format!("{id},oops,0,-1\n"),
        (false, _) => format!("{id},0.5,{},-1\n", id as f64 * 1e-6),
    };
    let mut stdin = child.stdin.take().expect("piped");
    let writer = std::thread::spawn(move || -> ChildStdin {
        stdin.write_all(header.as_bytes()).expect("it reads");
        for start in (0..lines).step_by(1000) {
            let text: String = (start..start + 1000).map(line).collect();
            stdin.write_all(text.as_bytes()).expect("it reads");
        }
        stdin
    });
    let answers = BufReader::new(child.stdout.take().expect("piped")).lines().take(lines).count();
    assert_eq!(answers, lines);
    // The process still waits for input, because its standard input is open.
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).expect("Linux has it");
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB")?.trim().parse().ok());
    drop(writer.join().expect("it ends"));
    child.wait().expect("it ends");
    peak.expect("a number")
}

#[cfg(target_os = "linux")]
#[test]
fn ten_times_the_lines_take_no_more_memory() {
    for arguments in [&[][..], &["--input-format", "csv"]] {
        let [few, many] = [20_000, 200_000].map(|lines| peak(lines, arguments));
        // Blocks of lines that wait for each other make a difference of a few hundred kB by chance. If lines were kept,
        // they would take 20 MB and more.
        assert!(many < few * 3 / 2 + 4000, "{arguments:?}: {few} kB for 20,000 lines, {many} kB for 200,000");
    }
}
