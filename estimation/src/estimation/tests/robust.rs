//! Robust estimators against published numbers, and what wrong equations do to them.

use nalgebra::{DMatrix, DVector, dmatrix};
use rand::RngExt;

use super::coverage::Coverage;
use super::setting::{synthetic, white};
use crate::base::{BaseReduction, Method};
use crate::estimation::{Estimate, EstimationProblem, EstimatorKind, Finding, Observation};
use crate::model::{ParameterId, ParameterKind};
use crate::seed::Seed;

/// Brownlee's stack loss data: air flow, water temperature, acid concentration, loss (K. A. Brownlee, *Statistical Theory and
/// Methodology in Science and Engineering*, Wiley, 1960, p. 454).
const STACK_LOSS: [[f64; 4]; 21] = [
    [80.0, 27.0, 89.0, 42.0],
    [80.0, 27.0, 88.0, 37.0],
    [75.0, 25.0, 90.0, 37.0],
    [62.0, 24.0, 87.0, 28.0],
    [62.0, 22.0, 87.0, 18.0],
    [62.0, 23.0, 87.0, 18.0],
    [62.0, 24.0, 93.0, 19.0],
    [62.0, 24.0, 93.0, 20.0],
    [58.0, 23.0, 87.0, 15.0],
    [58.0, 18.0, 80.0, 14.0],
    [58.0, 18.0, 89.0, 14.0],
    [58.0, 17.0, 88.0, 13.0],
    [58.0, 18.0, 82.0, 11.0],
    [58.0, 19.0, 93.0, 12.0],
    [50.0, 18.0, 89.0, 8.0],
    [50.0, 18.0, 86.0, 7.0],
    [50.0, 19.0, 72.0, 8.0],
    [50.0, 19.0, 79.0, 8.0],
    [50.0, 20.0, 80.0, 9.0],
    [56.0, 20.0, 82.0, 15.0],
    [70.0, 20.0, 91.0, 15.0],
];

/// Equations of one joint.
fn one_joint(regressor: DMatrix<f64>, y: DVector<f64>) -> Observation {
    let (exact, _) = synthetic(2, 2, &mut Seed::new(1).stream("units", 0));
    let b = regressor.ncols();
    let ids: Vec<ParameterId> = (0..b).map(|index| ParameterId { kind: ParameterKind::M, index }).collect();
    Observation {
        used: vec![true; y.len()],
        dof: 1,
        units: vec!["N·m".to_owned()],
        base: BaseReduction::from_stack(&ids, &DMatrix::identity(b, b), Method::Qr),
        parameter_units: vec!["kg".to_owned(); b],
        regressor,
        y,
        ..exact
    }
}

fn estimate(kind: EstimatorKind, observation: &Observation) -> Estimate {
    kind.estimator().estimate(&EstimationProblem::new(observation)).unwrap()
}

const ROBUST: [EstimatorKind; 4] =
    [EstimatorKind::IrlsHuber, EstimatorKind::IrlsTukey, EstimatorKind::IrlsCauchy, EstimatorKind::Mm];

#[test]
fn published_stack_loss_is_that_of_statsmodels() {
    let w = DMatrix::from_fn(21, 4, |k, j| if j == 0 { 1.0 } else { STACK_LOSS[k][j - 1] });
    let observation = one_joint(w, DVector::from_fn(21, |k, _| STACK_LOSS[k][3]));
    // statsmodels 0.15.0, RLM(y, X, M).fit(tol=1e-14, maxiter=2000, conv="coefs", cov="H1") with M = HuberT(1.345),
    // TukeyBiweight(4.685), StudentT(c=2.385, df=1). MM: the S-estimate over all 5985 subsets of four rows, followed to rest, then
    // Tukey's weights, in NumPy.
    let expected = [
        [-41.026_498_352_400_28, 0.829_384_334_600_11, 0.926_065_966_196_648, -0.127_846_724_945_785],
        [-42.285_350_779_329_63, 0.927_557_322_755_52, 0.650_717_687_214_307, -0.112_333_153_790_901],
        [-40.658_662_237_931_11, 0.834_596_662_314_999, 0.876_481_915_625_012, -0.123_838_930_420_777],
        [-41.524_543_434_967_28, 0.938_845_932_287_215, 0.579_547_592_199_279, -0.112_921_824_713_99],
    ];
    for (kind, expected) in ROBUST.into_iter().zip(expected) {
        let found = estimate(kind, &observation);
        assert!(found.termination.was_successful());
        for (p, expected) in found.base.iter().zip(expected) {
            assert!((p.value / expected - 1.0).abs() < 1e-8, "{}: {} {expected}", kind.name(), p.value);
        }
    }
    // Huber's standard deviations by statsmodels: the same formula where residuals are taken for white.
    let found = estimate(EstimatorKind::IrlsHuber, &observation);
    let std = [9.791_898_541_349_282, 0.111_005_213_354_505, 0.302_930_163_108_59, 0.128_649_614_935_37];
    for (p, expected) in found.base.iter().zip(std) {
        assert!((p.std / expected - 1.0).abs() < 1e-7, "{} {expected}", p.std);
    }
}

