//! `robot.toml` with a Denavit–Hartenberg table: kinematics, limits, drives and shapes of an arm.

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

use super::base_table::{BaseTable, read_base};
use super::coupling_table::{CouplingTable, read_coupling};
use super::error::FormatError;
use super::joint_tables::{DriveTable, JointTables, LimitsTable};
use super::point_tables::{PointTable, read_points};
use super::reading::{Check, Number, Row, STANDARD_GRAVITY, read};
use super::servo_table::{ServoTable, read_servo};
use super::shape_tables::{
    FloorTable, ObstacleTable, ShapeTable, TouchTable, link_index, read_obstacles, read_shape, read_touch,
};
use super::uncertainty_table::{UncertaintyTable, read_uncertainty};
use crate::model::drive::Drive;
use crate::model::drive_kind::DriveKind;
use crate::model::joint::{DhConvention, DhRow, Joint, JointKind, Limits};
use crate::model::robot::{Robot, RobotSpec};
use crate::model::servo::EffortInterface;
use crate::provenance::sha256;
use crate::spatial::Placement;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    name: String,
    convention: DhConvention,
    gravity_m_s2: Option<Row>,
    #[serde(default)]
    effort: EffortInterface,
    base: Option<BaseTable>,
    servo: Option<ServoTable>,
    drives: Option<DriveKind>,
    #[serde(default)]
    uncertainty: UncertaintyTable,
    joint: Spanned<Vec<Spanned<JointTable>>>,
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointTable {
    name: Spanned<String>,
    kind: JointKind,
    dh: DhTable,
    #[serde(default)]
    limits: LimitsTable,
    drive: Option<DriveTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DhTable {
    offset_deg: Number,
    d_m: Number,
    a_m: Number,
    alpha_deg: Number,
}

/// Reads it.
pub(super) fn read_dh_robot(text: &str) -> Result<Robot, FormatError> {
    let file: RobotTable = read(text)?;
    let check = Check::new(text);
    let tables = file.joint.get_ref();
    if tables.is_empty() {
        return check.fault(file.joint.span(), "the robot has no joints, expected at least one [[joint]]");
    }
    let mut names: Vec<&str> = Vec::with_capacity(tables.len());
    let mut joints = Vec::with_capacity(tables.len());
    for table in tables {
        let name = table.get_ref().name.get_ref().as_str();
        if name == "base" || names.contains(&name) {
            let message = format!("joint name \"{name}\" is taken, expected a name that no other link has");
            return check.fault(table.get_ref().name.span(), message);
        }
        names.push(name);
        joints.push(read_joint(check, table, file.convention, file.effort)?);
    }
    let shapes = file.shape.iter().map(|shape| read_shape(check, shape, &names)).collect::<Result<_, _>>()?;
    let obstacles = read_obstacles(check, file.floor.as_ref(), &file.obstacle)?;
    let may_touch = file.may_touch.iter().map(|table| read_touch(check, table, &names)).collect::<Result<_, _>>()?;
    let points = read_points(check, &file.point, &|link| link_index(check, link, &names))?;
    let gravity = file.gravity_m_s2.as_ref();
    let spec = RobotSpec {
        name: file.name,
        gravity: gravity.map_or(Ok(Vector3::from(STANDARD_GRAVITY)), |row| check.vector("gravity_m_s2", row))?,
        base: file.base.as_ref().map_or(Ok(Placement::identity()), |table| read_base(check, table))?,
        joints,
        coupling: file.coupling.as_ref().map(|table| read_coupling(check, table, tables.len())).transpose()?,
        shapes,
        obstacles,
        may_touch,
        points,
        effort: file.effort,
        servo: file.servo.as_ref().map(|table| read_servo(check, table)).transpose()?,
        uncertainty: read_uncertainty(check, &file.uncertainty)?,
        drives: file.drives,
        source_sha256: sha256(text),
    };
    Robot::new(spec).or_else(|fault| check.fault(file.joint.span(), fault.to_string()))
}

fn read_joint(
    check: Check<'_>,
    table: &Spanned<JointTable>,
    convention: DhConvention,
    effort: EffortInterface,
) -> Result<Joint, FormatError> {
    let (at, table) = (table.span(), table.get_ref());
    let (name, kind) = (table.name.get_ref().as_str(), table.kind);
    let tables = JointTables { check, at, name, kind, effort, gear_may_lack: false };
    let dh = &table.dh;
    let row = DhRow {
        offset_deg: check.finite("offset_deg", &dh.offset_deg)?,
        d: check.finite("d_m", &dh.d_m)?,
        a: check.finite("a_m", &dh.a_m)?,
        alpha_deg: check.finite("alpha_deg", &dh.alpha_deg)?,
    };
    let limits = tables.limits(&table.limits, Limits::NONE)?;
    let drive = table.drive.as_ref().map_or(Ok(Drive::ideal()), |drive| tables.drive(drive))?;
    Ok(Joint::from_dh(name.to_owned(), kind, (convention, row), limits, drive))
}
