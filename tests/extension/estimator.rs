//! An estimator of one's own: in a program that identifies, in the law suite, and in a study.

use std::sync::Arc;

use armid::base::{Method, reduce};
use armid::conformance::estimator_laws;
use armid::dynamics::Dynamics;
use armid::estimation::{
    Estimate, EstimationError, EstimationProblem, Estimator, EstimatorKind, EstimatorLaw, Inference,
    Instruments as InstrumentRows, IntervalBasis, LawException, Observation, Termination, residual_noise,
    scatter_noise, solve,
};
use armid::linalg::LeastSquares;
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::Samples;
use armid::statistics::student_quantile;
use armid::study::radkhah2007::table_one;
use armid::study::{OwnMethods, StudyPlan, StudySetup, Truth, truth_text};
use nalgebra::{DMatrix, DVector};

/// Huber's M-estimator (P. J. Huber, *Robust Statistics*, 1981, sec. 7.8): residuals beyond `K` standard deviations of the
/// noise count with a weight that falls as their inverse.
#[derive(Debug)]
struct Huber;

const K: f64 = 3.0;

impl Estimator for Huber {
    fn name(&self) -> &'static str {
        "huber"
    }

    fn summary(&self) -> &'static str {
        "least squares in which outliers count less"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let observation = problem.observation;
        let start = solve(observation, &observation.regressor, &observation.y)?;
        let scatter = scatter_noise(observation);
        let mut beta = start.solution().clone();
        let mut last_step = f64::INFINITY;
        let mut termination = None;
        let (mut fit, mut weighted) = (start, observation.regressor.clone());
        for iterations in 1..=50 {
            let residual = observation.residual(&beta);
            let sigma = match &scatter {
                Some(noise) => noise.std(),
                None => residual_noise(observation, &residual).std(),
            };
            let weight = |row: usize| {
                let sigma = sigma[row % observation.dof];
                (K * sigma / residual[row].abs()).min(1.0) / (sigma * sigma)
            };
            let root = |row: usize| weight(row).sqrt();
            let w = scaled(&observation.regressor, root);
            let y = DVector::from_fn(observation.y.len(), |row, _| observation.y[row] * root(row));
            fit = solve(observation, &w, &y)?;
            weighted = scaled(&observation.regressor, weight);
            last_step = (fit.solution() - &beta).norm() / beta.norm();
            beta.copy_from(fit.solution());
            if last_step < 1e-13 {
                termination = Some(Termination::Converged { iterations, last_step });
                break;
            }
        }
        let (noise, basis) = match scatter {
            Some(noise) => (noise, IntervalBasis::Scatter),
            None => (residual_noise(observation, &observation.residual(&beta)), IntervalBasis::Residual),
        };
        Inference {
            estimator: self.name(),
            problem,
            fit: &fit,
            instruments: InstrumentRows::Rows(&weighted),
            noise: &noise,
            basis,
            termination: termination.unwrap_or(Termination::IterationLimit { iterations: 50, last_step }),
        }
        .estimate()
    }
}

/// Every row of a matrix times a factor.
fn scaled(matrix: &DMatrix<f64>, factor: impl Fn(usize) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)] * factor(row))
}

/// Instrumental variables whose instruments are the regressor at the nominal motion, here the samples' own states: it needs
/// robot and samples, and its A = ZᵀW is not symmetric.
#[derive(Debug)]
struct Instruments;

impl Estimator for Instruments {
    fn name(&self) -> &'static str {
        "instruments"
    }

    fn summary(&self) -> &'static str {
        "instrumental variables"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let observation = problem.observation;
        let robot = problem.robot_for(self.name())?;
        let samples = problem.samples_for(self.name())?;
        // Only to show that the column of a parameter that is not excited is named.
        let plain = solve(observation, &observation.regressor, &observation.y)?;
        let regressor = JointTorqueRegressor::new(robot, observation.columns).expect("columns of motion");
        let mut z = observation.base.select_columns(&regressor.stack(&samples.states));
        // Any instruments that are correlated with the regressor and not with the noise do: columns mixed.
        for j in 1..z.ncols() {
            let before = z.column(j - 1) * 0.1;
            let mut column = z.column_mut(j);
            column += before;
        }
        let a = z.tr_mul(&observation.regressor);
        let inverse = a.try_inverse().ok_or(EstimationError::NotDefinite)?;
        let solution = &inverse * z.tr_mul(&observation.y);
        let identity = DMatrix::identity(inverse.nrows(), inverse.nrows());
        let factors = [inverse, identity];
        let fit = LeastSquares::from_factors(solution, factors, plain.condition(), plain.condition_scaled())?;
        let noise = scatter_noise(observation)
            .unwrap_or_else(|| residual_noise(observation, &observation.residual(fit.solution())));
        Inference {
            estimator: self.name(),
            problem,
            fit: &fit,
            instruments: InstrumentRows::Rows(&z),
            noise: &noise,
            basis: if observation.noise.is_some() { IntervalBasis::Scatter } else { IntervalBasis::Residual },
            termination: Termination::Direct,
        }
        .estimate()
    }

    fn exceptions(&self) -> &[LawException] {
        &[LawException {
            law: EstimatorLaw::ParameterUnits,
            reason: "the instruments are made from the robot, whose parameters are in SI units",
        }]
    }
}

