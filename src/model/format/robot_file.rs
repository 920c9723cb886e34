//! `robot.toml`: kinematics, limits, drives and shapes of an arm.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

use super::FormatError;
use super::coupling_table::{CouplingTable, read_coupling};
use super::point_tables::{PointTable, read_points};
use super::reading::{Check, Number, Row, STANDARD_GRAVITY, read, roll_pitch_yaw};
use super::shape_parameters::read_shape_parameters;
use super::shape_tables::{
    FloorTable, ObstacleTable, ShapeTable, TouchTable, link_index, read_obstacles, read_shape, read_touch,
};
use crate::input::size::RATE_HZ;
use crate::model::{
    DhConvention, DhRow, Drive, EffortInterface, Joint, JointKind, Limits, MotorCircuit, Robot, RobotSpec, ServoTuning,
};
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
struct BaseTable {
    position_m: Option<Row>,
    roll_pitch_yaw_deg: Option<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ServoTable {
    rate_hz: Number,
    bandwidth_hz: Number,
    damping: Number,
    integral_hz: Number,
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

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitsTable {
    position_deg: Option<Row>,
    position_m: Option<Row>,
    velocity_deg_s: Option<Number>,
    velocity_m_s: Option<Number>,
    acceleration_rad_s2: Option<Number>,
    acceleration_m_s2: Option<Number>,
    jerk_rad_s3: Option<Number>,
    jerk_m_s3: Option<Number>,
    torque_nm: Option<Number>,
    force_n: Option<Number>,
    continuous_torque_nm: Option<Number>,
    continuous_force_n: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DriveTable {
    gear: Option<Number>,
    gear_rad_m: Option<Number>,
    torque_constant_nm_a: Option<Number>,
    current_limit_a: Option<Number>,
    continuous_current_a: Option<Number>,
    counts_per_revolution: Option<Number>,
    counts_per_m: Option<Number>,
    encoder_sign: Option<Number>,
    current_noise_a: Option<Number>,
    adc_range_a: Option<Number>,
    adc_bits: Option<Spanned<u32>>,
    coulomb_velocity_rad_s: Option<Number>,
    coulomb_velocity_m_s: Option<Number>,
    resistance_ohm: Option<Number>,
    inductance_h: Option<Number>,
    back_emf_v_s_rad: Option<Number>,
    brush_drop_v: Option<Number>,
    supply_v: Option<Number>,
    voltage_noise_v: Option<Number>,
    /// Shape parameters of torque laws, by their keys.
    #[serde(default)]
    shape: BTreeMap<Spanned<String>, Number>,
}

/// Reads a `robot.toml`.
///
/// Angles and speeds are in the units that their keys name, and SI inside. A limit that is not given is infinite, a
/// joint without a `drive` has [`Drive::ideal`]. Where the effort interface is `torque`, the torque constant may be
/// left out; it is then 1 / gear, so that the effort passes through the drive unchanged.
///
/// # Errors
/// [`FormatError`] with line and column: an unknown or missing key, a list of the wrong length, a number that is not
/// finite, a gear that is not positive, limits that are reversed, a link that does not exist, a singular coupling.
pub fn parse_robot(text: &str) -> Result<Robot, FormatError> {
    let file: RobotTable = read(text)?;
    let check = Check::new(text);
    let tables = file.joint.get_ref();
    if tables.is_empty() {
        return check.fault(file.joint.span(), "the robot has no joints, expected at least one [[joint]]");
    }
    let mut names: Vec<&str> = Vec::with_capacity(tables.len());
    let mut joints = Vec::with_capacity(tables.len());
    for table in tables {
        let reader = JointReader { check, at: table.span(), table: table.get_ref(), effort: file.effort };
        let name = table.get_ref().name.get_ref().as_str();
        if name == "base" || names.contains(&name) {
            let message = format!("joint name \"{name}\" is taken, expected a name that no other link has");
            return check.fault(table.get_ref().name.span(), message);
        }
        names.push(name);
        joints.push(reader.joint(file.convention)?);
    }
    let shapes = file.shape.iter().map(|shape| read_shape(check, shape, &names)).collect::<Result<_, _>>()?;
    let obstacles = read_obstacles(check, file.floor.as_ref(), &file.obstacle)?;
    let may_touch = file.may_touch.iter().map(|table| read_touch(check, table, &names)).collect::<Result<_, _>>()?;
    let points = read_points(check, &file.point, &|link| link_index(check, link, &names))?;
    let spec = RobotSpec {
        name: file.name,
        gravity: match &file.gravity_m_s2 {
            Some(row) => check.vector("gravity_m_s2", row)?,
            None => Vector3::from(STANDARD_GRAVITY),
        },
        base: read_base(check, file.base.as_ref())?,
        joints,
        coupling: file.coupling.as_ref().map(|table| read_coupling(check, table, tables.len())).transpose()?,
        shapes,
        obstacles,
        may_touch,
    };
    let servo = file.servo.as_ref().map(|table| read_servo(check, table)).transpose()?.unwrap_or_default();
    match Robot::new(spec) {
        Ok(robot) => Ok(robot.with_effort(file.effort).with_servo(servo).with_points(points).read_from(text)),
        Err(fault) => check.fault(file.joint.span(), fault.to_string()),
    }
}

fn read_base(check: Check<'_>, table: Option<&BaseTable>) -> Result<Placement, FormatError> {
    let mut base = Placement::identity();
    if let Some(table) = table {
        if let Some(row) = &table.position_m {
            base.translation = check.vector("position_m", row)?;
        }
        if let Some(row) = &table.roll_pitch_yaw_deg {
            base.rotation = roll_pitch_yaw(check.numbers("roll_pitch_yaw_deg", row)?);
        }
    }
    Ok(base)
}

fn read_servo(check: Check<'_>, table: &ServoTable) -> Result<ServoTuning, FormatError> {
    if let Err(fault) = RATE_HZ.check("rate_hz", *table.rate_hz.get_ref()) {
        return check.fault(table.rate_hz.span(), fault.to_string());
    }
    Ok(ServoTuning {
        rate_hz: check.positive("rate_hz", &table.rate_hz)?,
        bandwidth_hz: check.positive("bandwidth_hz", &table.bandwidth_hz)?,
        damping: check.positive("damping", &table.damping)?,
        integral_hz: check.not_negative("integral_hz", &table.integral_hz)?,
    })
}

/// Reads one `[[joint]]`.
struct JointReader<'a> {
    check: Check<'a>,
    at: Range<usize>,
    table: &'a JointTable,
    effort: EffortInterface,
}

impl JointReader<'_> {
    fn joint(&self, convention: DhConvention) -> Result<Joint, FormatError> {
        let dh = &self.table.dh;
        let row = DhRow {
            offset_deg: self.check.finite("offset_deg", &dh.offset_deg)?,
            d: self.check.finite("d_m", &dh.d_m)?,
            a: self.check.finite("a_m", &dh.a_m)?,
            alpha_deg: self.check.finite("alpha_deg", &dh.alpha_deg)?,
        };
        let (before, after) = row.placements(convention);
        Ok(Joint {
            name: self.table.name.get_ref().clone(),
            kind: self.table.kind,
            before,
            after,
            dh: Some((convention, row)),
            limits: self.limits()?,
            drive: self.drive()?,
        })
    }

    /// The key of a pair that fits the joint's kind; the other one is a fault.
    fn fitting<'b, T>(
        &self,
        revolute: (&'static str, &'b Option<Spanned<T>>),
        prismatic: (&'static str, &'b Option<Spanned<T>>),
    ) -> Result<Option<(&'static str, &'b Spanned<T>)>, FormatError> {
        let ((key, value), (wrong_key, wrong), kind) = match self.table.kind {
            JointKind::Revolute => (revolute, prismatic, "revolute"),
            JointKind::Prismatic => (prismatic, revolute, "prismatic"),
        };
        if let Some(wrong) = wrong {
            let message = format!("{wrong_key} is given for a {kind} joint, expected {key}");
            return self.check.fault(wrong.span(), message);
        }
        Ok(value.as_ref().map(|value| (key, value)))
    }

