//! Which limits a design holds, on the command line.

use armid::excitation::LimitSettings;

/// Which limits hold.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LimitArguments {
    /// Largest acceleration of every joint, instead of the robot's limits
    #[arg(long, value_name = "RAD_S2")]
    pub(crate) max_acceleration: Option<f64>,
    /// Distance from the position limits, deg [the guard's and one more]
    #[arg(long, value_name = "DEG", default_value_t = LimitSettings::default().margin_deg)]
    margin: f64,
    /// Ignore the limits of torque and current
    #[arg(long)]
    ignore_torque: bool,
    /// Probability of keeping torque and current limits; see `armid help limits`
    #[arg(long, value_name = "P", default_value_t = 0.95)]
    confidence: f64,
    /// Length of the ramps, which keep the limits too, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    ramp: f64,
    /// Keep the limits in the period only, not on the ramps
    #[arg(long)]
    no_ramps: bool,
    /// Distance to keep between the robot's collision shapes and from obstacles, m
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    clearance: f64,
    /// Ignore collisions
    #[arg(long)]
    ignore_clearance: bool,
    /// Keep all shapes above this height of the base frame, m
    #[arg(long, value_name = "Z")]
    pub(crate) keep_above: Option<f64>,
}

impl LimitArguments {
    /// The limits that are held.
    pub(crate) fn settings(&self) -> LimitSettings {
        LimitSettings {
            margin_deg: self.margin,
            confidence: (!self.ignore_torque).then_some(self.confidence),
            ramp_s: (!self.no_ramps).then_some(self.ramp),
            clearance_m: (!self.ignore_clearance).then_some(self.clearance),
        }
    }
}
