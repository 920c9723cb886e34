//! Which parameters the equations hardly determine.

use super::estimate::BaseEstimate;
use super::finding::Finding;

/// A value whose standard deviation is more than a third of it is reported.
const UNCERTAIN: f64 = 3.0;

/// Parameters whose standard deviation is more than a third of their value.
pub(super) fn poorly_determined(base: &[BaseEstimate]) -> Vec<Finding> {
    let poor = base.iter().filter(|p| UNCERTAIN * p.std > p.value.abs());
    let of = |p: &BaseEstimate| {
        let (parameter, unit) = (p.name.clone(), p.unit.clone());
        Finding::PoorlyDetermined { parameter, value: p.value, std: p.std, unit }
    };
    poor.map(of).collect()
}
