//! From a trajectory's variables to a criterion of its information, and back along exact derivatives.
//!
//! ```text
//! x → (q, q̇, q̈)_k → M → f(M)            ∂f/∂x = Bᵀ ∂f/∂(q, q̇, q̈)
//! ```

use std::sync::Arc;

use nalgebra::DMatrix;

use super::criterion::{Criterion, Score};
use super::error::{ExcitationError, same_joints};
use super::expected::EffectTorques;
use super::information::Information;
use super::problem::DesignProblem;
use super::sampled::SampledBasis;
use crate::dynamics::States;
use crate::model::Robot;
use crate::optimiser::Objective;
use crate::trajectory::PeriodicTrajectory;

/// A criterion of the information as a function of the variables.
pub struct InformationObjective {
    information: Information,
    sampled: SampledBasis,
    states: States,
    slopes: States,
    pub(crate) criterion: Arc<dyn Criterion>,
    sensitivity: DMatrix<f64>,
    m: DMatrix<f64>,
    /// The criterion at the last point, without any smoothing.
    pub(crate) exact: f64,
    effects: Option<Discrepancies>,
}

/// What effects add to the torque of the current motion.
struct Discrepancies {
    torques: EffectTorques,
    /// d, (n N) × E.
    d: DMatrix<f64>,
    moments: DMatrix<f64>,
    /// `S_c`, b × E.
    sensitivity: DMatrix<f64>,
}

impl Objective for InformationObjective {
    fn value(&mut self, x: &[f64]) -> f64 {
        self.gather(x);
        let by_m = &mut self.sensitivity;
        let score = match &mut self.effects {
            None => self.criterion.evaluate(&self.m, Some(by_m)),
            Some(Discrepancies { moments, sensitivity, .. }) => {
                self.criterion.evaluate_with_effects(&self.m, moments, Some((by_m, sensitivity)))
            }
        };
        self.exact = score.exact;
        score.value
    }

    fn gradient(&mut self, gradient: &mut [f64]) {
        let moments = self.effects.as_ref().map(|effects| (&effects.d, &effects.sensitivity));
        self.information.pull_back(&self.states, &self.sensitivity, moments, &mut self.slopes);
        if let Some(effects) = &self.effects {
            let by_d = self.information.pull_back_moments(&effects.sensitivity);
            effects.torques.pull_back(&self.states, &by_d, &mut self.slopes);
        }
        self.sampled.pull_back(&self.slopes, gradient);
    }
}

/// Coulomb columns of the optimiser turn over this part of the speed limit, if the drive's own law is sharper.
///
/// A sample that crosses a reversal flips a sharp sign, and the criterion would jump with every sample. The
/// certificate always uses the drive's own law.
const COULOMB_PART: f64 = 0.05;

/// The robot that the optimiser sees.
fn smoothed_robot(problem: &DesignProblem) -> Result<Robot, ExcitationError> {
    Ok(problem.robot().clone().with_joints(|joint| {
        let speed = joint.limits.velocity;
        if speed.is_finite() {
            joint.drive.coulomb_velocity = joint.drive.coulomb_velocity.max(COULOMB_PART * speed);
        }
    })?)
}

impl DesignProblem {
    /// The information of one torque row of a trajectory on the base columns (b × b), weighted by the problem's noise
    /// and without its prior: what a later problem takes as prior, times how much longer this experiment was.
    ///
    /// # Errors
    /// [`ExcitationError::Joints`] if the trajectory is of another number of joints than the robot.
    pub fn information(&self, trajectory: &PeriodicTrajectory) -> Result<DMatrix<f64>, ExcitationError> {
        let n = self.robot().dof();
        same_joints(trajectory.dof(), n)?;
        let noise = self.objective().noise.clone().unwrap_or_else(|| vec![1.0; n]);
        let samples = self.samples();
        let regressor = self.regressor(&smoothed_robot(self)?)?;
        Ok(Information::of_period(regressor, &self.base().kept, &noise, trajectory, samples))
    }

