//! A grid of families of designs: every criterion × family of trajectories × number of harmonics.

use super::family_plan::{DesignMethod, FamilyPlan, HarmonicsPlan};

/// One table `[[grid]]` of a `study.toml`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridPlan {
    /// Names of criteria.
    pub criteria: Vec<String>,
    /// Names of families of trajectories.
    pub families: Vec<String>,
    /// Numbers of harmonics.
    pub harmonics: Vec<usize>,
    /// Number of designs of each combination.
    pub starts: usize,
    /// Evaluations that each design may use.
    pub evaluations: usize,
}

impl GridPlan {
    /// The families of designs of the grid, named `criterion family harmonics`.
    pub(super) fn designs(&self) -> Vec<FamilyPlan> {
        let mut designs = Vec::new();
        for criterion in &self.criteria {
            for family in &self.families {
                for &harmonics in &self.harmonics {
                    designs.push(FamilyPlan {
                        name: format!("{criterion} {family} {harmonics}"),
                        method: DesignMethod::Optimised,
                        criterion: Some(criterion.clone()),
                        family: Some(family.clone()),
                        harmonics: Some(HarmonicsPlan::Every(harmonics)),
                        starts: self.starts,
                        evaluations: self.evaluations,
                        ..FamilyPlan::default()
                    });
                }
            }
        }
        designs
    }
}

#[cfg(test)]
mod tests {
    use crate::study::{DesignMethod, StudyPlan};

    const SEQUENTIAL: &str = include_str!("../../experiments/04-sequential/study.toml");
    const DESIGNS: &str = include_str!("../../experiments/05-designs/study.toml");

    #[test]
    fn identity_a_grid_is_every_combination_and_reads_back_as_designs() {
        let plan = StudyPlan::from_toml(DESIGNS).unwrap();
        assert_eq!(plan.designs.len(), 7 * 4 * 3);
        assert!(plan.designs.iter().all(|family| family.method == DesignMethod::Optimised && family.starts >= 20));
        let text = toml::to_string(&plan).unwrap();
        assert_eq!(StudyPlan::from_toml(&text).unwrap(), plan);
    }

    #[test]
    fn faults_in_chains_and_comparisons_are_named() {
        let plan = StudyPlan::from_toml(SEQUENTIAL).unwrap();
        assert_eq!(StudyPlan::from_toml(&toml::to_string(&plan).unwrap()).unwrap(), plan);
        for (from, to, words) in [
            ("after = \"redesign 2\"", "after = \"redesign 4\"", "after is \"redesign 4\", expected one of"),
            ("compare_with = [\"repeat condition 4\"", "compare_with = [\"nothing\"", "compare_with is \"nothing\""),
            ("making = \"repeated\"\nafter = \"condition 1\"", "making = \"repeated\"", "after is \"\""),
            ("making = \"optimised\"", "making = \"optimised\"\nrms_speed = 2.0", "design.rms_speed is 2, expected"),
            (
                "making = \"optimised\"",
                "making = \"optimised\"\npredict = \"slow\"",
                "design.criterion is condition, expected one that predicts",
            ),
            ("[validation]", "[validation]\nmeasured_on = \"static\"", "validation.measured_on is \"static\""),
            (
                "[experiment]",
                "[truths]\ncount = 2\ndraw_effects = true\n[effects]\nseed = 3\n[experiment]",
                "effects.seed is 3",
            ),
        ] {
            assert!(SEQUENTIAL.contains(from), "{from}");
            let fault = StudyPlan::from_toml(&SEQUENTIAL.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(fault.contains(words), "{fault}");
        }
    }
}
