//! What every estimator obeys, but for the exceptions that it declares.
//!
//! The equations are those of a random chain of three joints with rotors and friction, at random states: the truth is known,
//! and the noise is white with a stated covariance. Estimators that simulate get a [`StiffLoop`] about that motion. See
//! [`EstimatorLaw`] for the laws.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

use super::law_error::LawError;
use super::{StiffLoop, chains};
use crate::base::{BaseReduction, Method, reduce};
use crate::dynamics::States;
use crate::estimation::{
    Estimate, EstimationError, EstimationProblem, Estimator, EstimatorLaw, Finding, LawException, Observation,
};
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};

const DOF: usize = 3;
const INSTANTS: usize = 150;

/// Relative error of the parameters from exact equations: the condition number times rounding, with room for iterations.
const RECOVERY: f64 = 1e-8;
/// How much the servo of estimators that simulate lets a joint deviate, rad per N·m, and the noise of positions, rad: too
/// little to matter to any other.
const COMPLIANCE: f64 = 1e-5;
const POSITION_NOISE: f64 = 1e-9;
/// Change of a value that counts as none, in standard deviations.
const EQUAL: f64 = 1e-6;
/// Experiments behind the coverage, and the share that must lie between these: with about 20 parameters each, whose
/// errors are correlated, an estimator with calibrated intervals leaves them by chance less than once in a thousand
/// seeds.
const EXPERIMENTS: u64 = 40;
const COVERAGE: [f64; 2] = [0.88, 0.99];

/// Checks one estimator.
///
/// ```
/// use armid::conformance::estimator_laws;
/// use armid::estimation::EstimatorKind;
/// estimator_laws::check(&EstimatorKind::Ols)?;
/// # Ok::<(), armid::conformance::LawError>(())
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold and is no declared exception, or an exception without a reason.
pub fn check(estimator: &dyn Estimator) -> Result<(), LawError> {
    let setting = Setting::new();
    for law in EstimatorLaw::ALL {
        match estimator.exceptions().iter().find(|exception| exception.law == law) {
            Some(LawException { reason, .. }) => {
                let holds = !reason.trim().is_empty();
                let found = format!("none for: {}", law.sentence());
                LawError::unless("an exception states its reason", holds, found, "a reason")?;
            }
            None => setting.check(law, estimator)?,
        }
    }
    Ok(())
}

/// A robot, its true parameters, and the states of an experiment.
struct Setting {
    robot: Robot,
    truth: StandardParameters,
    regressor: JointTorqueRegressor,
    base: BaseReduction,
    beta: DVector<f64>,
    /// Samples without an error in torque, and the noise that they state.
    exact: Samples,
    sigma: Vec<f64>,
    closed_loop: StiffLoop,
}

impl Setting {
    fn new() -> Self {
        let seed = Seed::new(11);
        let mut rng = seed.stream("estimator laws", 0);
        let (robot, truth) = chains::random_robot(&mut rng, DOF);
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
        let base = reduce(&robot, columns, Method::Structural, seed).expect("a drawn chain can be reduced");
        let mut states = States::new(DOF);
        for _ in 0..INSTANTS {
            let (q, qd, qdd) = chains::random_state(&mut rng, DOF);
            states.push(&q, &qd, &qdd);
        }
        let beta = base.beta(&truth.vector(&robot, columns));
        let tau: Vec<f64> = (base.select_columns(&regressor.stack(&states)) * &beta).as_slice().to_vec();
        let sigma: Vec<f64> = (0..DOF)
            .map(|i| {
                let power: f64 = tau.iter().skip(i).step_by(DOF).map(|tau| tau * tau).sum();
                // Joints of unlike quality: a hundredth, a fiftieth, a thirtieth of their torque.
                [0.01, 0.02, 0.03][i] * (power / INSTANTS as f64).sqrt()
            })
            .collect();
        let covariance = DMatrix::from_diagonal(&DVector::from_iterator(DOF, sigma.iter().map(|s| s * s)));
        let exact = Samples {
            periods: 10,
            torque_covariance: Some(&covariance * 10.0),
            noise: Some(NoiseModel::white(covariance, false, 1e6)),
            ..Samples::exact(states, tau, vec!["N·m".to_owned(); DOF], 10.0)
        };
        let closed_loop = StiffLoop::new(
            &robot,
            columns,
            &truth,
            tenth_off(&robot, columns, &truth),
            exact.states.clone(),
            COMPLIANCE,
        );
        Self { robot, truth, regressor, base, beta, exact, sigma, closed_loop }
    }

