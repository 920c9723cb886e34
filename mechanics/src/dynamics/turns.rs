//! Sines and cosines of all joints of one state.

use super::chain::Link;
use crate::lanes::sines_and_cosines;

/// Angles of all joints about their axes, with their sines and cosines, n each.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    angles: Vec<f64>,
    sines: Vec<f64>,
    cosines: Vec<f64>,
}

/// Positions, velocities (n each), and the sines and cosines of the positions.
pub(super) type State<'a> = (&'a [f64], &'a [f64], &'a Turns);

impl Turns {
    /// Of n joints.
    pub(super) fn new(n: usize) -> Self {
        Self { angles: vec![0.0; n], sines: vec![0.0; n], cosines: vec![1.0; n] }
    }

    /// Takes the positions `q` (n): one evaluation for as many joints as the processor has lanes.
    #[inline(always)]
    pub(super) fn take(&mut self, links: &[Link], q: &[f64]) {
        for ((angle, link), q) in self.angles.iter_mut().zip(links).zip(q) {
            *angle = link.angle(*q);
        }
        sines_and_cosines(&self.angles, &mut self.sines, &mut self.cosines);
    }

    /// Sine and cosine of joint k.
    #[inline(always)]
    pub(super) fn sine_and_cosine(&self, k: usize) -> (f64, f64) {
        (self.sines[k], self.cosines[k])
    }
}
