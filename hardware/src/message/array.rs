//! A list of numbers: streamed set-points.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// `std_msgs/msg/MultiArrayDimension`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArrayDimension {
    /// What runs along it.
    pub label: String,
    /// How many entries.
    pub size: u32,
    /// Distance of two of them.
    pub stride: u32,
}

/// `std_msgs/msg/MultiArrayLayout`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArrayLayout {
    /// The dimensions; may be empty for a plain list.
    pub dim: Vec<ArrayDimension>,
    /// Entries before the first.
    pub data_offset: u32,
}

/// `std_msgs/msg/Float64MultiArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// Shape.
    pub layout: ArrayLayout,
    /// Numbers.
    pub data: Vec<f64>,
}

impl Message for Float64MultiArray {}

impl Float64MultiArray {
    /// A plain list.
    pub fn list(data: Vec<f64>) -> Self {
        Self { layout: ArrayLayout::default(), data }
    }
}
