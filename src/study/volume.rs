//! The log volume of the errors of many runs, without holding the errors of more than some of them.
//!
//! ```text
//! log volume = ½ ln det( Σ_r w_r z_r z_rᵀ / Σ_r w_r )     z_i = e_i / u_i,  w_r how often run r was drawn, 1 of all runs
//! ```
//! Runs are read some at a time, and every draw that is under way takes its share of them; each moment is a sum in the order of
//! the runs, so that neither the number of draws under way nor that of threads changes a bit.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use super::error::StudyError;
use super::estimator_runs::EstimatorRuns;
use super::run_table::{RunNumber, RunTable};
use crate::seed::Seed;
use crate::statistics::{Interval, TwoLayerDraws, percentile_interval};

/// Errors of so many runs are read at a time.
const RUNS_AT_ONCE: usize = 1024;

/// So many counts of draws are held at a time, 4 bytes each.
const COUNTS: usize = 4 << 20;

/// So many draws are under way at most.
const DRAWS: usize = 64;

/// The errors of the runs with one estimator under one condition.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorVolumes<'a> {
    pub(super) runs: &'a dyn RunTable,
    pub(super) condition: usize,
    pub(super) estimator: usize,
    /// Reference units (b).
    pub(super) units: &'a DVector<f64>,
}

/// Designs, and how many runs of each gave an estimate; groups of runs, where these share noise.
pub(super) type Side<'a> = (&'a [usize], &'a [usize]);

/// How often each run that gave an estimate was drawn, by design; `None` is once each.
type Counts = Option<Vec<Vec<u32>>>;

/// A sum of z zᵀ, of which the lower triangle is kept, and of the weights in it.
struct Moment {
    sum: DMatrix<f64>,
    weight: u64,
}

