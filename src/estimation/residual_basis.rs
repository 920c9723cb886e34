//! Error bars from a residual, beside what scatter over periods says of it.

use super::{Estimate, EstimationError, Finding, IntervalBasis, Observation, scatter_noise};
use crate::signal::NoiseModel;

/// The estimate with intervals from `noise` of a residual. Where there is scatter over periods, findings about the residual
/// come from that: what noise alone would leave. `inferred` infers with a noise and its basis.
pub(super) fn with_residual_noise(
    observation: &Observation,
    noise: &NoiseModel,
    inferred: impl Fn(&NoiseModel, IntervalBasis) -> Result<Estimate, EstimationError>,
) -> Result<Estimate, EstimationError> {
    let mut estimate = inferred(noise, IntervalBasis::Residual)?;
    if let Some(scatter) = scatter_noise(observation) {
        let of_scatter = inferred(&scatter, IntervalBasis::Scatter)?;
        let is_of_std = |finding: &Finding| matches!(finding, Finding::PoorlyDetermined { .. });
        estimate.findings.retain(is_of_std);
        estimate.findings.extend(of_scatter.findings.into_iter().filter(|finding| !is_of_std(finding)));
        estimate.noise_std = of_scatter.noise_std;
    }
    Ok(estimate)
}
