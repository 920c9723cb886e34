//! The lag of the currents: its column, what is found of it, and that none is found where there is none.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

use super::current_lag::LaggedTorque;
use super::evidence::{Selection, TermEvidence, Verdict};
use super::{candidate_terms, select};
use crate::chains::ChainRecipe;
use crate::dynamics::{Dynamics, States};
use crate::estimation::Identification;
use crate::experiment::Transmission;
use crate::model::term::{COULOMB, CURRENT_LAG, OFFSET, ROTOR, VISCOUS};
use crate::model::{Columns, Robot, StandardParameters};
use crate::seed::Seed;
use crate::signal::Samples;

const COUNT: usize = 1200;
const RATE_HZ: f64 = 120.0;
const PERIOD_S: f64 = COUNT as f64 / RATE_HZ;

/// A drawn arm of three joints and what is true of it.
fn arm(seed: u64, coupled: bool) -> (Robot, StandardParameters) {
    let (robot, drawn) = ChainRecipe { coupled, ..ChainRecipe::new(3) }.draw(&mut Seed::new(seed).stream("arm", 0));
    let mut truth = StandardParameters { links: drawn.links, ..StandardParameters::zero(3) };
    for drive in &mut truth.drives {
        for (term, value) in [(ROTOR, 0.3), (VISCOUS, 4.0), (COULOMB, 4.0), (OFFSET, 2.0)] {
            drive[term] = value;
        }
    }
    (robot, truth)
}

/// Position, velocity and acceleration at any time: two of the joints never turn within `COUNT` samples of each other.
fn motion(t: f64) -> [[f64; 3]; 3] {
    let mut x = [[0.0; 3]; 3];
    for i in 0..3 {
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

fn torque(robot: &Robot, truth: &StandardParameters, t: f64) -> Vec<f64> {
    let [q, qd, qdd] = motion(t);
    let mut tau = vec![0.0; 3];
    Dynamics::new(robot, truth).inverse(&q, &qd, &qdd, &mut tau);
    tau
}

/// What the motors report `lags` before it acts, with noise of 0.2 N·m.
fn recorded(seed: u64, (robot, truth): (&Robot, &StandardParameters), lags: [f64; 3]) -> Samples {
    let mut noise = Seed::new(seed).stream("noise", 0);
    let transmission = Transmission::new(robot);
    let (mut states, mut tau) = (States::new(3), Vec::new());
    for k in 0..COUNT {
        let t = k as f64 / RATE_HZ;
        let [q, qd, qdd] = motion(t);
        states.push(&q, &qd, &qdd);
        let (mut motors, mut joints) = ([0.0; 3], [0.0; 3]);
        for (m, lag) in lags.into_iter().enumerate() {
            let mut of_motors = [0.0; 3];
            transmission.motor_torque(&torque(robot, truth, t + lag), &mut of_motors);
            motors[m] = of_motors[m];
        }
        transmission.joint_torque(&motors, &mut joints);
        for value in joints {
            let z: f64 = StandardNormal.sample(&mut noise);
            tau.push(value + 0.2 * z);
        }
    }
    let mut samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 3], RATE_HZ);
    samples.period_s = Some(PERIOD_S);
    // Where friction turns over within the lag, as the processing leaves out.
    for (row, used) in samples.used.iter_mut().enumerate() {
        *used = samples.states.qd[row].abs() > 0.05;
    }
    samples
}

fn selected(robot: &Robot, samples: &Samples) -> Selection {
    let candidates = candidate_terms().into_iter().fold(Columns::RIGID, Columns::with_term);
    select(|columns| Identification::new(robot, columns), samples, &[], candidates).unwrap()
}

fn lag_of(selection: &Selection) -> &TermEvidence {
    selection.terms.iter().find(|one| one.term == CURRENT_LAG.entry().name).unwrap()
}

