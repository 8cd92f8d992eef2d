//! A progress bar for long inputs and sweeps, shown on a terminal.

use super::diagnostic::is_quiet;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use std::io::{self, IsTerminal};
use std::path::Path;

/// A bar for the bytes of `input`, if it is a file, standard error is a terminal, and the results go elsewhere: to
/// standard output unless `to_a_file`; else one that is hidden.
pub(super) fn over(input: &Path, to_a_file: bool) -> ProgressBar {
    let watched = to_a_file || !io::stdout().is_terminal();
    let file = if watched { std::fs::metadata(input).ok().filter(std::fs::Metadata::is_file) } else { None };
    bar(file.map(|file| file.len()), "{wide_bar} {percent}% of {total_bytes}, {eta} left")
}

/// A bar for so many pieces of work, if standard error is a terminal.
pub(super) fn of(pieces: usize) -> ProgressBar {
    bar(Some(pieces as u64), "{wide_bar} {percent}%, {eta} left")
}

/// It is removed when the last handle to it is dropped.
fn bar(length: Option<u64>, parts: &str) -> ProgressBar {
    let Some(length) = length.filter(|_| io::stderr().is_terminal() && !is_quiet()) else {
        return ProgressBar::hidden();
    };
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    let bar = bar.with_finish(ProgressFinish::AndClear);
    bar.with_style(ProgressStyle::with_template(parts).unwrap_or_else(|_| ProgressStyle::default_bar()))
}
