//! A text: the robot controller's state in words.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// `std_msgs/msg/String`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// The text.
    pub data: String,
}

impl Message for Text {}
