//! Each calibration gives back the constants of a simulated arm within its own intervals.

use crate::model::term;
use nalgebra::Vector3;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::{Measured, Resistance, back_emf, friction, known_load, payload};
use crate::chains::planar_2r;
use crate::dynamics::Dynamics;
use crate::experiment::{ExperimentPlan, Plant, PlantError, Recording, Sensing, Servo, hinges, record};
use crate::model::{Drive, MotorCircuit, Robot, StandardParameters, smooth_sign};
use crate::seed::Seed;
use crate::signal::Samples;
use crate::spatial::Inertia;
use crate::trajectory::{ConstantSpeedTrajectory, FourierJoint, FourierTrajectory};

/// What the motor really is: the robot file says 0.15 N·m/A and 1.5 Ω.
const KT: f64 = 0.1437;
const CIRCUIT: MotorCircuit =
    MotorCircuit { resistance: 1.71, inductance: 1.5e-3, back_emf: KT, brush_drop: 0.83, supply: 70.0 };
const VISCOUS: f64 = 5.2;
const COULOMB: f64 = 4.4;
const SEEDS: u64 = 200;

/// One pendulum with friction: `J q̈ = τ − m g l sin q − Fv q̇ − Fc sgn q̇`.
struct Pendulum {
    q: [f64; 1],
    qd: [f64; 1],
}

impl Plant for Pendulum {
    fn dof(&self) -> usize {
        1
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.qd)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        (self.q[0], self.qd[0]) = (q[0], qd[0]);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        let h = dt / 4.0;
        let force = |q: f64, v: f64| tau[0] - 12.0 * libm::sin(q) - VISCOUS * v - COULOMB * smooth_sign(v, 0.01);
        for _ in 0..4 {
            let a = force(self.q[0], self.qd[0]) / hinges::INERTIA;
            let (q, v) = (self.q[0] + 0.5 * h * self.qd[0], self.qd[0] + 0.5 * h * a);
            let a = force(q, v) / hinges::INERTIA;
            self.q[0] += h * v;
            self.qd[0] += h * a;
        }
        Ok(())
    }
}

fn robot() -> Robot {
    let robot = hinges::single();
    let guess = MotorCircuit { resistance: 1.5, back_emf: 0.15, brush_drop: 1.0, ..CIRCUIT };
    let drives = robot.joints().iter().map(|joint| Drive { circuit: Some(guess), ..joint.drive.clone() }).collect();
    robot.with_drives(drives)
}

/// The pendulum there and back at some speeds, without any sensor's fault.
fn clean() -> (Robot, Recording) {
    let robot = robot();
    let speeds = [0.2, 0.5, 0.9, 1.4, 1.9];
    let motion = ConstantSpeedTrajectory::there_and_back(&robot, 0, &speeds, &[0.0], (-1.5, 1.5)).unwrap();
    let plan = ExperimentPlan { periods: 3, ..ExperimentPlan::new(motion) };
    plan.check_limits(&robot).unwrap();
    let motors = vec![Drive { torque_constant: KT, circuit: Some(CIRCUIT), ..robot.joints()[0].drive.clone() }];
    let mut servo = Servo::new(&robot, &hinges::parameters(1), Pendulum { q: [0.0], qd: [0.0] })
        .unwrap()
        .with_motors(motors)
        .with_sensing(Sensing { voltage: true, ..Sensing::ideal() });
    let (recording, ending) = record(&mut servo, &plan).unwrap();
    assert!(ending.is_complete());
    (robot, recording)
}

/// A recording through encoders of 400 000 counts, and meters with 20 mA and 50 mV of white noise.
fn noisy(clean: &Recording, run: u64) -> Recording {
    let mut rng = Seed::new(71).stream("calibration", run);
    let step = std::f64::consts::TAU / 400_000.0;
    let grid: f64 = rng.random_range(-0.5..0.5);
    let mut recording = clean.clone();
    recording.q.iter_mut().for_each(|q| *q = ((*q / step + grid).round()) * step);
    let mut noise =
        |std: f64| -> f64 { std * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng) };
    recording.effort.iter_mut().for_each(|current| *current += noise(0.02));
    recording.voltage.iter_mut().for_each(|voltage| *voltage += noise(0.05));
    recording
}

