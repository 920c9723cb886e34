//! Known transmissions are found between noisy encoders, and none where nothing shows it.

use rand_distr::{Distribution, StandardNormal};

use super::{Measured, StiffnessVerdict, TransmissionStiffness, transmission_stiffness};
use crate::chains::{ChainRecipe, planar_2r};
use crate::dynamics::{Dynamics, States};
use crate::experiment::Transmission;
use crate::model::{Robot, StandardParameters, smooth_sign};
use crate::seed::Seed;
use crate::signal::{FourierTransform, HarmonicSeries, Samples};

const COUNT: usize = 1600;
const PERIOD_S: f64 = 8.0;
const ROTOR: f64 = 0.4;

/// Standard deviation of a link's encoder, rad, and of a torque, N·m.
const NOISE: (f64, f64) = (2e-4, 0.3);

fn motion(t: f64, joints: usize) -> [Vec<f64>; 3] {
    let mut x = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
    for i in 0..joints {
        for l in 1..=5 {
            let (w, phase) = (std::f64::consts::TAU / PERIOD_S * f64::from(l), 1.3 * f64::from(l) + 2.1 * i as f64);
            let amplitude = 0.6 / f64::from(l);
            let (sine, cosine) = (w * t + phase).sin_cos();
            x[0][i] += amplitude * sine;
            x[1][i] += amplitude * w * cosine;
            x[2][i] -= amplitude * w * w * sine;
        }
    }
    x
}

/// Samples of an arm whose links do a known motion, wound up by `stiffness` in front of it, and a rigid model that errs by a tenth.
fn recorded(
    robot: &Robot,
    links: &StandardParameters,
    stiffness: &[f64],
    (encoder, sensor): (f64, f64),
    seed: u64,
) -> (Samples, Vec<f64>) {
    let n = robot.dof();
    let transmission = Transmission::new(robot);
    let mut dynamics = Dynamics::new(robot, &links.links_alone());
    let (mut motors, mut link_q, mut load) = (vec![Vec::new(); n], Vec::new(), Vec::new());
    for k in 0..COUNT {
        let [q, qd, qdd] = motion(PERIOD_S * k as f64 / COUNT as f64, n);
        let (mut tau, mut at, mut through) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        dynamics.inverse(&q, &qd, &qdd, &mut tau);
        transmission.motor_motion(&q, &mut at);
        transmission.motor_torque(&tau, &mut through);
        for m in 0..n {
            motors[m].push(at[m] + through[m] / stiffness[m]);
        }
        link_q.extend(q);
        load.extend(through);
    }
    let transform = FourierTransform::new(COUNT);
    let series = motors.iter().map(|angles| HarmonicSeries::new(&transform, angles, PERIOD_S).samples(&transform));
    let of_motors: Vec<_> = series.collect();
    let mut noise = Seed::new(seed).stream("noise", 0);
    let mut white = |std: f64| -> f64 {
        let z: f64 = StandardNormal.sample(&mut noise);
        std * z
    };
    let (mut states, mut tau, mut modelled) = (States::new(n), Vec::new(), Vec::new());
    for k in 0..COUNT {
        let joints = |pick: &dyn Fn(usize) -> f64| {
            let (motors, mut joints): (Vec<f64>, _) = ((0..n).map(pick).collect(), vec![0.0; n]);
            transmission.joint_motion(&motors, &mut joints);
            joints
        };
        let q = joints(&|m| of_motors[m].q[k]);
        let qd = joints(&|m| of_motors[m].qd[k]);
        let qdd = joints(&|m| of_motors[m].qdd[k]);
        let motor = |m: usize| {
            let (speed, acceleration) = (of_motors[m].qd[k], of_motors[m].qdd[k]);
            let turn = robot.joints()[m].drive.coulomb_velocity;
            ROTOR * acceleration + 3.0 * speed + 4.0 * smooth_sign(speed, turn) + 1.5 + load[k * n + m]
        };
        let (torque, mut at_joints, mut rigid) = ((0..n).map(motor).collect::<Vec<_>>(), vec![0.0; n], vec![0.0; n]);
        transmission.joint_torque(&torque, &mut at_joints);
        tau.extend(at_joints.iter().map(|value| value + white(sensor)));
        dynamics.inverse(&q, &qd, &qdd, &mut rigid);
        modelled.extend(rigid.iter().map(|value| 1.1 * value));
        states.push(&q, &qd, &qdd);
    }
    for value in &mut link_q {
        // An offset, noise, and steps of an encoder.
        *value = ((*value + 0.01 + white(encoder)) / 5e-5).round() * 5e-5;
    }
    let exact = Samples::exact(states, tau, vec!["N·m".to_owned(); n], COUNT as f64 / PERIOD_S);
    let blocks = COUNT / 4;
    let samples =
        Samples { link_q: Some(link_q), block: 4, used: vec![true; blocks * n], period_s: Some(PERIOD_S), ..exact };
    (samples, modelled)
}

fn drawn(seed: u64, coupled: bool) -> (Robot, StandardParameters) {
    ChainRecipe { coupled, ..ChainRecipe::new(3) }.draw(&mut Seed::new(seed).stream("arm", 0))
}

