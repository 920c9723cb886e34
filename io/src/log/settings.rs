//! What a log does not say of itself, and how it becomes samples.

use armid::estimation::DEFAULT_BANDWIDTH_HZ;
use armid::model::EffortInterface;
use armid::signal::Processing;
use serde::{Deserialize, Serialize};

/// Which part of a log is held out for validation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOut {
    /// The last fifth of a log that something else recorded, nothing of armid's own.
    #[default]
    LastFifth,
    /// Nothing.
    Nothing,
    /// The last part of the log, between 0 and 1.
    Share(f64),
}

impl HeldOut {
    /// Whether a part was asked for.
    pub(super) const fn is_share(self) -> bool {
        matches!(self, Self::Share(_))
    }

    /// The part of a log.
    pub(super) fn share(self, foreign: bool) -> f64 {
        match self {
            Self::LastFifth if foreign => 0.2,
            Self::LastFifth | Self::Nothing => 0.0,
            Self::Share(share) => share,
        }
    }
}

/// What a log does not say of itself, and how it becomes samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LogSettings {
    /// Period of a log that does not say it, s; without one it is taken as not periodic.
    pub period_s: Option<f64>,
    /// Whether the period, and the part in which it repeats, are looked for in a log where they are not stated.
    #[serde(default)]
    pub finds_period: bool,
    /// Start of the part that is used, s. Ignored for logs that mark it themselves.
    pub from_s: f64,
    /// Where it ends to count, s; at its end where it is `None`.
    pub until_s: Option<f64>,
    /// Which part of it is held out.
    pub held_out: HeldOut,
    /// Takes velocities as measured, instead of from the positions.
    pub measured_velocity: bool,
    /// What the efforts are, where the log does not say it; `None` leaves it to the robot.
    pub effort: Option<EffortInterface>,
    /// Cut-off of the low pass through which residuals are compared, Hz.
    pub bandwidth_hz: f64,
    /// Derivatives, cut-off, samples that are kept.
    pub processing: Processing,
}

impl Default for LogSettings {
    fn default() -> Self {
        Self {
            period_s: None,
            finds_period: false,
            from_s: 0.0,
            until_s: None,
            held_out: HeldOut::default(),
            measured_velocity: false,
            effort: None,
            bandwidth_hz: DEFAULT_BANDWIDTH_HZ,
            processing: Processing::default(),
        }
    }
}

impl LogSettings {
    /// The settings for a log of a motion that repeats itself every `period_s` seconds.
    pub fn periodic(period_s: f64) -> Self {
        Self { period_s: Some(period_s), ..Self::default() }
    }

    /// Returns these settings for a choice of terms: rows near reversals stay, since they tell laws of friction apart.
    #[must_use]
    pub fn for_selection(mut self) -> Self {
        self.processing.reversal_cycles = 0.0;
        self
    }
}
