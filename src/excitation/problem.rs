//! What is asked of a design.

use std::f64::consts::PI;

use nalgebra::DMatrix;
use rand::RngExt;

use super::basis::MotionBasis;
use super::criterion::CriterionKind;
use super::effort::{EffortModel, ParameterSpread};
use super::error::ExcitationError;
use super::margins::Margins;
use super::start::series_start;
use crate::base::{BaseReduction, Method, reduce, reduce_on};
use crate::dynamics::States;
use crate::model::{Columns, Robot, StandardParameters};
use crate::seed::Seed;
use crate::trajectory::{Family, PeriodicTrajectory, Timeline};

/// A design problem: robot, columns, criterion, limits and budget.
///
/// ```
/// use armid::excitation::{CriterionKind, DesignProblem};
/// use armid::model::{Columns, bundled, format::parse_robot};
/// let robot = parse_robot(bundled()[0].robot).unwrap();
/// let problem = DesignProblem::new(robot, Columns::RIGID, CriterionKind::Condition).unwrap();
/// assert_eq!(problem.base.rank(), 36);
/// assert_eq!((problem.period_s, problem.harmonics[0]), (10.0, 5));
/// ```
#[derive(Clone, Debug)]
pub struct DesignProblem {
    /// The robot, with its limits.
    pub robot: Robot,
    /// Which parameters are to be estimated.
    pub columns: Columns,
    /// Their base: the criterion is that of its kept columns.
    pub base: BaseReduction,
    /// What is minimised.
    pub criterion: CriterionKind,
    /// Period T, s.
    pub period_s: f64,
    /// In which family of trajectories it is sought.
    pub family: Family,
    /// Number of harmonics H of each joint, n; splines have 2H + 1 knots.
    pub harmonics: Vec<usize>,
    /// Where joints stand still, rad, n; `None` for those that move. Changed by [`Self::freeze`] alone, as the base is that
    /// of the joints that move.
    frozen: Vec<Option<f64>>,
    /// Samples of one period in the criterion.
    pub samples: usize,
    /// Parameters that torque limits are computed with; without them torque is not limited.
    pub nominal: Option<StandardParameters>,
    /// How far the true parameters may be from the nominal ones, and what the effort limits must leave for that.
    pub spread: Option<ParameterSpread>,
    /// Length of the ramps around the motion, s, in which the limits hold as well; without it only the period counts.
    pub ramp_s: Option<f64>,
    /// Distance to keep between the robot's bodies and from what stands around it, m; not held without it.
    pub clearance_m: Option<f64>,
    /// Which part of each limit may be used.
    pub margins: Margins,
    /// Distance to keep from both position limits of each joint, rad (m), n: where a guard stops the arm.
    pub position_margin: Vec<f64>,
    /// Noise of each joint's torque, N·m (n), for the criteria that weight rows; all 1 without it.
    pub sigma: Option<Vec<f64>>,
    /// Information already collected, b × b per torque row of one period, weighted by the same noise; for the
    /// criteria that weight rows.
    pub prior: Option<DMatrix<f64>>,
    /// Criterion evaluations allowed; a gradient counts as one more.
    pub max_evaluations: usize,
    /// Steps of the optimiser allowed.
    pub max_iterations: usize,
    /// Samples of one period in the certificate.
    pub certificate_samples: usize,
}

/// The least number of random states on which a base of frozen joints is found.
const RANDOM_STATES: usize = 40;

/// Default budget of one design: criterion evaluations, of which a gradient is one more.
pub const DEFAULT_EVALUATIONS: usize = 400;

