//! `robot.toml` over a URDF: what that file has no place for.
//!
//! ```text
//! urdf = "arm.urdf"
//! effort = "current"
//!
//! [[joint]]                  # any of the chain, by name
//! name = "shoulder"
//! [joint.limits]             # beside those of the URDF, or in their place
//! acceleration_rad_s2 = 5
//! [joint.drive]
//! gear = 100
//! torque_constant_nm_a = 0.1
//! [joint.terms]              # nominal coefficients, keys as in nominal.toml
//! rotor_kg_m2 = 0.4
//! ```

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::base_table::{BaseTable, read_base};
use super::coupling_table::{CouplingTable, read_coupling};
use super::embedded_urdf::{EmbeddedTable, named_urdf};
use super::error::FormatError;
use super::joint_tables::{DriveTable, JointTables, LimitsTable};
use super::point_tables::{PointTable, read_points};
use super::reading::{Check, Number, Row, read};
use super::robot_model::RobotModel;
use super::servo_table::{ServoTable, read_servo};
use super::shape_tables::{
    FloorTable, ObstacleTable, ShapeTable, TouchTable, link_index, read_obstacles, read_shape, read_touch,
};
use super::term_keys::{read_terms, term_keys};
use super::tree::ImportedModel;
use super::uncertainty_table::{UncertaintyTable, read_uncertainty};
use super::urdf::parse_urdf;
use crate::model::drive_kind::DriveKind;
use crate::model::joint::Joint;
use crate::model::robot::{Robot, RobotSpec};
use crate::model::servo::EffortInterface;
use crate::provenance::sha256;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    name: Option<String>,
    urdf: Spanned<String>,
    #[serde(rename = "base_link")]
    _base_link: Option<String>,
    #[serde(rename = "tip_link")]
    _tip_link: Option<String>,
    gravity_m_s2: Option<Row>,
    effort: Option<EffortInterface>,
    base: Option<BaseTable>,
    servo: Option<ServoTable>,
    drives: Option<DriveKind>,
    #[serde(default)]
    uncertainty: UncertaintyTable,
    #[serde(default)]
    joint: Vec<Spanned<JointTable>>,
    coupling: Option<CouplingTable>,
    #[serde(default)]
    shape: Vec<ShapeTable>,
    floor: Option<FloorTable>,
    #[serde(default)]
    obstacle: Vec<ObstacleTable>,
    #[serde(default)]
    may_touch: Vec<TouchTable>,
    #[serde(default)]
    point: Vec<PointTable>,
    embedded: Option<EmbeddedTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointTable {
    name: Spanned<String>,
    #[serde(default)]
    limits: LimitsTable,
    drive: Option<DriveTable>,
    #[serde(default)]
    terms: BTreeMap<Spanned<String>, Number>,
}

/// Reads it, with the URDF that it holds.
pub(super) fn read_urdf_robot(text: &str) -> Result<RobotModel, FormatError> {
    let file: RobotTable = read(text)?;
    let check = Check::new(text);
    let at = file.urdf.span();
    let Some(EmbeddedTable { urdf }) = &file.embedded else {
        let message = format!(
            "the URDF \"{}\" is not with this text, expected it in [embedded] or beside the robot file",
            file.urdf.get_ref()
        );
        return check.fault(at, message);
    };
    let ends = named_urdf(text)?.map(|reference| reference.ends).unwrap_or_default();
    let imported = parse_urdf(urdf, &ends).or_else(|fault| {
        let place = format!("line {}, column {}", fault.line, fault.column);
        check.fault(at.clone(), format!("{}, {place}: {}", file.urdf.get_ref(), fault.message))
    })?;
    let ImportedModel { robot, mut parameters, locked, collisions, snapped: _, remarks } = imported;
    let effort = file.effort.unwrap_or_else(|| robot.effort());
    let mut spec = RobotSpec::from(robot);
    let names: Vec<String> = spec.joints.iter().map(|joint| joint.name.clone()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut stated: Vec<Option<&Spanned<JointTable>>> = vec![None; names.len()];
    let mut seen = vec![false; names.len()];
    for table in &file.joint {
        stated[check.place("joint", &table.get_ref().name, &names, &mut seen)?] = Some(table);
    }
    for (joint, table) in spec.joints.iter_mut().zip(&stated) {
        match table {
            Some(table) => add(check, table, effort, joint)?,
            None if effort == EffortInterface::Torque => {}
            None => return lacks_drive(check, at, &joint.name),
        }
    }
    if let Some(name) = file.name {
        spec.name = name;
    }
    if let Some(row) = &file.gravity_m_s2 {
        spec.gravity = check.vector("gravity_m_s2", row)?;
    }
    if let Some(table) = &file.base {
        spec.base = read_base(check, table)?;
    }
    if let Some(table) = &file.coupling {
        spec.coupling = Some(read_coupling(check, table, names.len())?);
    }
    for shape in &file.shape {
        spec.shapes.push(read_shape(check, shape, &names)?);
    }
    spec.obstacles.extend(read_obstacles(check, file.floor.as_ref(), &file.obstacle)?);
    for table in &file.may_touch {
        spec.may_touch.push(read_touch(check, table, &names)?);
    }
    spec.points = read_points(check, &file.point, &|link| link_index(check, link, &names))?;
    spec.effort = effort;
    spec.servo = file.servo.as_ref().map(|table| read_servo(check, table)).transpose()?;
    spec.uncertainty = read_uncertainty(check, &file.uncertainty)?;
    spec.drives = file.drives;
    spec.source_sha256 = sha256(text);
    let robot = Robot::new(spec).or_else(|fault| check.fault(at, fault.to_string()))?;
    for (index, table) in stated.iter().enumerate().filter_map(|(index, table)| Some((index, (*table)?))) {
        let terms = &table.get_ref().terms;
        if let Some(key) = terms.keys().find(|key| !term_keys().any(|known| known == key.get_ref())) {
            let known: Vec<String> = term_keys().map(|known| format!("`{known}`")).collect();
            let message = format!("unknown field `{}`, expected one of {}", key.get_ref(), known.join(", "));
            return check.fault(key.span(), message);
        }
        let numbers = terms.iter().map(|(key, number)| (key.get_ref().as_str(), number));
        read_terms(check, &robot, index, numbers, true, &mut parameters.drives[index])?;
    }
    Ok(RobotModel { robot, parameters: Some(parameters), locked, collisions, remarks })
}

/// Puts what the file says of a joint into it.
fn add(
    check: Check<'_>,
    table: &Spanned<JointTable>,
    effort: EffortInterface,
    joint: &mut Joint,
) -> Result<(), FormatError> {
    let (at, table) = (table.span(), table.get_ref());
    let tables = JointTables { check, at, name: &joint.name, kind: joint.kind, effort, gear_may_lack: true };
    joint.limits = tables.limits(&table.limits, joint.limits)?;
    joint.drive = match &table.drive {
        Some(drive) => tables.drive(drive)?,
        None if effort == EffortInterface::Torque => return Ok(()),
        None => return lacks_drive(check, table.name.span(), &joint.name),
    };
    Ok(())
}

fn lacks_drive<T>(check: Check<'_>, at: std::ops::Range<usize>, joint: &str) -> Result<T, FormatError> {
    let message = format!(
        "joint \"{joint}\" has no [joint.drive], expected one with gear and torque_constant_nm_a since effort is a current"
    );
    check.fault(at, message)
}