/// Share of intervals that cover the truth; 95 % are expected, and of 200 fewer than 90 % once in a thousand.
fn assert_covers(what: &str, truth: f64, found: &[Measured]) {
    let covers = |measured: &&Measured| measured.ci95[0] <= truth && truth <= measured.ci95[1];
    let covered = found.iter().filter(covers).count() as f64 / found.len() as f64;
    let mean = found.iter().map(|measured| measured.value).sum::<f64>() / found.len() as f64;
    assert!(covered >= 0.9, "{what}: {covered} of {} intervals cover {truth}, mean {mean}", found.len());
    assert!(found[0].std < 0.05 * truth.abs(), "{what}: an interval that says nothing: {:?}", found[0]);
}

#[test]
fn analytic_back_emf_gives_back_the_circuit_within_its_intervals() {
    let (robot, clean) = clean();
    let runs: Vec<_> =
        (0..SEEDS).map(|run| back_emf(&noisy(&clean, run), &robot, 0, Resistance::Estimated).unwrap()).collect();
    assert_covers("Kt", KT, &runs.iter().map(|run| run.torque_constant).collect::<Vec<_>>());
    assert_covers("V_b", CIRCUIT.brush_drop, &runs.iter().map(|run| run.brush_drop).collect::<Vec<_>>());
    assert_covers("R", CIRCUIT.resistance, &runs.iter().filter_map(|run| run.resistance).collect::<Vec<_>>());
    // With the true resistance known the interval is no wider.
    let known = back_emf(&noisy(&clean, 0), &robot, 0, Resistance::Known(CIRCUIT.resistance)).unwrap();
    assert!(known.resistance.is_none() && known.torque_constant.std <= 1.01 * runs[0].torque_constant.std);
    assert!((known.torque_constant.value - KT).abs() < 1e-3 * KT);
}

#[test]
fn analytic_friction_gives_back_the_law_within_its_intervals() {
    let (robot, clean) = clean();
    // Torque is read through the robot file's torque constant: with the true one it is the true torque.
    let drive = Drive { torque_constant: KT, ..robot.joints()[0].drive.clone() };
    let robot = robot.with_drives(vec![drive]);
    let runs: Vec<_> = (0..SEEDS).map(|run| friction(&noisy(&clean, run), &robot, 0).unwrap()).collect();
    for (what, truth, found) in [
        ("Fv", VISCOUS, runs.iter().map(|run| run.viscous).collect::<Vec<_>>()),
        ("Fc", COULOMB, runs.iter().map(|run| run.coulomb).collect()),
    ] {
        // The servo still settles, which is no noise: a bias below 1 %. About the mean the intervals hold.
        let mean = found.iter().map(|measured| measured.value).sum::<f64>() / found.len() as f64;
        assert!((mean / truth - 1.0).abs() < 0.01, "{what}: mean {mean} of {truth}");
        assert_covers(what, mean, &found);
    }
    let seen = runs.iter().filter(|run| run.stribeck.unwrap().ci95[0] > 0.0).count();
    assert!(seen as f64 <= 0.1 * SEEDS as f64, "{seen} of {SEEDS} see a Stribeck effect that is not there");
    assert_eq!(runs[0].points.len(), 5);
}

#[test]
fn what_is_missing_is_named() {
    let (robot, mut recording) = clean();
    recording.voltage.clear();
    let message = back_emf(&recording, &robot, 0, Resistance::Estimated).unwrap_err().to_string();
    assert!(message.contains("no motor voltages") && message.contains("known payload"), "{message}");
    recording.trajectory = hinges::trajectory(1).into();
    let message = friction(&recording, &robot, 0).unwrap_err().to_string();
    assert!(message.contains("expected segments at constant speed"), "{message}");
}

/// What the robot file's constant is off by: 7 % and −4 %.
const RATIO: [f64; 2] = [1.07, 0.96];