    fn limits(&self) -> Result<Limits, FormatError> {
        let table = &self.table.limits;
        let revolute = self.table.kind == JointKind::Revolute;
        // A degree limit is converted once, here; an angle of the file is a double of its own all the way.
        let si = |value: f64| if revolute { value.to_radians() } else { value };
        let mut limits = Limits::NONE;
        if let Some((key, row)) =
            self.fitting(("position_deg", &table.position_deg), ("position_m", &table.position_m))?
        {
            let [low, high] = self.check.numbers::<2>(key, row)?;
            if low >= high {
                let message = format!("{key} is [{low}, {high}], expected the lower limit below the upper");
                return self.check.fault(row.span(), message);
            }
            limits.position = (si(low), si(high));
        }
        if let Some((key, x)) =
            self.fitting(("velocity_deg_s", &table.velocity_deg_s), ("velocity_m_s", &table.velocity_m_s))?
        {
            limits.velocity = si(self.check.positive(key, x)?);
        }
        if let Some((key, x)) = self.fitting(
            ("acceleration_rad_s2", &table.acceleration_rad_s2),
            ("acceleration_m_s2", &table.acceleration_m_s2),
        )? {
            limits.acceleration = self.check.positive(key, x)?;
        }
        if let Some((key, x)) = self.fitting(("jerk_rad_s3", &table.jerk_rad_s3), ("jerk_m_s3", &table.jerk_m_s3))? {
            limits.jerk = self.check.positive(key, x)?;
        }
        if let Some((key, x)) = self.fitting(("torque_nm", &table.torque_nm), ("force_n", &table.force_n))? {
            limits.torque = self.check.positive(key, x)?;
        }
        if let Some((key, x)) = self.fitting(
            ("continuous_torque_nm", &table.continuous_torque_nm),
            ("continuous_force_n", &table.continuous_force_n),
        )? {
            limits.continuous_torque = self.check.positive(key, x)?;
        }
        Ok(limits)
    }

