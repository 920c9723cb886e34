//! A robot with its parameters in the formats of other tools, and the same read back.

use armid::dynamics::Dynamics;
use armid::model::format::{
    ChainEnds, EditedText, FormatError, ImportedModel, edit_mjcf, edit_urdf, law_map, note, parse_mjcf,
    parse_parameter_map, parse_parameters, parse_urdf, write_parameters, write_urdf,
};
use armid::model::term::{COULOMB, ROTOR, VISCOUS};
use armid::model::{Columns, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid_io::output::pretty;
use armid_io::robot::ChainSource;
use armid_io::{Error, LoadedRobot};
use serde::Serialize;
use serde_json::{Map, Value};

use super::python_file;
use super::read_back::{STATES, largest_difference};

/// Relative difference that rounding explains: numbers go through text, angles and another choice of frames.
const ROUNDING: f64 = 1e-9;

/// A format that other tools read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Exchange {
    /// A URDF: rigid bodies, viscous and Coulomb friction.
    Urdf,
    /// An MJCF: rotor inertia, too.
    Mjcf,
    /// A file of parameters, with every term.
    Toml,
    /// A map of names to values, with every term.
    Json,
    /// Settings of the actuators in Isaac Lab, in Python, beside an MJCF.
    Isaac,
    /// An MJCF without friction, and friction of every law for a simulator's step, in Python.
    Python,
}

armid::input::named! {
    Exchange { Urdf: "urdf", Mjcf: "mjcf", Toml: "toml", Json: "json", Isaac: "isaac", Python: "python" }
}

impl Exchange {
    /// How files of this format end.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Isaac | Self::Python => "py",
            other => other.name(),
        }
    }

    /// The terms that it has a place for, of a model that was estimated with some.
    pub(super) fn columns(self, estimated: Columns) -> Columns {
        let friction = Columns::RIGID.with_term(VISCOUS).with_term(COULOMB);
        match self {
            Self::Urdf => friction,
            Self::Mjcf | Self::Isaac => friction.with_term(ROTOR),
            Self::Toml | Self::Json | Self::Python => estimated,
        }
    }

    /// The robot with the laws of friction that a reader of the file has: URDF, MJCF and Isaac Lab have a plain sign.
    pub(super) fn robot(self, robot: &Robot) -> Result<Robot, Error> {
        match self {
            Self::Urdf | Self::Mjcf | Self::Isaac => {
                let plain = robot.clone().with_joints(|joint| joint.drive.coulomb_velocity = 0.0);
                plain.map_err(Error::new)
            }
            Self::Toml | Self::Json | Self::Python => Ok(robot.clone()),
        }
    }

    /// The file that is edited in place, of what a robot was read from.
    pub fn template(self, loaded: &LoadedRobot) -> Option<&ChainSource> {
        match self {
            Self::Urdf => loaded.urdf.as_ref(),
            // A tendon that stands for a coupled motor is written anew.
            Self::Mjcf | Self::Python => loaded.mjcf.as_ref().filter(|_| loaded.robot.coupling().is_none()),
            Self::Toml | Self::Json | Self::Isaac => None,
        }
    }

    /// The file's text, and what the reader must know of it. `header` is its comment, where the format has any; a `template` is that file
    /// with other numbers.
    pub(super) fn write(
        self,
        robot: &Robot,
        template: Option<&ChainSource>,
        parameters: &StandardParameters,
        header: &str,
    ) -> Result<(String, Vec<String>), Error> {
        if self == Self::Python {
            let mut bodies = parameters.clone();
            for drive in &mut bodies.drives {
                *drive = drive.only(|term| term == ROTOR);
            }
            let (mjcf, remarks) = Self::Mjcf.write(robot, template, &bodies, "")?;
            let map = parameter_map(robot, parameters);
            return Ok((python_file::write(self.name(), robot, parameters, (&map, Some(&mjcf)), header)?, remarks));
        }
        if let Some(source) = template {
            let named = |fault: FormatError| Error::new(format!("{}: {fault}", source.text.name));
            let edited = match self {
                Self::Mjcf => edit_mjcf(&source.text.content, &source.ends, robot, parameters),
                _ => edit_urdf(&source.text.content, &source.ends, parameters),
            };
            let EditedText { text, mut remarks } = edited.map_err(named)?;
            let gravity = self.model(&text, &source.ends).map(|model| model.robot.gravity());
            if gravity.is_ok_and(|read| (read - robot.gravity()).amax() > ROUNDING) {
                remarks.push(format!("gravity is that of {}: in the robot file it is another", source.text.name));
            }
            return Ok((note(&text, &header.replace('\n', " ")).map_err(named)?, remarks));
        }
        let text = match self {
            Self::Urdf => write_urdf(robot, parameters, header),
            Self::Mjcf => armid_sim::mjcf_for_exchange(robot, parameters, header).map_err(Error::new)?,
            Self::Toml => write_parameters(robot, parameters, header),
            Self::Json => parameter_map(robot, parameters),
            Self::Isaac | Self::Python => {
                python_file::write(self.name(), robot, parameters, (&parameter_map(robot, parameters), None), header)?
            }
        };
        Ok((text, Vec::new()))
    }

    fn model(self, text: &str, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
        if self == Self::Mjcf { parse_mjcf(text, ends) } else { parse_urdf(text, ends) }
    }

    /// The robot and its parameters as a reader of the file sees them, gravity being that of the robot file where it was edited in place.
    pub(super) fn read(
        self,
        text: &str,
        robot: &Robot,
        template: Option<&ChainSource>,
    ) -> Result<(Robot, StandardParameters), Error> {
        let read = match self {
            Self::Urdf | Self::Mjcf => {
                let ends = template.map_or_else(ChainEnds::default, |source| source.ends.clone());
                self.model(text, &ends).map(|ImportedModel { robot: read, parameters, .. }| match template {
                    Some(_) => (read.clone().with_gravity(read.base().rotation * robot.gravity()), parameters),
                    None => (read, parameters),
                })
            }
            Self::Toml => parse_parameters(text, robot, true)
                .map(|file| (robot.clone().with_drives(file.motors), file.parameters)),
            // A map alone is a file without anything around it.
            Self::Json | Self::Isaac => {
                parse_parameter_map(python_file::parameters(text), robot).map(|(parameters, robot)| (robot, parameters))
            }
            Self::Python => {
                let (read, mut found) = Self::Mjcf.read(python_file::mjcf(text), robot, template)?;
                parse_parameter_map(python_file::parameters(text), robot).map(|(parameters, own)| {
                    found.drives = parameters.drives;
                    (read.with_drives(own.joints().iter().map(|joint| joint.drive.clone()).collect()), found)
                })
            }
        };
        read.map_err(|fault| Error::new(format!("the file does not read back: {}", fault.message)))
    }
}

