//! Estimates that no recording was made for.

use nalgebra::{DMatrix, DVector};

use crate::base::BaseReduction;
use crate::estimation::FactorisedBy;
use crate::estimation::estimate::{BaseEstimate, Estimate, IntervalBasis, rows_of};
use crate::estimation::termination::Termination;

/// An estimate with these base parameters and this covariance.
pub(in crate::estimation) fn estimate_of(
    base: &BaseReduction,
    beta: &DVector<f64>,
    covariance: &DMatrix<f64>,
) -> Estimate {
    let of = |(i, name): (usize, String)| {
        let std = covariance[(i, i)].sqrt();
        let ci95 = [beta[i] - 1.96 * std, beta[i] + 1.96 * std];
        BaseEstimate { name, value: beta[i], std, ci95, unit: String::new(), declared_std: 0.0 }
    };
    Estimate {
        estimator: "wls".to_owned(),
        robot: "crs-a460".to_owned(),
        columns: "rigid".to_owned(),
        shape: Vec::new(),
        base: base.names().into_iter().enumerate().map(of).collect(),
        covariance: rows_of(covariance),
        noise_covariance: Vec::new(),
        motor_errors: Vec::new(),
        servo: Vec::new(),
        standard: None,
        consistent: None,
        residual_rms: Vec::new(),
        noise_std: Vec::new(),
        units: Vec::new(),
        condition: 1.0,
        condition_scaled: 1.0,
        factorised_by: FactorisedBy::default(),
        interval_basis: IntervalBasis::Scatter,
        degrees_of_freedom: 100.0,
        samples: 1,
        periods: 1,
        effects: Vec::new(),
        findings: Vec::new(),
        termination: Termination::Direct,
        provenance: None,
    }
}
