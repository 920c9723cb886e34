//! Ordinary least squares over physically consistent sets, alone or near a prior.
//!
//! ```text
//! min_φ ‖y − W K φ‖²/(2σ̂²) + R(φ)        over consistent φ; σ̂² the variance of the residual
//!
//! pc-ols              R = 0
//! pc-ols-euclidean    R = |φ − φ₀|²/(2s²)                                                 s² the mean square of φ₀
//! pc-ols-entropic     R = Σ_links ( tr(P₀⁻¹ P) − ln det P ) + Σ_drives ( x/x₀ − ln x )
//! pc-ols-pullback     R = ½ Σ_links tr((P₀⁻¹ΔP)²) + ½ Σ_drives (Δx/x₀)²
//! ```
//! Its optimum is that of the semidefinite program, found along a barrier's path. Where the ordinary solution is consistent, `pc-ols` is
//! that. The entropic distance is the Bregman divergence of −ln det: it does not depend on frames or on units of length and mass, and is
//! infinite where the set is not consistent. It counts in nats beside the equations' own likelihood. The pullback metric is that of positive
//! definite matrices at the prior alone: the entropic distance to second order. The Euclidean distance in SI is for comparison: a kilogram
//! weighs as much as a kilogram metre squared, so a prior's masses hold and its inertias do not.
//!
//! Assumes what `ols` does, links that are rigid bodies, and for a prior a nominal set near the arm. Fails where torque that the model lacks
//! pushes the equations out of what bodies can have: the estimate then lies on the boundary, and
//! [`Finding::HeldBack`](crate::estimation::Finding::HeldBack) says how far from its equations. A prior that is wrong pulls what the motion
//! hardly shows, and the intervals do not know. Which of the consistent sets with the same base parameters it names says nothing of the arm.
//!
//! Sources: C. D. Sousa, R. Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix inequality
//! approach", International Journal of Robotics Research 33(6), 2014; P. M. Wensing, S. Kim, J.-J. Slotine, "Linear matrix inequalities for
//! physically consistent inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018, for pseudo-inertias; T. Lee,
//! P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Trans. Robotics 36(2), 2020,
//! section IV, for the priors.

use super::fit::{PRIOR_IN_SI, STATED_IN_SI, estimate};
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::law::LawException;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;

/// Ordinary least squares with every link a possible body.
#[derive(Clone, Copy, Debug)]
pub struct ConsistentOrdinary(Prior);

impl ConsistentOrdinary {
    /// Without a prior.
    pub const ALONE: Self = Self(Prior::None);
    /// With the Euclidean distance from the nominal set.
    pub const EUCLIDEAN: Self = Self(Prior::Euclidean);
    /// With the entropic distance from the nominal set.
    pub const ENTROPIC: Self = Self(Prior::Entropic);
    /// With the constant pullback distance from the nominal set.
    pub const PULLBACK: Self = Self(Prior::Pullback);
}

impl Estimator for ConsistentOrdinary {
    fn name(&self) -> &'static str {
        match self.0 {
            Prior::None => "pc-ols",
            Prior::Euclidean => "pc-ols-euclidean",
            Prior::Entropic => "pc-ols-entropic",
            Prior::Pullback => "pc-ols-pullback",
        }
    }

    fn summary(&self) -> &'static str {
        match self.0 {
            Prior::None => "ordinary least squares over physically consistent sets",
            Prior::Euclidean => "consistent least squares near the nominal set, by the Euclidean distance in SI",
            Prior::Entropic => "consistent least squares near the nominal set, by the entropic distance",
            Prior::Pullback => "consistent least squares near the nominal set, by the constant pullback distance",
        }
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        if self.0 != Prior::None {
            problem.nominal_for(self.name())?;
        }
        let equations = problem.factorised()?;
        let linear = LinearFit::ordinary(&equations)?;
        estimate(self.name(), &problem.with_factorisation(&equations), &linear, self.0)
    }

    fn exceptions(&self) -> &[LawException] {
        if self.0 == Prior::None { STATED_IN_SI } else { PRIOR_IN_SI }
    }
}
