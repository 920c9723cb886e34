//! Why no source code can be made.

/// Why no source code can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum CodegenError {
    /// Base parameters of another number than the base has.
    #[error("{found} base parameters, expected {expected}")]
    Count { found: usize, expected: usize },
    /// A base of another robot.
    #[error("base parameter {parameter} is of a joint that a robot of {dof} joints does not have")]
    OtherRobot { parameter: String, dof: usize },
    /// A torque term whose law is not written.
    #[error(
        "parameter {parameter} belongs to a torque term that is not written, expected rotor inertia, viscous or Coulomb friction, friction of the load, offset"
    )]
    Term { parameter: String },
}
