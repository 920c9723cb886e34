//! A stacked regressor in units in which robot and motion are of size 1.

use nalgebra::DMatrix;

use super::error::BaseError;
use super::geometry::Geometry;
use crate::model::ParameterId;

/// A stacked regressor, whose row `k n + i` is joint i, from SI units to those in which robot and motion are of size 1.
pub(super) fn scaled_stack(
    geometry: &Geometry,
    parameters: &[ParameterId],
    mut w: DMatrix<f64>,
) -> Result<DMatrix<f64>, BaseError> {
    let n = geometry.dof();
    let units = geometry.units(parameters);
    for (mut column, unit) in w.column_iter_mut().zip(&units) {
        for (row, entry) in column.iter_mut().enumerate() {
            if !entry.is_finite() {
                return Err(BaseError::NotFinite { sample: row / n, value: *entry });
            }
            *entry *= unit / geometry.effort_unit(row % n);
        }
    }
    Ok(w)
}