    fn check(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        match law {
            EstimatorLaw::Recovery => self.recovery(law, estimator),
            EstimatorLaw::TorqueUnits => self.torque_units(law, estimator),
            EstimatorLaw::ParameterUnits => self.parameter_units(law, estimator),
            EstimatorLaw::TooFewEquations => self.too_few(law, estimator),
            EstimatorLaw::Determinism => self.determinism(law, estimator),
            EstimatorLaw::Report => self.report(law, estimator),
            EstimatorLaw::Misfit => self.misfit(law, estimator),
            EstimatorLaw::Coverage => self.coverage(law, estimator),
        }
    }

    /// The samples of experiment `run`, with noise.
    fn noisy(&self, run: u64) -> Samples {
        let mut rng = Seed::new(12).stream("noise", run);
        let mut samples = self.exact.clone();
        let mut positions = Seed::new(13).stream("position noise", run);
        for q in &mut samples.states.q {
            let z: f64 = StandardNormal.sample(&mut positions);
            *q += POSITION_NOISE * z;
        }
        for row in samples.tau.chunks_exact_mut(DOF) {
            for (tau, sigma) in row.iter_mut().zip(&self.sigma) {
                let z: f64 = StandardNormal.sample(&mut rng);
                *tau += sigma * z;
            }
        }
        samples
    }

    fn observation(&self, law: EstimatorLaw, samples: &Samples) -> Result<Observation, LawError> {
        Observation::new(&self.robot, &self.regressor, &self.base, samples).map_err(|error| refused(law, &error))
    }

    /// The estimate from everything that an estimator may look at; the nominal set is a tenth off.
    fn estimate(
        &self,
        estimator: &dyn Estimator,
        observation: &Observation,
        samples: &Samples,
    ) -> Result<Estimate, EstimationError> {
        let nominal = tenth_off(&self.robot, self.regressor.columns(), &self.truth);
        let problem = EstimationProblem {
            robot: Some(&self.robot),
            samples: Some(samples),
            closed_loop: Ok(&self.closed_loop),
            ..EstimationProblem::new(observation)
        };
        estimator.estimate(&EstimationProblem { nominal: Some(&nominal), ..problem })
    }

    fn made(&self, law: EstimatorLaw, estimator: &dyn Estimator, samples: &Samples) -> Result<Estimate, LawError> {
        let observation = self.observation(law, samples)?;
        self.estimate(estimator, &observation, samples).map_err(|error| refused(law, &error))
    }

    fn recovery(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let found = self.made(law, estimator, &self.exact)?;
        LawError::unless_at_most(law.sentence(), (found.beta() - &self.beta).norm() / self.beta.norm(), RECOVERY)
    }

    fn torque_units(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let samples = self.noisy(0);
        let factor = 1000.0;
        let mut scaled = samples.clone();
        scaled.tau.iter_mut().for_each(|tau| *tau *= factor);
        scaled.noise = scaled.noise.map(|noise| noise.scaled(factor * factor));
        scaled.torque_covariance = scaled.torque_covariance.map(|covariance| covariance * (factor * factor));
        let (own, other) = (self.made(law, estimator, &samples)?, self.made(law, estimator, &scaled)?);
        same(law, &own, &other, |_| factor)
    }

    fn parameter_units(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let samples = self.noisy(0);
        let observation = self.observation(law, &samples)?;
        let factor = |j: usize| [1e-3, 1.0, 1e3][j % 3];
        let mut scaled = observation.clone();
        for (j, mut column) in scaled.regressor.column_iter_mut().enumerate() {
            column *= factor(j);
        }
        let of = |observation: &Observation| {
            // Only the equations: robot and samples state parameters in the units that they were.
            estimator.estimate(&EstimationProblem::new(observation)).map_err(|error| refused(law, &error))
        };
        same(law, &of(&observation)?, &of(&scaled)?, |j| 1.0 / factor(j))
    }

