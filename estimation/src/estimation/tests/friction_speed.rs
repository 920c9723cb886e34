//! Speeds of laws of friction: found of exact and of noisy torque, and none where no friction has one.

use rand_distr::{Distribution, StandardNormal};

use crate::chains::random_robot;
use crate::dynamics::{Dynamics, States};
use crate::estimation::speed_columns::SpeedColumns;
use crate::estimation::{EstimatorKind, FrictionSpeeds, Identification};
use crate::model::format::parse_robot;
use crate::model::term::{COULOMB, LOAD_FRICTION, MOTOR_STRIBECK, ROTOR, STRIBECK, ShapeParameter, Stribeck, VISCOUS};
use crate::model::{Columns, Robot, StandardParameters, bundled};
use crate::observer::Unobserved;
use crate::seed::Seed;
use crate::signal::{Butterworth, Derivatives, Samples};

/// Speed at which the friction of the arm falls, and that of its robot file.
const TRUE_SPEED: f64 = 0.2;
const STATED_SPEED: f64 = 0.1;
/// Static above Coulomb friction, N·m.
const AMPLITUDE: f64 = 4.0;

fn columns() -> Columns {
    Columns::RIGID_ROTOR_FRICTION.with_term(STRIBECK)
}

/// The robot with one Stribeck velocity in all drives.
fn with_speed(robot: &Robot, speed: f64) -> Robot {
    with_speeds(robot, Stribeck::VELOCITY, &vec![speed; robot.dof()])
}

fn with_speeds(robot: &Robot, shape: ShapeParameter, speeds: &[f64]) -> Robot {
    let mut drives: Vec<_> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
    for (drive, speed) in drives.iter_mut().zip(speeds) {
        drive.set_shape(&shape, *speed);
    }
    robot.clone().with_drives(drives)
}

/// A slow periodic motion of `n` joints.
fn motion(n: usize, count: usize) -> States {
    let mut states = States::new(n);
    for k in 0..count {
        let t = k as f64 / 60.0;
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            for l in 1..=5 {
                let (w, phase) = (0.628 * f64::from(l), 1.3 * f64::from(l) + 2.1 * i as f64);
                let amplitude = 0.5 / f64::from(l);
                q[i] += amplitude * libm::sin(w * t + phase);
                qd[i] += amplitude * w * libm::cos(w * t + phase);
                qdd[i] -= amplitude * w * w * libm::sin(w * t + phase);
            }
        }
        states.push(&q, &qd, &qdd);
    }
    states
}

/// A drawn arm of three joints whose friction falls by `amplitudes` at the true speed, as its robot file has it, with torque on that motion
/// and noise of standard deviation `noise`.
fn recording(seed: u64, amplitudes: [f64; 3], noise: f64) -> (Robot, Samples) {
    let source = Seed::new(seed);
    let (robot, drawn) = random_robot(&mut source.stream("arm", 0), 3);
    let robot = with_speed(&robot, STATED_SPEED);
    let mut truth = StandardParameters { links: drawn.links, ..StandardParameters::zero(3) };
    for (drive, amplitude) in truth.drives.iter_mut().zip(amplitudes) {
        for (term, value) in [(ROTOR, 0.3), (VISCOUS, 4.0), (COULOMB, 4.0), (STRIBECK, amplitude)] {
            drive[term] = value;
        }
    }
    let samples = torque(&with_speed(&robot, TRUE_SPEED), &truth, noise, &source);
    (robot, samples)
}

/// A drawn arm whose Coulomb friction sets in with these speeds, and grows by `load` with the torque of the links; its robot file states none.
pub(super) fn onset_recording(
    seed: u64,
    speeds: [f64; 3],
    load: f64,
    noise: f64,
) -> (Robot, StandardParameters, Samples) {
    let source = Seed::new(seed);
    let (robot, drawn) = random_robot(&mut source.stream("arm", 0), 3);
    let robot = with_speeds(&robot, ShapeParameter::COULOMB_VELOCITY, &[0.0; 3]);
    let mut truth = StandardParameters { links: drawn.links, ..StandardParameters::zero(3) };
    for drive in &mut truth.drives {
        for (term, value) in [(ROTOR, 0.3), (VISCOUS, 4.0), (COULOMB, 4.0), (LOAD_FRICTION, load)] {
            drive[term] = value;
        }
    }
    // A rotor that shows only in a sum with its link would count as the link.
    truth.drives[0][ROTOR] = 0.0;
    let samples = torque(&with_speeds(&robot, ShapeParameter::COULOMB_VELOCITY, &speeds), &truth, noise, &source);
    (robot, truth, samples)
}

