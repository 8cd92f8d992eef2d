//! A budget of time for computing an answer.
//!
//! ```text
//!     Budget::within --work--> loops without a fixed bound call is_spent --yes--> unfinished parts stay undecided
//! ```
//!
//! This crate reads no clock; the caller supplies one with the budget. A budget covers everything that its thread does
//! within it, at any depth of calls. A sign that is not computed in time counts as unknown.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The time that work may take, and the clock that measures it.
///
/// ```
/// use heelstrike::{Budget, ContactProblem, Friction, analyze, impact::ListedRejections};
/// use std::sync::LazyLock;
/// use std::time::{Duration, Instant};
///
/// static START: LazyLock<Instant> = LazyLock::new(Instant::now);
/// let budget = Budget { time: Duration::from_secs(1), clock: || START.elapsed() };
/// let problem = ContactProblem::new(vec![2.0, 1.0, 1.0, 2.0], vec![[0.5, -1.0]], vec![Friction::from(0.8)], vec![0.0])?;
/// let analysis = budget.within(|| analyze(&problem, ListedRejections::Nothing))?;
/// assert!(analysis.open.is_none());
/// # Ok::<(), heelstrike::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Time that the work may take.
    pub time: Duration,
    /// Returns the time since any fixed moment, preferably the processor time of the calling thread. [`Budget::within`]
    /// does not call the clock for work that takes less than about ten microseconds.
    pub clock: fn() -> Duration,
}

/// A budget that several threads spend together.
#[derive(Debug, Clone)]
pub struct SharedBudget {
    budget: Budget,
    /// Time that all threads have spent \[ns\].
    spent: Arc<AtomicU64>,
}

/// A time limit for each of many pieces of work, together with a total for the pieces that exceed their limit. Each
/// piece may take at most a sixth of the remaining total. The first pieces therefore get their full limit, and later
/// ones less and less.
#[derive(Debug, Clone)]
pub struct TotalBudget {
    each: Budget,
    /// Remaining total \[ns\].
    left: Arc<AtomicU64>,
    /// The smallest limit of all pieces that exceeded theirs \[ns\]; `u64::MAX` if none did.
    least: Arc<AtomicU64>,
}

/// One piece of work may take the remaining total divided by this number.
const PARTS: u64 = 6;

/// The error that a shared budget is spent; contains the time of that budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BudgetSpent(pub Duration);

thread_local! {
    static WORK: Work = const { Work { running: Cell::new(None), rounds: Cell::new(ROUNDS), spent: Cell::new(false) } };
    /// Time that all threads have spent of the budget that this thread shares \[ns\]. It is not part of [`WORK`],
    /// because a thread-local value without a destructor is faster to access.
    static SHARED: RefCell<Option<Arc<AtomicU64>>> = const { RefCell::new(None) };
}

/// State of the budget that the thread works within.
struct Work {
    running: Cell<Option<Running>>,
    /// Rounds until the clock is read again.
    rounds: Cell<u32>,
    spent: Cell<bool>,
}

#[derive(Clone, Copy)]
struct Running {
    budget: Budget,
    /// Clock value at the last reading.
    last: Option<Duration>,
    /// Time that this work alone has spent \[ns\].
    own: u64,
    /// Whether the budget is shared with other threads, by means of [`SHARED`].
    is_shared: bool,
}

impl Work {
    /// Reads the clock and returns whether the budget is spent.
    fn is_spent_now(&self) -> bool {
        // The state is taken out during the call, because the clock may itself work within a budget.
        let Some(Running { budget, last, own, is_shared }) = self.running.take() else { return false };
        let all = if is_shared { SHARED.take() } else { None };
        let now = (budget.clock)();
        let used = nanoseconds(now.saturating_sub(last.unwrap_or(now)));
        let own = own.saturating_add(used);
        let more = |spent: u64| Some(spent.saturating_add(used));
        let shared = all.as_ref().map(|all| {
            let before = all.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more);
            before.unwrap_or(u64::MAX).saturating_add(used)
        });
        if is_shared {
            SHARED.set(all);
        }
        self.running.set(Some(Running { budget, last: Some(now), own, is_shared }));
        shared.unwrap_or(own) >= nanoseconds(budget.time)
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

/// Guard that ends the budget of the thread's work, also on unwinding.
struct Ending;

impl Drop for Ending {
    fn drop(&mut self) {
        WORK.with(|work| {
            if work.running.get().is_some_and(|running| running.is_shared) {
                work.is_spent_now();
                SHARED.set(None);
            }
            work.running.set(None);
            work.spent.set(false);
        });
    }
}

impl Budget {
    /// Runs `work` within this budget. [`Pipeline`](crate::Pipeline) and [`analyze`](crate::analyze) leave open what
    /// they cannot finish in time. Inside the work of another budget, that outer budget remains in force and this one
    /// has no effect.
    pub fn within<R>(self, work: impl FnOnce() -> R) -> R {
        Running { budget: self, last: None, own: 0, is_shared: false }.during(None, work)
    }
}

impl TotalBudget {
    /// Creates an unspent budget. The default `total` is six times the time of `each`.
    pub fn new(each: Budget, total: Option<Duration>) -> Self {
        let total = total.map_or(nanoseconds(each.time).saturating_mul(PARTS), nanoseconds);
        Self { each, left: Arc::new(total.into()), least: Arc::new(u64::MAX.into()) }
    }

