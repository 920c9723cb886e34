//! Newton's method along the path from the guess to the data.
//!
//! ```text
//! step d of  ½ λ χ² + D:      (K H⁻¹ Kᵀ + C/λ) z = r + K pull        d = pull − H⁻¹ Kᵀ z        H = ∇²D, pull = −H⁻¹ ∇D
//! decrement δ² = dᵀ H d + λ (K d)ᵀ C⁻¹ (K d)                          length 1/(1 + δ) keeps inside and descends
//! ```
//! The equations are b × b, and neither a large λ nor a link on the edge of what is possible spoils them; λ = ∞ is the
//! equation K φ = β̂ itself. Reference for the length: S. Boyd, L. Vandenberghe, "Convex Optimization", section 9.6.4.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::distance::Distance;
use crate::estimation::Termination;

/// Newton steps for one λ: some ten are enough but where links must grow far beyond the guess.
const STEPS: usize = 2000;

/// Squared decrement above which a step longer than Newton's is tried.
const FAR: f64 = 1.0;

/// Squared decrement at which a minimum is reached.
const CONVERGED: f64 = 1e-14;

/// Squared decrement below which only rounding keeps it from falling as fast as Newton's method does.
const ROUNDING: f64 = 1e-6;

/// Part of the promised decrease that a step must give to be longer than theory asks.
const ARMIJO: f64 = 0.1;

/// Steps onto the sets with the estimated base parameters.
const PROJECTIONS: usize = 3;

/// Part of what is summed to a base parameter that a set with the estimated one may be away from it.
const EXACT: f64 = 1e-10;

/// The estimated base parameters: `r = K φ − β̂` with its covariance C and information C⁻¹.
pub(super) struct DataTerm<'a> {
    pub(super) k: &'a DMatrix<f64>,
    pub(super) beta: &'a DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    pub(super) information: DMatrix<f64>,
}

impl DataTerm<'_> {
    fn residual(&self, phi: &DVector<f64>) -> DVector<f64> {
        self.k * phi - self.beta
    }

    /// χ², the squared Mahalanobis distance of a set from the estimate.
    pub(super) fn chi_squared(&self, phi: &DVector<f64>) -> f64 {
        let r = self.residual(phi);
        r.dot(&(&self.information * &r))
    }
}

/// Where a minimisation ended, and how.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) phi: DVector<f64>,
    pub(super) termination: Termination,
}

/// `H⁻¹ Kᵀ` at a set, and the factor of `K H⁻¹ Kᵀ + C/λ`.
pub(super) struct StepEquations {
    spread: DMatrix<f64>,
    factor: Scaled,
}

impl StepEquations {
    /// `None` where the matrix is not positive definite, which happens only where a number is not finite.
    pub(super) fn of(phi: &DVector<f64>, distance: &Distance, data: &DataTerm<'_>, weight: f64) -> Option<Self> {
        let columns: Vec<_> = data.k.row_iter().map(|row| distance.inverse_hessian(phi, &row.transpose())).collect();
        let spread = DMatrix::from_columns(&columns);
        let matrix = data.k * &spread + &data.covariance / weight;
        let factor = Scaled::of(&((&matrix + matrix.transpose()) * 0.5))?;
        Some(Self { spread, factor })
    }

    /// How the set follows the estimate: `∂φ/∂β̂`, p × b.
    pub(super) fn sensitivity(&self) -> DMatrix<f64> {
        let b = self.spread.ncols();
        let columns: Vec<_> =
            (0..b).map(|i| self.factor.solve(&DVector::from_fn(b, |j, _| f64::from(u8::from(i == j))))).collect();
        &self.spread * DMatrix::from_columns(&columns)
    }
}

