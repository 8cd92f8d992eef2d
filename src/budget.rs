//! A budget of work: how much time an answer may take.
//!
//! ```text
//!     Budget::within --work--> loops without a bound of their own ask is_spent --yes--> what is open stays undecided
//! ```
//!
//! This crate reads no clock: who sets a budget gives one. A budget holds for all that its thread does within it, so
//! that a linear program in the middle of a proof ends as soon as one at its edge: every sign that is asked for then is
//! unknown, which is always a right answer.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How much time work may take, and by which clock.
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
    /// How much.
    pub time: Duration,
    /// Time that the calling thread has worked, since any moment: best its processor time. It is not called by work
    /// that takes less than some ten microseconds.
    pub clock: fn() -> Duration,
}

/// A budget that several threads spend together.
#[derive(Debug, Clone)]
pub struct SharedBudget {
    budget: Budget,
    /// In nanoseconds.
    spent: Arc<AtomicU64>,
}

/// A budget for each of many pieces of work, and one for all that end beyond theirs, of which each may take a sixth of
/// what is left: the first ones take what they would alone, and later ones ever less.
#[derive(Debug, Clone)]
pub struct TotalBudget {
    each: Budget,
    /// In nanoseconds.
    left: Arc<AtomicU64>,
    /// The least that one had and spent.
    least: Arc<AtomicU64>,
}

/// The part of what is left that one piece of work may take.
const PARTS: u64 = 6;

/// All of a shared budget was spent; how much that was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BudgetSpent(pub Duration);

thread_local! {
    static WORK: Work = const { Work { running: Cell::new(None), rounds: Cell::new(ROUNDS), spent: Cell::new(false) } };
    /// What all that share the budget of this thread's work have spent \[ns\]. It is not part of the work, since what needs
    /// no drop is quicker to reach.
    static SHARED: RefCell<Option<Arc<AtomicU64>>> = const { RefCell::new(None) };
}

/// What the thread is at work on.
struct Work {
    running: Cell<Option<Running>>,
    /// How many rounds until the clock is read.
    rounds: Cell<u32>,
    spent: Cell<bool>,
}

#[derive(Clone, Copy)]
struct Running {
    budget: Budget,
    /// When the clock was last read.
    last: Option<Duration>,
    /// Of this work alone \[ns\].
    own: u64,
    /// Whether others share the budget, by [`SHARED`].
    is_shared: bool,
}

impl Work {
    /// Reads the clock; whether everything is spent.
    fn is_spent_now(&self) -> bool {
        // Taken meanwhile: a clock may itself work within a budget.
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

/// Ends the work of a thread, however it ends.
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
    /// Does the work; what of it cannot be done within the budget is left open by [`Pipeline`](crate::Pipeline) and
    /// [`analyze`](crate::analyze). Within the work of another budget, that one goes on.
    pub fn within<R>(self, work: impl FnOnce() -> R) -> R {
        Running { budget: self, last: None, own: 0, is_shared: false }.during(None, work)
    }
}

impl TotalBudget {
    /// A budget of which nothing is spent yet; by default the `total` is six times that of each.
    pub fn new(each: Budget, total: Option<Duration>) -> Self {
        let total = total.map_or(nanoseconds(each.time).saturating_mul(PARTS), nanoseconds);
        Self { each, left: Arc::new(total.into()), least: Arc::new(u64::MAX.into()) }
    }

    /// Does the work, as [`Budget::within`].
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> R {
        // Almost always enough is left for the whole time of one.
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

    /// What a piece of work spent that had less than each may take, the least of all; `None` if there is none.
    pub fn least(&self) -> Option<Duration> {
        let least = Duration::from_nanos(self.least.load(Ordering::Relaxed));
        (least < self.each.time && least != Duration::from_nanos(u64::MAX)).then_some(least)
    }
}

impl SharedBudget {
    /// A budget of which nothing is spent yet.
    pub fn new(budget: Budget) -> Self {
        Self { budget, spent: Arc::default() }
    }

    /// What the work makes, on any number of [`Workers`](crate::sweep::Workers).
    ///
    /// # Errors
    /// The budget was spent before: what was made then means nothing.
    pub fn within<R>(&self, work: impl FnOnce() -> R) -> Result<R, BudgetSpent> {
        let made = self.share(work);
        let is_spent = self.spent.load(Ordering::Relaxed) >= nanoseconds(self.budget.time);
        if is_spent { Err(BudgetSpent(self.budget.time)) } else { Ok(made) }
    }

    /// As [`SharedBudget::within`], by a thread whose work is part of another one's.
    pub(crate) fn share<R>(&self, work: impl FnOnce() -> R) -> R {
        let (budget, last) = (self.budget, Some((self.budget.clock)()));
        Running { budget, last, own: 0, is_shared: true }.during(Some(&self.spent), work)
    }

    /// That within which this thread is at work.
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

/// As [`Budget::within`], if there is one.
pub fn within<R>(budget: Option<Budget>, work: impl FnOnce() -> R) -> R {
    match budget {
        Some(budget) => budget.within(work),
        None => work(),
    }
}

/// Whether the budget of this thread's work is spent, asked at least once in each round of a loop without a bound.
pub(crate) fn is_spent() -> bool {
    is_spent_after(1)
}

/// As [`is_spent`], after work that takes about as long as so many rounds of a linear program.
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

/// Work that takes so many rounds and more is followed by a look at the clock, which takes microseconds.
pub(crate) const ROUNDS: u32 = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn is_spent_now() -> bool {
        is_spent_after(u32::MAX)
    }

    /// A clock that goes on by a second whenever it is read.
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
        // 2^33 s are more than a third of what 64 bits hold in nanoseconds.
        let leaping = || Duration::from_secs(ticking().as_secs() << 33);
        let shared = SharedBudget::new(Budget { time: Duration::MAX, clock: leaping });
        let looks = shared.share(|| [(); 5].map(|()| is_spent_now()));
        assert_eq!(looks, [false, false, true, true, true]);
        assert_eq!(shared.spent.load(Ordering::Relaxed), u64::MAX);
    }

    #[test]
    fn work_beyond_its_budget_takes_ever_less() {
        // A nanosecond a look, and one for the beginning.
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
        // A look at the beginning, at the end, and these.
        assert_eq!(shared.within(|| looks(1)), Ok(()));
        assert_eq!(shared.within(|| looks(1)), Err(BudgetSpent(Duration::from_secs(6))));
    }
}
