//! Mistakes that logs are made with, and what to correct.

use crate::remedy::{Remedy, Setting};

/// A mistake in a log or about the robot. Joints are counted from one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[serde(tag = "mistake", rename_all = "kebab-case")]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum Mistake {
    /// Positions are in degrees, and were read as radians.
    #[error("the positions look like degrees, and are read as radians")]
    Degrees,
    /// Positions are in radians, and were read as degrees.
    #[error("the positions look like radians, and are read as degrees")]
    Radians,
    /// Positions are those of the motors.
    #[error("the positions look like those of the motors, and are read as those of the joints")]
    MotorAngles,
    /// Positions are in another unit, or those of motors whose gears the robot file does not know: the true ones are `factor` times those in
    /// the log.
    #[error("the positions of all joints look {:.4} times too large", factor.recip())]
    PositionUnit { factor: f64 },
    /// Torques are those of the motors.
    #[error("the torques look like those of the motors, and are read as those of the joints")]
    MotorTorques,
    /// Efforts are in another unit: the true ones are `factor` times those in the log.
    #[error("the efforts are beyond the limits of the joints; times {factor} they are not")]
    EffortUnit { factor: f64 },
    /// All efforts count the other way; `slope` is the median over the joints of measured torque over that of the robot file, `None` where
    /// friction alone shows it.
    #[error("all torques are reversed: {}", reversed(*slope))]
    EffortsReversed { slope: Option<f64> },
    /// All efforts are too small to be torques of the joints: currents, or torques of the motors. `times` are the least and largest torque of
    /// the robot file over measured effort.
    #[error(
        "these look like currents, or torques at the motor: the robot file's torque is {:.0} to {:.0} times as large", times[0], times[1]
    )]
    EffortsSmall { times: [f64; 2] },
    /// Gravity does not act along the axis that the robot file says, but in this direction of the base frame.
    #[error(
        "gravity seems to act along [{}, {}, {}] of the base, not as in the robot file", direction[0], direction[1], direction[2]
    )]
    Gravity { direction: [i8; 3] },
    /// The sign of a position is reversed.
    #[error("the position of joint {joint} seems to count the other way")]
    PositionSign { joint: usize },
    /// The sign of an effort is reversed.
    #[error("the effort of joint {joint} seems to count the other way")]
    EffortSign { joint: usize },
    /// The sign of either the position or the effort of a joint is reversed; the data do not show which.
    #[error("position and effort of joint {joint} seem to count in opposite ways")]
    EitherSign { joint: usize },
    /// The positions of two joints are exchanged.
    #[error("the positions of joints {} and {} seem to be exchanged", joints[0], joints[1])]
    PositionsSwapped { joints: [usize; 2] },
    /// The efforts of two joints are exchanged.
    #[error("the efforts of joints {} and {} seem to be exchanged", joints[0], joints[1])]
    EffortsSwapped { joints: [usize; 2] },
    /// Two joints are exchanged, positions and efforts.
    #[error("joints {} and {} seem to be exchanged", joints[0], joints[1])]
    JointsSwapped { joints: [usize; 2] },
    /// A position is too large by a factor: a wrong gear ratio. The true one is `factor` times that in the log.
    #[error("the positions of joint {joint} seem to be {:.4} times the true ones", factor.recip())]
    PositionScale { joint: usize, factor: f64 },
    /// An effort is too large by a factor: a wrong gear ratio or torque constant. The true one is `factor` times that in the log.
    #[error("the efforts of joint {joint} seem to be {:.4} times the true ones", factor.recip())]
    EffortScale { joint: usize, factor: f64 },
    /// A joint's zero is another: so many degrees are to be added to its position.
    #[error("the zero of joint {joint} seems to be off by {degrees}°")]
    ZeroOffset { joint: usize, degrees: f64 },
    /// The effort of a joint that moves is one number throughout.
    #[error("the effort of joint {joint} is one number throughout, although the joint moves")]
    NoEffort { joint: usize },
    /// A joint stands still.
    #[error("joint {joint} is at rest")]
    AtRest { joint: usize },
}

