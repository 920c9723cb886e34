//! How well a model file predicts the log that it came from, beside the estimate.

use armid::estimation::{RowShares, TorqueResidual};
use serde_json::{Value, json};

/// How much worse than the estimate a file may be, as a factor.
const WORSE: f64 = 1.25;

/// Share of the torque below which an error is none, however exact the estimate is: that of a log without noise.
const NOTHING: f64 = 0.01;

/// Error of a prediction over all rows, as a share of the torque: of the fit's part, and of what is held out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PredictionError {
    fit: f64,
    held_out: Option<f64>,
}

impl PredictionError {
    pub(crate) fn of((fit, held_out): &(TorqueResidual, Option<TorqueResidual>)) -> Self {
        Self { fit: share(&fit.all), held_out: held_out.as_ref().map(|residual| share(&residual.all)) }
    }

    pub(crate) fn fit(&self) -> f64 {
        self.fit
    }

    /// Of what is held out, where anything is.
    pub(crate) fn shown(&self) -> f64 {
        self.held_out.unwrap_or(self.fit)
    }
}

/// That of a file beside that of the estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelPrediction {
    pub(crate) file: PredictionError,
    pub(crate) estimate: PredictionError,
}

impl ModelPrediction {
    /// Whether the file is about as good as the estimate.
    pub(crate) fn is_good(&self) -> bool {
        self.file.fit <= NOTHING.max(WORSE * self.estimate.fit)
    }

    /// "arm.urdf predicts this log with 8.6 % (estimate: 8.4 %; held-out part: 9.1 %)".
    pub(crate) fn sentence(&self, name: &str) -> String {
        let held_out =
            self.file.held_out.map_or_else(String::new, |error| format!("; held-out part: {}", percent(error)));
        let (file, estimate) = (percent(self.file.fit), percent(self.estimate.fit));
        format!("{name} predicts this log with {file} (estimate: {estimate}{held_out})")
    }

    pub(crate) fn json(&self) -> Value {
        let of = |error: &PredictionError| json!({ "fit": error.fit, "held_out": error.held_out });
        json!({ "file": of(&self.file), "estimate": of(&self.estimate), "limit": WORSE, "good": self.is_good() })
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

/// Two digits after the point below ten percent, so that a small difference is seen.
pub(crate) fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if value < 10.0 { format!("{value:.2} %") } else { format!("{value:.1} %") }
}
