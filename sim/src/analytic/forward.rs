//! Forward dynamics in one pass out and one pass in: bias forces, composite inertias and the mass matrix together.
//!
//! ```text
//! H(q) q̈ = τ − friction(q, q̇) − c(q, q̇) − g(q)
//! ```
//! The sweeps are those of [`armid::dynamics::chain`]. Rows of the mass matrix are factored as they are found.

use armid::dynamics::chain::{Inward, Outward, Pose, Wrench};
use armid::lanes::{Lane, Sines};

use super::chain::Chain;
use super::factor::Factor;

/// The rigid part of the equations of motion in one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rigid<const N: usize, V> {
    /// Efforts that the motion takes without any acceleration, `c + g`.
    bias: [V; N],
    /// Of the mass matrix.
    pub(crate) factor: Factor<N, V>,
}

impl<const N: usize, V: Lane> Rigid<N, V> {
    /// No bias and no masses, before there is one.
    #[inline(always)]
    pub(crate) fn nothing(zero: V) -> Self {
        Self { bias: [zero; N], factor: Factor::nothing(zero) }
    }

    /// The same in other numbers.
    #[inline(always)]
    pub(crate) fn map<U: Copy>(&self, of: impl Fn(V) -> U + Copy) -> Rigid<N, U> {
        Rigid { bias: self.bias.map(of), factor: self.factor.map(of) }
    }

    /// Efforts `tau` less the bias, into `out`.
    #[inline(always)]
    pub(crate) fn free(&self, tau: &[V; N], out: &mut [V; N]) {
        for i in 0..N {
            out[i] = tau[i] - self.bias[i];
        }
    }

    /// Accelerations under efforts `tau`, of which friction takes `taken`.
    #[inline(always)]
    pub(crate) fn accelerations(&self, tau: &[V; N], taken: &[V; N]) -> [V; N] {
        let mut right = *tau;
        for i in 0..N {
            right[i] = tau[i] - taken[i] - self.bias[i];
        }
        self.factor.solve(right)
    }
}

/// What the sweeps keep of each link, and the rigid part that they find. It is room for many evaluations: to clear it for each of them
/// takes a tenth of their time.
#[derive(Clone, Debug)]
pub(crate) struct Room<const N: usize, V> {
    poses: [Pose<V>; N],
    wrenches: [Wrench<V>; N],
    columns: [Wrench<V>; N],
    pub(crate) rigid: Rigid<N, V>,
    /// Efforts that friction takes.
    pub(crate) taken: [V; N],
}

impl<const N: usize, V: Lane> Room<N, V> {
    /// Before the first.
    #[inline(always)]
    pub(crate) fn nothing(zero: V) -> Self {
        let none = ([zero; 3], [zero; 3]);
        let poses = [Pose::nowhere(zero); N];
        Self { poses, wrenches: [none; N], columns: [none; N], rigid: Rigid::nothing(zero), taken: [zero; N] }
    }
}

impl<const N: usize> Chain<N> {
    /// Accelerations of the joints of one arm, and in `room` the rigid part of its equations; compiled once.
    #[inline(never)]
    pub(crate) fn accelerate_alone(
        &self,
        q: &[f64; N],
        v: &[f64; N],
        tau: &[f64; N],
        room: &mut Room<N, f64>,
    ) -> [f64; N] {
        self.parts(q, v, room, true);
        room.rigid.accelerations(tau, &room.taken)
    }

    /// The rigid part at `q` and `v`.
    #[inline(always)]
    pub(crate) fn rigid<V: Sines>(&self, q: &[V; N], v: &[V; N]) -> Rigid<N, V> {
        let mut room = Room::nothing(q[0].splat(0.0));
        self.sweep::<V, false>(q, v, &mut room, false);
        room.rigid
    }

    /// The rigid part at `q` and `v`, and what friction takes there, where that is asked for: both are then in `room`, since a call would copy them.
    #[inline(always)]
    pub(crate) fn parts<V: Sines>(&self, q: &[V; N], v: &[V; N], room: &mut Room<N, V>, friction: bool) {
        self.sweep::<V, true>(q, v, room, friction);
    }

    /// The rigid part, and friction where it is asked for.
    #[inline(always)]
    fn sweep<V: Sines, const FRICTION: bool>(
        &self,
        q: &[V; N],
        v: &[V; N],
        Room { poses, wrenches, columns, rigid: Rigid { bias, factor }, taken }: &mut Room<N, V>,
        friction: bool,
    ) {
        let one = q[0];
        let zero = one.splat(0.0);
        let links = &self.links;
        let mut angles = *q;
        for i in 0..N {
            angles[i] = links[i].angle(q[i]);
        }
        let sines = V::sines(&angles);
        for i in 0..N {
            poses[i] = links[i].pose(q[i], sines[i]);
        }
        let (mut outward, effort) = Outward::first(&links[0], &poses[0], v[0], None, &self.lift);
        for i in 1..N {
            wrenches[i] = outward.next(&links[i], &poses[i], v[i], None);
        }
        // Here, between the sweeps, it waits for neither.
        if FRICTION && friction {
            self.forces.torque(q, v, taken);
        }
        let mut row = [zero; N];
        let mut inward = Inward::begin(one, &links[N - 1]);
        for i in (0..N).rev() {
            let link = &links[i];
            // The first has none but its effort.
            if i > 0 {
                inward.take(&wrenches[i]);
            }
            columns[i] = inward.column(link);
            bias[i] = inward.effort(link);
            for k in i..N {
                row[k] = link.along(&columns[k]) + one.splat(self.rotors[k][i]);
            }
            // Here, where the sweep does not wait for it.
            factor.take_row(i, &mut row);
            if i > 0 {
                inward.next(link, &poses[i], &links[i - 1], &mut columns[i..]);
            }
        }
        bias[0] = bias[0] + effort;
    }
}
