//! `[guard]` of an experiment file: where each check draws its line.

/// Where the guard draws its lines. Angles are for joints that turn, lengths for joints that slide.
///
/// The defaults follow what laboratories use with arms of this class: soft limits 3 to 5 degrees inside the hard ones,
/// set-points no older than 20 ms. The others are assumed: above what a servo of 8 Hz does on a good day, far below what
/// does harm.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GuardSettings {
    /// How far the soft limits lie inside the hard ones, deg.
    pub soft_margin_deg: f64,
    /// The same for sliding joints, m.
    pub soft_margin_m: f64,
    /// Largest distance from the command, deg.
    pub following_error_deg: f64,
    /// The same for sliding joints, m.
    pub following_error_m: f64,
    /// What a position may move between two samples beyond 1.5 times the speed limit, deg.
    pub jump_deg: f64,
    /// The same for sliding joints, m.
    pub jump_m: f64,
    /// Part of the current limit that may be used for longer than the window.
    pub current_clamp: f64,
    /// How long the clamp may be exceeded, ms.
    pub current_window_ms: f64,
    /// Silence after which the state is stale, ms.
    pub stale_ms: f64,
    /// Age at which a set-point is no longer sent, ms.
    pub command_age_ms: f64,
    /// Time over which command and motion are compared to tell that the arm stands, ms.
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
            current_clamp: 0.95,
            current_window_ms: 20.0,
            stale_ms: 50.0,
            command_age_ms: 20.0,
            stop_window_ms: 200.0,
            approach_speed: 0.1,
        }
    }
}

/// A setting that draws no line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} is {found}, expected {expected}")]
pub struct SettingError {
    /// Key in `[guard]`.
    pub key: &'static str,
    /// What was found.
    pub found: f64,
    /// What is possible.
    pub expected: &'static str,
}

impl GuardSettings {
    /// Every setting draws a line.
    ///
    /// # Errors
    /// [`SettingError`] for the first that does not.
    pub fn check(&self) -> Result<(), SettingError> {
        let above = [
            ("following_error_deg", self.following_error_deg),
            ("following_error_m", self.following_error_m),
            ("jump_deg", self.jump_deg),
            ("jump_m", self.jump_m),
            ("current_window_ms", self.current_window_ms),
            ("stale_ms", self.stale_ms),
            ("command_age_ms", self.command_age_ms),
            ("stop_window_ms", self.stop_window_ms),
        ];
        let parts = [("current_clamp", self.current_clamp), ("approach_speed", self.approach_speed)];
        let margins = [("soft_margin_deg", self.soft_margin_deg), ("soft_margin_m", self.soft_margin_m)];
        let fault = |key, found, expected| Err(SettingError { key, found, expected });
        for (key, found) in above {
            if !(found.is_finite() && found > 0.0) {
                return fault(key, found, "a finite number above zero");
            }
        }
        for (key, found) in parts {
            if !(found > 0.0 && found <= 1.0) {
                return fault(key, found, "a part above zero, at most 1");
            }
        }
        for (key, found) in margins {
            if !(found.is_finite() && found >= 0.0) {
                return fault(key, found, "a finite number not below zero");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_draw_no_line_are_named() {
        assert_eq!(GuardSettings::default().check(), Ok(()));
        for (broken, key) in [
            (GuardSettings { stale_ms: 0.0, ..GuardSettings::default() }, "stale_ms"),
            (GuardSettings { jump_deg: f64::NAN, ..GuardSettings::default() }, "jump_deg"),
            (GuardSettings { current_clamp: 1.5, ..GuardSettings::default() }, "current_clamp"),
            (GuardSettings { soft_margin_deg: -1.0, ..GuardSettings::default() }, "soft_margin_deg"),
        ] {
            assert_eq!(broken.check().unwrap_err().key, key);
        }
    }
}
