//! Answers the tasks of a source in several threads, and passes the answers on in order.
//!
//! ```text
//!     Source --tasks--> threads, each with its own Answerer --blocks--┐
//!        └─────────────────── places of the blocks ───────────────┴──> Sink, on the caller's thread
//! ```
//!
//! The source's thread sends tasks to any free thread, and to the sink the places where their blocks will appear. The
//! second channel is bounded, and so is the memory. No answer depends on another: the bytes are those of one thread.

use super::Summary;
use crate::Error;
use crate::draw::ListedKeyframe;
use crate::error::excerpt::Excerpt;
use std::io;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::thread::{self, Builder};

/// Tasks in flight per thread.
const AHEAD: usize = 4;

/// Gives tasks, one after the other.
pub trait Source: Send {
    /// Some records.
    type Task: Send;

    /// The next records; `None` at the end.
    ///
    /// # Errors
    /// Those of reading; this is not called again then.
    fn next(&mut self) -> io::Result<Option<Self::Task>>;

    /// Whether the next records may take long to arrive.
    fn keeps_waiting(&self) -> bool;
}

/// Answers tasks; each thread has its own.
pub trait Answerer<T> {
    /// Answers the records of a task.
    fn answer(&mut self, task: T, block: &mut Block);
}

/// The answers to a task.
#[derive(Debug, Default)]
pub struct Block {
    /// The bytes to write.
    pub out: Vec<u8>,
    /// Why records were refused.
    pub refused: Vec<RefusedRecord>,
    /// The summary of these records; see [`Summary::merge`].
    pub summary: Summary,
    /// Keyframes of the states, if requested.
    pub keyframes: Vec<ListedKeyframe>,
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
pub trait Sink {
    /// Takes the next answers.
    ///
    /// # Errors
    /// Those of writing; this is not called again then.
    fn block(&mut self, block: Block) -> io::Result<()>;

