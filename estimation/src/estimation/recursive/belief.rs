//! What a filter knows between two samples.

use nalgebra::{DMatrix, DVector};

/// Mean and spread of the parameters, and how a sample changes them.
pub(super) trait Belief {
    /// From a mean (b) and its covariance (b × b); `None` where that is not positive definite.
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self>
    where
        Self: Sized;

    /// A step of the walk: `variance` is added to that of each parameter.
    fn walk(&mut self, variance: f64);

    /// A sample `z = H γ + ν` (m × b) with cov ν = 1; `false` where its covariance is not positive definite.
    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool;

    /// Mean, b.
    fn mean(&self) -> &DVector<f64>;

    /// Covariance, b × b.
    fn covariance(&self) -> DMatrix<f64>;
}