impl ErrorVolumes<'_> {
    /// The log volume over all runs of some designs; `None` where they are no more than there are parameters.
    pub(super) fn value(&self, designs: &[usize]) -> Result<Option<f64>, StudyError> {
        Ok(self.moments(designs, &[None])?[0].log_volume())
    }

    /// Percentile interval by the two-layer bootstrap of a statistic of the log volumes of all sides.
    pub(super) fn interval(
        &self,
        groups: &EstimatorRuns<'_>,
        sides: &[Side<'_>],
        resamples: usize,
        level: f64,
        seed: Seed,
        statistic: impl Fn(&[Option<f64>]) -> Option<f64>,
    ) -> Result<Option<Interval>, StudyError> {
        let sizes: Vec<&[usize]> = sides.iter().map(|side| side.1).collect();
        let runs: usize = sizes.iter().copied().flatten().sum();
        let at_once = (COUNTS / runs.max(1)).clamp(1, DRAWS);
        let mut draws = TwoLayerDraws::new(&sizes, seed);
        let mut values = Vec::with_capacity(resamples);
        let mut left = resamples;
        while left > 0 {
            let count = left.min(at_once);
            left -= count;
            let none = |designs: &[usize]| Some(designs.iter().map(|&d| vec![0_u32; groups.count(d)]).collect());
            let mut counts: Vec<Vec<Counts>> = sides.iter().map(|side| vec![none(side.0); count]).collect();
            for draw in 0..count {
                draws.draw(|side, place, group| {
                    if let Some(counts) = &mut counts[side][draw] {
                        for run in groups.group(sides[side].0[place], group) {
                            counts[place][run] += 1;
                        }
                    }
                });
            }
            let moments = sides
                .iter()
                .zip(&counts)
                .map(|((designs, _), counts)| self.moments(designs, counts))
                .collect::<Result<Vec<_>, _>>()?;
            for draw in 0..count {
                let volumes: Vec<Option<f64>> = moments.iter().map(|of_side| of_side[draw].log_volume()).collect();
                values.extend(statistic(&volumes));
            }
        }
        Ok(percentile_interval(&values, resamples, level))
    }

    /// The moments of the runs of some designs, one for each list of counts.
    fn moments(&self, designs: &[usize], counts: &[Counts]) -> Result<Vec<Moment>, StudyError> {
        let b = self.units.len();
        let mut moments: Vec<Moment> = counts.iter().map(|_| Moment { sum: DMatrix::zeros(b, b), weight: 0 }).collect();
        for (place, &design) in designs.iter().enumerate() {
            let runs = self.runs.runs(design, self.condition);
            // Place of the next run among those that gave an estimate.
            let mut next = 0;
            for from in (0..runs).step_by(RUNS_AT_ONCE) {
                let z = self.errors(design, from..runs.min(from + RUNS_AT_ONCE))?;
                let some = z.len() / b;
                moments.par_iter_mut().zip(counts).for_each(|(moment, counts)| {
                    let weights = counts.as_ref().map(|counts| &counts[place][next..next + some]);
                    for (run, z) in z.chunks_exact(b).enumerate() {
                        moment.add(z, weights.map_or(1, |weights| weights[run]));
                    }
                });
                next += some;
            }
        }
        Ok(moments)
    }

    /// Errors in reference units of the runs that gave an estimate, run by run.
    fn errors(&self, design: usize, range: std::ops::Range<usize>) -> Result<Vec<f64>, StudyError> {
        let (b, estimator) = (self.units.len(), self.estimator);
        let columns = (0..b)
            .map(|parameter| {
                let number = RunNumber::Error { estimator, parameter };
                self.runs.numbers(design, self.condition, range.clone(), number)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut z = Vec::with_capacity(b * range.len());
        for run in 0..columns.first().map_or(0, Vec::len) {
            // A run has all of its errors or none.
            if columns[0][run].is_some() {
                z.extend(columns.iter().zip(self.units).map(|(column, unit)| column[run].unwrap_or(f64::NAN) / unit));
            }
        }
        Ok(z)
    }
}

impl Moment {
    fn add(&mut self, z: &[f64], weight: u32) {
        if weight == 0 {
            return;
        }
        let weighted = f64::from(weight);
        for (j, &second) in z.iter().enumerate() {
            let scaled = weighted * second;
            for (sum, &first) in self.sum.column_mut(j).as_mut_slice()[j..].iter_mut().zip(&z[j..]) {
                *sum += scaled * first;
            }
        }
        self.weight += u64::from(weight);
    }

    fn log_volume(&self) -> Option<f64> {
        if self.weight <= self.sum.nrows() as u64 {
            return None;
        }
        let factor = Cholesky::new(&self.sum / self.weight as f64)?;
        Some(factor.l_dirty().diagonal().iter().map(|&d| libm::log(d)).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::StatusCount;

    /// Errors of the only parameter: condition → run.
    #[derive(Debug)]
    struct Errors([Vec<f64>; 2]);

    impl RunTable for Errors {
        fn runs(&self, _: usize, condition: usize) -> usize {
            self.0[condition].len()
        }

        fn numbers(
            &self,
            _: usize,
            condition: usize,
            range: std::ops::Range<usize>,
            _: RunNumber,
        ) -> Result<Vec<Option<f64>>, StudyError> {
            Ok(self.0[condition][range].iter().copied().map(Some).collect())
        }

        fn statuses(&self, _: usize) -> Vec<StatusCount> {
            Vec::new()
        }
    }

    #[test]
    fn analytic_the_volume_is_that_of_the_errors_under_its_condition() {
        // Mean squares 3 and 10, in units of 2.
        let runs = Errors([vec![1.0, -2.0, 2.0], vec![4.0, 2.0, -2.0, 4.0]]);
        let units = DVector::from_element(1, 2.0);
        for (condition, ratio) in [(0, 0.75), (1, 2.5)] {
            let volumes = ErrorVolumes { runs: &runs, condition, estimator: 0, units: &units };
            let found = volumes.value(&[0]).unwrap().unwrap();
            assert!((found - 0.5 * libm::log(ratio)).abs() < 1e-14, "{condition}: {found}");
        }
    }
}
