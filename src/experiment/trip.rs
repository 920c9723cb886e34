//! What a guard does when something is wrong: it trips, takes a safe action, and says why.

/// What an arm does at once when its guard trips. None of them needs the motion to go on as planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SafeAction {
    /// Streamed set-points end with the one sent last: the servo keeps holding it.
    Hold,
    /// A motion that was handed over is cancelled: the robot's computer brings the arm to rest and holds it.
    Cancel,
    /// The drives lose power and the brakes close: where the measured positions cannot be trusted.
    Disable,
}

impl SafeAction {
    /// All, from the mildest to the hardest.
    pub const ALL: [Self; 3] = [Self::Hold, Self::Cancel, Self::Disable];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Cancel => "cancel",
            Self::Disable => "disable",
        }
    }

    /// The action with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|action| action.name() == name)
    }
}

/// Why an experiment was ended before anything worse happened.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct TripReport {
    /// Name of the check that tripped.
    pub trip: &'static str,
    /// What was done at once.
    pub action: SafeAction,
    /// Time from the first sign of the fault to the action, at most, ms.
    pub bound_ms: f64,
    /// What was found and what was expected, with joint and unit.
    pub reason: String,
}

impl std::fmt::Display for TripReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}; {} within {} ms", self.trip, self.reason, self.action.name(), self.bound_ms)
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
