//! What a design expects of an effect is what the simulated arm with it does to an estimate.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::base::{Method, reduce};
use armid::estimation::{EstimationProblem, Estimator, EstimatorKind, Observation};
use armid::excitation::criterion::{ModelError, Prediction};
use armid::excitation::{EffectTorques, Information, radkhah2007_start};
use armid::experiment::{ActualArm, EffectKind, Effects, ExperimentPlan, Level, Sensing, Servo, record};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid_sim::AnalyticPlant;
use nalgebra::DVector;

/// Samples of one period: of the estimates, and of the law, whose derivatives jump where friction turns over.
const SAMPLES: usize = 200;
const FINE: usize = 1000;

#[test]
fn simulated_bias_of_predicted_torque_is_the_one_that_the_criterion_expects() {
    let robot = parse_robot(bundled()[0].robot).unwrap();
    let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap().parameters;
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let (n, base) = (robot.dof(), reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap());
    let motion = |index: u64| radkhah2007_start(&robot, 10.0, 5, Seed::new(8), index).unwrap();
    let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
    // The arm is the nominal one, so that what is left between the two is the law of the effect alone.
    let estimate = |effects: &Effects, periods: usize| -> DVector<f64> {
        let plan = ExperimentPlan { periods, ..ExperimentPlan::new(motion(0)) };
        let arm = ActualArm::new(effects, &robot, &nominal);
        let plant = AnalyticPlant::new(arm.robot(), arm.parameters()).unwrap();
        let mut servo = Servo::new(&robot, &nominal, plant).unwrap().with_sensing(Sensing::ideal()).with_effects(arm);
        let (recording, ending) = record(&mut servo, &plan).unwrap();
        assert!(ending.is_complete(), "{ending:?}");
        let processing = Processing { samples_per_period: SAMPLES, reversal_fraction: 0.1, ..Processing::default() };
        let samples = process(&recording, &robot, &processing).unwrap();
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        EstimatorKind::Ols.estimate(&EstimationProblem::new(&observation)).unwrap().beta()
    };
    let without = estimate(&Effects::none(), 1);
    // Fresh motions, on which the torque is predicted.
    let evaluated = base.select_columns(&regressor.stack(&motion(1).sample(SAMPLES)));
    let rms = |torque: &DVector<f64>| torque.norm() / (torque.len() as f64).sqrt();
    let prediction = Prediction {
        gram: evaluated.tr_mul(&evaluated) / evaluated.nrows() as f64,
        // No noise.
        rows: 1e30,
        effects: std::iter::once(0..1).collect(),
        carried: None,
    };
    let states = motion(0).sample(FINE);
    let mut information = Information::new(regressor.clone(), &base.kept, FINE, &vec![1.0; n], None);
    let m = information.gather(&states);
    // Size, and torque moment by moment, relative. Where a joint reverses, links on springs ring and the loop has its own way
    // with a late current, which no law of the planned motion knows: equations near reversals are left out, and what is
    // left of both shows.
    for (kind, periods, size, shape) in [
        (EffectKind::LoadFriction, 1, 0.03, 0.12),
        (EffectKind::CurrentLag, 1, 0.3, 0.6),
        (EffectKind::Elasticity, 1, 0.1, 0.55),
        // Gears warm up meanwhile: the law has the mean of the first minute, the experiment that of its recorded periods.
        (EffectKind::Warming, 5, 0.2, 0.25),
    ] {
        let effects = Effects::only(kind, Level::Realistic);
        let simulated = &evaluated * (estimate(&effects, periods) - &without);
        let expected = effects.expected(&robot, &nominal).unwrap();
        let d = EffectTorques::new(&robot, &expected, FINE, 10.0).evaluate(&states);
        let c = information.moments(&d);
        let found = ModelError::new(prediction.clone()).errors(&m, &c)[1];
        let error = found / rms(&simulated) - 1.0;
        assert!(error.abs() < size, "{kind:?}: expected {found} N·m, simulated {} N·m", rms(&simulated));
        // Not its size alone: the same torque, moment by moment.
        let by_law = &evaluated * m.clone().cholesky().unwrap().solve(&c.column(0).into_owned());
        let apart = rms(&(&simulated - by_law)) / rms(&simulated);
        assert!(apart < shape, "{kind:?}: apart by {apart}");
    }
}
