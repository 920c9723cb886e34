//! Sequences of experiments: a later experiment adds its information to that of the earlier ones.
//!
//! ```text
//! M = Σ_k C_k⁻¹        β̂ = M⁻¹ Σ_k C_k⁻¹ β̂_k        C_k covariance of the estimate of experiment k
//! ```
//! A family of designs that names another in `after` continues it: its designs have the information of that family's
//! designs as their prior, and its runs combine the estimates of all experiments of the sequence. For Gaussian noise
//! and a linear model the sum loses nothing against one fit of all data.

use nalgebra::{DMatrix, DVector};

use super::design::StudyDesign;
use super::error::StudyError;
use super::family_plan::DesignMethod;
use super::measured_motion::MeasuredMotions;
use super::outcome::{Outcome, ScoredEstimate};
use super::performed::Performed;
use super::plan::StudyPlan;
use super::plan_error::{StudyPlanError, family_name, number};
use super::run_error::RunError;
use super::run_id::RunId;
use super::setup::{PlannedDesign, StudySetup};
use crate::dynamics::States;
use crate::estimation::{Estimate, EstimationError, pool};
use crate::excitation::CriterionKind;
use crate::observer::Observer;

impl StudySetup {
    /// The family that `family` continues.
    fn predecessor(&self, family: usize) -> Option<usize> {
        let name = self.plan.designs[family].after.as_ref()?;
        self.plan.designs[..family].iter().position(|other| other.name == *name)
    }

    /// Families from the first experiment of a sequence to `family` itself.
    pub(super) fn families_of_sequence(&self, family: usize) -> Vec<usize> {
        let mut sequence = vec![family];
        while let Some(before) = self.predecessor(sequence[sequence.len() - 1]) {
            sequence.push(before);
        }
        sequence.reverse();
        sequence
    }

    /// Indices of the designs from the first experiment of a sequence to design `index` itself: those of one start.
    pub fn sequence(&self, index: usize) -> Vec<usize> {
        let designs = self.designs();
        let PlannedDesign { family, start } = designs[index];
        let of = |family: usize| designs.iter().position(|&design| design == PlannedDesign { family, start });
        self.families_of_sequence(family).into_iter().filter_map(of).collect()
    }

    /// The information of experiments with these designs, per torque row of one more of the same length; `None` of none.
    pub(super) fn collected(&self, designs: &[StudyDesign]) -> Result<Option<DMatrix<f64>>, StudyError> {
        let problem = self.problem(CriterionKind::DOptimal.into(), 1)?;
        let all = designs.iter().map(|design| problem.information(&design.trajectory));
        Ok(all.collect::<Result<Vec<DMatrix<f64>>, _>>()?.into_iter().reduce(|sum, m| sum + m))
    }

    /// Cramér–Rao standard deviations after all experiments of a sequence, from the exact motion of one period of each.
    pub fn bound_of_sequence(&self, exact: &[States]) -> Vec<f64> {
        let Some(first) = exact.first() else { return vec![f64::INFINITY; self.base.rank()] };
        let mut all = States::new(first.dof);
        for states in exact {
            for k in 0..states.len() {
                all.push(states.q(k), states.qd(k), states.qdd(k));
            }
        }
        self.bound_with_weight(&all, self.raw_samples() / first.len() as f64)
    }

