//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     source --task--> thread --block--> ReorderBuffer --next block--> sink
//! ```
//!
//! Each thread takes a task from the source, answers it, and puts the block into the buffer. If all blocks before it
//! were handed on, and no other thread does so, it hands on what is ready. So no thread waits for another unless
//! the buffer is full or the source busy, and none has to be woken for a block. No answer depends on another: the bytes
//! are those of one thread.

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

/// How many blocks per thread the buffer usually holds: while one thread takes long for a task, the others answer as many.
pub const AHEAD: usize = 16;

/// The answers to a task.
#[derive(Debug, Default)]
pub struct Block {
    /// The answers as text.
    pub out: Vec<u8>,
    /// The answers as columns, if these are asked for.
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

/// Answers all tasks of `source` in `threads` threads, the caller's among them, each with what `answerer` makes. If fewer
/// can be started, these do the work.
///
/// The source gives the next task, or `None` at the end; after that, and after an error of reading, it is not asked again.
/// The buffer holds so many blocks per thread `ahead`, usually [`AHEAD`]. The sink takes the answers in the order of the
/// tasks, on whichever thread has the next one; more may take long to arrive, so that a sink that others read keeps none
/// back. After an error of writing it is not called again.
///
/// # Errors
/// Those of the source, with all before it answered, and of the sink, once the source's current call returns.
pub fn run<T, B: Send, F: FnMut(T) -> B>(
    source: impl FnMut() -> Result<Option<T>> + Send,
    threads: usize,
    ahead: usize,
    answerer: impl Fn() -> F + Sync,
    sink: impl FnMut(B) -> Result<()> + Send,
) -> Result<()> {
    in_threads(source, threads, ahead, answerer, sink, |_| Builder::new())
}

/// Starts thread `k`, from 1, by `builder(k)`.
fn in_threads<T, B: Send, F: FnMut(T) -> B>(
    source: impl FnMut() -> Result<Option<T>> + Send,
    threads: usize,
    ahead: usize,
    answerer: impl Fn() -> F + Sync,
    sink: impl FnMut(B) -> Result<()> + Send,
    builder: impl Fn(usize) -> Builder,
) -> Result<()> {
    // Until it ends or fails.
    let source = Mutex::new(Some(source));
    let buffer = ReorderBuffer::new(ahead * threads.max(1), sink);
    // The next task and its number. Here a thread waits for the others, for input and for the sink.
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

/// The blocks that are answered before their turn, and where they go.
struct ReorderBuffer<B, K> {
    pending: Mutex<Pending<B, K>>,
    has_room: Condvar,
}

struct Pending<B, K> {
    /// From the block that the sink takes next; `None` while it is answered.
    blocks: VecDeque<Option<B>>,
    capacity: usize,
    /// How many blocks the sink has taken.
    taken: usize,
    /// `None` while a thread uses it, and after its failure.
    sink: Option<K>,
    /// Whether a thread waits for room.
    is_waited_for: bool,
    /// Of the sink, or else of the source.
    error: Option<Error>,
    /// Whether no more tasks are taken, since the sink has failed or a thread panicked.
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

    /// Nothing panics while it holds the blocks.
    fn lock(&self) -> MutexGuard<'_, Pending<B, K>> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until there is room for a block; whether any more is taken.
    fn wait_for_room(&self) -> bool {
        let is_full = |pending: &mut Pending<B, K>| {
            pending.is_waited_for = pending.blocks.len() >= pending.capacity && !pending.is_ending;
            pending.is_waited_for
        };
        !self.has_room.wait_while(self.lock(), is_full).unwrap_or_else(PoisonError::into_inner).is_ending
    }

    /// Numbers a task.
    fn number<T>(&self, task: Result<Option<T>>) -> Option<(T, usize)> {
        let mut pending = self.lock();
        let task = task.unwrap_or_else(|error| {
            pending.error.get_or_insert(error);
            None
        })?;
        pending.blocks.push_back(None);
        Some((task, pending.taken + pending.blocks.len() - 1))
    }

    /// Takes the block of a task, and gives the sink what is ready unless another thread does.
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

    /// Lets no more tasks be taken.
    fn stop(&self, mut pending: MutexGuard<'_, Pending<B, K>>) {
        pending.is_ending = true;
        self.wake(&mut pending);
    }

    /// Wakes the thread that waits for room.
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

/// Lets the other threads end if one panics, for whose block they would wait.
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

    /// The numbers below a limit, and then the end or an error.
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

    /// Until a count is reached, and then until it might have gone on.
    fn wait_until(count: &AtomicUsize, reached: usize) {
        let start = Instant::now();
        while count.load(Relaxed) < reached {
            assert!(start.elapsed() < Duration::from_secs(20), "{} of {reached}", count.load(Relaxed));
            thread::yield_now();
        }
        thread::sleep(Duration::from_millis(5));
    }

    /// Answers each number by itself.
    fn counting(answered: &AtomicUsize) -> impl Fn(u32) -> u32 + Copy {
        |number| {
            answered.fetch_add(1, Relaxed);
            number
        }
    }

    #[test]
    fn threads_that_cannot_be_started_are_done_without() {
        for missing in [vec![], vec![2], vec![1, 2]] {
            // No system has room for such a stack.
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

    /// Writes the numbers; at the last one it waits until so many are answered, and fails.
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
            // The other threads answer what there is room for.
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
            // By then the source has failed, unless one thread does all.
            answered.store(0, Relaxed);
            let until = if threads == 1 { 4 } else { 10 };
            let sink = failing(&mut found, 3, &answered, until);
            let error = run(numbers(10, true), threads, AHEAD, || answer, sink).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)), "{error}");
            // Or it fails afterwards: asked for the second time, once the sink has.
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
            // It gives the next number once all before it are written.
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
