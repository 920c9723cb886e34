//! Which limits a design holds, on the command line.

use armid::excitation::LimitSettings;

/// Which limits hold.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LimitArguments {
    /// Largest acceleration of every joint, in place of the robot's own limits
    #[arg(long, value_name = "RAD_S2")]
    pub(crate) max_acceleration: Option<f64>,
    /// Distance to keep from the position limits, deg: by default the soft limits of the guard that watches a real arm, and
    /// a degree for the servo. Prismatic joints keep as much of the guard's margin in metres
    #[arg(long, value_name = "DEG", default_value_t = LimitSettings::default().margin_deg)]
    margin: f64,
    /// Do not hold the limits of torque and current
    #[arg(long)]
    ignore_torque: bool,
    /// Probability with which torque and current keep their limits at any one instant, by the uncertainty that the
    /// nominal parameters state; 0.5 holds them for the nominal parameters alone
    #[arg(long, value_name = "P", default_value_t = 0.95)]
    confidence: f64,
    /// Length of the ramps in which the limits hold as well, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    ramp: f64,
    /// Hold the limits on the period alone, not on the ramps around it
    #[arg(long)]
    no_ramps: bool,
    /// Distance to keep between the robot's collision shapes and from obstacles, m
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    clearance: f64,
    /// Do not hold any clearance
    #[arg(long)]
    ignore_clearance: bool,
    /// Keep everything above this height of the base frame, m, beside the obstacles of the robot file
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
