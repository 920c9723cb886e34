//! The equations of motion of many samples: regressor, its normal equations, inverse and forward dynamics, mass matrix.
//!
//! Results go into arrays that Python made, so that a result which does not fit into memory is Python's `MemoryError`.

use armid::dynamics::Dynamics;
use armid::model::StandardParameters;
use armid::regressor::JointTorqueRegressor;
use numpy::{PyReadonlyArray1, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Rows, check_lengths, finite, output, samples_of};
use crate::fault::unexpected;
use crate::robot::Robot;

/// Numbers of one dimension.
type Vector<'py> = PyReadonlyArray1<'py, f64>;
/// Where a result goes.
type Output<'py> = PyReadwriteArrayDyn<'py, f64>;

/// A vector of as many finite numbers.
fn numbers<'a>(vector: &'a Vector<'_>, name: &str, expected: usize) -> PyResult<&'a [f64]> {
    let found = vector.len();
    if found != expected {
        return Err(unexpected(format!("{name} has {found} values, expected {expected}")));
    }
    let values = vector.as_slice().map_err(|_| unexpected(format!("{name} is not contiguous")))?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(unexpected(format!("{name}[{at}] is {}, expected a finite number", values[at]))),
        None => Ok(values),
    }
}

/// The parameters that a caller gives for these columns, or what is known of the robot.
fn parameters(robot: &Robot, columns: &str, given: Option<&Vector<'_>>) -> PyResult<StandardParameters> {
    let columns = robot.columns(columns)?;
    let of = &robot.loaded.robot;
    match given {
        Some(phi) => {
            let phi = numbers(phi, "parameters", columns.parameters(of).len())?;
            Ok(StandardParameters::from_vector(of, columns, phi))
        }
        None => robot.loaded.guess().cloned().ok_or_else(|| robot.without_parameters()),
    }
}

/// `Y(q, q̇, q̈)` of every sample into `out`, N × n × p.
#[pyfunction]
pub(crate) fn regressor(
    py: Python<'_>,
    robot: &Robot,
    samples: [Rows<'_>; 3],
    columns: &str,
    mut out: Output<'_>,
) -> PyResult<()> {
    let [q, qd, qdd] = &samples;
    let regressor = JointTorqueRegressor::new(&robot.loaded.robot, robot.columns(columns)?).map_err(unexpected)?;
    let rows = q.shape()[0];
    let samples = samples_of(robot.dof(), [q, qd, qdd])?;
    let (n, p) = (regressor.rows(), regressor.cols());
    let out = output(&mut out, &[rows, n, p])?;
    py.detach(|| {
        let all: Vec<usize> = (0..p).collect();
        regressor.stack_rows_into(samples, &all, out);
    });
    Ok(())
}

/// `Σ w_i Y_iᵀ Y_i` (p × p) into `information` and `Σ w_i Y_iᵀ τ_i` (p) into `moment`; no regressor is held.
#[pyfunction]
pub(crate) fn gram(
    py: Python<'_>,
    robot: &Robot,
    samples: [Rows<'_>; 4],
    weights: Option<Vector<'_>>,
    columns: &str,
    mut information: Output<'_>,
    mut moment: Output<'_>,
) -> PyResult<()> {
    let [q, qd, qdd, tau] = &samples;
    let regressor = JointTorqueRegressor::new(&robot.loaded.robot, robot.columns(columns)?).map_err(unexpected)?;
    let samples = samples_of(robot.dof(), [q, qd, qdd])?;
    check_lengths(&[("q", q), ("tau", tau)])?;
    let (n, p) = (regressor.rows(), regressor.cols());
    let tau = finite(tau, "tau", n)?;
    let weights = weights.as_ref().map_or_else(
        || Ok(vec![1.0; n]),
        |given| {
            let weights = numbers(given, "weights", n)?;
            match weights.iter().find(|weight| **weight < 0.0) {
                Some(weight) => Err(unexpected(format!("a weight is {weight}, expected numbers not below zero"))),
                None => Ok(weights.to_vec()),
            }
        },
    )?;
    let information = output(&mut information, &[p, p])?;
    let moment = output(&mut moment, &[p])?;
    py.detach(|| {
        let all: Vec<usize> = (0..p).collect();
        let gram = regressor.gram(samples, &all, tau, &weights);
        information.copy_from_slice(gram.information().as_slice());
        moment.copy_from_slice(gram.moment.as_slice());
    });
    Ok(())
}

/// `τ = H q̈ + c + g + τ_terms` of every sample into `out`, N × n.
#[pyfunction]
pub(crate) fn inverse_dynamics(
    py: Python<'_>,
    robot: &Robot,
    samples: [Rows<'_>; 3],
    columns: &str,
    given: Option<Vector<'_>>,
    mut out: Output<'_>,
) -> PyResult<()> {
    let parameters = parameters(robot, columns, given.as_ref())?;
    let [q, qd, qdd] = &samples;
    let (n, rows) = (robot.dof(), q.shape()[0]);
    let samples = samples_of(n, [q, qd, qdd])?;
    let out = output(&mut out, &[rows, n])?;
    py.detach(|| {
        Dynamics::new(&robot.loaded.robot, &parameters).inverse_of_samples(samples, out);
    });
    Ok(())
}

/// `q̈ = H⁻¹ (τ − c − g − τ_terms)` of every sample into `out`, N × n.
#[pyfunction]
pub(crate) fn forward_dynamics(
    py: Python<'_>,
    robot: &Robot,
    samples: [Rows<'_>; 3],
    columns: &str,
    given: Option<Vector<'_>>,
    mut out: Output<'_>,
) -> PyResult<()> {
    let parameters = parameters(robot, columns, given.as_ref())?;
    let [q, qd, tau] = &samples;
    check_lengths(&[("q", q), ("qd", qd), ("tau", tau)])?;
    let (n, rows) = (robot.dof(), q.shape()[0]);
    let (q, qd, tau) = (finite(q, "q", n)?, finite(qd, "qd", n)?, finite(tau, "tau", n)?);
    let out = output(&mut out, &[rows, n])?;
    py.detach(|| {
        let mut dynamics = Dynamics::new(&robot.loaded.robot, &parameters);
        for (k, qdd) in out.chunks_exact_mut(n).enumerate() {
            let of = k * n..(k + 1) * n;
            dynamics.forward(&q[of.clone()], &qd[of.clone()], &tau[of], qdd);
        }
    });
    Ok(())
}

/// `H(q)` of every sample into `out`, N × n × n.
#[pyfunction]
pub(crate) fn mass_matrix(
    py: Python<'_>,
    robot: &Robot,
    q: Rows<'_>,
    columns: &str,
    given: Option<Vector<'_>>,
    mut out: Output<'_>,
) -> PyResult<()> {
    let parameters = parameters(robot, columns, given.as_ref())?;
    let (n, rows) = (robot.dof(), q.shape()[0]);
    let q = finite(&q, "q", n)?;
    let out = output(&mut out, &[rows, n, n])?;
    py.detach(|| {
        let mut dynamics = Dynamics::new(&robot.loaded.robot, &parameters);
        for (q, matrix) in q.chunks_exact(n).zip(out.chunks_exact_mut(n * n)) {
            matrix.copy_from_slice(dynamics.mass_matrix(q).as_slice());
        }
    });
    Ok(())
}
