//! One claim and what was found.

use crate::statistics::Interval;

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds.
    Holds,
    /// It holds in part, or under a condition that the finding states.
    HoldsInPart,
    /// It does not hold.
    DoesNotHold,
    /// The numbers do not decide.
    Undecided,
}

crate::input::named! { Verdict as words {
    Holds: "holds", HoldsInPart: "holds in part", DoesNotHold: "does not hold", Undecided: "undecided"
} }

/// A number behind a verdict.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Quantity {
    /// What was measured, with its unit.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its 95 % interval, where it is a statistic.
    pub interval: Option<Interval>,
    /// Number of runs, designs or samples behind it.
    pub samples: usize,
}

impl Quantity {
    /// A number without an interval.
    pub fn new(name: impl Into<String>, value: f64, samples: usize) -> Self {
        Self { name: name.into(), value, interval: None, samples }
    }

    /// Adds its interval.
    #[must_use]
    pub const fn with_interval(mut self, interval: Option<Interval>) -> Self {
        self.interval = interval;
        self
    }
}

/// A claim of `radkhah2007` and what armid finds.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Claim {
    /// The claim, in our words, with the place in `radkhah2007`.
    pub claim: String,
    /// What the numbers say.
    pub verdict: Verdict,
    /// How the verdict follows from them.
    pub rule: String,
    /// The numbers.
    pub quantities: Vec<Quantity>,
}

impl Claim {
    pub(super) fn new(claim: &str, verdict: Verdict, rule: impl Into<String>, quantities: Vec<Quantity>) -> Self {
        Self { claim: claim.to_owned(), verdict, rule: rule.into(), quantities }
    }
}
