//! Long work: on a thread of its own, while Python's thread tells how far it is and takes signals.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use armid::observer::{Observer, Progress, Work};
use pyo3::prelude::*;

use crate::fault::unexpected;

/// How often signals are taken.
const TICK: Duration = Duration::from_millis(20);
/// How long work that computes alone is waited for once it is to end: with [`TICK`] below the 0.2 s in which a call is to return.
/// Steps of designs end within it. One step of an estimator that simulates can take seconds, and nothing ends a step: its thread is
/// left to end alone. What it would still return is lost in any case.
const PATIENCE: Duration = Duration::from_millis(150);
/// Stack of the thread, bytes: that of a program's own.
const STACK: usize = 8 << 20;

/// What is left behind when work is to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leaves {
    /// Nothing: nobody waits long for its last step.
    Nothing,
    /// Files, which are whole before it returns.
    Files,
}

/// What both threads see.
#[derive(Default)]
struct Shared {
    latest: Mutex<Vec<Progress>>,
    is_to_end: AtomicBool,
    is_done: Mutex<bool>,
    done: Condvar,
}

impl Observer for Shared {
    fn observe(&self, progress: Progress) -> ControlFlow<()> {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        match latest.iter_mut().find(|known| known.work == progress.work) {
            Some(known) => *known = progress,
            None => latest.push(progress),
        }
        if self.is_to_end.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Shared {
    /// Waits for the end of the work, at most so long, or for ever; is it there?
    fn wait(&self, time: Option<Duration>) -> bool {
        let is_done = self.is_done.lock().unwrap_or_else(PoisonError::into_inner);
        match time {
            Some(time) => {
                let waited = self.done.wait_timeout_while(is_done, time, |is_done| !*is_done);
                *waited.unwrap_or_else(PoisonError::into_inner).0
            }
            None => *self.done.wait_while(is_done, |is_done| !*is_done).unwrap_or_else(PoisonError::into_inner),
        }
    }

    /// Tells how far the work is.
    fn tell(&self, py: Python<'_>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let Some(callback) = callback else { return Ok(()) };
        let latest = std::mem::take(&mut *self.latest.lock().unwrap_or_else(PoisonError::into_inner));
        latest
            .iter()
            .try_for_each(|Progress { work, done, total }| callback.call1(py, (*done, *total, name(*work))).map(|_| ()))
    }
}

/// What is counted, for people.
const fn name(work: Work) -> &'static str {
    match work {
        Work::Designs => "designs",
        Work::Runs => "runs",
        Work::Starts => "starts",
        Work::Evaluations => "evaluations",
        Work::Steps => "steps",
        Work::Samples => "samples",
        _ => "pieces",
    }
}

/// Does the work without the interpreter's lock. Its progress goes to `callback(done, total, what)`; a signal, or an exception of
/// the callback, ends it.
///
/// # Errors
/// The exception that ended it; `ArmidError` where it panicked, which is a defect.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    leaves: Leaves,
    work: impl FnOnce(&dyn Observer) -> T + Send + 'static,
) -> PyResult<T> {
    let shared = Arc::new(Shared::default());
    let seen = Arc::clone(&shared);
    let worker = thread::Builder::new().name("armid".to_owned()).stack_size(STACK).spawn(move || {
        let result = catch_unwind(AssertUnwindSafe(|| work(&*seen)));
        *seen.is_done.lock().unwrap_or_else(PoisonError::into_inner) = true;
        seen.done.notify_all();
        result
    })?;
    while !py.detach(|| shared.wait(Some(TICK))) {
        if let Err(ended) = py.check_signals().and_then(|()| shared.tell(py, callback.as_ref())) {
            shared.is_to_end.store(true, Ordering::Relaxed);
            py.detach(|| shared.wait((leaves == Leaves::Nothing).then_some(PATIENCE)));
            return Err(ended);
        }
    }
    shared.tell(py, callback.as_ref())?;
    match py.detach(|| worker.join()) {
        Ok(Ok(result)) => Ok(result),
        Ok(Err(panic)) | Err(panic) => {
            let said = panic.downcast_ref::<String>().map(String::as_str);
            let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            Err(unexpected(format!("a defect of armid, please report it: {said}")))
        }
    }
}
