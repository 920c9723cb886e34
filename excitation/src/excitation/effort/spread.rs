//! How far the true parameters may be from the nominal ones.

use crate::model::format::RelativeUncertainty;
use crate::model::term::PriorOf;
use crate::model::{Columns, ParameterKind, Robot, StandardParameters};

/// Standard deviations that one side of a normal distribution keeps within in 95 % of cases.
pub const CONFIDENCE_95: f64 = 1.644_853_626_951_472_2;

/// Independent normal uncertainty of every parameter, and how many standard deviations a limit must leave.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSpread {
    /// Standard deviation of each parameter of the nominal model's columns (p), in its own unit.
    pub deviations: Vec<f64>,
    /// Standard deviations k that a limit must leave.
    pub multiple: f64,
}

impl ParameterSpread {
    /// How many standard deviations a limit must leave so that one side of a normal distribution keeps within it with
    /// this probability (at least one half): its quantile.
    #[must_use]
    pub fn multiple_of(confidence: f64) -> f64 {
        crate::statistics::normal_quantile(confidence)
    }

    /// From the shares that a `nominal.toml` states: of the mass, of the length of the first moment, of the trace of
    /// the inertia for each of its elements, of rotor inertia and friction; the offset's is absolute.
    #[must_use]
    pub fn of(robot: &Robot, nominal: &StandardParameters, shares: &RelativeUncertainty, multiple: f64) -> Self {
        use ParameterKind as Kind;
        let deviations = Columns::default()
            .and_those_of(nominal)
            .parameters(robot)
            .into_iter()
            .map(|id| {
                let value = nominal.get(id).abs();
                match id.kind {
                    Kind::M => shares.mass * value,
                    Kind::Mcx | Kind::Mcy | Kind::Mcz => {
                        let ten = nominal.links[id.index].to_array();
                        let length = (ten[1] * ten[1] + ten[2] * ten[2] + ten[3] * ten[3]).sqrt();
                        shares.first_moment * length
                    }
                    Kind::Ixx | Kind::Ixy | Kind::Ixz | Kind::Iyy | Kind::Iyz | Kind::Izz => {
                        let ten = nominal.links[id.index].to_array();
                        shares.inertia * (ten[4] + ten[7] + ten[9])
                    }
                    Kind::Term(term) => match term.entry().prior.of {
                        PriorOf::Value => shares.of(term) * value,
                        PriorOf::Unit => shares.of(term),
                    },
                }
            })
            .collect();
        Self { deviations, multiple }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_one_sided_quantile() {
        // Abramowitz and Stegun, table 26.5.
        assert!((ParameterSpread::multiple_of(0.95) - CONFIDENCE_95).abs() < 1e-9);
    }
}
