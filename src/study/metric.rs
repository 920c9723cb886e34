//! The metrics in which designs are compared.

use super::outcome::ScoredEstimate;

/// A metric in which designs are compared; the first decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Torque prediction RMSE on random motions, N·m.
    #[default]
    Prediction,
    /// Error of the predicted torque, each joint over its torque rating.
    PredictionOfRating,
    /// Log volume of the error in reference units.
    LogVolume,
    /// RMS parameter error in reference units.
    Reference,
    /// RMS parameter error in SI units.
    Si,
    /// Torque prediction RMSE against what the arm measures on fresh motions, N·m.
    Measured,
    /// Torque prediction RMSE on the random motions at 30 % of their speed, N·m.
    Slow,
    /// Torque prediction RMSE on moves from point to point, N·m.
    PointToPoint,
    /// Torque prediction RMSE on poses at rest, N·m; `None` of an arm that carries no weight there.
    Static,
}

// The first decides.
crate::input::named! { Metric as title {
    Prediction: "torque prediction RMSE, N·m", PredictionOfRating: "torque prediction RMSE, share of the rating",
    LogVolume: "log volume of the error, reference units", Reference: "parameter RMSE, reference units",
    Si: "parameter RMSE, SI units", Measured: "RMSE against measured torque, N·m",
    Slow: "torque prediction RMSE on slow motions, N·m",
    PointToPoint: "torque prediction RMSE on moves from point to point, N·m",
    Static: "torque prediction RMSE on static poses, N·m"
} }

impl Metric {
    /// The metrics of the first table, in which a study compares designs; predictions on other kinds of motion have a table of their own.
    pub const OF_ERRORS: [Self; 6] =
        [Self::Prediction, Self::PredictionOfRating, Self::LogVolume, Self::Reference, Self::Si, Self::Measured];

    /// The torque prediction RMSE on each kind of motion, in the order of
    /// [`MotionKind::ALL`](super::MotionKind::ALL).
    pub const OF_MOTIONS: [Self; 4] = [Self::Prediction, Self::Slow, Self::PointToPoint, Self::Static];

    /// Whether two values are compared by their difference rather than their ratio.
    pub const fn is_logarithmic(self) -> bool {
        matches!(self, Self::LogVolume)
    }

    pub(super) fn value(self, estimate: &ScoredEstimate) -> Option<f64> {
        let score = estimate.score.as_ref()?;
        match self {
            Self::Prediction => Some(score.prediction_rmse_nm),
            Self::PredictionOfRating => Some(score.prediction_rmse_of_rating),
            Self::Reference => Some(score.reference_rmse),
            Self::Si => Some(score.si_rmse),
            Self::Measured => score.measured_rmse_nm,
            Self::Slow => Some(score.slow_rmse_nm),
            Self::PointToPoint => Some(score.point_to_point_rmse_nm),
            Self::Static => score.static_rmse_nm,
            Self::LogVolume => None,
        }
    }
}
