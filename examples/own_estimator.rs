//! An estimator of one's own: Huber's, which gives less weight to equations that lie far off. It is one type with three
//! functions; what it needs is in the `EstimationProblem`, and a known estimator finishes the statistics.
//!
//! Source: P. J. Huber, *Robust Statistics*, 1981, chapter 7 (iteratively reweighted least squares).
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, EstimatorKind, Identification};
use armid::experiment::{Effects, ExperimentPlan, Sensing, record};
use armid::model::Columns;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid_io::{robot, trajectory};
use armid_sim::Engine;
use armid_workflow::simulated_arm;

/// Residuals beyond this multiple of their scale count linearly: 95 % efficiency where noise is normal.
const THRESHOLD: f64 = 1.345;

#[derive(Debug)]
struct Huber;

impl Estimator for Huber {
    fn name(&self) -> &'static str {
        "huber"
    }

    fn summary(&self) -> &'static str {
        "least squares in which equations far off count less"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let plain = EstimatorKind::Wls.estimator();
        let mut estimate = plain.estimate(problem)?;
        for _ in 0..10 {
            let mut observation = problem.observation.clone();
            let residual = problem.observation.residual(&estimate.beta());
            for joint in 0..observation.dof {
                let rows: Vec<usize> = (joint..residual.len()).step_by(observation.dof).collect();
                let mut sizes: Vec<f64> =
                    rows.iter().filter(|&&row| observation.used[row]).map(|&row| residual[row].abs()).collect();
                sizes.sort_by(f64::total_cmp);
                let scale = 1.4826 * sizes[sizes.len() / 2];
                for row in rows.into_iter().filter(|&row| residual[row].abs() > THRESHOLD * scale) {
                    let weight = (THRESHOLD * scale / residual[row].abs()).sqrt();
                    observation.y[row] *= weight;
                    observation.regressor.row_mut(row).scale_mut(weight);
                }
            }
            let weighted = EstimationProblem { observation: &observation, ..*problem };
            estimate = plain.estimate(&weighted)?;
        }
        self.name().clone_into(&mut estimate.estimator);
        Ok(estimate)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // An experiment on a simulated arm, and a dozen readings of its torque that are far off. An equation is a mean over many
    // samples: outliers must be rare among the means to be recognised.
    let loaded = robot::find("crs-a460")?;
    let (arm, nominal) = (&loaded.robot, loaded.nominal.as_ref().expect("bundled robots have a nominal file"));
    let simulated = simulated_arm(&loaded, Engine::Analytic, Effects::none())?;
    let truth = &simulated.truth.parameters;
    let plan = ExperimentPlan::new(trajectory::load("table-one", None, arm)?);
    let mut servo = simulated.servo(&Sensing::default())?.with_seed(Seed::new(1), 0);
    let mut samples = process(&record(&mut servo, &plan)?.0, arm, &Processing::default())?;
    for tau in samples.tau.iter_mut().step_by(4999) {
        *tau += 200.0;
    }

    let identification = Identification::new(arm, Columns::RIGID_ROTOR_FRICTION)?.with_nominal(nominal);
    let exact = identification.base().beta(&truth.vector(arm, Columns::RIGID_ROTOR_FRICTION));
    let error = |estimate: &Estimate| (estimate.beta() - &exact).norm();
    let plain = error(&identification.estimate(&samples, EstimatorKind::Wls.estimator())?);
    let robust = error(&identification.estimate(&samples, &Huber)?);
    println!("error of the base parameters: {plain:.4} by wls, {robust:.4} by huber");
    if robust < plain { Ok(()) } else { Err("outliers should disturb huber less".into()) }
}
