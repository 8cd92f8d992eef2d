//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     Source --task--> thread --block--> Line --next block--> Sink
//! ```
//!
//! Each thread takes a task from the source, answers it, and puts the block in its place in the line; if the blocks before
//! it have left, it also hands on what is ready. So no thread waits for another unless the line is full or the
//! source is busy, and none has to be woken for a block. No answer depends on another: the bytes are those of one thread.

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

/// Places in the line per thread: as long as a thread takes for a slow task, the others go on.
const AHEAD: usize = 4;

/// Gives tasks, one after the other.
pub trait TaskSource: Send {
    type Task: Send;

    /// The next records; `None` at the end. After that, and after an error of reading, this is not called again.
    fn next(&mut self) -> Result<Option<Self::Task>>;
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

/// Takes the answers in the order of the input, on whichever thread has the next one.
pub trait Sink<B = Block>: Send {
    /// Takes the next answers.
    ///
    /// # Errors
    /// Those of writing; nothing here is called again then.
    fn block(&mut self, block: B) -> Result<()>;

    /// Writes what is buffered: everything read so far is answered, and more may take long to arrive.
    ///
    /// # Errors
    /// As above.
    fn idle(&mut self) -> Result<()>;
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
    let line = Line::new(AHEAD * threads.max(1), sink);
    // The next task and its place. Here a thread waits for the others, for input and for the sink.
    let next_task = || {
        let mut left = source.lock().ok()?;
        line.wait_for_room();
        let next = left.as_mut().filter(|_| !line.lock().is_broken)?.next();
        if !matches!(next, Ok(Some(_))) {
            *left = None;
        }
        line.place(next)
    };
    let work = || {
        let _break = BreakOnPanic(&line);
        let mut answer = answerer();
        while let Some((task, place)) = next_task() {
            line.put(answer(task), place);
        }
    };
    thread::scope(|scope| {
        (1..threads).map_while(|k| builder(k).spawn_scoped(scope, work).ok()).for_each(drop);
        work();
    });
    line.end()
}

/// The blocks that are answered, in order, and where they go.
struct Line<'s, B, K> {
    places: Mutex<Places<'s, B, K>>,
    freed: Condvar,
}

struct Places<'s, B, K> {
    /// From the block that the sink takes next; `None` while it is answered.
    blocks: VecDeque<Option<B>>,
    /// How many places there are.
    room: usize,
    /// How many blocks the sink has taken.
    taken: usize,
    /// `None` while a thread uses it.
    sink: Option<&'s mut K>,
    /// Whether the sink has taken blocks since it was idle.
    is_behind: bool,
    /// Whether a thread waits for room.
    is_awaited: bool,
    /// Of the sink, or else of the source.
    error: Option<Error>,
    /// Whether the sink has failed or a thread panicked, so that the sink takes nothing any more.
    is_broken: bool,
}

impl<'s, B, K: Sink<B>> Line<'s, B, K> {
    fn new(room: usize, sink: &'s mut K) -> Self {
        let places = Places {
            blocks: VecDeque::with_capacity(room),
            room,
            taken: 0,
            sink: Some(sink),
            is_behind: false,
            is_awaited: false,
            error: None,
            is_broken: false,
        };
        Self { places: Mutex::new(places), freed: Condvar::new() }
    }

    /// Nothing panics while it holds the places.
    fn lock(&self) -> MutexGuard<'_, Places<'s, B, K>> {
        self.places.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns once a block has room, or none is taken any more.
    fn wait_for_room(&self) {
        let is_full = |places: &mut Places<B, K>| {
            places.is_awaited = places.blocks.len() >= places.room && !places.is_broken;
            places.is_awaited
        };
        drop(self.freed.wait_while(self.lock(), is_full));
    }

    /// Gives a task its place.
    fn place<T>(&self, task: Result<Option<T>>) -> Option<(T, usize)> {
        let mut places = self.lock();
        let task = task.unwrap_or_else(|error| {
            places.error.get_or_insert(error);
            None
        })?;
        places.blocks.push_back(None);
        Some((task, places.taken + places.blocks.len() - 1))
    }

    /// Puts a block in its place, and gives the sink what is ready unless another thread does.
    fn put(&self, block: B, place: usize) {
        let mut places = self.lock();
        let at = place - places.taken;
        places.blocks[at] = Some(block);
        let Some(sink) = places.sink.take() else { return };
        while let Some(next) = places.next() {
            self.wake(&mut places);
            drop(places);
            let done = match next {
                Next::Block(block) => sink.block(block),
                Next::Pause => sink.idle(),
            };
            places = self.lock();
            if let Err(error) = done {
                places.error = Some(error);
                places.is_broken = true;
                self.wake(&mut places);
            }
        }
        places.sink = Some(sink);
    }

    /// Wakes the thread that waits for room.
    fn wake(&self, places: &mut Places<B, K>) {
        if mem::take(&mut places.is_awaited) {
            self.freed.notify_one();
        }
    }

    fn end(self) -> Result<()> {
        let places = self.places.into_inner().unwrap_or_else(PoisonError::into_inner);
        places.error.map_or(Ok(()), Err)
    }
}

/// What the sink does next.
enum Next<B> {
    Block(B),
    Pause,
}

impl<B, K> Places<'_, B, K> {
    fn next(&mut self) -> Option<Next<B>> {
        if self.is_broken {
            return None;
        }
        let Some(first) = self.blocks.front_mut() else {
            return mem::take(&mut self.is_behind).then_some(Next::Pause);
        };
        let block = first.take()?;
        self.blocks.pop_front();
        self.taken += 1;
        self.is_behind = true;
        Some(Next::Block(block))
    }
}

