//! Instrumental variables against NumPy: `tests/python/instrumental.py` prints these numbers.

use nalgebra::{DMatrix, DVector};

use crate::base::{Method, reduce};
use crate::dynamics::States;
use crate::estimation::{
    ClosedLoop, ClosedLoopError, ClosedLoopMotion, ClosedLoopSlopes, Estimate, EstimationProblem, EstimatorKind,
    Finding, Observation,
};
use crate::experiment::hinges;
use crate::model::{Columns, ParameterId, StandardParameters};
use crate::observer::Observer;
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};

const COUNT: usize = 60;

/// A loop that moves in one way, whatever the arm.
#[derive(Debug)]
struct OneMotion(ClosedLoopMotion, StandardParameters);

impl ClosedLoop for OneMotion {
    fn nominal(&self) -> &StandardParameters {
        &self.1
    }

    fn motion(&self, _: &StandardParameters, _: &dyn Observer) -> Result<ClosedLoopMotion, ClosedLoopError> {
        Ok(self.0.clone())
    }

    fn slopes(
        &self,
        _: &StandardParameters,
        _: &[ParameterId],
        _: usize,
        _: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        Err(ClosedLoopError::NotGiven)
    }
}

/// States of a hinge whose speed and acceleration are `of` the true ones at instant k.
fn states(of: impl Fn(f64, f64, f64) -> (f64, f64)) -> States {
    let mut states = States::new(1);
    for k in 0..COUNT {
        let (k, t) = (k as f64, 0.05 * k as f64);
        let speed = libm::cos(1.1 * t) + 0.5 * libm::sin(2.3 * t);
        let acceleration = -1.1 * libm::sin(1.1 * t) + 1.15 * libm::cos(2.3 * t);
        let (speed, acceleration) = of(k, speed, acceleration);
        states.push(&[0.0], &[speed], &[acceleration]);
    }
    states
}

/// A hinge with these base parameters whose measured motion has errors, and its simulated one, which is another.
fn hinge(beta: [f64; 4]) -> (Observation, Samples, OneMotion) {
    let robot = hinges::single();
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
    let exact = states(|_, speed, acceleration| (speed, acceleration));
    let tau: Vec<f64> = (base.select_columns(&regressor.stack(&exact)) * DVector::from_row_slice(&beta))
        .iter()
        .enumerate()
        .map(|(k, tau)| tau + 0.02 * libm::sin(29.0 * k as f64))
        .collect();
    let measured = states(|k, speed, acceleration| {
        (speed + 0.002 * libm::sin(17.0 * k), acceleration + 0.02 * libm::cos(13.0 * k))
    });
    let simulated = states(|_, speed, acceleration| (0.98 * speed, 0.97 * acceleration));
    let samples = Samples {
        noise: Some(NoiseModel::white(DMatrix::from_element(1, 1, 81e-4), false, 1e9)),
        ..Samples::exact(measured, tau.clone(), vec!["N·m".to_owned()], 20.0)
    };
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    (observation, samples, OneMotion(ClosedLoopMotion { states: simulated, tau }, hinges::parameters(1)))
}

fn estimate(kind: EstimatorKind, (observation, samples, one): &(Observation, Samples, OneMotion)) -> Estimate {
    let robot = hinges::single();
    let problem =
        EstimationProblem { robot: Some(&robot), samples: Some(samples), ..EstimationProblem::new(observation) };
    kind.estimator().estimate(&EstimationProblem { closed_loop: Ok(one), ..problem }).unwrap()
}

#[test]
fn published_instruments_are_those_of_numpy() {
    let found = estimate(EstimatorKind::Iv, &hinge([2.0, 0.5, 0.3, 0.1]));
    let beta = [1.997_967_884_627_897_7, 0.489_947_620_157_480_8, 0.310_790_450_709_434_1, 0.098_576_898_021_650_6];
    let std =
        [0.003_261_142_856_268_081, 0.011_382_151_466_197_565, 0.011_402_736_250_012_105, 0.004_331_038_661_109_805_5];
    assert_eq!(found.base.len(), 4);
    for (p, (beta, std)) in found.base.iter().zip(beta.iter().zip(&std)) {
        assert!((p.value / beta - 1.0).abs() < 1e-10, "{}: {} {beta}", p.name, p.value);
        // NumPy's are for a third of the noise, at which the errors of the motion would be a discrepancy.
        assert!((p.std / (3.0 * std) - 1.0).abs() < 1e-9, "{}: {} {std}", p.name, p.std);
    }
    let test = found.findings.iter().find_map(|finding| match finding {
        Finding::DurbinWuHausman { statistic, freedom, .. } => Some((*statistic, *freedom)),
        _ => None,
    });
    let (statistic, freedom) = test.unwrap();
    assert!(freedom == 3 && (statistic / 220.472_083_856_178_95 - 1.0).abs() < 1e-6, "{statistic} {freedom}");
}

#[test]
fn analytic_a_bound_moves_the_others_by_the_covariance_of_the_instruments() {
    // Friction that would drive the joint: held at none, and β moves along that column of G = (ZᵀW)⁻¹ ZᵀZ (WᵀZ)⁻¹.
    let case = hinge([2.0, 0.5, -0.3, 0.1]);
    let (free, held) = (estimate(EstimatorKind::Iv, &case), estimate(EstimatorKind::PcIv, &case));
    let (robot, columns) = (hinges::single(), Columns::RIGID_ROTOR_FRICTION);
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let z = base.select_columns(&JointTorqueRegressor::new(&robot, columns).unwrap().stack(&case.2.0.states));
    let inverse = z.tr_mul(&case.0.regressor).try_inverse().unwrap();
    let g = &inverse * z.tr_mul(&z) * inverse.transpose();
    let at = free.base.iter().position(|p| p.name == "Fc1").unwrap();
    assert!(free.base[at].value < -0.25 && held.termination.was_successful());
    let expected = free.beta() - g.column(at) * (free.base[at].value / g[(at, at)]);
    let apart = (held.beta() - expected).component_div(&free.std()).amax();
    assert!(apart < 1e-4, "{apart} {held:?}");
}
