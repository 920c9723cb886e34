//! Ctrl-C: the first asks the work to end with what is finished, the second ends it at once.

use std::sync::atomic::{AtomicBool, Ordering};

use armid_io::Error as Fault;
use miette::Result;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Watches for Ctrl-C, and for the signal that a batch system sends before it kills.
pub(crate) fn watch() -> Result<()> {
    let handler = || {
        if ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Fault::new(format!("Ctrl-C cannot be watched: {error}")).into())
}

/// Has somebody asked for the end?
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
