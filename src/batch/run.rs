//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     Source --tasks--> threads, each with its own answerer --blocks--┐
//!        └─────────────────── places of the blocks ───────────────┴──> Sink, on the caller's thread
//! ```
//!
//! A thread that is free takes the next task from the source itself, and announces to the sink where its block will
//! appear. The announcements are bounded, and so is the memory. No answer depends on another: the bytes are those of
//! one thread.

use super::Summary;
use crate::draw::ListedKeyframe;
use crate::error::excerpt::Excerpt;
#[cfg(feature = "columnar")]
use crate::write::ColumnBlock;
use crate::{Error, Result};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread::{self, Builder};
use std::time::{Duration, Instant};

/// Tasks in flight per thread.
const AHEAD: usize = 2;

/// The most records of a task: few, so that the threads share short inputs, and more while these take less than
/// [`QUICK`], since to wake a thread for a task takes as long as some records.
const FEW: usize = 16;
const MANY: usize = 64;
const QUICK: Duration = Duration::from_millis(1);

/// Gives tasks, one after the other.
pub trait TaskSource: Send {
    type Task: Send;

    /// The next records, at most so many if the source does not cut its tasks itself; `None` at the end. After an error of
    /// reading this is not called again.
    fn next(&mut self, most: usize) -> Result<Option<Self::Task>>;

    /// Whether the next records may take long to arrive.
    fn keeps_waiting(&self) -> bool {
        false
    }
}

/// The answers to a task.
#[derive(Debug, Default)]
pub struct Block {
    pub out: Vec<u8>,
    /// The answers as columns, if these are asked for.
    #[cfg(feature = "columnar")]
    pub columns: Option<ColumnBlock>,
    pub refused: Vec<RefusedRecord>,
    /// The summary of these records; see [`Summary::merge`].
    pub summary: Summary,
    /// Keyframes of the states, if requested.
    pub keyframes: Vec<ListedKeyframe>,
}

impl Block {
    /// Where rows of a table go.
    pub(super) fn rows(&mut self) -> Rows<'_> {
        #[cfg(feature = "columnar")]
        if let Some(columns) = &mut self.columns {
            return Rows::Columns(columns);
        }
        Rows::Text(&mut self.out)
    }
}

