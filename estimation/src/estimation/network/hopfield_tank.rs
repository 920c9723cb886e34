//! A Hopfield–Tank network whose energy is the sum of squares.
//!
//! ```text
//! du/dt = hᵀ (z − h γ)        γ = α tanh(u/α)        E = ½ ‖z − h γ‖² falls along it
//! step: (1/Δt + A D) Δu = hᵀ (z − h γ), A = hᵀh, D = 1 − (γ/α)²        Δt doubles from one step to the next
//! ```
//! States are bounded by α, a hundred times the size of the torque in units of its noise: no arm that explains it lies beyond. The
//! dynamics is stiff by the square of the condition number, so it is integrated by linearly implicit steps of Euler. Numbers
//! of a recording enter by A, with the square of the condition number: at 1e6 and more, half of the digits are gone.
//!
//! Assumes what `wls` does, at whose solution it rests. Fails where that solution lies beyond α: states then rest at their bounds;
//! and by rounding as above, of parameters that the motion hardly shows first.
//!
//! Source: M. Atencia, G. Joya, F. Sandoval, "Hopfield neural networks for parametric identification of dynamical systems",
//! Neural Processing Letters 21(2), 2005.

use nalgebra::{DMatrix, DVector};

use crate::estimation::linear_fit::LinearFit;
use crate::estimation::unit_equations::UnitEquations;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, Termination};
use crate::linalg::{LeastSquares, transpose_product};

/// Steps at most.
const STEPS: usize = 200;

/// Bound of a state over the size of the torque.
const BOUND: f64 = 100.0;

/// Change of the states, over their size, at which the network has come to rest.
const AT_REST: f64 = 1e-11;

/// Weighted least squares by the dynamics of a network.
#[derive(Clone, Copy, Debug, Default)]
pub struct HopfieldTank;

impl Estimator for HopfieldTank {
    fn name(&self) -> &'static str {
        "hopfield-tank"
    }

    fn summary(&self) -> &'static str {
        "weighted least squares as the rest of a Hopfield-Tank network"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let (observation, equations) = (problem.observation, problem.factorised()?);
        let problem = problem.with_factorisation(&equations);
        let linear = LinearFit::weighted(&equations)?;
        let unit = UnitEquations::of(observation, &linear)?;
        let z = DMatrix::from_column_slice(unit.z.len(), 1, unit.z.as_slice());
        let (a, m) = (transpose_product(&unit.h, &unit.h), transpose_product(&unit.h, &z).column(0).into_owned());
        let bound = BOUND * unit.z.norm().max(f64::MIN_POSITIVE);
        let b = m.len();
        let (gamma, termination) = rest(&a, &m, bound);
        let fit = LeastSquares::from_factors(
            gamma.component_mul(&unit.scale),
            [linear.fit.inverse_information(), DMatrix::identity(b, b)],
            linear.fit.condition(),
            linear.fit.condition_scaled(),
        )?;
        linear.estimate(self.name(), &problem, &fit, termination)
    }
}

/// The states in which the network rests.
fn rest(a: &DMatrix<f64>, m: &DVector<f64>, bound: f64) -> (DVector<f64>, Termination) {
    let b = m.len();
    let state = |u: &DVector<f64>| u.map(|u| bound * libm::tanh(u / bound));
    let mut u = DVector::zeros(b);
    let mut gamma = state(&u);
    let (mut time, mut last_step) = (1.0, f64::INFINITY);
    for iterations in 1..=STEPS {
        let mut matrix = DMatrix::from_fn(b, b, |i, j| a[(i, j)] * (1.0 - (gamma[j] / bound) * (gamma[j] / bound)));
        for j in 0..b {
            matrix[(j, j)] += 1.0 / time;
        }
        let Some(step) = matrix.lu().solve(&(m - a * &gamma)) else {
            return (gamma, Termination::Singular { iterations });
        };
        u += step;
        let next = state(&u);
        let moved = (&next - &gamma).norm();
        last_step = if moved > 0.0 { moved / next.norm() } else { 0.0 };
        gamma = next;
        if last_step <= AT_REST {
            return (gamma, Termination::Converged { iterations, last_step });
        }
        time *= 2.0;
    }
    (gamma, Termination::IterationLimit { iterations: STEPS, last_step })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn analytic_the_network_rests_at_the_minimum_or_at_its_bounds() {
        let (a, m) = (dmatrix![1.0, 0.9; 0.9, 1.0], dvector![1.0, 2.0]);
        let (found, termination) = rest(&a, &m, 100.0);
        assert!(termination.was_successful());
        let expected = a.clone().lu().solve(&m).unwrap();
        assert!((found - expected).norm() < 1e-9);
        // Bounds that the minimum (−4.2, 5.8) lies beyond: no state passes them.
        let (found, _) = rest(&a, &m, 3.0);
        assert!(found.amax() <= 3.0 && found[1] > 2.0, "{found}");
    }
}