/// Stiffness at which the load winds a motor up by some mrad.
fn soft(robot: &Robot, links: &StandardParameters) -> Vec<f64> {
    let one = vec![1.0; robot.dof()];
    let (samples, _) = recorded(robot, links, &one, (0.0, 0.0), 0);
    let transmission = Transmission::new(robot);
    let mut most = vec![0.0_f64; robot.dof()];
    for k in 0..samples.len() {
        let mut at = vec![0.0; robot.dof()];
        transmission.motor_motion(samples.states.q(k), &mut at);
        most.iter_mut().zip(at).for_each(|(most, at)| *most = most.max(at.abs()));
    }
    most.iter().map(|most| most / 3e-3).collect()
}

#[test]
fn analytic_stiffness_is_found_between_noisy_encoders_coupled_or_not() {
    let (mut inside, mut all) = (0, 0);
    for seed in 0..12 {
        let (robot, links) = drawn(40 + seed, seed % 2 == 0);
        let truth = soft(&robot, &links);
        let (samples, modelled) = recorded(&robot, &links, &truth, NOISE, seed);
        for (found, truth) in transmission_stiffness(&robot, &samples, &modelled).unwrap().iter().zip(&truth) {
            // A drawn joint may have an axis whose load is that of its own inertia.
            let Some(stiffness) = found.stiffness else { continue };
            assert!((stiffness.value / truth - 1.0).abs() < 0.25, "{seed} {found:?} {truth}");
            let rotor = found.rotor.unwrap();
            let covers = |of: Measured, truth| usize::from(of.ci95[0] <= truth && truth <= of.ci95[1]);
            (inside, all) = (inside + covers(stiffness, *truth) + covers(rotor, ROTOR), all + 2);
        }
    }
    // 95 % of 50 or more, less three standard deviations.
    assert!(all >= 50 && inside as f64 >= 0.86 * all as f64, "{inside} of {all}");
}

/// With M equations and an F of the first stage, least squares of the same equations would find F/(F + M) of the stiffness.
#[test]
fn analytic_noise_of_the_encoders_does_not_draw_the_stiffness_down() {
    let (robot, links) = drawn(40, false);
    let truth = soft(&robot, &links);
    let runs: Vec<Vec<TransmissionStiffness>> = (0..12)
        .map(|seed| {
            let (samples, modelled) = recorded(&robot, &links, &truth, (3e-4, 0.3), 100 + seed);
            transmission_stiffness(&robot, &samples, &modelled).unwrap()
        })
        .collect();
    let mut drawn_down = 0;
    for (m, truth) in truth.iter().enumerate() {
        let of: Vec<&TransmissionStiffness> = runs.iter().map(|run| &run[m]).collect();
        let f = of.iter().map(|one| one.f.unwrap()).sum::<f64>() / 12.0;
        // Below, an estimate by instruments has no mean to speak of.
        if f < 50.0 {
            continue;
        }
        let mean = |value: &dyn Fn(&TransmissionStiffness) -> f64| of.iter().map(|one| value(one)).sum::<f64>() / 12.0;
        let ratio = mean(&|one| one.stiffness.unwrap().value / truth);
        let std = mean(&|one| one.stiffness.unwrap().std / truth) / 12.0_f64.sqrt();
        assert!((ratio - 1.0).abs() < 3.5 * std, "{m}: {ratio} {std} {f}");
        drawn_down += usize::from(f / (f + COUNT as f64 / 4.0) < 1.0 - 5.0 * std);
    }
    assert!(drawn_down > 0);
}

#[test]
fn analytic_a_stiff_transmission_is_hidden_in_the_steps_of_its_encoders() {
    let (robot, links) = drawn(40, false);
    let truth: Vec<f64> = soft(&robot, &links).iter().map(|soft| 1e6 * soft).collect();
    let mut stated = 0;
    for seed in 0..10 {
        let (samples, modelled) = recorded(&robot, &links, &truth, NOISE, seed);
        let found = transmission_stiffness(&robot, &samples, &modelled).unwrap();
        stated += found.iter().filter(|one| one.verdict == StiffnessVerdict::Decided).count();
    }
    assert_eq!(stated, 0);
}

#[test]
fn analytic_a_constant_inertia_without_gravity_is_like_a_rotor() {
    // The outer joint of an arm in the horizontal plane, whose inner one stands still.
    let robot = planar_2r();
    let mut links = StandardParameters::zero(2);
    links.links[1] = crate::calibration::payload(4.0, [0.2, 0.0, 0.0], [0.1; 3]);
    let (mut samples, _) = recorded(&robot, &links, &[2e4, 2e4], (0.0, 0.0), 1);
    for k in 0..COUNT {
        samples.states.q[2 * k] = 0.0;
        samples.states.qd[2 * k] = 0.0;
        samples.states.qdd[2 * k] = 0.0;
    }
    let rigid: Vec<f64> =
        (0..2 * COUNT).map(|at| if at % 2 == 1 { 0.26 * samples.states.qdd[at] } else { 0.0 }).collect();
    let found: Vec<TransmissionStiffness> = transmission_stiffness(&robot, &samples, &rigid).unwrap();
    assert_eq!(found[1].verdict, StiffnessVerdict::LikeRotor);
    assert!(found[1].stiffness.is_none() && found[1].wind_up_rms > 0.0);
}

#[test]
fn without_positions_of_the_links_there_is_no_answer() {
    let (robot, links) = drawn(41, false);
    let (samples, modelled) = recorded(&robot, &links, &[1e4; 3], NOISE, 1);
    let samples = Samples { link_q: None, ..samples };
    let fault = transmission_stiffness(&robot, &samples, &modelled).unwrap_err().to_string();
    assert!(fault.contains("positions of the links"), "{fault}");
}