/// Torque of an arm on that motion, with noise.
fn torque(robot: &Robot, truth: &StandardParameters, noise: f64, source: &Seed) -> Samples {
    let (states, mut rng) = (motion(3, 900), source.stream("noise", 0));
    let mut tau = Vec::new();
    for k in 0..states.len() {
        let mut one = [0.0; 3];
        Dynamics::new(robot, truth).inverse(states.q(k), states.qd(k), states.qdd(k), &mut one);
        for of in one {
            let z: f64 = StandardNormal.sample(&mut rng);
            tau.push(of + noise * z);
        }
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); 3], 60.0)
}

fn found(robot: &Robot, samples: &Samples) -> FrictionSpeeds {
    let identification = Identification::new(robot, columns()).unwrap();
    identification.friction_speeds(samples, Stribeck::VELOCITY, &Unobserved).unwrap().expect("Stribeck columns")
}

pub(super) fn onset(robot: &Robot, columns: Columns, samples: &Samples) -> FrictionSpeeds {
    let identification = Identification::new(robot, columns).unwrap();
    identification
        .friction_speeds(samples, ShapeParameter::COULOMB_VELOCITY, &Unobserved)
        .unwrap()
        .expect("Coulomb columns")
}

#[test]
fn analytic_exact_torque_gives_the_speed_of_the_arm() {
    let (robot, samples) = recording(11, [AMPLITUDE; 3], 0.0);
    let speeds = found(&robot, &samples);
    assert!(speeds.termination.was_successful() && speeds.joints_not_shown().is_empty(), "{speeds:?}");
    for joint in &speeds.joints {
        // Nothing is left at the truth, where Gauss–Newton is quadratic: behind a step of 1e-6 rounding alone is left.
        let (speed, amplitude) = (joint.speed.unwrap().value, joint.amplitude.unwrap().value);
        assert_eq!(joint.stated, STATED_SPEED);
        assert!((speed / TRUE_SPEED - 1.0).abs() < 1e-8, "{joint:?}");
        assert!((amplitude / AMPLITUDE - 1.0).abs() < 1e-8, "{joint:?}");
    }
    assert!(speeds.weighted_rms[1] < 1e-6 * speeds.weighted_rms[0], "{:?}", speeds.weighted_rms);
    // The whole estimate at these speeds is that of the arm.
    let moved = speeds.robot(&robot);
    let identification = Identification::new(&moved, columns()).unwrap();
    let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator()).unwrap();
    let of_joint = estimate.base.iter().find(|of| of.name == "Fs2").expect("the amplitude of joint 2");
    assert!((of_joint.value / AMPLITUDE - 1.0).abs() < 1e-8, "{of_joint:?}");
}

#[test]
fn analytic_intervals_of_noisy_torque_hold_the_speed_of_the_arm() {
    let (mut held, mut all) = ([0, 0], 0);
    for seed in 20..30 {
        let (robot, samples) = recording(seed, [AMPLITUDE; 3], 0.2);
        let speeds = found(&robot, &samples);
        assert!(speeds.termination.was_successful() && speeds.joints_not_shown().is_empty(), "{seed}: {speeds:?}");
        assert!(speeds.weighted_rms[1] < speeds.weighted_rms[0], "{:?}", speeds.weighted_rms);
        for joint in &speeds.joints {
            let (speed, amplitude) = (joint.speed.unwrap(), joint.amplitude.unwrap());
            all += 1;
            held[0] += usize::from(speed.ci95[0] <= TRUE_SPEED && TRUE_SPEED <= speed.ci95[1]);
            held[1] += usize::from(amplitude.ci95[0] <= AMPLITUDE && AMPLITUDE <= amplitude.ci95[1]);
            // An interval that says something.
            assert!(speed.std < 0.2 * TRUE_SPEED, "{seed}: {joint:?}");
        }
    }
    // 95 % of 30; fewer than 25 have a probability of 1e-3.
    assert!(all == 30 && held.iter().all(|held| *held >= 25), "{held:?} of {all}");
}

