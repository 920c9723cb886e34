//! A rounded rod.

use nalgebra::Vector3;

/// A capsule: every point within `radius` of a segment, m.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// One end of the segment, in the frame of its link.
    #[serde(with = "crate::plain::vector")]
    pub from: Vector3<f64>,
    /// The other end.
    #[serde(with = "crate::plain::vector")]
    pub to: Vector3<f64>,
    /// Radius, m.
    pub radius: f64,
}
