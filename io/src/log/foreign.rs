//! Joint states that something else recorded.

use std::collections::BTreeSet;

use armid::model::EffortInterface;
use armid::remedy::{Remedy, Setting};
use armid_cdr::JointState;

use super::conversion::Conversion;
use super::foreign_csv::NONE;
use super::joint_log::Log;
use super::joint_names::names_in_log;
use super::mapping::{ColumnMap, Mapping, Quantity, listed};
use super::origin::{Origin, ReadAs};
use super::raw_log::RawLog;
use super::state_rows::StateRows;
use super::topics::{Message, StateReading};
use crate::error::Error;

/// Joints of one quantity, and how their values become those of the robot's.
struct Column {
    map: ColumnMap,
    joints: Vec<String>,
}

/// What is read from joint states.
struct Plan {
    q: Column,
    /// Velocities: in any case, or where every message has them.
    qd: Option<(Column, bool)>,
    effort: Column,
    /// Positions behind the transmissions, as joints of their own.
    link: Option<Column>,
    /// What the robot calls the joints; `None` where the mapping puts them in order.
    joints: Option<Vec<String>>,
    remarks: Vec<String>,
}

/// A log whose times are the stamps of its messages.
pub(super) fn log(name: &str, messages: &[Message], reading: &StateReading<'_>) -> Result<Log, Error> {
    let plan = Plan::of(name, messages, reading)?;
    let dof = plan.q.joints.len();
    let columns = || {
        let more = plan.qd.as_ref().map(|(column, _)| column).into_iter().chain(&plan.link);
        [&plan.q, &plan.effort].into_iter().chain(more)
    };
    let needed: BTreeSet<&String> =
        columns().flat_map(|column| &column.joints).filter(|joint| *joint != NONE).collect();
    let rows = StateRows::of(name, messages, needed.into_iter().cloned().collect())?;
    let qd = match &plan.qd {
        Some((column, needed)) => match rows.velocities(&column.joints) {
            None if *needed => {
                let message =
                    format!("{name}: a message has no velocity of a joint, expected one for each joint of qd");
                return Err(Error::new(message).help("leave out qd: velocities are made from the positions"));
            }
            found => found.map(|values| column.scaled(values)).transpose()?,
        },
        None => None,
    };
    let (conversion, effort_unit) =
        Conversion::of_maps(&plan.q.map, plan.qd.as_ref().map(|(column, _)| &column.map), &plan.effort.map, dof)?;
    let is_mapped = plan.joints.is_none();
    let first = rows.times_ns.first().copied().unwrap_or(0);
    let said = |column: &Column| {
        let unit = column.map.unit.unwrap_or(column.map.quantity.units()[0]).name();
        let side = if column.map.motor { " at the motors" } else { "" };
        format!("{} from {} in {unit}{side}", column.map.quantity.key(), column.joints.join(" "))
    };
    // Velocities that nobody asked for are not part of a correction.
    let stated = || columns().filter(|column| is_mapped || column.map.quantity != Quantity::Velocity);
    let read_as = (is_mapped || reading.robot.is_some()).then(|| ReadAs {
        mapping: Mapping {
            columns: stated().map(Column::listed).collect(),
            topic: reading.mapping.and_then(|mapping| mapping.topic.clone()),
        },
        columns: columns().map(|column| (column.map.quantity, column.joints.clone())).collect(),
    });
    let efforts = rows.values(&plan.effort.joints, |state: &JointState| &state.effort)?;
    let without_effort: Vec<usize> = (0..dof).filter(|&joint| plan.effort.joints[joint] == NONE).collect();
    let raw = RawLog {
        name: name.to_owned(),
        dof,
        t: rows.times_ns.iter().map(|&time| (i128::from(time) - i128::from(first)) as f64 * 1e-9).collect(),
        rate_hz: None,
        q: plan.q.scaled(rows.values(&plan.q.joints, |state: &JointState| &state.position)?)?,
        qd,
        link_q: match &plan.link {
            Some(link) => Some(link.scaled(rows.values(&link.joints, |state: &JointState| &state.position)?)?),
            None => None,
        },
        effort: plan.effort.scaled(with_zeros(efforts, dof, &without_effort))?,
        without_effort,
        effort_unit: is_mapped.then_some(effort_unit),
        servo: None,
        conversion,
        origin: Origin {
            columns: if is_mapped { columns().map(said).collect() } else { Vec::new() },
            remarks: plan.remarks.iter().chain(&rows.remarks).cloned().collect(),
            read_as,
            ..Origin::default()
        },
        joints: plan.joints,
    };
    raw.even(|row, message| Error::new(format!("{name}: message {}: {message}", row + 1)))
}

/// Rows of efforts with zeros where a joint has none.
fn with_zeros(mut rows: Vec<f64>, dof: usize, without: &[usize]) -> Vec<f64> {
    for &joint in without {
        rows.iter_mut().skip(joint).step_by(dof).for_each(|effort| *effort = 0.0);
    }
    rows
}

