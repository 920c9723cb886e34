//! Ordinary least squares over physically consistent sets.
//!
//! ```text
//! min_φ ‖y − W K φ‖²        over consistent φ
//! ```
//! Its optimum is that of the semidefinite program, found along a barrier's path. Where the ordinary
//! solution is consistent, it is that.
//!
//! Assumes what `ols` does, and links that are rigid bodies. Fails where torque that the model lacks pushes the equations out of
//! what bodies can have: the estimate then lies on the boundary, and [`Finding::HeldBack`](crate::estimation::Finding::HeldBack)
//! says how far from its equations. Which of the consistent sets with the same base parameters it names says nothing of the arm.
//!
//! Sources: C. D. Sousa, R. Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix inequality
//! approach", International Journal of Robotics Research 33(6), 2014; P. M. Wensing, S. Kim, J.-J. Slotine, "Linear matrix inequalities for
//! physically consistent inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018, for pseudo-inertias.

use super::fit::{STATED_IN_SI, ordinary};
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::law::LawException;
use crate::estimation::problem::EstimationProblem;

/// Ordinary least squares with every link a possible body.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConsistentOrdinary;

impl Estimator for ConsistentOrdinary {
    fn name(&self) -> &'static str {
        "pc-ols"
    }

    fn summary(&self) -> &'static str {
        "ordinary least squares over physically consistent sets"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        ordinary(self.name(), problem, Prior::None)
    }

    fn exceptions(&self) -> &[LawException] {
        STATED_IN_SI
    }
}
