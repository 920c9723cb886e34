//! What made torques of the efforts of a log.

/// What the efforts of each joint were multiplied with, so that they are torques.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortScale {
    /// Torque constants of the robot file, N·m/A.
    RobotConstant,
    /// Torque constants of the mapping, N·m/A.
    MappedConstant,
    /// Stiffness of position servos, N·m/rad, by which commands became torques.
    ServoStiffness,
}

impl EffortScale {
    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::RobotConstant | Self::MappedConstant => "N·m/A",
            Self::ServoStiffness => "N·m/rad",
        }
    }

    /// Keys of an answer: of a value that was found, and of the one that was stated.
    pub const fn answer_keys(self) -> [&'static str; 2] {
        match self {
            Self::RobotConstant | Self::MappedConstant => ["torque_constant_nm_a", "stated_nm_a"],
            Self::ServoStiffness => ["kp_nm_rad", "stated_nm_rad"],
        }
    }

    /// Its key in a robot file or a mapping.
    pub const fn key(self) -> &'static str {
        match self {
            Self::RobotConstant => "torque_constant_nm_a",
            Self::MappedConstant => "constant",
            Self::ServoStiffness => "kp",
        }
    }
}
