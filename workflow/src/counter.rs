//! Pieces of work that are finished on all threads, told to an observer.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use armid::observer::{Observer, Progress, Work};
use armid_io::Error;

/// Counts finished pieces.
pub(crate) struct Counter<'a> {
    observer: &'a dyn Observer,
    work: Work,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Counter<'a> {
    /// None of `total` is finished.
    pub(crate) fn new(observer: &'a dyn Observer, work: Work, total: usize) -> Self {
        Self { observer, work, total, done: AtomicUsize::new(0) }
    }

    /// One more is finished.
    pub(crate) fn add(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
        let _ = self.goes_on();
    }

    /// Begins the next piece, the one before being finished.
    ///
    /// # Errors
    /// [`Error`] of [`armid_io::ErrorKind::Interrupted`], which calls the work `name`, where the observer ends it.
    pub(crate) fn begin(&self, name: &str) -> Result<(), Error> {
        let goes_on = self.goes_on();
        self.done.fetch_add(1, Ordering::Relaxed);
        if goes_on { Ok(()) } else { Err(Error::interrupted(name)) }
    }

    /// Tells how far the work is; does it go on?
    pub(crate) fn goes_on(&self) -> bool {
        let done = self.done.load(Ordering::Relaxed);
        self.observer.observe(Progress { work: self.work, done, total: self.total }).is_continue()
    }
}

/// An observer that remembers whether it ended the work: what was made until then is whole.
pub(crate) struct Latch<'a> {
    observer: &'a dyn Observer,
    ended: AtomicBool,
}

impl<'a> Latch<'a> {
    pub(crate) fn new(observer: &'a dyn Observer) -> Self {
        Self { observer, ended: AtomicBool::new(false) }
    }

    /// Did it end the work?
    pub(crate) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}

impl Observer for Latch<'_> {
    fn observe(&self, progress: Progress) -> ControlFlow<()> {
        let flow = if self.has_ended() { ControlFlow::Break(()) } else { self.observer.observe(progress) };
        if flow.is_break() {
            self.ended.store(true, Ordering::Relaxed);
        }
        flow
    }
}
