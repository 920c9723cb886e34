//! Mistakes that logs are made with, on three robots: which are named, and that sound logs are left alone.

use armid::diagnosis::{Evidence, Mistake, diagnose, standing_joints};
use armid::dynamics::{Dynamics, States};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::signal::Samples;
use armid::study::{Truth, truth_text};
use nalgebra::Vector3;
use rand::{Rng, RngExt};

const ROBOTS: [&str; 3] = ["crs-a460", "puma-560", "staubli-tx40"];
const RATE_HZ: f64 = 50.0;
const SAMPLES: usize = 900;

fn robot(name: &str) -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == name).expect("a bundled robot");
    let robot = parse_robot(entry.robot).expect("a robot");
    let truth = Truth::from_toml(truth_text(name).expect("a truth"), &robot).expect("parameters");
    (robot, truth.parameters)
}

/// What the robot file's author would guess.
fn nominal(robot: &Robot) -> StandardParameters {
    let of = |text| parse_robot(text).expect("a robot");
    let entry = bundled().iter().find(|entry| of(entry.robot).name() == robot.name()).expect("a bundled robot");
    parse_nominal(entry.nominal, robot).expect("parameters").parameters
}

fn uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    rng.random_range(low..high)
}

/// A motion inside the limits, the torque that gives it, and noise of 2 % of each joint's torque.
fn log(robot: &Robot, truth: &StandardParameters, seed: u64) -> Samples {
    let n = robot.dof();
    let mut rng = Seed::new(seed).stream("log", 0);
    let mut waves = Vec::new();
    for joint in robot.joints() {
        let (low, high) = joint.limits.position;
        let (middle, half) = (0.5 * (low.max(-3.0) + high.min(3.0)), 0.5 * (high.min(3.0) - low.max(-3.0)));
        let each: Vec<[f64; 3]> = (0..4)
            .map(|l| {
                let w = 0.5 * f64::from(l + 1) + uniform(&mut rng, 0.0, 0.4);
                [0.2 * half.min(1.2) / f64::from(l + 1).sqrt(), w, uniform(&mut rng, 0.0, 6.0)]
            })
            .collect();
        waves.push((middle + 0.2 * half * uniform(&mut rng, -1.0, 1.0), each));
    }
    let mut dynamics = Dynamics::new(robot, truth);
    let (mut states, mut tau) = (States::new(n), Vec::new());
    for k in 0..SAMPLES {
        let t = k as f64 / RATE_HZ;
        let (mut q, mut qd, mut qdd, mut one) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for (i, (middle, each)) in waves.iter().enumerate() {
            q[i] = *middle;
            for [a, w, phase] in each {
                q[i] += a * (w * t + phase).sin();
                qd[i] += a * w * (w * t + phase).cos();
                qdd[i] -= a * w * w * (w * t + phase).sin();
            }
        }
        dynamics.inverse(&q, &qd, &qdd, &mut one);
        states.push(&q, &qd, &qdd);
        tau.extend(one);
    }
    for i in 0..n {
        let rms = (tau.iter().skip(i).step_by(n).map(|x| x * x).sum::<f64>() / SAMPLES as f64).sqrt();
        for x in tau.iter_mut().skip(i).step_by(n) {
            *x += 0.02 * rms * 1.7 * uniform(&mut rng, -1.0, 1.0);
        }
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); n], RATE_HZ)
}

fn scale_motion(samples: &mut Samples, i: usize, factor: f64) {
    let n = samples.dof();
    let states = &mut samples.states;
    for rows in [&mut states.q, &mut states.qd, &mut states.qdd] {
        rows.iter_mut().skip(i).step_by(n).for_each(|x| *x *= factor);
    }
}

fn scale_effort(samples: &mut Samples, i: usize, factor: f64) {
    let n = samples.dof();
    samples.tau.iter_mut().skip(i).step_by(n).for_each(|x| *x *= factor);
}

fn swap_motion(samples: &mut Samples, a: usize, b: usize) {
    let n = samples.dof();
    let states = &mut samples.states;
    for rows in [&mut states.q, &mut states.qd, &mut states.qdd] {
        rows.chunks_exact_mut(n).for_each(|row| row.swap(a, b));
    }
}

