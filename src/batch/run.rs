//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     Source --task--> thread --block--> ReorderBuffer --next block--> Sink
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

/// Gives tasks, one after the other.
pub trait TaskSource: Send {
    /// What a thread answers at once.
    type Task: Send;

    /// How many blocks per thread the buffer holds: while one thread takes long for a task, the others answer as many.
    const AHEAD: usize = 16;

    /// The next records; `None` at the end. After that, and after an error of reading, this is not called again.
    fn next(&mut self) -> Result<Option<Self::Task>>;
}

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

/// Takes the answers in the order of the input, on whichever thread has the next one.
pub trait Sink<B = Block>: Send {
    /// Takes the next answers. More may take long to arrive, so that a sink that others read keeps none back.
    ///
    /// # Errors
    /// Those of writing; this is not called again then.
    fn block(&mut self, block: B) -> Result<()>;
}

/// Answers all tasks of `source` in `threads` threads, the caller's among them, each with what `answerer` makes. If fewer
/// can be started, these do the work.
///
/// # Errors
/// Those of the source, with all before it answered, and of the sink, once the source's current call of `next` returns.
pub fn run<S: TaskSource, B: Send, F: FnMut(S::Task) -> B>(
    source: S,
    threads: usize,
    answerer: impl Fn() -> F + Sync,
    sink: &mut impl Sink<B>,
) -> Result<()> {
    in_threads(source, threads, answerer, sink, |_| Builder::new())
}

/// Starts thread `k`, from 1, by `builder(k)`.
fn in_threads<S: TaskSource, B: Send, F: FnMut(S::Task) -> B>(
    source: S,
    threads: usize,
    answerer: impl Fn() -> F + Sync,
    sink: &mut impl Sink<B>,
    builder: impl Fn(usize) -> Builder,
) -> Result<()> {
    // Until it ends or fails.
    let source = Mutex::new(Some(source));
    let buffer = ReorderBuffer::new(S::AHEAD * threads.max(1), sink);
    // The next task and its number. Here a thread waits for the others, for input and for the sink.
    let next_task = || {
        let mut source = source.lock().ok()?;
        let next = source.as_mut().filter(|_| buffer.wait_for_room())?.next();
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
struct ReorderBuffer<'s, B, K> {
    pending: Mutex<Pending<'s, B, K>>,
    has_room: Condvar,
}

struct Pending<'s, B, K> {
    /// From the block that the sink takes next; `None` while it is answered.
    blocks: VecDeque<Option<B>>,
    capacity: usize,
    /// How many blocks the sink has taken.
    taken: usize,
    /// `None` while a thread uses it, and after its failure.
    sink: Option<&'s mut K>,
    /// Whether a thread waits for room.
    is_waited_for: bool,
    /// Of the sink, or else of the source.
    error: Option<Error>,
    /// Whether no more tasks are taken, since the sink has failed or a thread panicked.
    is_ending: bool,
}

impl<'s, B, K: Sink<B>> ReorderBuffer<'s, B, K> {
    fn new(capacity: usize, sink: &'s mut K) -> Self {
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
    fn lock(&self) -> MutexGuard<'_, Pending<'s, B, K>> {
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
        let Some(sink) = pending.sink.take() else { return };
        while let Some(block) = pending.blocks.front_mut().and_then(Option::take) {
            pending.blocks.pop_front();
            pending.taken += 1;
            self.wake(&mut pending);
            drop(pending);
            let done = sink.block(block);
            pending = self.lock();
            if let Err(error) = done {
                pending.error = Some(error);
                return self.stop(pending);
            }
        }
        pending.sink = Some(sink);
    }

    /// Lets no more tasks be taken.
    fn stop(&self, mut pending: MutexGuard<'_, Pending<'s, B, K>>) {
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
struct EndOnPanic<'b, 's, B, K: Sink<B>>(&'b ReorderBuffer<'s, B, K>);

impl<B, K: Sink<B>> Drop for EndOnPanic<'_, '_, B, K> {
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
    struct Numbers {
        next: u32,
        end: u32,
        fails: bool,
    }

    fn numbers(end: u32) -> Numbers {
        Numbers { next: 0, end, fails: false }
    }

    impl TaskSource for Numbers {
        type Task = u32;

        fn next(&mut self) -> Result<Option<u32>> {
            assert!(self.next <= self.end, "asked again after the end");
            self.next += 1;
            match self.next <= self.end {
                true => Ok(Some(self.next - 1)),
                false if self.fails => Err(Reason::BeyondBudget.into()),
                false => Ok(None),
            }
        }
    }

    impl Sink<u32> for Vec<u32> {
        fn block(&mut self, number: u32) -> Result<()> {
            self.push(number);
            Ok(())
        }
    }

    const AHEAD: usize = Numbers::AHEAD;

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
            let mut written = Vec::new();
            in_threads(numbers(1000), 3, || |number| number, &mut written, builder).unwrap();
            assert_eq!(written, Vec::from_iter(0..1000), "without {missing:?}");
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
        let mut written = Vec::new();
        run(numbers(1000), 4, || answer, &mut written).unwrap();
        assert_eq!(written, Vec::from_iter(0..1000));
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
            let mut written = Vec::new();
            let run = || run(numbers(1000), threads, || answer, &mut written);
            assert!(catch_unwind(AssertUnwindSafe(run)).is_err());
            assert_eq!(written, Vec::from_iter(0..panics_at));
        }
    }

    /// Counts the numbers; at the last one it waits until so many are answered, and fails.
    struct Failing<'a> {
        written: Vec<u32>,
        last: u32,
        until: usize,
        answered: &'a AtomicUsize,
    }

