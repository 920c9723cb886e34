//! The person who waits for long work: bars at a terminal, and Ctrl-C.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use armid::observer::{Observer, Progress, Work};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Console;
use crate::interrupt;

/// Shows how far work is, and ends it when a signal asks for it.
pub(crate) struct Watch<'a> {
    console: &'a Console,
    bar: Mutex<Option<(Work, ProgressBar)>>,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(console: &'a Console) -> Self {
        Self { console, bar: Mutex::new(None) }
    }

    fn show(&self, progress: Progress) {
        let Some(what) = shown(progress.work) else { return };
        let mut shown = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.is_complete() {
            if let Some((_, bar)) = shown.take() {
                bar.finish_and_clear();
            }
            return;
        }
        match &*shown {
            Some((work, bar)) if *work == progress.work => {
                // Threads report out of order.
                bar.set_position(bar.position().max(progress.done as u64));
            }
            _ => *shown = Some((progress.work, bar(self.console, progress.total as u64, what))),
        }
    }
}

impl Observer for Watch<'_> {
    fn observe(&self, progress: Progress) -> ControlFlow<()> {
        if interrupt::asked() {
            return ControlFlow::Break(());
        }
        if self.console.talks() {
            self.show(progress);
        }
        ControlFlow::Continue(())
    }

    fn note(&self, sentence: &str) {
        self.console.note(sentence);
    }
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        if let Some((_, bar)) = self.bar.get_mut().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }
}

/// What the bar of a kind of work counts; `None` of work within that of another bar.
fn shown(work: Work) -> Option<&'static str> {
    match work {
        Work::Designs => Some("designs"),
        Work::Runs => Some("runs"),
        Work::Starts => Some("starts"),
        _ => None,
    }
}

/// A bar of `length` steps; hidden where there is no terminal.
pub(crate) fn bar(console: &Console, length: u64, what: &'static str) -> ProgressBar {
    let target = if console.talks() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{msg:>12} {bar:40} {pos}/{len}  {elapsed} + {eta}  {prefix}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(length), target).with_style(style).with_message(what)
}
