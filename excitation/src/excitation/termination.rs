//! How an optimisation ended, and how its value developed.

use super::limit_kind::LimitKind;
use super::limits::WorstUse;

/// How an optimisation ended.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case", tag = "reason")]
pub enum Termination {
    /// The last descent ended where the quadratic model promises no further gain, with too little of the budget left for another one.
    Converged,
    /// No step along the last direction improved on its start.
    Stalled,
    /// All evaluations were used, and the last descent would have gone on.
    EvaluationBudget,
    /// All iterations were used.
    IterationBudget,
    /// An observer ended the search.
    Interrupted,
    /// No trajectory inside the limits was found.
    Infeasible {
        /// Which kind of limit.
        limit: LimitKind,
        /// Name of the joint.
        joint: String,
        /// The worst case of the last iterate.
        worst: WorstUse,
    },
    /// No iterate showed all chosen parameters: the criterion has no finite value.
    Singular,
    /// Random draws have no end of their own: all of the budget was drawn.
    Drawn,
}

impl Termination {
    /// Whether the trajectory holds all limits and shows all chosen parameters.
    pub const fn is_feasible(&self) -> bool {
        !matches!(self, Self::Infeasible { .. } | Self::Singular)
    }

    /// Whether the optimiser ended by itself, not by its budget.
    pub const fn is_converged(&self) -> bool {
        matches!(self, Self::Converged | Self::Stalled)
    }

    /// One word for it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::EvaluationBudget => "evaluation-budget",
            Self::IterationBudget => "iteration-budget",
            Self::Interrupted => "interrupted",
            Self::Infeasible { .. } => "infeasible",
            Self::Singular => "singular",
            Self::Drawn => "drawn",
        }
    }
}

/// One point of the convergence figure.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HistoryPoint {
    /// Evaluations spent so far.
    pub evaluations: usize,
    /// The criterion of the best trajectory inside all limits so far, as it is reported: κ or ln det M, on the
    /// optimiser's samples; that of the current iterate as long as none was inside. Limits hold within the tolerances of a search here:
    /// the value of the design is that of its motion when it is exactly inside.
    #[serde(deserialize_with = "crate::plain::infinite::undecided")]
    pub value: f64,
    /// The criterion of the current iterate.
    #[serde(deserialize_with = "crate::plain::infinite::undecided")]
    pub current: f64,
    /// Excess of the current iterate over the permitted torques and currents, relative, and over the clearances, in
    /// tenths of a metre, summed; the other limits hold, within a ten-thousandth of them.
    pub excess: f64,
}
