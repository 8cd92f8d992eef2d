//! Ctrl-C and the budget of work.
//!
//! Work that may take long runs within a budget, whose clock is read again and again. On the thread that runs Python's
//! signal handlers this clock also asks whether one has raised: the budget is then spent, and the call raises.

use heelstrike::Budget;
use heelstrike::budget::SharedBudget;
use heelstrike::cli::{Seconds, work_time};
use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// How often signals are looked for.
const OFTEN: Duration = Duration::from_millis(50);

/// What the clock goes on by whenever it is read after a signal: a few looks spend any budget.
const AGE: Duration = Duration::from_secs(1 << 33);

thread_local! {
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
    static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
    static AGES: Cell<u32> = const { Cell::new(0) };
}

/// The budget of work that may take so long; `None` for work without an end.
pub fn budget(time: Seconds) -> Budget {
    Budget { time: time.unwrap_or(Duration::MAX), clock }
}

/// A budget that several threads spend together.
pub fn shared(time: Seconds) -> SharedBudget {
    SharedBudget::new(budget(time))
}

fn clock() -> Duration {
    match interrupted() {
        true => AGE.saturating_mul(AGES.replace(AGES.get().saturating_add(1))),
        false => work_time(),
    }
}

/// Whether a signal handler raised, which is asked anew after a while.
pub fn interrupted() -> bool {
    if LAST.get().is_none_or(|last| last.elapsed() > OFTEN) {
        LAST.set(Some(Instant::now()));
        look();
    }
    raised()
}

/// Whether a signal handler raised during the work of this thread.
pub fn raised() -> bool {
    RAISED.with_borrow(Option::is_some)
}

/// Runs Python's signal handlers; whether one of them raised.
fn look() -> bool {
    let raised = Python::attach(|py| py.check_signals()).err();
    RAISED.with_borrow_mut(|all| {
        *all = raised.or(all.take());
        all.is_some()
    })
}

/// Does the work without the interpreter; raises what a signal handler raised on the way.
pub fn without_python<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    RAISED.set(None);
    AGES.set(1);
    let made = py.detach(work);
    match RAISED.take() {
        Some(raised) => Err(raised),
        None => Ok(made),
    }
}
