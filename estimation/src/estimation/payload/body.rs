//! The possible body that agrees best with the combinations of a load that a motion shows.
//!
//! ```text
//! min_θ  ½ χ²(θ) + w D(θ)        χ² = (K θ − β̂)ᵀ C⁻¹ (K θ − β̂)        w = 0.01
//! ```
//! D is the log-det divergence of [`fit_body`] from a ball of the estimated mass, where its centre is estimated to be. The weight is so small
//! that it decides what the motion does not show, and keeps the body off the edge of what bodies can be.

use nalgebra::{DMatrix, DVector};

use super::change::Fitted;
use crate::base::{BaseReduction, LOAD_UNITS};
use crate::estimation::consistent_set::definite_inverse;
use crate::estimation::error::EstimationError;
use crate::estimation::model_fit::fit_body;
use crate::estimation::termination::Termination;
use crate::model::ParameterKind;
use crate::spatial::Inertia;
use crate::statistics::chi_squared_quantile;

/// Radius of gyration of a load of which nothing is known, m.
const GYRATION: f64 = 0.05;

/// Part of its natural size to which a parameter is known at best: a log without noise is no exact one.
const EXACT: f64 = 1e-5;

/// Probability of the joint region of all combinations.
const CONFIDENCE: f64 = 0.95;

/// A body that can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadBody {
    /// The body, in the frame of the last link.
    pub inertia: Inertia,
    /// Its squared distance from the free estimate, in standard deviations.
    pub chi_squared: f64,
    /// What that of the true load exceeds with a probability of 5 %.
    pub chi_squared_limit: f64,
    /// How the search ended.
    pub termination: Termination,
}

impl PayloadBody {
    /// The body that agrees best with the combinations of a load.
    pub(super) fn of(load: &BaseReduction, fitted: &Fitted) -> Result<Self, EstimationError> {
        let guess = guess(load, fitted);
        let least = |j: usize| (EXACT * guess.mass * LOAD_UNITS[load.kept[j]]).powi(2);
        let rank = load.rank();
        let covariance =
            DMatrix::from_fn(rank, rank, |i, j| fitted.covariance[(i, j)] + if i == j { least(i) } else { 0.0 });
        let information = definite_inverse(&covariance).ok_or(EstimationError::NotDefinite)?;
        let (inertia, termination) = fit_body(&load.k, &fitted.values, &information, &guess)?;
        let off = load.beta(&DVector::from_column_slice(&inertia.to_array())) - &fitted.values;
        Ok(Self {
            inertia,
            chi_squared: off.dot(&(information * &off)),
            chi_squared_limit: chi_squared_quantile(CONFIDENCE, rank as f64),
            termination,
        })
    }

    /// Whether the body lies in the joint 95 % region of the free estimate.
    #[must_use]
    pub fn is_within(&self) -> bool {
        self.chi_squared <= self.chi_squared_limit
    }
}

/// A ball of the estimated mass where it is estimated to be.
fn guess(load: &BaseReduction, fitted: &Fitted) -> Inertia {
    let of = |kind: ParameterKind| {
        let row = load.kept.iter().position(|&column| load.parameters[column].kind == kind)?;
        Some((fitted.values[row], fitted.covariance[(row, row)].sqrt()))
    };
    let mass = of(ParameterKind::M).map_or(1.0, |(mass, std)| mass.max(std).max(1e-3));
    let far = |kind: ParameterKind| of(kind).map_or(0.0, |(moment, _)| (moment / mass).clamp(-0.5, 0.5));
    let centre = [ParameterKind::Mcx, ParameterKind::Mcy, ParameterKind::Mcz].map(far);
    Inertia::with_gyration(mass, centre, GYRATION)
}
