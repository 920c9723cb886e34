//! The torque of all laws that a model omits, as far as a log shows it.

use nalgebra::{DMatrix, DVector};

use crate::estimation::effect_size::EffectSize;
use crate::estimation::error::EstimationError;
use crate::estimation::finding::Finding;
use crate::estimation::instruments::Instruments;
use crate::estimation::observation::Observation;
use crate::linalg::{LeastSquares, product};
use crate::signal::NoiseModel;

/// Torque of laws, and how large it may be.
#[derive(Clone, Debug)]
pub(in crate::estimation) struct OmittedTorque {
    /// D, (n·M) × d.
    pub(super) columns: DMatrix<f64>,
    /// E[θ | y], d.
    pub(super) mean: DVector<f64>,
    /// E[θ θᵀ | y], d × d.
    pub(super) second_moment: DMatrix<f64>,
    /// Which columns are of laws that the log supports.
    pub(super) supported: Vec<usize>,
    /// The noise that errors of the motion add to scatter over periods, where it is known.
    pub(in crate::estimation) motion: Option<NoiseModel>,
    /// How large each law may be.
    pub(in crate::estimation) sizes: Vec<EffectSize>,
    /// The laws that the log supports.
    pub(in crate::estimation) findings: Vec<Finding>,
}

impl OmittedTorque {
    /// Columns of the laws that the log supports, (n·M) × few.
    pub(in crate::estimation) fn supported(&self) -> DMatrix<f64> {
        self.columns.select_columns(&self.supported)
    }

    /// What a fit leaves of the torque that is expected of the laws, n·M: `(D − W G) E[θ | y]`.
    ///
    /// # Errors
    /// [`EstimationError`] where the instruments are of other equations.
    pub(in crate::estimation) fn left(
        &self,
        observation: &Observation,
        fit: &LeastSquares,
        instruments: Instruments<'_>,
    ) -> Result<DVector<f64>, EstimationError> {
        let torque = DMatrix::from_column_slice(self.columns.nrows(), 1, (&self.columns * &self.mean).as_slice());
        let moved = fit.moved_by(&instruments.transposed_product(observation, &torque)?);
        Ok((torque - product(&observation.regressor, &moved)).column(0).into_owned())
    }

    /// What it adds to cov β̂, b × b: `G E[θ θᵀ | y] Gᵀ`.
    ///
    /// # Errors
    /// [`EstimationError`] where the instruments are of other equations.
    pub(in crate::estimation) fn covariance(
        &self,
        observation: &Observation,
        fit: &LeastSquares,
        instruments: Instruments<'_>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let shifts = fit.moved_by(&instruments.transposed_product(observation, &self.columns)?);
        Ok(product(&product(&shifts, &self.second_moment), &shifts.transpose()))
    }
}
