//! What an estimator promises.

/// A law that an estimator obeys unless it declares an exception; `conformance::estimator_laws` checks it. `NOTATION.md` has
/// the table of laws and estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EstimatorLaw {
    /// From exact equations it returns the true base parameters.
    Recovery,
    /// Torque in a unit `s` times smaller gives parameters and standard deviations `s` times larger.
    TorqueUnits,
    /// A column of the regressor `d` times larger gives a parameter and a standard deviation `d` times smaller.
    ParameterUnits,
    /// Fewer equations than parameters are refused.
    TooFewEquations,
    /// Equal input gives equal bits.
    Determinism,
    /// The estimate names every base parameter, every number of it is finite, its covariance is symmetric with the stated
    /// standard deviations, each interval holds its value, and its termination is a successful one.
    Report,
    /// A residual far above the stated noise is reported as a finding.
    Misfit,
    /// 95 % intervals cover the truth about as often as they say, for white Gaussian noise of the stated covariance.
    Coverage,
}

crate::input::named! { EstimatorLaw as sentence {
    Recovery: "exact equations give the true parameters",
    TorqueUnits: "the unit of torque scales parameters and standard deviations",
    ParameterUnits: "the unit of a parameter scales its value and standard deviation",
    TooFewEquations: "fewer equations than parameters are refused", Determinism: "equal input gives equal bits",
    Report: "the estimate is complete and consistent in itself", Misfit: "a residual far above the noise is reported",
    Coverage: "95 % intervals cover the truth in about 95 % of cases"
} }

/// A law that an estimator does not obey, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawException {
    /// The law.
    pub law: EstimatorLaw,
    /// Why the estimator cannot or does not want to obey it.
    pub reason: &'static str,
}

impl LawException {
    const PARAMETER_UNITS: Self = Self {
        law: EstimatorLaw::ParameterUnits,
        reason: "it simulates the robot, whose parameters are in SI units: equations alone are refused",
    };

    /// Of estimators that compare measured torque with what a simulation gives.
    pub(super) const OF_SIMULATION: &'static [Self] = &[
        Self {
            law: EstimatorLaw::TorqueUnits,
            reason: "robot and servo state torque in N·m: torque in another unit is that of an arm which they do not describe",
        },
        Self::PARAMETER_UNITS,
    ];

    /// Of estimators that compare positions.
    pub(super) const OF_POSITIONS: &'static [Self] = &[
        Self {
            law: EstimatorLaw::TorqueUnits,
            reason: "it reads positions and no torque: its parameters are those by which the robot's servo moves",
        },
        Self::PARAMETER_UNITS,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::{Estimator, EstimatorKind};

    #[test]
    fn the_table_of_the_notation_shows_the_declared_exceptions() {
        let text = include_str!("../../../NOTATION.md");
        let rows = text.lines().map(|line| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<&str>>());
        // Estimators, a cell for each law, the reason.
        let rows: Vec<Vec<&str>> = rows.filter(|cells| cells.len() == EstimatorLaw::ALL.len() + 2).collect();
        for kind in EstimatorKind::ALL {
            let name = format!("`{}`", kind.name());
            let found = rows.iter().find(|cells| cells[0].split(", ").any(|cell| cell == name));
            let cells = found.unwrap_or_else(|| panic!("no row for {name}"));
            for (law, cell) in EstimatorLaw::ALL.iter().zip(&cells[1..]) {
                let excepted = kind.exceptions().iter().any(|exception| exception.law == *law);
                assert_eq!(*cell, if excepted { "no" } else { "yes" }, "{name}: {law:?}");
            }
        }
    }
}