/// Samples of a swinging planar arm without and with a payload on its last link, with noise of 0.05 N·m. Their torque is
/// that of Newton and Euler; a fit has only the regressor.
fn without_and_with(robot: &Robot, load: &Inertia, run: u64) -> [Samples; 2] {
    let mut truth = StandardParameters::zero(2);
    for (i, link) in truth.links.iter_mut().enumerate() {
        *link = payload(2.0 + i as f64, [-0.2, 0.01, 0.0], [0.01, 0.02, 0.03]);
        truth.drives[i][term::VISCOUS] = 0.8;
        truth.drives[i][term::COULOMB] = 0.6;
    }
    let mut heavy = truth.clone();
    heavy.links[1].mass += load.mass;
    heavy.links[1].first_moment += load.first_moment;
    heavy.links[1].rotational += load.rotational;
    let series =
        |name: &str, a: f64| FourierJoint { name: name.into(), a: vec![a, -0.5, 0.3], b: vec![0.4, 0.2, -a], q0: 0.3 };
    let motion = FourierTrajectory::new(4.0, vec![series("shoulder", 0.7), series("elbow", -0.9)]).unwrap();
    let samples = |parameters: &StandardParameters, stream: &str| {
        let states = motion.sample(200);
        let mut rng = Seed::new(5).stream(stream, run);
        let mut dynamics = Dynamics::new(robot, parameters);
        let (mut tau, mut all) = ([0.0; 2], Vec::new());
        for k in 0..states.len() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
            for j in 0..2 {
                let noise: f64 = StandardNormal.sample(&mut rng);
                all.push(tau[j] * RATIO[j] + 0.05 * noise);
            }
        }
        Samples::exact(states, all, vec!["N·m".into(); 2], 50.0)
    };
    [samples(&truth, "without"), samples(&heavy, "with")]
}

#[test]
fn identity_known_load_gives_back_torque_constants_within_their_intervals() {
    let robot = planar_2r();
    let load = payload(1.5, [0.03, 0.02, 0.05], [0.0; 3]);
    let mut found = [Vec::new(), Vec::new()];
    for run in 0..SEEDS {
        let [without, with] = without_and_with(&robot, &load, run);
        let all = known_load(&robot, &without, &with, &load).unwrap();
        assert!(all.hidden.is_empty(), "{all:?}");
        for (joint, one) in all.shown.into_iter().enumerate() {
            found[joint].push(one.torque_constant);
        }
    }
    for joint in 0..2 {
        let truth = robot.joints()[joint].drive.torque_constant / RATIO[joint];
        assert_covers(&robot.joints()[joint].name, truth, &found[joint]);
    }
    assert!((load.com().unwrap() - Vector3::new(0.03, 0.02, 0.05)).norm() < 1e-15);
}

#[test]
fn a_joint_in_which_the_payload_does_not_show_is_named_beside_those_in_which_it_does() {
    let robot = planar_2r();
    let joints = robot.joints();
    // On the axis of the elbow, 0.3 m behind the end of its link: it adds nothing there, and at the shoulder it does.
    let load = payload(1.5, [-0.3, 0.0, 0.0], [0.0; 3]);
    let [without, with] = without_and_with(&robot, &load, 0);
    let found = known_load(&robot, &without, &with, &load).unwrap();
    let ([shown], [hidden]) = (&found.shown[..], &found.hidden[..]) else { panic!("{found:?}") };
    assert_eq!((&shown.joint, &hidden.joint), (&joints[0].name, &joints[1].name));
    let [low, high] = shown.torque_constant.ci95;
    let truth = joints[0].drive.torque_constant / RATIO[0];
    assert!(low < truth && truth < high, "{shown:?}");
    assert!(hidden.load_rms < 1e-12 && hidden.to_string().contains("causes no torque at the joint"), "{hidden}");
    // A payload that drowns in the noise gives no constant, rather than one that may be anything.
    let load = payload(1e-4, [0.03, 0.02, 0.05], [0.0; 3]);
    let [without, with] = without_and_with(&robot, &load, 0);
    let found = known_load(&robot, &without, &with, &load).unwrap();
    assert!(found.shown.is_empty() && found.hidden[0].to_string().contains("its share"), "{found:?}");
}
