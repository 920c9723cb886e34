//! `tf2_msgs/msg/TFMessage`: where frames are in each other.

use serde::{Deserialize, Serialize};

use super::{CdrError, Time, decode, encode};

/// `geometry_msgs/msg/TransformStamped`: the pose of a child frame in its parent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// When it was there, by the sender's clock.
    pub stamp: Time,
    /// The parent.
    pub frame_id: String,
    /// The child.
    pub child_frame_id: String,
    /// Position of the child's origin in the parent, m.
    pub translation: [f64; 3],
    /// The child's rotation as a unit quaternion (x, y, z, w).
    pub rotation: [f64; 4],
}

/// Some poses.
///
/// ```
/// use armid_cdr::{Transform, Transforms};
/// let poses = Transforms { transforms: vec![Transform { rotation: [0.0, 0.0, 0.0, 1.0], ..Transform::default() }] };
/// assert_eq!(Transforms::decode(&poses.encode()?)?, poses);
/// # Ok::<(), armid_cdr::CdrError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transforms {
    /// The poses.
    pub transforms: Vec<Transform>,
}

impl Transforms {
    /// Name of the message type.
    pub const NAME: &str = "tf2_msgs/msg/TFMessage";

    /// Its definition, with those that it needs, in the format `ros2msg`.
    pub const DEFINITION: &str = "\
geometry_msgs/TransformStamped[] transforms
================================================================================
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: geometry_msgs/Transform
geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
";

    /// The message as bytes.
    ///
    /// # Errors
    /// [`CdrError::Long`] where a sequence or a string has 2³² entries or more.
    pub fn encode(&self) -> Result<Vec<u8>, CdrError> {
        encode(self)
    }

    /// The message in some bytes.
    ///
    /// # Errors
    /// [`CdrError`] where the bytes are not such a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, CdrError> {
        decode(bytes)
    }
}
