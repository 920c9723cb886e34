//! The designs of a study: one trajectory per family and start, with its certificate and how it was found.

use std::sync::Arc;

use super::error::StudyError;
use super::family_plan::{DesignMethod, HarmonicsPlan};
use super::motions_to_predict::motions_to_predict;
use super::plan_error;
use super::radkhah2007::table_one;
use super::setup::StudySetup;
use super::shared_start::SharedStart;
use super::variance_reduction::VarianceReduction;
use crate::excitation::{
    Certificate, Criterion, CriterionKind, Design, DesignBudget, DesignLimits, DesignProblem, DesignSpace,
    ExcitationError, ExpectedEffects, HistoryPoint, Termination, design, random_design,
};
use crate::observer::Observer;
use crate::trajectory::{Family, PeriodicTrajectory};

/// One design of a study.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StudyDesign {
    /// Index of its family.
    pub family: usize,
    /// Number of its start within the family.
    pub start: usize,
    /// The trajectory.
    pub trajectory: PeriodicTrajectory,
    /// Name of the criterion that it was optimised for or chosen by; `None` for a fixed trajectory.
    pub criterion: Option<String>,
    /// Its criterion values and its use of each limit.
    pub certificate: Certificate,
    /// Evaluations of the criterion that were spent.
    pub evaluations: usize,
    /// Steps of the optimiser, or draws.
    pub iterations: usize,
    /// How the optimisation ended; `None` for a fixed trajectory.
    pub termination: Option<Termination>,
    /// The criterion value over the iterations.
    pub history: Vec<HistoryPoint>,
}

impl StudyDesign {
    /// The values that may predict the error of a design, all of the columns that are estimated; smaller is better.
    pub fn values(&self) -> Vec<(&'static str, f64)> {
        let smallest = self.certificate.spectrum.first().copied().unwrap_or(0.0);
        vec![
            ("condition", self.certificate.condition_all),
            ("condition-scaled", self.certificate.condition_scaled_all),
            ("d-optimal", -self.certificate.log_det_information_all),
            ("a-optimal", self.certificate.deviations.iter().map(|deviation| deviation * deviation).sum()),
            ("e-optimal", -smallest),
            ("condition-plus-sigma", self.certificate.condition_all + 1.0 / smallest.sqrt()),
            ("condition-plus-d", self.certificate.condition_all - self.certificate.log_det_information_all),
        ]
    }

    /// The value by which the design was made, smaller is better; the condition number of a fixed trajectory. Of a
    /// criterion that a certificate does not state, that of the optimiser.
    pub fn own_value(&self) -> f64 {
        let criterion = self.criterion.as_deref().unwrap_or(CriterionKind::Condition.name());
        let stated = self.values().iter().find(|(value, _)| *value == criterion).map(|(_, value)| *value);
        // Every criterion of which more is better is stated; all others are reported as they are minimised.
        stated.or_else(|| self.history.last().map(|last| last.value)).unwrap_or(f64::INFINITY)
    }

    fn of(family: usize, start: usize, design: Design) -> Self {
        Self {
            family,
            start,
            trajectory: design.trajectory,
            criterion: Some(design.criterion),
            certificate: design.certificate,
            evaluations: design.evaluations,
            iterations: design.iterations,
            termination: Some(design.termination),
            history: design.history,
        }
    }
}

impl StudySetup {
    /// Where the search of design `start` of a family began.
    pub(super) fn shared_start(&self, family: usize, start: usize) -> SharedStart {
        let sequence = self.families_of_sequence(family);
        let has = |method| sequence.iter().any(|&of| self.plan.designs[of].method == method);
        if self.plan.reduces_variance(VarianceReduction::CommonNoise) || has(DesignMethod::Optimised) {
            SharedStart::Guess(start)
        } else if has(DesignMethod::Random) {
            SharedStart::Draws(start)
        } else {
            SharedStart::Fixed
        }
    }

    /// The designs of number `start` of all families of a sequence, from the first experiment to `family` itself. Families share
    /// their starts: start k of every family is the same first guess. An observer may end their searches: they are then not those of the study.
    ///
    /// # Errors
    /// [`StudyError`] where the settings are impossible for the robot.
    pub fn designs_of_sequence(
        &self,
        family: usize,
        start: usize,
        observer: &dyn Observer,
    ) -> Result<Vec<StudyDesign>, StudyError> {
        let mut made: Vec<StudyDesign> = Vec::new();
        for next in self.families_of_sequence(family) {
            let design = self.design_after(next, start, &made, observer)?;
            made.push(design);
        }
        Ok(made)
    }

