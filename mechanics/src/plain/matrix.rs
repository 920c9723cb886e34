//! Matrices in files: the list of their rows. A matrix without rows does not keep the number of its columns.

use nalgebra::DMatrix;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The rows of a matrix.
fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// The matrix with these rows; an error where they differ in length.
fn matrix<E: Error>(rows: &[Vec<f64>]) -> Result<DMatrix<f64>, E> {
    let columns = rows.first().map_or(0, Vec::len);
    if let Some(row) = rows.iter().find(|row| row.len() != columns) {
        return Err(E::custom(format!("a row of a matrix has {} numbers, expected {columns} as the first", row.len())));
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
}

pub fn serialize<S: Serializer>(value: &DMatrix<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    rows(value).serialize(serializer)
}

pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<DMatrix<f64>, D::Error> {
    matrix(&Vec::<Vec<f64>>::deserialize(deserializer)?)
}

/// For a matrix that may be missing.
pub mod option {
    use super::{DMatrix, Deserialize, Deserializer, Serialize, Serializer, matrix, rows};

    pub fn serialize<S: Serializer>(value: &Option<DMatrix<f64>>, serializer: S) -> Result<S::Ok, S::Error> {
        value.as_ref().map(rows).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<DMatrix<f64>>, D::Error> {
        Option::<Vec<Vec<f64>>>::deserialize(deserializer)?.map(|rows| matrix(&rows)).transpose()
    }
}

/// For a list of matrices.
pub mod list {
    use super::{DMatrix, Deserialize, Deserializer, Serialize, Serializer, matrix, rows};

    pub fn serialize<S: Serializer>(value: &[DMatrix<f64>], serializer: S) -> Result<S::Ok, S::Error> {
        value.iter().map(rows).collect::<Vec<_>>().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<DMatrix<f64>>, D::Error> {
        Vec::<Vec<Vec<f64>>>::deserialize(deserializer)?.iter().map(|rows| matrix(rows)).collect()
    }
}

/// For a rotation, 3 × 3.
pub mod three {
    use nalgebra::Matrix3;

    use super::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &Matrix3<f64>, serializer: S) -> Result<S::Ok, S::Error> {
        let rows: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| value[(i, j)]));
        rows.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Matrix3<f64>, D::Error> {
        <[[f64; 3]; 3]>::deserialize(deserializer).map(|rows| Matrix3::from_fn(|i, j| rows[i][j]))
    }
}
