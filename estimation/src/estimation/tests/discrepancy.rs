//! Intervals of an arm that has what the model lacks.

use nalgebra::{DMatrix, DVector};

use super::coverage::Coverage;
use super::setting::{a460_samples, white};
use crate::estimation::factorisation::Factorisation;
use crate::estimation::omitted::omitted_torque;
use crate::estimation::{Against, EstimationProblem, EstimatorKind, Finding, IntervalBasis, Observation};
use crate::model::Robot;
use crate::seed::Seed;
use crate::signal::NoiseModel;

/// The A460's recording of 200 instants with friction in proportion to the load, and its white noise.
struct Arm {
    robot: Robot,
    exact: Observation,
    samples: crate::signal::Samples,
    beta: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Arm {
    fn new(load_friction: f64) -> Self {
        let (robot, parameters, regressor, base, samples) = a460_samples(200);
        let mut exact = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
        let rigid = DVector::from_fn(beta.len(), |j, _| {
            if base.parameters[base.kept[j]].kind.link_place().is_some() { beta[j] } else { 0.0 }
        });
        let load = &exact.regressor * rigid;
        for row in 0..exact.y.len() {
            exact.y[row] += load_friction * load[row].abs() * libm::tanh(samples.states.qd[row] / 0.02);
        }
        let std = robot.joints().iter().map(|j| j.drive.current_noise * j.drive.torque_per_ampere());
        let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, std.map(|s| s * s)));
        Self { robot, exact, samples, beta, covariance }
    }

    fn observed(&self, seed: Seed, run: u64) -> Observation {
        let mut observation = self.exact.clone();
        observation.y += white(&self.covariance, 200, &mut seed.stream("noise", run));
        observation.noise = Some(NoiseModel::white(self.covariance.clone(), true, 1e9));
        observation.periodic = true;
        observation.periods = 5;
        observation
    }
}

#[test]
fn analytic_noise_alone_rarely_shows_a_discrepancy_and_intervals_hold() {
    // The stated chance of a false alarm is, by joint, at most 2 % of its F and 0.2 % of each of ten groups: below 22 % of six
    // joints. 100 recordings exceed 37 by chance in one of a thousand cases.
    let (arm, seed) = (Arm::new(0.0), Seed::new(71));
    let (mut alarms, mut named, mut coverage) = (0, 0, Coverage::new(arm.beta.len()));
    for run in 0..100 {
        let observation = arm.observed(seed, run);
        let problem = EstimationProblem { samples: Some(&arm.samples), ..EstimationProblem::new(&observation) };
        let estimate = EstimatorKind::Wls.estimator().estimate(&problem).unwrap();
        alarms += usize::from(estimate.interval_basis == IntervalBasis::Discrepancy);
        named += usize::from(estimate.findings.iter().any(|finding| matches!(finding, Finding::LackOfFit { .. })));
        coverage.add(&estimate, &arm.beta);
    }
    assert!(alarms <= 37, "{alarms} false alarms in 100");
    // A finding that names a joint has at most 5 % over all joints; 13 are exceeded by chance in one of a thousand cases.
    assert!(named <= 13, "{named} findings in 100");
    assert!((0.93..=0.98).contains(&coverage.pooled()), "pooled {}", coverage.pooled());
}

#[test]
fn analytic_intervals_hold_what_the_model_lacks() {
    let (arm, seed) = (Arm::new(0.05), Seed::new(72));
    let (mut with, mut without) = (Coverage::new(arm.beta.len()), Coverage::new(arm.beta.len()));
    for run in 0..20 {
        let observation = arm.observed(seed, run);
        let problem = EstimationProblem::new(&observation);
        let wls = EstimatorKind::Wls.estimator();
        let seen = wls.estimate(&EstimationProblem { samples: Some(&arm.samples), ..problem }).unwrap();
        assert_eq!(seen.interval_basis, IntervalBasis::Discrepancy);
        with.add(&seen, &arm.beta);
        // Without states no function of them is known: the residual stands for all.
        let blind = wls.estimate(&problem).unwrap();
        assert_eq!(blind.interval_basis, IntervalBasis::Residual);
        without.add(&blind, &arm.beta);
        // The same estimate, with other intervals.
        assert_eq!(seen.beta(), blind.beta());
    }
    assert!(with.pooled() > 0.9, "{} with, {} without", with.pooled(), without.pooled());
    assert!(without.pooled() < with.pooled() - 0.05, "{} with, {} without", with.pooled(), without.pooled());
}

