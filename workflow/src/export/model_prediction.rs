//! How well a model file predicts the log that it came from, next to the estimate.

use armid::estimation::RowShares;
use armid_io::log::LogResidual;
use serde::Serialize;

use crate::numbers::error_percent;

/// How much worse than the estimate a file may be, as a factor.
const WORSE: f64 = 1.25;

/// Share of the torque below which an error is none, however exact the estimate is: that of a log without noise.
const NOTHING: f64 = 0.01;

/// Error of a prediction over all rows, as a share of the torque: of the fit's part, and of what is held out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PredictionError {
    /// Of what the fit used.
    pub fit: f64,
    /// Of what is held out, where anything is.
    pub held_out: Option<f64>,
}

impl PredictionError {
    pub(crate) fn of(residual: &LogResidual) -> Self {
        Self { fit: share(&residual.used.all), held_out: residual.held_out.as_ref().map(|part| share(&part.all)) }
    }

    /// The error of what is held out, or else of the fit.
    pub fn shown(&self) -> f64 {
        self.held_out.unwrap_or(self.fit)
    }
}

/// The prediction error of a file next to that of the estimate.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModelPrediction {
    /// Of the file.
    pub file: PredictionError,
    /// Of the estimate.
    pub estimate: PredictionError,
    /// How much worse than the estimate a good file is at most, as a factor.
    pub limit: f64,
    /// Whether the file is about as good as the estimate.
    pub good: bool,
}

impl ModelPrediction {
    pub(crate) fn new(file: PredictionError, estimate: PredictionError) -> Self {
        Self { file, estimate, limit: WORSE, good: file.fit <= NOTHING.max(WORSE * estimate.fit) }
    }

    /// "arm.urdf predicts this log with 8.6 % (estimate: 8.4 %; held-out part: 9.1 %)".
    pub fn sentence(&self, name: &str) -> String {
        let held_out =
            self.file.held_out.map_or_else(String::new, |error| format!("; held-out part: {}", error_percent(error)));
        let (file, estimate) = (error_percent(self.file.fit), error_percent(self.estimate.fit));
        format!("{name} predicts this log with {file} (estimate: {estimate}{held_out})")
    }
}

/// Over all joints; of joints with unlike units the root of the mean square of their own shares.
fn share(rows: &RowShares) -> f64 {
    let own = || {
        let shares: Vec<f64> = rows.share.iter().flatten().map(|share| share * share).collect();
        (shares.iter().sum::<f64>() / shares.len().max(1) as f64).sqrt()
    };
    rows.total.unwrap_or_else(own)
}
