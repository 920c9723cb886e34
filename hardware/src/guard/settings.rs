//! `[guard]` of an experiment file: the limit of each check.

use armid::experiment::Expectation;

/// Limits of the guard. Angles are for revolute joints, lengths for prismatic ones.
///
/// The defaults follow what laboratories use with arms of this class: soft limits 3 to 5 degrees inside the hard ones,
/// set-points no older than 20 ms. The others are assumed: above what a servo of 8 Hz does on a good day, far below what
/// does harm.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GuardSettings {
    /// How far the soft limits lie inside the hard ones, deg.
    pub soft_margin_deg: f64,
    /// How far the soft limits lie inside the hard ones of a prismatic joint, m.
    pub soft_margin_m: f64,
    /// Largest distance from the command, deg.
    pub following_error_deg: f64,
    /// Largest distance from the command of a prismatic joint, m.
    pub following_error_m: f64,
    /// What a position may move between two samples beyond 1.5 times the speed limit, deg.
    pub jump_deg: f64,
    /// What a position may move between two samples beyond 1.5 times the speed limit of a prismatic joint, m.
    pub jump_m: f64,
    /// Largest measured speed, in parts of a joint's speed limit.
    pub overspeed: f64,
    /// Largest speed of the flange and of every point that the robot file names, mm/s; 0 sets no limit. For people
    /// beside the arm, 250.
    pub reduced_speed_mm_s: f64,
    /// Part of the current limit that may be used for longer than the window.
    pub current_clamp: f64,
    /// How long the clamp may be exceeded, in all, within eight times that long, ms.
    pub current_window_ms: f64,
    /// Silence after which the state is stale, ms.
    pub stale_ms: f64,
    /// Age at which a set-point is no longer sent, ms.
    pub command_age_ms: f64,
    /// Time over which command and motion are compared to detect that the arm stands, ms.
    pub stop_window_ms: f64,
    /// Part of the speed and acceleration limits used on the way to the start pose.
    pub approach_speed: f64,
}

impl Default for GuardSettings {
    fn default() -> Self {
        Self {
            soft_margin_deg: 4.0,
            soft_margin_m: 0.01,
            following_error_deg: 5.0,
            following_error_m: 0.02,
            jump_deg: 1.0,
            jump_m: 0.005,
            overspeed: 1.1,
            reduced_speed_mm_s: 0.0,
            current_clamp: 0.95,
            current_window_ms: 20.0,
            stale_ms: 50.0,
            command_age_ms: 20.0,
            stop_window_ms: 200.0,
            approach_speed: 0.1,
        }
    }
}

/// A setting outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} is {found}, expected {expected}")]
pub struct SettingError {
    /// Key in `[guard]`.
    pub key: &'static str,
    /// What was found.
    pub found: f64,
    /// What is possible.
    pub expected: Expectation,
}

impl GuardSettings {
    /// Every setting with its key, and what is possible: above the first number (or equal to it where the third says so),
    /// at most the second.
    ///
    /// The upper ends: a soft margin leaves a range; a following error of 20 degrees or a jump of 10 is no servo's; an
    /// overspeed of half as much again is no overshoot; a window of current within the thermal time constant of a small
    /// motor; half a second of silence is as long as a piece of a motion lasts, twice that for a machine that does other
    /// work; an approach at a quarter of the speed is one that a person can still stop.
    fn ranges(&self) -> [(&'static str, f64, f64, f64, bool); 14] {
        [
            ("soft_margin_deg", self.soft_margin_deg, 0.0, 45.0, true),
            ("soft_margin_m", self.soft_margin_m, 0.0, 0.5, true),
            ("following_error_deg", self.following_error_deg, 0.0, 20.0, false),
            ("following_error_m", self.following_error_m, 0.0, 0.1, false),
            ("jump_deg", self.jump_deg, 0.0, 10.0, false),
            ("jump_m", self.jump_m, 0.0, 0.05, false),
            ("overspeed", self.overspeed, 0.0, 1.5, false),
            ("reduced_speed_mm_s", self.reduced_speed_mm_s, 0.0, 1000.0, true),
            ("current_clamp", self.current_clamp, 0.0, 1.0, false),
            ("current_window_ms", self.current_window_ms, 0.0, 200.0, false),
            ("stale_ms", self.stale_ms, 0.0, 1000.0, false),
            ("command_age_ms", self.command_age_ms, 0.0, 200.0, false),
            ("stop_window_ms", self.stop_window_ms, 0.0, 2000.0, false),
            ("approach_speed", self.approach_speed, 0.0, 0.25, false),
        ]
    }

    /// Every setting is in its range.
    ///
    /// # Errors
    /// [`SettingError`] for the first that does not.
    pub fn check(&self) -> Result<(), SettingError> {
        for (key, found, low, high, inclusive) in self.ranges() {
            let above = found > low || (inclusive && found == low);
            if !(above && found <= high) {
                return Err(SettingError { key, found, expected: Expectation::Range { low, inclusive, high } });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_outside_their_range_are_named() {
        assert_eq!(GuardSettings::default().check(), Ok(()));
        for (broken, key) in [
            (GuardSettings { stale_ms: 0.0, ..GuardSettings::default() }, "stale_ms"),
            (GuardSettings { jump_deg: f64::NAN, ..GuardSettings::default() }, "jump_deg"),
            (GuardSettings { current_clamp: 1.5, ..GuardSettings::default() }, "current_clamp"),
            (GuardSettings { soft_margin_deg: -1.0, ..GuardSettings::default() }, "soft_margin_deg"),
            (GuardSettings { following_error_deg: 1e6, ..GuardSettings::default() }, "following_error_deg"),
            (GuardSettings { jump_deg: 1e6, ..GuardSettings::default() }, "jump_deg"),
            (GuardSettings { stop_window_ms: 1e9, ..GuardSettings::default() }, "stop_window_ms"),
            (GuardSettings { approach_speed: 1.0, ..GuardSettings::default() }, "approach_speed"),
        ] {
            assert_eq!(broken.check().unwrap_err().key, key);
        }
    }

    #[test]
    fn every_setting_has_an_upper_end() {
        let keys = serde_json::to_value(GuardSettings::default()).unwrap();
        let keys: Vec<&String> = keys.as_object().unwrap().keys().collect();
        let ranges = GuardSettings::default().ranges();
        assert_eq!(keys.len(), ranges.len());
        assert!(keys.iter().all(|key| ranges.iter().any(|(named, ..)| named == key)));
        assert!(ranges.iter().all(|(_, _, _, high, _)| high.is_finite()));
    }
}