/// Every parameter and every number of a law of friction by its name, as a JSON object.
fn parameter_map(robot: &Robot, parameters: &StandardParameters) -> String {
    let ids = Columns::RIGID_ROTOR_FRICTION.with_terms_of(parameters).parameters(robot);
    let laws = law_map(robot, parameters).into_iter().map(|(name, value)| (name, value.into()));
    let map: Map<String, Value> =
        ids.into_iter().map(|id| (id.to_string(), parameters.get(id).into())).chain(laws).collect();
    pretty(&Value::Object(map))
}

/// What a file says when it is read back.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Reloaded {
    /// Random states at which it was asked.
    pub states: usize,
    /// Largest difference of its torque, links and rotors as far as the format has them, from `Y φ`, over the largest
    /// torque of the joint.
    #[serde(rename = "largest_relative_difference")]
    pub difference: f64,
    /// Largest difference of a friction coefficient that the format has, over its size.
    #[serde(rename = "largest_friction_difference")]
    pub friction: f64,
}

impl Reloaded {
    /// The torque of what the file says, by the recursion, against the regressor of the robot itself times the parameters, as far as
    /// `columns` has them.
    pub(super) fn compare(
        robot: &Robot,
        parameters: &StandardParameters,
        (read, found): (&Robot, &StandardParameters),
        columns: Columns,
    ) -> Result<Self, Error> {
        if read.dof() != robot.dof() || found.drives.len() != parameters.drives.len() {
            let (found, expected) = (read.dof(), robot.dof());
            return Err(Error::new(format!("the file reads back with {found} joints, expected {expected}")));
        }
        let mut found = found.clone();
        let friction = [VISCOUS, COULOMB].into_iter().flat_map(|term| {
            let pairs = found.drives.iter().zip(&parameters.drives);
            pairs.map(move |(found, expected)| {
                let size = expected[term].abs().max(f64::MIN_POSITIVE);
                if columns.has(term) { (found[term] - expected[term]).abs() / size } else { 0.0 }
            })
        });
        let friction = friction.fold(0.0, f64::max);
        let columns = if columns.has(ROTOR) { Columns::RIGID_ROTOR } else { Columns::RIGID };
        for drive in &mut found.drives {
            *drive = drive.only(|term| columns.has(term));
        }
        let regressor = JointTorqueRegressor::new(robot, columns).map_err(Error::new)?;
        let phi = parameters.vector(robot, columns);
        let mut dynamics = Dynamics::new(read, &found);
        let torque = |q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]| dynamics.inverse(q, qd, qdd, tau);
        let difference = largest_difference(&regressor, phi.as_slice(), torque);
        Ok(Self { states: STATES, difference, friction })
    }

    pub(super) fn is_sound(&self) -> bool {
        self.difference <= ROUNDING && self.friction <= ROUNDING
    }
}
