//! How friction of the load depends on the parameters.
//!
//! ```text
//! f(β) = W β + Σ_j Fl_j d_j |τ_j| tanh(q̇_j/v_s)        τ_j the torque of links and gravity at joint or motor j, by β itself
//! J = ∂f/∂β:  (1 + S) W on the links' columns, W on all others        S = ∂(friction)/∂τ_l        J β − f(β) = S τ_l
//! ```
//! A rotor inertia that torque shows only in a sum with a link's counts as the link's.
//!
//! Source of the law: [`LoadFriction`](crate::model::term::LoadFriction).

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use crate::base::BaseReduction;
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// A regressor of any columns that can be estimated, the torque of the links being zero until it is known.
///
/// # Errors
/// [`EstimationError::Columns`] where a term depends on what no recording has.
pub(super) fn regressor_of(robot: &Robot, columns: Columns) -> Result<JointTorqueRegressor, EstimationError> {
    columns.check_estimable()?;
    Ok(JointTorqueRegressor::with_load(robot, columns, &StandardParameters::zero(robot.dof())))
}

/// φ whose base parameters are β: their representatives have their values, all others are zero.
pub(super) fn standard(base: &BaseReduction, beta: &DVector<f64>) -> Vec<f64> {
    let mut phi = vec![0.0; base.parameters.len()];
    for (&column, &value) in base.kept.iter().zip(beta.iter()) {
        phi[column] = value;
    }
    phi
}

/// J at β, means over blocks, (n·M) × b; adds `S τ_l` to the torque `y` (n·M).
pub(super) fn linearised(
    regressor: &JointTorqueRegressor,
    base: &BaseReduction,
    samples: &Samples,
    beta: &DVector<f64>,
    y: &mut DVector<f64>,
) -> DMatrix<f64> {
    let (n, p, phi) = (regressor.rows(), regressor.cols(), standard(base, beta));
    let (links, terms) = phi.split_at(10 * n);
    let (regressor, states, share) = (regressor.with_links(links), &samples.states, 1.0 / samples.block as f64);
    let (mut w, mut rows) = (DMatrix::zeros(y.len(), base.rank()), vec![0.0; n * p]);
    for block in 0..samples.blocks() {
        for k in block * samples.block..(block + 1) * samples.block {
            let moved = regressor.evaluate_slopes(terms, [states.q(k), states.qd(k), states.qdd(k)], &mut rows);
            for (i, (row, moved)) in rows.chunks_exact(p).zip(moved).enumerate() {
                y[block * n + i] += share * moved;
                for (c, &column) in base.kept.iter().enumerate() {
                    w[(block * n + i, c)] += share * row[column];
                }
            }
        }
    }
    w
}
