//! One joint state as it arrives from a robot.

/// What a robot reports at one moment, before it is put onto the grid of a plan, and when it arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceivedState<'a> {
    /// When it was taken, s by the robot's clock.
    pub stamp_s: f64,
    /// When it arrived, s by the local monotonic clock.
    pub arrival_s: f64,
    /// How much longer it was on its way than the fastest ones, s.
    pub lateness_s: f64,
    /// Joint coordinates, rad (m); n.
    pub q: &'a [f64],
}