#[test]
fn analytic_an_arm_whose_friction_does_not_fall_has_no_speed() {
    for seed in 40..44 {
        let (robot, samples) = recording(seed, [0.0; 3], 0.2);
        let speeds = found(&robot, &samples);
        assert_eq!(speeds.joints_not_shown(), [1, 2, 3], "{seed}: {speeds:?}");
        assert_eq!(speeds.robot(&robot), robot);
    }
    // Nor has a joint beside one that has.
    let (robot, samples) = recording(45, [AMPLITUDE, 0.0, AMPLITUDE], 0.2);
    let speeds = found(&robot, &samples);
    assert_eq!(speeds.joints_not_shown(), [2], "{speeds:?}");
    let drives = speeds.robot(&robot);
    assert_eq!(drives.joints()[1].drive.shape(&Stribeck::VELOCITY), STATED_SPEED);
    assert_eq!(Some(drives.joints()[0].drive.shape(&Stribeck::VELOCITY)), speeds.joints[0].speed.map(|of| of.value));
    // Without a column there is nothing to seek.
    let plain = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
    assert_eq!(plain.friction_speeds(&samples, Stribeck::VELOCITY, &Unobserved).unwrap(), None);
}

#[test]
fn analytic_exact_torque_gives_the_onset_of_the_arm_with_and_without_friction_of_the_load() {
    for load in [0.0, 0.06] {
        let truth = [0.2, 0.05, 0.1];
        let (robot, _, samples) = onset_recording(12, truth, load, 0.0);
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let speeds = onset(&robot, if load > 0.0 { columns.with_term(LOAD_FRICTION) } else { columns }, &samples);
        assert!(speeds.joints_not_shown().is_empty() && speeds.predict_better(), "{speeds:?}");
        for (joint, truth) in speeds.joints.iter().zip(truth) {
            let (speed, amplitude) = (joint.speed.unwrap().value, joint.amplitude.unwrap().value);
            // With friction of the load, the alternation of load and speeds ends at a change of 1e-4.
            let most = if load > 0.0 { 1e-3 } else { 1e-7 };
            assert!((speed / truth - 1.0).abs() < most && (amplitude / 4.0 - 1.0).abs() < most, "{load}: {joint:?}");
        }
    }
}

#[test]
fn analytic_intervals_hold_the_onset_and_a_plain_sign_shows_none() {
    let (mut held, mut all) = (0, 0);
    for seed in 50..60 {
        let truth = [0.2, 0.1, 0.3];
        let (robot, _, samples) = onset_recording(seed, truth, 0.0, 0.2);
        let speeds = onset(&robot, Columns::RIGID_ROTOR_FRICTION, &samples);
        for (joint, truth) in speeds.joints.iter().zip(truth) {
            let Some(speed) = joint.speed else { panic!("{seed}: {joint:?}") };
            all += 1;
            held += usize::from(speed.ci95[0] <= truth && truth <= speed.ci95[1]);
        }
        assert!(speeds.predict_better(), "{seed}: {:?}", speeds.held_out);
    }
    // As above.
    assert!(all == 30 && held >= 25, "{held} of {all}");
    for seed in 60..64 {
        let (robot, _, samples) = onset_recording(seed, [0.0; 3], 0.0, 0.2);
        let speeds = onset(&robot, Columns::RIGID_ROTOR_FRICTION, &samples);
        assert_eq!(speeds.joints_not_shown(), [1, 2, 3], "{seed}: {speeds:?}");
        assert_eq!((speeds.robot(&robot), speeds.held_out), (robot, None));
    }
}

