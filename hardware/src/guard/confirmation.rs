//! The operator's confirmation that the arm may move.

/// What the operator confirms: the emergency stop works and is in reach, the arm is homed, and nobody is within its reach.
///
/// There is no other way to get one than to type the robot's name, or to say so on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Confirmation {
    how: &'static str,
}

impl Confirmation {
    /// What a person is asked.
    pub fn question(robot: &str) -> String {
        format!(
            "This moves \"{robot}\". The emergency stop works and is in reach, the arm is homed, nobody is within its\n\
             reach, and nothing stands between it and its start pose. Type the robot's name to go on: "
        )
    }

    /// The confirmation by typing the robot's name.
    pub fn typed(robot: &str, answer: &str) -> Option<Self> {
        (answer.trim() == robot).then_some(Self { how: "confirmed by typing the robot's name" })
    }

    /// The confirmation by the option `--yes-the-estop-works`.
    pub const fn on_the_command_line() -> Self {
        Self { how: "confirmed on the command line" }
    }

    /// How it was given.
    pub const fn how(&self) -> &'static str {
        self.how
    }
}
