//! Vectors of space in files: the list of their three components.

use nalgebra::Vector3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub fn serialize<S: Serializer>(value: &Vector3<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    <[f64; 3]>::from(*value).serialize(serializer)
}

pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vector3<f64>, D::Error> {
    <[f64; 3]>::deserialize(deserializer).map(Vector3::from)
}

/// For a list of vectors.
pub mod list {
    use super::{Deserialize, Deserializer, Serialize, Serializer, Vector3};

    pub fn serialize<S: Serializer>(value: &[Vector3<f64>], serializer: S) -> Result<S::Ok, S::Error> {
        value.iter().map(|vector| <[f64; 3]>::from(*vector)).collect::<Vec<_>>().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vector3<f64>>, D::Error> {
        Ok(Vec::<[f64; 3]>::deserialize(deserializer)?.into_iter().map(Vector3::from).collect())
    }
}
