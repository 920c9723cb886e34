//! A robot with its parameters in the formats of other tools, and the same read back.

use armid::dynamics::Dynamics;
use armid::model::format::{
    ChainEnds, FormatError, ImportedModel, edit_urdf, parse_mjcf, parse_parameter_map, parse_parameters, parse_urdf,
    write_parameters, write_urdf,
};
use armid::model::term::{COULOMB, ROTOR, Term, VISCOUS};
use armid::model::{Columns, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid_io::output::pretty;
use armid_io::{Error, LoadedRobot};
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

    /// The file's text, and what the reader must know of it. `header` is its comment, where the format has any; a robot
    /// that was read from a URDF gets that file with other numbers.
    pub(crate) fn write(
        self,
        loaded: &LoadedRobot,
        parameters: &StandardParameters,
        header: &str,
    ) -> Result<(String, Vec<String>)> {
        let robot = &loaded.robot;
        let text = match (self, &loaded.urdf) {
            (Self::Urdf, Some(urdf)) => {
                let mut edited = edit_urdf(&urdf.text.content, &urdf.ends, parameters)
                    .map_err(|fault| Error::new(format!("{}: {fault}", urdf.text.name)))?;
                let read = parse_urdf(&edited.text, &urdf.ends).map(|model| model.robot.gravity());
                if read.is_ok_and(|read| (read - robot.gravity()).amax() > ROUNDING) {
                    let remark =
                        "URDF has no place for gravity, which readers take along −z of the root: here it is another";
                    edited.remarks.push(remark.to_owned());
                }
                return Ok((edited.text, edited.remarks));
            }
            (Self::Urdf, None) => write_urdf(robot, parameters, header),
            (Self::Mjcf, _) => armid_sim::mjcf_for_exchange(robot, parameters, header)
                .map_err(|error| Error::new(error.to_string()))?,
            (Self::Toml, _) => write_parameters(robot, parameters, header),
            (Self::Json, _) => {
                let ids = Columns::RIGID_ROTOR_FRICTION.parameters(robot);
                let map: Map<String, Value> =
                    ids.into_iter().map(|id| (id.to_string(), parameters.get(id).into())).collect();
                pretty(&Value::Object(map))
            }
        };
        Ok((text, Vec::new()))
    }

    /// Whether the format has a place for a term.
    fn carries(self, term: Term) -> bool {
        match self {
            Self::Urdf => [VISCOUS, COULOMB].contains(&term),
            Self::Mjcf => [ROTOR, VISCOUS, COULOMB].contains(&term),
            Self::Toml => true,
            Self::Json => Columns::RIGID_ROTOR_FRICTION.has(term),
        }
    }

    /// The robot and its parameters as a reader of the file sees them.
    fn read(self, text: &str, loaded: &LoadedRobot) -> std::result::Result<(Robot, StandardParameters), FormatError> {
        let imported = |parsed: std::result::Result<ImportedModel, FormatError>| {
            parsed.map(|model| (model.robot, model.parameters))
        };
        let robot = &loaded.robot;
        match self {
            Self::Urdf => match &loaded.urdf {
                // Gravity is that of the robot file.
                Some(urdf) => imported(parse_urdf(text, &urdf.ends)).map(|(read, parameters)| {
                    (read.clone().with_gravity(read.base().rotation * robot.gravity()), parameters)
                }),
                None => imported(parse_urdf(text, &ChainEnds::default())),
            },
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
    /// Largest difference of its torque, links and rotors as far as the format has them, from `Y φ`, over the largest
    /// torque of the joint.
    pub(crate) difference: f64,
    /// Largest difference of a friction coefficient that the format has, over its size.
    pub(crate) friction: f64,
    /// What the format has no place for.
    pub(crate) left_out: Option<LeftOut>,
}

/// Terms that a format has no place for, and what torque lacks without them.
pub(crate) struct LeftOut {
    /// What they are called.
    pub(crate) meanings: Vec<&'static str>,
    /// RMS of the torque that is missing over the RMS of all torque, for each joint.
    pub(crate) missing: Vec<f64>,
}

impl Reloaded {
    /// The torque of what the file says, by the recursion, against the regressor of the robot itself times the parameters.
    pub(crate) fn compare(
        format: Exchange,
        text: &str,
        loaded: &LoadedRobot,
        parameters: &StandardParameters,
    ) -> Result<Self> {
        let robot = &loaded.robot;
        let (read, mut found) = format
            .read(text, loaded)
            .map_err(|fault| Error::new(format!("the file does not read back: {}", fault.message)))?;
        if read.dof() != robot.dof() || found.drives.len() != parameters.drives.len() {
            let (found, expected) = (read.dof(), robot.dof());
            return Err(Error::new(format!("the file reads back with {found} joints, expected {expected}")).into());
        }
        let friction = [VISCOUS, COULOMB].into_iter().flat_map(|term| {
            let pairs = found.drives.iter().zip(&parameters.drives);
            pairs.map(move |(found, expected)| {
                let size = expected[term].abs().max(f64::MIN_POSITIVE);
                if format.carries(term) { (found[term] - expected[term]).abs() / size } else { 0.0 }
            })
        });
        let friction = friction.fold(0.0, f64::max);
        let columns = if format.carries(ROTOR) { Columns::RIGID_ROTOR } else { Columns::RIGID };
        for drive in &mut found.drives {
            *drive = drive.only(|term| columns.has(term));
        }
        let (n, regressor) = (robot.dof(), JointTorqueRegressor::new(robot, columns));
        let phi = parameters.vector(robot, columns);
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
        let difference = difference.fold(0.0, f64::max);
        Ok(Self { states: STATES, difference, friction, left_out: LeftOut::of(format, robot, parameters) })
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.difference <= ROUNDING && self.friction <= ROUNDING
    }
}

impl LeftOut {
    /// What a format leaves out of these parameters; `None` where it is nothing.
    fn of(format: Exchange, robot: &Robot, parameters: &StandardParameters) -> Option<Self> {
        let mut meanings: Vec<&'static str> = Vec::new();
        let mut kept = parameters.clone();
        for (drive, kept) in parameters.drives.iter().zip(&mut kept.drives) {
            for (term, value) in drive.iter() {
                let meaning = term.entry().meaning;
                if !format.carries(term) && value != 0.0 && !meanings.contains(&meaning) {
                    meanings.push(meaning);
                }
            }
            *kept = drive.only(|term| format.carries(term));
        }
        if meanings.is_empty() {
            return None;
        }
        let n = robot.dof();
        let (mut whole, mut part) = (Dynamics::new(robot, parameters), Dynamics::new(robot, &kept));
        let (mut all, mut missing) = (vec![0.0; n], vec![0.0; n]);
        let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
        let mut rng = Seed::new(0).stream("read back", 0);
        for _ in 0..STATES {
            let (q, qd, qdd) = armid::conformance::chains::random_state(&mut rng, n);
            whole.inverse(&q, &qd, &qdd, &mut a);
            part.inverse(&q, &qd, &qdd, &mut b);
            for i in 0..n {
                all[i] += a[i] * a[i];
                missing[i] += (a[i] - b[i]) * (a[i] - b[i]);
            }
        }
        let missing = missing.iter().zip(&all).map(|(part, all)| (part / all.max(f64::MIN_POSITIVE)).sqrt()).collect();
        Some(Self { meanings, missing })
    }
}
