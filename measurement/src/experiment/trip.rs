//! What a guard does when something is wrong: it trips, takes a safe action, and says why.

/// What an arm does at once when its guard trips. None of them needs the motion to go on as planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SafeAction {
    /// Streamed set-points end with the one sent last: the servo keeps holding it.
    Hold,
    /// A motion that was handed over is cancelled: the robot controller brings the arm to rest and holds it.
    Cancel,
    /// The drives lose power and the brakes close: where the measured positions cannot be trusted.
    Disable,
}

// From the mildest to the hardest.
crate::input::named! { SafeAction { Hold: "hold", Cancel: "cancel", Disable: "disable" } }

/// What is known of an arm that was asked to stop. A request that was sent, and even one that was accepted, is no rest:
/// only states that were taken afterwards show it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(tag = "outcome", rename_all = "kebab-case")]
pub enum Rest {
    /// It stands: seen in states taken after the request was answered.
    Confirmed {
        /// Time from the request to the last state of those that show it, ms.
        after_ms: f64,
    },
    /// The request was repeated for as long as the motion could have lasted, and the arm was not seen at rest.
    NotConfirmed {
        /// What was missing.
        reason: String,
    },
    /// Nothing is left that could move: a simulation or a replay ends with its last sample.
    Simulated,
}

impl Rest {
    /// Whether a person has to check the arm: it may still be moving.
    pub const fn is_unconfirmed(&self) -> bool {
        matches!(self, Self::NotConfirmed { .. })
    }
}

impl std::fmt::Display for Rest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Confirmed { after_ms } => write!(f, "at rest after {after_ms:.0} ms"),
            Self::NotConfirmed { reason } => write!(f, "NOT CONFIRMED: {reason}; the arm may still be moving"),
            Self::Simulated => write!(f, "the simulation ended"),
        }
    }
}

/// Why an experiment was ended before anything worse happened.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct TripReport {
    /// Name of the check that tripped.
    pub trip: &'static str,
    /// What was asked for at once.
    pub action: SafeAction,
    /// Time from the first sign of the fault to the request, at most, ms.
    pub bound_ms: f64,
    /// What came of it.
    pub rest: Rest,
    /// What was found and what was expected, with joint and unit.
    pub reason: String,
}

impl std::fmt::Display for TripReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { trip, action, bound_ms, reason, rest } = self;
        write!(f, "{trip}: {reason}; {} asked for within {bound_ms} ms, {rest}", action.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for action in SafeAction::ALL {
            assert_eq!(SafeAction::parse(action.name()), Some(action));
        }
        assert_eq!(SafeAction::parse("pray"), None);
    }
}