#[test]
fn analytic_the_column_is_the_change_of_the_motors_torque_with_time() {
    for coupled in [false, true] {
        let (robot, mut truth) = arm(3, coupled);
        // A torque that can be differentiated anywhere.
        truth.drives.iter_mut().for_each(|drive| drive[COULOMB] = 0.0);
        let mut samples = recorded(3, (&robot, &truth), [0.0; 3]);
        samples.used.fill(true);
        let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
        let observation = identification.observation(&samples).unwrap();
        let beta = identification.base().beta(&truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        let lagged = LaggedTorque::new(&robot, &observation, beta.as_slice());
        let columns = lagged.columns(&lagged.rates(&samples));
        let transmission = Transmission::new(&robot);
        let mut worst = 0.0_f64;
        for k in (0..COUNT).step_by(7) {
            let (t, h) = (k as f64 / RATE_HZ, 1e-3);
            let at = |s: f64| DVector::from_vec(torque(&robot, &truth, t + s * h));
            // Fourth order.
            let change = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let mut of_motors = [0.0; 3];
            transmission.motor_torque(change.as_slice(), &mut of_motors);
            for m in 0..3 {
                let (mut one, mut expected) = ([0.0; 3], [0.0; 3]);
                one[m] = of_motors[m];
                transmission.joint_torque(&one, &mut expected);
                for i in 0..3 {
                    worst = worst.max((columns[(3 * k + i, m)] - expected[i]).abs() / change.amax().max(1.0));
                }
            }
        }
        // (ωh)²/24 of the fastest tones: five harmonics and their products.
        assert!(worst < 2e-4, "{worst:e}");
    }
}

#[test]
fn analytic_lags_are_found_and_other_parameters_are_nearer_beside_them() {
    for (seed, coupled) in [(11, false), (12, true), (13, false)] {
        let (robot, truth) = arm(seed, coupled);
        let lags = [6e-3, 3e-3, -4e-3];
        let samples = recorded(seed, (&robot, &truth), lags);
        let selection = selected(&robot, &samples);
        let evidence = lag_of(&selection);
        assert_eq!(evidence.verdict, Verdict::Supported, "{seed}: {evidence:?}");
        let found: Vec<_> = selection.beyond_motion.iter().filter(|one| one.term == "current-lag").collect();
        assert_eq!(found.len(), 3);
        for (one, lag) in found.iter().zip(lags) {
            // Three times the half width: one of nine intervals of 95 % may fail.
            let [low, high] = one.ci95;
            assert!((one.value - lag).abs() < 1.5 * (high - low), "{seed}: {one:?} {lag}");
            assert!(one.unit == "s" && (high - low) < 6e-3, "{one:?}");
        }
        // Parameters of the selected set with the lag, and without it.
        let columns = Columns::parse(&selection.columns).unwrap();
        let identification = Identification::new(&robot, columns).unwrap();
        let estimate = identification.estimate(&samples, crate::estimation::EstimatorKind::Wls.estimator()).unwrap();
        let beside: Vec<_> = selection.parameters_beside.iter().filter(|one| one.term == "current-lag").collect();
        assert_eq!(beside.len(), identification.base().rank());
        // By the torque that acts.
        let observation = identification.observation(&samples).unwrap();
        let acting = (0..COUNT).flat_map(|k| torque(&robot, &truth, k as f64 / RATE_HZ)).zip(&samples.used);
        let acting = DVector::from_iterator(3 * COUNT, acting.map(|(tau, used)| if *used { tau } else { 0.0 }));
        let error = |beta: DVector<f64>| (&observation.regressor * beta - &acting).norm();
        let with = error(DVector::from_iterator(beside.len(), beside.iter().map(|one| one.value)));
        let without = error(estimate.beta());
        assert!(with < 0.5 * without, "{seed}: {with} {without} {}", selection.columns);
    }
}

#[test]
fn analytic_an_arm_without_a_lag_shows_none() {
    for seed in 20..30 {
        let (robot, truth) = arm(seed, seed % 2 == 0);
        let samples = recorded(seed, (&robot, &truth), [0.0; 3]);
        let selection = selected(&robot, &samples);
        assert_ne!(lag_of(&selection).verdict, Verdict::Supported, "{seed}: {:?}", lag_of(&selection));
        assert!(selection.beyond_motion.iter().all(|one| one.term != "current-lag"));
    }
}

/// Linear equations of one unknown and its lag have the solution of the bilinear ones: `y = β (s + T ṡ)`.
#[test]
fn analytic_the_iteration_rests_at_the_solution_of_the_bilinear_equations() {
    let (robot, mut truth) = arm(5, false);
    truth.drives.iter_mut().for_each(|drive| drive[COULOMB] = 0.0);
    let lags = [5e-3, -2e-3, 8e-3];
    let mut samples = recorded(5, (&robot, &truth), [0.0; 3]);
    samples.used.fill(true);
    let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
    let beta = identification.base().beta(&truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
    let observation = identification.observation(&samples).unwrap();
    let lagged = LaggedTorque::new(&robot, &observation, beta.as_slice());
    let rates = lagged.rates(&samples);
    // Without noise, and exactly of first order: then the answer is exact, wherever the iteration begins.
    let exact = &observation.regressor * &beta + lagged.columns(&rates) * DVector::from_row_slice(&lags);
    samples.tau.copy_from_slice(exact.as_slice());
    let mut noise = Seed::new(5).stream("little", 0);
    for value in &mut samples.tau {
        let z: f64 = StandardNormal.sample(&mut noise);
        *value += 1e-9 * z;
    }
    let observation = identification.observation(&samples).unwrap();
    let begin = DMatrix::from_element(beta.len(), 1, 1.0);
    let rested = LaggedTorque::at_rest(&robot, &observation, &samples, begin.as_slice()).unwrap().unwrap();
    for (found, lag) in rested.lags.iter().zip(lags) {
        assert!((found - lag).abs() < 1e-9, "{found} {lag}");
    }
}
