//! What a family of trajectories is to a search: shape functions, and coefficients that multiply them.

use std::fmt;
use std::sync::Arc;

use super::error::TrajectoryError;
use super::fourier::FourierTrajectory;
use super::periodic::PeriodicTrajectory;

/// A family of trajectories, linear in the coefficients of each joint.
///
/// ```text
/// q_j(θ) = Σ_c x_jc N_c(θ)          θ = 2π t/T
/// ```
/// The list is [`Family`](super::Family); one from outside is used like those of the list. Laws that every family obeys
/// are in `conformance::family_laws`.
pub trait TrajectoryFamily: fmt::Debug + Send + Sync {
    /// Its name, as `cubic-b-spline`.
    fn name(&self) -> &'static str;

    /// The shape functions of a joint of `harmonics` harmonics, for a period (s). A joint of as many harmonics should have
    /// 2H + 1 coefficients in every family, so that families can be compared.
    fn shape(&self, period_s: f64, harmonics: usize) -> Arc<dyn ShapeFunctions>;

    /// The member with this period (s), these names of the joints, and the coefficients of each.
    fn trajectory(&self, period_s: f64, joints: Vec<(String, Vec<f64>)>) -> PeriodicTrajectory;

    /// The coefficients of one joint of a member, for the shape functions of `harmonics` harmonics.
    ///
    /// # Errors
    /// [`TrajectoryError`] if the trajectory is of another family, or the joint's motion is not one of so many harmonics.
    fn coefficients(
        &self,
        trajectory: &PeriodicTrajectory,
        joint: usize,
        harmonics: usize,
    ) -> Result<Vec<f64>, TrajectoryError>;

    /// The least number of harmonics of a joint that moves.
    fn least_harmonics(&self) -> usize {
        1
    }

    /// The member that has the coefficients of a Fourier series; `None` where the family has other coefficients, so that
    /// the nearest member is found by least squares of positions.
    fn of_series(&self, series: &FourierTrajectory) -> Option<PeriodicTrajectory> {
        let _ = series;
        None
    }
}

/// How far and how fast a joint can move: what its coefficients are measured by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionScale {
    /// Half the range of its position, rad (m).
    pub range: f64,
    /// Speed that it can reach within its limits, rad/s (m/s).
    pub speed: f64,
    /// Fundamental angular frequency ω, rad/s.
    pub omega: f64,
}

/// The shape functions of one joint: periodic functions of the phase, as often differentiable as limits ask for.
pub trait ShapeFunctions: fmt::Debug + Send + Sync {
    /// How many there are, and so how many coefficients.
    fn count(&self) -> usize;

    /// Points of one period between which no peak of a limited quantity hides.
    fn grid(&self) -> usize;

    /// Writes the derivative of this order (0 position … 3 jerk) with respect to time of every function at a phase, in rad
    /// and s.
    fn fill(&self, phase: f64, order: usize, out: &mut [f64]);

    /// The coefficients of standing still at 1 rad.
    fn constant(&self) -> Vec<f64>;

    /// A size for each coefficient, so that a step of one such size moves the joint about as far for all. By default that
    /// of coefficients in rad.
    fn scales(&self, scale: &MotionScale) -> Vec<f64> {
        vec![scale.speed / scale.omega; self.count()]
    }
}