fn swap_effort(samples: &mut Samples, a: usize, b: usize) {
    let n = samples.dof();
    samples.tau.chunks_exact_mut(n).for_each(|row| row.swap(a, b));
}

/// What a mistake does to a log, joint by joint as the mappings would have it.
type Fault = (&'static str, fn(&Robot, &mut Samples), fn(&Mistake) -> bool);

const FAULTS: [Fault; 19] = [
    (
        "degrees",
        |_, s| (0..6).for_each(|i| scale_motion(s, i, 180.0 / std::f64::consts::PI)),
        |m| *m == Mistake::Degrees,
    ),
    (
        "position of joint 2 the other way",
        |_, s| scale_motion(s, 1, -1.0),
        |m| matches!(m, Mistake::PositionSign { joint: 2 } | Mistake::EitherSign { joint: 2 }),
    ),
    (
        "position of joint 3 the other way",
        |_, s| scale_motion(s, 2, -1.0),
        |m| matches!(m, Mistake::PositionSign { joint: 3 } | Mistake::EitherSign { joint: 3 }),
    ),
    (
        "effort of joint 1 the other way",
        |_, s| scale_effort(s, 0, -1.0),
        |m| matches!(m, Mistake::EffortSign { joint: 1 } | Mistake::EitherSign { joint: 1 }),
    ),
    (
        "effort of joint 3 the other way",
        |_, s| scale_effort(s, 2, -1.0),
        |m| matches!(m, Mistake::EffortSign { joint: 3 } | Mistake::EitherSign { joint: 3 }),
    ),
    (
        "joints 2 and 3 exchanged",
        |_, s| {
            swap_motion(s, 1, 2);
            swap_effort(s, 1, 2);
        },
        |m| *m == Mistake::JointsSwapped { joints: [2, 3] },
    ),
    (
        "positions of joints 1 and 2 exchanged",
        |_, s| swap_motion(s, 0, 1),
        |m| *m == Mistake::PositionsSwapped { joints: [1, 2] },
    ),
    (
        "efforts of joints 2 and 4 exchanged",
        |_, s| swap_effort(s, 1, 3),
        |m| *m == Mistake::EffortsSwapped { joints: [2, 4] },
    ),
    (
        "gear of joint 3: positions doubled",
        |_, s| scale_motion(s, 2, 2.0),
        |m| matches!(m, Mistake::PositionScale { joint: 3, factor } if (factor / 0.5 - 1.0).abs() < 0.1),
    ),
    (
        "gear of joint 2: efforts halved",
        |_, s| scale_effort(s, 1, 0.5),
        |m| matches!(m, Mistake::EffortScale { joint: 2, factor } if (factor / 2.0 - 1.0).abs() < 0.1),
    ),
    (
        "angles of the motors",
        |robot, s| {
            let n = robot.dof();
            if let Some(coupling) = robot.coupling() {
                for rows in [&mut s.states.q, &mut s.states.qd, &mut s.states.qdd] {
                    for row in rows.chunks_exact_mut(n) {
                        let at_motors = coupling * nalgebra::DVector::from_column_slice(row);
                        row.copy_from_slice(at_motors.as_slice());
                    }
                }
            }
            for (i, joint) in robot.joints().iter().enumerate() {
                scale_motion(s, i, joint.drive.gear);
            }
        },
        |m| *m == Mistake::MotorAngles,
    ),
    (
        "efforts in thousandths",
        |_, s| (0..6).for_each(|i| scale_effort(s, i, 1e3)),
        |m| *m == Mistake::EffortUnit { factor: 1e-3 },
    ),
    (
        "all efforts the other way",
        |_, s| (0..6).for_each(|i| scale_effort(s, i, -1.0)),
        |m| matches!(m, Mistake::EffortsReversed { slope: Some(slope) } if (-2.0..-0.5).contains(slope)),
    ),
    (
        "currents, or torques of motors with gears of 6 to 90",
        |_, s| (0..6).for_each(|i| scale_effort(s, i, 1.0 / [90.0, 60.0, 6.0, 25.0, 40.0, 15.0][i])),
        |m| matches!(m, Mistake::EffortsSmall { .. } | Mistake::MotorTorques),
    ),
    (
        "zero of joint 2 off by 90°",
        |_, s| s.states.q.iter_mut().skip(1).step_by(6).for_each(|q| *q += 0.5 * std::f64::consts::PI),
        |m| *m == Mistake::ZeroOffset { joint: 2, degrees: -90.0 },
    ),
    (
        "radians taken for degrees",
        |_, s| (0..6).for_each(|i| scale_motion(s, i, std::f64::consts::PI / 180.0)),
        |m| *m == Mistake::Radians,
    ),
    ("effort of joint 1 not there", |_, s| scale_effort(s, 0, 0.0), |m| *m == Mistake::NoEffort { joint: 1 }),
    ("gravity along x", |_, _| {}, |m| *m == Mistake::Gravity { direction: [1, 0, 0] }),
    ("joint 4 at rest", |_, _| {}, |m| *m == Mistake::AtRest { joint: 4 }),
];

/// What is said of a log.
fn named(robot: &Robot, samples: &Samples) -> Option<Mistake> {
    if let Some(&joint) = standing_joints(samples).first() {
        return Some(Mistake::AtRest { joint });
    }
    let guess = nominal(robot);
    let log = Evidence { samples, held_out: None, nominal: Some(&guess) };
    diagnose(robot, Columns::RIGID_ROTOR_FRICTION, &log)
        .expect("a robot with base parameters")
        .map(|found| found.mistake)
}

/// Friction that the fitted model lacks: proportional to the load, and larger near rest.
fn with_unmodelled_friction(samples: &mut Samples, load: f64, stribeck: f64) {
    let n = samples.dof();
    for i in 0..n {
        let rms = (samples.tau.iter().skip(i).step_by(n).map(|x| x * x).sum::<f64>() / SAMPLES as f64).sqrt();
        for (tau, qd) in samples.tau.iter_mut().zip(&samples.states.qd).skip(i).step_by(n) {
            *tau += (load * tau.abs() + stribeck * rms * (-(qd / 0.1).powi(2)).exp()) * qd.signum();
        }
    }
}

#[test]
fn a_model_error_is_no_mistake_of_the_log() {
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        for (load, stribeck) in [(0.05, 0.0), (0.15, 0.0), (0.0, 0.1), (0.0, 0.3), (0.1, 0.2)] {
            for seed in 1..2 {
                let mut samples = log(&robot, &truth, seed);
                with_unmodelled_friction(&mut samples, load, stribeck);
                let found = named(&robot, &samples);
                assert_eq!(found, None, "{name}: load friction {load}, Stribeck {stribeck}, seed {seed}");
            }
        }
    }
}