    fn too_few(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let mut observation = self.observation(law, &self.exact)?;
        for row in self.base.rank() - 1..observation.y.len() {
            observation.used[row] = false;
            observation.y[row] = 0.0;
            observation.regressor.row_mut(row).fill(0.0);
        }
        let samples = Samples { used: observation.used.clone(), ..self.exact.clone() };
        let answer = self.estimate(estimator, &observation, &samples);
        LawError::unless(law.sentence(), answer.is_err(), "an estimate", "an error")
    }

    fn determinism(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let samples = self.noisy(0);
        let (first, second) = (self.made(law, estimator, &samples)?, self.made(law, estimator, &samples)?);
        LawError::unless(law.sentence(), first == second, "another estimate", "the same bits")
    }

    fn report(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let found = self.made(law, estimator, &self.noisy(0))?;
        let unless =
            |holds: bool, what: String, expected: &'static str| LawError::unless(law.sentence(), holds, what, expected);
        unless(found.names() == self.base.names(), found.names().join(" "), "the names of the base parameters")?;
        unless(found.estimator == estimator.name(), found.estimator.clone(), "the name of the estimator")?;
        let b = self.base.rank();
        let shape = found.covariance.len() == b && found.covariance.iter().all(|row| row.len() == b);
        unless(shape, format!("{} rows of covariance", found.covariance.len()), "one row and column per parameter")?;
        for (j, parameter) in found.base.iter().enumerate() {
            let (value, std, [low, high]) = (parameter.value, parameter.std, parameter.ci95);
            let holds =
                [value, std, low, high].iter().all(|x| x.is_finite()) && std > 0.0 && low < value && value < high;
            unless(holds, format!("{parameter:?}"), "finite numbers, a positive std, an interval around the value")?;
            let variance = found.covariance[j][j];
            let holds = (variance - std * std).abs() <= EQUAL * variance
                && (0..b).all(|i| {
                    let size = std * found.base[i].std;
                    (found.covariance[i][j] - found.covariance[j][i]).abs() <= EQUAL * size
                });
            unless(
                holds,
                format!("{variance:e} beside a std of {std:e}"),
                "a symmetric covariance with these variances",
            )?;
        }
        let joints = [found.residual_rms.len(), found.noise_std.len(), found.units.len()];
        unless(joints == [DOF; 3], format!("{joints:?} joints"), "one residual, noise and unit per joint")?;
        unless(found.termination.was_successful(), format!("{:?}", found.termination), "a successful termination")
    }

    fn misfit(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let mut samples = self.noisy(0);
        // A torque that no column has: a ripple over joint 1.
        for k in 0..samples.len() {
            let ripple = libm::sin(25.0 * samples.states.q(k)[0]);
            samples.tau[k * DOF] += 10.0 * self.sigma[0] * ripple;
        }
        let found = self.made(law, estimator, &samples)?;
        let reported = |finding: &Finding| matches!(finding, Finding::ResidualAboveNoise { joint: 1, .. });
        let holds = found.findings.iter().any(reported);
        LawError::unless(
            law.sentence(),
            holds,
            format!("{:?}", found.findings),
            "a residual above the noise of joint 1",
        )
    }

    fn coverage(&self, law: EstimatorLaw, estimator: &dyn Estimator) -> Result<(), LawError> {
        let (mut covered, mut all) = (0_u32, 0_u32);
        for run in 0..EXPERIMENTS {
            let found = self.made(law, estimator, &self.noisy(run))?;
            for (parameter, &truth) in found.base.iter().zip(self.beta.iter()) {
                covered += u32::from(parameter.ci95[0] <= truth && truth <= parameter.ci95[1]);
                all += 1;
            }
        }
        let share = f64::from(covered) / f64::from(all);
        let holds = (COVERAGE[0]..=COVERAGE[1]).contains(&share);
        LawError::unless(law.sentence(), holds, format!("{share:.3} of {all}"), format!("{COVERAGE:?}"))
    }
}

/// A set a tenth above another one.
fn tenth_off(robot: &Robot, columns: Columns, of: &StandardParameters) -> StandardParameters {
    StandardParameters::from_vector(robot, columns, (of.vector(robot, columns) * 1.1).as_slice())
}

fn refused(law: EstimatorLaw, error: &EstimationError) -> LawError {
    LawError::failed(law.sentence(), error, "an estimate")
}

