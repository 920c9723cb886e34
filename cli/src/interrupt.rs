//! Signals: the first asks the work to end with what is finished, the second ends it at once, unless an arm moves. Work that
//! never checks for a request has nothing to keep, and ends at the first.
//!
//! While an arm moves, no signal that can be caught ends the process before the arm is at rest, or nothing more can be done for
//! it. Signals are taken by a thread that waits for them and are blocked everywhere else, so that none interrupts the
//! middleware in the middle of a call.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

use armid_io::Error as Fault;
use miette::Result;

static ASKED: AtomicBool = AtomicBool::new(false);
/// Whether the work looks.
static HEEDED: AtomicBool = AtomicBool::new(false);
/// How many motions are under way; held while the process ends, so that none begins then.
static MOVING: Mutex<usize> = Mutex::new(0);

/// Watches for Ctrl-C, Ctrl-\\, Ctrl-Z, a terminal that is closed, and what a batch system sends before it kills.
#[cfg(unix)]
pub(crate) fn watch() -> Result<()> {
    use nix::sys::signal::{SigSet, Signal};

    let fault = |error: &dyn std::fmt::Display| Fault::new(format!("signals cannot be watched: {error}"));
    let ends = [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP, Signal::SIGQUIT];
    let watched = SigSet::from_iter(ends.into_iter().chain([Signal::SIGTSTP]));
    // Every thread that begins later inherits it.
    watched.thread_block().map_err(|error| fault(&error))?;
    let wait = move || {
        loop {
            match watched.wait() {
                Ok(Signal::SIGTSTP) if !is_moving() => {
                    // What Ctrl-Z does where it is not caught.
                    let _ = nix::sys::signal::raise(Signal::SIGSTOP);
                }
                Ok(_) => ask(),
                Err(_) => {}
            }
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(wait).map(|_| ()).map_err(|error| fault(&error).into())
}

/// Watches for Ctrl-C.
#[cfg(not(unix))]
pub(crate) fn watch() -> Result<()> {
    ctrlc::set_handler(ask).map_err(|error| Fault::new(format!("Ctrl-C cannot be watched: {error}")).into())
}

#[cfg(unix)]
fn is_moving() -> bool {
    *MOVING.lock().unwrap_or_else(PoisonError::into_inner) > 0
}

fn ask() {
    let moving = MOVING.lock().unwrap_or_else(PoisonError::into_inner);
    let again = ASKED.swap(true, Ordering::SeqCst);
    if *moving == 0 && (again || !HEEDED.load(Ordering::SeqCst)) {
        std::process::exit(130);
    }
}

/// Has a signal asked for the end?
pub(crate) fn asked() -> bool {
    if !HEEDED.load(Ordering::Relaxed) {
        HEEDED.store(true, Ordering::SeqCst);
    }
    ASKED.load(Ordering::SeqCst)
}

/// The end was asked for before anything moved, and what was broken off.
#[derive(Debug)]
pub(crate) struct Interrupted(pub(crate) String);

impl std::fmt::Display for Interrupted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "interrupted, and nothing has moved: {}", self.0)
    }
}

impl std::error::Error for Interrupted {}

impl miette::Diagnostic for Interrupted {}

/// An arm moves while this value exists: signals ask to stop, and none ends the process.
pub(crate) struct Moving(());

/// Makes a panic say no more than its message while an arm moves: a backtrace takes a tenth of a second, and the arm is asked
/// to stop after it.
fn hurry_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if MOVING.try_lock().is_ok_and(|moving| *moving == 0) {
                usual(panic);
            } else {
                let _ = writeln!(std::io::stderr(), "{panic}");
            }
        }));
    });
}

/// From here on an arm may move.
pub(crate) fn moving() -> Moving {
    hurry_panics();
    *MOVING.lock().unwrap_or_else(PoisonError::into_inner) += 1;
    Moving(())
}

impl Drop for Moving {
    fn drop(&mut self) {
        *MOVING.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
    }
}
