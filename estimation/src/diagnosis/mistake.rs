//! Mistakes that logs are made with, and what to correct.

use std::fmt;

/// A mistake in a log or about the robot. Joints are counted from one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "mistake", rename_all = "kebab-case")]
pub enum Mistake {
    /// Positions are in degrees, and were read as radians.
    Degrees,
    /// Positions are in radians, and were read as degrees.
    Radians,
    /// Positions are those of the motors.
    MotorAngles,
    /// Positions are in another unit, or those of motors whose gears the robot file does not know: the true ones are `factor` times those in
    /// the log.
    PositionUnit {
        /// True position over that in the log.
        factor: f64,
    },
    /// Torques are those of the motors.
    MotorTorques,
    /// Efforts are in another unit: the true ones are `factor` times those in the log.
    EffortUnit {
        /// True effort over that in the log.
        factor: f64,
    },
    /// All efforts count the other way.
    EffortsReversed {
        /// Median over the joints of measured torque over that of the robot file; `None` where friction alone shows it.
        slope: Option<f64>,
    },
    /// All efforts are too small to be torques of the joints: currents, or torques of the motors.
    EffortsSmall {
        /// Least and largest torque of the robot file over measured effort.
        times: [f64; 2],
    },
    /// Gravity does not act along the axis that the robot file says.
    Gravity {
        /// Direction in the base frame that explains the torque.
        direction: [i8; 3],
    },
    /// The sign of a position is reversed.
    PositionSign {
        /// The joint.
        joint: usize,
    },
    /// The sign of an effort is reversed.
    EffortSign {
        /// The joint.
        joint: usize,
    },
    /// The sign of either the position or the effort of a joint is reversed; the data do not show which.
    EitherSign {
        /// The joint.
        joint: usize,
    },
    /// The positions of two joints are exchanged.
    PositionsSwapped {
        /// The joints.
        joints: [usize; 2],
    },
    /// The efforts of two joints are exchanged.
    EffortsSwapped {
        /// The joints.
        joints: [usize; 2],
    },
    /// Two joints are exchanged, positions and efforts.
    JointsSwapped {
        /// The joints.
        joints: [usize; 2],
    },
    /// A position is too large by a factor: a wrong gear ratio.
    PositionScale {
        /// The joint.
        joint: usize,
        /// True position over that in the log.
        factor: f64,
    },
    /// An effort is too large by a factor: a wrong gear ratio or torque constant.
    EffortScale {
        /// The joint.
        joint: usize,
        /// True effort over that in the log.
        factor: f64,
    },
    /// A joint's zero is another.
    ZeroOffset {
        /// The joint.
        joint: usize,
        /// What is to be added to its position, degrees.
        degrees: f64,
    },
    /// The effort of a joint that moves is one number throughout.
    NoEffort {
        /// The joint.
        joint: usize,
    },
    /// A joint stands still.
    AtRest {
        /// The joint.
        joint: usize,
    },
}

impl Mistake {
    /// Whether columns are exchanged.
    pub(super) const fn is_exchange(&self) -> bool {
        matches!(self, Self::PositionsSwapped { .. } | Self::EffortsSwapped { .. } | Self::JointsSwapped { .. })
    }

