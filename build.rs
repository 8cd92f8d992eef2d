//! Passes the commit to the compiler, for `heelstrike --version`.
//!
//! The commit is read from the packaged crate's `.cargo_vcs_info.json`, else from the checkout that this folder is the
//! top of. Without either (no git, a copy inside another repository) the version stands alone: nothing fails, and the same
//! sources give the same binary.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let commit = packaged_commit().or_else(checked_out_commit);
    let suffix = commit.map_or(String::new(), |commit| format!(" ({commit})"));
    println!("cargo::rustc-env=HEELSTRIKE_COMMIT={suffix}");
}

/// The commit recorded by `cargo package`.
fn packaged_commit() -> Option<String> {
    const NOTE: &str = ".cargo_vcs_info.json";
    let note = std::fs::read_to_string(NOTE).ok()?;
    println!("cargo::rerun-if-changed={NOTE}");
    let (_, hash) = note.split_once("\"sha1\": \"")?;
    short(hash)
}

/// The commit of the checkout, if this folder is its top.
fn checked_out_commit() -> Option<String> {
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != Path::new(".").canonicalize().ok()? {
        return None;
    }
    // Each commit and each checkout adds a line to the log of HEAD.
    for name in ["HEAD", "logs/HEAD"] {
        let path = git(&["rev-parse", "--git-path", name])?;
        if Path::new(&path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    short(&git(&["rev-parse", "HEAD"])?)
}

/// The first twelve digits, if these are digits of a hash.
fn short(hash: &str) -> Option<String> {
    let digits = hash.get(..12)?;
    digits.bytes().all(|digit| digit.is_ascii_hexdigit()).then(|| digits.to_owned())
}

/// The output of git; `None` if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let answer = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| answer.trim_end().to_owned())
}
