//! The command from start to end, as an engine pays for it that starts one process per partition.
//!
//! `cargo bench --bench startup` prints times; they include what the operating system takes to start any process.

use divan::Bencher;
use std::process::{Command, Stdio};

fn main() {
    divan::main();
}

/// Runs the command to its end, its input empty.
fn run(arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_heelstrike"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments);
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    assert!(status.expect("it runs").success(), "{arguments:?}");
}

/// The least that the command does.
#[divan::bench]
fn version(bencher: Bencher) {
    bencher.bench_local(|| run(&["--version"]));
}

/// One state.
#[divan::bench]
fn impact(bencher: Bencher) {
    bencher.bench_local(|| run(&["impact", "urdf/ramone.urdf", "examples/ramone.json"]));
}

/// All threads and a few lines.
#[divan::bench]
fn short_batch(bencher: Bencher) {
    let arguments = ["batch", "urdf/minimalistic.urdf", "examples/keyframes.ndjson", "--friction", "0.8"];
    bencher.bench_local(|| run(&arguments));
}