#[test]
fn analytic_intervals_cover_under_a_law_that_is_omitted_and_it_is_named() {
    let seed = Seed::new(76);
    for (level, periodic, runs) in [(0.0, false, 20), (0.05, false, 8), (0.05, true, 8)] {
        let arm = Arm::new(level);
        let (mut with, mut without) = (Coverage::new(arm.beta.len()), Coverage::new(arm.beta.len()));
        let (mut named, mut misfits, mut narrower) = (0, 0, 0.0);
        for run in 0..runs {
            let measured = arm.observed(seed, run);
            let plain = Observation { noise: None, periodic: false, periods: 1, ..measured.clone() };
            let observation = if periodic { measured } else { plain };
            let mut equations = Factorisation::new(&observation).unwrap();
            equations.omitted = omitted_torque(&arm.robot, &equations, &arm.samples).unwrap();
            let wls = EstimatorKind::Wls.estimator();
            let problem = EstimationProblem { samples: Some(&arm.samples), ..EstimationProblem::new(&observation) };
            let seen = wls.estimate(&EstimationProblem { factorisation: Some(&equations), ..problem }).unwrap();
            named += usize::from(seen.findings.iter().any(|finding| match finding {
                Finding::EffectShown { effect, size, .. } => {
                    level == 0.0 || effect == "load-friction" && (0.02..0.1).contains(size)
                }
                _ => false,
            }));
            misfits += usize::from(seen.findings.iter().any(|finding| matches!(finding, Finding::LackOfFit { .. })));
            with.add(&seen, &arm.beta);
            let generic = wls.estimate(&problem).unwrap();
            let pairs = seen.base.iter().zip(&generic.base);
            narrower += pairs.map(|(law, generic)| libm::log(law.std / generic.std)).sum::<f64>();
            without.add(&generic, &arm.beta);
        }
        assert!(with.pooled() > 0.93, "{level}: {} with, {} without", with.pooled(), without.pooled());
        match (level, periodic) {
            // One run in twenty names a law that is not there: four of twenty are exceeded by chance in one of four hundred cases.
            (0.0, _) => assert!(named <= 4, "{named} findings in {runs}"),
            (_, false) => assert!(without.pooled() < 0.93, "{} without", without.pooled()),
            // A law says more than functions of any kind. What it explains is no lack of fit: at 5 %, three of eight are rarer than one in a hundred.
            (_, true) => assert!(narrower < 0.0 && misfits <= 2, "{narrower} {misfits}"),
        }
        assert!(level == 0.0 || named == runs as usize, "{named} of {runs}");
    }
}

#[test]
fn analytic_a_misfit_is_found_in_its_joint_with_its_size_and_speed() {
    // Friction near rest in the third joint alone, ten times the noise.
    let arm = Arm::new(0.0);
    let joint = 2;
    let rows: Vec<usize> = (0..200).map(|k| 6 * k + joint).collect();
    let speed = |row: usize| arm.samples.states.qd[row];
    let friction = |v: f64| 3.0 * v.signum() * libm::exp(-(v / 0.1).powi(2));
    let added = DVector::from_iterator(200, rows.iter().map(|&row| friction(speed(row))));
    // What no parameter of the joint's own equations explains, by a decomposition of them.
    let own = arm.exact.regressor.select_rows(&rows);
    let projection = &own * own.clone().pseudo_inverse(1e-9).unwrap();
    let freedom = 200.0 - own.rank(1e-9) as f64;
    let left = |torque: &DVector<f64>| (torque - &projection * torque).norm_squared() / freedom;
    let mut observation = arm.observed(Seed::new(75), 0);
    for (&row, added) in rows.iter().zip(&added) {
        observation.y[row] += added;
    }
    let problem = EstimationProblem { samples: Some(&arm.samples), ..EstimationProblem::new(&observation) };
    let estimate = EstimatorKind::Wls.estimator().estimate(&problem).unwrap();
    let found: Vec<_> =
        estimate.findings.iter().filter(|finding| matches!(finding, Finding::LackOfFit { .. })).collect();
    let [Finding::LackOfFit { joint: named, beyond_noise_rms, torque_rms, most: Some(most), unit, .. }] = found[..]
    else {
        panic!("{found:?}")
    };
    assert_eq!((*named, unit.as_str(), most.range_unit.as_str()), (joint + 1, "N·m", "rad/s"));
    let torque = DVector::from_iterator(200, rows.iter().map(|&row| observation.y[row]));
    assert!((torque_rms / (torque.norm_squared() / 200.0).sqrt() - 1.0).abs() < 1e-9, "{torque_rms}");
    let expected = (left(&torque) - arm.covariance[(joint, joint)]).sqrt();
    assert!((beyond_noise_rms / expected - 1.0).abs() < 1e-6, "{beyond_noise_rms} {expected}");
    // It is what was added but for noise, whose part in the square has a standard deviation of an eighth.
    let exact = left(&added);
    assert!((beyond_noise_rms.powi(2) / exact - 1.0).abs() < 3.0 / 8.0, "{beyond_noise_rms} {exact}");
    let mut speeds: Vec<f64> = rows.iter().map(|&row| speed(row).abs()).collect();
    speeds.sort_by(f64::total_cmp);
    assert_eq!((most.against, most.range), (Against::Speed, [speeds[0], speeds[39]]));
    assert!(most.rms > 1.5 * beyond_noise_rms, "{most:?} {beyond_noise_rms}");
    let text = found[0].to_string();
    assert!(
        text.contains("joint 3: neither model nor noise explains 0.408 N·m")
            && text.contains("largest at a speed of 0.00"),
        "{text}"
    );
}

