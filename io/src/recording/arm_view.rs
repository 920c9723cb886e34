//! What viewers need to show an arm beside its numbers: its model once, and where its links are.
//!
//! | topic | what |
//! |---|---|
//! | `/robot_description` | `std_msgs/msg/String`: the arm as URDF with its shapes, at the beginning |
//! | `/tf` | `tf2_msgs/msg/TFMessage`: the pose of every link of that URDF in the one before it, at most 50 times a second |

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use armid::model::format::write_urdf_to_view;
use armid::model::{Robot, StandardParameters};
use armid_cdr::{Time, Transform, Transforms, encode};
use mcap::records::MessageHeader;
use nalgebra::{Rotation3, UnitQuaternion};

/// Topic of the arm as URDF.
const DESCRIPTION: &str = "/robot_description";
/// Topic of the poses.
const TRANSFORMS: &str = "/tf";
/// How often poses are stored, at most, Hz.
const RATE_HZ: f64 = 50.0;

/// A fault of the file, or of a message.
pub(super) type Fault = Box<dyn std::error::Error>;

/// An arm that is shown.
pub(super) struct ArmView {
    robot: Robot,
    channel: u16,
    every: usize,
}

impl ArmView {
    /// Describes the arm at time zero; samples come so many times a second.
    pub(super) fn begin<W: Write + Seek>(
        writer: &mut mcap::Writer<W>,
        robot: &Robot,
        rate_hz: f64,
    ) -> Result<Self, Fault> {
        let schema = writer.add_schema("std_msgs/msg/String", "ros2msg", b"string data\n")?;
        let channel_id = writer.add_channel(schema, DESCRIPTION, "cdr", &BTreeMap::new())?;
        let header = "the arm as a viewer shows it, without inertias: armid export writes those";
        let text = write_urdf_to_view(robot, &StandardParameters::zero(robot.dof()), header);
        let at_zero = MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&at_zero, &encode(&(text,))?)?;
        let schema = writer.add_schema(Transforms::NAME, "ros2msg", Transforms::DEFINITION.as_bytes())?;
        let channel = writer.add_channel(schema, TRANSFORMS, "cdr", &BTreeMap::new())?;
        Ok(Self { robot: robot.clone(), channel, every: (rate_hz / RATE_HZ).ceil().max(1.0) as usize })
    }

    /// Stores the poses of a sample where it is their turn.
    pub(super) fn show<W: Write + Seek>(
        &self,
        writer: &mut mcap::Writer<W>,
        index: usize,
        stamp: Time,
        q: &[f64],
    ) -> Result<(), Fault> {
        if !index.is_multiple_of(self.every) {
            return Ok(());
        }
        let (mut parent, mut end) = ("base".to_owned(), *self.robot.base());
        let links = self.robot.joints().iter().zip(q).enumerate().map(|(link, (joint, &q))| {
            // The frame of the URDF stands on its joint, before what is constant behind it.
            let pose = end.compose(&joint.placement(q)).compose(&joint.after.inverse());
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
            let child = format!("link{}", link + 1);
            end = joint.after;
            Transform {
                stamp,
                frame_id: std::mem::replace(&mut parent, child.clone()),
                child_frame_id: child,
                translation: pose.translation.into(),
                rotation: rotation.coords.into(),
            }
        });
        let message = Transforms { transforms: links.collect() };
        let ns = stamp.ns().cast_unsigned();
        let sequence = (index / self.every) as u32;
        let header = MessageHeader { channel_id: self.channel, sequence, log_time: ns, publish_time: ns };
        writer.write_to_known_channel(&header, &message.encode()?)?;
        Ok(())
    }
}
