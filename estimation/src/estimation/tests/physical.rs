//! Fits over physically consistent sets.

use nalgebra::{DMatrix, DVector};

use super::setting::{a460_samples_of, white};
use crate::base::BaseReduction;
use crate::estimation::StiffLoop;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, EstimatorKind, Finding, Observation};
use crate::model::term::VISCOUS;
use crate::model::{Columns, Robot, StandardParameters};
use crate::seed::Seed;
use crate::signal::Samples;

const CONSTRAINED: [EstimatorKind; 3] = [EstimatorKind::PcOls, EstimatorKind::PcWls, EstimatorKind::PcIrls];
const NEAR_A_PRIOR: [EstimatorKind; 3] =
    [EstimatorKind::PcOlsEuclidean, EstimatorKind::PcOlsEntropic, EstimatorKind::PcOlsPullback];

const SIMULATING: [EstimatorKind; 2] = [EstimatorKind::PcIv, EstimatorKind::PcDidim];

struct Case {
    robot: Robot,
    truth: StandardParameters,
    observation: Observation,
    base: BaseReduction,
    beta: DVector<f64>,
    samples: Samples,
}

/// The A460 on Table I with noise `factor` times that of its currents, and hardly any viscous friction at the wrist.
fn case(factor: f64, run: u64) -> Case {
    let (robot, truth, regressor, base, mut samples) = a460_samples_of(150, |set| {
        for drive in &mut set.drives[3..] {
            drive[VISCOUS] = 1e-4;
        }
    });
    let variance =
        robot.joints().iter().map(|j| (factor * j.drive.current_noise * j.drive.torque_per_ampere()).powi(2));
    let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, variance));
    let noise = white(&covariance, 150, &mut Seed::new(91).stream("noise", run));
    for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
        *tau += noise;
    }
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let beta = base.beta(&truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
    Case { robot, truth, observation, base, beta, samples }
}

impl Case {
    fn estimate(&self, kind: EstimatorKind) -> Estimate {
        self.estimate_in(kind, 1e-6)
    }

    /// Under a servo that lets a joint deviate by `compliance` rad per N·m.
    fn estimate_in(&self, kind: EstimatorKind, compliance: f64) -> Estimate {
        let (columns, states) = (Columns::RIGID_ROTOR_FRICTION, self.samples.states.clone());
        let stiff = StiffLoop::new(&self.robot, columns, &self.truth, self.truth.clone(), states, compliance);
        let problem = EstimationProblem {
            robot: Some(&self.robot),
            nominal: Some(&self.truth),
            ..EstimationProblem::new(&self.observation)
        };
        kind.estimator()
            .estimate(&EstimationProblem { samples: Some(&self.samples), closed_loop: Ok(&stiff), ..problem })
            .unwrap()
    }

    fn set(&self, estimate: &Estimate) -> StandardParameters {
        let mut set = self.truth.clone();
        for (&id, found) in self.base.parameters.iter().zip(estimate.standard.as_ref().unwrap()) {
            assert_eq!(id.to_string(), found.name);
            set.set(id, found.value);
        }
        set
    }
}

#[test]
fn identity_every_set_is_consistent_and_has_the_base_parameters_of_the_estimate() {
    let case = case(3.0, 0);
    for kind in CONSTRAINED.into_iter().chain(NEAR_A_PRIOR).chain(SIMULATING) {
        let found = case.estimate(kind);
        assert!(found.termination.was_successful(), "{}: {:?}", kind.name(), found.termination);
        let set = case.set(&found);
        assert!(set.links.iter().all(|link| link.check().is_ok()), "{}", kind.name());
        assert!(set.drives.iter().all(|drive| drive[VISCOUS] >= 0.0) && found.consistent == Some(true));
        let beta = case.base.beta(&set.vector(&case.robot, Columns::RIGID_ROTOR_FRICTION));
        assert!((beta - found.beta()).component_div(&found.std()).amax() < 1e-6, "{}", kind.name());
    }
    // Nothing of that holds for the unconstrained ones.
    let plain = case.estimate(EstimatorKind::Wls);
    assert!(
        plain.findings.iter().any(|f| matches!(f, Finding::NegativeDrive { .. } | Finding::InconsistentLink { .. }))
    );
    for kind in CONSTRAINED.into_iter().chain(SIMULATING) {
        assert!(case.estimate(kind).findings.iter().any(|f| matches!(f, Finding::HeldBack { .. })), "{}", kind.name());
    }
}