/// On the TX40, whose wrist motors are coupled, at block means.
#[test]
fn identity_columns_are_those_of_the_regressor_and_slopes_their_central_differences() {
    let entry = bundled().iter().find(|entry| entry.name == "staubli-tx40").expect("the TX40 is bundled");
    let robot = with_speed(&parse_robot(entry.robot).unwrap(), 0.3);
    assert!(robot.coupling().is_some());
    let states = motion(6, 300);
    let tau = vec![0.0; 1800];
    let samples = Samples { block: 3, ..Samples::exact(states, tau, vec!["N·m".to_owned(); 6], 60.0) };
    let samples = Samples { used: vec![true; 600], ..samples };
    let identification = |robot: &Robot| {
        let identification = Identification::new(robot, columns().with_term(MOTOR_STRIBECK)).unwrap();
        identification.observation(&samples).unwrap()
    };
    let observation = identification(&robot);
    let of = SpeedColumns::of(&robot, &observation, &samples, Stribeck::VELOCITY);
    let n = of.joints.len();
    assert_eq!(n, 6);
    for speed in [0.05, 0.3, 0.7] {
        let by_regressor = identification(&with_speed(&robot, speed));
        let found = of.observation_at(&observation, &vec![speed; n]);
        assert!((found.regressor - by_regressor.regressor).amax() < 1e-12, "{speed}");
    }
    let beta = nalgebra::DVector::from_fn(observation.base.rank(), |j, _| 1.0 + 0.1 * j as f64);
    let (speed, h) = (0.3, 1e-5);
    let slopes = of.with_slopes(&observation, &vec![speed; n], &beta, &vec![true; n]);
    assert_eq!(slopes.base.rank(), observation.base.rank() + n);
    for joint in 0..n {
        let torque = |logarithm: f64| {
            let mut speeds = vec![speed; n];
            speeds[joint] = speed * libm::exp(logarithm);
            of.observation_at(&observation, &speeds).regressor * &beta
        };
        let difference = (torque(h) - torque(-h)) / (2.0 * h);
        // Truncation h² and rounding 1e-16/h, of a torque of some ten.
        let slope = slopes.regressor.column(observation.base.rank() + joint);
        assert!((difference - slope).amax() < 1e-8, "{joint}");
        assert!(slope.amax() > 0.1, "{joint}");
    }
}

/// Friction behind the low pass of the torque: the columns go through it too, those of the search as those of the regressor.
#[test]
fn identity_friction_columns_pass_the_low_pass_of_the_torque() {
    let (robot, truth, plain) = onset_recording(13, [0.2, 0.1, 0.3], 0.0, 0.0);
    let moved = with_speeds(&robot, ShapeParameter::COULOMB_VELOCITY, &[0.2, 0.1, 0.3]);
    let rigid = Columns::RIGID.with_term(ROTOR);
    let mut smooth = truth.clone();
    smooth.drives.iter_mut().for_each(|drive| *drive = drive.only(|term| rigid.has(term) || term == VISCOUS));
    let base = torque(&moved, &smooth, 0.0, &Seed::new(13)).tau;
    let filter = Butterworth::new(4, 3.0, 60.0).unwrap();
    let mut tau = base.clone();
    for i in 0..3 {
        let friction = (0..900).map(|k| plain.tau[3 * k + i] - base[3 * k + i]).collect::<Vec<_>>();
        for (k, value) in filter.zero_phase_reflected(&friction, 1).into_iter().enumerate() {
            tau[3 * k + i] += value;
        }
    }
    let samples = Samples { tau, torque_band_hz: Some(3.0), derivatives: Derivatives::Differences, ..plain };
    let speeds = onset(&robot, Columns::RIGID_ROTOR_FRICTION, &samples);
    for (joint, truth) in speeds.joints.iter().zip([0.2, 0.1, 0.3]) {
        let (speed, amplitude) = (joint.speed.unwrap().value, joint.amplitude.unwrap().value);
        assert!((speed / truth - 1.0).abs() < 1e-7 && (amplitude / 4.0 - 1.0).abs() < 1e-7, "{joint:?}");
    }
}
