//! What is changed where nearly right angles of a URDF are read as right ones, and what that does to the torque.

use armid::dynamics::TorqueDifference;
use armid::model::StandardParameters;
use armid::model::format::{SnappedJoint, edit_urdf, parse_urdf, parse_urdf_as_written};
use armid_io::{Error, LoadedRobot};
use serde::Serialize;

/// States at which torques are compared.
const STATES: usize = 200;

/// Angles that were snapped, and the torque of the URDF as it is written less that as it is read.
#[derive(Clone, Debug, Serialize)]
pub struct Snapping {
    /// The joints whose angles were.
    pub joints: Vec<SnappedJoint>,
    /// The largest angle by which one was off, rad.
    pub largest_angle_rad: f64,
    /// The difference of torque.
    pub torque: TorqueDifference,
    /// Its unit, n.
    pub torque_units: Vec<&'static str>,
}

impl Snapping {
    /// Of the URDF that a robot came from, with these parameters in it; `None` where no angle was snapped.
    ///
    /// # Errors
    /// [`Error`] where the URDF cannot be read as it is written.
    pub(super) fn of(loaded: &LoadedRobot, parameters: &StandardParameters) -> Result<Option<Self>, Error> {
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
        Ok(Some(Self {
            largest_angle_rad: read.snapped.iter().fold(0.0, |most, joint| joint.angle_rad.max(most)),
            joints: read.snapped,
            torque: difference,
            torque_units: loaded.robot.joints().iter().map(|joint| joint.kind.effort_unit()).collect(),
        }))
    }
}