    /// Runs `work` within the limit of one piece, see [`Budget::within`].
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> R {
        // Almost always the remaining total allows the full limit of a piece.
        let part = Duration::from_nanos(self.left.load(Ordering::Relaxed) / PARTS);
        let budget = Budget { time: self.each.time.min(part), ..self.each };
        let (made, is_spent) = budget.within(|| (work(), WORK.with(|work| work.spent.get())));
        if is_spent {
            let time = nanoseconds(budget.time);
            self.least.fetch_min(time, Ordering::Relaxed);
            let less = |left: u64| Some(left.saturating_sub(time));
            let _ = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
        }
        made
    }

    /// Returns the smallest limit of all pieces that exceeded theirs, if it was below the time of `each`; `None`
    /// otherwise.
    pub fn least(&self) -> Option<Duration> {
        let least = Duration::from_nanos(self.least.load(Ordering::Relaxed));
        (least < self.each.time && least != Duration::from_nanos(u64::MAX)).then_some(least)
    }
}

impl SharedBudget {
    /// Creates an unspent budget.
    pub fn new(budget: Budget) -> Self {
        Self { budget, spent: Arc::default() }
    }

    /// Runs `work`, which may use any number of [`Workers`](crate::sweep::Workers), and returns its result.
    ///
    /// # Errors
    /// Returns an error if the budget is spent. The result of the work is dropped then, because it has no meaning.
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> Result<R, BudgetSpent> {
        let made = self.share(work);
        let is_spent = self.spent.load(Ordering::Relaxed) >= nanoseconds(self.budget.time);
        if is_spent { Err(BudgetSpent(self.budget.time)) } else { Ok(made) }
    }

    /// As [`SharedBudget::within`], but without the error; for a thread that does a part of the work of another thread.
    pub(crate) fn share<R>(&self, work: impl FnOnce() -> R) -> R {
        let (budget, last) = (self.budget, Some((self.budget.clock)()));
        Running { budget, last, own: 0, is_shared: true }.during(Some(&self.spent), work)
    }

    /// Returns the shared budget that this thread works within; `None` if there is none.
    pub(crate) fn current() -> Option<Self> {
        let running = WORK.with(|work| work.running.get()).filter(|running| running.is_shared)?;
        Some(Self { budget: running.budget, spent: SHARED.with_borrow(Clone::clone)? })
    }
}

impl Running {
    fn during<R>(self, shared: Option<&Arc<AtomicU64>>, work: impl FnOnce() -> R) -> R {
        let _ending = WORK.with(|own| {
            let begins = own.running.get().is_none();
            if begins {
                if let Some(shared) = shared {
                    SHARED.set(Some(Arc::clone(shared)));
                }
                own.running.set(Some(self));
                own.rounds.set(ROUNDS);
            }
            begins.then(|| Ending)
        });
        work()
    }
}

/// As [`Budget::within`]; runs `work` without a limit if `budget` is `None`.
pub fn within<R>(budget: Option<Budget>, work: impl FnOnce() -> R) -> R {
    match budget {
        Some(budget) => budget.within(work),
        None => work(),
    }
}

/// Returns whether the budget of this thread's work is spent. Every loop without a fixed bound calls it at least once
/// per round.
pub(crate) fn is_spent() -> bool {
    is_spent_after(1)
}

/// As [`is_spent`], after work that takes about as long as `rounds` rounds of a linear program.
pub(crate) fn is_spent_after(rounds: u32) -> bool {
    WORK.with(|work| {
        let left = work.rounds.get().saturating_sub(rounds);
        work.rounds.set(if left > 0 { left } else { ROUNDS });
        if left > 0 {
            return work.spent.get();
        }
        if !work.spent.get() {
            work.spent.set(work.is_spent_now());
        }
        work.spent.get()
    })
}

/// Rounds between two readings of the clock, because one reading takes microseconds.
pub(crate) const ROUNDS: u32 = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn is_spent_now() -> bool {
        is_spent_after(u32::MAX)
    }

