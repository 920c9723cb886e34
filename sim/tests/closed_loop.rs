//! The whole simulated arm: servo, sensors and phases around the analytic plant.
#![allow(clippy::unwrap_used, reason = "a test panics")]

use armid::base::{Method, reduce};
use armid::conformance::arm_laws::{self, ArmTolerance};
use armid::dynamics::{Dynamics, States};
use armid::estimation::{EstimationProblem, EstimatorKind, Observation};
use armid::experiment::{Discarding, ExperimentPlan, Phase, Recording, Sensing, Servo, Tracking, record};
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid::trajectory::FourierTrajectory;
use armid_sim::{AnalyticPlant, BatchRun, record_runs};

fn arm(name: &str) -> (Robot, StandardParameters, Servo<AnalyticPlant>) {
    let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let truth = parse_parameters(truth_text(name).unwrap(), &robot, true).unwrap().parameters;
    let plant = AnalyticPlant::new(&robot, &truth).unwrap();
    let servo = Servo::new(&robot, &nominal, plant).unwrap().with_robot_text(entry.robot);
    (robot, truth, servo)
}

fn table_one_plan(periods: usize) -> ExperimentPlan {
    ExperimentPlan::new(table_one::corrected()).with_periods(periods)
}

#[test]
fn published_table_one_is_followed_inside_ratings_and_currents() {
    let (robot, _, servo) = arm("crs-a460");
    assert_eq!(table_one_plan(1).check_limits(&robot), Ok(()));
    let mut servo = servo.with_seed(Seed::new(1), 0);
    let (recording, ending) = record(&mut servo, &table_one_plan(1)).unwrap();
    assert!(ending.is_complete());
    let Tracking { peak_error, peak_effort, saturated_steps, .. } = servo.tracking().unwrap();
    // Measured: 3.5, 6.0, 5.3, 13, 16, 17 mrad; friction turns over in the wrist, whose inertia is small.
    for (error, most) in peak_error.iter().zip([0.005, 0.008, 0.007, 0.016, 0.019, 0.020]) {
        assert!(*error < most, "{peak_error:?}");
    }
    for (effort, joint) in peak_effort.iter().zip(robot.joints()) {
        assert!(*effort < 0.95 * joint.limits.torque, "{peak_effort:?}");
    }
    assert_eq!(*saturated_steps, 0);
    assert_eq!(recording.periods(), 1);
    assert!(recording.robot_text.starts_with("# CRS A460") && recording.provenance.seed == Some(Seed::new(1)));
}

/// Largest difference between the recorded periods `p` and `p + 1`.
fn between(recording: &Recording, p: usize) -> (f64, f64) {
    let n = recording.dof;
    let (a, b) = (recording.period(p), recording.period(p + 1));
    let most = |values: &[f64]| {
        let (a, b) = (&values[a.start * n..a.end * n], &values[b.start * n..b.end * n]);
        a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    (most(&recording.q), most(&recording.effort))
}

#[test]
fn identity_after_one_discarded_period_the_motion_repeats() {
    for name in ["crs-a460", "puma-560"] {
        let (robot, _, servo) = arm(name);
        let mut plan = table_one_plan(2);
        if name != "crs-a460" {
            plan.trajectory = gentle(&robot, 10.0).into();
        }
        let ideal = record(&mut servo.clone().with_sensing(Sensing::ideal()), &plan).unwrap().0;
        // The transient of the ramp has died out: what is left is rounding.
        let (q, current) = between(&ideal, 0);
        assert!(q < 1e-14 && current < 1e-10, "{name}: {q:e} rad {current:e} A");
        // Without the discarded period it has not.
        let hasty = ExperimentPlan { discarded_periods: 0, ..plan.clone() };
        let (q, _) = between(&record(&mut servo.clone().with_sensing(Sensing::ideal()), &hasty).unwrap().0, 0);
        assert!(q > 1e-6, "{name}: {q:e} rad");
        // Encoders that count leave one count between periods.
        let counted = record(&mut servo.with_sensing(Sensing::noise_free()), &plan).unwrap().0;
        let step = robot.joints().iter().map(|joint| joint.drive.encoder_step(true)).fold(0.0, f64::max);
        let (q, _) = between(&counted, 0);
        assert!(q < 1.01 * step, "{name}: {q:e} rad, one count is {step:e}");
    }
}

/// `radkhah2007`'s motion at six tenths of its speed, about the middle of another arm's range.
fn gentle(robot: &Robot, period_s: f64) -> FourierTrajectory {
    let mut trajectory = FourierTrajectory { period_s, ..table_one::corrected() };
    for (series, joint) in trajectory.joints.iter_mut().zip(robot.joints()) {
        let (low, high) = joint.limits.position;
        series.q0 = 0.5 * (low + high);
        for amplitude in series.a.iter_mut().chain(&mut series.b) {
            *amplitude *= 0.6;
        }
    }
    trajectory
}

#[test]
fn identity_true_states_and_torques_satisfy_the_regressor() {
    // At every sample the torques held from then on, the true state and the acceleration that core forward dynamics
    // give it lie on τ = Y φ of the truth, friction included.
    let (robot, truth, servo) = arm("crs-a460");
    let mut servo = servo.with_sensing(Sensing::ideal());
    let mut dynamics = Dynamics::new(&robot, &truth);
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).expect("columns of motion");
    let phi = truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION);
    let mut y = vec![0.0; regressor.rows() * regressor.cols()];
    let mut worst: f64 = 0.0;
    let mut states = States::new(6);
    servo
        .perform_observed(&table_one_plan(1), &mut Discarding, &mut |state| {
            if state.phase == Phase::Record && state.index % 37 == 0 {
                let mut qdd = [0.0; 6];
                dynamics.forward(state.q, state.qd, state.tau, &mut qdd);
                regressor.evaluate(state.q, state.qd, &qdd, &mut y);
                for (i, row) in y.chunks_exact(phi.len()).enumerate() {
                    let tau: f64 = row.iter().zip(phi.iter()).map(|(a, b)| a * b).sum();
                    worst = worst.max((tau - state.tau[i]).abs());
                }
                states.push(state.q, state.qd, &qdd);
            }
        })
        .unwrap();
    assert!(states.len() > 250 && worst < 1e-11, "{worst:e}");
}

