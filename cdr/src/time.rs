//! Time as messages hold it.

use serde::{Deserialize, Serialize};

use super::CdrError;

/// `builtin_interfaces/msg/Time`, and `Duration`, whose bytes are the same: seconds in 32 bits with a sign.
///
/// ```
/// use armid_cdr::Time;
/// assert_eq!(Time::from_ns(-1)?, Time { sec: -1, nanosec: 999_999_999 });
/// assert!(Time::from_ns(2_147_483_648_000_000_000).is_err()); // 19 January 2038, 3:14:08
/// # Ok::<(), armid_cdr::CdrError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds since the clock's zero.
    pub sec: i32,
    /// The rest, ns.
    pub nanosec: u32,
}

impl Time {
    /// The time that is `ns` nanoseconds after the clock's zero.
    ///
    /// # Errors
    /// [`CdrError::Time`] where 32 bits do not hold the seconds: a date after 19 January 2038 has no such time. A wrong
    /// stamp, wrapped or clamped, would move a motion into the past.
    pub fn from_ns(ns: i64) -> Result<Self, CdrError> {
        let seconds = ns.div_euclid(1_000_000_000);
        let sec = i32::try_from(seconds).map_err(|_| CdrError::Time { seconds })?;
        Ok(Self { sec, nanosec: ns.rem_euclid(1_000_000_000) as u32 })
    }

    /// The time that is `s` seconds after the clock's zero, to the nearest nanosecond.
    ///
    /// # Errors
    /// As [`Self::from_ns`].
    pub fn from_s(s: f64) -> Result<Self, CdrError> {
        Self::from_ns((s * 1e9).round() as i64)
    }

    /// Nanoseconds since the clock's zero.
    pub fn ns(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }

    /// Seconds since the clock's zero; exact to a nanosecond for durations, to a quarter of a microsecond for dates.
    pub fn seconds(self) -> f64 {
        self.ns() as f64 * 1e-9
    }
}

#[cfg(test)]
mod tests {
    use super::{CdrError, Time};

    #[test]
    fn analytic_times_before_and_after_zero() {
        for (ns, sec, nanosec) in [(-1, -1, 999_999_999), (0, 0, 0), (3_000_000_005, 3, 5)] {
            let time = Time::from_ns(ns).unwrap();
            assert_eq!((time.sec, time.nanosec, time.ns()), (sec, nanosec, ns));
        }
        assert_eq!(Time::from_s(1.000_000_002), Ok(Time { sec: 1, nanosec: 2 }));
    }

    #[test]
    fn a_time_that_32_bits_do_not_hold_is_refused_neither_wrapped_nor_clamped() {
        let last = 2_147_483_647_999_999_999;
        assert_eq!(Time::from_ns(last), Ok(Time { sec: i32::MAX, nanosec: 999_999_999 }));
        assert_eq!(Time::from_ns(last + 1), Err(CdrError::Time { seconds: 2_147_483_648 }));
        let first = -2_147_483_648_000_000_000;
        assert_eq!(Time::from_ns(first), Ok(Time { sec: i32::MIN, nanosec: 0 }));
        assert_eq!(Time::from_ns(first - 1), Err(CdrError::Time { seconds: -2_147_483_649 }));
        assert!(Time::from_s(f64::INFINITY).is_err());
    }
}
