//! What is done with estimates, which come as the text of their files.

use armid::estimation::{Estimate, predict as predicted};
use armid::statistics::student_quantile;
use armid_io::{Error, Inputs, Text, estimate};
use armid_workflow::{PayloadSide, columns_of, payload as payload_of};
use numpy::PyReadwriteArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Rows, output, states};
use crate::fault::{exception, raised};
use crate::robot::Robot;

/// An estimate from its text.
fn parsed(text: &str) -> PyResult<(Estimate, Text)> {
    let text = Text::new("the estimate", text);
    Ok((estimate::parse(&text).map_err(exception)?, text))
}

/// Torque that an estimate predicts for every sample, N × n, into `out`.
#[pyfunction]
pub(crate) fn predict(
    py: Python<'_>,
    robot: &Robot,
    text: &str,
    samples: [Rows<'_>; 3],
    mut out: PyReadwriteArrayDyn<'_, f64>,
) -> PyResult<()> {
    let [q, qd, qdd] = &samples;
    let (estimate, text) = parsed(text)?;
    estimate::check_robot(&estimate, &text.name, &robot.loaded).map_err(exception)?;
    let columns = columns_of(&estimate, &text.name).map_err(exception)?;
    let states = states(robot.dof(), [q, qd, qdd])?;
    let out = output(&mut out, &[states.len(), robot.dof()])?;
    let torque = py.detach(|| {
        let regressor = estimate.regressor(&robot.loaded.robot, columns)?;
        predicted(&estimate, &regressor, &states)
    });
    out.copy_from_slice(&torque.map_err(raised)?);
    Ok(())
}

/// The load by which two estimates of one arm differ, as the command's answer.
#[pyfunction]
pub(crate) fn payload(py: Python<'_>, robot: &Robot, without: (&str, &str), with: (&str, &str)) -> PyResult<String> {
    let side = |(name, text): (&str, &str)| -> Result<PayloadSide, Error> {
        let text = Text::new(name, text);
        Ok(PayloadSide {
            estimate: estimate::parse(&text)?,
            name: text.name.clone(),
            inputs: Inputs::of_estimate(&text)?,
        })
    };
    let answer = py.detach(|| {
        let answer = payload_of(&robot.loaded, side(without)?, side(with)?)?;
        serde_json::to_string(&answer).map_err(Error::of)
    });
    answer.map_err(exception)
}

/// Half the width of an interval that holds a share `level` of Student's t, in standard deviations.
#[pyfunction]
pub(crate) fn student(level: f64, degrees_of_freedom: f64) -> PyResult<f64> {
    if !(0.0 < level && level < 1.0 && degrees_of_freedom > 0.0) {
        return Err(raised(format!("the level is {level}, expected a number between 0 and 1")));
    }
    Ok(student_quantile(0.5 * (1.0 + level), degrees_of_freedom))
}
