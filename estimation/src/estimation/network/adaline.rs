//! The adaptive linear neuron, trained by the delta rule on the whole recording.
//!
//! ```text
//! γ ← γ + η hᵀ (z − h γ)        η = 1/λ_max(hᵀh)        from γ = 0
//! ```
//! Steepest descent: each epoch leaves `1 − 1/κ²` of the error in the weakest direction, κ the condition number with columns of
//! unit length. Needs some 25 κ² epochs. Assumes what `wls` does, at whose solution it rests. Fails where κ is above some ninety:
//! 200,000 epochs are then too few, it stops on the way, and the termination says so.
//!
//! Source: B. Widrow, M. E. Hoff, "Adaptive switching circuits", IRE WESCON Convention Record 4, 1960.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::estimation::linear_fit::LinearFit;
use crate::estimation::unit_equations::UnitEquations;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, Termination};
use crate::linalg::{LeastSquares, transpose_product};

/// Epochs at most.
const EPOCHS: usize = 200_000;

/// Change of the parameters, over their size, at which training has come to rest.
const AT_REST: f64 = 1e-14;

/// Weighted least squares by the delta rule.
#[derive(Clone, Copy, Debug, Default)]
pub struct Adaline;

impl Estimator for Adaline {
    fn name(&self) -> &'static str {
        "adaline"
    }

    fn summary(&self) -> &'static str {
        "weighted least squares by the delta rule of one linear neuron"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let (observation, equations) = (problem.observation, problem.factorised()?);
        let problem = problem.with_factorisation(&equations);
        let linear = LinearFit::weighted(&equations)?;
        let unit = UnitEquations::of(observation, &linear)?;
        let z = DMatrix::from_column_slice(unit.z.len(), 1, unit.z.as_slice());
        let (a, m) = (transpose_product(&unit.h, &unit.h), transpose_product(&unit.h, &z).column(0).into_owned());
        let rate = 1.0 / SymmetricEigen::new(a.clone()).eigenvalues.max();
        let b = m.len();
        let mut gamma = nalgebra::DVector::zeros(b);
        let (mut last_step, mut termination) = (f64::INFINITY, None);
        for iterations in 1..=EPOCHS {
            let mut step = m.clone();
            step.gemv(-1.0, &a, &gamma, 1.0);
            step *= rate;
            gamma += &step;
            last_step = if step.norm() > 0.0 { step.norm() / gamma.norm() } else { 0.0 };
            if last_step <= AT_REST {
                termination = Some(Termination::Converged { iterations, last_step });
                break;
            }
        }
        let fit = LeastSquares::from_factors(
            gamma.component_mul(&unit.scale),
            [linear.fit.inverse_information(), DMatrix::identity(b, b)],
            linear.fit.condition(),
            linear.fit.condition_scaled(),
        )?;
        let termination = termination.unwrap_or(Termination::IterationLimit { iterations: EPOCHS, last_step });
        linear.estimate(self.name(), &problem, &fit, termination)
    }
}
