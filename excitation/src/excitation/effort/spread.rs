//! How far the true parameters may be from the nominal ones.

use crate::model::format::RelativeUncertainty;
use crate::model::term::PriorOf;
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};

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
    pub fn multiple_for(confidence: f64) -> f64 {
        crate::statistics::normal_quantile(confidence)
    }

    /// The spread by the shares that a `nominal.toml` states: of the mass, of the length of the first moment, of the trace of
    /// the inertia for each of its elements, of rotor inertia and friction; the offset's is absolute.
    pub fn new(robot: &Robot, nominal: &StandardParameters, shares: &RelativeUncertainty, multiple: f64) -> Self {
        use ParameterKind as Kind;
        let deviation = |id: ParameterId| {
            let (value, link) = (nominal.get(id).abs(), &nominal.links[id.index]);
            match id.kind {
                Kind::M => shares.mass * value,
                Kind::Mcx | Kind::Mcy | Kind::Mcz => shares.first_moment * link.first_moment.norm(),
                Kind::Ixx | Kind::Ixy | Kind::Ixz | Kind::Iyy | Kind::Iyz | Kind::Izz => {
                    shares.inertia * link.rotational.trace()
                }
                Kind::Term(term) => match term.entry().prior.of {
                    PriorOf::Value => shares.of_term(term) * value,
                    PriorOf::Unit => shares.of_term(term),
                },
            }
        };
        let ids = Columns::default().with_terms_of(nominal).parameters(robot);
        let deviations = ids.into_iter().map(deviation).collect();
        Self { deviations, multiple }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::planar_2r;
    use crate::model::term::{OFFSET, VISCOUS};
    use crate::spatial::Inertia;

    #[test]
    fn analytic_deviations_are_shares_of_the_length_of_the_first_moment_and_of_the_trace() {
        let robot = planar_2r();
        let mut nominal = StandardParameters::zero(2);
        // (3, −4, 12) kg·m has the length 13, and the trace is 5 + 6 + 7.
        nominal.links[0] = Inertia::from_array(&[20.0, 3.0, -4.0, 12.0, 5.0, 0.1, -0.2, 6.0, 0.3, 7.0]);
        nominal.drives[1][VISCOUS] = 8.0;
        nominal.drives[1][OFFSET] = 8.0;
        let terms = [("viscous", 0.25), ("offset_nm", 0.5)].map(|(key, share)| (key.to_owned(), share));
        let shares = RelativeUncertainty { mass: 0.1, first_moment: 0.2, inertia: 0.5, terms: terms.into() };
        let spread = ParameterSpread::new(&robot, &nominal, &shares, 2.0);
        let [link, other] = [&spread.deviations[..10], &spread.deviations[10..20]];
        let expected = [2.0, 2.6, 2.6, 2.6, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0];
        for (found, expected) in link.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{link:?}");
        }
        assert!(other.iter().all(|&deviation| deviation == 0.0));
        // Friction counts as a share of its value, an offset as an amount.
        let columns = Columns::default().with_terms_of(&nominal).parameters(&robot);
        let of = |term| columns.iter().position(|id| id.index == 1 && id.kind == ParameterKind::Term(term)).unwrap();
        assert_eq!(spread.deviations[of(VISCOUS)], 2.0);
        assert_eq!(spread.deviations[of(OFFSET)], 0.5);
    }

    #[test]
    fn published_one_sided_quantile() {
        // Abramowitz and Stegun, table 26.5.
        assert!((ParameterSpread::multiple_for(0.95) - CONFIDENCE_95).abs() < 1e-9);
    }
}
