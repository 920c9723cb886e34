//! Vectors of space in files: the list of their three components.

use nalgebra::Vector3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) fn serialize<S: Serializer>(value: &Vector3<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    <[f64; 3]>::from(*value).serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vector3<f64>, D::Error> {
    <[f64; 3]>::deserialize(deserializer).map(Vector3::from)
}
