//! A robot, and what is asked of a trajectory for it.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::budget::DesignBudget;
use super::limits::DesignLimits;
use super::objective::{DesignObjective, check_prior};
use super::space::DesignSpace;
use crate::base::BaseReduction;
use crate::excitation::basis::MotionBasis;
use crate::excitation::criterion::Criterion;
use crate::excitation::effort::{Channel, EffortModel, WorstEfforts};
use crate::excitation::error::{ExcitationError, above_zero, at_least_one, same_length};
use crate::excitation::evaluation::EvaluationMotions;
use crate::excitation::expected::ExpectedEffects;
use crate::excitation::start::series_start;
use crate::model::{Columns, ReferenceUnits, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::trajectory::{Family, PeriodicTrajectory, Timeline};

/// A design problem: a robot, the space of trajectories, the limits to hold, the objective, and the budget of the search.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem};
/// use armid::model::{Columns, bundled, format::parse_robot};
/// let robot = parse_robot(bundled()[0].robot).unwrap();
/// let limits = DesignLimits::motion();
/// let mut problem = DesignProblem::new(robot, Columns::RIGID_ROTOR_FRICTION, CriterionKind::Condition, limits).unwrap();
/// assert_eq!(problem.base().rank(), 58);
/// assert_eq!((problem.space().period_s, problem.space().harmonics[0]), (10.0, 5));
/// problem.set_budget(DesignBudget { evaluations: 60, ..DesignBudget::default() }).unwrap();
/// let mut held_still = problem.space().clone();
/// held_still.frozen[3] = Some(0.2);
/// problem.set_space(held_still).unwrap();
/// // Friction of a joint at rest is not revealed.
/// assert!(problem.base().rank() < 58);
/// ```
#[derive(Clone, Debug)]
pub struct DesignProblem {
    robot: Robot,
    space: DesignSpace,
    /// The space as variables of the search.
    basis: MotionBasis,
    limits: DesignLimits,
    /// The robot with position limits that keep the margin from its own.
    pub(crate) inner_robot: Robot,
    pub(crate) objective: DesignObjective,
    budget: DesignBudget,
}

/// Period of `radkhah2007`'s trajectories, s.
const PERIOD_S: f64 = 10.0;

/// Their number of harmonics.
const HARMONICS: usize = 5;

/// Samples for each period of the highest harmonic, at least.
const SAMPLES_PER_HARMONIC: usize = 4;

impl DesignProblem {
    /// `radkhah2007`'s setting for a criterion of the list or from outside: period 10 s, five harmonics. Of the robot's limits it
    /// holds those that [`DesignLimits::for_robot`] or [`DesignLimits::motion`] chose.
    ///
    /// # Errors
    /// [`ExcitationError::Base`] if the base parameters cannot be found; as [`Self::set_limits`].
    pub fn new(
        robot: Robot,
        columns: Columns,
        criterion: impl Into<Arc<dyn Criterion>>,
        limits: DesignLimits,
    ) -> Result<Self, ExcitationError> {
        let objective = DesignObjective::new(&robot, columns, criterion.into())?;
        let space = DesignSpace::new(Family::Fourier, PERIOD_S, vec![HARMONICS; robot.dof()]);
        let basis = MotionBasis::new(&robot, &space)?;
        let inner_robot = limits.inner_robot(&robot)?;
        let mut problem = Self { robot, space, basis, limits, inner_robot, objective, budget: DesignBudget::default() };
        problem.declare()?;
        Ok(problem)
    }

    /// Seeks the design in another space. What joints that stand still no longer reveal is taken out of the base.
    ///
    /// # Errors
    /// [`ExcitationError`] if the space is not one of the robot: another number of joints, a joint that stands still outside
    /// its range, no joint that moves, or too few harmonics for the family; [`ExcitationError::Base`] if the base parameters
    /// of the motion cannot be found, [`ExcitationError::PriorSize`] if the prior is not on them. The problem is then as it
    /// was.
    pub fn set_space(&mut self, space: DesignSpace) -> Result<(), ExcitationError> {
        let basis = MotionBasis::new(&self.robot, &space)?;
        let objective = if space.frozen == self.space.frozen {
            self.objective.clone()
        } else {
            self.objective.in_space(&self.robot, &space)?
        };
        let mut next = Self { objective, space, basis, ..self.clone() };
        next.declare()?;
        *self = next;
        Ok(())
    }

    /// Holds other limits.
    ///
    /// # Errors
    /// [`ExcitationError`] if a limit is no number or outside its range, [`ExcitationError::Length`] if nominal parameters,
    /// their uncertainty or position margins are not those of the robot,
    /// [`ExcitationError::PositionMargin`] if a margin leaves a joint no range. The problem is then as it was.
    pub fn set_limits(&mut self, limits: DesignLimits) -> Result<(), ExcitationError> {
        self.inner_robot = limits.inner_robot(&self.robot)?;
        self.limits = limits;
        // Nothing else that a criterion is told depends on the nominal parameters.
        if self.objective.columns.beyond_motion().is_some() { self.declare() } else { Ok(()) }
    }

    /// The regressor of a robot, this one or one like it; friction of the load by the nominal parameters.
    ///
    /// # Errors
    /// [`ExcitationError::Columns`] where a column depends on more than the motion and there are no nominal parameters.
    pub fn regressor(&self, robot: &Robot) -> Result<JointTorqueRegressor, ExcitationError> {
        let columns = self.objective.columns;
        columns.check_estimable()?;
        Ok(match &self.limits.nominal {
            Some(nominal) => JointTorqueRegressor::with_load(robot, columns, nominal),
            None => JointTorqueRegressor::new(robot, columns)?,
        })
    }

    /// Tells the criterion what the estimate is for.
    fn declare(&mut self) -> Result<(), ExcitationError> {
        // Nominal parameters may be said later.
        if self.objective.columns.beyond_motion().is_some() && self.limits.nominal.is_none() {
            return Ok(());
        }
        let regressor = self.regressor(&self.robot)?;
        self.objective.declare(&self.robot, &regressor, &self.space)
    }

    /// Searches for longer or shorter.
    ///
    /// # Errors
    /// [`ExcitationError::TooFew`] of no evaluations or no certificate samples.
    pub fn set_budget(&mut self, budget: DesignBudget) -> Result<(), ExcitationError> {
        at_least_one("evaluations", budget.evaluations)?;
        at_least_one("certificate samples", budget.certificate_samples)?;
        self.budget = budget;
        Ok(())
    }

    /// Weights the rows of each joint by the noise of its torque, N·m (n), where the criterion weights rows.
    ///
    /// # Errors
    /// [`ExcitationError::Length`] if it is not one for each joint, [`ExcitationError::NotPositive`] if one is no finite number
    /// above zero.
    pub fn set_noise(&mut self, noise: Vec<f64>) -> Result<(), ExcitationError> {
        same_length("noise levels", noise.len(), self.robot.dof())?;
        noise.iter().try_for_each(|&level| above_zero("a noise level", level, "N·m"))?;
        self.objective.noise = Some(noise);
        Ok(())
    }

    /// Judges predictions on these motions, in place of [`EvaluationMotions::default_for`]; for the criteria that ask what the
    /// estimate is for.
    ///
    /// # Errors
    /// [`ExcitationError::Length`] if they are of another number of joints.
    pub fn set_evaluation(&mut self, motions: EvaluationMotions) -> Result<(), ExcitationError> {
        same_length("joints of the evaluation motions", motions.joints, self.robot.dof())?;
        self.objective.evaluation = Some(motions);
        self.declare()
    }

    /// Adds errors of unlike parameters in these units, in place of the usual ones, in
    /// [`Certificate::bias_susceptibility`](crate::excitation::Certificate::bias_susceptibility).
    pub fn set_reference_units(&mut self, units: ReferenceUnits) {
        self.objective.reference_units = units;
        self.objective = self.objective.clone().told_units();
    }

    /// Expects these effects of the arm, for the criteria that do; none unless said.
    ///
    /// # Errors
    /// [`ExcitationError::Length`] if they are of another number of joints, [`ExcitationError::Negative`] if a size is below
    /// zero or no number.
    pub fn set_expected(&mut self, expected: ExpectedEffects) -> Result<(), ExcitationError> {
        expected.check(self.robot.dof())?;
        self.objective.expected = Some(expected);
        self.declare()
    }

    /// Expects so many torque rows of the whole experiment, each with the noise of its joint; ten periods at the servo's
    /// rate unless said. It weights noise against effects.
    ///
    /// # Errors
    /// [`ExcitationError::NotPositive`] if it is no finite number above zero.
    pub fn set_rows(&mut self, rows: f64) -> Result<(), ExcitationError> {
        above_zero("number of torque rows of the experiment", rows, "")?;
        self.objective.rows = Some(rows);
        self.declare()
    }

    /// Takes information as known: b × b per torque row of one period, weighted by the noise of the rows.
    ///
    /// # Errors
    /// [`ExcitationError::PriorSize`] if it is not on the base parameters, [`ExcitationError::NotFinite`] if an entry is no
    /// number.
    pub fn set_prior(&mut self, prior: DMatrix<f64>) -> Result<(), ExcitationError> {
        check_prior(&prior, self.base())?;
        self.objective.prior = Some(prior);
        Ok(())
    }

    /// Takes what earlier experiments have shown as known: their `information` of the base parameters (b × b, Σ of the
    /// inverse covariances), with the `noise` (n) and the number of equations of each joint that the next experiment
    /// will have.
    ///
    /// ```text
    /// M_prior = information / (n · equations)
    /// ```
    /// A row of the criterion and a row of the prior then weigh the same. A criterion that weighs noise against effects expects these
    /// equations.
    ///
    /// # Errors
    /// As [`Self::set_prior`], [`Self::set_noise`] and [`Self::set_rows`].
    pub fn set_collected(
        &mut self,
        information: &DMatrix<f64>,
        noise: &[f64],
        equations: usize,
    ) -> Result<(), ExcitationError> {
        let rows = (self.robot.dof() * equations) as f64;
        let prior = information / rows;
        check_prior(&prior, self.base())?;
        self.set_noise(noise.to_vec())?;
        self.set_rows(rows)?;
        self.set_prior(prior)
    }

    /// The robot, with its limits.
    pub const fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Where the design is sought.
    pub const fn space(&self) -> &DesignSpace {
        &self.space
    }

    /// The space as variables of the search.
    pub const fn basis(&self) -> &MotionBasis {
        &self.basis
    }

    /// What it must hold.
    pub const fn limits(&self) -> &DesignLimits {
        &self.limits
    }

    /// What makes it good.
    pub const fn objective(&self) -> &DesignObjective {
        &self.objective
    }

    /// The base parameters that the joints which move can show.
    pub const fn base(&self) -> &BaseReduction {
        &self.objective.base
    }

    /// How long the search may take.
    pub const fn budget(&self) -> &DesignBudget {
        &self.budget
    }

    /// Samples of one period in the criterion: as many as were asked for, and four for each period of the highest
    /// harmonic at least.
    pub fn samples(&self) -> usize {
        self.objective.samples.max(SAMPLES_PER_HARMONIC * self.space.highest_harmonic())
    }

    /// The first guess number `index` of this problem: `radkhah2007`'s for a Fourier series, else the trajectory of the
    /// family that comes nearest to it. Families share their starts.
    ///
    /// # Errors
    /// [`ExcitationError`] if no joint has a harmonic.
    pub fn start(&self, seed: Seed, index: u64) -> Result<PeriodicTrajectory, ExcitationError> {
        let series = series_start(&self.robot, self.space.period_s, &self.space.harmonics, seed, index)?;
        Ok(self.basis.trajectory(&self.basis.nearest(&series)?))
    }

    /// The segments of the experiment in which limits hold, around a motion of this period (s).
    pub fn timeline(&self, period_s: f64) -> Timeline {
        Timeline { period_s, ramp_s: self.limits.ramp_s }
    }

    /// The efforts by the nominal parameters; `None` without them.
    pub fn efforts(&self) -> Option<EffortModel> {
        let DesignLimits { nominal, spread, .. } = &self.limits;
        nominal.as_ref().map(|nominal| EffortModel::new(&self.robot, nominal, spread.as_ref()))
    }

    /// The efforts with the payload; `None` without nominal parameters or payload.
    pub fn payload_efforts(&self) -> Option<EffortModel> {
        let DesignLimits { nominal, payload, spread, .. } = &self.limits;
        let (mut loaded, payload) = (nominal.clone()?, payload.as_ref()?);
        *loaded.links.last_mut()? += *payload;
        Some(EffortModel::new(&self.robot, &loaded, spread.as_ref()))
    }

    /// The largest uses of torque and current by a motion with the payload, over its period and ramps.
    pub fn payload_use(&self, trajectory: &PeriodicTrajectory) -> Option<WorstEfforts> {
        let (mut model, timeline) = (self.payload_efforts()?, self.timeline(trajectory.period_s()));
        let samples = self.budget.certificate_samples;
        Some(WorstEfforts::compute(&mut model, &Channel::all(&self.robot), trajectory, timeline, samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{CriterionKind, LimitKind, design};

    fn problem(family: Family, evaluations: usize) -> DesignProblem {
        let mut problem =
            DesignProblem::new(chains::crs_a460(), Columns::RIGID, CriterionKind::DOptimal, DesignLimits::motion())
                .unwrap();
        problem.set_space(DesignSpace::new(family, 10.0, vec![5, 5, 5, 3, 3, 3])).unwrap();
        problem.objective.samples = 60;
        problem.set_budget(DesignBudget { evaluations, ..DesignBudget::default() }).unwrap();
        problem
    }

    #[test]
    fn identity_designs_of_every_family_keep_the_limits_and_improve_on_their_start() {
        for family in Family::ALL {
            let problem = problem(family, 60);
            let made = design(&problem, Seed::new(7), 0).unwrap();
            assert!(made.termination.is_feasible(), "{family:?}: {:?}", made.termination);
            let used = made.certificate.worst_limit_use;
            assert!(
                LimitKind::ALL.into_iter().all(|kind| used.for_limit(kind).is_none_or(|ratio| ratio <= 1.0)),
                "{family:?}"
            );
            assert!(made.value > made.history[0].value + 5.0, "{family:?}: {} {}", made.value, made.history[0].value);
            // On a grid of its own, a prime number of samples.
            let states = made.trajectory.sample(4001);
            for (j, joint) in problem.robot().joints().iter().enumerate() {
                for k in 0..states.len() {
                    assert!(states.q(k)[j].abs() <= joint.limits.position.1, "{family:?}");
                    assert!(states.qd(k)[j].abs() <= joint.limits.velocity, "{family:?}");
                    assert!(states.qdd(k)[j].abs() <= joint.limits.acceleration, "{family:?}");
                }
            }
        }
    }

    #[test]
    fn identity_a_frozen_joint_stands_still_and_the_rest_is_excited() {
        let robot = chains::crs_a460();
        let mut problem =
            DesignProblem::new(robot, Columns::RIGID_ROTOR_FRICTION, CriterionKind::DOptimal, DesignLimits::motion())
                .unwrap();
        problem.objective.samples = 60;
        problem.set_budget(DesignBudget { evaluations: 40, ..DesignBudget::default() }).unwrap();
        let all = problem.base().rank();
        let space = problem.space().clone();
        let frozen = vec![None, None, None, Some(0.2), None, Some(-0.1)];
        problem.set_space(DesignSpace { frozen, ..space }).unwrap();
        // The bodies still show in the torque of the joints at rest; their viscous and Coulomb friction does not.
        assert!(problem.base().rank() <= all - 4, "{} of {all}", problem.base().rank());
        assert!(problem.base().names().iter().all(|name| !["Fv4", "Fc4", "Fv6", "Fc6"].contains(&name.as_str())));
        let made = design(&problem, Seed::new(7), 0).unwrap();
        assert!(made.value.is_finite() && made.termination.is_feasible());
        let states = made.trajectory.sample(50);
        assert!((0..50).all(|k| states.q(k)[3] == 0.2 && states.q(k)[5] == -0.1 && states.qd(k)[3] == 0.0));
        let before = problem.space().clone();
        let mut outside = before.clone();
        outside.frozen[3] = Some(9.0);
        let error = problem.set_space(outside).unwrap_err();
        assert!(error.to_string().contains("frozen position of joint"), "{error}");
        assert_eq!(problem.space().frozen, before.frozen);
    }

    #[test]
    fn identity_prior_information_adds_to_that_of_the_trajectory() {
        let mut problem = problem(Family::Fourier, 20);
        let start = problem.start(Seed::new(7), 0).unwrap();
        let noise = [0.3, 0.5, 0.2, 0.1, 0.1, 0.05];
        problem.set_noise(noise.to_vec()).unwrap();
        let m = problem.information(&start).unwrap();
        // 500 equations of each joint: what such an experiment contains in all.
        let alone = problem.clone();
        problem.set_collected(&(&m * (6.0 * 500.0)), &noise, 500).unwrap();
        let prior = problem.objective().prior.as_ref().unwrap().clone();
        assert!((&prior - &m).norm() < 1e-12 * m.norm());
        let mut objective = crate::excitation::InformationObjective::of(&problem, 4.0).unwrap();
        let x = problem.basis().coefficients(&start).unwrap();
        let twice = -objective.exact_at(&x);
        let once = -crate::excitation::InformationObjective::of(&alone, 4.0).unwrap().exact_at(&x);
        // Twice the information: ln det grows by b ln 2.
        assert!((twice - once - m.nrows() as f64 * libm::log(2.0)).abs() < 1e-9, "{once} {twice}");
    }
}