    impl Sink<u32> for Failing<'_> {
        fn block(&mut self, number: u32) -> Result<()> {
            self.written.push(number);
            if number < self.last {
                return Ok(());
            }
            wait_until(self.answered, self.until);
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
            let mut sink = Failing { written: Vec::new(), last: 70, until, answered: &answered };
            let error = run(numbers(u32::MAX), threads, || answer, &mut sink).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)));
            assert_eq!((sink.written, answered.load(Relaxed)), (Vec::from_iter(0..=70), until));
        }
    }

    #[test]
    fn the_earlier_error_is_the_one_of_all() {
        for threads in 1..4 {
            let answered = AtomicUsize::new(0);
            let answer = counting(&answered);
            let failing = || Numbers { fails: true, ..numbers(10) };
            let mut written = Vec::new();
            let error = run(failing(), threads, || answer, &mut written).unwrap_err();
            assert_eq!((written, error.reason()), (Vec::from_iter(0..10), &Reason::BeyondBudget));
            // By then the source has failed, unless one thread does all.
            answered.store(0, Relaxed);
            let until = if threads == 1 { 4 } else { 10 };
            let mut sink = Failing { written: Vec::new(), last: 3, until, answered: &answered };
            let error = run(failing(), threads, || answer, &mut sink).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)), "{error}");
            // Or it fails afterwards.
            let (asked, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let answer = |()| wait_until(&asked, threads.min(2));
            let error = run(Late(&asked, &failed), threads, || answer, &mut Closed(&failed)).unwrap_err();
            assert!(matches!(error.reason(), Reason::Io(_)), "{error}");
        }
    }

    /// Counts how often it is asked; the second time it fails once the sink has.
    struct Late<'a>(&'a AtomicUsize, &'a AtomicUsize);

    impl TaskSource for Late<'_> {
        type Task = ();

        fn next(&mut self) -> Result<Option<()>> {
            if self.0.fetch_add(1, Relaxed) == 0 {
                return Ok(Some(()));
            }
            wait_until(self.1, 1);
            Err(Reason::BeyondBudget.into())
        }
    }

    /// Fails at once.
    struct Closed<'a>(&'a AtomicUsize);

    impl Sink<()> for Closed<'_> {
        fn block(&mut self, _: ()) -> Result<()> {
            self.0.fetch_add(1, Relaxed);
            Err(Error::new(Reason::Io("closed".into())))
        }
    }

    /// Gives the next number once all before it are written.
    struct Live<'a>(Numbers, &'a AtomicUsize);

    impl TaskSource for Live<'_> {
        type Task = u32;

        fn next(&mut self) -> Result<Option<u32>> {
            wait_until(self.1, self.0.next as usize);
            self.0.next()
        }
    }

    struct Counting<'a>(&'a AtomicUsize);

    impl Sink<u32> for Counting<'_> {
        fn block(&mut self, number: u32) -> Result<()> {
            assert_eq!(number as usize, self.0.fetch_add(1, Relaxed));
            Ok(())
        }
    }

    #[test]
    fn an_answer_does_not_wait_for_the_source() {
        for threads in 1..4 {
            let written = AtomicUsize::new(0);
            run(Live(numbers(10), &written), threads, || |number| number, &mut Counting(&written)).unwrap();
            assert_eq!(written.into_inner(), 10);
        }
    }
}
