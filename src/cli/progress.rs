//! A progress bar for long inputs and sweeps, shown on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Read};
use std::path::Path;

/// A bar on standard error, or nothing.
pub(super) struct Progress(Option<ProgressBar>);

impl Progress {
    /// A bar for the bytes of `input`, if it is a file, standard error is a terminal, and the results go elsewhere: to
    /// standard output unless `to_a_file`.
    pub fn over(input: &Path, to_a_file: bool) -> Self {
        let watched = io::stderr().is_terminal() && (to_a_file || !io::stdout().is_terminal());
        let file = if watched { std::fs::metadata(input).ok().filter(std::fs::Metadata::is_file) } else { None };
        Self(file.map(|file| bar(file.len(), "{wide_bar} {percent}% of {total_bytes}, {eta} left")))
    }

    /// A bar for so many pieces of work, if standard error is a terminal.
    pub fn of(pieces: u64) -> Self {
        Self(io::stderr().is_terminal().then(|| bar(pieces, "{wide_bar} {percent}%, {eta} left")))
    }

    /// Adds so many pieces.
    pub fn expect(&self, pieces: u64) {
        if let Some(bar) = &self.0 {
            bar.inc_length(pieces);
        }
    }

    /// Counts one piece as done.
    pub fn step(&self) {
        if let Some(bar) = &self.0 {
            bar.inc(1);
        }
    }

    /// The same input, watched.
    pub fn watch(&self, input: Box<dyn Read + Send>) -> Box<dyn Read + Send> {
        match &self.0 {
            Some(bar) => Box::new(bar.wrap_read(input)),
            None => input,
        }
    }

    /// Writes to standard error without touching the bar.
    pub fn suspended<T>(&self, write: impl FnOnce() -> T) -> T {
        match &self.0 {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Removes the bar.
    pub fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

fn bar(length: u64, parts: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    bar.with_style(ProgressStyle::with_template(parts).unwrap_or_else(|_| ProgressStyle::default_bar()))
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}
