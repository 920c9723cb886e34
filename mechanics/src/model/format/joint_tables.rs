//! Limits and drive of a joint in `robot.toml`.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Number, Row};
use super::shape_parameters::read_shape_parameters;
use crate::model::drive::Drive;
use crate::model::joint::{JointKind, Limits};
use crate::model::motor_circuit::MotorCircuit;
use crate::model::servo::EffortInterface;

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LimitsTable {
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
pub(super) struct DriveTable {
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

/// The keys of one quantity, for a revolute joint and for a prismatic one, each with what stands there.
type Keys<'a, T> = [(&'static str, &'a Option<Spanned<T>>); 2];

macro_rules! keys {
    ($table:ident, $revolute:ident, $prismatic:ident) => {
        [(stringify!($revolute), &$table.$revolute), (stringify!($prismatic), &$table.$prismatic)]
    };
}

/// Reads limits and drive of one joint.
pub(super) struct JointTables<'a> {
    pub(super) check: Check<'a>,
    /// Where the joint's table stands.
    pub(super) at: Range<usize>,
    pub(super) name: &'a str,
    pub(super) kind: JointKind,
    pub(super) effort: EffortInterface,
    /// A drive without gear and constants may be stated: the robot is placed by a URDF, which says nothing of drives.
    pub(super) gear_may_lack: bool,
}

impl JointTables<'_> {
    /// The key of a pair that fits the joint's kind; the other one is a fault.
    fn fitting<'b, T>(
        &self,
        [revolute, prismatic]: Keys<'b, T>,
    ) -> Result<Option<(&'static str, &'b Spanned<T>)>, FormatError> {
        let ((key, value), (wrong_key, wrong), kind) = match self.kind {
            JointKind::Revolute => (revolute, prismatic, "revolute"),
            JointKind::Prismatic => (prismatic, revolute, "prismatic"),
        };
        if let Some(wrong) = wrong {
            let message = format!("{wrong_key} is given for a {kind} joint, expected {key}");
            return self.check.fault(wrong.span(), message);
        }
        Ok(value.as_ref().map(|value| (key, value)))
    }

    /// The number above zero of the key that fits; `otherwise` where it is not stated.
    fn positive(&self, keys: Keys<'_, f64>, otherwise: f64) -> Result<f64, FormatError> {
        let stated = self.fitting(keys)?;
        stated.map_or(Ok(otherwise), |(key, number)| self.check.positive(key, number))
    }

    /// Limits as the file states them; what it does not state is as `otherwise` has it.
    pub(super) fn limits(&self, table: &LimitsTable, otherwise: Limits) -> Result<Limits, FormatError> {
        let revolute = self.kind == JointKind::Revolute;
        // A degree limit is converted once, here; an angle of the file is a double of its own all the way.
        let si = |value: f64| if revolute { value.to_radians() } else { value };
        let mut limits = otherwise;
        if let Some((key, row)) = self.fitting(keys!(table, position_deg, position_m))? {
            let [low, high] = self.check.numbers::<2>(key, row)?;
            if low >= high {
                let message = format!("{key} is [{low}, {high}], expected the lower limit below the upper");
                return self.check.fault(row.span(), message);
            }
            limits.position = (si(low), si(high));
        }
        if let Some((key, x)) = self.fitting(keys!(table, velocity_deg_s, velocity_m_s))? {
            limits.velocity = si(self.check.positive(key, x)?);
        }
        limits.acceleration =
            self.positive(keys!(table, acceleration_rad_s2, acceleration_m_s2), limits.acceleration)?;
        limits.jerk = self.positive(keys!(table, jerk_rad_s3, jerk_m_s3), limits.jerk)?;
        limits.torque = self.positive(keys!(table, torque_nm, force_n), limits.torque)?;
        limits.continuous_torque =
            self.positive(keys!(table, continuous_torque_nm, continuous_force_n), limits.continuous_torque)?;
        Ok(limits)
    }

    /// The drive.
    pub(super) fn drive(&self, table: &DriveTable) -> Result<Drive, FormatError> {
        let check = self.check;
        let lacks = |key: &str, why: &str| {
            let message = format!("the drive of joint \"{}\" has no {key}, expected one{why}", self.name);
            check.fault(self.at.clone(), message)
        };
        let mut drive = Drive::ideal();
        let gear = self.fitting(keys!(table, gear, gear_rad_m))?;
        let is_motor = table.torque_constant_nm_a.is_some() || table.resistance_ohm.is_some();
        match gear {
            Some((key, gear)) => drive.gear = check.positive(key, gear)?,
            None if self.gear_may_lack && !is_motor && self.effort == EffortInterface::Torque => {}
            None => return lacks("gear", ""),
        }
        drive.torque_constant = match (&table.torque_constant_nm_a, self.effort) {
            (Some(x), _) => check.positive("torque_constant_nm_a", x)?,
            (None, EffortInterface::Torque) => 1.0 / drive.gear,
            (None, EffortInterface::Current) => return lacks("torque_constant_nm_a", " since effort is a current"),
        };
        drive.current_limit = check.positive_or("current_limit_a", &table.current_limit_a, f64::INFINITY)?;
        drive.continuous_current =
            check.positive_or("continuous_current_a", &table.continuous_current_a, f64::INFINITY)?;
        drive.counts_per_revolution = self.positive(keys!(table, counts_per_revolution, counts_per_m), 0.0)?;
        if let Some(x) = &table.encoder_sign {
            drive.encoder_sign = check.finite("encoder_sign", x)?;
            if ![1.0, -1.0].contains(&drive.encoder_sign) {
                return check.fault(x.span(), format!("encoder_sign is {}, expected 1 or -1", drive.encoder_sign));
            }
        }
        drive.current_noise = check.not_negative_or("current_noise_a", &table.current_noise_a, 0.0)?;
        drive.adc_range = check.positive_or("adc_range_a", &table.adc_range_a, f64::INFINITY)?;
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
        if let Some((key, x)) = self.fitting(keys!(table, coulomb_velocity_rad_s, coulomb_velocity_m_s))? {
            drive.coulomb_velocity = check.not_negative(key, x)?;
        }
        drive.shapes = read_shape_parameters(check, &table.shape)?;
        drive.circuit = self.circuit(table, drive.torque_constant)?;
        drive.voltage_noise = check.not_negative_or("voltage_noise_v", &table.voltage_noise_v, 0.0)?;
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
        Ok(Some(MotorCircuit {
            resistance: check.positive("resistance_ohm", resistance)?,
            inductance: check.not_negative_or("inductance_h", &table.inductance_h, 0.0)?,
            back_emf: check.not_negative_or("back_emf_v_s_rad", &table.back_emf_v_s_rad, torque_constant)?,
            brush_drop: check.not_negative_or("brush_drop_v", &table.brush_drop_v, 0.0)?,
            supply: check.positive_or("supply_v", &table.supply_v, f64::INFINITY)?,
        }))
    }
}
