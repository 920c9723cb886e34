//! What work costs, whatever else the machine does.

use std::time::Duration;

/// Processor time that this process has used on all its threads, s.
#[cfg(unix)]
pub(crate) fn processor_seconds() -> f64 {
    use nix::time::{ClockId, clock_gettime};
    // This clock is one that every process has; a number that is none is better than none spent.
    clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID).map_or(f64::NAN, |used| Duration::from(used).as_secs_f64())
}

/// Wall time where the system does not tell processor time apart, s.
#[cfg(not(unix))]
pub(crate) fn processor_seconds() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    let used: Duration = BEGIN.get_or_init(Instant::now).elapsed();
    used.as_secs_f64()
}