impl Plan {
    fn of(name: &str, messages: &[Message], reading: &StateReading<'_>) -> Result<Self, Error> {
        let Some(first) = messages.first() else { return Err(Error::new(format!("{name} holds no joint states"))) };
        let found: BTreeSet<&str> =
            messages.iter().flat_map(|message| message.state.name.iter()).map(String::as_str).collect();
        if let Some(mapping) = reading.mapping.filter(|mapping| !mapping.columns.is_empty()) {
            return Self::of_mapping(name, mapping, &found);
        }
        let (in_log, prefix) = match reading.robot {
            Some(robot) => names_in_log(name, robot, &found)?,
            None => (first.state.name.to_vec(), None),
        };
        let joints = match reading.robot {
            Some(robot) => robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            None => in_log.clone(),
        };
        let effort = match reading.robot.map(|robot| robot.effort()) {
            Some(EffortInterface::Current) => Quantity::Current,
            Some(EffortInterface::Torque) | None => Quantity::Torque,
        };
        let of = |quantity| Column { map: ColumnMap::new(quantity, ""), joints: in_log.clone() };
        Ok(Self {
            q: of(Quantity::Position),
            link: None,
            qd: Some((of(Quantity::Velocity), false)),
            effort: of(effort),
            joints: Some(joints),
            remarks: prefix.iter().map(|prefix| format!("the joints are those with the prefix \"{prefix}\"")).collect(),
        })
    }

    /// The joints that a mapping names.
    fn of_mapping(name: &str, mapping: &Mapping, found: &BTreeSet<&str>) -> Result<Self, Error> {
        let of = |quantity: Quantity| -> Result<Option<Column>, Error> {
            let Some(map) = mapping.columns(quantity) else { return Ok(None) };
            let key = quantity.key();
            let help = || {
                let map = "q=joint[1-6] deg, tau=joint[1-6] motor gear=100";
                Remedy::from("joints named as in the robot need no map; another map of joint states names joints: ")
                    .assign(Setting::Map, map)
            };
            let is_effort = quantity.is_effort();
            let is_known = |joint: &str| found.contains(joint) || (is_effort && joint == NONE);
            let joints = listed(&map.columns, is_known).map_err(|fault| Error::new(format!("{key}: {fault}")))?;
            if let Some(file) = &map.file {
                let message =
                    format!("{key}: {name} holds joint states, found the file \"{file}\" in front of a joint");
                return Err(Error::mismatch(message).help(help()));
            }
            if let Some(missing) = joints.iter().find(|joint| !is_known(joint)) {
                let list = found.iter().copied().collect::<Vec<_>>().join(", ");
                let message = format!("{key}: {name} holds no joint \"{missing}\", found {list}");
                return Err(Error::mismatch(message).help(help()));
            }
            Ok(Some(Column { map: map.clone(), joints }))
        };
        if mapping.columns(Quantity::Time).is_some() {
            let message =
                format!("t: the times of {name} are the stamps of its messages, expected none in the mapping");
            return Err(Error::mismatch(message).help("leave out t; joints named as in the robot need no map at all"));
        }
        if mapping.columns(Quantity::Command).is_some() {
            let message = format!("q_cmd: {name} holds joint states, which have no commands, expected tau or current");
            let help = "write positions and commands into one table, whose map may have q_cmd";
            return Err(Error::mismatch(message).help(help));
        }
        let needed = |column: Option<Column>, key: &str| {
            column.ok_or_else(|| Error::new(format!("{name}: {key} is missing in the mapping")))
        };
        let q = needed(of(Quantity::Position)?, "q")?;
        let effort = match of(Quantity::Torque)? {
            Some(torque) => torque,
            None => needed(of(Quantity::Current)?, "tau or current")?,
        };
        let (qd, link) = (of(Quantity::Velocity)?, of(Quantity::LinkPosition)?);
        for column in [&effort].into_iter().chain(&qd).chain(&link) {
            let (key, count, dof) = (column.map.quantity.key(), column.joints.len(), q.joints.len());
            if count != dof {
                return Err(Error::new(format!("{key} names {count} joints, expected {dof}, as many as q")));
            }
        }
        Ok(Self { q, qd: qd.map(|column| (column, true)), effort, link, joints: None, remarks: Vec::new() })
    }
}

impl Column {
    /// Values with sign, unit and what else the mapping states.
    fn scaled(&self, mut values: Vec<f64>) -> Result<Vec<f64>, Error> {
        let unit = self.map.unit.unwrap_or(self.map.quantity.units()[0]);
        let factors = self.map.factors(unit, self.joints.len())?;
        for row in values.chunks_exact_mut(factors.len().max(1)) {
            for (value, factor) in row.iter_mut().zip(&factors) {
                *value *= factor;
            }
        }
        Ok(values)
    }

    /// The map with every joint written out.
    fn listed(&self) -> ColumnMap {
        ColumnMap { columns: self.joints.join("/"), ..self.map.clone() }
    }
}

#[cfg(test)]
mod tests {
    use armid_cdr::{JointState, Time};

    use super::{Mapping, Message, StateReading, log};

    #[test]
    fn the_torque_of_a_joint_may_be_left_out_of_joint_states() {
        let messages = [0, 1, 2].map(|k| Message {
            recorded_ns: k,
            state: JointState {
                stamp: Time::from_ns(k * 1_000_000).unwrap(),
                name: ["a".to_owned(), "b".to_owned()].into(),
                position: vec![k as f64, 0.5],
                effort: vec![7.0, f64::NAN],
                ..JointState::default()
            },
        });
        let mapping = Mapping::parse("q=a/b, tau=a/-").unwrap();
        let read = log("bag", &messages, &StateReading { mapping: Some(&mapping), robot: None }).unwrap();
        assert_eq!((read.dof, read.q, read.effort), (2, vec![0.0, 0.5, 1.0, 0.5, 2.0, 0.5], [7.0, 0.0].repeat(3)));
        assert_eq!(read.excluded, [false, true].repeat(3));
        let mapping = Mapping::parse("q=a/-, tau=a/b").unwrap();
        let fault = log("bag", &messages, &StateReading { mapping: Some(&mapping), robot: None }).unwrap_err();
        assert_eq!(fault.to_string(), "q: bag holds no joint \"-\", found a, b");
    }
}