/// The rows of a block.
pub(super) enum Rows<'b> {
    Text(&'b mut Vec<u8>),
    #[cfg(feature = "columnar")]
    Columns(&'b mut ColumnBlock),
}

/// A refused record.
#[derive(Debug)]
pub struct RefusedRecord {
    /// Why, with line and column in the input.
    pub error: Error,
    /// The line, shortened, if a place in it is refused.
    pub excerpt: Option<Excerpt>,
}

/// Takes the answers in the order of the input.
pub trait Sink<B = Block> {
    /// Takes the next answers.
    ///
    /// # Errors
    /// Those of writing; this is not called again then.
    fn block(&mut self, block: B) -> Result<()>;

    /// Writes what is buffered: everything read so far is answered, and the input pauses or has ended.
    ///
    /// # Errors
    /// As above.
    fn idle(&mut self) -> Result<()>;
}

/// Answers all tasks of `source` in `threads` threads, each with what `answerer` makes; with one thread none is
/// started. If fewer threads can be started, these do the work.
///
/// # Errors
/// Those of the source, with all before it answered, and of the sink, once the source's current call of `next` returns.
pub fn run<S: TaskSource, B: Send, F: FnMut(S::Task) -> B>(
    source: S,
    threads: usize,
    answerer: impl Fn() -> F + Sync,
    sink: &mut impl Sink<B>,
) -> Result<()> {
    if threads > 1 {
        in_threads(source, threads, answerer, sink, |_| Builder::new())
    } else {
        alone(source, answerer(), sink)
    }
}

fn alone<S: TaskSource, B>(mut source: S, mut answer: impl FnMut(S::Task) -> B, sink: &mut impl Sink<B>) -> Result<()> {
    while let Some(task) = source.next(FEW)? {
        sink.block(answer(task))?;
        if source.keeps_waiting() {
            sink.idle()?;
        }
    }
    sink.idle()
}

/// Starts thread `k` by `builder(k)`.
fn in_threads<S: TaskSource, B: Send, F: FnMut(S::Task) -> B>(
    source: S,
    threads: usize,
    answerer: impl Fn() -> F + Sync,
    sink: &mut impl Sink<B>,
    builder: impl Fn(usize) -> Builder,
) -> Result<()> {
    let (places, ordered) = sync_channel(AHEAD * threads);
    // Until it ends or fails, or the sink does.
    let source = Mutex::new(Some((source, places)));
    let most = AtomicUsize::new(FEW);
    // The next task and the channel for its block. Here a thread waits for the others, for input and for the sink.
    let next_job = || {
        let mut left = source.lock().ok()?;
        let (mut source, places) = left.take()?;
        let (block, place) = sync_channel(1);
        let (task, place) = match source.next(most.load(Relaxed)).transpose()? {
            Ok(task) => (Some(task), Ok(place)),
            Err(error) => (None, Err(error)),
        };
        places.send(place).ok()?;
        *left = task.is_some().then_some((source, places));
        Some((task?, block))
    };
    let work = || {
        let mut answer = answerer();
        while let Some((task, block)) = next_job() {
            let start = Instant::now();
            if block.send(answer(task)).is_err() {
                break;
            }
            let is_quick = start.elapsed() < QUICK;
            most.store(if is_quick { (2 * most.load(Relaxed)).min(MANY) } else { FEW }, Relaxed);
        }
    };
    thread::scope(|scope| {
        let started = (0..threads).map_while(|k| builder(k).spawn_scoped(scope, work).ok()).count();
        if started > 0 {
            return hand_on(ordered, sink);
        }
        let left = source.lock().ok().and_then(|mut left| left.take());
        left.map_or(Ok(()), |(source, _)| alone(source, answerer(), sink))
    })
}

/// Gives the sink the blocks in the order of their places.
fn hand_on<B>(ordered: Receiver<Result<Receiver<B>>>, sink: &mut impl Sink<B>) -> Result<()> {
    loop {
        let place = match ordered.try_recv() {
            Err(TryRecvError::Empty) => {
                sink.idle()?;
                ordered.recv().ok()
            }
            place => place.ok(),
        };
        let Some(place) = place else { return sink.idle() };
        // A thread whose block is missing has panicked, which the end of the scope passes on.
        let Ok(block) = place?.recv() else { return Ok(()) };
        sink.block(block)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers below a limit.
    struct Numbers(u32, u32);

    impl TaskSource for Numbers {
        type Task = u32;

        fn next(&mut self, _: usize) -> Result<Option<u32>> {
            self.0 += 1;
            Ok((self.0 <= self.1).then_some(self.0 - 1))
        }
    }

    impl Sink for Vec<u8> {
        fn block(&mut self, block: Block) -> Result<()> {
            self.extend(block.out);
            Ok(())
        }

        fn idle(&mut self) -> Result<()> {
            Ok(())
        }
    }

    /// How many records are asked for, call by call.
    struct Asked<'a>(usize, &'a Mutex<Vec<usize>>);

    impl TaskSource for Asked<'_> {
        type Task = ();

        fn next(&mut self, most: usize) -> Result<Option<()>> {
            self.1.lock().unwrap().push(most);
            self.0 -= 1;
            Ok((self.0 > 0).then_some(()))
        }
    }

    #[test]
    fn tasks_grow_only_while_they_are_quick() {
        let asked = |takes: Duration| {
            let asked = Mutex::default();
            let wait = |()| {
                thread::sleep(takes);
                Block::default()
            };
            run(Asked(50, &asked), 2, || wait, &mut Vec::new()).unwrap();
            asked.into_inner().unwrap()
        };
        let quick = asked(Duration::ZERO);
        assert!(quick[0] == FEW && quick.contains(&MANY), "{quick:?}");
        assert!(asked(2 * QUICK).iter().all(|&most| most == FEW));
    }

    #[test]
    fn threads_that_cannot_be_started_are_done_without() {
        let expected: String = (0..100).map(|number| format!("{number}\n")).collect();
        for missing in [vec![], vec![2], vec![1, 2], vec![0], vec![0, 1, 2]] {
            // No system has room for such a stack.
            let stack = |thread| if missing.contains(&thread) { usize::MAX / 4 } else { 1 << 20 };
            let builder = |thread| Builder::new().stack_size(stack(thread));
            let mut written = Vec::new();
            let line = |task| Block { out: format!("{task}\n").into(), ..Block::default() };
            in_threads(Numbers(0, 100), 3, || line, &mut written, builder).unwrap();
            assert_eq!(String::from_utf8(written).unwrap(), expected, "without {missing:?}");
        }
    }
}
