//! What a study does: robot, experiment, families of designs, estimators, metrics. The text of `study.toml`.

use super::family_plan::{DesignMethod, FamilyPlan};
use super::grid::GridPlan;
use super::motion_kind::MotionKind;
use super::own_methods::OwnMethods;
use super::plan_error::{StudyPlanError, family_name, name, number};
use super::random_truth::RandomTruths;
use super::variance_reduction::VarianceReduction;
use crate::experiment::{Effects, ExpectedEffectError};
use crate::model::{Columns, DeclaredUncertainty, ReferenceUnits};
use crate::seed::Seed;

/// A whole study. Two runs of one plan give the same bytes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyPlan {
    /// Short name; the folder under `reports/`.
    pub name: String,
    /// The question that the study answers, one sentence.
    pub question: String,
    /// Bundled name of the robot, or path of its file; absent where the text has `robots`.
    #[serde(default)]
    pub robot: String,
    /// Robots on each of which the whole study is done; one plan for each once the text is read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<String>,
    /// Every random number comes from it.
    pub seed: Seed,
    /// Runs of each design, unless its family says otherwise.
    pub runs: usize,
    /// Names of the engines that simulate the arm: every run of every design is performed in each.
    #[serde(default = "default_engines")]
    pub engines: Vec<String>,
    /// The experiment that every design is performed as.
    pub experiment: ExperimentSettings,
    /// How a recording becomes an estimate.
    pub identification: IdentificationSettings,
    /// Where predictions are tested.
    pub validation: ValidationSettings,
    /// Units in which errors of unlike parameters are added.
    pub reference: ReferenceUnits,
    /// Truths that are drawn at random, in place of the robot's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truths: Option<RandomTruths>,
    /// The families of designs that are compared.
    #[serde(rename = "design", default)]
    pub designs: Vec<FamilyPlan>,
    /// What is declared uncertain of the arm, in place of what its robot file declares.
    #[serde(default, skip_serializing_if = "DeclaredUncertainty::is_none")]
    pub uncertainty: DeclaredUncertainty,
    /// Effects of the real arm that every run has, beside those of its truth.
    #[serde(default, skip_serializing_if = "Effects::is_none")]
    pub effects: Effects,
    /// Effects under which every run is done again, one set after the other, with the same random numbers; one
    /// empty set where there are none. The first is what designs are compared under.
    #[serde(default, rename = "conditions", skip_serializing_if = "Vec::is_empty")]
    pub effect_sets: Vec<Effects>,
    /// What the conditions are called, in their order; by their effects where there are no names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub condition_names: Vec<String>,
    /// More families, every combination of what each table lists; part of `designs` once the text is read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub grid: Vec<GridPlan>,
    /// Families that every other is compared with; all pairs where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compare_with: Vec<String>,
    /// Random numbers that runs share.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variance_reduction: Vec<VarianceReduction>,
    /// Whether the claims of `radkhah2007` are evaluated too.
    #[serde(default, rename = "paper_claims", alias = "radkhah2007_claims")]
    pub radkhah2007_claims: bool,
}

/// The experiment of every design.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentSettings {
    /// Period of the excitation, s.
    pub period_s: f64,
    /// Harmonics of each joint's Fourier series.
    pub harmonics: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Recorded periods.
    pub periods: usize,
    /// Periods that are performed and not recorded, so that the motion settles.
    pub discarded_periods: usize,
}

/// How a recording becomes an estimate.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentificationSettings {
    /// What is estimated: `rigid`, `rigid+rotor`, `rigid+rotor+friction`.
    pub columns: String,
    /// `fourier` or `differences`.
    pub derivatives: String,
    /// Samples of the averaged period that the estimators see.
    pub samples_per_period: usize,
    /// Names of estimators; `wls+stribeck` is `wls` with one more term than the columns.
    pub estimators: Vec<String>,
}