    /// The outcome of one run from what came of its experiments, in the order of the sequence: every estimate made, all
    /// combined; `measured` scores them too. A failed experiment is the reason in the outcome. An observer may end estimators that
    /// iterate: the outcome is then not that of the run.
    pub fn outcome(
        &self,
        id: RunId,
        performed: Vec<Performed>,
        measured: Option<&MeasuredMotions>,
        observer: &dyn Observer,
    ) -> Outcome {
        let truth = self.plan.truth_of(id.run);
        let outcome = |failure, estimates| Outcome {
            design: id.design,
            condition: id.condition,
            truth,
            run: id.run,
            failure,
            estimates,
        };
        let sequence = performed.into_iter().map(|experiment| self.processed(experiment));
        let sequence: Vec<_> = match sequence.collect() {
            Ok(sequence) => sequence,
            Err(failure) => return outcome(Some(failure), Vec::new()),
        };
        if let [only] = &sequence[..] {
            return outcome(None, self.scored(only, truth, measured, observer));
        }
        let made: Vec<_> = sequence.iter().map(|samples| self.unscored(samples, observer)).collect();
        let estimates = self.plan.identification.estimators.iter().enumerate().map(|(e, name)| {
            let each: Result<Vec<&Estimate>, RunError> =
                made.iter().map(|estimates| estimates[e].as_ref().map_err(Clone::clone)).collect();
            match each.and_then(|each| together(&each).map_err(|fault| RunError::estimator(&fault))) {
                Ok(mut scored) => {
                    scored.score = Some(self.scorer.score(&DVector::from_column_slice(&scored.beta), truth, measured));
                    scored
                }
                Err(failure) => ScoredEstimate::failed(name, failure),
            }
        });
        outcome(None, estimates.collect())
    }
}

impl StudyPlan {
    /// Every `after` names an earlier family of as many starts.
    pub(super) fn check_sequences(&self) -> Result<(), StudyPlanError> {
        for (index, family) in self.designs.iter().enumerate() {
            let earlier = &self.designs[..index];
            match &family.after {
                Some(found) => match earlier.iter().find(|other| other.name == *found) {
                    Some(before) if before.starts < family.starts => {
                        let expected = "at most as many as the family that it continues";
                        return Err(number("design.starts", family.starts, expected));
                    }
                    Some(_) => {}
                    None => return Err(family_name("after", found, earlier.iter().map(|other| other.name.as_str()))),
                },
                None if family.method == DesignMethod::Repeated => {
                    return Err(family_name("after", "", earlier.iter().map(|other| other.name.as_str())));
                }
                None => {}
            }
        }
        Ok(())
    }
}