#[test]
fn identity_the_simulated_arm_obeys_the_laws_of_arms() {
    for name in ["crs-a460", "puma-560", "staubli-tx40"] {
        let (robot, _, servo) = arm(name);
        let servo = servo.with_seed(Seed::new(3), 5);
        let plan = ExperimentPlan {
            settle_s: 0.3,
            ramp_s: 0.5,
            periods: 1,
            discarded_periods: 0,
            ..ExperimentPlan::new(gentle(&robot, 2.0))
        };
        // The servo of the TX40 is assumed as slow as the others', although its wrist has much friction and little
        // inertia: 0.2 rad behind.
        let tolerance = ArmTolerance { tracking: 0.25, ..ArmTolerance::SIMULATED };
        arm_laws::check(&plan, &tolerance, || servo.clone()).unwrap_or_else(|broken| panic!("{name}: {broken}"));
    }
}

#[test]
fn identity_runs_together_have_the_bits_of_each_alone() {
    let (robot, _, servo) = arm("crs-a460");
    let plan = ExperimentPlan {
        settle_s: 0.2,
        ramp_s: 0.5,
        periods: 1,
        discarded_periods: 0,
        ..ExperimentPlan::new(gentle(&robot, 2.0))
    };
    // Longer than the others, and one that cannot be performed.
    let longer = plan.clone().with_periods(2);
    let none = plan.clone().with_periods(0);
    let runs: Vec<BatchRun<'_>> = [&plan, &plan, &longer, &none, &plan, &longer]
        .iter()
        .zip(0..)
        .map(|(plan, run)| BatchRun { plan, noise: Seed::new(run % 2).of_run(run) })
        .collect();
    let together = record_runs(&servo, &runs);
    assert_eq!(together.len(), runs.len());
    for (member, other) in runs.iter().zip(together) {
        let alone = record(&mut servo.clone().with_noise(member.noise), member.plan);
        assert!(alone == other, "run {}", member.noise.run);
        assert_eq!(alone.is_err(), std::ptr::eq(member.plan, &raw const none), "run {}", member.noise.run);
    }
}

#[test]
fn identity_the_whole_chain_without_noise_recovers_the_parameters() {
    // Servo, encoder counts, averaging, derivatives, decimation, least squares: what remains is what counts and
    // reversals of friction leave in velocity and acceleration.
    let (robot, truth, servo) = arm("crs-a460");
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).expect("columns of motion");
    let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(1)).unwrap();
    let beta = base.beta(&truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
    let error = |sensing: Sensing| {
        let recording = record(&mut servo.clone().with_sensing(sensing), &table_one_plan(2)).unwrap().0;
        let samples = process(&recording, &robot, &Processing::default()).unwrap();
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let problem =
            EstimationProblem { robot: Some(&robot), samples: Some(&samples), ..EstimationProblem::new(&observation) };
        let estimate = EstimatorKind::Ols.estimator().estimate(&problem).unwrap();
        (estimate.beta() - &beta).norm() / beta.norm()
    };
    let (ideal, counted) = (error(Sensing::ideal()), error(Sensing::noise_free()));
    // Measured: 2.9e-4 and 3.0e-4.
    assert!(ideal < 6e-4 && counted < 6e-4, "{ideal:e} {counted:e}");
}
