//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     source --task--> thread --block--> ReorderBuffer --next block--> sink
//! ```
//!
//! Each thread takes a task from the source, answers it, and puts the block into the buffer. If all blocks before it
//! were passed on and no other thread is doing so, it passes on all blocks that are ready. A thread therefore waits
//! only if the buffer is full or the source is busy, and no thread has to be woken for a block. No answer depends on
//! another: the bytes are those of one thread.

use super::Summary;
use crate::draw::ListedKeyframe;
use crate::error::excerpt::Excerpt;
#[cfg(feature = "columnar")]
use crate::write::ColumnBlock;
use crate::{Error, Result};
use std::collections::VecDeque;
use std::mem;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, Builder};

/// Blocks per thread in the buffer: while one thread works on a slow task, the others answer this many.
pub const AHEAD: usize = 16;

/// The answers to a task.
#[derive(Debug, Default)]
pub struct Block {
    /// The answers as text.
    pub out: Vec<u8>,
    /// The answers as columns, if the output has typed columns.
    #[cfg(feature = "columnar")]
    pub columns: Option<ColumnBlock>,
    /// The records that were refused, in order.
    pub refused: Vec<RefusedRecord>,
    /// The summary of these records; see [`Summary::merge`].
    pub summary: Summary,
    /// Keyframes of the states, if requested.
    pub keyframes: Vec<ListedKeyframe>,
}

impl Block {
    /// Returns the destination of table rows.
    pub(super) fn rows(&mut self) -> Rows<'_> {
        #[cfg(feature = "columnar")]
        if let Some(columns) = &mut self.columns {
            return Rows::Columns(columns);
        }
        Rows::Text(&mut self.out)
    }
}

