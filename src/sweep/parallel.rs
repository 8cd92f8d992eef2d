//! Parallel work on many indices, with the results in order.

use crate::budget::SharedBudget;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, Builder};

/// The division of work among threads, and the report of its progress.
#[derive(Clone, Copy)]
pub struct Workers<'w> {
    /// The number of threads that compute. With one, no thread is started.
    pub threads: usize,
    /// Called after each piece of work.
    pub done: &'w (dyn Fn() + Sync),
}

impl Workers<'_> {
    /// Returns the results of `work` for each index below `count`, in order. Each thread has its own state from
    /// `begin`, and all spend the budget of the calling thread. If fewer threads can be started, those do the work.
    pub fn map<S, T: Send>(
        &self,
        count: usize,
        begin: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let next = AtomicUsize::new(0);
        let run = || {
            let mut state = begin();
            let mut made = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= count {
                    return made;
                }
                made.push((index, work(&mut state, index)));
                (self.done)();
            }
        };
        let all = Mutex::new(Vec::with_capacity(count));
        let shared = SharedBudget::current();
        let collect = || {
            let made = match &shared {
                Some(shared) => shared.share(run),
                None => run(),
            };
            all.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(made);
        };
        thread::scope(|scope| {
            for _ in 1..self.threads.min(count) {
                if Builder::new().spawn_scoped(scope, collect).is_err() {
                    break;
                }
            }
            collect();
        });
        let mut all = all.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        all.sort_unstable_by_key(|(index, _)| *index);
        all.into_iter().map(|(_, made)| made).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_for_any_threads() {
        for threads in [1, 2, 7, 200] {
            let counted = AtomicUsize::new(0);
            let done = || {
                counted.fetch_add(1, Ordering::Relaxed);
            };
            let squares = Workers { threads, done: &done }.map(100, || (), |(), index| index * index);
            assert_eq!(squares, (0..100).map(|index| index * index).collect::<Vec<_>>());
            assert_eq!(counted.load(Ordering::Relaxed), 100);
        }
    }
}
