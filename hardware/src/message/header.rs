//! Time, and the header that many messages begin with.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// `builtin_interfaces/msg/Time`, and `Duration`, whose bytes are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds since the clock's zero.
    pub sec: i32,
    /// The rest, ns.
    pub nanosec: u32,
}

impl Message for Time {}

impl Time {
    /// The time that is `ns` nanoseconds after the clock's zero; beyond the year 2038 it stays at the last second.
    #[must_use]
    pub fn from_ns(ns: i64) -> Self {
        let sec = ns.div_euclid(1_000_000_000).clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self { sec: sec as i32, nanosec: ns.rem_euclid(1_000_000_000) as u32 }
    }

    /// The time that is `s` seconds after the clock's zero, to the nearest nanosecond.
    #[must_use]
    pub fn from_s(s: f64) -> Self {
        Self::from_ns((s * 1e9).round() as i64)
    }

    /// Nanoseconds since the clock's zero.
    #[must_use]
    pub fn ns(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }

    /// Seconds since the clock's zero; exact to a nanosecond for durations, to a quarter of a microsecond for dates.
    #[must_use]
    pub fn seconds(self) -> f64 {
        self.ns() as f64 * 1e-9
    }
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// When the data were taken, by the sender's clock.
    pub stamp: Time,
    /// Frame that the data are in.
    pub frame_id: String,
}

impl Message for Header {}
