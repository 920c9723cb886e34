//! What is changed where nearly right angles of a URDF are read as right ones, and what that does to the torque.

use armid::dynamics::TorqueDifference;
use armid::model::format::{SnappedJoint, edit_urdf, parse_urdf, parse_urdf_as_written};
use armid::model::{JointKind, StandardParameters};
use armid_io::{Error, LoadedRobot};
use miette::Result;
use serde_json::{Value, json};

use super::findings::paragraph;
use crate::terminal::{Align, Table, number};

/// States at which torques are compared.
const STATES: usize = 200;

/// Angles that were snapped, and the torque of the URDF as it is written less that as it is read.
pub(crate) struct Snapping {
    joints: Vec<SnappedJoint>,
    names: Vec<String>,
    units: Vec<&'static str>,
    difference: TorqueDifference,
}

impl Snapping {
    /// Of the URDF that a robot came from, with these parameters in it; `None` where no angle was snapped.
    ///
    /// # Errors
    /// [`Error`] where the URDF cannot be read as it is written.
    pub(crate) fn of(loaded: &LoadedRobot, parameters: &StandardParameters) -> Result<Option<Self>> {
        let Some(urdf) = &loaded.urdf else { return Ok(None) };
        let named =
            |fault: armid::model::format::FormatError| Error::new(format!("{}: {}", urdf.text.name, fault.message));
        let text = edit_urdf(&urdf.text.content, &urdf.ends, parameters).map_err(named)?.text;
        let read = parse_urdf(&text, &urdf.ends).map_err(named)?;
        if read.snapped.is_empty() {
            return Ok(None);
        }
        let written = parse_urdf_as_written(&text, &urdf.ends).map_err(named)?;
        // Gravity is that of the robot file.
        let [read_robot, written_robot] = [&read, &written].map(|model| {
            let gravity = model.robot.base().rotation * loaded.robot.gravity();
            model.robot.clone().with_gravity(gravity)
        });
        let difference =
            TorqueDifference::new((&written_robot, &written.parameters), (&read_robot, &read.parameters), STATES);
        let joints = loaded.robot.joints();
        Ok(Some(Self {
            joints: read.snapped,
            names: joints.iter().map(|joint| joint.name.clone()).collect(),
            units: joints.iter().map(|joint| JointKind::effort_unit(joint.kind)).collect(),
            difference,
        }))
    }

    fn largest_angle(&self) -> f64 {
        self.joints.iter().fold(0.0, |most, joint| joint.angle_rad.max(most))
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "joints": self.joints,
            "largest_angle_rad": self.largest_angle(),
            "torque": self.difference,
            "torque_units": self.units,
        })
    }

    pub(crate) fn text(&self) -> String {
        let joints: Vec<&str> = self.joints.iter().map(|joint| joint.name.as_str()).collect();
        let sentence = format!(
            "the URDF as written, with its angles up to {:.1e} rad off right ones ({}), has another torque than the model: over {} \
             random states inside the limits",
            self.largest_angle(),
            joints.join(", "),
            self.difference.states,
        );
        let mut table = Table::new(&[
            ("joint", Align::Left),
            ("difference RMS", Align::Right),
            ("largest", Align::Right),
            ("of its torque", Align::Right),
        ]);
        for (i, name) in self.names.iter().enumerate() {
            let of = |value: f64| format!("{value:.1e} {}", self.units[i]);
            table.row([
                name.clone(),
                of(self.difference.rms[i]),
                of(self.difference.largest[i]),
                format!("{} %", number(100.0 * self.difference.relative_rms[i])),
            ]);
        }
        format!("{}{}", paragraph(&sentence, 0), table.render(2))
    }
}
