//! What the samples of an experiment keep of it when others are joined to them.

use serde::{Deserialize, Serialize};

/// One of the experiments that were [joined](super::Samples::join).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JoinedExperiment {
    /// Number of its instants.
    pub samples: usize,
    /// The period that they cover once, s; `None` where there is none.
    pub period_s: Option<f64>,
    /// Upper end of the band of positions, per joint, Hz.
    pub position_band_hz: Vec<f64>,
    /// Power of a Fourier line of a position that is noise, per joint, rad² (m²); empty where it is not known.
    pub position_floor: Vec<f64>,
    /// Upper end of the band of torque, Hz; `None` where it was not filtered.
    pub torque_band_hz: Option<f64>,
}