/// Lets the other threads end if one panics, whose block they would wait for.
struct BreakOnPanic<'l, 's, B, K: Sink<B>>(&'l Line<'s, B, K>);

impl<B, K: Sink<B>> Drop for BreakOnPanic<'_, '_, B, K> {
    fn drop(&mut self) {
        if thread::panicking() {
            let mut places = self.0.lock();
            places.is_broken = true;
            self.0.wake(&mut places);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reason;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    use std::time::Duration;

    /// The numbers below a limit.
    struct Numbers(u32, u32);

    impl TaskSource for Numbers {
        type Task = u32;

        fn next(&mut self) -> Result<Option<u32>> {
            self.0 += 1;
            Ok((self.0 <= self.1).then_some(self.0 - 1))
        }
    }

    impl Sink<u32> for Vec<u32> {
        fn block(&mut self, number: u32) -> Result<()> {
            self.push(number);
            Ok(())
        }

        fn idle(&mut self) -> Result<()> {
            Ok(())
        }
    }

    #[test]
    fn threads_that_cannot_be_started_are_done_without() {
        for missing in [vec![], vec![2], vec![1, 2]] {
            // No system has room for such a stack.
            let stack = |thread| if missing.contains(&thread) { usize::MAX / 4 } else { 1 << 20 };
            let builder = |thread| Builder::new().stack_size(stack(thread));
            let mut numbers = Vec::new();
            in_threads(Numbers(0, 1000), 3, || |number| number, &mut numbers, builder).unwrap();
            assert_eq!(numbers, Vec::from_iter(0..1000), "without {missing:?}");
        }
    }

    #[test]
    fn a_thread_with_a_slow_task_keeps_the_others_from_filling_the_memory() {
        let answered = AtomicUsize::new(0);
        let answer = |number| {
            // Until the others have done all that they can.
            while number == 0 && answered.load(Relaxed) < 4 * AHEAD - 1 {
                thread::yield_now();
            }
            if number == 0 {
                thread::sleep(Duration::from_millis(20));
                assert_eq!(answered.load(Relaxed), 4 * AHEAD - 1);
            }
            answered.fetch_add(1, Relaxed);
            number
        };
        let mut numbers = Vec::new();
        run(Numbers(0, 1000), 4, || answer, &mut numbers).unwrap();
        assert_eq!(numbers, Vec::from_iter(0..1000));
    }

    #[test]
    fn a_panic_ends_all_threads() {
        for (panics_at, threads) in [(0, 1), (0, 3), (500, 2), (500, 3)] {
            let answer = |number| {
                assert_ne!(number, panics_at);
                number
            };
            let mut numbers = Vec::new();
            let ended = catch_unwind(AssertUnwindSafe(|| run(Numbers(0, 1000), threads, || answer, &mut numbers)));
            assert!(ended.is_err());
            assert_eq!(numbers, Vec::from_iter(0..numbers.len() as u32));
            assert!(numbers.len() <= panics_at as usize);
        }
    }

    /// Says when it was idle, and fails at a number.
    struct Output<'a>(u32, &'a AtomicUsize, Vec<u32>);

    impl Sink<u32> for Output<'_> {
        fn block(&mut self, number: u32) -> Result<()> {
            self.2.push(number);
            if number == self.0 { Err(Reason::BeyondBudget.into()) } else { Ok(()) }
        }

        fn idle(&mut self) -> Result<()> {
            self.1.store(self.2.len(), Relaxed);
            Ok(())
        }
    }

    /// Some numbers, and more only once all of these are answered; then it fails.
    struct Live<'a>(Numbers, &'a AtomicUsize);

    impl TaskSource for Live<'_> {
        type Task = u32;

        fn next(&mut self) -> Result<Option<u32>> {
            let Self(Numbers(given, end), idle) = self;
            while given == end && idle.load(Relaxed) < *end as usize {
                thread::yield_now();
            }
            if given == end { Err(Reason::BeyondBudget.into()) } else { self.0.next() }
        }
    }

    #[test]
    fn all_is_written_before_the_source_goes_on_or_fails() {
        for threads in 1..4 {
            let idle = AtomicUsize::new(0);
            let mut output = Output(u32::MAX, &idle, Vec::new());
            run(Live(Numbers(0, 100), &idle), threads, || |number| number, &mut output).unwrap_err();
            assert_eq!(output.2, Vec::from_iter(0..100));
        }
    }

    #[test]
    fn nothing_is_written_after_the_sink_has_failed() {
        for threads in 1..4 {
            let mut output = Output(70, &AtomicUsize::new(0), Vec::new());
            run(Numbers(0, 1000), threads, || |number| number, &mut output).unwrap_err();
            assert_eq!(output.2, Vec::from_iter(0..=70));
        }
    }
}
