//! The three derivatives of a motion that its limits are stated for.

/// Which of the three derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// q.
    Position,
    /// q̇.
    Velocity,
    /// q̈.
    Acceleration,
}

impl Quantity {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Acceleration];
}
