//! A robot with its parameters in the formats of other tools, and the same read back.

use armid::dynamics::Dynamics;
use armid::model::format::{
    ChainEnds, FormatError, parse_mjcf, parse_parameter_map, parse_parameters, parse_urdf, write_parameters, write_urdf,
};
use armid::model::{Columns, DriveParameters, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid_io::Error;
use armid_io::output::pretty;
use miette::Result;
use serde_json::{Map, Value};

/// States on which what was read back is compared.
const STATES: usize = 200;

/// Relative difference that rounding explains: numbers go through text, angles and another choice of frames.
const ROUNDING: f64 = 1e-9;

/// A format that other tools read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exchange {
    Urdf,
    Mjcf,
    Toml,
    Json,
}

impl Exchange {
    /// Every format.
    pub(crate) const ALL: [Self; 4] = [Self::Urdf, Self::Mjcf, Self::Toml, Self::Json];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::Toml => "toml",
            Self::Json => "json",
        }
    }

    /// How files of this format end.
    pub(crate) const fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            other => other.name(),
        }
    }

    /// The file's text. `header` is its comment, where the format has any.
    pub(crate) fn write(self, robot: &Robot, parameters: &StandardParameters, header: &str) -> Result<String> {
        Ok(match self {
            Self::Urdf => write_urdf(robot, parameters, header),
            Self::Mjcf => armid_sim::mjcf_for_exchange(robot, parameters, header)
                .map_err(|error| Error::new(error.to_string()))?,
            Self::Toml => write_parameters(robot, parameters, header),
            Self::Json => {
                let ids = Columns::RIGID_ROTOR_FRICTION.parameters(robot);
                let map: Map<String, Value> =
                    ids.into_iter().map(|id| (id.to_string(), parameters.get(id).into())).collect();
                pretty(&Value::Object(map))
            }
        })
    }

    /// The robot and its parameters as a reader of the file sees them.
    fn read(self, text: &str, robot: &Robot) -> std::result::Result<(Robot, StandardParameters), FormatError> {
        let imported = |parsed: std::result::Result<armid::model::format::ImportedModel, FormatError>| {
            parsed.map(|model| (model.robot, model.parameters))
        };
        match self {
            Self::Urdf => imported(parse_urdf(text, &ChainEnds::default())),
            Self::Mjcf => imported(parse_mjcf(text, &ChainEnds::default())),
            Self::Toml => parse_parameters(text, robot, true).map(|file| (robot.clone(), file.parameters)),
            Self::Json => parse_parameter_map(text, robot).map(|parameters| (robot.clone(), parameters)),
        }
    }
}

/// What a file says when it is read back.
pub(crate) struct Reloaded {
    /// Random states at which it was asked.
    pub(crate) states: usize,
    /// Largest difference of its rigid torque from `Y φ`, over the largest torque of the joint.
    pub(crate) difference: f64,
}

impl Reloaded {
    /// The rigid torque of what the file says, by the recursion, against the regressor of the robot itself times the
    /// parameters.
    pub(crate) fn compare(
        format: Exchange,
        text: &str,
        robot: &Robot,
        parameters: &StandardParameters,
    ) -> Result<Self> {
        let (read, mut found) = format
            .read(text, robot)
            .map_err(|fault| Error::new(format!("the file does not read back: {}", fault.message)))?;
        found.drives.fill(DriveParameters::default());
        let (n, regressor) = (robot.dof(), JointTorqueRegressor::new(robot, Columns::RIGID));
        let phi = parameters.vector(robot, Columns::RIGID);
        let mut dynamics = Dynamics::new(&read, &found);
        let mut y = vec![0.0; n * phi.len()];
        let mut tau = vec![0.0; n];
        let (mut largest, mut differences) = (vec![0.0_f64; n], vec![0.0_f64; n]);
        let mut rng = Seed::new(0).stream("read back", 0);
        for _ in 0..STATES {
            let (q, qd, qdd) = armid::conformance::chains::random_state(&mut rng, n);
            regressor.evaluate(&q, &qd, &qdd, &mut y);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            for i in 0..n {
                let expected: f64 =
                    y[i * phi.len()..(i + 1) * phi.len()].iter().zip(&phi).map(|(y, phi)| y * phi).sum();
                largest[i] = largest[i].max(expected.abs());
                differences[i] = differences[i].max((tau[i] - expected).abs());
            }
        }
        let difference = differences.iter().zip(&largest).map(|(d, size)| d / size.max(f64::MIN_POSITIVE));
        Ok(Self { states: STATES, difference: difference.fold(0.0, f64::max) })
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.difference <= ROUNDING
    }
}
