//! What does the last link carry?

use armid::base::{Method, reduce};
use armid::estimation::{BaseEstimate, Estimate, EstimatorKind, Payload, Termination, payload as payload_of};
use armid::model::{Columns, ParameterId, Robot};
use armid::observer::Observer;
use armid::remedy::{Remedy, Task};
use armid::seed::Seed;
use armid_io::estimate::check_robot;
use armid_io::{Error, Inputs, LoadedRobot, ProcessedLog};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// An estimate of the arm without or with its load.
#[derive(Clone, Debug)]
pub struct PayloadSide {
    /// The estimate.
    pub estimate: Estimate,
    /// What it is called in errors.
    pub name: String,
    /// What it was made from, where that is known.
    pub inputs: Option<Inputs>,
}

impl PayloadSide {
    /// The estimate from a log, with the speeds of friction of the other side where that is there already. Else they are found where the log has no periods,
    /// and become those of its robot.
    ///
    /// # Errors
    /// [`Error`] where the log does not show every parameter, or the other side is of another robot; of
    /// [`armid_io::ErrorKind::Interrupted`] where the observer ended the work.
    pub fn of_log(
        log: &mut ProcessedLog,
        inputs: Option<Inputs>,
        columns: Columns,
        estimator: EstimatorKind,
        other: Option<&Self>,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        match other {
            Some(other) => log.take_shape(&other.estimate, &other.name)?,
            None if log.has_no_periods() => {
                log.find_onset(columns, observer)?;
            }
            None => {}
        }
        let name = log.name();
        let mut estimates = log.identify_for_difference(columns, &[estimator.estimator()], observer)?;
        let ended = |of: &Estimate| matches!(of.termination, Termination::Interrupted { .. });
        let estimate = estimates.pop().filter(|of| !ended(of)).ok_or_else(|| Error::interrupted(&name))?;
        Ok(Self { estimate, name, inputs })
    }
}

/// A load, and everything that is said of it. It serialises to the keys of the command's answer.
#[derive(Clone, Debug)]
pub struct PayloadAnswer {
    /// The load.
    pub found: Payload,
    /// The robot.
    pub robot: Robot,
    /// The arm without it.
    pub without: PayloadSide,
    /// The arm with it.
    pub with: PayloadSide,
}

/// The columns of an estimate.
///
/// # Errors
/// [`Error`] where it names none.
pub fn columns_of(estimate: &Estimate, name: &str) -> Result<Columns, Error> {
    Columns::parse(&estimate.columns).ok_or_else(|| {
        let names = Columns::ALL.map(|columns| columns.to_string()).join(", ");
        Error::new(format!("{name}: the set of columns is \"{}\", expected one of {names}", estimate.columns))
    })
}

/// Two estimates are of two recordings.
pub(crate) fn check_apart(without: (&str, Option<&Inputs>), with: Option<&Inputs>) -> Result<(), Error> {
    if let ((name, Some(one)), Some(other)) = (without, with)
        && let Some(file) = one.shared_file(other)
    {
        let message =
            format!("{} with the load is {name} without it (the same SHA-256), expected two recordings", file.path);
        return Err(Error::mismatch(message).help("record one log with the load and one without it"));
    }
    Ok(())
}

/// The load by which two estimates of one arm differ.
///
/// # Errors
/// [`Error`] where they are of one recording, of other robots or columns, or do not show every parameter.
pub fn payload(loaded: &LoadedRobot, without: PayloadSide, with: PayloadSide) -> Result<PayloadAnswer, Error> {
    check_apart((&without.name, without.inputs.as_ref()), with.inputs.as_ref())?;
    check_robot(&without.estimate, &without.name, loaded)?;
    let columns = columns_of(&without.estimate, &without.name)?;
    let base = reduce(&loaded.robot, columns, Method::Structural, Seed::new(0))
        .map_err(|error| Error::new(format!("robot \"{}\": {error}", loaded.robot.name())))?;
    let found = payload_of(&base, &without.estimate, &with.estimate).map_err(|error| {
        let help = Remedy::from("both logs must move every joint; ")
            .perform(Task::Design, "")
            .say(" makes a motion that does");
        Error::new(format!("{}, {}: {error}", without.name, with.name)).help(help)
    })?;
    Ok(PayloadAnswer { found, robot: loaded.robot.clone(), without, with })
}

impl PayloadAnswer {
    /// Whether the body was found, agrees with the estimates and weighs something, and is all that changed.
    pub fn is_sound(&self) -> bool {
        let Payload { body, negative_mass, .. } = &self.found;
        body.termination.was_successful() && body.is_within() && negative_mass.is_none() && self.found.is_of_a_load()
    }

    /// Name of the link that carries it.
    pub fn link(&self) -> &str {
        self.robot.link_name(self.robot.dof())
    }
}

impl Serialize for PayloadAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let found = &self.found;
        let body = found.body.inertia;
        let centre = body.first_moment / body.mass;
        let term = |(id, coefficient): &(ParameterId, f64)| json!({ "parameter": id.kind.symbol(), "coefficient": coefficient });
        let combination = |(row, parameter): (usize, &BaseEstimate)| {
            let (mut value, terms) = (json!(parameter), found.base.terms(row));
            value["terms"] = terms.iter().map(term).collect();
            value["name"] = json!(terms[0].0.kind.symbol());
            value
        };
        json!({
            "robot": self.robot.name(),
            "link": self.link(),
            "without": self.without.name,
            "with": self.with.name,
            "parameters": found.parameters,
            "combinations": found.combinations.base.iter().enumerate().map(combination).collect::<Value>(),
            "covariance": found.combinations.covariance,
            "negative_mass": found.negative_mass,
            "body": {
                "mass_kg": body.mass,
                "com_m": centre.as_slice(),
                "first_moment_kg_m": body.first_moment.as_slice(),
                "inertia_kg_m2": body.to_array()[4..],
                "chi_squared": found.body.chi_squared,
                "chi_squared_limit": found.body.chi_squared_limit,
                "termination": found.body.termination,
            },
            "consistent": body.check().is_ok(),
            "chi_squared": found.chi_squared,
            "chi_squared_limit": found.chi_squared_limit,
            "widened_by": found.widened_by,
            "friction_change": found.friction_change,
            "offset_change": found.offset_change,
            "inputs": { "without": self.without.inputs, "with": self.with.inputs },
        })
        .serialize(serializer)
    }
}
