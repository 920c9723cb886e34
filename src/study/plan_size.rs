//! How much a plan asks for, and by which names: checked before work begins.

use super::family_plan::HarmonicsPlan;
use super::plan::StudyPlan;
use super::plan_error::StudyPlanError;
use crate::input::check_file_name;
use crate::input::size::{
    DESIGNS, HARMONICS, HELD_SAMPLES, PERIOD_S, PERIOD_SAMPLES, RATE_HZ, RUNS, TRUTHS, VALIDATION_SAMPLES,
};

impl StudyPlan {
    /// Checks that names stay inside their folder, each family has its own, and sizes are inside [`crate::input::size`].
    pub(super) fn check_names_and_sizes(&self) -> Result<(), StudyPlanError> {
        check_file_name("name", &self.name)?;
        for (i, family) in self.designs.iter().enumerate() {
            check_file_name("design.name", &family.name)?;
            if self.designs[..i].iter().any(|other| other.name == family.name) {
                return Err(StudyPlanError::Twice { key: "design.name", found: family.name.clone() });
            }
            match &family.harmonics {
                Some(HarmonicsPlan::Every(every)) => HARMONICS.check_count("design.harmonics", *every)?,
                Some(HarmonicsPlan::Each(each)) => {
                    each.iter().try_for_each(|&one| HARMONICS.check_count("design.harmonics", one))?;
                }
                None => {}
            }
        }
        let settings = &self.experiment;
        HARMONICS.check_count("experiment.harmonics", settings.harmonics)?;
        PERIOD_S.check("experiment.period_s", settings.period_s)?;
        RATE_HZ.check("experiment.rate_hz", settings.rate_hz)?;
        let period = settings.period_s * settings.rate_hz;
        PERIOD_SAMPLES.check("experiment.period_s by rate_hz", period)?;
        let periods = settings.periods as f64 + settings.discarded_periods as f64;
        HELD_SAMPLES.check("experiment.periods by samples of one", periods * period)?;
        PERIOD_SAMPLES.check_count("identification.samples_per_period", self.identification.samples_per_period)?;
        let validation = &self.validation;
        let samples = validation.trajectories as f64 * validation.samples as f64;
        VALIDATION_SAMPLES.check("validation.samples by trajectories", samples)?;
        if let Some(truths) = &self.truths {
            TRUTHS.check_count("truths.count", truths.count)?;
        }
        DESIGNS.check("design.starts, all together", self.designs.iter().map(|family| family.starts as f64).sum())?;
        let conditions = self.engines.len() as f64 * self.effect_sets.len().max(1) as f64;
        for family in &self.designs {
            DESIGNS.check_count("design.of_starts", family.of_starts.unwrap_or(1))?;
        }
        let runs = |family: usize| self.designs[family].starts as f64 * self.runs_of(family) as f64;
        let runs: f64 = (0..self.designs.len()).map(runs).sum();
        RUNS.check("runs of all designs under all conditions", runs * conditions)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::study::{RandomTruths, StudyPlan};

    const PLAN: &str = include_str!("../../experiments/01-criteria/study.toml");

    #[test]
    fn what_is_too_much_is_refused_with_its_line_and_limit() {
        for (key, value, words) in [
            ("runs", "1_000_000_000_000", "runs of all designs under all conditions is"),
            ("period_s", "1e9", "experiment.period_s is 1000000000 s, expected at most 100000 s"),
            ("rate_hz", "1e9", "experiment.rate_hz is 1000000000 Hz, expected at most 100000 Hz"),
            ("harmonics", "100_000", "experiment.harmonics is 100000, expected at most 200"),
            ("periods", "1_000_000", "experiment.periods by samples of one is"),
            ("samples_per_period", "1_000_000_000_000", "identification.samples_per_period is"),
            ("trajectories", "1_000_000_000", "validation.samples by trajectories is"),
            ("samples", "1_000_000_000", "validation.samples by trajectories is"),
            ("starts", "1_000_000_000", "design.starts, all together is"),
            ("name", "\"../../x\"", "name is \"../../x\", expected a name that a file can have"),
            ("estimators", "[]", "identification.estimators is [], expected at least one name"),
        ] {
            let mut lines: Vec<String> = PLAN.lines().map(str::to_owned).collect();
            let keyed = |line: &&mut String| line.split('=').next().is_some_and(|found| found.trim() == key);
            let line = lines.iter_mut().find(keyed).unwrap_or_else(|| panic!("{key} is not in the plan"));
            *line = format!("{key} = {value}");
            let fault = StudyPlan::from_toml(&lines.join("\n")).unwrap_err();
            assert!(fault.message.contains(words), "{key}: {fault}");
        }
    }

    #[test]
    fn families_stay_in_their_folder_and_have_names_of_their_own() {
        let plan = StudyPlan::from_toml(PLAN).unwrap();
        let mut outside = plan.clone();
        outside.designs[1].name = "../x".to_owned();
        assert!(outside.check().unwrap_err().to_string().starts_with("design.name is \"../x\""));
        let mut twice = plan;
        twice.designs[1].name = twice.designs[0].name.clone();
        assert!(twice.check().unwrap_err().to_string().contains("twice"));
    }

    #[test]
    fn spreads_of_truths_are_from_zero_to_one() {
        let with = |mass_spread| {
            let truths = Some(RandomTruths { mass_spread, ..RandomTruths::new(2) });
            StudyPlan { truths, ..StudyPlan::from_toml(PLAN).unwrap() }.check()
        };
        assert!(with(0.3).is_ok());
        assert!(with(1.1).unwrap_err().to_string().contains("truths.mass_spread is 1.1"));
    }
}
