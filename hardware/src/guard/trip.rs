//! Every reason for which a guard trips: in which mode it exists, what is done, and how soon.

use armid::experiment::SafeAction;

use super::{GuardSettings, Mode};

/// Every trip, listed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trip {
    /// A position or an effort is no number.
    NotFinite,
    /// A position moved further between two samples than the joint can.
    PositionJump,
    /// A position, or a set-point, is outside the soft limits.
    SoftLimit,
    /// The arm is too far from its command.
    FollowingError,
    /// The motor current stays above the clamp.
    CurrentClamp,
    /// The command moves and the arm does not.
    UnexpectedStop,
    /// No state has come for too long, or one was too long on its way.
    StaleState,
    /// A set-point is sent too late.
    CommandAge,
    /// A set-point is further from the one before than the joint can move.
    CommandStep,
    /// The robot's own computer ended the motion: emergency stop, abort, drives off.
    RobotStopped,
    /// The link failed: messages that make no sense, or a network that is gone.
    Link,
}

/// Time that a guard has from the sample or the silence that shows a fault to the safe action, ms.
///
/// A waiting arm looks at its guard at least every 5 ms; what follows is a comparison and one message.
pub const REACTION_MS: f64 = 10.0;

impl Trip {
    /// All, in the order in which a sample is judged: the first that finds something wins.
    pub const ALL: [Self; 11] = [
        Self::NotFinite,
        Self::PositionJump,
        Self::SoftLimit,
        Self::FollowingError,
        Self::CurrentClamp,
        Self::UnexpectedStop,
        Self::StaleState,
        Self::CommandAge,
        Self::CommandStep,
        Self::RobotStopped,
        Self::Link,
    ];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotFinite => "not-finite",
            Self::PositionJump => "position-jump",
            Self::SoftLimit => "soft-limit",
            Self::FollowingError => "following-error",
            Self::CurrentClamp => "current-clamp",
            Self::UnexpectedStop => "unexpected-stop",
            Self::StaleState => "stale-state",
            Self::CommandAge => "command-age",
            Self::CommandStep => "command-step",
            Self::RobotStopped => "robot-stopped",
            Self::Link => "link",
        }
    }

    /// The trip with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|trip| trip.name() == name)
    }

    /// What it watches, in a few words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::NotFinite => "a position or an effort is no number",
            Self::PositionJump => "a position moved further between two samples than the joint can",
            Self::SoftLimit => "a position or a set-point is outside the soft limits",
            Self::FollowingError => "the arm is too far from its command",
            Self::CurrentClamp => "the motor current stays above the clamp",
            Self::UnexpectedStop => "the command moves and the arm does not",
            Self::StaleState => "no state has come for too long, or one was too long on its way",
            Self::CommandAge => "a set-point is sent too late",
            Self::CommandStep => "a set-point is further from the one before than the joint can move",
            Self::RobotStopped => "the robot's computer ended the motion: emergency stop, abort, drives off",
            Self::Link => "the link failed: messages that make no sense, or a network that is gone",
        }
    }

    /// Whether the guard has this trip in a mode. Set-points exist only where they are streamed.
    #[must_use]
    pub const fn exists_in(self, mode: Mode) -> bool {
        match self {
            Self::CommandAge | Self::CommandStep => matches!(mode, Mode::Stream),
            _ => true,
        }
    }

    /// Whether the simulated robot computer, and any good real one, has it too, without anybody on the other side.
    #[must_use]
    pub const fn in_robot_computer(self) -> bool {
        matches!(self, Self::SoftLimit | Self::CurrentClamp | Self::CommandAge | Self::RobotStopped)
    }

    /// What is done at once. Measured positions that cannot be trusted cannot be held: the drives go off.
    #[must_use]
    pub const fn action(self, mode: Mode) -> SafeAction {
        match (self, mode) {
            (Self::NotFinite | Self::PositionJump | Self::CurrentClamp, _) => SafeAction::Disable,
            (_, Mode::Trajectory) => SafeAction::Cancel,
            (_, Mode::Stream) => SafeAction::Hold,
        }
    }

    /// Time from the first sign of the fault to the safe action at most, ms, where states come at `rate_hz`.
    ///
    /// ```text
    /// bound = window of the check + one sample + reaction
    /// ```
    #[must_use]
    pub fn bound_ms(self, settings: &GuardSettings, rate_hz: f64) -> f64 {
        let sample_ms = 1e3 / rate_hz;
        match self {
            Self::NotFinite | Self::PositionJump | Self::SoftLimit | Self::FollowingError => sample_ms + REACTION_MS,
            Self::CurrentClamp => settings.current_window_ms + sample_ms + REACTION_MS,
            Self::UnexpectedStop => settings.stop_window_ms + sample_ms + REACTION_MS,
            Self::StaleState => settings.stale_ms + sample_ms + REACTION_MS,
            Self::CommandAge => settings.command_age_ms + REACTION_MS,
            Self::CommandStep | Self::RobotStopped | Self::Link => REACTION_MS,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_bounds_are_positive() {
        for trip in Trip::ALL {
            assert_eq!(Trip::parse(trip.name()), Some(trip));
            assert!(trip.bound_ms(&GuardSettings::default(), 500.0) >= REACTION_MS);
            assert!(Mode::ALL.into_iter().any(|mode| trip.exists_in(mode)));
        }
    }
}
