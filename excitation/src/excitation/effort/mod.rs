//! Torque and current, their peaks and their root mean square, for parameters that are known with an uncertainty.
//!
//! ```text
//! |w·τ̄(t)| + k s(t) ≤ u r   for all t of period and ramps,        RMS over the period of (|w·τ̄| + k s) ≤ u r_continuous
//! τ̄ = Y φ̄       s² = (w·Y) Σ_φ (w·Y)ᵀ
//! ```
//! w picks a joint's torque, or a motor's current `i = (Cᵀ)⁻¹ τ / (N Kt)`; r is its rating, u the permitted part of it.
//! With φ ~ N(φ̄, Σ_φ) the torque at any *one*
//! instant stays on its side of the limit with probability Φ(k) at least (95 % for k = 1.645); how often no limit is
//! passed at *any* instant is measured by drawing parameters, [`InsideShare`]. With k = 0 the limits hold
//! for the nominal parameters alone.

mod channel;
mod instants;
mod limits;
mod model;
mod spread;
mod worst;

pub use channel::{Channel, EffortKind};
pub use limits::EffortLimits;
pub use model::{EffortModel, InsideShare};
pub use spread::{CONFIDENCE_95, ParameterSpread};
pub use worst::{EffortUse, WorstEfforts};
