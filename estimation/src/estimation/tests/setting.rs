//! Equations to test with: a small well-conditioned regressor, and the A460's on `radkhah2007` Table I.

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::base::{BaseReduction, Method, reduce};
use crate::estimation::Observation;
use crate::model::format::{parse_nominal, parse_robot};
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters, bundled};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::Samples;
use crate::trajectory::table_one;

/// The A460 and its nominal parameters.
pub(super) fn a460() -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("the A460 is bundled");
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap();
    (robot, nominal.parameters)
}

/// Exact samples of the A460 on Table I at `count` instants, with the regressor and the base of all columns.
pub(in crate::estimation) fn a460_samples(
    count: usize,
) -> (Robot, StandardParameters, JointTorqueRegressor, BaseReduction, Samples) {
    a460_samples_of(count, |_| {})
}

/// Samples of the A460 after a change of the parameters.
pub(super) fn a460_samples_of(
    count: usize,
    change: impl Fn(&mut StandardParameters),
) -> (Robot, StandardParameters, JointTorqueRegressor, BaseReduction, Samples) {
    let (robot, mut parameters) = a460();
    change(&mut parameters);
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let states = table_one::corrected().sample(count);
    let mut dynamics = crate::dynamics::Dynamics::new(&robot, &parameters);
    let mut tau = vec![0.0; 6 * count];
    for (k, tau) in tau.chunks_exact_mut(6).enumerate() {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 6], count as f64 / 10.0);
    (robot, parameters, regressor, base, samples)
}

/// A random regressor of `b` columns on two joints at `count` instants, and true parameters; `y` is exact.
pub(in crate::estimation) fn synthetic(count: usize, b: usize, rng: &mut impl Rng) -> (Observation, DVector<f64>) {
    let ids: Vec<ParameterId> = (0..b).map(|index| ParameterId { kind: ParameterKind::M, index }).collect();
    let regressor = DMatrix::from_fn(2 * count, b, |_, _| rng.random_range(-1.0..1.0));
    let beta = DVector::from_fn(b, |_, _| rng.random_range(-2.0..2.0));
    let observation = Observation {
        y: &regressor * &beta,
        used: vec![true; 2 * count],
        dof: 2,
        robot: "synthetic".to_owned(),
        units: vec!["N·m".to_owned(); 2],
        columns: Columns::RIGID,
        shape: Vec::new(),
        linear_at: None,
        base: BaseReduction::from_stack(&ids, &DMatrix::identity(b, b), Method::Qr),
        parameter_units: vec!["kg".to_owned(); b],
        noise: None,
        torque_covariance: None,
        periodic: false,
        periods: 1,
        provenance: None,
        regressor,
    };
    (observation, beta)
}

/// `count` samples of white noise with covariance `covariance` (n × n), stacked.
pub(super) fn white(covariance: &DMatrix<f64>, count: usize, rng: &mut impl Rng) -> DVector<f64> {
    let n = covariance.nrows();
    let l = Cholesky::new(covariance.clone()).unwrap().unpack();
    let mut noise = DVector::zeros(n * count);
    for k in 0..count {
        let z = DVector::from_fn(n, |_, _| -> f64 { StandardNormal.sample(rng) });
        noise.rows_mut(k * n, n).copy_from(&(&l * z));
    }
    noise
}
