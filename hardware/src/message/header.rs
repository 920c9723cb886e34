//! The header that many messages begin with.

use armid_cdr::Time;
use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// When the data were taken, by the sender's clock.
    pub stamp: Time,
    /// Frame that the data are in.
    pub frame_id: String,
}

impl Message for Header {}
