//! Checks of many seeds on four threads.

use std::thread;

/// Runs `check` on the numbers below `count` and adds up the results entry by entry.
pub fn total<const N: usize>(count: u64, check: impl Fn(u64) -> [u64; N] + Sync) -> [u64; N] {
    let check = &check;
    let work = |worker| move || (worker..count).step_by(4).map(check).fold([0; N], added);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..4).map(|worker| scope.spawn(work(worker))).collect();
        let sums =
            workers.into_iter().map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        sums.fold([0; N], added)
    })
}

pub fn added<const N: usize>(a: [u64; N], b: [u64; N]) -> [u64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}
