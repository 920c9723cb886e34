//! `truth.toml`, `nominal.toml` and exports: the dynamic parameters of an arm.

use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::drive_table::{CIRCUIT, DriveTable, TORQUE_CONSTANT};
use super::error::FormatError;
use super::reading::{Check, Number, Row, read};
use super::relative_uncertainty::{RelativeUncertainty, UncertaintyTable};
use super::shape_parameters;
use super::term_keys::read_terms;
use crate::model::drive::Drive;
use crate::model::parameters::StandardParameters;
use crate::model::robot::Robot;
use crate::spatial::Inertia;

/// Where a group of numbers comes from.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Note {
    /// What the note is about: `link waist`, `drive elbow`.
    pub subject: String,
    /// The source, or why the numbers were assumed.
    pub source: String,
}

/// A set of parameters with the notes of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterFile {
    /// The values.
    pub parameters: StandardParameters,
    /// What the motors really are: the robot's drives, with what this file says of their circuits and laws of friction; n. The
    /// back-EMF constant is the torque constant.
    pub motors: Vec<Drive>,
    /// Where they come from.
    pub notes: Vec<Note>,
}

/// Prior knowledge of an experimenter.
#[derive(Clone, Debug, PartialEq)]
pub struct NominalParameters {
    /// The guess.
    pub parameters: StandardParameters,
    /// How good it is.
    pub relative_uncertainty: RelativeUncertainty,
    /// Where the numbers come from.
    pub notes: Vec<Note>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParametersTable {
    link: Spanned<Vec<Spanned<LinkTable>>>,
    drive: Option<Spanned<Vec<Spanned<DriveTable>>>>,
    /// What a simulated arm does beside its parameters: read by the simulator.
    #[serde(rename = "effects")]
    _effects: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NominalTable {
    relative_uncertainty: Spanned<UncertaintyTable>,
    link: Spanned<Vec<Spanned<LinkTable>>>,
    drive: Option<Spanned<Vec<Spanned<DriveTable>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkTable {
    name: Spanned<String>,
    source: Option<String>,
    mass_kg: Number,
    com_m: Option<Row>,
    inertia_about_com_kg_m2: Option<Spanned<InertiaTable>>,
    first_moment_kg_m: Option<Row>,
    inertia_kg_m2: Option<Spanned<InertiaTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InertiaTable {
    xx: Number,
    xy: Number,
    xz: Number,
    yy: Number,
    yz: Number,
    zz: Number,
}

/// Reads a set of parameters for a robot.
///
/// Each link has `mass_kg` and exactly one of two forms: `com_m` with `inertia_about_com_kg_m2`, or `first_moment_kg_m`
/// with `inertia_kg_m2` about the origin of the link's frame. A drive that is not given, or a key of it, is zero. A table
/// `[effects]` is no parameter and is passed over.
///
/// # Errors
/// [`FormatError`] with line and column: an unknown or missing key, both forms or none, a link or joint that the robot
/// does not have, one that is missing or there twice, a number that is not finite, friction of a coupled motor where no
/// motor is coupled; and, where `require_consistent`, a link whose pseudo-inertia is not positive definite or a rotor
/// or friction below zero.
pub fn parse_parameters(text: &str, robot: &Robot, require_consistent: bool) -> Result<ParameterFile, FormatError> {
    let file: ParametersTable = read(text)?;
    let reader = ParameterReader { check: Check::new(text), robot, require_consistent };
    reader.parameters(&file.link, file.drive.as_ref())
}

/// Reads a `nominal.toml`: physically consistent parameters and their uncertainty.
///
/// # Errors
/// As [`parse_parameters`], and an uncertainty that is missing or below zero.
pub fn parse_nominal(text: &str, robot: &Robot) -> Result<NominalParameters, FormatError> {
    let file: NominalTable = read(text)?;
    let check = Check::new(text);
    let relative_uncertainty = file.relative_uncertainty.get_ref().read(check, file.relative_uncertainty.span())?;
    let reader = ParameterReader { check, robot, require_consistent: true };
    let ParameterFile { parameters, notes, .. } = reader.parameters(&file.link, file.drive.as_ref())?;
    Ok(NominalParameters { parameters, relative_uncertainty, notes })
}

/// Reads the links and drives of one file.
struct ParameterReader<'a> {
    check: Check<'a>,
    robot: &'a Robot,
    require_consistent: bool,
}

impl ParameterReader<'_> {
    fn parameters(
        &self,
        links: &Spanned<Vec<Spanned<LinkTable>>>,
        drives: Option<&Spanned<Vec<Spanned<DriveTable>>>>,
    ) -> Result<ParameterFile, FormatError> {
        let mut parameters = StandardParameters::zero(self.robot.dof());
        let mut motors: Vec<Drive> = self.robot.joints().iter().map(|joint| joint.drive.clone()).collect();
        let names: Vec<&str> = self.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let mut notes = Vec::new();
        let note = |what: &str, name: &Spanned<String>, source: &Option<String>| {
            source.clone().map(|source| Note { subject: format!("{what} {}", name.get_ref()), source })
        };
        let mut seen = vec![false; self.robot.dof()];
        for table in links.get_ref() {
            let index = self.check.place("link", &table.get_ref().name, &names, &mut seen)?;
            parameters.links[index] = self.link(table.get_ref())?;
            notes.extend(note("link", &table.get_ref().name, &table.get_ref().source));
        }
        if let Some(missing) = seen.iter().position(|seen| !seen) {
            let name = names[missing];
            let message = format!("link \"{name}\" is missing, expected one [[link]] for each link of the robot");
            let at = links.get_ref().last().map_or_else(|| links.span(), Spanned::span);
            return self.check.fault(at, message);
        }
        let mut seen = vec![false; self.robot.dof()];
        for table in drives.map(|drives| drives.get_ref().as_slice()).unwrap_or_default() {
            let index = self.check.place("joint", &table.get_ref().joint, &names, &mut seen)?;
            let (numbers, drive) = (table.get_ref().numbers(), &mut parameters.drives[index]);
            read_terms(self.check, self.robot, index, numbers, self.require_consistent, drive)?;
            self.motor(table.get_ref(), &mut motors[index])?;
            notes.extend(note("drive", &table.get_ref().joint, &table.get_ref().source));
        }
        Ok(ParameterFile { parameters, motors, notes })
    }

    fn link(&self, table: &LinkTable) -> Result<Inertia, FormatError> {
        let check = self.check;
        let name = table.name.get_ref();
        let mass = check.finite("mass_kg", &table.mass_kg)?;
        let forms = ((&table.com_m, &table.inertia_about_com_kg_m2), (&table.first_moment_kg_m, &table.inertia_kg_m2));
        let inertia = match forms {
            ((Some(com), Some(about_com)), (None, None)) => {
                Inertia::from_com(mass, check.vector("com_m", com)?, self.matrix(about_com.get_ref())?)
            }
            ((None, None), (Some(moment), Some(inertia))) => Inertia {
                mass,
                first_moment: check.vector("first_moment_kg_m", moment)?,
                rotational: self.matrix(inertia.get_ref())?,
            },
            _ => {
                let message = format!(
                    "link \"{name}\" has neither or a mixture of the two forms, expected com_m with \
                     inertia_about_com_kg_m2, or first_moment_kg_m with inertia_kg_m2"
                );
                return check.fault(table.name.span(), message);
            }
        };
        if self.require_consistent
            && let Err(fault) = inertia.check()
        {
            let message = format!("link \"{name}\" is physically inconsistent: {fault}");
            return check.fault(table.mass_kg.span(), message);
        }
        Ok(inertia)
    }

    fn matrix(&self, table: &InertiaTable) -> Result<Matrix3<f64>, FormatError> {
        let [xx, xy, xz, yy, yz, zz] = [
            ("xx", &table.xx),
            ("xy", &table.xy),
            ("xz", &table.xz),
            ("yy", &table.yy),
            ("yz", &table.yz),
            ("zz", &table.zz),
        ]
        .map(|(key, number)| self.check.finite(key, number));
        let (xy, xz, yz) = (xy?, xz?, yz?);
        Ok(Matrix3::from_columns(&[Vector3::new(xx?, xy, xz), Vector3::new(xy, yy?, yz), Vector3::new(xz, yz, zz?)]))
    }

    /// Puts what the file says of a motor in place of what the robot file says.
    fn motor(&self, table: &DriveTable, drive: &mut Drive) -> Result<(), FormatError> {
        if let Some(x) = table.number(TORQUE_CONSTANT) {
            drive.torque_constant = self.check.positive(TORQUE_CONSTANT, x)?;
        }
        for shape in shape_parameters::all() {
            if let Some(x) = table.number(shape.key) {
                drive.set_shape(&shape, self.check.not_negative(shape.key, x)?);
            }
        }
        let keys = CIRCUIT.map(|key| (key, table.number(key)));
        let Some(circuit) = &mut drive.circuit else {
            return match keys.iter().find_map(|(key, x)| x.map(|x| (key, x))) {
                Some((key, x)) => self.check.fault(
                    x.span(),
                    format!("{key} is given for a motor whose circuit the robot file does not have, expected neither"),
                ),
                None => Ok(()),
            };
        };
        circuit.back_emf = drive.torque_constant;
        let slots = [&mut circuit.resistance, &mut circuit.inductance, &mut circuit.brush_drop];
        for ((key, x), slot) in keys.into_iter().zip(slots) {
            if let Some(x) = x {
                *slot = if key == "resistance_ohm" {
                    self.check.positive(key, x)?
                } else {
                    self.check.not_negative(key, x)?
                };
            }
        }
        Ok(())
    }
}