/// So many samples of a log, from one of them on.
fn excerpt(samples: &Samples, first: usize, count: usize) -> Samples {
    let n = samples.dof();
    let rows = |table: &[f64]| table[first * n..(first + count) * n].to_vec();
    let mut states = States::new(n);
    let (q, qd, qdd) = (rows(&samples.states.q), rows(&samples.states.qd), rows(&samples.states.qdd));
    for ((q, qd), qdd) in q.chunks_exact(n).zip(qd.chunks_exact(n)).zip(qdd.chunks_exact(n)) {
        states.push(q, qd, qdd);
    }
    Samples::exact(states, rows(&samples.tau), vec!["N·m".to_owned(); n], RATE_HZ)
}

#[test]
fn two_seconds_of_a_sound_log_are_too_few_to_suspect_it() {
    let mut wrong = Vec::new();
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        for seed in 1..3 {
            let mut samples = log(&robot, &truth, seed);
            if seed == 2 {
                with_unmodelled_friction(&mut samples, 0.05, 0.0);
            }
            for (seconds, first) in [(2, 0), (2, 300), (2, 600), (4, 100), (4, 500)] {
                let part = excerpt(&samples, first, seconds * 50);
                let found = named(&robot, &part);
                if let Some(found) = found {
                    wrong.push(format!("{name}, seed {seed}, {seconds} s from sample {first}: {found:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn noise_of_weak_joints_is_no_mistake_of_strong_ones() {
    // A residual that is large beside a small torque: a larger torque of another joint must not excuse it.
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        for (seed, noise) in [(1, 0.1), (2, 0.2), (3, 0.3)] {
            let mut samples = log(&robot, &truth, seed);
            let mut rng = Seed::new(seed).stream("wrist", 0);
            for i in 3..6 {
                let rms = (samples.tau.iter().skip(i).step_by(6).map(|x| x * x).sum::<f64>() / SAMPLES as f64).sqrt();
                for x in samples.tau.iter_mut().skip(i).step_by(6) {
                    *x += noise * rms * 1.7 * uniform(&mut rng, -1.0, 1.0);
                }
            }
            assert_eq!(named(&robot, &samples), None, "{name}, seed {seed}, noise {noise}");
        }
    }
}

#[test]
fn angles_of_motors_with_unknown_gears_are_no_degrees() {
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        let mut samples = log(&robot, &truth, 1);
        let ungeared = robot.with_joints(|joint| joint.drive.gear = 1.0).expect("a robot");
        (0..6).for_each(|i| scale_motion(&mut samples, i, 100.0));
        match named(&ungeared, &samples) {
            Some(Mistake::PositionUnit { factor }) => assert!((factor * 100.0 - 1.0).abs() < 0.1, "{name}: {factor}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn reversed_efforts_show_in_friction_alone_and_an_arm_upside_down_is_none() {
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        let mut samples = log(&robot, &truth, 2);
        (0..6).for_each(|i| scale_effort(&mut samples, i, -1.0));
        let evidence = Evidence { samples: &samples, held_out: None, nominal: None };
        let found = diagnose(&robot, Columns::RIGID_ROTOR_FRICTION, &evidence).unwrap().map(|found| found.mistake);
        assert_eq!(found, Some(Mistake::EffortsReversed { slope: None }), "{name}");

        let upside_down = log(&robot.clone().with_gravity(-robot.gravity()), &truth, 2);
        let found = named(&robot, &upside_down);
        assert!(!matches!(found, Some(Mistake::EffortsReversed { .. })), "{name}: {found:?}");
    }
}

#[test]
fn a_log_faster_than_the_speed_limit_of_a_urdf_is_not_in_degrees() {
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        for load_friction in [0.0, 0.1] {
            let mut samples = log(&robot, &truth, 1);
            with_unmodelled_friction(&mut samples, load_friction, 0.0);
            let top = samples.states.qd.iter().fold(0.0_f64, |top, qd| top.max(qd.abs()));
            let slow = robot.clone().with_joints(|joint| joint.limits.velocity = top / 6.0).expect("a robot");
            assert_eq!(named(&slow, &samples), None, "{name}, load friction {load_friction}");
        }
    }
}

#[test]
fn nine_of_ten_mistakes_are_named_and_sound_logs_are_left_alone() {
    let (mut right, mut all, mut wrong) = (0, 0, Vec::new());
    for name in ROBOTS {
        let (robot, truth) = robot(name);
        for seed in 1..4 {
            let sound = log(&robot, &truth, seed);
            assert_eq!(named(&robot, &sound), None, "{name}: a sound log, seed {seed}");
        }
        for (fault, make, is_right) in FAULTS {
            let mut samples = match fault {
                "gravity along x" => log(&robot.clone().with_gravity(Vector3::new(9.81, 0.0, 0.0)), &truth, 1),
                _ => log(&robot, &truth, 1),
            };
            if fault == "joint 4 at rest" {
                let (n, held) = (samples.dof(), samples.states.q[3]);
                samples.states.q.iter_mut().skip(3).step_by(n).for_each(|q| *q = held);
            }
            make(&robot, &mut samples);
            let found = named(&robot, &samples);
            all += 1;
            if found.as_ref().is_some_and(is_right) {
                right += 1;
            } else {
                wrong.push(format!("{name}: {fault}: {found:?}"));
            }
        }
    }
    println!("{right} of {all}\n{}", wrong.join("\n"));
    assert!(all >= 30 && right * 10 >= all * 9, "{right} of {all} named rightly:\n{}", wrong.join("\n"));
}