/// The rows of a block, as text or columns.
pub(super) enum Rows<'b> {
    Text(&'b mut Vec<u8>),
    #[cfg(feature = "columnar")]
    Columns(&'b mut ColumnBlock),
}

/// A refused record.
#[derive(Debug)]
pub struct RefusedRecord {
    /// The reason, with line and column in the input.
    pub error: Error,
    /// The shortened line, if the error has a place in it.
    pub excerpt: Option<Excerpt>,
}

/// Answers all tasks of `source` in `threads` threads, with one closure of `answerer` for each. The caller's thread is
/// one of them. If fewer threads can be started, those do the work.
///
/// The source returns the next task, or `None` at the end. It is not called again after `None` or an error. The buffer
/// holds `ahead` blocks per thread, usually [`AHEAD`]. The sink receives the answers in the order of the tasks, on the
/// thread that has the next one. The next answer may take long, so a sink that feeds a reader should not buffer blocks.
/// After an error the sink is not called again.
///
/// # Errors
/// Returns the source's error, after the answers to all tasks before it, or the sink's, once the source's call ends.
pub fn run<T, B: Send, F: FnMut(T) -> B>(
    source: impl FnMut() -> Result<Option<T>> + Send,
    threads: usize,
    ahead: usize,
    answerer: impl Fn() -> F + Sync,
    sink: impl FnMut(B) -> Result<()> + Send,
) -> Result<()> {
    in_threads(source, threads, ahead, answerer, sink, |_| Builder::new())
}

/// Runs the tasks; thread `k`, from 1, is started by `builder(k)`.
fn in_threads<T, B: Send, F: FnMut(T) -> B>(
    source: impl FnMut() -> Result<Option<T>> + Send,
    threads: usize,
    ahead: usize,
    answerer: impl Fn() -> F + Sync,
    sink: impl FnMut(B) -> Result<()> + Send,
    builder: impl Fn(usize) -> Builder,
) -> Result<()> {
    // The source, until it ends or fails.
    let source = Mutex::new(Some(source));
    let buffer = ReorderBuffer::new(ahead * threads.max(1), sink);
    // Returns the next task and its number. Threads wait here for each other, for input and for the sink.
    let next_task = || {
        let mut source = source.lock().ok()?;
        let next = source.as_mut().filter(|_| buffer.wait_for_room())?();
        if !matches!(next, Ok(Some(_))) {
            *source = None;
        }
        buffer.number(next)
    };
    let work = || {
        let _end = EndOnPanic(&buffer);
        let mut answer = answerer();
        while let Some((task, number)) = next_task() {
            buffer.put(answer(task), number);
        }
    };
    thread::scope(|scope| {
        (1..threads).map_while(|k| builder(k).spawn_scoped(scope, work).ok()).for_each(drop);
        work();
    });
    buffer.end()
}

/// Buffer for blocks that are answered before their turn, with their sink.
struct ReorderBuffer<B, K> {
    pending: Mutex<Pending<B, K>>,
    has_room: Condvar,
}

struct Pending<B, K> {
    /// The blocks from the next one for the sink on; `None` for a block that is still being answered.
    blocks: VecDeque<Option<B>>,
    capacity: usize,
    /// The number of blocks that the sink has taken.
    taken: usize,
    /// The sink; `None` while a thread uses it, and after its failure.
    sink: Option<K>,
    /// Whether a thread waits for room in the buffer.
    is_waited_for: bool,
    /// The error of the sink, or else of the source.
    error: Option<Error>,
    /// Whether no more tasks are handed out, because the sink has failed or a thread panicked.
    is_ending: bool,
}

impl<B, K: FnMut(B) -> Result<()>> ReorderBuffer<B, K> {
    fn new(capacity: usize, sink: K) -> Self {
        let pending = Pending {
            blocks: VecDeque::with_capacity(capacity),
            capacity,
            taken: 0,
            sink: Some(sink),
            is_waited_for: false,
            error: None,
            is_ending: false,
        };
        Self { pending: Mutex::new(pending), has_room: Condvar::new() }
    }

    /// Locks the blocks. Poisoning is ignored, because nothing panics while it holds the lock.
    fn lock(&self) -> MutexGuard<'_, Pending<B, K>> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until there is room for a block. Returns whether more tasks are handed out.
    fn wait_for_room(&self) -> bool {
        let is_full = |pending: &mut Pending<B, K>| {
            pending.is_waited_for = pending.blocks.len() >= pending.capacity && !pending.is_ending;
            pending.is_waited_for
        };
        !self.has_room.wait_while(self.lock(), is_full).unwrap_or_else(PoisonError::into_inner).is_ending
    }

    /// Assigns a number to a task.
    fn number<T>(&self, task: Result<Option<T>>) -> Option<(T, usize)> {
        let mut pending = self.lock();
        let task = task.unwrap_or_else(|error| {
            pending.error.get_or_insert(error);
            None
        })?;
        pending.blocks.push_back(None);
        Some((task, pending.taken + pending.blocks.len() - 1))
    }

    /// Stores the block of a task, and passes all ready blocks to the sink unless another thread does so.
    fn put(&self, block: B, number: usize) {
        let mut pending = self.lock();
        let at = number - pending.taken;
        pending.blocks[at] = Some(block);
        let Some(mut sink) = pending.sink.take() else { return };
        while let Some(block) = pending.blocks.front_mut().and_then(Option::take) {
            pending.blocks.pop_front();
            pending.taken += 1;
            self.wake(&mut pending);
            drop(pending);
            let done = sink(block);
            pending = self.lock();
            if let Err(error) = done {
                pending.error = Some(error);
                return self.stop(pending);
            }
        }
        pending.sink = Some(sink);
    }

    /// Stops handing out tasks.
    fn stop(&self, mut pending: MutexGuard<'_, Pending<B, K>>) {
        pending.is_ending = true;
        self.wake(&mut pending);
    }

    /// Wakes the thread that waits for room, if there is one.
    fn wake(&self, pending: &mut Pending<B, K>) {
        if mem::take(&mut pending.is_waited_for) {
            self.has_room.notify_one();
        }
    }

    fn end(self) -> Result<()> {
        let pending = self.pending.into_inner().unwrap_or_else(PoisonError::into_inner);
        pending.error.map_or(Ok(()), Err)
    }
}

/// Ends the other threads if one panics; otherwise they would wait for its block.
struct EndOnPanic<'b, B, K: FnMut(B) -> Result<()>>(&'b ReorderBuffer<B, K>);

