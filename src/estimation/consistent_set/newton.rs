//! Newton's method for distance and data, and the projection onto the estimated base parameters.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::distance::Distance;
use crate::base::BaseReduction;
use crate::estimation::Termination;

/// Newton steps for one λ.
const STEPS: usize = 100;

/// Decrease that counts as none: half the squared Newton decrement.
const CONVERGED: f64 = 1e-11;

/// Decrease that is lost in the rounding of the value, as a part of it.
const ROUNDING: f64 = 1e-12;

/// Halvings of a Newton step.
const SHORTENINGS: i32 = 60;

/// Projections onto the equation: the first does it but for rounding.
const PROJECTIONS: usize = 3;

/// How far a set is from the estimated base parameters: `½ rᵀ L r` with `r = K φ − β̂` and the information L, times λ.
pub(super) struct DataTerm<'a> {
    pub(super) k: &'a DMatrix<f64>,
    pub(super) beta: &'a DVector<f64>,
    pub(super) information: DMatrix<f64>,
}

impl DataTerm<'_> {
    fn value(&self, phi: &DVector<f64>) -> f64 {
        let r = self.k * phi - self.beta;
        0.5 * r.dot(&(&self.information * &r))
    }
}

/// Where a minimisation ended, and how.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) phi: DVector<f64>,
    pub(super) termination: Termination,
}

/// Damped Newton steps from a consistent set to the minimum of distance and data term; every iterate is consistent.
pub(super) fn newton(mut phi: DVector<f64>, distance: &Distance, data: &DataTerm<'_>) -> Minimum {
    let value = |phi: &DVector<f64>| distance.value(phi) + data.value(phi);
    let curvature = data.k.tr_mul(&(&data.information * data.k));
    let mut last_step = 0.0;
    for iterations in 0..STEPS {
        let (mut gradient, mut hessian) = distance.derivatives(&phi);
        gradient += data.k.tr_mul(&(&data.information * (data.k * &phi - data.beta)));
        hessian += &curvature;
        let Some(factor) = Scaled::of(&hessian) else {
            return Minimum { phi, termination: Termination::Singular { iterations } };
        };
        let step = -factor.solve(&gradient);
        let promised = -gradient.dot(&step);
        if promised.is_nan() {
            return Minimum { phi, termination: Termination::Singular { iterations } };
        }
        if 0.5 * promised < CONVERGED {
            return Minimum { phi, termination: Termination::Converged { iterations, last_step } };
        }
        let before = value(&phi);
        let lengths = (0..SHORTENINGS).map(|halvings| libm::exp2(-f64::from(halvings)));
        let trials = lengths.map(|length| (length, &phi + &step * length));
        let mut better = trials.filter(|(length, trial)| value(trial) <= before - 1e-4 * length * promised);
        let Some((_, trial)) = better.next() else {
            drop(better);
            // The last digits of a large value hide a small decrease: nothing is left to gain.
            let termination = if promised <= ROUNDING * before.abs() {
                Termination::Converged { iterations, last_step }
            } else {
                Termination::Stalled { iterations, last_step }
            };
            return Minimum { phi, termination };
        };
        drop(better);
        last_step = (&trial - &phi).norm() / trial.norm();
        phi = trial;
    }
    Minimum { phi, termination: Termination::IterationLimit { iterations: STEPS, last_step } }
}

/// The nearest set, in the curvature of the distance, with exactly these base parameters: consistent only where the set
/// that it starts from is close.
pub(super) fn project(
    phi: &DVector<f64>,
    distance: &Distance,
    base: &BaseReduction,
    beta: &DVector<f64>,
) -> Option<DVector<f64>> {
    let mut phi = phi.clone();
    for _ in 0..PROJECTIONS {
        let (_, hessian) = distance.derivatives(&phi);
        let factor = Scaled::of(&hessian)?;
        let spread =
            DMatrix::from_columns(&base.k.row_iter().map(|row| factor.solve(&row.transpose())).collect::<Vec<_>>());
        let missing = Scaled::of(&(&base.k * &spread))?.solve(&(beta - base.beta(&phi)));
        phi += spread * missing;
        if !distance.value(&phi).is_finite() {
            return None;
        }
    }
    Some(phi)
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

    /// Ends of the search on the A460 for a data term with this information on every base parameter.
    fn ends(information: f64) -> Termination {
        let (robot, guess) = (crs_a460(), crs_a460_nominal());
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let distance = Distance::of(&base, &guess);
        let beta = base.beta(&guess.vector(&robot, Columns::RIGID_ROTOR_FRICTION)) * 1.1;
        let data = DataTerm { k: &base.k, beta: &beta, information: DMatrix::identity(58, 58) * information };
        newton(distance.centre(), &distance, &data).termination
    }

    #[test]
    fn an_end_says_whether_the_minimum_was_reached() {
        assert!(matches!(ends(100.0), Termination::Converged { iterations: 1.., .. }), "{:?}", ends(100.0));
        // Information that is none makes the matrix of the step indefinite.
        assert_eq!(ends(-1e9), Termination::Singular { iterations: 0 });
        assert_eq!(ends(f64::NAN), Termination::Singular { iterations: 0 });
    }
}
