//! A point of the arm that has a name, such as the tip of its gripper.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::spatial::Placement;

/// A point that a link carries, of no influence on kinematics or dynamics: a place to look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NamedPoint {
    /// Its name.
    pub name: String,
    /// The link that carries it; 0 is the base.
    pub link: usize,
    /// Where it is in the link's frame, m.
    #[serde(rename = "position_m", with = "crate::plain::vector")]
    pub position: Vector3<f64>,
}

impl NamedPoint {
    /// Where it is in the base frame, m, given the pose of every link's frame there (n): `p = R_i p_i + t_i`.
    pub fn place(&self, poses: &[Placement]) -> Vector3<f64> {
        match self.link {
            0 => self.position,
            link => poses[link - 1].rotation * self.position + poses[link - 1].translation,
        }
    }
}