/// Estimators whose intervals come from a residual of their own.
const OF_RESIDUAL: [EstimatorKind; 4] =
    [EstimatorKind::IrlsHuber, EstimatorKind::IrlsTukey, EstimatorKind::IrlsCauchy, EstimatorKind::Mm];

#[test]
fn analytic_intervals_of_robust_estimators_hold_what_the_model_lacks() {
    let (arm, seed) = (Arm::new(0.05), Seed::new(73));
    for kind in OF_RESIDUAL {
        let (mut with, mut without) = (Coverage::new(arm.beta.len()), Coverage::new(arm.beta.len()));
        for run in 0..8 {
            let observation = arm.observed(seed, run);
            let problem = EstimationProblem::new(&observation);
            let seen =
                kind.estimator().estimate(&EstimationProblem { samples: Some(&arm.samples), ..problem }).unwrap();
            assert_eq!(seen.interval_basis, IntervalBasis::Discrepancy, "{}", kind.name());
            with.add(&seen, &arm.beta);
            let blind = kind.estimator().estimate(&problem).unwrap();
            assert_eq!(blind.interval_basis, IntervalBasis::Residual, "{}", kind.name());
            without.add(&blind, &arm.beta);
            assert_eq!(seen.beta(), blind.beta());
        }
        assert!(with.pooled() > 0.9, "{}: {} with, {} without", kind.name(), with.pooled(), without.pooled());
        let gain = with.pooled() - without.pooled();
        assert!(gain > 0.05, "{}: {} with, {} without", kind.name(), with.pooled(), without.pooled());
    }
}

#[test]
fn analytic_outliers_that_a_robust_estimator_gives_up_are_no_discrepancy() {
    // One torque in a hundred is wrong by two hundred standard deviations.
    let (arm, seed) = (Arm::new(0.0), Seed::new(74));
    for kind in OF_RESIDUAL {
        let (mut alarms, mut coverage) = (0, Coverage::new(arm.beta.len()));
        for run in 0..20 {
            let mut observation = arm.observed(seed, run);
            for row in (0..observation.y.len()).skip(run as usize).step_by(97) {
                observation.y[row] += 200.0 * arm.covariance[(row % 6, row % 6)].sqrt();
            }
            let problem = EstimationProblem { samples: Some(&arm.samples), ..EstimationProblem::new(&observation) };
            let estimate = kind.estimator().estimate(&problem).unwrap();
            alarms += usize::from(estimate.interval_basis == IntervalBasis::Discrepancy);
            coverage.add(&estimate, &arm.beta);
        }
        // Below 22 % of recordings by chance; 11 of 20 in one of a thousand cases.
        assert!(alarms <= 11, "{}: {alarms} false alarms in 20", kind.name());
        assert!(coverage.pooled() > 0.92, "{}: {}", kind.name(), coverage.pooled());
    }
}