    /// What to try.
    #[must_use]
    pub fn correction(&self) -> String {
        match self {
            Self::Degrees => "state the unit: --map \"q=… deg\"".to_owned(),
            Self::Radians => "state the unit: --map \"q=… rad\"".to_owned(),
            Self::PositionUnit { factor } => {
                format!(
                    "state the side and the gears, about {:.0} on average: --map \"q=… motor gear=…\"; or the unit",
                    factor.recip()
                )
            }
            Self::MotorAngles => "state the side: --map \"q=… motor\", with gear=… where the robot has none".to_owned(),
            Self::MotorTorques => {
                "state the side: --map \"tau=… motor\", with gear=… where the robot has none".to_owned()
            }
            Self::EffortUnit { factor } if *factor == 1e-3 => {
                "state the unit: --map \"current=… mA\" or \"tau=… mNm\"".to_owned()
            }
            Self::EffortUnit { .. } => {
                "state what they are: --map \"current=… % rated=…\" (A), or \"tau=… % rated=…\" (N·m)".to_owned()
            }
            Self::EffortsReversed { .. } => "reverse all of them: --map \"tau=… sign=-\" (or current)".to_owned(),
            Self::EffortsSmall { .. } => {
                "state what they are: --map \"current=… constant=… gear=…\" for currents, or \"tau=… motor \
                                          gear=…\" for torques at the motors"
                    .to_owned()
            }
            Self::Gravity { direction: [x, y, z] } => {
                format!("turn gravity_m_s2 in the robot file along [{x}, {y}, {z}], or the base as it is mounted")
            }
            Self::PositionSign { joint } => {
                format!("turn the sign of its position: --map \"q=… sign=…\", − at joint {joint}")
            }
            Self::EffortSign { joint } => {
                format!("turn the sign of its effort: --map \"tau=… sign=…\" (or current), − at joint {joint}")
            }
            Self::EitherSign { joint } => {
                format!("turn the sign of its position or of its effort: --map \"… sign=…\", − at joint {joint}")
            }
            Self::PositionsSwapped { joints: [a, b] } => format!("exchange the columns of q{a} and q{b}"),
            Self::EffortsSwapped { joints: [a, b] } => {
                format!("exchange the columns of the efforts of joints {a} and {b}")
            }
            Self::JointsSwapped { joints: [a, b] } => format!("exchange the columns of joints {a} and {b}"),
            Self::PositionScale { joint, factor } => {
                format!("check the gear ratio of joint {joint}: its positions times {factor:.4}")
            }
            Self::EffortScale { joint, factor } => {
                format!("check gear ratio and torque constant of joint {joint}: its efforts times {factor:.4}")
            }
            Self::ZeroOffset { joint, degrees } => {
                format!("add the offset of its zero: --map \"q=… offset_deg=…\", {degrees} at joint {joint}")
            }
            Self::NoEffort { joint } => {
                format!("check the column that is mapped to the effort of joint {joint}")
            }
            Self::AtRest { joint } => {
                format!("the parameters that only the motion of joint {joint} excites are left out of this fit")
            }
        }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Degrees => write!(f, "the positions look like degrees, and are read as radians"),
            Self::Radians => write!(f, "the positions look like radians, and are read as degrees"),
            Self::PositionUnit { factor } => {
                write!(f, "the positions of all joints look {:.4} times too large", factor.recip())
            }
            Self::MotorAngles => {
                write!(f, "the positions look like those of the motors, and are read as those of the joints")
            }
            Self::MotorTorques => {
                write!(f, "the torques look like those of the motors, and are read as those of the joints")
            }
            Self::EffortUnit { factor } => {
                write!(f, "the efforts are beyond the limits of the joints; times {factor} they are not")
            }
            Self::EffortsReversed { slope: Some(slope) } => {
                write!(
                    f,
                    "all torques are reversed: the measured torque is about {slope:.2} times that of the robot file"
                )
            }
            Self::EffortsReversed { slope: None } => {
                write!(f, "all torques are reversed: friction would be negative at nearly every joint")
            }
            Self::EffortsSmall { times: [least, most] } => write!(
                f,
                "these look like currents, or torques at the motor: the robot file's torque is {least:.0} to {most:.0} times as large"
            ),
            Self::Gravity { direction: [x, y, z] } => {
                write!(f, "gravity seems to act along [{x}, {y}, {z}] of the base, not as in the robot file")
            }
            Self::PositionSign { joint } => write!(f, "the position of joint {joint} seems to count the other way"),
            Self::EffortSign { joint } => write!(f, "the effort of joint {joint} seems to count the other way"),
            Self::EitherSign { joint } => {
                write!(f, "position and effort of joint {joint} seem to count in opposite ways")
            }
            Self::PositionsSwapped { joints: [a, b] } => {
                write!(f, "the positions of joints {a} and {b} seem to be exchanged")
            }
            Self::EffortsSwapped { joints: [a, b] } => {
                write!(f, "the efforts of joints {a} and {b} seem to be exchanged")
            }
            Self::JointsSwapped { joints: [a, b] } => write!(f, "joints {a} and {b} seem to be exchanged"),
            Self::PositionScale { joint, factor } => {
                write!(f, "the positions of joint {joint} seem to be {:.4} times the true ones", factor.recip())
            }
            Self::EffortScale { joint, factor } => {
                write!(f, "the efforts of joint {joint} seem to be {:.4} times the true ones", factor.recip())
            }
            Self::ZeroOffset { joint, degrees } => {
                write!(f, "the zero of joint {joint} seems to be off by {degrees}°")
            }
            Self::NoEffort { joint } => {
                write!(f, "the effort of joint {joint} is one number throughout, although the joint moves")
            }
            Self::AtRest { joint } => write!(f, "joint {joint} is at rest"),
        }
    }
}
