//! The list of families of trajectories in which a design is sought.

use std::sync::Arc;

use super::b_spline::{BSplineJoint, BSplineTrajectory};
use super::error::TrajectoryError;
use super::fourier::{FourierJoint, FourierTrajectory};
use super::fourier_quintic::FourierQuinticTrajectory;
use super::linear_family::{ShapeFunctions, TrajectoryFamily};
use super::periodic::PeriodicTrajectory;
use super::shape::Shape;

/// A family of trajectories of the list. All have 2H + 1 coefficients for a joint of H harmonics, so that
/// they can be compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// `radkhah2007`'s finite Fourier series.
    #[default]
    Fourier,
    /// The series with a quintic polynomial, at rest at both ends of the period.
    FourierQuintic,
    /// Periodic cubic splines on 2H + 1 knots.
    CubicBSpline,
    /// Periodic quintic splines on 2H + 1 knots.
    QuinticBSpline,
}

crate::input::named! { Family {
    Fourier: "fourier", FourierQuintic: "fourier-quintic", CubicBSpline: "cubic-b-spline",
    QuinticBSpline: "quintic-b-spline"
} }

impl Family {
    /// Degree of the splines; `None` for a series.
    const fn degree(self) -> Option<usize> {
        match self {
            Self::Fourier | Self::FourierQuintic => None,
            Self::CubicBSpline => Some(3),
            Self::QuinticBSpline => Some(5),
        }
    }
}

impl TrajectoryFamily for Family {
    fn name(&self) -> &'static str {
        Self::name(*self)
    }

    /// Splines need a knot more than their degree.
    fn least_harmonics(&self) -> usize {
        self.degree().map_or(1, |degree| degree.div_ceil(2))
    }

    fn shape(&self, period_s: f64, harmonics: usize) -> Arc<dyn ShapeFunctions> {
        Arc::new(match self.degree() {
            None => Shape::Series { period_s, harmonics, at_rest: matches!(self, Self::FourierQuintic) },
            Some(degree) => Shape::Spline { period_s, degree, knots: 2 * harmonics + 1 },
        })
    }

    /// Each joint has 2H + 1 coefficients: `(a_1, b_1, …, a_H, b_H, q0)` or `c`.
    fn trajectory(&self, period_s: f64, joints: Vec<(String, Vec<f64>)>) -> PeriodicTrajectory {
        let Some(degree) = self.degree() else {
            // A file has one number of harmonics: joints with fewer have zeros.
            let harmonics = joints.iter().map(|(_, values)| values.len() / 2).max().unwrap_or(0);
            let joints = joints.into_iter().map(|(name, values)| {
                let (pairs, q0) = values.split_at(values.len() - 1);
                let padded = |first: usize| {
                    let mut amplitudes: Vec<f64> = pairs.iter().skip(first).step_by(2).copied().collect();
                    amplitudes.resize(harmonics, 0.0);
                    amplitudes
                };
                FourierJoint { name, a: padded(0), b: padded(1), q0: q0[0] }
            });
            let series = FourierTrajectory { period_s, joints: joints.collect() };
            return match self {
                Self::FourierQuintic => FourierQuinticTrajectory::from(series).into(),
                _ => series.into(),
            };
        };
        let joints = joints.into_iter().map(|(name, c)| BSplineJoint { name, c });
        BSplineTrajectory { period_s, degree, joints: joints.collect() }.into()
    }

    /// Harmonics that a series lacks are zero.
    fn coefficients(
        &self,
        trajectory: &PeriodicTrajectory,
        joint: usize,
        harmonics: usize,
    ) -> Result<Vec<f64>, TrajectoryError> {
        let series = match (self, trajectory) {
            (Self::Fourier, PeriodicTrajectory::Fourier(series)) => series,
            (Self::FourierQuintic, PeriodicTrajectory::FourierQuintic(motion)) => &motion.series,
            (_, PeriodicTrajectory::BSpline(splines)) if Some(splines.degree) == self.degree() => {
                let BSplineJoint { name, c } = &splines.joints[joint];
                let (found, expected) = (c.len(), 2 * harmonics + 1);
                if found != expected {
                    return Err(TrajectoryError::OtherKnots { joint: name.clone(), found, expected });
                }
                return Ok(c.clone());
            }
            _ => return Err(TrajectoryError::OtherFamily { expected: self.name() }),
        };
        let FourierJoint { name, a, b, q0 } = &series.joints[joint];
        if a.iter().skip(harmonics).chain(b.iter().skip(harmonics)).any(|&amplitude| amplitude != 0.0) {
            return Err(TrajectoryError::Harmonics { joint: name.clone(), found: a.len(), most: harmonics });
        }
        let mut pairs: Vec<f64> = a.iter().zip(b).flat_map(|(&a, &b)| [a, b]).collect();
        pairs.resize(2 * harmonics, 0.0);
        pairs.push(*q0);
        Ok(pairs)
    }

    fn of_series(&self, series: &FourierTrajectory) -> Option<PeriodicTrajectory> {
        match self {
            Self::Fourier => Some(series.clone().into()),
            Self::FourierQuintic => Some(FourierQuinticTrajectory::from(series.clone()).into()),
            Self::CubicBSpline | Self::QuinticBSpline => None,
        }
    }
}

impl From<Family> for Arc<dyn TrajectoryFamily> {
    fn from(family: Family) -> Self {
        Arc::new(family)
    }
}
