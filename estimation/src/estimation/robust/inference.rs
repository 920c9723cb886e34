//! Error bars of an M-estimate.
//!
//! ```text
//! β̂ − β = A⁻¹ Σ_r w̃_r (m_i/s_i²) ε*_r        ε*_r = k_i s_i ψ(u_r)/m_i        m_i = mean of ψ'(u) over joint i
//! A = Σ_r (m_i/s_i²) w̃_rᵀ w̃_r        k_i = 1 + (b/E) var ψ'/m_i²
//! ```
//! To first order an M-estimate is least squares on the pseudo-residuals ε*, so its covariance is the sandwich of their
//! lag covariances: correlation between joints and in time is in it, and what the estimator holds back is held
//! back there too. w̃ = w for a loss whose influence only levels off. For one that falls again, w̃ = w √(ω/ω̄): an equation
//! that was given up is no information, however long its row. k is Huber's correction for the number of parameters.
//!
//! The scatter over periods, where there is one, says what residual noise alone explains, and is the basis of no interval:
//! outliers that scatter are in it. What the equations that are no outliers show beyond the scatter, of a torque that the model lacks,
//! is added as a discrepancy.
//!
//! References: P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2009, section 7.6 (eq. 7.81 is one joint and white
//! noise); M. Koller, W. A. Stahel, "Sharpening Wald-type inference in robust regression for small samples", Computational
//! Statistics & Data Analysis 55(8), 2011, for w̃.

use nalgebra::{DMatrix, DVector};

use super::iteration::{RobustFit, weighted_rows};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::finding::Finding;
use crate::estimation::inference::Inference;
use crate::estimation::instruments::Instruments;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;

/// Mean slope of the influence that a joint is taken to have at least; below it hardly an equation of the joint counts.
const LEAST_SLOPE: f64 = 0.05;

/// Scales beyond which an equation is called an outlier: one in two million where noise is normal.
const OUTLIER: f64 = 5.0;

/// The estimate of a robust fit.
pub(crate) fn estimate(
    name: &str,
    problem: &EstimationProblem<'_>,
    robust: &RobustFit,
) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let u = robust.scaled_residual(observation);
    let joints: Vec<Joint> = (0..observation.dof).map(|i| Joint::of(observation, robust, &u, i)).collect();
    let pseudo = DVector::from_fn(u.len(), |row, _| {
        let (i, joint) = (row % observation.dof, &joints[row % observation.dof]);
        joint.correction * robust.scales[i] * robust.loss.influence(u[row]) / joint.slope
    });
    let part = |(row, &used): (usize, &bool)| {
        let (i, joint) = (row % observation.dof, &joints[row % observation.dof]);
        let kept = if robust.loss.redescends() { robust.loss.weight(u[row]) / joint.weight } else { 1.0 };
        if used { kept * joint.slope / (robust.scales[i] * robust.scales[i]) } else { 0.0 }
    };
    let parts: Vec<f64> = observation.used.iter().enumerate().map(part).collect();
    let solved = weighted_rows(observation, &parts)?;
    let b = robust.beta.len();
    let fit = solved.with_solution(robust.beta.clone(), solved.inverse_information())?;
    // B = w̃ m/s², and the noise meets w̃ once more: √(parts m/s²) w.
    let rows = DMatrix::from_fn(u.len(), b, |row, column| {
        let (s, slope) = (robust.scales[row % observation.dof], joints[row % observation.dof].slope);
        observation.regressor[(row, column)] * (parts[row] * slope).sqrt() / s
    });
    let noise = residual_noise(observation, &pseudo);
    let inference = Inference {
        estimator: name,
        problem,
        fit: &fit,
        instruments: Instruments::Rows(&rows),
        noise: &noise,
        basis: IntervalBasis::Residual,
        termination: robust.termination,
    };
    let kept = observation.without(|row| u[row].abs() > OUTLIER);
    let mut estimate = inference.with_residual_noise(&kept)?;
    estimate.findings.extend(outliers(observation, robust, &u));
    Ok(estimate)
}

/// Means over the equations of one joint.
struct Joint {
    slope: f64,
    weight: f64,
    correction: f64,
}

impl Joint {
    fn of(observation: &Observation, robust: &RobustFit, u: &DVector<f64>, i: usize) -> Self {
        let rows = (i..u.len()).step_by(observation.dof).filter(|&row| observation.used[row]);
        let (mut count, mut slope, mut squared, mut weight) = (0.0, 0.0, 0.0, 0.0);
        for row in rows {
            let here = robust.loss.slope(u[row]);
            count += 1.0;
            slope += here;
            squared += here * here;
            weight += robust.loss.weight(u[row]);
        }
        if count == 0.0 {
            return Self { slope: 1.0, weight: 1.0, correction: 1.0 };
        }
        let (mean, squared) = (slope / count, squared / count);
        let slope = mean.max(LEAST_SLOPE);
        let share = observation.base.rank() as f64 / observation.equations().max(1) as f64;
        let correction = 1.0 + share * (squared - mean * mean) / (slope * slope);
        Self { slope, weight: weight / count, correction }
    }
}

/// Joints with outliers.
fn outliers(observation: &Observation, robust: &RobustFit, u: &DVector<f64>) -> Vec<Finding> {
    let n = observation.dof;
    (0..n)
        .filter_map(|i| {
            let used = || (i..u.len()).step_by(n).filter(|&row| observation.used[row]);
            let outliers = used().filter(|&row| u[row].abs() > OUTLIER).count();
            (outliers > 0).then(|| Finding::Outliers {
                joint: i + 1,
                outliers,
                equations: used().count(),
                scale: robust.scales[i],
                unit: observation.units[i].clone(),
            })
        })
        .collect()
}
