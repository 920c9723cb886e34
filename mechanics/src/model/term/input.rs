//! What a torque law may depend on.

use super::number::{Number, Scale};

/// The largest number of shape parameters of one law.
pub const MOST_SHAPES: usize = 2;

/// The shape parameters of one law, in the order of its term's entry; zero beyond its own.
pub type Shapes = [Scale; 2];

/// One coordinate, of a joint or a motor, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermInput<R> {
    /// Position, rad (m).
    pub q: R,
    /// Velocity, rad/s (m/s).
    pub qd: R,
    /// Acceleration, rad/s² (m/s²).
    pub qdd: R,
    /// Torque that the links take of this coordinate, `M_l q̈ + c + g` without any term, N·m (N). Only where the term's
    /// entry says that it needs it; else 0.
    pub load: R,
    /// Temperature above that of a cold gear, as a share of the rise at its rated power, 0 to 1. Only where the term's
    /// entry says that it needs it; else 0.
    pub warmth: R,
    /// The law's shape parameters, in the order of the term's entry.
    pub shape: Shapes,
}

impl TermInput<f64> {
    /// A block of this one alone.
    pub fn block(&self) -> TermBlock<'_> {
        use std::slice::from_ref;
        TermBlock {
            q: from_ref(&self.q),
            qd: from_ref(&self.qd),
            qdd: from_ref(&self.qdd),
            load: from_ref(&self.load),
            warmth: from_ref(&self.warmth),
            shape: from_ref(&self.shape),
        }
    }
}

/// Input of several coordinates or samples: slices of one length. `load` and `warmth` may be empty where no law
/// needs them.
#[derive(Clone, Copy, Debug)]
pub struct TermBlock<'a> {
    /// Positions.
    pub q: &'a [f64],
    /// Velocities.
    pub qd: &'a [f64],
    /// Accelerations.
    pub qdd: &'a [f64],
    /// Transmitted torques.
    pub load: &'a [f64],
    /// Temperatures.
    pub warmth: &'a [f64],
    /// Shape parameters.
    pub shape: &'a [Shapes],
}

impl TermBlock<'_> {
    /// Entry `k`.
    ///
    /// # Panics
    /// If there is no such entry.
    #[inline(always)]
    pub fn entry(&self, k: usize) -> TermInput<f64> {
        TermInput {
            q: self.q[k],
            qd: self.qd[k],
            qdd: self.qdd[k],
            load: if self.load.is_empty() { 0.0 } else { self.load[k] },
            warmth: if self.warmth.is_empty() { 0.0 } else { self.warmth[k] },
            shape: self.shape[k],
        }
    }
}

/// A number of each of several runs.
pub trait Runs: Number {
    /// A law that is written for single samples, run by run.
    fn apart(input: &TermInput<Self>, law: impl FnMut(&TermInput<f64>) -> f64) -> Self;
}