impl<B, K: FnMut(B) -> Result<()>> Drop for EndOnPanic<'_, B, K> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.stop(self.0.lock());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reason;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    use std::time::{Duration, Instant};

    /// Returns the numbers below a limit, and then the end or an error.
    fn numbers(end: u32, fails: bool) -> impl FnMut() -> Result<Option<u32>> {
        let mut next = 0;
        move || {
            assert!(next <= end, "asked again after the end");
            next += 1;
            match next <= end {
                true => Ok(Some(next - 1)),
                false if fails => Err(Reason::BeyondBudget.into()),
                false => Ok(None),
            }
        }
    }

    fn written(numbers: &mut Vec<u32>) -> impl FnMut(u32) -> Result<()> {
        |number| {
            numbers.push(number);
            Ok(())
        }
    }

    /// Waits until a count is reached, and then a little longer in case it goes on.
    fn wait_until(count: &AtomicUsize, reached: usize) {
        let start = Instant::now();
        while count.load(Relaxed) < reached {
            assert!(start.elapsed() < Duration::from_secs(20), "{} of {reached}", count.load(Relaxed));
            thread::yield_now();
        }
        thread::sleep(Duration::from_millis(5));
    }

    /// Answers each number with itself, and counts.
    fn counting(answered: &AtomicUsize) -> impl Fn(u32) -> u32 + Copy {
        |number| {
            answered.fetch_add(1, Relaxed);
            number
        }
    }

    #[test]
    fn threads_that_cannot_be_started_are_done_without() {
        for missing in [vec![], vec![2], vec![1, 2]] {
            // No system has room for a stack of this size.
            let stack = |thread| if missing.contains(&thread) { usize::MAX / 4 } else { 1 << 20 };
            let builder = |thread| Builder::new().stack_size(stack(thread));
            let mut found = Vec::new();
            in_threads(numbers(1000, false), 3, AHEAD, || |number| number, written(&mut found), builder).unwrap();
            assert_eq!(found, Vec::from_iter(0..1000), "without {missing:?}");
        }
    }

    #[test]
    fn while_a_task_takes_long_the_others_fill_the_buffer_and_no_more() {
        let answered = AtomicUsize::new(0);
        let answer = |number| {
            if number == 0 {
                wait_until(&answered, 4 * AHEAD - 1);
                assert_eq!(answered.load(Relaxed), 4 * AHEAD - 1);
            }
            answered.fetch_add(1, Relaxed);
            number
        };
        let mut found = Vec::new();
        run(numbers(1000, false), 4, AHEAD, || answer, written(&mut found)).unwrap();
        assert_eq!(found, Vec::from_iter(0..1000));
    }

    #[test]
    fn a_panic_ends_all_threads_with_all_before_it_written() {
        for (panics_at, threads) in [(0, 1), (0, 3), (500, 1), (500, 2), (500, 3)] {
            let answered = AtomicUsize::new(0);
            let answer = |number| {
                if number == panics_at && threads > 1 {
                    wait_until(&answered, panics_at as usize + AHEAD);
                }
                assert_ne!(number, panics_at);
                answered.fetch_add(1, Relaxed);
                number
            };
            let mut found = Vec::new();
            let run = || run(numbers(1000, false), threads, AHEAD, || answer, written(&mut found));
            assert!(catch_unwind(AssertUnwindSafe(run)).is_err());
            assert_eq!(found, Vec::from_iter(0..panics_at));
        }
    }

    /// Collects the numbers; at the `last` one it waits until `until` numbers are answered, and fails.
    fn failing<'a>(
        written: &'a mut Vec<u32>,
        last: u32,
        answered: &'a AtomicUsize,
        until: usize,
    ) -> impl FnMut(u32) -> Result<()> {
        move |number| {
            written.push(number);
            if number < last {
                return Ok(());
            }
            wait_until(answered, until);
            Err(Error::new(Reason::Io("full".into())))
        }
    }

    #[test]
    fn nothing_is_asked_or_written_after_the_sink_has_failed() {
        for threads in 1..4 {
            let answered = AtomicUsize::new(0);
            let answer = counting(&answered);
            // The other threads answer as many as the buffer has room for.
            let until = if threads == 1 { 71 } else { 71 + AHEAD * threads };
            let mut found = Vec::new();
            let sink = failing(&mut found, 70, &answered, until);
            let error = run(numbers(u32::MAX, false), threads, AHEAD, || answer, sink).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)));
            assert_eq!((found, answered.load(Relaxed)), (Vec::from_iter(0..=70), until));
        }
    }

    #[test]
    fn the_earlier_error_is_the_one_of_all() {
        for threads in 1..4 {
            let answered = AtomicUsize::new(0);
            let answer = counting(&answered);
            let mut found = Vec::new();
            let error = run(numbers(10, true), threads, AHEAD, || answer, written(&mut found)).unwrap_err();
            assert_eq!((&found, error.reason()), (&Vec::from_iter(0..10), &Reason::BeyondBudget));
            // The source has failed before the sink does, unless there is only one thread.
            answered.store(0, Relaxed);
            let until = if threads == 1 { 4 } else { 10 };
            let sink = failing(&mut found, 3, &answered, until);
            let error = run(numbers(10, true), threads, AHEAD, || answer, sink).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)), "{error}");
            // In this case the source fails after the sink: its second call waits for the sink's failure.
            let (asked, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let source = || {
                if asked.fetch_add(1, Relaxed) == 0 {
                    return Ok(Some(()));
                }
                wait_until(&failed, 1);
                Err(Reason::BeyondBudget.into())
            };
            let answer = |()| wait_until(&asked, threads.min(2));
            let closed = |()| {
                failed.fetch_add(1, Relaxed);
                Err(Error::new(Reason::Io("closed".into())))
            };
            let error = run(source, threads, AHEAD, || answer, closed).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)), "{error}");
        }
    }

    #[test]
    fn an_answer_does_not_wait_for_the_source() {
        for threads in 1..4 {
            let (asked, written) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let mut numbers = numbers(10, false);
            // This source returns the next number only after all numbers before it are written.
            let source = || {
                wait_until(&written, asked.fetch_add(1, Relaxed));
                numbers()
            };
            let sink = |number| {
                assert_eq!(number as usize, written.fetch_add(1, Relaxed));
                Ok(())
            };
            run(source, threads, AHEAD, || |number| number, sink).unwrap();
            assert_eq!(written.into_inner(), 10);
        }
    }
}
