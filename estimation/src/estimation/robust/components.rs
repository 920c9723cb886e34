//! Directions in which single equations move a fit, to sort good equations from bad without random subsets.
//!
//! ```text
//! U = W R⁻¹ (orthonormal)    h_r = |u_r|²    M = Uᵀ D² U, D = diag(e_r/(1 − h_r))    z_k = U v_k for the eigenvectors v_k of M
//! ```
//! Column z_k says how far the fit at each equation follows when others are left out, one principal direction at a time. A
//! group of wrong equations that hide each other in the residual e stands at one end of some z_k. Each direction gives three
//! guesses at the good half: without its largest, its smallest, its largest absolute values. Random subsets of b equations,
//! the usual start, would all but never be free of wrong ones at the 58 parameters of an arm.
//!
//! Reference: D. Peña, V. Yohai, "A fast procedure for outlier diagnostics in large regression problems", Journal of the American
//! Statistical Association 94(446), 1999.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::linalg::{LeastSquares, transpose_product};

/// The part of a row that others explain is taken to leave at least this.
const LEAST_FREEDOM: f64 = 1e-6;

/// Guesses at the good half of the equations `rows`: those that each leaves out. `weights` are 1/s² of the rows' joints.
pub(super) fn doubtful_halves(
    observation: &Observation,
    rows: &[usize],
    weights: &[f64],
    fit: &LeastSquares,
) -> Result<Vec<Vec<usize>>, EstimationError> {
    let b = observation.regressor.ncols();
    // (WᵀPW)⁻¹ = F Fᵀ, so U = P½ W F has orthonormal columns.
    let inverse = fit.inverse_information();
    let scale: DVector<f64> = inverse.diagonal().map(f64::sqrt);
    let unit = DMatrix::from_fn(b, b, |i, j| inverse[(i, j)] / (scale[i] * scale[j]));
    let Some(factor) = unit.cholesky() else { return Err(EstimationError::NotDefinite) };
    let lower = factor.l();
    let factor = DMatrix::from_fn(b, b, |i, j| lower[(i, j)] * scale[i]);
    let picked = DMatrix::from_fn(rows.len(), b, |k, j| observation.regressor[(rows[k], j)] * weights[rows[k]].sqrt());
    let u = crate::linalg::product(&picked, &factor);
    let residual = observation.residual(fit.solution());
    let mut pulled = u.clone();
    for (k, &row) in rows.iter().enumerate() {
        let freedom = (1.0 - u.row(k).norm_squared()).max(LEAST_FREEDOM);
        let pull = residual[row] * weights[row].sqrt() / freedom;
        pulled.row_mut(k).scale_mut(pull);
    }
    let eigen = SymmetricEigen::new(transpose_product(&pulled, &pulled));
    let mut halves = Vec::new();
    for direction in eigen.eigenvectors.column_iter() {
        let z = &u * direction;
        for key in [|z: f64| z, |z: f64| -z, f64::abs] {
            let mut order: Vec<usize> = (0..rows.len()).collect();
            order.sort_by(|&a, &b| key(z[b]).total_cmp(&key(z[a])));
            halves.push(order[..rows.len() / 2].iter().map(|&k| rows[k]).collect());
        }
    }
    Ok(halves)
}
