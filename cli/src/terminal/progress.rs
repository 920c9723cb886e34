//! Progress bars, for a person at a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Console;

/// A bar of `length` steps; hidden where there is no terminal.
pub(crate) fn bar(console: &Console, length: u64, what: &'static str) -> ProgressBar {
    let target = if console.talks() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{msg:>12} {bar:40} {pos}/{len}  {elapsed} + {eta}  {prefix}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(length), target).with_style(style).with_message(what)
}
