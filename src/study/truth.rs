//! The true parameters of a simulated arm: read by the simulator and the scoring, out of reach for everything above.

use crate::model::{Columns, Robot, StandardParameters};
use nalgebra::DVector;

/// What a simulation is made of and an estimate is scored against.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Inertia, rotor, friction and offset of every link and joint.
    pub parameters: StandardParameters,
}

impl Truth {
    /// The vector φ of these columns, length p.
    #[must_use]
    pub fn vector(&self, robot: &Robot, columns: Columns) -> DVector<f64> {
        self.parameters.vector(robot, columns)
    }
}
