//! An arm in motion with the torque that was measured and the torque that an estimate predicts, as MCAP for viewers.
//!
//! | topic | what |
//! |---|---|
//! | `/robot_description`, `/tf` | as in recordings |
//! | `/joint_states` | `sensor_msgs/msg/JointState`: position, rad (m), and measured torque, N·m (N), every sample |
//! | `/predicted_torque` | the same message: what is predicted, as effort |
//! | `/residual` | the same message: measured less predicted, as effort |
//!
//! It is no recording: what it shows is processed, and nothing is identified from it.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use armid::model::Robot;
use armid_cdr::{JointState, Time};
use mcap::records::MessageHeader;

use super::arm_view::{ArmView, Fault};
use super::mcap_sink::{STATES, options};
use crate::error::Error;
use crate::output::write;

/// What is shown of a robot of n joints: N samples, row by row.
#[derive(Clone, Copy, Debug)]
pub struct TorqueView<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Positions, N × n, rad (m).
    pub q: &'a [f64],
    /// Measured torque, N × n, N·m (N).
    pub measured: &'a [f64],
    /// Predicted torque, N × n.
    pub predicted: &'a [f64],
}

impl TorqueView<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let cannot =
            |fault: &dyn std::fmt::Display| Error::new(format!("{} cannot be written: {fault}", path.display()));
        let bytes = self.bytes().map_err(|fault| cannot(&fault))?;
        write(path, |file| file.write_all(&bytes))
    }

    fn bytes(&self) -> Result<Vec<u8>, Fault> {
        let mut file = Cursor::new(Vec::new());
        let mut writer = options().create(&mut file)?;
        let view = ArmView::begin(&mut writer, self.robot, self.rate_hz)?;
        let schema = writer.add_schema(JointState::NAME, "ros2msg", JointState::DEFINITION.as_bytes())?;
        let mut channel = |topic| writer.add_channel(schema, topic, "cdr", &BTreeMap::new());
        let channels = [channel(STATES)?, channel("/predicted_torque")?, channel("/residual")?];
        let n = self.robot.dof();
        let name: Arc<[String]> = self.robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let rows = self.q.chunks_exact(n).zip(self.measured.chunks_exact(n)).zip(self.predicted.chunks_exact(n));
        for (k, ((q, measured), predicted)) in rows.enumerate() {
            let stamp = Time::from_s(k as f64 / self.rate_hz)?;
            let residual = measured.iter().zip(predicted).map(|(measured, predicted)| measured - predicted).collect();
            let none = &q[..0];
            let states = [(q, measured.to_vec()), (none, predicted.to_vec()), (none, residual)];
            for (channel_id, (position, effort)) in channels.into_iter().zip(states) {
                let state = JointState {
                    stamp,
                    name: Arc::clone(&name),
                    position: position.to_vec(),
                    effort,
                    ..JointState::default()
                };
                let ns = stamp.ns().cast_unsigned();
                let header = MessageHeader { channel_id, sequence: k as u32, log_time: ns, publish_time: ns };
                writer.write_to_known_channel(&header, &state.encode()?)?;
            }
            view.show(&mut writer, k, stamp, q)?;
        }
        writer.finish()?;
        drop(writer);
        Ok(file.into_inner())
    }
}
