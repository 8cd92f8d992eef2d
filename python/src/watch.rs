//! Ctrl-C and the budget of work.
//!
//! Work that may take long runs within a budget, whose clock is read again and again. On the thread that runs Python's
//! signal handlers this clock also asks whether one has raised: the budgets of all threads of the call are then spent,
//! and it raises.

use heelstrike::Budget;
use heelstrike::budget::SharedBudget;
use heelstrike::cli::{Seconds, work_time};
use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often signals are looked for.
const OFTEN: Duration = Duration::from_millis(50);

/// What the clock goes on by whenever it is read after a signal: a few looks spend any budget.
const AGE: Duration = Duration::from_secs(1 << 33);

thread_local! {
    static CALL: RefCell<Option<Call>> = const { RefCell::new(None) };
    static IS_CALLER: Cell<bool> = const { Cell::new(false) };
    static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
    static AGES: Cell<u32> = const { Cell::new(0) };
}

/// A call from Python, of which all its threads know whether a signal handler raised, and what.
#[derive(Clone, Default)]
pub struct Call(Arc<(AtomicBool, Mutex<Option<PyErr>>)>);

impl Call {
    /// That for which this thread works.
    pub fn current() -> Self {
        CALL.with_borrow(Clone::clone).unwrap_or_default()
    }

    /// Lets this thread work for it.
    pub fn join(&self) {
        CALL.set(Some(self.clone()));
    }
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
    // Python handles signals on the thread that called.
    if IS_CALLER.get() && !raised() && LAST.get().is_none_or(|last| last.elapsed() > OFTEN) {
        LAST.set(Some(Instant::now()));
        look();
    }
    raised()
}

/// Whether a signal handler raised during the call for which this thread works.
pub fn raised() -> bool {
    CALL.with_borrow(|call| call.as_ref().is_some_and(|call| call.0.0.load(Relaxed)))
}

/// Runs Python's signal handlers, one of which may raise.
fn look() {
    if let Err(raised) = Python::attach(|py| py.check_signals()) {
        let Call(call) = Call::current();
        *call.1.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
        call.0.store(true, Relaxed);
    }
}

/// Does the work without the interpreter; raises what a signal handler raised on the way.
pub fn without_python<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    // A handler may itself call.
    let call = Call::default();
    let (outer, was_caller) = (CALL.replace(Some(call.clone())), IS_CALLER.replace(true));
    AGES.set(1);
    let made = py.detach(work);
    CALL.set(outer);
    IS_CALLER.set(was_caller);
    let raised = call.0.1.lock().unwrap_or_else(PoisonError::into_inner).take();
    raised.map_or(Ok(made), Err)
}
