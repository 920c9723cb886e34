//! `truth.toml`, `nominal.toml` and exports: the dynamic parameters of an arm.

use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::FormatError;
use super::reading::{Check, Number, Row, read};
use super::robot_file::quoted;
use crate::model::{Drive, DriveParameters, JointKind, Robot, StandardParameters};
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
    /// What the motors really are: the robot's drives, with what this file says of their circuits; n. The back-EMF
    /// constant is the torque constant.
    pub motors: Vec<Drive>,
    /// Where they come from.
    pub notes: Vec<Note>,
}

/// How far the truth may be from a guess: one standard deviation per group of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, serde::Serialize)]
pub struct RelativeUncertainty {
    /// Of the mass.
    pub mass: f64,
    /// Of the first moment, as a share of its length.
    pub first_moment: f64,
    /// Of the rotational inertia, as a share of its trace.
    pub inertia: f64,
    /// Of the rotor inertia.
    pub rotor: f64,
    /// Of viscous friction.
    pub viscous: f64,
    /// Of Coulomb friction.
    pub coulomb: f64,
    /// Of the offset, which is guessed as zero: absolute, N·m (N for a prismatic joint).
    pub offset_nm: f64,
}

/// What an experimenter knows before measuring.
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
    /// What a simulated arm does beside its parameters: for whoever simulates, read there.
    #[serde(rename = "effects")]
    _effects: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NominalTable {
    relative_uncertainty: UncertaintyTable,
    link: Spanned<Vec<Spanned<LinkTable>>>,
    drive: Option<Spanned<Vec<Spanned<DriveTable>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncertaintyTable {
    mass: Number,
    first_moment: Number,
    inertia: Number,
    rotor: Number,
    viscous: Number,
    coulomb: Number,
    offset_nm: Number,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DriveTable {
    joint: Spanned<String>,
    source: Option<String>,
    rotor_kg_m2: Option<Number>,
    viscous_nm_s_rad: Option<Number>,
    coulomb_nm: Option<Number>,
    offset_nm: Option<Number>,
    motor_viscous_nm_s_rad: Option<Number>,
    motor_coulomb_nm: Option<Number>,
    rotor_kg: Option<Number>,
    viscous_n_s_m: Option<Number>,
    coulomb_n: Option<Number>,
    offset_n: Option<Number>,
    motor_viscous_n_s_m: Option<Number>,
    motor_coulomb_n: Option<Number>,
    torque_constant_nm_a: Option<Number>,
    resistance_ohm: Option<Number>,
    inductance_h: Option<Number>,
    brush_drop_v: Option<Number>,
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
    let table = &file.relative_uncertainty;
    let relative_uncertainty = RelativeUncertainty {
        mass: check.not_negative("mass", &table.mass)?,
        first_moment: check.not_negative("first_moment", &table.first_moment)?,
        inertia: check.not_negative("inertia", &table.inertia)?,
        rotor: check.not_negative("rotor", &table.rotor)?,
        viscous: check.not_negative("viscous", &table.viscous)?,
        coulomb: check.not_negative("coulomb", &table.coulomb)?,
        offset_nm: check.not_negative("offset_nm", &table.offset_nm)?,
    };
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
        let mut notes = Vec::new();
        let mut seen = vec![false; self.robot.dof()];
        for table in links.get_ref() {
            let index = self.index("link", &table.get_ref().name, &mut seen)?;
            parameters.links[index] = self.link(table.get_ref())?;
            if let Some(source) = &table.get_ref().source {
                let subject = format!("link {}", table.get_ref().name.get_ref());
                notes.push(Note { subject, source: source.clone() });
            }
        }
        if let Some(missing) = seen.iter().position(|seen| !seen) {
            let name = &self.robot.joints()[missing].name;
            let message = format!("link \"{name}\" is missing, expected one [[link]] for each link of the robot");
            let at = links.get_ref().last().map_or_else(|| links.span(), Spanned::span);
            return self.check.fault(at, message);
        }
        let mut seen = vec![false; self.robot.dof()];
        for table in drives.map(|drives| drives.get_ref().as_slice()).unwrap_or_default() {
            let index = self.index("joint", &table.get_ref().joint, &mut seen)?;
            parameters.drives[index] = self.drive(index, table.get_ref())?;
            self.motor(table.get_ref(), &mut motors[index])?;
            if let Some(source) = &table.get_ref().source {
                let subject = format!("drive {}", table.get_ref().joint.get_ref());
                notes.push(Note { subject, source: source.clone() });
            }
        }
        Ok(ParameterFile { parameters, motors, notes })
    }

    fn index(&self, what: &str, name: &Spanned<String>, seen: &mut [bool]) -> Result<usize, FormatError> {
        let Some(index) = self.robot.joint_index(name.get_ref()) else {
            let names: Vec<&str> = self.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
            let message = format!("{what} \"{}\" is not there, expected one of {}", name.get_ref(), quoted(&names));
            return self.check.fault(name.span(), message);
        };
        if std::mem::replace(&mut seen[index], true) {
            let message = format!("{what} \"{}\" is there twice, expected it once", name.get_ref());
            return self.check.fault(name.span(), message);
        }
        Ok(index)
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
            let message = format!("link \"{name}\" cannot be a real body: {fault}");
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
        if let Some(x) = &table.torque_constant_nm_a {
            drive.torque_constant = self.check.positive("torque_constant_nm_a", x)?;
        }
        let keys = [
            ("resistance_ohm", &table.resistance_ohm),
            ("inductance_h", &table.inductance_h),
            ("brush_drop_v", &table.brush_drop_v),
        ];
        let Some(circuit) = &mut drive.circuit else {
            return match keys.iter().find_map(|(key, x)| x.as_ref().map(|x| (key, x))) {
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

    fn drive(&self, index: usize, table: &DriveTable) -> Result<DriveParameters, FormatError> {
        let coupled = self.robot.is_coupled(index);
        for (key, number) in [
            ("motor_viscous_nm_s_rad", &table.motor_viscous_nm_s_rad),
            ("motor_coulomb_nm", &table.motor_coulomb_nm),
            ("motor_viscous_n_s_m", &table.motor_viscous_n_s_m),
            ("motor_coulomb_n", &table.motor_coulomb_n),
        ] {
            if let (Some(number), false) = (number, coupled) {
                let message = format!("{key} is given, expected it only where the robot's coupling drives more joints");
                return self.check.fault(number.span(), message);
            }
        }
        let kind = self.robot.joints()[index].kind;
        let value = |revolute: (&str, &Option<Number>), prismatic: (&str, &Option<Number>), signed: bool| {
            let ((key, number), (wrong_key, wrong)) = match kind {
                JointKind::Revolute => (revolute, prismatic),
                JointKind::Prismatic => (prismatic, revolute),
            };
            if let Some(wrong) = wrong {
                let unit = kind.unit();
                let message = format!("{wrong_key} is given for a joint measured in {unit}, expected {key}");
                return self.check.fault(wrong.span(), message);
            }
            match number {
                Some(number) if signed || !self.require_consistent => self.check.finite(key, number),
                Some(number) => self.check.not_negative(key, number),
                None => Ok(0.0),
            }
        };
        Ok(DriveParameters {
            rotor: value(("rotor_kg_m2", &table.rotor_kg_m2), ("rotor_kg", &table.rotor_kg), false)?,
            viscous: value(
                ("viscous_nm_s_rad", &table.viscous_nm_s_rad),
                ("viscous_n_s_m", &table.viscous_n_s_m),
                false,
            )?,
            coulomb: value(("coulomb_nm", &table.coulomb_nm), ("coulomb_n", &table.coulomb_n), false)?,
            offset: value(("offset_nm", &table.offset_nm), ("offset_n", &table.offset_n), true)?,
            motor_viscous: value(
                ("motor_viscous_nm_s_rad", &table.motor_viscous_nm_s_rad),
                ("motor_viscous_n_s_m", &table.motor_viscous_n_s_m),
                false,
            )?,
            motor_coulomb: value(
                ("motor_coulomb_nm", &table.motor_coulomb_nm),
                ("motor_coulomb_n", &table.motor_coulomb_n),
                false,
            )?,
        })
    }
}
