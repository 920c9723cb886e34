//! Recursive Newton–Euler over the links, of one sample or of several at once.

use pulp::{Arch, Simd, WithSimd};

use super::chain::{Links, Outward, Pose, Wrench};
use super::together::{TOGETHER, Together, samples_of};
use crate::lanes::{Lane, Wide, sin_cos};
use crate::spatial::sum;

/// Pose of a link's frame, and what the link's motion needs.
pub(super) type Carried<V> = (Pose<V>, Wrench<V>);

/// For n joints; `zero` says of how many samples.
#[inline(always)]
pub(super) fn workspace<V: Lane>(n: usize, zero: V) -> Vec<Carried<V>> {
    vec![(Pose::nowhere(zero), ([zero; 3], [zero; 3])); n]
}

/// Efforts that the links take. `state` gives coordinate, velocity and acceleration of a joint, and sine and cosine of its angle; `put`
/// takes its effort, from the last joint to the first.
#[inline(always)]
pub(super) fn efforts<V: Lane>(
    Links { links, lift }: &Links,
    carried: &mut [Carried<V>],
    state: impl Fn(usize) -> ([V; 3], (V, V)),
    mut put: impl FnMut(usize, V),
) {
    let n = links.len();
    let (links, carried) = (&links[..n], &mut carried[..n]);
    let ([q, qd, qdd], turn) = state(0);
    let nothing = [qd.splat(0.0); 3];
    let (mut outward, effort) = Outward::first(&links[0], &links[0].pose(q, turn), qd, Some(qdd), lift);
    for i in 1..n {
        let ([q, qd, qdd], turn) = state(i);
        let pose = links[i].pose(q, turn);
        carried[i] = (pose, outward.next(&links[i], &pose, qd, Some(qdd)));
    }
    let mut needed = (nothing, nothing);
    for i in (1..n).rev() {
        let (pose, (n, f)) = &carried[i];
        needed = (sum(&needed.0, n), sum(&needed.1, f));
        put(i, links[i].along(&needed));
        needed = pose.to_parent(&links[i], &needed);
    }
    put(0, links[0].along(&needed) + effort);
}

/// Efforts of many samples, N × n row-major.
pub(super) fn efforts_of(chain: &Links, samples: [&[f64]; 3], tau: &mut [f64]) {
    Arch::new().dispatch(Efforts { chain, samples, tau });
}

struct Efforts<'a> {
    chain: &'a Links,
    samples: [&'a [f64]; 3],
    tau: &'a mut [f64],
}

impl WithSimd for Efforts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { chain, samples, tau } = self;
        let n = chain.links.len();
        let mut state = Together::new(n);
        let mut carried = workspace(n, Wide::new(simd, simd.splat_f64s(0.0)));
        let mut found = vec![[0.0; TOGETHER]; n];
        let all = samples_of(n, samples);
        for first in (0..all).step_by(TOGETHER) {
            let count = TOGETHER.min(all - first);
            state.fill(samples, first, 1, count);
            for vector in 0..TOGETHER / S::F64_LANES {
                let at = |x: &[[f64; TOGETHER]], k: usize| Wide::new(simd, S::as_simd_f64s(&x[k]).0[vector]);
                efforts(
                    chain,
                    &mut carried,
                    #[inline(always)]
                    |k| {
                        let q = at(&state.q, k);
                        ([q, at(&state.qd, k), at(&state.qdd, k)], sin_cos(chain.links[k].angle(q)))
                    },
                    #[inline(always)]
                    |k, effort| S::as_mut_simd_f64s(&mut found[k]).0[vector] = effort.x,
                );
            }
            for (lane, tau) in tau[first * n..].chunks_exact_mut(n).take(count).enumerate() {
                for (tau, found) in tau.iter_mut().zip(&found) {
                    *tau = found[lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::seed::Seed;
    use crate::trajectory::States;

    #[test]
    fn identity_one_lane_has_the_bits_of_all() {
        let mut rng = Seed::new(18).stream("chains", 0);
        let (robot, parameters) = ChainRecipe::new(7).draw(&mut rng);
        let chain = Links::new(&robot, &parameters.links);
        let mut states = States::new(7);
        for _ in 0..19 {
            let (q, qd, qdd) = chains::random_state(&mut rng, 7);
            states.push(&q, &qd, &qdd);
        }
        let [mut wide, mut narrow] = [vec![0.0; 19 * 7], vec![f64::NAN; 19 * 7]];
        efforts_of(&chain, states.arrays(), &mut wide);
        Arch::Scalar.dispatch(Efforts { chain: &chain, samples: states.arrays(), tau: &mut narrow });
        assert_eq!(wide, narrow);
    }
}