/// Whether the second estimate is the first with parameter j in a unit `factor(j)` times smaller.
fn same(law: EstimatorLaw, first: &Estimate, second: &Estimate, factor: impl Fn(usize) -> f64) -> Result<(), LawError> {
    for (j, (first, second)) in first.base.iter().zip(&second.base).enumerate() {
        let factor = factor(j);
        let values = (second.value / factor - first.value).abs() / first.std;
        let deviations = (second.std / factor / first.std - 1.0).abs();
        LawError::unless_at_most(law.sentence(), values.max(deviations), EQUAL)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::EstimatorKind;

    #[test]
    fn laws_of_ordinary_least_squares() {
        check(&EstimatorKind::Ols).unwrap();
    }

    #[test]
    fn laws_of_weighted_least_squares() {
        check(&EstimatorKind::Wls).unwrap();
    }

    #[test]
    fn laws_of_every_listed_estimator() {
        let broken =
            EstimatorKind::ALL.iter().filter_map(|kind| Some(format!("{}: {}", kind.name(), check(kind).err()?)));
        let broken: Vec<String> = broken.collect();
        assert!(broken.is_empty(), "{}", broken.join("\n"));
    }

    #[test]
    fn the_exceptions_of_estimators_that_simulate_are_none_too_many() {
        let setting = Setting::new();
        for kind in [EstimatorKind::Iv, EstimatorKind::Didim, EstimatorKind::Clie, EstimatorKind::Cloe] {
            assert_eq!(kind.estimator().exceptions().len(), 2);
            // The motion of this loop is linear in the parameters: for its exact slope torque of any unit is as good.
            let linear =
                |exception: &&LawException| kind == EstimatorKind::Clie && exception.law == EstimatorLaw::TorqueUnits;
            for exception in kind.estimator().exceptions().iter().filter(|exception| !linear(exception)) {
                let broken = setting.check(exception.law, &kind).expect_err(kind.name());
                let refused = broken.found.contains("estimator") && broken.found.contains("needs the robot");
                assert_eq!(refused, exception.law == EstimatorLaw::ParameterUnits, "{broken}");
            }
        }
    }

    #[test]
    fn every_listed_estimator_declares_its_exceptions_with_a_reason() {
        for kind in EstimatorKind::ALL {
            assert!(kind.estimator().exceptions().iter().all(|exception| !exception.reason.is_empty()));
        }
    }

    /// Ordinary least squares with one number of its answer spoiled.
    #[derive(Debug)]
    struct Spoiled(fn(&mut Estimate), &'static [LawException]);

    impl Estimator for Spoiled {
        fn name(&self) -> &'static str {
            "ols"
        }

        fn summary(&self) -> &'static str {
            "spoiled"
        }

        fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
            let mut estimate = EstimatorKind::Ols.estimate(problem)?;
            (self.0)(&mut estimate);
            Ok(estimate)
        }

        fn exceptions(&self) -> &[LawException] {
            self.1
        }
    }

    #[test]
    fn each_law_catches_an_estimator_that_breaks_it() {
        let broken = |spoil: fn(&mut Estimate)| check(&Spoiled(spoil, &[])).unwrap_err().law;
        assert_eq!(broken(|e| e.base[0].value *= 1.0 + 1e-6), EstimatorLaw::Recovery.sentence());
        assert_eq!(broken(|e| e.base[1].std += 1e-3), EstimatorLaw::TorqueUnits.sentence());
        assert_eq!(broken(|e| e.base[0].name.clear()), EstimatorLaw::Report.sentence());
        assert_eq!(broken(|e| e.findings.clear()), EstimatorLaw::Misfit.sentence());
        let narrow = |e: &mut Estimate| {
            for p in &mut e.base {
                let half = 0.5 * (p.ci95[1] - p.value);
                p.ci95 = [p.value - half, p.value + half];
            }
        };
        assert_eq!(broken(narrow), EstimatorLaw::Coverage.sentence());
    }

    #[test]
    fn an_exception_excuses_its_law_and_must_state_a_reason() {
        const SILENT: &[LawException] = &[LawException { law: EstimatorLaw::Misfit, reason: " " }];
        const STATED: &[LawException] = &[LawException { law: EstimatorLaw::Misfit, reason: "it reports nothing" }];
        let silent = check(&Spoiled(|e| e.findings.clear(), SILENT)).unwrap_err();
        assert_eq!(silent.law, "an exception states its reason");
        check(&Spoiled(|e| e.findings.clear(), STATED)).unwrap();
    }
}