    /// A clock that advances by one second at each reading.
    fn ticking() -> Duration {
        thread_local!(static TICKS: Cell<u64> = const { Cell::new(0) });
        Duration::from_secs(TICKS.replace(TICKS.get() + 1))
    }

    fn seconds(time: u64) -> Budget {
        Budget { time: Duration::from_secs(time), clock: ticking }
    }

    #[test]
    fn a_budget_is_spent_by_the_clock() {
        assert!(!is_spent_now(), "without a budget nothing is ever spent");
        let looks = seconds(3).within(|| (1..10).find(|_| is_spent_now()));
        assert_eq!(looks, Some(4), "the first look is the beginning");
        let asks = seconds(1).within(|| (1..10_000).find(|_| is_spent()));
        assert_eq!(asks, Some(2 * ROUNDS));
        assert!(!is_spent_now(), "the budget ends with its work");
        let inner = seconds(2).within(|| (seconds(0).within(is_spent_now), (1..10).find(|_| is_spent_now())));
        assert_eq!(inner, (false, Some(2)), "the outer budget goes on within the inner one and behind it");
    }

    #[test]
    fn clocks_may_work_within_budgets() {
        fn working() -> Duration {
            assert!(!SharedBudget::new(seconds(9)).share(is_spent_now), "a budget of its own");
            ticking()
        }
        let shared = SharedBudget::new(Budget { time: Duration::from_secs(1000), clock: working });
        assert_eq!(shared.within(|| (0..3).any(|_| is_spent_now())), Ok(false));
        assert!(SharedBudget::current().is_none() && shared.spent.load(Ordering::Relaxed) > 0);
    }

    #[test]
    fn a_shared_budget_stays_spent() {
        // 2^33 s are more than a third of the nanoseconds that 64 bits can hold.
        let leaping = || Duration::from_secs(ticking().as_secs() << 33);
        let shared = SharedBudget::new(Budget { time: Duration::MAX, clock: leaping });
        let looks = shared.share(|| [(); 5].map(|()| is_spent_now()));
        assert_eq!(looks, [false, false, true, true, true]);
        assert_eq!(shared.spent.load(Ordering::Relaxed), u64::MAX);
    }

    #[test]
    fn work_beyond_its_budget_takes_ever_less() {
        // Each reading advances the clock by one nanosecond, and the first reading marks the beginning.
        thread_local!(static TICKS: Cell<u64> = const { Cell::new(0) });
        let clock = || Duration::from_nanos(TICKS.replace(TICKS.get() + 1));
        let each = Budget { time: Duration::from_nanos(60), clock };
        let looks = |total: &TotalBudget| total.within(|| (1..1000).find(|_| is_spent_now())).map(|looks| looks - 1);
        let total = TotalBudget::new(each, None);
        assert_eq!(total.within(|| (1..50).find(|_| is_spent_now())), None, "what ends in time takes nothing of it");
        assert_eq!((looks(&total), total.least()), (Some(60), None));
        assert_eq!([(); 3].map(|()| looks(&total).unwrap()), [50, 41, 34]);
        assert_eq!(total.least(), Some(Duration::from_nanos(34)));
        let rest = (0..1000).map(|_| looks(&total).unwrap()).sum::<u64>();
        assert!(rest < 360 - 60 - 50 - 41 - 34, "{rest}");
        assert_eq!(looks(&TotalBudget::new(each, Some(Duration::from_nanos(6)))), Some(1));
    }

    #[test]
    fn threads_spend_a_shared_budget_together() {
        let shared = SharedBudget::new(seconds(6));
        let looks = |count: u32| {
            let own = SharedBudget::current().expect("the budget of this thread");
            let work = || {
                own.share(|| {
                    (0..count).for_each(|_| {
                        is_spent_now();
                    })
                })
            };
            std::thread::scope(|scope| scope.spawn(work).join()).expect("no panic");
        };
        // The clock is read at the beginning, at the end and `count` times between them.
        assert_eq!(shared.within(|| looks(1)), Ok(()));
        assert_eq!(shared.within(|| looks(1)), Err(BudgetSpent(Duration::from_secs(6))));
    }
}
