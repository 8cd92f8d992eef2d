//! Bounds on time and memory: a violation is reported with its case.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{LazyLock, Mutex, MutexGuard};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// What a case may take of a processor.
const SLOW: Duration = Duration::from_secs(2);
/// After this it will not end.
const HANGS: Duration = Duration::from_secs(60);
/// What the process may hold \[bytes\].
const MEMORY: u64 = 1 << 30;

/// A case under way.
struct Case {
    thread: ThreadId,
    start: Instant,
    text: String,
}

/// The cases under way, with a thread that looks after them.
static RUNNING: LazyLock<Mutex<Vec<Case>>> = LazyLock::new(|| {
    thread::spawn(|| {
        loop {
            thread::sleep(Duration::from_millis(100));
            look();
        }
    });
    Mutex::default()
});

fn running() -> MutexGuard<'static, Vec<Case>> {
    RUNNING.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Prints what is under way and ends the process once a case does not end or the memory is too much.
fn look() {
    let memory = resident();
    for case in running().iter() {
        let taken = case.start.elapsed();
        if taken > HANGS || memory > MEMORY {
            eprintln!("{} MB after {taken:?}:\n{}", memory >> 20, case.text);
            std::process::abort();
        }
    }
}

/// Memory of the process \[bytes\]; 0 where the system does not report it.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok());
    4096 * pages.unwrap_or(0)
}

/// What this thread had of a processor, which other work on the machine does not change; else the time since `start`.
fn spent(start: Instant) -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let own = text.split(' ').next().and_then(|nanoseconds| nanoseconds.parse().ok());
    own.map_or_else(|| start.elapsed(), Duration::from_nanos)
}

/// Runs the case described by `text` within the bounds, and prints it if it panics.
pub fn watched<T>(text: &str, run: impl FnOnce() -> T) -> T {
    watched_for(SLOW, text, run)
}

/// The same for a case that may take so long of a processor.
pub fn watched_for<T>(slow: Duration, text: &str, run: impl FnOnce() -> T) -> T {
    let (thread, start) = (thread::current().id(), Instant::now());
    let before = spent(start);
    running().push(Case { thread, start, text: text.to_owned() });
    let result = catch_unwind(AssertUnwindSafe(run));
    running().retain(|case| case.thread != thread);
    let taken = spent(start).saturating_sub(before);
    let result = result.unwrap_or_else(|panic| {
        println!("this panics:\n{text}");
        resume_unwind(panic)
    });
    assert!(taken < slow, "takes {taken:?}:\n{text}");
    result
}