    /// One design of one family, after those of the families that it continues.
    fn design_after(
        &self,
        family: usize,
        start: usize,
        before: &[StudyDesign],
        observer: &dyn Observer,
    ) -> Result<StudyDesign, StudyError> {
        let plan = &self.plan.designs[family];
        let seed = self.plan.seed.child("design", 0);
        let index = start as u64;
        match plan.method {
            DesignMethod::Optimised => {
                let problem = self.problem_of(family, before)?;
                let made = design(problem.watched_by(observer), seed, index)?;
                Ok(StudyDesign::of(family, start, made))
            }
            DesignMethod::Random => {
                let problem = self.problem_of(family, before)?;
                let made = random_design(problem.watched_by(observer), seed, index)?;
                Ok(StudyDesign::of(family, start, made))
            }
            DesignMethod::Repeated => {
                let made = before.last().expect("the plan has been checked").clone();
                Ok(StudyDesign { family, evaluations: 0, iterations: 0, history: Vec::new(), ..made })
            }
            DesignMethod::TableOne => {
                let trajectory = table_one::corrected().into();
                let certificate = Certificate::new(&self.problem(CriterionKind::Condition.into(), 1)?, &trajectory)?;
                Ok(StudyDesign {
                    family,
                    start,
                    trajectory,
                    criterion: None,
                    certificate,
                    evaluations: 0,
                    iterations: 0,
                    termination: None,
                    history: Vec::new(),
                })
            }
        }
    }

    /// The design problem of a family whose experiment follows those of the designs `before`.
    fn problem_of(&self, family: usize, before: &[StudyDesign]) -> Result<DesignProblem, StudyError> {
        let plan = &self.plan.designs[family];
        let criterion = plan.criterion(&self.own)?;
        let (expected, is_measured) = (plan.expected_effects(&*criterion), criterion.predicts_measured_torque());
        let expects_effects = criterion.expects_effects();
        let mut problem = self.problem(criterion, plan.evaluations)?;
        let harmonics = match &plan.harmonics {
            Some(HarmonicsPlan::Every(harmonics)) => vec![*harmonics; self.robot.dof()],
            Some(HarmonicsPlan::Each(harmonics)) => harmonics.clone(),
            None => problem.space().harmonics.clone(),
        };
        let mut space = DesignSpace::new(plan.family()?, self.plan.experiment.period_s, harmonics);
        for (found, place) in &plan.freeze {
            let names: Vec<&str> = self.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
            let index = names
                .iter()
                .position(|known| known == found)
                .ok_or_else(|| plan_error::name("design.freeze", found, names.iter().copied()))?;
            space.frozen[index] = Some(*place);
        }
        problem.set_space(space)?;
        if let Some(most) = plan.rms_speed {
            problem.set_limits(DesignLimits { rms_speed: Some(most), ..problem.limits().clone() })?;
        }
        if expects_effects {
            let expected = expected.expected(&self.robot, &self.nominal);
            let expected = expected.map_err(|fault| plan_error::expected(&fault))?;
            problem.set_expected(ExpectedEffects { are_carried: is_measured, ..expected })?;
        }
        if let Some(kind) = plan.predict {
            let motions = motions_to_predict(kind, &self.robot, &self.nominal, &self.plan.experiment, self.plan.seed)?;
            problem.set_evaluation(motions)?;
        }
        if let Some(prior) = self.collected(before)? {
            problem.set_prior(prior)?;
        }
        Ok(problem)
    }

    /// The design problem of a criterion: the columns that are estimated, all limits of the robot, the noise of its
    /// sensors, the torque of the nominal parameters.
    pub(super) fn problem(
        &self,
        criterion: Arc<dyn Criterion>,
        evaluations: usize,
    ) -> Result<DesignProblem, ExcitationError> {
        let sigma = (0..self.robot.dof()).map(|j| self.noise[(j, j)].sqrt()).collect();
        let limits = DesignLimits { nominal: Some(self.nominal.clone()), ..DesignLimits::motion() };
        let mut problem = DesignProblem::new(self.robot.clone(), self.regressor.columns(), criterion, limits)?;
        let experiment = &self.plan.experiment;
        let harmonics = vec![experiment.harmonics; self.robot.dof()];
        problem.set_space(DesignSpace::new(Family::Fourier, experiment.period_s, harmonics))?;
        problem.set_noise(sigma)?;
        problem.set_budget(DesignBudget { evaluations, ..DesignBudget::default() })?;
        problem.set_reference_units(self.plan.reference.clone());
        problem.set_rows(self.robot.dof() as f64 * self.raw_samples() * experiment.periods as f64)?;
        Ok(problem)
    }
}
