//! The axes of the joints so far, seen from the current link, two to a lane pair.

use crate::spatial::{Motion, Placement};

/// Two axes side by side: each component as a pair, so that both move in the same instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisPair {
    ang: [[f64; 2]; 3],
    lin: [[f64; 2]; 3],
}

impl AxisPair {
    pub(super) const ZERO: Self = Self { ang: [[0.0; 2]; 3], lin: [[0.0; 2]; 3] };

    /// Stores an axis in one half.
    #[inline]
    fn set(&mut self, half: usize, axis: &Motion) {
        for r in 0..3 {
            self.ang[r][half] = axis.ang[r];
            self.lin[r][half] = axis.lin[r];
        }
    }

    /// The axis in one half.
    #[inline]
    fn get(&self, half: usize) -> Motion {
        let take = |x: &[[f64; 2]; 3]| nalgebra::Vector3::new(x[0][half], x[1][half], x[2][half]);
        Motion { ang: take(&self.ang), lin: take(&self.lin) }
    }

    /// `ω' = Rᵀω`, `v' = Rᵀ(v + ω × p)`.
    #[inline]
    fn carry(&mut self, x: &Placement) {
        let (r, p) = (&x.rotation, &x.translation);
        let turn = |x: &[[f64; 2]; 3]| -> [[f64; 2]; 3] {
            std::array::from_fn(|c| pair(|h| r[(0, c)] * x[0][h] + r[(1, c)] * x[1][h] + r[(2, c)] * x[2][h]))
        };
        let (w, v) = (&self.ang, &self.lin);
        let moved = [
            pair(|h| v[0][h] + (w[1][h] * p.z - w[2][h] * p.y)),
            pair(|h| v[1][h] + (w[2][h] * p.x - w[0][h] * p.z)),
            pair(|h| v[2][h] + (w[0][h] * p.y - w[1][h] * p.x)),
        ];
        (self.ang, self.lin) = (turn(w), turn(&moved));
    }
}

#[inline(always)]
fn pair(f: impl Fn(usize) -> f64) -> [f64; 2] {
    [f(0), f(1)]
}

/// Carries the first `count` axes from one link to the next and puts the next joint's axis beside them.
#[inline]
pub(super) fn carry_axes(pairs: &mut [AxisPair], count: usize, x: &Placement, axis: &Motion) {
    for pair in &mut pairs[..count.div_ceil(2)] {
        pair.carry(x);
    }
    pairs[count / 2].set(count % 2, axis);
}

/// The first `count` axes.
#[inline]
pub(super) fn axes(pairs: &[AxisPair], count: usize) -> impl Iterator<Item = Motion> + '_ {
    (0..count).map(|i| pairs[i / 2].get(i % 2))
}
