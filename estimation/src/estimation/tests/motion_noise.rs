//! What errors of the motion do to the equations, against inverse dynamics along motions with such errors.

use nalgebra::DVector;
use rand::RngExt;

use super::setting::{a460_samples, a460_samples_of};
use crate::dynamics::{Dynamics, States};
use crate::estimation::Observation;
use crate::estimation::motion::motion_noise;
use crate::model::StandardParameters;
use crate::model::term::COULOMB;
use crate::seed::Seed;
use crate::signal::Samples;

const COUNT: usize = 400;
const PERIOD_S: f64 = 10.0;
/// Last harmonic of the band of positions.
const BAND: usize = 80;
/// Amplitude of a line of a position, rad.
const LINE: f64 = 2e-6;

/// Errors of one joint's velocity and acceleration: lines of random phase, beyond the band those of a motion that has steps of acceleration.
fn errors(rng: &mut impl RngExt) -> (Vec<f64>, Vec<f64>) {
    let (mut qd, mut qdd) = (vec![0.0; COUNT], vec![0.0; COUNT]);
    for h in 1..COUNT / 2 {
        let w = std::f64::consts::TAU * h as f64 / PERIOD_S;
        let size = LINE * if h > BAND { (BAND as f64 / h as f64).powi(3) } else { 1.0 };
        let phase = rng.random_range(0.0..std::f64::consts::TAU);
        for k in 0..COUNT {
            let (s, c) = libm::sincos(phase + std::f64::consts::TAU * ((h * k) % COUNT) as f64 / COUNT as f64);
            qd[k] -= w * size * s;
            qdd[k] -= w * w * size * c;
        }
    }
    (qd, qdd)
}

#[test]
fn analytic_noise_of_the_motion_is_that_of_torque_along_a_motion_with_errors() {
    // Without friction that bends, whose slope is not the same all over a block.
    let smooth = |parameters: &mut StandardParameters| {
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| term != COULOMB);
        }
    };
    let (robot, parameters, regressor, base, samples) = a460_samples_of(COUNT, smooth);
    let n = robot.dof();
    let samples = Samples {
        period_s: Some(PERIOD_S),
        position_band_hz: vec![BAND as f64 / PERIOD_S; n],
        position_floor: vec![LINE * LINE; n],
        block: 2,
        used: vec![true; n * COUNT / 2],
        slow: vec![false; n * COUNT / 2],
        ..samples
    };
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let beta: DVector<f64> = base.beta(&parameters.vector(&robot, regressor.columns()));
    let noise = motion_noise(&robot, &observation, &samples, &beta).unwrap();
    let twice = Samples::join(vec![samples.clone(), samples.clone()]).unwrap();
    let observation = Observation::new(&robot, &regressor, &base, &twice).unwrap();
    let of_both = motion_noise(&robot, &observation, &twice, &beta).unwrap();
    assert!((of_both.covariance() - noise.covariance()).norm() < 1e-9 * noise.covariance().norm());

    let mut arm = Dynamics::new(&robot, &parameters);
    let mut torque = |states: &States| {
        let mut all = vec![0.0; n * COUNT];
        for (k, tau) in all.chunks_exact_mut(n).enumerate() {
            arm.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
        samples.block_means(&all, n)
    };
    let exact = torque(&samples.states);
    let (blocks, runs) = (COUNT / 2, 40);
    let mut products = vec![[0.0; 3]; n];
    for run in 0..runs {
        let mut rng = Seed::new(31).stream("motion", run);
        let mut states = samples.states.clone();
        for i in 0..n {
            let (qd, qdd) = errors(&mut rng);
            for k in 0..COUNT {
                states.qd[k * n + i] += qd[k];
                states.qdd[k * n + i] += qdd[k];
            }
        }
        let moved: Vec<f64> = torque(&states).iter().zip(&exact).map(|(moved, exact)| moved - exact).collect();
        for (i, products) in products.iter_mut().enumerate() {
            for (l, product) in products.iter_mut().enumerate() {
                let at = |k: usize| moved[k % blocks * n + i];
                *product += (0..blocks).map(|k| at(k) * at(k + l)).sum::<f64>() / (blocks as f64 * runs as f64);
            }
        }
    }
    for (i, products) in products.iter().enumerate() {
        let variance = noise.covariance()[(i, i)];
        // 8000 blocks: a tenth.
        assert!((variance / products[0] - 1.0).abs() < 0.1, "joint {i}: {variance} {products:?}");
        for l in 1..3 {
            let (stated, seen) = (noise.correlation(i, l), products[l] / products[0]);
            assert!((stated - seen).abs() < 0.05, "joint {i}, lag {l}: {stated} {seen}");
        }
    }
}

#[test]
fn without_the_noise_of_the_positions_none_is_known() {
    let (robot, parameters, regressor, base, samples) = a460_samples(60);
    let samples = Samples { period_s: Some(PERIOD_S), ..samples };
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
    assert!(motion_noise(&robot, &observation, &samples, &beta).is_none());
}
