//! One sample as an arm hands it on.

use super::phase::Phase;

/// What the sensors say at one moment, and what was asked for. All slices have length n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawSample<'a> {
    /// Position in the experiment, from zero.
    pub index: usize,
    /// Time since the beginning of the experiment, s.
    pub t: f64,
    /// What the arm is doing.
    pub phase: Phase,
    /// Joint coordinates from the encoders, rad (m).
    pub q: &'a [f64],
    /// What the robot reports as effort: motor currents, A, or joint torques, N·m (N).
    pub effort: &'a [f64],
    /// Voltages at the motors' terminals, V; empty where the interface gives none.
    pub voltage: &'a [f64],
    /// Positions behind the transmissions, rad (m); empty where no encoder is there.
    pub link_q: &'a [f64],
    /// Commanded joint coordinates, rad (m).
    pub command: &'a [f64],
}