    /// Writes what is buffered: everything read so far is answered, and the input pauses or has ended.
    ///
    /// # Errors
    /// As above.
    fn idle(&mut self) -> io::Result<()>;
}

/// Why not all records were answered.
#[derive(Debug)]
pub enum Broken {
    /// The input could not be read further; what came before is answered.
    Input(io::Error),
    /// The sink could not take an answer.
    Output(io::Error),
}

/// Answers all tasks of `source` in `threads` threads, each with an answerer that `answerer` makes; with one thread
/// none is started.
///
/// If fewer threads can be started, these do the work. If the sink fails, this returns after the source's current call
/// of `next`; with a source that may wait for ever, the sink must end the process itself.
///
/// # Errors
/// Those of the source and the sink.
pub fn run<S, F>(source: S, threads: usize, answerer: impl Fn() -> F + Sync, sink: &mut impl Sink) -> Result<(), Broken>
where
    S: Source,
    F: Answerer<S::Task>,
{
    if threads > 1 {
        in_threads(source, threads, answerer, sink, |_| Builder::new())
    } else {
        alone(source, answerer(), sink)
    }
}

fn alone<S: Source>(mut source: S, mut answerer: impl Answerer<S::Task>, sink: &mut impl Sink) -> Result<(), Broken> {
    while let Some(task) = source.next().map_err(Broken::Input)? {
        sink.block(answer(&mut answerer, task)).map_err(Broken::Output)?;
        if source.keeps_waiting() {
            sink.idle().map_err(Broken::Output)?;
        }
    }
    sink.idle().map_err(Broken::Output)
}

/// A task, and the channel for its answer.
type Job<T> = (T, SyncSender<Block>);

/// Starts thread `k` by `builder(k)`, of which 0 reads.
fn in_threads<S, F>(
    source: S,
    threads: usize,
    answerer: impl Fn() -> F + Sync,
    sink: &mut impl Sink,
    builder: impl Fn(usize) -> Builder,
) -> Result<(), Broken>
where
    S: Source,
    F: Answerer<S::Task>,
{
    let (jobs, queue) = channel::<Job<S::Task>>();
    let (places, ordered) = sync_channel(AHEAD * threads);
    let queue = Mutex::new(queue);
    thread::scope(|scope| {
        // The source is handed over once all threads run, so that it is not lost if one cannot be started.
        let (hand_over, given) = sync_channel::<S>(1);
        let read = move || {
            let Ok(mut source) = given.recv() else { return };
            while let Some(task) = source.next().transpose() {
                let (block, place) = sync_channel(1);
                let task = task.map(|task| jobs.send((task, block)));
                let ended = task.is_err();
                // A send fails if the sink has failed.
                if places.send(task.map(|_| place)).is_err() || ended {
                    break;
                }
            }
        };
        let work = || {
            let mut answerer = answerer();
            while let Some((task, block)) = next_job(&queue) {
                if block.send(answer(&mut answerer, task)).is_err() {
                    break;
                }
            }
        };
        let reads = builder(0).spawn_scoped(scope, read).is_ok();
        let work = (1..=threads).map_while(|k| builder(k).spawn_scoped(scope, work).ok());
        if reads && work.count() > 0 {
            return match hand_over.send(source) {
                Ok(()) => hand_on(ordered, sink),
                // Unreachable: the reading thread waits for the source.
                Err(refused) => alone(refused.0, answerer(), sink),
            };
        }
        drop(hand_over);
        alone(source, answerer(), sink)
    })
}

/// The next job; `None` when the source has ended.
fn next_job<T>(queue: &Mutex<Receiver<Job<T>>>) -> Option<Job<T>> {
    queue.lock().ok()?.recv().ok()
}

/// Gives the sink the blocks in the order of their places.
fn hand_on(ordered: Receiver<io::Result<Receiver<Block>>>, sink: &mut impl Sink) -> Result<(), Broken> {
    loop {
        let place = match ordered.try_recv() {
            Err(TryRecvError::Empty) => {
                sink.idle().map_err(Broken::Output)?;
                ordered.recv().ok()
            }
            place => place.ok(),
        };
        let Some(place) = place else {
            return sink.idle().map_err(Broken::Output);
        };
        match place.map_err(Broken::Input)?.recv() {
            Ok(block) => sink.block(block).map_err(Broken::Output)?,
            // Its thread has panicked, which the end of the scope passes on.
            Err(_) => return Ok(()),
        }
    }
}

fn answer<T>(answerer: &mut impl Answerer<T>, task: T) -> Block {
    let mut block = Block::default();
    answerer.answer(task, &mut block);
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers below a limit.
    struct Numbers(u32, u32);

    impl Source for Numbers {
        type Task = u32;

        fn next(&mut self) -> io::Result<Option<u32>> {
            self.0 += 1;
            Ok((self.0 <= self.1).then_some(self.0 - 1))
        }

        fn keeps_waiting(&self) -> bool {
            false
        }
    }

    struct Lines;

    impl Answerer<u32> for Lines {
        fn answer(&mut self, task: u32, block: &mut Block) {
            block.out.extend(format!("{task}\n").bytes());
        }
    }

    impl Sink for Vec<u8> {
        fn block(&mut self, block: Block) -> io::Result<()> {
            self.extend(block.out);
            Ok(())
        }

        fn idle(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn threads_that_cannot_be_started_are_done_without() {
        let expected: String = (0..100).map(|number| format!("{number}\n")).collect();
        for missing in [vec![], vec![3], vec![2, 3], vec![1, 2, 3], vec![0], vec![0, 1, 2, 3]] {
            let builder = |thread| match missing.contains(&thread) {
                // No system has room for such a stack.
                true => Builder::new().stack_size(usize::MAX / 4),
                false => Builder::new(),
            };
            let mut written = Vec::new();
            in_threads(Numbers(0, 100), 3, || Lines, &mut written, builder).unwrap();
            assert_eq!(String::from_utf8(written).unwrap(), expected, "without {missing:?}");
        }
    }
}
