//! Estimators against each other on the same recordings.
//!
//! ```text
//! d_r = ln( error of one estimator / error of the reference )      run r, both from the same recording
//! ratio exp( mean d ), interval exp( mean d ± t s / √K )           over K units
//! ```
//! Units are designs where a family has at least two, each with the mean of its runs, else the runs; runs that share their noise
//! count as one. A run counts where both estimators gave an estimate: how often one of them did not stands beside it.

use super::error::StudyError;
use super::evidence::{Evidence, LEVEL, present};
use super::metric::Metric;
use super::run_table::RunNumber;
use crate::statistics::{Interval, mean, t_interval};

/// An estimator against the last of the plan that gave an estimate, which figures show, over a family of designs, in one metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EstimatorComparison {
    /// By what.
    pub metric: Metric,
    /// Name of the family.
    pub family: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the one that it is compared with.
    pub reference: String,
    /// Runs in which both gave an estimate.
    pub runs: usize,
    /// Runs in which the reference did and this one did not.
    pub failures: usize,
    /// Its error over that of the reference, geometric mean over units. Below 1: it is better.
    pub ratio: f64,
    /// Its 95 % interval; `None` of one unit.
    pub interval: Option<Interval>,
}

impl Evidence<'_> {
    /// Every estimator against the reference, family by family, in each metric of single runs that the arm was asked for.
    ///
    /// # Errors
    /// [`StudyError::Runs`] where the numbers of the runs cannot be read.
    pub(super) fn estimator_comparisons(&self) -> Result<Vec<EstimatorComparison>, StudyError> {
        let mut comparisons = Vec::new();
        let Some(reference) = self.reference_estimator()? else { return Ok(comparisons) };
        for family in 0..self.families.len() {
            for metric in Metric::ALL.into_iter().filter(|metric| !metric.is_logarithmic()) {
                for estimator in (0..self.estimators.len()).filter(|&estimator| estimator != reference) {
                    comparisons.extend(self.estimator_comparison(family, metric, [estimator, reference])?);
                }
            }
        }
        Ok(comparisons)
    }

    /// The last of the plan that gave an estimate in any run.
    fn reference_estimator(&self) -> Result<Option<usize>, StudyError> {
        for estimator in (0..self.estimators.len()).rev() {
            for design in 0..self.designs.len() {
                let number = RunNumber::Metric { estimator, metric: Metric::Prediction };
                if self.numbers(design, number)?.iter().any(Option::is_some) {
                    return Ok(Some(estimator));
                }
            }
        }
        Ok(None)
    }

    /// `None` where no run has both.
    fn estimator_comparison(
        &self,
        family: usize,
        metric: Metric,
        [estimator, reference]: [usize; 2],
    ) -> Result<Option<EstimatorComparison>, StudyError> {
        let (mut of_designs, mut runs, mut failures) = (Vec::new(), 0, 0);
        for design in self.designs_of(family) {
            let values = |estimator| self.numbers(design, RunNumber::Metric { estimator, metric });
            let (known, others) = (values(reference)?, values(estimator)?);
            let logs: Vec<Option<f64>> =
                known.iter().zip(&others).map(|(one, other)| Some(libm::log((*other)? / (*one)?))).collect();
            runs += logs.iter().flatten().count();
            failures += known.iter().zip(&others).filter(|(one, other)| one.is_some() && other.is_none()).count();
            let of_groups: Vec<f64> = logs
                .chunks(self.runs_of_noise)
                .map(present)
                .filter(|of_group| !of_group.is_empty())
                .map(|of_group| mean(&of_group))
                .collect();
            if !of_groups.is_empty() {
                of_designs.push(of_groups);
            }
        }
        let means: Vec<f64> = of_designs.iter().map(|of_groups| mean(of_groups)).collect();
        let units = if means.len() > 1 { means } else { of_designs.concat() };
        if units.is_empty() {
            return Ok(None);
        }
        Ok(Some(EstimatorComparison {
            metric,
            family: self.families[family].clone(),
            estimator: self.estimators[estimator].clone(),
            reference: self.estimators[reference].clone(),
            runs,
            failures,
            ratio: libm::exp(mean(&units)),
            interval: t_interval(&units, LEVEL).map(Interval::exponentiated),
        }))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::seed::Seed;
    use crate::study::{DesignRow, RunTable, SharedStart, StatusCount};

    /// Prediction errors: design → reference, which is the last of the plan, and another → run.
    #[derive(Debug)]
    struct Errors(Vec<[Vec<Option<f64>>; 2]>);

    impl RunTable for Errors {
        fn runs(&self, design: usize, _: usize) -> usize {
            self.0[design][0].len()
        }

        fn numbers(
            &self,
            design: usize,
            _: usize,
            range: std::ops::Range<usize>,
            number: RunNumber,
        ) -> Result<Vec<Option<f64>>, StudyError> {
            match number {
                RunNumber::Metric { estimator, metric: Metric::Prediction } => {
                    Ok(self.0[design][1 - estimator][range].to_vec())
                }
                _ => Ok(vec![None; range.len()]),
            }
        }

        fn statuses(&self, _: usize) -> Vec<StatusCount> {
            Vec::new()
        }
    }

    fn compared(errors: Errors, runs_of_noise: usize) -> EstimatorComparison {
        let (families, estimators) = (["one".to_owned()], ["wls", "ols"].map(str::to_owned));
        let designs =
            vec![DesignRow { family: 0, start: SharedStart::Fixed, bound_std: &[1.0], values: &[] }; errors.0.len()];
        let units = DVector::from_element(1, 1.0);
        let evidence = Evidence {
            families: &families,
            compare_with: &[],
            designs: &designs,
            estimators: &estimators,
            truths: 0,
            units: &units,
            runs: &errors,
            condition: 0,
            runs_of_noise,
            runs_are_matched: false,
            draws_effects: false,
            seed: Seed::new(1),
        };
        let mut found = evidence.estimator_comparisons().unwrap();
        assert_eq!(found.len(), 1);
        found.remove(0)
    }

    #[test]
    fn analytic_runs_of_one_design_are_pairs_and_failures_are_counted() {
        // Ratios 1/2, 1/4 and 1: geometric mean 1/2; the t interval of three logarithms whose deviation is ln 2.
        let first = vec![Some(2.0), Some(4.0), None, Some(8.0), Some(1.0)];
        let second = vec![Some(1.0), Some(1.0), Some(1.0), Some(8.0), None];
        let found = compared(Errors(vec![[first, second]]), 1);
        assert_eq!((found.runs, found.failures), (3, 1));
        assert!((found.ratio - 0.5).abs() < 1e-15);
        let half = 4.302_652_729_911_275 * std::f64::consts::LN_2 / 3.0_f64.sqrt();
        let interval = found.interval.unwrap();
        assert!((interval.high / (0.5 * half.exp()) - 1.0).abs() < 1e-9, "{interval:?}");
    }

    #[test]
    fn analytic_designs_are_the_units_where_there_are_several() {
        let of = |ratio: f64| [vec![Some(1.0); 4], vec![Some(ratio); 4]];
        let found = compared(Errors(vec![of(2.0), of(8.0)]), 1);
        assert!((found.ratio - 4.0).abs() < 1e-14);
        let half = 12.706_204_736_174_7 * std::f64::consts::LN_2;
        assert!((found.interval.unwrap().high / (4.0 * half.exp()) - 1.0).abs() < 1e-9);
        // Pairs of one design with a common noise are two units, not four.
        let found = compared(Errors(vec![[vec![Some(1.0); 4], vec![Some(2.0), Some(2.0), Some(8.0), Some(8.0)]]]), 2);
        assert!((found.interval.unwrap().high / (4.0 * half.exp()) - 1.0).abs() < 1e-9);
    }
}