impl DesignProblem {
    /// `radkhah2007`'s setting: period 10 s, five harmonics, no torque limits.
    ///
    /// # Errors
    /// [`ExcitationError::Base`] if the base parameters cannot be found.
    pub fn new(robot: Robot, columns: Columns, criterion: CriterionKind) -> Result<Self, ExcitationError> {
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0))?;
        let n = robot.dof();
        Ok(Self {
            robot,
            columns,
            base,
            criterion,
            period_s: 10.0,
            family: Family::Fourier,
            harmonics: vec![5; n],
            frozen: vec![None; n],
            samples: 100,
            nominal: None,
            spread: None,
            ramp_s: None,
            clearance_m: None,
            margins: Margins::default(),
            position_margin: vec![0.0; n],
            sigma: None,
            prior: None,
            max_evaluations: DEFAULT_EVALUATIONS,
            max_iterations: usize::MAX,
            certificate_samples: 5000,
        })
    }

    /// Lets joint `index` stand still at `place` (rad). What it no longer reveals is taken out of the base.
    ///
    /// # Errors
    /// [`ExcitationError::FrozenOutside`] if the joint cannot stand there, [`ExcitationError::Base`] if the base parameters
    /// of the remaining motion cannot be found. The problem is then as it was.
    pub fn freeze(&mut self, index: usize, place: f64) -> Result<(), ExcitationError> {
        let joint = &self.robot.joints()[index];
        let range = joint.limits.position;
        if !(place >= range.0 && place <= range.1) {
            return Err(ExcitationError::FrozenOutside { joint: joint.name.clone(), found: place, range });
        }
        let mut frozen = self.frozen.clone();
        frozen[index] = Some(place);
        let states = self.random_states(&frozen);
        self.base = reduce_on(&self.robot, self.columns, Method::Qr, &states)?;
        self.frozen = frozen;
        Ok(())
    }

    /// Where joints stand still, rad, n; `None` for those that move.
    #[must_use]
    pub fn frozen(&self) -> &[Option<f64>] {
        &self.frozen
    }

    /// Takes what earlier experiments have shown as known: their `information` of the base parameters (b × b, Σ of the
    /// inverse covariances), with the `noise` (n) and the number of equations of each joint that the next experiment
    /// will have.
    ///
    /// ```text
    /// M_prior = information / (n · equations)
    /// ```
    /// A row of the criterion and a row of the prior then weigh the same.
    pub fn set_prior(&mut self, information: &DMatrix<f64>, noise: &[f64], equations: usize) {
        let rows = (self.robot.dof() * equations) as f64;
        self.prior = Some(information / rows);
        self.sigma = Some(noise.to_vec());
    }

    /// Random states of the joints that move, the others where they stand.
    fn random_states(&self, frozen: &[Option<f64>]) -> States {
        let n = self.robot.dof();
        let count = RANDOM_STATES.max(3 * self.base.parameters.len() / n);
        let mut rng = Seed::new(0).stream("frozen joints", 0);
        let mut states = States::new(n);
        for _ in 0..count {
            let mut draw = |still: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> {
                (0..n).map(|j| (rng.random_range(-PI..PI), still(j))).map(|(x, still)| still.unwrap_or(x)).collect()
            };
            let resting = |j: usize| frozen[j].map(|_| 0.0);
            let (q, qd, qdd) = (draw(&|j| frozen[j]), draw(&resting), draw(&resting));
            // Rates at which the arm's own motion weighs as much as gravity.
            let (qd, qdd) =
                (qd.iter().map(|x| 2.0 * x).collect::<Vec<_>>(), qdd.iter().map(|x| 5.0 * x).collect::<Vec<_>>());
            states.push(&q, &qd, &qdd);
        }
        states
    }

    /// The first guess number `index` of this problem: `radkhah2007`'s for a Fourier series, else the trajectory of the
    /// family that comes nearest to it. Families share their starts.
    ///
    /// # Errors
    /// [`ExcitationError`] if the settings are impossible.
    pub fn start(&self, seed: Seed, index: u64) -> Result<PeriodicTrajectory, ExcitationError> {
        let basis = self.basis()?;
        let series = series_start(&self.robot, self.period_s, &self.harmonics, seed, index)?;
        Ok(basis.trajectory(&basis.nearest(&series)?))
    }

    /// Position, among the kept columns, of those that belong to rigid bodies.
    #[must_use]
    pub fn rigid_positions(&self) -> Vec<usize> {
        let rigid = |&(_, &column): &(usize, &usize)| self.base.parameters[column].kind.term().is_none();
        self.base.kept.iter().enumerate().filter(rigid).map(|(position, _)| position).collect()
    }

    /// The segments of the experiment in which limits hold, around a motion of this period (s).
    #[must_use]
    pub fn timeline(&self, period_s: f64) -> Timeline {
        Timeline { period_s, ramp_s: self.ramp_s }
    }

    /// The efforts by the nominal parameters; `None` without them.
    #[must_use]
    pub fn efforts(&self) -> Option<EffortModel> {
        self.nominal.as_ref().map(|nominal| EffortModel::new(&self.robot, nominal, self.spread.as_ref()))
    }

    /// Noise of each joint for the rows of the criterion: all 1 where it does not weight them.
    pub(crate) fn row_noise(&self) -> Vec<f64> {
        match &self.sigma {
            Some(sigma) if self.criterion.is_weighted() => sigma.clone(),
            _ => vec![1.0; self.robot.dof()],
        }
    }

    /// The robot with limits that keep [`Self::position_margin`] from its own.
    pub(crate) fn inner_robot(&self) -> Result<Robot, ExcitationError> {
        let mut margins = self.position_margin.iter();
        let inner = self.robot.clone().with_joints(|joint| {
            if let Some(margin) = margins.next().filter(|margin| **margin != 0.0) {
                let (low, high) = joint.limits.position;
                joint.limits.position = (low + margin, high - margin);
            }
        });
        inner.map_err(ExcitationError::PositionMargin)
    }

    /// Checks the settings and makes the family of trajectories.
    pub(crate) fn basis(&self) -> Result<MotionBasis, ExcitationError> {
        let n = self.robot.dof();
        let least = 4 * self.harmonics.iter().copied().max().unwrap_or(0);
        if self.samples < least {
            // Four for each period of the highest harmonic.
            return Err(ExcitationError::TooFew { quantity: "samples", found: self.samples, least });
        }
        let above_zero = |quantity, found: f64, unit| {
            let holds = found.is_finite() && found > 0.0;
            if holds { Ok(()) } else { Err(ExcitationError::NotPositive { quantity, found, unit }) }
        };
        let length = |quantity, found, expected| {
            if found == expected { Ok(()) } else { Err(ExcitationError::Length { quantity, found, expected }) }
        };
        above_zero("part of the position range", self.margins.position, "")?;
        above_zero("part of the speed limit", self.margins.velocity, "")?;
        above_zero("part of the acceleration limit", self.margins.acceleration, "")?;
        above_zero("part of the torque rating", self.margins.torque, "")?;
        length("position margins", self.position_margin.len(), n)?;
        if let Some(sigma) = &self.sigma {
            length("noise levels", sigma.len(), n)?;
            for &level in sigma {
                above_zero("a noise level", level, "N·m")?;
            }
        }
        if let Some(prior) = &self.prior {
            let (expected, (rows, columns)) = (self.base.rank(), prior.shape());
            if (rows, columns) != (expected, expected) {
                return Err(ExcitationError::PriorSize { rows, columns, expected });
            }
        }
        if let Some(nominal) = &self.nominal {
            length("nominal links", nominal.links.len(), n)?;
        }
        if let Some(spread) = &self.spread {
            // As many as the effort model has, which takes in what terms the nominal parameters have.
            let columns =
                self.nominal.as_ref().map_or_else(Columns::default, |set| Columns::default().and_those_of(set));
            length("uncertain parameters", spread.deviations.len(), columns.parameters(&self.robot).len())?;
        }
        if let Some(ramp) = self.ramp_s {
            above_zero("length of the ramps", ramp, "s")?;
        }
        if let Some(found) = self.clearance_m.filter(|clearance| !clearance.is_finite()) {
            return Err(ExcitationError::NotFinite { quantity: "clearance", found, unit: "m" });
        }
        if self.max_evaluations == 0 {
            return Err(ExcitationError::TooFew { quantity: "evaluations", found: 0, least: 1 });
        }
        MotionBasis::new(&self.robot, self.family, self.period_s, &self.harmonics, &self.frozen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{design, fixtures};

    fn problem(family: Family, evaluations: usize) -> DesignProblem {
        let mut problem = DesignProblem::new(fixtures::crs_a460(), Columns::RIGID, CriterionKind::DOptimal).unwrap();
        problem.family = family;
        problem.harmonics = vec![5, 5, 5, 3, 3, 3];
        problem.samples = 60;
        problem.max_evaluations = evaluations;
        problem
    }

    #[test]
    fn identity_designs_of_every_family_keep_the_limits_and_improve_on_their_start() {
        for family in Family::ALL {
            let problem = problem(family, 60);
            let made = design(&problem, Seed::new(7), 0).unwrap();
            assert!(made.termination.is_feasible(), "{family:?}: {:?}", made.termination);
            assert!(made.certificate.worst_limit_use.largest() <= 1.0, "{family:?}");
            assert!(made.value > made.history[0].value + 5.0, "{family:?}: {} {}", made.value, made.history[0].value);
            // On a grid of its own, a prime number of samples.
            let states = made.trajectory.sample(4001);
            for (j, joint) in problem.robot.joints().iter().enumerate() {
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
        let robot = fixtures::crs_a460();
        let mut problem = DesignProblem::new(robot, Columns::RIGID_ROTOR_FRICTION, CriterionKind::DOptimal).unwrap();
        (problem.samples, problem.max_evaluations) = (60, 40);
        let all = problem.base.rank();
        problem.freeze(3, 0.2).unwrap();
        problem.freeze(5, -0.1).unwrap();
        // The bodies still show in the torque of the joints at rest; their viscous and Coulomb friction does not.
        assert!(problem.base.rank() <= all - 4, "{} of {all}", problem.base.rank());
        assert!(problem.base.names().iter().all(|name| !["Fv4", "Fc4", "Fv6", "Fc6"].contains(&name.as_str())));
        let made = design(&problem, Seed::new(7), 0).unwrap();
        assert!(made.value.is_finite() && made.termination.is_feasible());
        let states = made.trajectory.sample(50);
        assert!((0..50).all(|k| states.q(k)[3] == 0.2 && states.q(k)[5] == -0.1 && states.qd(k)[3] == 0.0));
        let error = problem.freeze(3, 9.0).unwrap_err();
        assert!(error.to_string().contains("frozen position of joint"), "{error}");
        assert_eq!(problem.frozen()[3], Some(0.2));
    }

    #[test]
    fn identity_prior_information_adds_to_that_of_the_trajectory() {
        let mut problem = problem(Family::Fourier, 20);
        let start = problem.start(Seed::new(7), 0).unwrap();
        let noise = [0.3, 0.5, 0.2, 0.1, 0.1, 0.05];
        problem.sigma = Some(noise.to_vec());
        let m = problem.information(&start).unwrap();
        // 500 equations of each joint: the information of the whole experiment.
        problem.set_prior(&(&m * (6.0 * 500.0)), &noise, 500);
        let prior = problem.prior.clone().unwrap();
        assert!((&prior - &m).norm() < 1e-12 * m.norm());
        let mut objective = crate::excitation::InformationObjective::of(&problem, 4.0).unwrap();
        let x = problem.basis().unwrap().coefficients(&start).unwrap();
        let twice = -objective.exact_at(&x);
        problem.prior = None;
        let once = -crate::excitation::InformationObjective::of(&problem, 4.0).unwrap().exact_at(&x);
        // Twice the information: ln det grows by b ln 2.
        assert!((twice - once - m.nrows() as f64 * libm::log(2.0)).abs() < 1e-9, "{once} {twice}");
    }
}