    fn drive(&self) -> Result<Drive, FormatError> {
        let Some(table) = &self.table.drive else { return Ok(Drive::ideal()) };
        let check = self.check;
        let mut drive = Drive::ideal();
        let Some((key, gear)) = self.fitting(("gear", &table.gear), ("gear_rad_m", &table.gear_rad_m))? else {
            let name = self.table.name.get_ref();
            return check.fault(self.at.clone(), format!("the drive of joint \"{name}\" has no gear, expected one"));
        };
        drive.gear = check.positive(key, gear)?;
        drive.torque_constant = match (&table.torque_constant_nm_a, self.effort) {
            (Some(x), _) => check.positive("torque_constant_nm_a", x)?,
            (None, EffortInterface::Torque) => 1.0 / drive.gear,
            (None, EffortInterface::Current) => {
                let name = self.table.name.get_ref();
                let message = format!(
                    "the drive of joint \"{name}\" has no torque_constant_nm_a, expected one since effort is a current"
                );
                return check.fault(self.at.clone(), message);
            }
        };
        if let Some(x) = &table.current_limit_a {
            drive.current_limit = check.positive("current_limit_a", x)?;
        }
        if let Some(x) = &table.continuous_current_a {
            drive.continuous_current = check.positive("continuous_current_a", x)?;
        }
        if let Some((key, x)) = self
            .fitting(("counts_per_revolution", &table.counts_per_revolution), ("counts_per_m", &table.counts_per_m))?
        {
            drive.counts_per_revolution = check.positive(key, x)?;
        }
        if let Some(x) = &table.encoder_sign {
            drive.encoder_sign = check.finite("encoder_sign", x)?;
            if ![1.0, -1.0].contains(&drive.encoder_sign) {
                return check.fault(x.span(), format!("encoder_sign is {}, expected 1 or -1", drive.encoder_sign));
            }
        }
        if let Some(x) = &table.current_noise_a {
            drive.current_noise = check.not_negative("current_noise_a", x)?;
        }
        if let Some(x) = &table.adc_range_a {
            drive.adc_range = check.positive("adc_range_a", x)?;
        }
        if let Some(bits) = &table.adc_bits {
            drive.adc_bits = *bits.get_ref();
            if drive.adc_bits > 30 {
                let message = format!("adc_bits is {}, expected 0 (no quantisation) to 30", drive.adc_bits);
                return check.fault(bits.span(), message);
            }
            if drive.adc_bits > 0 && drive.adc_range.is_infinite() {
                return check.fault(bits.span(), "adc_bits is given without adc_range_a, expected both or neither");
            }
        }
        if let Some((key, x)) = self.fitting(
            ("coulomb_velocity_rad_s", &table.coulomb_velocity_rad_s),
            ("coulomb_velocity_m_s", &table.coulomb_velocity_m_s),
        )? {
            drive.coulomb_velocity = check.not_negative(key, x)?;
        }
        drive.shapes = read_shape_parameters(check, &table.shape)?;
        drive.circuit = self.circuit(table, drive.torque_constant)?;
        if let Some(x) = &table.voltage_noise_v {
            drive.voltage_noise = check.not_negative("voltage_noise_v", x)?;
        }
        Ok(drive)
    }

    /// The motor's circuit, where its resistance is given.
    fn circuit(&self, table: &DriveTable, torque_constant: f64) -> Result<Option<MotorCircuit>, FormatError> {
        let check = self.check;
        let others = [
            ("inductance_h", &table.inductance_h),
            ("back_emf_v_s_rad", &table.back_emf_v_s_rad),
            ("brush_drop_v", &table.brush_drop_v),
            ("supply_v", &table.supply_v),
            ("voltage_noise_v", &table.voltage_noise_v),
        ];
        let Some(resistance) = &table.resistance_ohm else {
            return match others.iter().find_map(|(key, x)| x.as_ref().map(|x| (key, x))) {
                Some((key, x)) => {
                    check.fault(x.span(), format!("{key} is given without resistance_ohm, expected both or neither"))
                }
                None => Ok(None),
            };
        };
        let value = |key, x: &Option<Number>, default| x.as_ref().map_or(Ok(default), |x| check.not_negative(key, x));
        Ok(Some(MotorCircuit {
            resistance: check.positive("resistance_ohm", resistance)?,
            inductance: value("inductance_h", &table.inductance_h, 0.0)?,
            back_emf: value("back_emf_v_s_rad", &table.back_emf_v_s_rad, torque_constant)?,
            brush_drop: value("brush_drop_v", &table.brush_drop_v, 0.0)?,
            supply: table.supply_v.as_ref().map_or(Ok(f64::INFINITY), |x| check.positive("supply_v", x))?,
        }))
    }
}
