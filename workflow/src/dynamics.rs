//! What are torque, acceleration, mass matrix and regressor of a robot in given states?

use armid::dynamics::Dynamics;
use armid::model::{Columns, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid::trajectory::States;
use armid_io::Error;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// What is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Joint torque.
    Torque,
    /// How torque depends on each parameter.
    Regressor,
    /// The mass matrix.
    MassMatrix,
    /// Acceleration, by torque in the place of the acceleration of states.
    Acceleration,
}

armid::input::named! {
    Quantity {
        Torque: "torque",
        Regressor: "regressor",
        MassMatrix: "mass-matrix",
        Acceleration: "acceleration",
    }
}

/// A table of numbers with headings; the first columns are counts.
#[derive(Clone, Debug)]
pub struct DynamicsAnswer {
    robot: String,
    quantity: Quantity,
    counts: usize,
    /// What each column is.
    pub headings: Vec<String>,
    /// The rows, sample after sample.
    pub rows: Vec<Vec<f64>>,
}

/// The parameters of these columns, p, from an array.
///
/// # Errors
/// [`Error`] where there are more or fewer of them, or one is not finite.
pub fn parameters_of(robot: &Robot, columns: Columns, values: &[f64]) -> Result<StandardParameters, Error> {
    let expected = columns.parameters(robot).len();
    if values.len() != expected {
        return Err(Error::new(format!("found {} parameters, expected {expected}", values.len())));
    }
    check_finite("parameters", values)?;
    Ok(StandardParameters::from_vector(robot, columns, values))
}

/// Torque, acceleration or mass matrix with these parameters; the regressor is [`regressor`]'s.
///
/// # Errors
/// [`Error`] where parameters or states are not of the robot's joints, or one is not finite.
pub fn dynamics(
    robot: &Robot,
    parameters: &StandardParameters,
    quantity: Quantity,
    states: &States,
) -> Result<DynamicsAnswer, Error> {
    let n = robot.dof();
    check_states(robot, states)?;
    for (what, found) in [("links", parameters.links.len()), ("drives", parameters.drives.len())] {
        if found != n {
            return Err(Error::new(format!("found parameters of {found} {what}, expected {n}")));
        }
    }
    let phi = parameters.vector(robot, Columns::RIGID.with_terms_of(parameters));
    check_finite("parameters", phi.as_slice())?;
    let mut dynamics = Dynamics::new(robot, parameters);
    let numbered = |prefix: &'static str| (1..=n).map(move |k| format!("{prefix}{k}"));
    let mut rows = Vec::with_capacity(states.len());
    for k in 0..states.len() {
        let (q, qd, third) = (states.q(k), states.qd(k), states.qdd(k));
        let mut out = vec![0.0; n];
        match quantity {
            Quantity::Acceleration => dynamics.forward(q, qd, third, &mut out),
            Quantity::MassMatrix => {
                let m = dynamics.mass_matrix(q);
                rows.extend((0..n).map(|i| counted(k, i, m.row(i).iter().copied())));
                continue;
            }
            Quantity::Torque | Quantity::Regressor => dynamics.inverse(q, qd, third, &mut out),
        }
        rows.push(out);
    }
    let (counts, headings) = match quantity {
        Quantity::Acceleration => (0, numbered("qdd").collect()),
        Quantity::MassMatrix => (2, ["sample", "row"].map(str::to_owned).into_iter().chain(numbered("m")).collect()),
        Quantity::Torque | Quantity::Regressor => (0, numbered("tau").collect()),
    };
    Ok(DynamicsAnswer { robot: robot.name().to_owned(), quantity, counts, headings, rows })
}

/// The regressor of these columns.
///
/// # Errors
/// [`Error`] where the states are not of the robot's joints, one is not finite, or a column depends on more than the motion.
pub fn regressor(robot: &Robot, columns: Columns, states: &States) -> Result<DynamicsAnswer, Error> {
    check_states(robot, states)?;
    let regressor = JointTorqueRegressor::new(robot, columns);
    let regressor = regressor.map_err(|fault| Error::new(format!("columns {columns}: {fault}")))?;
    let (n, p) = (regressor.rows(), regressor.cols());
    let names = regressor.parameters().iter().map(ToString::to_string);
    let headings = ["sample", "joint"].map(str::to_owned).into_iter().chain(names).collect();
    let mut rows = Vec::with_capacity(states.len() * n);
    let mut y = vec![0.0; n * p];
    for k in 0..states.len() {
        regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
        rows.extend(y.chunks_exact(p).enumerate().map(|(i, row)| counted(k, i, row.iter().copied())));
    }
    Ok(DynamicsAnswer { robot: robot.name().to_owned(), quantity: Quantity::Regressor, counts: 2, headings, rows })
}

/// A row behind its sample, from zero, and its place, from one.
fn counted(sample: usize, place: usize, row: impl Iterator<Item = f64>) -> Vec<f64> {
    [sample as f64, (place + 1) as f64].into_iter().chain(row).collect()
}

fn check_states(robot: &Robot, states: &States) -> Result<(), Error> {
    let n = robot.dof();
    if states.dof != n || !states.q.len().is_multiple_of(n) {
        let message = format!("found {} positions of {} joints, expected rows of {n}", states.q.len(), states.dof);
        return Err(Error::new(message));
    }
    for (what, values) in
        [("positions", &states.q), ("velocities", &states.qd), ("accelerations or torques", &states.qdd)]
    {
        if values.len() != states.q.len() {
            return Err(Error::new(format!("found {} {what}, expected {}", values.len(), states.q.len())));
        }
        check_finite(what, values)?;
    }
    Ok(())
}

fn check_finite(what: &str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(Error::new(format!("{what}: found {} at place {at}, expected a finite number", values[at]))),
        None => Ok(()),
    }
}

impl Serialize for DynamicsAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |row: &Vec<f64>| -> Value {
            let (counts, values) = row.split_at(self.counts);
            counts.iter().map(|&count| json!(count as u64)).chain(values.iter().map(|&value| json!(value))).collect()
        };
        json!({
            "robot": self.robot,
            "quantity": self.quantity.name(),
            "headings": self.headings,
            "rows": self.rows.iter().map(row).collect::<Value>(),
        })
        .serialize(serializer)
    }
}