    /// What one more experiment along a trajectory buys: median over base parameters of their bound after it over that of
    /// the prior alone. As many experiments again like the k so far would give `√(k/(k+1))`. `None` without a prior that
    /// is positive definite.
    ///
    /// # Errors
    /// As [`Self::information`].
    pub fn bound_ratio(&self, trajectory: &PeriodicTrajectory) -> Result<Option<f64>, ExcitationError> {
        let Some(prior) = &self.objective().prior else { return Ok(None) };
        let after = prior + self.information(trajectory)?;
        let variances = |m: &DMatrix<f64>| m.clone().cholesky().map(|factor| factor.inverse().diagonal());
        let (Some(before), Some(after)) = (variances(prior), variances(&after)) else { return Ok(None) };
        let ratio = |(after, before): (&f64, &f64)| (after / before).sqrt();
        let mut ratios: Vec<f64> = after.iter().zip(before.iter()).map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let middle = ratios.len() / 2;
        Ok(Some(0.5 * (ratios[middle] + ratios[(ratios.len() - 1) / 2])))
    }
}

impl InformationObjective {
    /// The objective of a problem, with its criterion smoothed to `sharpness` where it has kinks.
    pub(crate) fn of(problem: &DesignProblem, sharpness: f64) -> Result<Self, ExcitationError> {
        let (n, samples, objective) = (problem.robot().dof(), problem.samples(), problem.objective());
        let (robot, criterion, base) = (smoothed_robot(problem)?, &objective.criterion, &objective.base);
        let prior = objective.prior.clone().filter(|_| criterion.is_weighted());
        let discrepancies = |expected| Discrepancies {
            torques: EffectTorques::new(&robot, expected, samples, problem.space().period_s),
            d: DMatrix::zeros(0, 0),
            moments: DMatrix::zeros(0, 0),
            sensitivity: DMatrix::zeros(0, 0),
        };
        Ok(Self {
            information: Information::new(
                problem.regressor(&robot)?,
                &base.kept,
                samples,
                &objective.row_noise(n),
                prior,
            ),
            sampled: SampledBasis::new(problem.basis().clone(), samples),
            states: States::with_len(n, samples),
            slopes: States::with_len(n, samples),
            criterion: objective.smoothed(sharpness),
            sensitivity: DMatrix::zeros(base.rank(), base.rank()),
            m: DMatrix::zeros(base.rank(), base.rank()),
            exact: f64::INFINITY,
            effects: objective.expected.as_ref().filter(|_| criterion.expects_effects()).map(discrepancies),
        })
    }

    /// The information at `x`, and the moments of what effects add to its torque.
    fn gather(&mut self, x: &[f64]) {
        self.sampled.states(x, &mut self.states);
        self.m = self.information.gather(&self.states);
        if let Some(effects) = &mut self.effects {
            effects.d = effects.torques.evaluate(&self.states);
            effects.moments = self.information.moments(&effects.d);
            if effects.sensitivity.shape() != effects.moments.shape() {
                effects.sensitivity = effects.moments.clone();
            }
        }
    }

    /// The criterion at the gathered motion, without what a gradient needs.
    fn score(&self) -> Score {
        match &self.effects {
            None => self.criterion.evaluate(&self.m, None),
            Some(effects) => self.criterion.evaluate_with_effects(&self.m, &effects.moments, None),
        }
    }