/// From a consistent set to the minimum of `½ λ χ² + D`; every iterate is consistent. With λ = ∞ the set that it starts
/// from must have the estimated base parameters, and so has the minimum.
pub(super) fn minimise(mut phi: DVector<f64>, distance: &Distance, data: &DataTerm<'_>, weight: f64) -> Minimum {
    let (mut last_step, mut before) = (0.0, f64::INFINITY);
    for iterations in 0..STEPS {
        let Some(equations) = StepEquations::of(&phi, distance, data, weight) else {
            return Minimum { phi, termination: Termination::Singular { iterations } };
        };
        let (r, pull) = (data.residual(&phi), distance.pull(&phi));
        let z = equations.factor.solve(&(&r + data.k * &pull));
        let step = pull - &equations.spread * z;
        let shift = data.k * &step;
        // ½ λ χ² along the step: its slope and its curvature.
        let (slope, bend) = if weight.is_finite() {
            let pushed = &data.information * &shift;
            (weight * r.dot(&pushed), weight * shift.dot(&pushed))
        } else {
            (0.0, 0.0)
        };
        let squared = distance.curvature(&phi, &step) + bend;
        if squared.is_nan() {
            return Minimum { phi, termination: Termination::Singular { iterations } };
        }
        if squared < CONVERGED || (squared < ROUNDING && squared > 0.1 * before) {
            return Minimum { phi, termination: Termination::Converged { iterations, last_step } };
        }
        before = squared;
        let start = distance.value(&phi);
        let change = |length: f64| {
            let value = distance.value(&(&phi + &step * length));
            value - start + length * slope + 0.5 * length * length * bend
        };
        let safe = 1.0 / (1.0 + squared.sqrt());
        let is_enough = |length: &f64| change(*length) <= -ARMIJO * length * squared;
        let mut halved =
            std::iter::successors(Some(1.0_f64), |length| Some(0.5 * length)).take_while(|&length| length > safe);
        let mut length = halved.find(is_enough).unwrap_or(safe);
        // Far from the minimum the way is longer than the quadratic says.
        while length >= 1.0 && squared > FAR && change(2.0 * length) < change(length) {
            length *= 2.0;
        }
        let trial = &phi + &step * length;
        if !distance.value(&trial).is_finite() {
            return Minimum { phi, termination: Termination::Stalled { iterations, last_step } };
        }
        last_step = (&trial - &phi).norm() / trial.norm();
        phi = trial;
    }
    Minimum { phi, termination: Termination::IterationLimit { iterations: STEPS, last_step } }
}

/// The nearest set, in the curvature of the distance, with the estimated base parameters: `None` where it is not
/// consistent, or rounding keeps it from having them.
pub(super) fn project(mut phi: DVector<f64>, distance: &Distance, data: &DataTerm<'_>) -> Option<DVector<f64>> {
    // The first step does it but for rounding, which the others take away.
    for _ in 0..PROJECTIONS {
        let equations = StepEquations::of(&phi, distance, data, f64::INFINITY)?;
        phi -= &equations.spread * equations.factor.solve(&data.residual(&phi));
        if !distance.value(&phi).is_finite() {
            return None;
        }
    }
    let size = data.k.abs() * phi.abs();
    let has_them = data.residual(&phi).iter().zip(&size).all(|(residual, size)| residual.abs() <= EXACT * size);
    has_them.then_some(phi)
}

/// The factor of a positive definite matrix, in units in which its diagonal is one.
struct Scaled {
    unit: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Scaled {
    fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        let unit = matrix.diagonal().map(|d| 1.0 / d.sqrt());
        let scaled = DMatrix::from_fn(unit.len(), unit.len(), |i, j| matrix[(i, j)] * unit[i] * unit[j]);
        Some(Self { unit, factor: Cholesky::new(scaled)? })
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.unit)).component_mul(&self.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::excitation::fixtures::{crs_a460, crs_a460_nominal};
    use crate::model::Columns;
    use crate::seed::Seed;

    /// The end of the search on the A460 for a variance of every base parameter and a weight.
    fn end(variance: f64, weight: f64) -> Termination {
        let (robot, guess) = (crs_a460(), crs_a460_nominal());
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let beta = base.beta(&guess.vector(&robot, Columns::RIGID_ROTOR_FRICTION)) * 1.1;
        let distance = Distance::of(&base, &guess, &beta, &DVector::from_element(58, variance.sqrt()));
        let covariance = DMatrix::identity(58, 58) * variance;
        let information = DMatrix::identity(58, 58) / variance;
        let data = DataTerm { k: &base.k, beta: &beta, covariance, information };
        minimise(distance.centre(), &distance, &data, weight).termination
    }

    #[test]
    fn an_end_says_whether_the_minimum_was_reached() {
        for weight in [1e-6, 1.0, 1e6, 1e12] {
            let found = end(0.01, weight);
            assert!(matches!(found, Termination::Converged { iterations: 1..50, .. }), "{weight}: {found:?}");
        }
        // A covariance that is not positive definite makes the matrix of the step indefinite.
        assert_eq!(end(0.01, -1e-12), Termination::Singular { iterations: 0 });
        assert_eq!(end(f64::NAN, 1.0), Termination::Singular { iterations: 0 });
    }
}
