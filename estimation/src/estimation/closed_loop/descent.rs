//! Gauss–Newton steps on simulated motions, damped where a step cannot be simulated or does not pay.
//!
//! ```text
//! y − f(β + Δ) ≈ r − J Δ        Δ = argmin ‖r − J Δ‖_Σ² + μ ‖D Δ‖²        D_jj = ‖J_j‖_Σ,  μ = 0 unless a step was rejected
//! ```
//! The damping is Levenberg and Marquardt's, in units in which no unit matters: a combination of parameters that the data hardly
//! show moves little until the others are right. At rest there is none.
//!
//! Reference: J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", Numerical Analysis, Springer 1978.

use nalgebra::{DMatrix, DVector};

use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::inference::solve;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::{BlockWhitening, LeastSquares, product};

/// Steps at most.
const STEPS: usize = 40;
/// Damping after the first rejection of a step, the most that is tried, and the factor between.
const LEAST_DAMPING: f64 = 1e-8;
const MOST_DAMPING: f64 = 1e3;
const FACTOR: f64 = 10.0;
/// Length of a step, as weighted equations over all of them, at which the search has come to rest.
pub(super) const AT_REST: f64 = 1e-9;
/// Length of a step at which the search has come to rest where steps end in a set: about what is known of the nearest point of it.
pub(super) const AT_REST_IN_A_SET: f64 = 1e-8;

/// Standard deviation of a position, over that of the joint that is known worst, below which it counts as that: a joint without
/// any residual would have all the weight.
const LEAST_SHARE: f64 = 1e-6;

/// Equations around a trial point, n·M rows; zero in rows that are none.
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    /// J, (n·M) × b.
    pub(super) jacobian: DMatrix<f64>,
    /// r, n·M.
    pub(super) residual: DVector<f64>,
}

impl Linearised {
    /// `r + J β = J β' + ε`: linear equations of the parameters themselves.
    pub(super) fn equations(&self, observation: &Observation, beta: &DVector<f64>) -> Observation {
        let column = DMatrix::from_column_slice(beta.len(), 1, beta.as_slice());
        let y = &self.residual + product(&self.jacobian, &column).column(0);
        Observation { regressor: self.jacobian.clone(), y, ..observation.clone() }
    }

    /// Weights of positions by the residual at a trial point, correlation between joints left out: what the model misses is in it too.
    pub(super) fn residual_weights(
        &self,
        positions: &Observation,
        beta: &DVector<f64>,
    ) -> Result<BlockWhitening, EstimationError> {
        let around = self.equations(positions, beta);
        let covariance = Factorisation::new(&around)?.residual_covariance(beta);
        let worst = covariance.diagonal().max();
        let least = (worst * LEAST_SHARE * LEAST_SHARE).max(f64::MIN_POSITIVE);
        Ok(BlockWhitening::new(&DMatrix::from_diagonal(&covariance.diagonal().map(|variance| variance.max(least))))?)
    }
}

/// Linearises at a trial point, or says why it cannot be simulated.
pub(super) type Linearise<'a> = dyn Fn(&DVector<f64>) -> Result<Linearised, EstimationError> + 'a;

/// Takes the solution of linear equations of β, with its inverse information, to the nearest point of a set.
pub(in crate::estimation) type Onto<'a> = dyn Fn(&LeastSquares) -> Result<DVector<f64>, EstimationError> + 'a;

/// Whether the trial point is at fault: another one may do.
pub(super) fn is_rejected(error: &EstimationError) -> bool {
    matches!(error, EstimationError::ClosedLoop { reason, .. } if reason.is_of_parameters())
}

/// What is minimised.
pub(super) struct Descent<'a> {
    /// Whose observer may end it.
    pub(super) problem: &'a EstimationProblem<'a>,
    pub(super) observation: &'a Observation,
    pub(super) weights: &'a BlockWhitening,
    /// By which part a step may raise the sum of squares: none where J is exact.
    pub(super) rise: f64,
    /// Equations that hold combinations of parameters where they are, h × b; none where all may move.
    pub(super) held: DMatrix<f64>,
    /// The set in which steps end; none where any β will do.
    pub(super) onto: Option<&'a Onto<'a>>,
}

/// Where the search ended.
pub(in crate::estimation) struct Rest {
    pub(super) beta: DVector<f64>,
    pub(super) linearised: Linearised,
    pub(in crate::estimation) termination: Termination,
}

