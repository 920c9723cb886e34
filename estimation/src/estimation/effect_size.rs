//! The size of an effect that a model omits.

use serde::{Deserialize, Serialize};

/// How large an effect may be of which a log shows something, or shows that there is little.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectSize {
    /// Name of the effect.
    pub effect: String,
    /// RMS of its size over the drives, with what noise leaves open.
    pub size: f64,
    /// Unit of the size; empty for a share.
    pub unit: String,
    /// Whether the log supports it ([`EffectShown`](super::Finding::EffectShown)).
    pub shown: bool,
}
