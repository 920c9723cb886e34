//! How is an estimate written for another tool, and how well does that file predict the log?

mod exchange;
mod model_file;
mod model_prediction;
mod python_file;
mod read_back;
mod snapping;
mod source;

pub use exchange::{Exchange, Reloaded};
pub use model_file::{ExportSettings, KnownSum, Lacking, ModelFile, WrittenParameter, export, prediction_of};
pub use model_prediction::{ModelPrediction, PredictionError};
pub use snapping::Snapping;
pub use source::{Recomputed, SourceFile, export_source};