#[test]
fn identity_where_the_plain_solution_is_consistent_it_is_the_answer() {
    let case = case(1e-3, 1);
    for (kind, plain) in [
        (EstimatorKind::PcOls, EstimatorKind::Ols),
        (EstimatorKind::PcWls, EstimatorKind::Wls),
        (EstimatorKind::PcIrls, EstimatorKind::IrlsHuber),
        (EstimatorKind::PcIv, EstimatorKind::Iv),
        (EstimatorKind::PcDidim, EstimatorKind::Didim),
    ] {
        let (found, plain) = (case.estimate(kind), case.estimate(plain));
        let moved = (found.beta() - plain.beta()).component_div(&plain.std()).amax();
        assert!(moved < 1e-5, "{}: {moved}", kind.name());
        assert!(!found.findings.iter().any(|f| matches!(f, Finding::HeldBack { .. })));
    }
}

#[test]
fn identity_along_the_measured_motion_those_that_simulate_are_weighted_least_squares() {
    // A servo that no torque moves: the simulated motion is the measured one, and torque is linear.
    let case = case(3.0, 5);
    let expected = case.estimate_in(EstimatorKind::PcWls, 0.0);
    assert!(expected.findings.iter().any(|f| matches!(f, Finding::HeldBack { .. })));
    for kind in SIMULATING {
        let found = case.estimate_in(kind, 0.0);
        let moved = (found.beta() - expected.beta()).component_div(&expected.std()).amax();
        assert!(moved < 1e-4, "{}: {moved}", kind.name());
        let wider = found.std().component_div(&expected.std());
        assert!((wider.add_scalar(-1.0)).amax() < 1e-6, "{}", kind.name());
    }
}

#[test]
fn analytic_the_constraint_brings_the_estimate_nearer_to_the_truth() {
    // In the metric of the fit itself, for every noise: projections onto a convex set move towards its points.
    for run in 0..2 {
        let case = case(10.0, run);
        let (plain, found) = (case.estimate(EstimatorKind::Ols), case.estimate(EstimatorKind::PcOls));
        let distance = |e: &Estimate| (&case.observation.regressor * (e.beta() - &case.beta)).norm();
        assert!(distance(&found) < distance(&plain), "{run}: {} {}", distance(&found), distance(&plain));
    }
}

#[test]
fn analytic_a_prior_that_is_right_helps_and_the_pullback_is_the_entropic_distance_near_it() {
    let case = case(10.0, 2);
    let error =
        |kind| (case.estimate(kind).beta() - &case.beta).component_div(&case.estimate(EstimatorKind::Ols).std()).norm();
    for kind in NEAR_A_PRIOR {
        assert!(error(kind) < error(EstimatorKind::PcOls), "{}: {}", kind.name(), error(kind));
    }
    // With little noise both priors are the same quadratic form, beside equations that decide.
    let quiet = self::case(1e-2, 3);
    let (entropic, pullback) =
        (quiet.estimate(EstimatorKind::PcOlsEntropic), quiet.estimate(EstimatorKind::PcOlsPullback));
    let apart = (entropic.beta() - pullback.beta()).component_div(&pullback.std()).amax();
    assert!(apart < 0.05, "{apart}");
}

#[test]
fn the_exceptions_are_what_they_say() {
    let case = case(1.0, 4);
    // A prior in SI needs a nominal set.
    for kind in NEAR_A_PRIOR {
        let problem = EstimationProblem::new(&case.observation);
        let expected =
            EstimationError::Missing { estimator: kind.name().to_owned(), part: "a nominal set of parameters" };
        assert!(expected.to_string().contains("a nominal set of parameters"), "{expected}");
        assert_eq!(kind.estimator().estimate(&problem).unwrap_err(), expected);
        // Torque in mN·m weighs a thousand times against it: the estimate is not a thousand times as large.
        let mut scaled = case.observation.clone();
        scaled.y *= 1000.0;
        let own = case.estimate(kind).beta() * 1000.0;
        let problem = EstimationProblem { nominal: Some(&case.truth), ..EstimationProblem::new(&scaled) };
        let other = kind.estimator().estimate(&problem).unwrap();
        assert!((other.beta() - own).component_div(&other.std()).amax() > 1e-6, "{}", kind.name());
    }
    // A column in other units is that of another body: the constraint binds elsewhere.
    let noisy = self::case(10.0, 0);
    let mut scaled = noisy.observation.clone();
    let at = noisy.base.names().iter().position(|name| name.starts_with("Ixx")).unwrap();
    let column = scaled.regressor.column(at) * 1e-3;
    scaled.regressor.set_column(at, &column);
    for kind in CONSTRAINED {
        let own = kind.estimator().estimate(&EstimationProblem::new(&noisy.observation)).unwrap();
        let other = kind.estimator().estimate(&EstimationProblem::new(&scaled)).unwrap();
        let moved = (other.base[at].value * 1e-3 - own.base[at].value).abs() / own.base[at].std;
        assert!(moved > 1e-6, "{}: {moved}", kind.name());
    }
}
