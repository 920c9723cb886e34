//! How a robot is controlled while it is measured: the signal it reports as effort, and the servo's tuning.

/// What a robot's controller reports as effort.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EffortInterface {
    /// The motor current, A: gear, torque constant and coupling turn it into a torque.
    #[default]
    Current,
    /// The effort at the joint itself, N·m (N for a prismatic joint).
    Torque,
}

crate::input::named! { EffortInterface { Current: "current", Torque: "torque" } }

/// Tuning of the joint servo: one PID per joint, placed on the nominal inertia `J` that the joint sees.
///
/// ```text
/// ω = 2π bandwidth_hz     Kp = J ω²     Kd = 2 ζ ω J     Ki = Kp · 2π integral_hz
/// ```
/// `ζ` is the damping. The loop is stable on `J` where `2π integral_hz < 2 ζ ω`.
///
/// With `friction`, Kp is raised by what nominal friction needs: URDFs have joints whose damping is a thousand times what a servo
/// on their inertia alone would overcome. With viscous and Coulomb friction Fv and Fc, the speed limit v and the servo's rate f
///
/// ```text
/// Kp = J ω² + Fv ω + min(Fc ω / v, J ((0.3 f)² − ω²))      Kd = 2 ζ J min(√(Kp / J), 0.3 f)
/// ```
/// so that friction at the speed v leaves an error of at most `v/ω`, less what the integral takes, and the derivative stays slower
/// than the servo.
///
/// ```
/// # use armid_mechanics as armid;
/// let tuning = armid::model::ServoTuning::ASSUMED;
/// assert!(tuning.integral_hz < 2.0 * tuning.damping * tuning.bandwidth_hz);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoTuning {
    /// Rate of the servo, Hz.
    pub rate_hz: f64,
    /// Natural frequency of the position loop, Hz.
    pub bandwidth_hz: f64,
    /// Damping ratio ζ.
    pub damping: f64,
    /// Corner frequency of the integral action, Hz; 0 means none.
    pub integral_hz: f64,
    /// Whether the gains overcome the nominal friction, too.
    #[serde(default)]
    pub friction: bool,
}

impl ServoTuning {
    /// 1 kHz, 8 Hz, damping 0.8, a mild integral, and friction overcome: what a simulated arm has whose robot file states no servo.
    pub const ASSUMED: Self =
        Self { rate_hz: 1000.0, bandwidth_hz: 8.0, damping: 0.8, integral_hz: 0.5, friction: true };
}