/// Equations of two joints with normal noise, of which every `every`-th sample is made wrong by `wrong`.
fn contaminated(run: u64, every: usize, wrong: impl Fn(&mut Observation, usize)) -> (Observation, DVector<f64>) {
    let seed = Seed::new(61);
    let (mut observation, beta) = synthetic(200, 6, &mut seed.stream("regressor", 0));
    observation.y += white(&dmatrix![0.04, 0.0; 0.0, 0.01], 200, &mut seed.stream("noise", run));
    for k in (0..200).step_by(every) {
        wrong(&mut observation, 2 * k);
    }
    (observation, beta)
}

/// The error of the estimate in standard deviations that ordinary least squares would have without contamination.
fn error(kind: EstimatorKind, (observation, beta): &(Observation, DVector<f64>)) -> f64 {
    let (clean, _) = contaminated(0, 1000, |_, _| {});
    let std = estimate(EstimatorKind::Wls, &clean).std();
    (estimate(kind, observation).beta() - beta).component_div(&std).amax()
}

#[test]
fn analytic_contaminated_torque_moves_least_squares_and_not_the_robust_ones() {
    for size in [10.0, 100.0, 1000.0] {
        let case = contaminated(3, 10, |observation, row| {
            observation.y[row] += size;
            observation.y[row + 1] -= size;
        });
        for kind in [EstimatorKind::Ols, EstimatorKind::Wls] {
            assert!(error(kind, &case) > 0.1 * size, "{} {}", kind.name(), error(kind, &case));
        }
        for kind in ROBUST {
            // The bias of a tenth wrong equations is bounded, whatever their size: Huber's is the largest.
            assert!(error(kind, &case) < 5.0, "{} {size}: {}", kind.name(), error(kind, &case));
            let found = estimate(kind, &case.0);
            let of_joint =
                |i: usize| move |f: &Finding| matches!(f, Finding::Outliers { joint, outliers: 20, .. } if *joint == i);
            assert!((1..=2).all(|i| found.findings.iter().any(of_joint(i))), "{:?}", found.findings);
        }
    }
}

#[test]
fn analytic_one_bad_row_of_leverage_breaks_m_estimators_and_not_mm() {
    // One state of 200 wrong: its row of the first joint is a thousand times too long, and its torque stays.
    let one = |size: f64| {
        contaminated(4, 1000, move |observation, row| {
            for j in 0..6 {
                observation.regressor[(row, j)] *= size;
            }
        })
    };
    for kind in [EstimatorKind::Ols, EstimatorKind::Wls, EstimatorKind::IrlsHuber] {
        assert!(error(kind, &one(1000.0)) > 5.0, "{}: {}", kind.name(), error(kind, &one(1000.0)));
    }
    for size in [10.0, 1000.0, 1e5] {
        assert!(error(EstimatorKind::Mm, &one(size)) < 4.0, "{size}: {}", error(EstimatorKind::Mm, &one(size)));
    }
}

#[test]
fn analytic_a_fifth_of_wrong_states_breaks_every_estimator_but_mm() {
    // Wrong equations that agree with each other: long rows with the torque of another arm.
    let case = contaminated(5, 5, |observation, row| {
        for j in 0..6 {
            observation.regressor[(row, j)] += 10.0;
        }
        observation.y[row] = -50.0;
    });
    for kind in EstimatorKind::ALL.iter().copied().filter(|kind| ROBUST.contains(kind)) {
        let error = error(kind, &case);
        assert_eq!(error < 4.0, kind == EstimatorKind::Mm, "{}: {error}", kind.name());
    }
    assert!(error(EstimatorKind::Wls, &case) > 20.0);
}

#[test]
fn analytic_coverage_under_contamination() {
    // A twentieth of the torques is noise thirty times as large: intervals of least squares become many times as wide.
    let seed = Seed::new(62);
    for kind in ROBUST {
        let mut coverage = Coverage::new(6);
        let mut width = 0.0;
        for run in 0..500 {
            let mut rng = seed.stream("outliers", run);
            let (mut observation, beta) = contaminated(run, 1000, |_, _| {});
            for row in 0..400 {
                if rng.random_range(0.0..1.0) < 0.05 {
                    observation.y[row] += rng.random_range(-6.0..6.0);
                }
            }
            let found = estimate(kind, &observation);
            assert!(found.termination.was_successful(), "{} {run}: {:?}", kind.name(), found.termination);
            width += found.std()[0] / estimate(EstimatorKind::Ols, &observation).std()[0] / 500.0;
            coverage.add(&found, &beta);
        }
        coverage.check();
        assert!(width < 0.4, "{}: {width}", kind.name());
    }
}