impl Mistake {
    /// Whether columns are exchanged.
    pub(super) const fn is_exchange(&self) -> bool {
        matches!(self, Self::PositionsSwapped { .. } | Self::EffortsSwapped { .. } | Self::JointsSwapped { .. })
    }

    /// What to try.
    pub fn correction(&self) -> Remedy {
        let map = |words: &str, map: &str| Remedy::from(words).assign(Setting::Map, map);
        match self {
            Self::Degrees => map("state the unit: ", "q=… deg"),
            Self::Radians => map("state the unit: ", "q=… rad"),
            Self::PositionUnit { factor } => {
                let words = format!("state the side and the gears, about {:.0} on average: ", factor.recip());
                map(&words, "q=… motor gear=…").say("; or the unit")
            }
            Self::MotorAngles => map("state the side: ", "q=… motor").say(", with gear=… where the robot has none"),
            Self::MotorTorques => map("state the side: ", "tau=… motor").say(", with gear=… where the robot has none"),
            Self::EffortUnit { factor } if *factor == 1e-3 => {
                map("state the unit: ", "current=… mA").say(" or ").assign(Setting::Map, "tau=… mNm")
            }
            Self::EffortUnit { .. } => map("state what they are: ", "current=… % rated=…")
                .say(" (A), or ")
                .assign(Setting::Map, "tau=… % rated=…")
                .say(" (N·m)"),
            Self::EffortsReversed { .. } => map("reverse all of them: ", "tau=… sign=-").say(" (or current)"),
            Self::EffortsSmall { .. } => map("state what they are: ", "current=… constant=… gear=…")
                .say(" for currents, or ")
                .assign(Setting::Map, "tau=… motor gear=…")
                .say(" for torques at the motors"),
            Self::Gravity { direction: [x, y, z] } => {
                format!("turn gravity_m_s2 in the robot file along [{x}, {y}, {z}], or the base as it is mounted")
                    .into()
            }
            Self::PositionSign { joint } => {
                map("turn the sign of its position: ", "q=… sign=…").say(format!(", − at joint {joint}"))
            }
            Self::EffortSign { joint } => {
                map("turn the sign of its effort: ", "tau=… sign=…").say(format!(" (or current), − at joint {joint}"))
            }
            Self::EitherSign { joint } => {
                map("turn the sign of its position or of its effort: ", "… sign=…").say(format!(", − at joint {joint}"))
            }
            Self::PositionsSwapped { joints: [a, b] } => format!("exchange the columns of q{a} and q{b}").into(),
            Self::EffortsSwapped { joints: [a, b] } => {
                format!("exchange the columns of the efforts of joints {a} and {b}").into()
            }
            Self::JointsSwapped { joints: [a, b] } => format!("exchange the columns of joints {a} and {b}").into(),
            Self::PositionScale { joint, factor } => {
                format!("check the gear ratio of joint {joint}: its positions times {factor:.4}").into()
            }
            Self::EffortScale { joint, factor } => {
                format!("check gear ratio and torque constant of joint {joint}: its efforts times {factor:.4}").into()
            }
            Self::ZeroOffset { joint, degrees } => {
                map("add the offset of its zero: ", "q=… offset_deg=…").say(format!(", {degrees} at joint {joint}"))
            }
            Self::NoEffort { joint } => {
                format!("check the column that is mapped to the effort of joint {joint}").into()
            }
            Self::AtRest { joint } => {
                format!("the parameters that only the motion of joint {joint} excites are left out of this fit").into()
            }
        }
    }
}

/// What shows that they are.
fn reversed(slope: Option<f64>) -> String {
    match slope {
        Some(slope) => format!("the measured torque is about {slope:.2} times that of the robot file"),
        None => "friction would be negative at nearly every joint".to_owned(),
    }
}
