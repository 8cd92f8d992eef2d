//! Ctrl-C and the budget of work.
//!
//! Long work runs within a budget, whose clock is read repeatedly. On the thread that called from Python, reading the
//! clock also runs Python's signal handlers. If a handler raises, the budgets of all threads of the call are spent, and
//! the call raises that exception.

use heelstrike::Budget;
use heelstrike::budget::SharedBudget;
use heelstrike::cli::{Seconds, work_time};
use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two checks for signals.
const OFTEN: Duration = Duration::from_millis(50);

/// Time by which the clock advances at each reading after a handler raised: a few readings spend any budget.
const AGE: Duration = Duration::from_secs(1 << 33);

thread_local! {
    static CALL: RefCell<Option<Call>> = const { RefCell::new(None) };
    static IS_CALLER: Cell<bool> = const { Cell::new(false) };
    static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
    static AGES: Cell<u32> = const { Cell::new(0) };
}

/// A call from Python, shared by its threads: whether a signal handler raised, and the exception.
#[derive(Clone, Default)]
pub struct Call(Arc<(AtomicBool, Mutex<Option<PyErr>>)>);

impl Call {
    /// The call for which this thread works.
    pub fn current() -> Self {
        CALL.with_borrow(Clone::clone).unwrap_or_default()
    }

    /// Makes this thread work for the call.
    pub fn join(&self) {
        CALL.set(Some(self.clone()));
    }
}

/// A budget of this time; `None` for no limit.
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

/// Whether a signal handler raised. On the calling thread, runs the handlers if the last check is longer ago than
/// [`OFTEN`].
pub fn interrupted() -> bool {
    // Of the threads of a call, only the one that called can run Python's signal handlers.
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

/// Runs Python's signal handlers, and keeps the exception if one raises.
fn look() {
    if let Err(raised) = Python::attach(|py| py.check_signals()) {
        let Call(call) = Call::current();
        *call.1.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
        call.0.store(true, Relaxed);
    }
}

/// Does the work detached from the interpreter; then raises what a signal handler raised meanwhile.
pub fn without_python<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    // A signal handler may itself make a call, so the outer call is restored.
    let call = Call::default();
    let (outer, was_caller) = (CALL.replace(Some(call.clone())), IS_CALLER.replace(true));
    AGES.set(1);
    let made = py.detach(work);
    CALL.set(outer);
    IS_CALLER.set(was_caller);
    let raised = call.0.1.lock().unwrap_or_else(PoisonError::into_inner).take();
    raised.map_or(Ok(made), Err)
}
