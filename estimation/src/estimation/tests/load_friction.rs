//! Friction of the load as a column: recovered from exact torque, with intervals that hold, and Jacobians that are central differences.

use nalgebra::DVector;

use super::friction_speed::{onset, onset_recording};
use crate::base::{Method, reduce};
use crate::chains::{ChainRecipe, random_state};
use crate::dynamics::States;
use crate::estimation::load_friction::{linearised, regressor_of};
use crate::estimation::{EstimationError, EstimatorKind, Identification, predict};
use crate::model::term::{LOAD_FRICTION, MOTOR_LOAD_FRICTION, WARM_VISCOUS};
use crate::model::{Columns, ColumnsError};
use crate::seed::Seed;
use crate::signal::Samples;

const LOAD: f64 = 0.06;

fn columns() -> Columns {
    Columns::RIGID_ROTOR_FRICTION.with_term(LOAD_FRICTION)
}

#[test]
fn analytic_exact_torque_gives_the_coefficients_by_every_linear_estimator() {
    let (robot, truth, samples) = onset_recording(21, [0.0; 3], LOAD, 0.0);
    let identification = Identification::new(&robot, columns()).unwrap();
    let exact = identification.base().beta(&truth.vector(&robot, columns()));
    let kinds =
        [EstimatorKind::Ols, EstimatorKind::Wls, EstimatorKind::IrlsHuber, EstimatorKind::Mm, EstimatorKind::Ekf];
    for kind in kinds {
        let estimate = identification.estimate(&samples, kind.estimator()).unwrap();
        assert!((estimate.beta() - &exact).amax() < 1e-6, "{}: {}", kind.name(), estimate.beta() - &exact);
        // Predicted by the bilinear law itself, with the load of its own parameters.
        let regressor = estimate.regressor(&robot, columns()).unwrap();
        let predicted = predict(&estimate, &regressor, &samples.states).unwrap();
        let largest = predicted.iter().zip(&samples.tau).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-6, "{}: {largest}", kind.name());
    }
}

#[test]
fn analytic_intervals_of_noisy_torque_hold_all_parameters() {
    let (mut held, mut all, mut of_load) = (0, 0, [0, 0]);
    for seed in 30..50 {
        let (robot, truth, samples) = onset_recording(seed, [0.0; 3], LOAD, 0.5);
        let identification = Identification::new(&robot, columns()).unwrap();
        let exact = identification.base().beta(&truth.vector(&robot, columns()));
        let estimate = identification.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap();
        for (parameter, exact) in estimate.base.iter().zip(exact.iter()) {
            let inside = usize::from(parameter.ci95[0] <= *exact && *exact <= parameter.ci95[1]);
            (held, all) = (held + inside, all + 1);
            if parameter.name.starts_with("Fl") {
                of_load = [of_load[0] + inside, of_load[1] + 1];
            }
        }
    }
    // 95 % of 60 coefficients: fewer than 50 have a probability of 1e-3. Parameters of one arm are correlated: 92 % of all.
    assert!(of_load[1] == 60 && of_load[0] >= 51, "{of_load:?}");
    assert!(held as f64 >= 0.92 * all as f64, "{held} of {all}");
}

/// On chains with coupled motors, at block means.
#[test]
fn identity_the_jacobian_is_central_differences_and_the_load_adds_its_own_friction() {
    for run in 0..6 {
        let mut rng = Seed::new(17).stream("load friction", run);
        let (robot, _) = ChainRecipe { coupled: run % 2 == 0, ..ChainRecipe::new(4) }.draw(&mut rng);
        let columns = columns().with_term(MOTOR_LOAD_FRICTION);
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
        let mut states = States::new(4);
        for _ in 0..30 {
            let (q, qd, qdd) = random_state(&mut rng, 4);
            states.push(&q, &qd, &qdd);
        }
        let samples = Samples { block: 3, ..Samples::exact(states, vec![0.0; 120], vec!["N·m".to_owned(); 4], 60.0) };
        let regressor = regressor_of(&robot, columns).unwrap();
        let beta = DVector::from_fn(base.rank(), |j, _| 0.3 + 0.05 * (j % 7) as f64);
        let torque = |beta: &DVector<f64>| {
            let mut phi = vec![0.0; base.parameters.len()];
            base.kept.iter().zip(beta.iter()).for_each(|(&column, &value)| phi[column] = value);
            regressor.with_links(&phi[..40]).stack_means(&samples.states, &base.kept, 3) * beta
        };
        let mut shift = DVector::zeros(40);
        let jacobian = linearised(&regressor, &base, &samples, &beta, &mut shift);
        assert!(shift.amax() > 0.1);
        let here = torque(&beta);
        assert!((&jacobian * &beta - &shift - &here).amax() < 1e-11 * here.amax(), "{run}");
        for j in 0..base.rank() {
            let mut step = DVector::zeros(base.rank());
            step[j] = 1e-6;
            let difference = (torque(&(&beta + &step)) - torque(&(&beta - &step))) / 2e-6;
            // The law is of second order in β away from where a load changes its sign; rounding is left.
            assert!((difference - jacobian.column(j)).amax() < 1e-7 * here.amax(), "{run}, {j}");
        }
    }
}

#[test]
fn a_plain_arm_has_none_and_temperature_is_refused() {
    let (robot, _, samples) = onset_recording(22, [0.1; 3], 0.0, 0.2);
    let robot = onset(&robot, Columns::RIGID_ROTOR_FRICTION, &samples).robot(&robot);
    let estimate = Identification::new(&robot, columns()).unwrap();
    let estimate = estimate.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap();
    for parameter in estimate.base.iter().filter(|of| of.name.starts_with("Fl")) {
        assert!(parameter.value.abs() < 4.0 * parameter.std, "{parameter:?}");
    }
    // The speeds are the estimate's own, whatever a robot file states.
    assert_eq!(estimate.shape.len(), 3);
    let other = onset_recording(22, [0.1; 3], 0.0, 0.2).0;
    assert_eq!(estimate.robot(&other, columns()).unwrap(), robot);
    let refused = Identification::new(&robot, columns().with_term(WARM_VISCOUS)).unwrap_err();
    assert!(matches!(refused, EstimationError::Columns(ColumnsError::Warmth { .. })), "{refused}");
}
