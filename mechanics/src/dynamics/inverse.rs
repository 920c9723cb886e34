//! Recursive Newton–Euler over the links, of one sample or of several at once.

use pulp::{Arch, Simd, WithSimd};

use super::joint_frames::{JointChain, JointPose};
use super::together::{TOGETHER, Together, samples_of};
use crate::lanes::{Lane, Wide, sin_cos};
use crate::spatial::{LaneForce, LaneMotion, sum};

/// Pose of a joint's frame, and the force that its link takes.
pub(super) type Carried<V> = (JointPose<V>, LaneForce<V>);

/// For n joints; `zero` says of how many samples.
#[inline(always)]
pub(super) fn workspace<V: Lane>(n: usize, zero: V) -> Vec<Carried<V>> {
    vec![(JointPose::nowhere(zero), LaneForce { ang: [zero; 3], lin: [zero; 3] }); n]
}

/// Efforts that the links take. `state` gives coordinate, velocity and acceleration of a joint, and sine and cosine of its angle; `put`
/// takes its effort, from the last joint to the first.
#[inline(always)]
pub(super) fn efforts<V: Lane>(
    chain: &JointChain,
    carried: &mut [Carried<V>],
    state: impl Fn(usize) -> ([V; 3], (V, V)),
    mut put: impl FnMut(usize, V),
) {
    let Some((first, _)) = carried.first() else { return };
    let zero = first.zero();
    let gravity = &chain.base_acceleration;
    let mut v = LaneMotion { ang: [zero; 3], lin: [zero; 3] };
    let mut a = LaneMotion { lin: [zero.splat(gravity.x), zero.splat(gravity.y), zero.splat(gravity.z)], ..v };
    let steps = carried.iter_mut().zip(chain.joints.iter().zip(&chain.bodies));
    for (i, ((pose, force), (joint, body))) in steps.enumerate() {
        let ([q, qd, qdd], turn) = state(i);
        *pose = joint.pose(q, turn);
        (v, a) = joint.moved((pose.in_child(&v), pose.in_child(&a)), qd, qdd);
        *force = body.lane_wrench(&v, &a);
    }
    let mut f = LaneForce { ang: [zero; 3], lin: [zero; 3] };
    for (i, ((pose, force), joint)) in carried.iter().zip(&chain.joints).enumerate().rev() {
        f = LaneForce { ang: sum(&f.ang, &force.ang), lin: sum(&f.lin, &force.lin) };
        put(i, joint.effort(&f));
        f = pose.in_parent(&f);
    }
}

/// Efforts of many samples, N × n row-major.
pub(super) fn efforts_of(chain: &JointChain, samples: [&[f64]; 3], tau: &mut [f64]) {
    Arch::new().dispatch(Efforts { chain, samples, tau });
}

struct Efforts<'a> {
    chain: &'a JointChain,
    samples: [&'a [f64]; 3],
    tau: &'a mut [f64],
}

impl WithSimd for Efforts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { chain, samples, tau } = self;
        let n = chain.joints.len();
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
                        ([q, at(&state.qd, k), at(&state.qdd, k)], sin_cos(chain.joints[k].angle(q)))
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
        let chain = JointChain::new(&robot, &parameters.links);
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
