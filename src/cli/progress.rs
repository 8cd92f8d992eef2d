//! Progress of long work on a terminal: bars for long inputs and sweeps, else the elapsed time.

use super::diagnostic::is_quiet;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use std::io::{self, IsTerminal};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

/// Returns a bar for the bytes of `input`. It is hidden unless `input` is a file, standard error is a terminal, and the
/// results go elsewhere: `to_a_file`, or to a standard output that is not a terminal.
pub(super) fn over(input: &Path, to_a_file: bool) -> ProgressBar {
    let watched = to_a_file || !io::stdout().is_terminal();
    let file = if watched { std::fs::metadata(input).ok().filter(std::fs::Metadata::is_file) } else { None };
    bar(file.map(|file| file.len()), "{wide_bar} {percent}% of {total_bytes}, {eta} left")
}

/// Returns a bar for a number of pieces of work. It is hidden unless standard error is a terminal.
pub(super) fn of(pieces: usize) -> ProgressBar {
    bar(Some(pieces as u64), "{wide_bar} {percent}%, {eta} left")
}

/// The time after which a terminal shows that work is going on.
const QUIET_WORK: Duration = Duration::from_secs(2);

/// Shows the elapsed time, from two seconds on, until it is dropped.
#[must_use]
pub(super) struct Stopwatch(Option<(Sender<()>, JoinHandle<()>)>);

impl Stopwatch {
    pub fn start() -> Self {
        if !io::stderr().is_terminal() || is_quiet() {
            return Self(None);
        }
        let (end, ended) = channel();
        let show = move || {
            if ended.recv_timeout(QUIET_WORK) == Err(RecvTimeoutError::Timeout) {
                let clock = ProgressBar::new_spinner().with_finish(ProgressFinish::AndClear).with_elapsed(QUIET_WORK);
                clock.set_style(style("{spinner} at work for {elapsed}"));
                clock.enable_steady_tick(Duration::from_millis(200));
                let _ = ended.recv();
            }
        };
        Self(Builder::new().spawn(show).ok().map(|thread| (end, thread)))
    }
}

impl Drop for Stopwatch {
    fn drop(&mut self) {
        if let Some((end, thread)) = self.0.take() {
            drop(end);
            let _ = thread.join();
        }
    }
}

fn style(parts: &str) -> ProgressStyle {
    ProgressStyle::with_template(parts).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Returns a bar that is removed when its last handle is dropped; hidden without a `length` or a terminal.
fn bar(length: Option<u64>, parts: &str) -> ProgressBar {
    let Some(length) = length.filter(|_| io::stderr().is_terminal() && !is_quiet()) else {
        return ProgressBar::hidden();
    };
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    let bar = bar.with_finish(ProgressFinish::AndClear);
    bar.with_style(style(parts))
}