/// The estimates of several experiments as one, not yet scored.
fn together(estimates: &[&Estimate]) -> Result<ScoredEstimate, EstimationError> {
    let pooled = pool(estimates, None)?.estimate;
    // The quantile of the last experiment's interval serves for all.
    let last = estimates[estimates.len() - 1];
    let quantile = last.half_width().component_div(&last.std());
    let std = pooled.std();
    Ok(ScoredEstimate {
        beta: pooled.beta().as_slice().to_vec(),
        half_width: std.component_mul(&quantile).as_slice().to_vec(),
        std: std.as_slice().to_vec(),
        estimator: pooled.estimator,
        residual_rms: pooled.residual_rms,
        ..ScoredEstimate::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::{BaseEstimate, FactorisedBy, IntervalBasis, Termination};
    use crate::excitation::{HistoryPoint, radkhah2007_start};
    use crate::observer::Unobserved;
    use crate::seed::Seed;
    use crate::study::small_results::setup;
    use crate::trajectory::PeriodicTrajectory;
    use rand::RngExt;

    fn estimate(beta: &DVector<f64>, covariance: &DMatrix<f64>) -> Estimate {
        let base = (0..beta.len()).map(|i| {
            let (value, std) = (beta[i], covariance[(i, i)].sqrt());
            let ci95 = [value - 2.0 * std, value + 2.0 * std];
            BaseEstimate { name: format!("p{i}"), value, std, ci95, unit: String::new(), declared_std: 0.0 }
        });
        Estimate {
            estimator: "wls".to_owned(),
            robot: String::new(),
            columns: String::new(),
            shape: Vec::new(),
            base: base.collect(),
            covariance: covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
            noise_covariance: Vec::new(),
            motor_errors: Vec::new(),
            servo: Vec::new(),
            standard: None,
            consistent: None,
            residual_rms: vec![1.0],
            noise_std: vec![1.0],
            units: vec![String::new()],
            condition: 1.0,
            condition_scaled: 1.0,
            factorised_by: FactorisedBy::default(),
            interval_basis: IntervalBasis::Scatter,
            degrees_of_freedom: 100.0,
            samples: 30,
            periods: 2,
            effects: Vec::new(),
            findings: Vec::new(),
            termination: Termination::Direct,
            provenance: None,
        }
    }

    #[test]
    fn identity_estimates_together_are_the_fit_of_all_data() {
        let mut rng = Seed::new(41).stream("two experiments", 0);
        let mut draw =
            |rows: usize| DMatrix::from_fn(rows, 4, |_, j| rng.random_range(-1.0..1.0) * 10.0_f64.powi(j as i32));
        let (w1, w2) = (draw(20), draw(30));
        let (y1, y2) = (draw(20).column(0).into_owned(), draw(30).column(0).into_owned());
        let fit = |w: &DMatrix<f64>, y: &DVector<f64>| {
            let covariance = w.tr_mul(w).try_inverse().unwrap();
            (&covariance * w.tr_mul(y), covariance)
        };
        let ((b1, c1), (b2, c2)) = (fit(&w1, &y1), fit(&w2, &y2));
        let found = together(&[&estimate(&b1, &c1), &estimate(&b2, &c2)]).unwrap();
        let stacked = DMatrix::from_fn(50, 4, |i, j| if i < 20 { w1[(i, j)] } else { w2[(i - 20, j)] });
        let y = DVector::from_fn(50, |i, _| if i < 20 { y1[i] } else { y2[i - 20] });
        let (beta, covariance) = fit(&stacked, &y);
        for i in 0..4 {
            let std = covariance[(i, i)].sqrt();
            assert!((found.beta[i] - beta[i]).abs() < 1e-10 * std.max(beta[i].abs()));
            assert!((found.std[i] / std - 1.0).abs() < 1e-10);
            assert!((found.half_width[i] / std - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn identity_the_same_experiment_twice_has_the_bound_of_one_over_the_root_of_two() {
        let setup = setup();
        let start = radkhah2007_start(&setup.robot, 10.0, 5, Seed::new(7), 0).unwrap();
        let exact = PeriodicTrajectory::from(start).sample(200);
        let twice = setup.bound_of_sequence(&[exact.clone(), exact.clone()]);
        for (one, twice) in setup.bound_of_sequence(&[exact]).into_iter().zip(twice) {
            assert!((one / twice / 2.0_f64.sqrt() - 1.0).abs() < 1e-9, "{one} {twice}");
        }
    }

    #[test]
    fn identity_information_of_two_experiments_is_the_sum() {
        let setup = setup();
        let table_one = setup.plan.designs.len() - 1;
        let design = setup.designs_of_sequence(table_one, 0, &Unobserved).unwrap().pop().unwrap();
        let one = setup.collected(std::slice::from_ref(&design)).unwrap().unwrap();
        let two = setup.collected(&[design.clone(), design.clone()]).unwrap().unwrap();
        assert!((two - &one * 2.0).norm() < 1e-12 * one.norm());
        assert_eq!(setup.collected(&[]).unwrap(), None);
        // A fixed trajectory has the condition number as its own value, whatever else it is.
        assert_eq!(design.own_value(), design.certificate.condition_all);
        let of = |criterion: &str, value: f64| {
            let history = vec![HistoryPoint { evaluations: 1, value, current: value, excess: 0.0 }];
            StudyDesign { criterion: Some(criterion.to_owned()), history, ..design.clone() }.own_value()
        };
        // What the certificate does not state is the optimiser's, and has to be better the smaller it is.
        assert_eq!(of("d-optimal", 7.0), -design.certificate.log_det_information_all);
        assert_eq!((of("i-optimal", 7.0), of("a criterion from outside", 7.0)), (7.0, 7.0));
        let stated = design.values();
        let is_stated = |kind: &CriterionKind| stated.iter().any(|(name, _)| *name == kind.name());
        assert!(CriterionKind::ALL.iter().filter(|kind| kind.criterion().is_larger_better()).all(is_stated));
    }
}
