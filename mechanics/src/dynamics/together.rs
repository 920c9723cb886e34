//! Samples that are worked on together, each in its place.

/// Samples, or blocks of them, that are worked on together: a whole number of lanes of any processor.
pub(crate) const TOGETHER: usize = 8;

/// How many samples of `dof` joints these positions, velocities and accelerations are, N × n each.
///
/// # Panics
/// If they are not as many, or not whole samples.
pub(crate) fn samples_of(dof: usize, samples: [&[f64]; 3]) -> usize {
    let [q, qd, qdd] = samples.map(<[f64]>::len);
    assert!(
        q == qd && q == qdd && q % dof == 0,
        "{q} positions, {qd} velocities and {qdd} accelerations, expected as many of each, for {dof} joints"
    );
    q / dof
}

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
    pub(crate) fn fill(&mut self, samples: [&[f64]; 3], first: usize, step: usize, count: usize) {
        // The usual numbers of joints, whole and one after the other, with loops of known length.
        match (self.q.len(), step, count) {
            (6, 1, TOGETHER) => return self.transpose::<6>(samples, first),
            (7, 1, TOGETHER) => return self.transpose::<7>(samples, first),
            _ => {}
        }
        let n = self.q.len();
        for lane in 0..TOGETHER {
            let k = first + lane.min(count - 1) * step;
            for (to, from) in [&mut self.q, &mut self.qd, &mut self.qdd].into_iter().zip(samples) {
                for (to, &from) in to.iter_mut().zip(&from[k * n..(k + 1) * n]) {
                    to[lane] = from;
                }
            }
        }
    }

    #[inline(always)]
    fn transpose<const N: usize>(&mut self, samples: [&[f64]; 3], first: usize) {
        for (to, from) in [&mut self.q, &mut self.qd, &mut self.qdd].into_iter().zip(samples) {
            let from = from.as_chunks::<N>().0[first..].first_chunk::<TOGETHER>().expect("as many samples");
            for (j, to) in to.iter_mut().enumerate().take(N) {
                for lane in 0..TOGETHER {
                    to[lane] = from[lane][j];
                }
            }
        }
    }
}
