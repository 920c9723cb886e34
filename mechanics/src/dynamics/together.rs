//! Samples that are worked on together, each in its place.

use crate::trajectory::States;

/// Samples, or blocks of them, that are worked on together: a whole number of lanes of any processor.
pub(crate) const TOGETHER: usize = 8;

/// One sample of each of the blocks that are worked on, joint by joint.
pub(crate) struct Together {
    pub(crate) q: Vec<[f64; TOGETHER]>,
    pub(crate) qd: Vec<[f64; TOGETHER]>,
    pub(crate) qdd: Vec<[f64; TOGETHER]>,
}

impl Together {
    /// Of n joints.
    pub(crate) fn new(n: usize) -> Self {
        let zeros = vec![[0.0; TOGETHER]; n];
        Self { q: zeros.clone(), qd: zeros.clone(), qdd: zeros }
    }

    /// The samples `first`, `first + step`, …, `count` of them; the last again in the places beyond.
    pub(crate) fn fill(&mut self, states: &States, first: usize, step: usize, count: usize) {
        for lane in 0..TOGETHER {
            let k = first + lane.min(count - 1) * step;
            for (to, from) in [(&mut self.q, states.q(k)), (&mut self.qd, states.qd(k)), (&mut self.qdd, states.qdd(k))]
            {
                for (to, &from) in to.iter_mut().zip(from) {
                    to[lane] = from;
                }
            }
        }
    }
}
