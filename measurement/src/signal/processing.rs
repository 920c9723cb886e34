//! The settings of signal processing.
//!
//! What they do was measured on the A460 in closed loop along Table I: encoder counts, noisy currents, 10 periods,
//! 40 runs, weighted least squares on all 58 columns. Error of predicted torque in N·m, and how often 95 % intervals
//! hold the truth when they are taken from the scatter over periods alone:
//!
//! ```text
//! positions           reversals kept        left out          left out, torque filtered alike
//! Fourier, default    2.8e-3    80 %        2.7e-3   94 %
//! differences 50 Hz   3.2e-3    80 %        2.7e-3   94 %
//! differences 10 Hz   2.4e-2     9 %        1.1e-2   34 %     2.8e-2   24 %
//! ```
//! Positions need a band far beyond the commanded 0.5 Hz, for the loop responds to each reversal of friction with a transient.
//! Filtering torque as well makes it worse there, where the Coulomb columns were not filtered alike. 125 to 500 equations a period
//! are equally good; at 1000 the noise of the acceleration shows, and coverage falls to 84 %.

use super::error::{SignalError, refused};
use super::harmonics::Bandwidth;

/// How velocity and acceleration are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derivatives {
    /// Analytically, through the Fourier coefficients of the measured positions. Needs periods.
    #[default]
    Fourier,
    /// Zero-phase Butterworth low pass, then central differences: `radkhah2007` IV.B.
    Differences,
}

crate::input::named! { Derivatives { Fourier: "fourier", Differences: "differences" } }

/// Which low pass torque goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TorqueFilter {
    /// None: blocks of samples are averaged on both sides of the equations, which biases nothing.
    #[default]
    None,
    /// The one that positions went through. A filter does not commute with the model: where friction reverses, it smooths the torque. So
    /// the columns of friction that turns round with velocity go through it too.
    SameAsPositions,
}

crate::input::named! { TorqueFilter { None: "none", SameAsPositions: "same-as-positions" } }

/// Settings of the processing from a recording to samples.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::{Derivatives, Processing};
/// let processing = Processing { derivatives: Derivatives::Differences, ..Processing::default() };
/// assert_eq!(processing.cutoff_hz(0.5), 10.0); // 5 × 0.5 Hz is below 10 Hz
/// assert_eq!(processing.cutoff_hz(4.0), 20.0);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Processing {
    /// How velocity and acceleration are found.
    pub derivatives: Derivatives,
    /// Which harmonics of the measured positions are kept, on the Fourier route.
    pub bandwidth: Bandwidth,
    /// Cut-off of one pass of the low pass on the route of differences, Hz, and the highest frequency kept on the Fourier route in place
    /// of `bandwidth`. Where it is `None`, differences of periods take 5 times the highest commanded frequency or 10 Hz, whichever is
    /// higher, and records without periods what is found in them.
    pub cutoff_hz: Option<f64>,
    /// Order of one pass of that low pass.
    pub filter_order: usize,
    /// Which low pass torque goes through.
    pub torque_filter: TorqueFilter,
    /// Equations per joint and period, at most: so many blocks of consecutive samples are averaged, on both sides of
    /// the equations. The largest divisor of the samples in a period that does not exceed it.
    pub samples_per_period: usize,
    /// Blocks in which a joint moves slower than this fraction of its top speed give no equation of that joint: where
    /// its friction reverses, the measured velocity is not good enough to say when. 0 keeps all.
    pub reversal_fraction: f64,
    /// Equations without periods that are nearer than so many periods of the cut-off to a sample where their joint is that slow, or turns round,
    /// are none either. There the acceleration steps with friction and the torque does not: of a step the low pass still loses 7 % after half a
    /// period, and at most 2 % after 3/4 of one, the default. Friction and inertias would answer for it. A `reversal_fraction` of 0 keeps all,
    /// and blocks near a reversal of more than half of the joints stay.
    #[serde(default = "usual_reach")]
    pub reversal_cycles: f64,
}

fn usual_reach() -> f64 {
    0.75
}

impl Default for Processing {
    fn default() -> Self {
        Self {
            derivatives: Derivatives::Fourier,
            bandwidth: Bandwidth::NoiseFloor,
            cutoff_hz: None,
            filter_order: 4,
            torque_filter: TorqueFilter::None,
            samples_per_period: 250,
            reversal_fraction: 0.02,
            reversal_cycles: usual_reach(),
        }
    }
}

impl Processing {
    /// The cut-off for a motion whose highest commanded frequency is `highest_hz`, Hz.
    pub fn cutoff_hz(&self, highest_hz: f64) -> f64 {
        self.cutoff_hz.unwrap_or((5.0 * highest_hz).max(10.0))
    }

    /// Which harmonics are kept on the Fourier route.
    pub(super) fn bandwidth(&self) -> Bandwidth {
        self.cutoff_hz.map_or(self.bandwidth, Bandwidth::Hertz)
    }

    /// Checks the settings that make sense only within bounds.
    pub(super) fn check(&self) -> Result<(), SignalError> {
        if self.samples_per_period < 8 {
            return Err(SignalError::TooFewSamples { found: self.samples_per_period, least: 8 });
        }
        if !(0.0..0.5).contains(&self.reversal_fraction) {
            let setting = "fraction of the top speed below which equations are left out";
            return refused(setting, self.reversal_fraction, "0 to 0.5");
        }
        if !(0.0..=10.0).contains(&self.reversal_cycles) {
            let setting = "periods of the cut-off that equations are from a reversal";
            return refused(setting, self.reversal_cycles, "0 to 10");
        }
        match self.bandwidth() {
            Bandwidth::Hertz(hz) if !(hz.is_finite() && hz > 0.0) => {
                refused("bandwidth of the positions", format!("{hz} Hz"), "a finite frequency above zero")
            }
            Bandwidth::Harmonics(0) => refused("bandwidth of the positions", "0 harmonics", "at least 1"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_without_meaning_are_named() {
        let usual = Processing::default();
        assert!(usual.check().is_ok());
        for (wrong, words) in [
            (Processing { bandwidth: Bandwidth::Harmonics(0), ..usual.clone() }, "0 harmonics"),
            (Processing { cutoff_hz: Some(0.0), ..usual.clone() }, "0 Hz"),
            (Processing { samples_per_period: 7, ..usual.clone() }, "7"),
            (Processing { reversal_fraction: 0.5, ..usual.clone() }, "0.5"),
            (Processing { reversal_cycles: 10.1, ..usual.clone() }, "10.1"),
        ] {
            let fault = wrong.check().expect_err(words).to_string();
            assert!(fault.contains(words), "{fault}");
        }
        assert!(Processing { bandwidth: Bandwidth::Harmonics(1), ..usual }.check().is_ok());
    }
}
