//! Shapes that a residual may have, and what each would be a sign of.

use crate::model::JointKind;

/// What a residual is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Time since the beginning.
    Time,
    /// Speed of the joint.
    Speed,
    /// What its links take, by the estimate.
    Load,
    /// Position of the joint.
    Position,
}

impl Against {
    /// Every one.
    pub const ALL: [Self; 4] = [Self::Time, Self::Speed, Self::Load, Self::Position];

    /// As in `the residual follows …`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Speed => "speed",
            Self::Load => "load",
            Self::Position => "position",
        }
    }
}

/// Speeds, as a part of the RMS, below which friction near rest shows.
const NEAR_REST: f64 = 0.3;

/// A joint at one equation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// From −½ at the beginning to ½ at the end.
    pub(super) time: f64,
    pub(super) velocity: f64,
    /// RMS of the velocity over all equations.
    pub(super) speed_rms: f64,
    pub(super) load: f64,
    pub(super) position: f64,
}

/// What a term that the model lacks would add to the torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResidualShape {
    /// t/T: a change over the whole record.
    Drift,
    /// sgn q̇.
    Coulomb,
    /// q̇.
    Viscous,
    /// q̇ |q̇|.
    Quadratic,
    /// sgn q̇ exp(−(q̇/v)²), v 0.3 of the RMS.
    NearRest,
    /// τ_l.
    Gain,
    /// |τ_l| sgn q̇.
    LoadFriction,
    /// q.
    Spring,
    /// cos q sgn q̇.
    CosineFriction,
    /// sin q sgn q̇.
    SineFriction,
}

impl ResidualShape {
    /// Every one.
    pub const ALL: [Self; 10] = [
        Self::Drift,
        Self::Coulomb,
        Self::Viscous,
        Self::Quadratic,
        Self::NearRest,
        Self::Gain,
        Self::LoadFriction,
        Self::Spring,
        Self::CosineFriction,
        Self::SineFriction,
    ];

    /// In which figure it shows.
    #[must_use]
    pub const fn against(self) -> Against {
        match self {
            Self::Drift => Against::Time,
            Self::Coulomb | Self::Viscous | Self::Quadratic | Self::NearRest => Against::Speed,
            Self::Gain | Self::LoadFriction => Against::Load,
            Self::Spring | Self::CosineFriction | Self::SineFriction => Against::Position,
        }
    }

    /// The shape at one equation.
    pub(super) fn at(self, point: &Point) -> f64 {
        let v = point.velocity;
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        match self {
            Self::Drift => point.time,
            Self::Coulomb => sign,
            Self::Viscous => v,
            Self::Quadratic => v * v.abs(),
            Self::NearRest => {
                let x = v / (NEAR_REST * point.speed_rms).max(f64::MIN_POSITIVE);
                sign * libm::exp(-x * x)
            }
            Self::Gain => point.load,
            Self::LoadFriction => point.load.abs() * sign,
            Self::Spring => point.position,
            Self::CosineFriction => libm::cos(point.position) * sign,
            Self::SineFriction => libm::sin(point.position) * sign,
        }
    }

    /// Unit of its coefficient.
    pub(super) fn unit(self, kind: JointKind) -> String {
        let (effort, coordinate) = match kind {
            JointKind::Revolute => ("N·m", "rad"),
            JointKind::Prismatic => ("N", "m"),
        };
        match self {
            Self::Drift | Self::Coulomb | Self::NearRest | Self::CosineFriction | Self::SineFriction => {
                effort.to_owned()
            }
            Self::Viscous => format!("{effort} per {coordinate}/s"),
            Self::Quadratic => format!("{effort} per ({coordinate}/s)²"),
            Self::Gain | Self::LoadFriction => format!("{effort} per {effort}"),
            Self::Spring => format!("{effort} per {coordinate}"),
        }
    }

    /// How the residual goes, where the coefficient is positive or negative.
    pub(super) const fn course(self, positive: bool) -> &'static str {
        match (self, positive) {
            (Self::Drift, true) => "the residual rises over the record",
            (Self::Drift, false) => "the residual falls over the record",
            (Self::Coulomb, true) => "the residual steps up where the speed changes its sign",
            (Self::Coulomb, false) => "the residual steps down where the speed changes its sign",
            (Self::Viscous, true) => "the residual grows with speed",
            (Self::Viscous, false) => "the residual falls with speed",
            (Self::Quadratic, true) => "the residual grows with the square of speed",
            (Self::Quadratic, false) => "the residual falls with the square of speed",
            (Self::NearRest, true) => "the residual is along the motion near rest",
            (Self::NearRest, false) => "the residual is against the motion near rest",
            (Self::Gain, true) => "the residual grows with load",
            (Self::Gain, false) => "the residual falls with load",
            (Self::LoadFriction, true) => "the residual grows with load along the motion",
            (Self::LoadFriction, false) => "the residual grows with load against the motion",
            (Self::Spring, true) => "the residual grows with position",
            (Self::Spring, false) => "the residual falls with position",
            (Self::CosineFriction | Self::SineFriction, _) => "the residual along the motion changes with position",
        }
    }

    /// What would look like it.
    pub(super) const fn sign_of(self, positive: bool) -> &'static str {
        match (self, positive) {
            (Self::Drift, _) => "as a sensor that drifts or a gear that warms up would show",
            (Self::Coulomb, true) => "as Coulomb friction that the model lacks would show",
            (Self::Viscous, true) => "as viscous friction that the model lacks would show",
            (Self::Quadratic, true) => "as friction with the square of speed that the model lacks would show",
            (Self::Coulomb | Self::Viscous, false) => "as friction that the model has too much of would show",
            (Self::Quadratic, false) => "as friction that flattens out at speed would show",
            (Self::NearRest, true) => "as Stribeck friction that the model lacks would show",
            (Self::NearRest, false) => "as friction that sets in softly from rest would show",
            (Self::Gain, _) => "as a wrong torque constant or gear ratio of this joint would show",
            (Self::LoadFriction, true) => "as load-dependent friction that the model lacks would show",
            (Self::LoadFriction, false) => "as a gear that loses less under load than the model says would show",
            (Self::Spring, true) => "as a spring or a cable that the model lacks would show",
            (Self::Spring, false) => "as a spring that pushes away from zero, a gravity compensator say, would show",
            (Self::CosineFriction | Self::SineFriction, _) => "as friction that depends on position would show",
        }
    }
}
