//! Every reason for which a guard trips: in which modes, with which action, and how soon.

use armid::experiment::SafeAction;

use super::{GuardSettings, Mode};

/// Every trip, listed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trip {
    /// A position or an effort is not a number.
    NotFinite,
    /// A position moved further between two samples than the joint can.
    PositionJump,
    /// A position, or a set-point, is outside the soft limits.
    SoftLimit,
    /// A joint is faster than it may be.
    Overspeed,
    /// A point of the arm is faster than the limit for people beside the arm.
    ReducedSpeed,
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
    /// The robot controller ended the motion (emergency stop, abort, drives off), or its clock and ours ran apart.
    RobotStopped,
    /// Another client commands the arm, or a second robot answers to its names.
    Interference,
    /// The robot controller does not report whether it accepts a motion.
    NoAcceptance,
    /// The robot controller does not report how a motion has ended.
    NoResult,
    /// The link failed: invalid messages, or a network that is gone.
    Link,
    /// This program itself failed.
    Panic,
}

/// Time that a guard has from the sample or the silence that shows a fault to the safe action, ms.
///
/// A waiting arm looks at its guard at least every 5 ms; what follows is a comparison and one message.
pub const REACTION_MS: f64 = 10.0;
/// Time over which a joint's speed is measured, s.
pub(crate) const OVERSPEED_WINDOW_S: f64 = 0.02;
/// Time over which arrivals are measured by the local clock, whose arrivals are less even, s.
pub(crate) const ARRIVAL_WINDOW_S: f64 = 0.2;
/// Time between two looks at who else is on the network, and at the middleware's threads, ms.
pub const LOOK_MS: f64 = 100.0;
/// Time that the robot controller has to say whether it takes a motion, ms.
const ACCEPTANCE_MS: f64 = 500.0;
/// Time that it has, from the end of a motion, to say how it ended, ms.
const RESULT_MS: f64 = 3000.0;

// In the order in which a sample is judged: the first that finds something wins.
armid::input::named! { Trip {
    NotFinite: "not-finite", PositionJump: "position-jump", SoftLimit: "soft-limit", Overspeed: "overspeed",
    ReducedSpeed: "reduced-speed", FollowingError: "following-error", CurrentClamp: "current-clamp",
    UnexpectedStop: "unexpected-stop", StaleState: "stale-state", CommandAge: "command-age",
    CommandStep: "command-step", RobotStopped: "robot-stopped", Interference: "interference",
    NoAcceptance: "no-acceptance", NoResult: "no-result", Link: "link", Panic: "panic"
} }

impl Trip {
    /// What it watches, in a few words.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::NotFinite => "a position or an effort is not a number",
            Self::PositionJump => "a position moved further between two samples than the joint can",
            Self::SoftLimit => "a position or a set-point is outside the soft limits",
            Self::Overspeed => "a joint is faster than its limit allows",
            Self::ReducedSpeed => {
                "the flange, or a point that the robot file names, is faster than the reduced speed allows"
            }
            Self::FollowingError => "the arm is too far from its command",
            Self::CurrentClamp => "the motor current is above the clamp for long, or again and again",
            Self::UnexpectedStop => "the command moves and the arm does not",
            Self::StaleState => "no state has come for too long, or one was too long on its way",
            Self::CommandAge => "a set-point is sent too late",
            Self::CommandStep => "a set-point is further from the one before than the joint can move",
            Self::RobotStopped => {
                "the robot controller ended the motion (emergency stop, abort, drives off), or its clock and ours ran apart"
            }
            Self::Interference => "another client commands the arm, or a second robot answers to its names",
            Self::NoAcceptance => "the robot controller does not report whether it accepts a motion",
            Self::NoResult => "the robot controller does not report how a motion has ended",
            Self::Link => "the link failed: invalid messages, or middleware that has ended",
            Self::Panic => "armid itself failed",
        }
    }

    /// Whether the guard has this trip in a mode. Set-points exist only where they are streamed.
    pub const fn exists_in(self, mode: Mode) -> bool {
        match self {
            Self::CommandAge | Self::CommandStep => matches!(mode, Mode::Stream),
            Self::NoAcceptance | Self::NoResult => matches!(mode, Mode::Trajectory),
            _ => true,
        }
    }

    /// Whether the simulated robot controller, and any good real one, has it too, without a client.
    pub const fn in_robot_controller(self) -> bool {
        matches!(self, Self::SoftLimit | Self::CurrentClamp | Self::CommandAge | Self::RobotStopped)
    }

    /// What is asked for at once. Measured positions that cannot be trusted cannot be held: the drives go off.
    pub const fn action(self, mode: Mode) -> SafeAction {
        match self {
            Self::NotFinite | Self::PositionJump | Self::CurrentClamp => SafeAction::Disable,
            _ => Self::mildest(mode),
        }
    }

    /// What is asked for where nothing subscribes to `disable`: the end of the motion.
    pub const fn mildest(mode: Mode) -> SafeAction {
        match mode {
            Mode::Trajectory => SafeAction::Cancel,
            Mode::Stream => SafeAction::Hold,
        }
    }

    /// Time from the first sign of the fault to the request for the safe action at most, ms, where states come at `rate_hz`.
    ///
    /// ```text
    /// bound = window of the check + one sample + reaction
    /// ```
    pub fn bound_ms(self, settings: &GuardSettings, rate_hz: f64) -> f64 {
        let sample_ms = 1e3 / rate_hz;
        match self {
            Self::NotFinite | Self::PositionJump | Self::SoftLimit | Self::FollowingError => sample_ms + REACTION_MS,
            Self::Overspeed | Self::ReducedSpeed => 1e3 * OVERSPEED_WINDOW_S + sample_ms + REACTION_MS,
            Self::CurrentClamp => settings.current_window_ms + sample_ms + REACTION_MS,
            Self::UnexpectedStop => settings.stop_window_ms + sample_ms + REACTION_MS,
            Self::StaleState => settings.stale_ms + sample_ms + REACTION_MS,
            Self::CommandAge => settings.command_age_ms + REACTION_MS,
            Self::CommandStep | Self::RobotStopped | Self::Panic => REACTION_MS,
            Self::Interference | Self::Link => LOOK_MS + REACTION_MS,
            Self::NoAcceptance => ACCEPTANCE_MS + REACTION_MS,
            Self::NoResult => RESULT_MS + REACTION_MS,
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