/// The motions on which torque predictions are tested; no design and no estimate sees them.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValidationSettings {
    /// How many of each [kind](super::MotionKind).
    pub trajectories: usize,
    /// Samples of each.
    pub samples: usize,
    /// So many motions are performed by the arm of every condition, and what it measures there scores its estimates too.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub measured: usize,
    /// On which kind of motion it is measured: random, slow or point to point.
    #[serde(default, skip_serializing_if = "MotionKind::is_random")]
    pub measured_on: MotionKind,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl StudyPlan {
    /// Checks what the types leave open: names, and numbers that must be positive.
    ///
    /// # Errors
    /// [`StudyPlanError`] with the key, what was found and what was expected.
    pub fn check(&self) -> Result<(), StudyPlanError> {
        self.check_with(&OwnMethods::default())
    }

    /// Reads a plan that may also name methods from outside.
    ///
    /// # Errors
    /// As [`StudyPlan::check`].
    pub fn check_with(&self, own: &OwnMethods) -> Result<(), StudyPlanError> {
        self.check_robot()?;
        self.columns()?;
        if self.identification.estimators.is_empty() {
            return Err(number("identification.estimators", "[]", "at least one name"));
        }
        self.planned_estimators(own)?;
        let counts = [
            ("runs", self.runs),
            ("experiment.harmonics", self.experiment.harmonics),
            ("experiment.periods", self.experiment.periods),
            ("identification.samples_per_period", self.identification.samples_per_period),
            ("validation.trajectories", self.validation.trajectories),
            ("validation.samples", self.validation.samples),
            ("number of [[design]] and [[grid]] tables", self.designs.len()),
        ];
        let family_counts = self
            .designs
            .iter()
            .flat_map(|family| [("design.starts", family.starts), ("design.runs", family.runs.unwrap_or(1))]);
        for (key, found) in counts.into_iter().chain(family_counts) {
            if found == 0 {
                return Err(number(key, found, "at least 1"));
            }
        }
        if self.engines.is_empty() {
            return Err(number("engines", "[]", "at least one name"));
        }
        check_once("engines", &self.engines, String::clone)?;
        check_once("conditions", &self.effect_sets, Effects::to_string)?;
        let (names, sets) = (self.condition_names.len(), self.effect_sets.len());
        if names > 0 && names != sets {
            return Err(number("condition_names", names, "one for each of the conditions, or none"));
        }
        check_once("condition_names", &self.condition_names, String::clone)?;
        let units = &self.reference;
        for (key, found) in [
            ("experiment.period_s", self.experiment.period_s),
            ("experiment.rate_hz", self.experiment.rate_hz),
            ("reference.mass_kg", units.mass_kg),
            ("reference.first_moment_kg_m", units.first_moment_kg_m),
            ("reference.inertia_kg_m2", units.inertia_kg_m2),
            ("reference.viscous_nm_s_rad", units.viscous_nm_s_rad),
            ("reference.torque_nm", units.torque_nm),
        ] {
            if !(found.is_finite() && found > 0.0) {
                return Err(number(key, found, "a finite number above zero"));
            }
        }
        if self.validation.measured_on == MotionKind::Static {
            return Err(moving_kind("validation.measured_on"));
        }
        self.check_truths()?;
        self.check_variance_reduction()?;
        self.check_names_and_sizes()?;
        for family in &self.designs {
            family.family()?;
            if let Some(all) = family.of_starts.filter(|&all| all < family.starts) {
                return Err(number("design.of_starts", all, "at least design.starts"));
            }
            if let Some(found) = family.rms_speed.filter(|most| !(*most > 0.0 && *most <= 1.0)) {
                return Err(number("design.rms_speed", found, "a number above 0 and at most 1"));
            }
            match family.method {
                DesignMethod::Optimised | DesignMethod::Random => {
                    let criterion = family.criterion(own)?;
                    match family.predict {
                        Some(MotionKind::Static) => return Err(moving_kind("design.predict")),
                        Some(_) if !criterion.asks_for_prediction() => {
                            let expected = "one that predicts torque where predict is given, such as i-optimal";
                            return Err(number("design.criterion", criterion.name(), expected));
                        }
                        _ => {}
                    }
                    if let Some((found, _)) =
                        family.expected.iter().find(|(kind, _)| !Effects::EXPECTABLE.contains(kind))
                    {
                        let fault = ExpectedEffectError::NoLaw { found };
                        return Err(super::plan_error::expected(&fault));
                    }
                    if family.evaluations == 0 {
                        return Err(number("design.evaluations", family.evaluations, "at least 1"));
                    }
                }
                DesignMethod::TableOne if family.starts != 1 => {
                    return Err(number("design.starts", family.starts, "1, since a fixed trajectory has one design"));
                }
                DesignMethod::TableOne | DesignMethod::Repeated => {}
            }
        }
        self.check_sequences()?;
        for found in &self.compare_with {
            if !self.designs.iter().any(|family| family.name == *found) {
                return Err(family_name("compare_with", found, self.designs.iter().map(|family| family.name.as_str())));
            }
        }
        Ok(())
    }

    fn check_truths(&self) -> Result<(), StudyPlanError> {
        let Some(truths) = &self.truths else { return Ok(()) };
        if truths.count == 0 {
            return Err(number("truths.count", truths.count, "at least 1"));
        }
        for (key, found) in [
            ("truths.mass_spread", truths.mass_spread),
            ("truths.inertia_spread", truths.inertia_spread),
            ("truths.rotor_spread", truths.rotor_spread),
            ("truths.friction_spread", truths.friction_spread),
        ] {
            // Beyond one, a link's length strays by a factor of e and more.
            if !(0.0..=1.0).contains(&found) {
                return Err(number(key, found, "a number from 0 to 1"));
            }
        }
        let seeds = std::iter::once(&self.effects).chain(&self.effect_sets).map(|effects| effects.seed.value());
        match seeds.into_iter().find(|&seed| truths.draw_effects && seed != 0) {
            Some(found) => {
                Err(number("effects.seed", found, "none, since truths.draw_effects draws one for each truth"))
            }
            None => Ok(()),
        }
    }

    /// Does the plan ask for this way?
    pub fn reduces_variance(&self, way: VarianceReduction) -> bool {
        self.variance_reduction.contains(&way)
    }

    /// How many runs in succession share their noise: 2 where it is antithetic.
    pub fn runs_of_noise(&self) -> usize {
        if self.reduces_variance(VarianceReduction::AntitheticNoise) { 2 } else { 1 }
    }

    fn check_variance_reduction(&self) -> Result<(), StudyPlanError> {
        check_once("variance_reduction", &self.variance_reduction, |way| format!("{way:?}"))?;
        let odd = (0..self.designs.len())
            .map(|family| self.runs_of(family))
            .find(|runs| !runs.is_multiple_of(self.runs_of_noise()));
        let expected = "an even number, since runs with antithetic noise come in pairs";
        odd.map_or(Ok(()), |runs| Err(number("runs", runs, expected)))
    }

    /// Index of the truth in this run of every design: 0 is the robot's own.
    pub fn truth_of(&self, run: u64) -> usize {
        // Runs with opposite noise are on the same arm.
        let unit = if self.reduces_variance(VarianceReduction::AntitheticNoise) { run / 2 } else { run };
        self.truths.as_ref().map_or(0, |truths| 1 + (unit % truths.count as u64) as usize)
    }

    /// Checks the names of engines against those that there are, which are not in the core.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`].
    pub fn check_engines(&self, engines: &[&'static str]) -> Result<(), StudyPlanError> {
        match self.engines.iter().find(|found| !engines.contains(&found.as_str())) {
            Some(found) => Err(name("engines", found, engines.iter().copied())),
            None => Ok(()),
        }
    }

    /// The columns that are estimated.
    ///
    /// # Errors
    /// [`StudyPlanError::Columns`].
    pub fn columns(&self) -> Result<Columns, StudyPlanError> {
        let found = &self.identification.columns;
        let columns = Columns::parse_estimable(found);
        columns.map_err(|fault| StudyPlanError::Columns { found: found.clone(), fault })
    }

    /// Sets the runs of each design, and scales those of families that have a number of their own.
    pub fn scale_runs(&mut self, runs: usize) {
        for family in &mut self.designs {
            family.runs = family.runs.map(|own| (own * runs).div_ceil(self.runs));
        }
        self.runs = runs;
    }

    /// The plan of a study that ended when each family had so many starts, or all of fewer: their runs are those of this one.
    #[must_use]
    pub fn first_starts(&self, starts: usize) -> Self {
        let mut plan = self.clone();
        for family in plan.designs.iter_mut().filter(|family| family.starts > starts) {
            family.of_starts = family.of_starts.or(Some(family.starts));
            family.starts = starts;
        }
        plan
    }

    /// Runs of each design of a family.
    pub fn runs_of(&self, family: usize) -> usize {
        self.designs[family].runs.unwrap_or(self.runs)
    }
}

/// Poses at rest stand where a kind of motion is asked for.
fn moving_kind(key: &'static str) -> StudyPlanError {
    name(key, "static", ["random", "slow", "point-to-point"])
}

/// Nothing stands twice in a list.
fn check_once<T: PartialEq>(key: &'static str, list: &[T], name: impl Fn(&T) -> String) -> Result<(), StudyPlanError> {
    match list.iter().enumerate().find(|(i, one)| list[..*i].contains(one)) {
        Some((_, twice)) => Err(StudyPlanError::Twice { key, found: name(twice) }),
        None => Ok(()),
    }
}

/// A study that names no engine.
fn default_engines() -> Vec<String> {
    vec!["analytic".to_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_of_the_first_starts_knows_how_many_there_were() {
        let plan = StudyPlan::from_toml(include_str!("../../experiments/01-criteria/study.toml")).unwrap();
        assert_eq!(plan.first_starts(8), plan);
        let first = plan.first_starts(3).first_starts(2);
        let starts: Vec<_> = first.designs.iter().map(|family| (family.starts, family.of_starts)).collect();
        assert_eq!(starts, [(2, Some(8)), (2, Some(8)), (2, Some(8)), (2, Some(8)), (1, None)]);
    }

    #[test]
    fn engines_that_there_are_not_are_named() {
        let mut plan = StudyPlan::from_toml(include_str!("../../experiments/01-criteria/study.toml")).unwrap();
        plan.engines = ["analytic", "another"].map(str::to_owned).to_vec();
        assert_eq!(plan.check_engines(&["another", "analytic", "third"]), Ok(()));
        let fault = plan.check_engines(&["analytic", "third"]).unwrap_err().to_string();
        assert!(["another", "analytic", "third"].iter().all(|name| fault.contains(name)), "{fault}");
    }
}
