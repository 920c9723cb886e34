//! From samples to parameters with tested error bars.
//!
//! ```text
//! y = W_b β + ε        cov ε = C        OLS: min ‖y − W_b β‖        WLS: min (y − W_b β)ᵀ Σ⁻¹ (y − W_b β)   (radkhah2007 eq. 6)
//! ```
//! [`Observation`] holds the equations, [`EstimationProblem`] adds what else an estimator may look at, and an
//! [`Estimator`] turns it into an [`Estimate`]: base parameters with covariance, intervals, residuals, and the
//! [`Finding`]s a reader must know. Each estimator is one file and one line in [`EstimatorKind`]; one from outside implements
//! [`Estimator`] with [`Factorisation`] or [`solve`], [`scatter_noise`] and [`Inference`], and passes `conformance::estimator_laws`.
//!
//! The equations' error bars come from the noise that scattered over periods, with its correlation in time; where no
//! period was repeated, from the residual. What the residual shows beyond that noise is in them as a discrepancy: a random
//! function of speed, load, position, acceleration and time. No estimator sees the truth: the types that hold it come after this module.

mod closed_loop;
mod comparison;
mod completion;
mod consistent_set;
mod declared;
mod discrepancy;
mod drive_gains;
mod effect_size;
mod entries;
mod error;
mod essential;
mod estimate;
mod estimator;
mod expected_residual;
mod factorisation;
mod finding;
mod friction_speed;
mod from_outside;
mod identification;
mod inference;
mod instruments;
mod joint_products;
mod kind;
mod law;
mod linear_fit;
mod load_fit;
mod load_friction;
mod lower_triangle;
mod model_fit;
mod measured;
mod motion;
mod observation;
mod omitted;
mod ordinary;
mod payload;
mod pooled;
mod poorly_determined;
mod position_servo;
mod physical;
mod prediction;
mod problem;
mod recursive;
mod residual;
mod residual_shape;
mod restated;
mod ridge;
mod robust;
mod selection;
mod speed_columns;
mod speed_search;
mod stiff_loop;
mod termination;
mod torque_residual;
mod unit_equations;
mod weighted;
#[cfg(test)]
mod tests;

pub use closed_loop::{
    ClosedLoop, ClosedLoopError, ClosedLoopFactory, ClosedLoopInterval, ClosedLoopIntervals, ClosedLoopMotion,
    ClosedLoopNode, ClosedLoopReference, ClosedLoopSlopes, CommandedLoop, closed_loop_of, commanded_loop_of,
};
pub use comparison::{ComparedParameter, Comparison, compare};
pub use completion::{Completion, complete};
pub use drive_gains::{DriveGain, DriveGains, GainMethod, drive_gains, gain_equations, gain_slopes};
pub use effect_size::EffectSize;
pub use error::{EstimationError, ExternalError};
pub use estimate::{BaseEstimate, Estimate, IntervalBasis, StandardEstimate};
pub use estimator::Estimator;
pub use factorisation::{Factorisation, FactorisedBy};
pub use finding::{Finding, MisfitPart};
pub use friction_speed::{FrictionSpeed, FrictionSpeeds};
pub use identification::Identification;
pub use inference::{Inference, solve};
pub use instruments::Instruments;
pub use kind::EstimatorKind;
pub use law::{EstimatorLaw, LawException};
pub use load_fit::observe;
pub use measured::Measured;
pub use model_fit::{BodyOrigin, ModelFit, ModelGuess, PriorWeight, fit_model};
pub use observation::Observation;
pub use payload::{NegativeMass, NegativeMassCause, Payload, PayloadBody, PayloadParameter, payload};
pub use pooled::{Pooled, Together, pool};
pub use position_servo::{PositionServo, ServoEstimate, ServoPart, interpolate};
pub use prediction::{Model, Validation, predict, validate};
pub use problem::EstimationProblem;
pub use residual::{residual_noise, scatter_noise};
pub use residual_shape::{Against, JointTrace, ResidualShape, ResidualTests, ResidualTrends, Trend, Whiteness};
pub use selection::{
    BeyondMotion, FTest, HeldOutChange, HeldOutData, Selection, TermEvidence, Verdict, candidate_terms, select,
};
pub use stiff_loop::StiffLoop;
pub use termination::Termination;
pub use torque_residual::{DEFAULT_BANDWIDTH_HZ, RowShares, TorqueResidual, TorqueSeries};
