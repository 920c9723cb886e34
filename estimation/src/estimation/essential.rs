//! Essential parameters: base parameters that the data do not tell from zero are left out.
//!
//! ```text
//! t_j = |β̂_j|/std_j of the parameters that are left        while min t_j < t_{0.975}: leave that parameter out, solve again
//! leaving out j: β ← β − C_j β_j/C_jj        C ← C − C_j C_jᵀ/C_jj        (C_j column j of C)
//! ```
//! Weighted least squares with its full covariance C, backward elimination by one t test (an F test of one parameter) after the other;
//! the solution with the others at zero follows from β̂ and C alone. Its value is fewer numbers that predict as
//! well, and no parameter with a sign by chance. What is left out is 0 in the estimate, not in the arm.
//!
//! Intervals know the selection: they, standard deviations and covariance are those of the *full* model, which nothing was selected for,
//! widened to hold the value where it moved out. Those of the small model alone would take the zeros for known and be too
//! short.
//!
//! Assumes what `wls` does, and that a parameter within its noise may be taken for zero wherever the estimate is used. Fails where
//! parameters are hidden together: of two that only act as a sum one is left out and the other takes its part, which predicts the
//! recorded motion and not another one.
//!
//! Sources: M. Gautier, W. Khalil, "Exciting trajectories for the identification of base inertial parameters of robots",
//! International Journal of Robotics Research 11(4), 1992; A. Janot et al., "A generic instrumental variable approach for
//! industrial robot identification", IEEE Trans. Control Systems Technology 22(1), 2014, for the F test.

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::estimate::Estimate;
use super::finding::Finding;
use super::law::{EstimatorLaw, LawException};
use super::linear_fit::LinearFit;
use super::problem::EstimationProblem;
use super::termination::Termination;
use crate::statistics::student_quantile;

pub(super) const EXCEPTIONS: &[LawException] = &[LawException {
    law: EstimatorLaw::Recovery,
    reason: "a parameter smaller than the stated noise is left out, although its equations may be exact",
}];

/// Weighted least squares of the parameters that the data tell from zero.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    let full = linear.estimate(name, problem, &linear.fit, Termination::Direct)?;
    let t = student_quantile(0.975, full.degrees_of_freedom);
    let selection = select(full.beta(), full.covariance_matrix(), t);
    let fit = linear.fit.with_solution(selection.beta, linear.fit.inverse_information())?;
    let mut estimate = linear.estimate(name, problem, &fit, Termination::Direct)?;
    estimate = estimate.with_covariance(&full.covariance_matrix());
    estimate.degrees_of_freedom = full.degrees_of_freedom;
    estimate.interval_basis = full.interval_basis;
    for (p, known) in estimate.base.iter_mut().zip(&full.base) {
        p.ci95 = [known.ci95[0].min(p.value), known.ci95[1].max(p.value)];
    }
    let left_out = |name: &String| full.base.iter().zip(&selection.kept).any(|(p, kept)| !kept && p.name == *name);
    estimate
        .findings
        .retain(|finding| !matches!(finding, Finding::PoorlyDetermined { parameter, .. } if left_out(parameter)));
    for (p, _) in full.base.iter().zip(&selection.kept).filter(|(_, kept)| !**kept) {
        let (parameter, unit) = (p.name.clone(), p.unit.clone());
        estimate.findings.push(Finding::LeftOut { parameter, value: p.value, std: p.std, unit });
    }
    Ok(estimate)
}

struct Selection {
    beta: DVector<f64>,
    kept: Vec<bool>,
}

/// Leaves out one parameter after the other until each that is left differs from zero by `t` standard deviations.
fn select(mut beta: DVector<f64>, mut covariance: DMatrix<f64>, t: f64) -> Selection {
    let mut kept = vec![true; beta.len()];
    loop {
        let ratio = |j: usize| beta[j].abs() / covariance[(j, j)].sqrt();
        let left = (0..beta.len()).filter(|&j| kept[j] && covariance[(j, j)] > 0.0);
        let Some(least) = left.min_by(|&a, &b| ratio(a).total_cmp(&ratio(b))).filter(|&j| ratio(j) < t) else {
            return Selection { beta, kept };
        };
        let column: DVector<f64> = covariance.column(least) / covariance[(least, least)].sqrt();
        beta -= &column * (beta[least] / covariance[(least, least)].sqrt());
        covariance -= &column * column.transpose();
        kept[least] = false;
        for j in (0..beta.len()).filter(|&j| !kept[j]) {
            beta[j] = 0.0;
            covariance.row_mut(j).fill(0.0);
            covariance.column_mut(j).fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::LeastSquares;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn identity_leaving_out_is_solving_without_the_columns() {
        let mut rng = Seed::new(71).stream("essential", 0);
        let w = DMatrix::from_fn(60, 6, |_, _| rng.random_range(-1.0..1.0));
        let beta = DVector::from_vec(vec![1.0, 0.0, -2.0, 0.0, 0.5, 0.0]);
        let noise = DVector::from_fn(60, |_, _| rng.random_range(-0.2..0.2));
        let y = &w * &beta + noise;
        let fit = LeastSquares::solve(&w, &y).unwrap();
        let covariance = fit.inverse_information() * (0.04 / 3.0);
        let selection = select(fit.solution().clone(), covariance, 1.96);
        assert!(
            [0, 2, 4].iter().all(|&j| selection.kept[j]) && selection.kept.contains(&false),
            "{:?}",
            selection.kept
        );
        let columns: Vec<usize> = (0..6).filter(|&j| selection.kept[j]).collect();
        let small = LeastSquares::solve(&w.select_columns(&columns), &y).unwrap();
        for (k, &j) in columns.iter().enumerate() {
            assert!((selection.beta[j] - small.solution()[k]).abs() < 1e-12);
            let std = (small.inverse_information()[(k, k)] * 0.04 / 3.0).sqrt();
            assert!(small.solution()[k].abs() >= 1.96 * std);
        }
        for j in (0..6).filter(|&j| !selection.kept[j]) {
            assert_eq!(selection.beta[j], 0.0);
        }
    }
}