    /// The criterion at `x`, without any smoothing and without a gradient.
    pub(crate) fn exact_at(&mut self, x: &[f64]) -> f64 {
        self.gather(x);
        self.exact = self.score().exact;
        self.exact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{
        CriterionKind, DesignLimits, DesignSpace, EffectLaw, ExpectedEffect, ExpectedEffects, WarmGear, WarmGears,
    };
    use crate::model::{Columns, DriveParameters};
    use crate::seed::Seed;
    use crate::trajectory::Family;

    fn problem(columns: Columns, kind: CriterionKind) -> DesignProblem {
        let mut problem = DesignProblem::new(chains::crs_a460(), columns, kind, DesignLimits::motion()).unwrap();
        problem.objective.samples = 40;
        problem.set_noise(vec![0.3, 0.5, 0.2, 0.1, 0.1, 0.05]).unwrap();
        problem
    }

    #[test]
    fn analytic_the_same_experiment_again_brings_the_bound_down_by_the_root_of_their_number() {
        let mut problem = problem(Columns::RIGID, CriterionKind::DOptimal);
        let motion = problem.start(Seed::new(1), 0).unwrap();
        assert_eq!(problem.bound_ratio(&motion).unwrap(), None);
        for experiments in [1.0, 4.0_f64] {
            problem.set_prior(problem.information(&motion).unwrap() * experiments).unwrap();
            let ratio = problem.bound_ratio(&motion).unwrap().unwrap();
            assert!((ratio - (experiments / (experiments + 1.0)).sqrt()).abs() < 1e-9, "{ratio}");
        }
    }

    /// Load friction, springs, a lag, torque constants and gears that warm up.
    fn expected(problem: &DesignProblem) -> ExpectedEffects {
        let friction = DriveParameters::from_iter([(crate::model::term::LOAD_FRICTION, 0.05)]);
        let ratings = problem.robot().joints().iter().map(|joint| 2e-3 / joint.limits.torque);
        let compliance = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(6, ratings));
        let gear = WarmGear { viscous: 3.0, coulomb: 4.0, fade: 0.05, rise_per_watt: 0.02, lost: 1.8 };
        let laws = [
            EffectLaw::Terms(vec![friction; 6]),
            EffectLaw::Elastic { compliance, with_link: vec![false, false, false, false, true, true] },
            EffectLaw::Late(5e-4),
            EffectLaw::Scaled(0.03),
            EffectLaw::Warming(WarmGears { speeds: DMatrix::identity(6, 6), gears: vec![gear; 6] }),
        ];
        let effects = laws.map(|law| ExpectedEffect { name: "effect".to_owned(), law });
        ExpectedEffects { nominal: chains::crs_a460_nominal(), effects: effects.into(), are_carried: false }
    }

    #[test]
    fn identity_gradient_matches_central_differences() {
        for family in Family::ALL {
            for kind in CriterionKind::ALL {
                // All columns with one family, the rigid ones with the others.
                let columns = if family == Family::Fourier { Columns::RIGID_ROTOR_FRICTION } else { Columns::RIGID };
                let mut problem = problem(columns, kind);
                problem.set_space(DesignSpace::new(family, 10.0, vec![5, 5, 5, 3, 3, 4])).unwrap();
                if kind.criterion().expects_effects() {
                    problem.set_expected(expected(&problem)).unwrap();
                }
                let b = problem.base().rank();
                problem.set_prior(DMatrix::identity(b, b) * 0.1).unwrap();
                let mut objective = InformationObjective::of(&problem, 6.0).unwrap();
                let start = problem.start(Seed::new(1), 0).unwrap();
                let x = problem.basis().coefficients(&start).unwrap();
                let mut gradient = vec![0.0; x.len()];
                objective.value(&x);
                objective.gradient(&mut gradient);
                let size = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
                for i in (0..x.len()).step_by(11) {
                    let at = |h: f64, objective: &mut InformationObjective| {
                        let mut moved = x.clone();
                        moved[i] += h;
                        objective.gather(&moved);
                        objective.score().value
                    };
                    // Sixth-order differences; a short step leaves the rounding of small eigenvalues, a long one truncation.
                    let error = [2e-4, 5e-4, 1e-3, 2e-3].map(|h| {
                        let mut pair = |k: f64| at(k * h, &mut objective) - at(-k * h, &mut objective);
                        let difference = (45.0 * pair(1.0) - 9.0 * pair(2.0) + pair(3.0)) / (60.0 * h);
                        (difference - gradient[i]).abs() / size
                    });
                    let error = error.into_iter().fold(f64::INFINITY, f64::min);
                    assert!(error < 1e-7, "{kind:?} {family:?} {columns:?} variable {i}: {error}");
                }
            }
        }
    }
}
