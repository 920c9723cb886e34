//! The Cramér–Rao bound: the least standard deviation that any unbiased estimator can have from the experiment.
//!
//! ```text
//! cov β̂ ⪰ ( P Σ_k Y_b(k)ᵀ Σ⁻¹ Y_b(k) )⁻¹       k over every raw sample of one period, P recorded periods
//! Σ = T diag(σ_i² + Δ_i²/12) Tᵀ               T torque per ampere, σ_i current noise, Δ_i the converter's step
//! ```
//! at the noise-free motion of the closed loop, with the true Σ: `radkhah2007` eq. 5 with nothing estimated. Positions
//! are taken as exact, as there.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::base::BaseReduction;
use crate::dynamics::States;
use crate::model::{EffortInterface, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::signal::torque_map;

/// Covariance of the joint torques in one raw sample, from the noise of the robot's sensors, (N·m)², n × n.
pub fn torque_covariance(robot: &Robot) -> DMatrix<f64> {
    let variance = DVector::from_iterator(
        robot.dof(),
        robot.joints().iter().map(|joint| {
            let drive = &joint.drive;
            drive.current_noise * drive.current_noise + drive.adc_step() * drive.adc_step() / 12.0
        }),
    );
    let per_ampere = torque_map(robot, EffortInterface::Current);
    &per_ampere * DMatrix::from_diagonal(&variance) * per_ampere.transpose()
}

/// Cramér–Rao standard deviations of the base parameters (b), from the exact states of one period of which each
/// stands for `weight` raw samples, over `periods` periods; `None` where the motion does not excite all of them.
pub fn cramer_rao_std(
    regressor: &JointTorqueRegressor,
    base: &BaseReduction,
    exact: &States,
    covariance: &DMatrix<f64>,
    weight: f64,
    periods: usize,
) -> Option<Vec<f64>> {
    let n = exact.dof;
    let whiten = Cholesky::new(covariance.clone())?.l();
    let mut w = base.select_columns(&regressor.stack(exact));
    for k in 0..exact.len() {
        let mut block = w.rows_mut(k * n, n);
        let white = whiten.solve_lower_triangular(&block)?;
        block.copy_from(&white);
    }
    // Columns of unlike size: scale them before the inverse, and the result back.
    let scale: Vec<f64> = w.column_iter().map(|column| column.norm()).collect();
    if scale.contains(&0.0) {
        return None;
    }
    for (mut column, norm) in w.column_iter_mut().zip(&scale) {
        column /= *norm;
    }
    let inverse = Cholesky::new(w.tr_mul(&w))?.inverse();
    let raw = weight * periods as f64;
    Some(scale.iter().enumerate().map(|(i, norm)| (inverse[(i, i)] / raw).sqrt() / norm).collect())
}