impl Descent<'_> {
    /// Follows steps from a point to rest.
    pub(super) fn follow(
        &self,
        (mut beta, mut at): (DVector<f64>, Linearised),
        linearise: &Linearise<'_>,
    ) -> Result<Rest, EstimationError> {
        let mut cost = self.white(&at.residual)?.norm_squared();
        let (mut last_step, mut damping) = (f64::INFINITY, 0.0);
        let at_rest = if self.onto.is_some() { AT_REST_IN_A_SET } else { AT_REST };
        for iterations in 1..=STEPS {
            let step = self.step(&at, &beta, 0.0)?;
            let equations = at.equations(self.observation, &beta);
            let moved = product(&at.jacobian, &DMatrix::from_column_slice(step.len(), 1, step.as_slice()));
            last_step = self.white(&moved.column(0).into_owned())?.norm() / self.white(&equations.y)?.norm();
            if last_step <= at_rest {
                return Ok(Rest {
                    beta,
                    linearised: at,
                    termination: Termination::Converged { iterations, last_step },
                });
            }
            let (mut unsimulable, mut accepted) = (false, None);
            while damping <= MOST_DAMPING {
                let trial = &beta + if damping == 0.0 { step.clone() } else { self.step(&at, &beta, damping)? };
                match linearise(&trial) {
                    Ok(found) => {
                        let trial_cost = self.white(&found.residual)?.norm_squared();
                        if trial_cost <= cost * (1.0 + self.rise) {
                            accepted = Some((trial, found, trial_cost));
                            break;
                        }
                        unsimulable = false;
                    }
                    Err(error) if is_rejected(&error) => unsimulable = true,
                    Err(EstimationError::Interrupted) => {
                        return Ok(Rest { beta, linearised: at, termination: Termination::Interrupted { iterations } });
                    }
                    Err(error) => return Err(error),
                }
                damping = (damping * FACTOR).max(LEAST_DAMPING);
            }
            let Some((trial, found, trial_cost)) = accepted else {
                let termination = if unsimulable {
                    Termination::Unsimulable { iterations }
                } else {
                    Termination::Stalled { iterations, last_step }
                };
                return Ok(Rest { beta, linearised: at, termination });
            };
            (beta, at, cost) = (trial, found, trial_cost);
            damping = if damping > LEAST_DAMPING { damping / (FACTOR * FACTOR) } else { 0.0 };
            if let Some(termination) = self.problem.ended_after(iterations, STEPS) {
                return Ok(Rest { beta, linearised: at, termination });
            }
        }
        let termination = Termination::IterationLimit { iterations: STEPS, last_step };
        Ok(Rest { beta, linearised: at, termination })
    }

    /// Δ from β with the damping μ.
    fn step(&self, at: &Linearised, beta: &DVector<f64>, damping: f64) -> Result<DVector<f64>, EstimationError> {
        let fit = self.solve(at, damping)?;
        let Some(onto) = self.onto else { return Ok(fit.solution().clone()) };
        Ok(onto(&fit.with_solution(beta + fit.solution(), fit.inverse_information())?)? - beta)
    }

    /// The fit whose solution is Δ, with the damping μ.
    pub(super) fn solve(&self, at: &Linearised, damping: f64) -> Result<LeastSquares, EstimationError> {
        let mut jacobian = self.weights.clone().whiten(&at.jacobian, &self.observation.used)?;
        let mut residual = self.white(&at.residual)?;
        let lengths: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
        let mut append = |more: &DMatrix<f64>| {
            let rows = jacobian.nrows();
            jacobian.resize_vertically_mut(rows + more.nrows(), 0.0);
            jacobian.rows_mut(rows, more.nrows()).copy_from(more);
            residual.resize_vertically_mut(rows + more.nrows(), 0.0);
        };
        append(&self.held);
        if damping > 0.0 {
            append(&(DMatrix::from_diagonal(&DVector::from_vec(lengths)) * damping.sqrt()));
        }
        solve(self.observation, &jacobian, &residual)
    }

    /// `Σ^{-½} r`.
    fn white(&self, residual: &DVector<f64>) -> Result<DVector<f64>, EstimationError> {
        Ok(self.observation.white(self.weights, residual)?)
    }
}

impl Rest {
    /// The weighted fit of the equations around this point; where the search did not come to rest, with this point in place of
    /// a step that was not taken.
    pub(super) fn fit(&self, fit: LeastSquares) -> Result<LeastSquares, EstimationError> {
        if self.termination.was_successful() {
            return Ok(fit);
        }
        Ok(fit.with_solution(self.beta.clone(), fit.inverse_information())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::tests::synthetic;
    use crate::seed::Seed;

    #[test]
    fn identity_a_step_onto_a_set_is_a_step_to_the_nearest_point_of_it() {
        let (observation, beta) = synthetic(40, 4, &mut Seed::new(9).stream("onto", 0));
        let (weights, problem) =
            (BlockWhitening::new(&DMatrix::identity(2, 2)).unwrap(), EstimationProblem::new(&observation));
        let descent = |onto| Descent {
            problem: &problem,
            observation: &observation,
            weights: &weights,
            rise: 0.0,
            held: DMatrix::zeros(0, 4),
            onto,
        };
        // Equations that are exact at β: from half of it, a step is the other half.
        let from = 0.5 * &beta;
        let residual = &observation.y - &observation.regressor * &from;
        let at = Linearised { jacobian: observation.regressor.clone(), residual };
        let (all, first_is_three) = (
            |fit: &LeastSquares| Ok(fit.solution().clone()),
            |fit: &LeastSquares| {
                let mut nearest = fit.solution().clone();
                nearest[0] = 3.0;
                Ok(nearest)
            },
        );
        let mut inside = &beta - &from;
        assert!((descent(None).step(&at, &from, 0.0).unwrap() - &inside).norm() < 1e-12);
        assert!((descent(Some(&all)).step(&at, &from, 0.0).unwrap() - &inside).norm() < 1e-12);
        inside[0] = 3.0 - from[0];
        assert!((descent(Some(&first_is_three)).step(&at, &from, 0.0).unwrap() - &inside).norm() < 1e-12);
    }
}