/// Weighted least squares of another program, of which numbers alone come back; or its failure, in its own words.
#[derive(Debug)]
struct Foreign {
    fails: bool,
}

impl Estimator for Foreign {
    fn name(&self) -> &'static str {
        "foreign"
    }

    fn summary(&self) -> &'static str {
        "numbers of another program"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        if self.fails {
            return Err(EstimationError::external("the other program has no licence"));
        }
        let known = EstimatorKind::Wls.estimator().estimate(problem)?;
        let b = known.base.len();
        let covariance = DMatrix::from_fn(b, b, |i, j| known.covariance[i][j]);
        Estimate::of(self.name(), problem, &known.beta(), &covariance, known.degrees_of_freedom)
    }
}

#[test]
fn an_iterating_estimator_from_outside_obeys_the_laws() {
    estimator_laws::check(&Huber).unwrap();
}

#[test]
fn an_estimator_that_is_no_least_squares_obeys_the_laws_but_for_its_exception() {
    estimator_laws::check(&Instruments).unwrap();
}

#[test]
fn an_estimator_from_outside_identifies_and_names_what_it_lacks() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let states = table_one::corrected().sample(200);
    let mut dynamics = Dynamics::new(&robot, &nominal);
    let mut tau = vec![0.0; states.len() * robot.dof()];
    for (k, tau) in tau.chunks_exact_mut(robot.dof()).enumerate() {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
    }
    // One sample in fifty is an outlier of 100 N·m.
    let clean = tau.clone();
    for row in (0..tau.len()).step_by(53) {
        tau[row] += 100.0;
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); robot.dof()], 20.0);
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let problem = EstimationProblem::new(&observation);
    let error = |estimator: &dyn Estimator| {
        let beta = estimator.estimate(&problem).unwrap().beta();
        let predicted = &observation.regressor * beta;
        (predicted - DVector::from_column_slice(&clean)).norm()
    };
    assert!(error(&Huber) < 0.5 * error(&EstimatorKind::Ols), "{} {}", error(&Huber), error(&EstimatorKind::Ols));
    // Numbers become the estimate that they are of; what fails says so in its own words.
    let wls = EstimatorKind::Wls.estimator().estimate(&problem).unwrap();
    let found = Foreign { fails: false }.estimate(&problem).unwrap();
    assert_eq!((found.estimator.as_str(), found.beta(), found.names()), ("foreign", wls.beta(), wls.names()));
    let t = student_quantile(0.975, wls.degrees_of_freedom);
    for (own, known) in found.base.iter().zip(&wls.base) {
        assert!((own.std / known.std - 1.0).abs() < 1e-12, "{own:?} {known:?}");
        assert!((own.ci95[1] - own.value - t * own.std).abs() < 1e-9 * own.std, "{own:?}");
    }
    let error = Foreign { fails: true }.estimate(&problem).unwrap_err();
    let EstimationError::External(own) = &error else { panic!("{error}") };
    assert_eq!(own.0.to_string(), "the other program has no licence");
    let lacking = Instruments.estimate(&problem).unwrap_err();
    assert_eq!(lacking, EstimationError::Missing { estimator: "instruments".to_owned(), part: "the robot" });
}

const PLAN: &str = r#"
name = "own estimator"
question = "Does an estimator from outside take part in a study?"
robot = "crs-a460"
seed = 1
runs = 1

[experiment]
period_s = 10.0
harmonics = 5
rate_hz = 100.0
periods = 2
discarded_periods = 1

[identification]
columns = "rigid"
derivatives = "fourier"
samples_per_period = 100
estimators = ["ols"]

[validation]
trajectories = 1
samples = 50

[reference]
mass_kg = 1.0
first_moment_kg_m = 0.1
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 1.0
torque_nm = 1.0

[[design]]
name = "table-one"
method = "table-one"
starts = 1
"#;

#[test]
fn an_estimator_from_outside_takes_part_in_a_study() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let truth = Truth::from_toml(truth_text("crs-a460").unwrap(), &robot).unwrap();
    let mut plan = StudyPlan::from_toml(PLAN).unwrap();
    plan.identification.estimators.push("huber".to_owned());
    assert!(StudySetup::new(plan.clone(), robot.clone(), nominal.clone(), &truth).is_err());
    let own = OwnMethods { estimators: vec![Arc::new(Huber)], criteria: Vec::new() };
    let setup = StudySetup::with_methods(plan, robot.clone(), nominal, &truth, own).unwrap();
    let states = table_one::corrected().sample(100);
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).expect("columns of motion");
    let tau = regressor.stack(&states) * truth.vector(&robot, Columns::RIGID);
    let samples = Samples::exact(states, tau.as_slice().to_vec(), vec!["N·m".to_owned(); robot.dof()], 10.0);
    let scored = setup.estimates(&samples, 0);
    assert_eq!(scored.iter().map(|estimate| estimate.estimator.as_str()).collect::<Vec<_>>(), ["ols", "huber"]);
    for estimate in scored {
        assert!(estimate.score.unwrap().prediction_rmse_nm < 1e-8);
    }
}
