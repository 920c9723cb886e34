//! Forward dynamics in one pass out and one pass in: bias forces, composite inertias and the mass matrix together.
//!
//! ```text
//! H(q) q̈ = τ − friction(q, q̇) − c(q, q̇) − g(q)
//! ```
//! Out: velocities, accelerations without q̈, and the forces they need, with `U = [ω̇]× + [ω]×²` so that a point `x` of
//! a link accelerates by `a + U x`; a link needs `f = m a + U m c` and `n = m c × a + vee(U Σ − Σ Uᵀ)`. In: forces and
//! composite inertias go to the frame before; the force that accelerates joint k alone travels inwards and leaves
//! `H_jk` at every joint j. What is zero for every state is left out: moments along a revolute joint's axis
//! ([`Link`]), shifts between axes that meet, and what the base does not do.
//!
//! Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, tables 5.1 and 6.2.

use super::chain::{Chain, Link, Twist};
use super::factor::Factor;
use armid::lanes::{Lane, sines};

type Three<V> = [V; 3];

/// Values of [`Twist`] that a function can be compiled for.
const ANY: u8 = 0;
const PARALLEL: u8 = 1;
const RIGHT: u8 = 2;

/// Where a link's frame stands: sine and cosine of its turn about z, and its origin in the frame before.
#[derive(Clone, Copy)]
struct Pose<V> {
    sin: V,
    cos: V,
    origin: Three<V>,
}

#[inline(always)]
fn add<V: Lane>(a: Three<V>, b: Three<V>) -> Three<V> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn cross<V: Lane>(a: Three<V>, b: Three<V>) -> Three<V> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn splat<V: Lane>(one: V, a: &[f64; 3]) -> Three<V> {
    [one.splat(a[0]), one.splat(a[1]), one.splat(a[2])]
}

#[inline(always)]
fn moments<V: Lane>(one: V, link: &Link) -> Moments<V> {
    let s = &link.second;
    Moments {
        first: splat(one, &link.first),
        second: [one.splat(s[0]), one.splat(s[1]), one.splat(s[2]), one.splat(s[3]), one.splat(s[4]), one.splat(s[5])],
    }
}

/// A vector of the frame before, in the link's frame: `Rzᵀ Rxᵀ v`.
#[inline(always)]
fn outward<const TWIST: u8, V: Lane>(link: &Link, pose: &Pose<V>, v: Three<V>) -> Three<V> {
    let (y, z) = match TWIST {
        PARALLEL => (v[1], v[2]),
        RIGHT => (v[2], -v[1]),
        _ => {
            let (sa, ca) = (pose.sin.splat(link.sin), pose.sin.splat(link.cos));
            (ca * v[1] + sa * v[2], ca * v[2] - sa * v[1])
        }
    };
    [pose.cos * v[0] + pose.sin * y, pose.cos * y - pose.sin * v[0], z]
}

/// A vector of the link's frame, in the frame before: `Rx Rz v`.
#[inline(always)]
fn inward<const TWIST: u8, V: Lane>(link: &Link, pose: &Pose<V>, v: Three<V>) -> Three<V> {
    let x = pose.cos * v[0] - pose.sin * v[1];
    let y = pose.sin * v[0] + pose.cos * v[1];
    match TWIST {
        PARALLEL => [x, y, v[2]],
        RIGHT => [x, -v[2], y],
        _ => {
            let (sa, ca) = (pose.sin.splat(link.sin), pose.sin.splat(link.cos));
            [x, ca * y - sa * v[2], sa * y + ca * v[2]]
        }
    }
}

/// A force `(n, f)` about the link's origin, about the origin of the frame before and in its axes.
#[inline(always)]
fn carry<const TWIST: u8, V: Lane>(link: &Link, pose: &Pose<V>, n: Three<V>, f: Three<V>) -> (Three<V>, Three<V>) {
    let (n, f) = (inward::<TWIST, V>(link, pose, n), inward::<TWIST, V>(link, pose, f));
    if link.meets {
        return (n, f);
    }
    let p = pose.origin;
    let arm = if TWIST == ANY { cross(p, f) } else { [p[1] * f[2], -(p[0] * f[2]), p[0] * f[1] - p[1] * f[0]] };
    (add(n, arm), f)
}

/// Rotates the plane (a, b; b, d) of a symmetric matrix.
#[inline(always)]
fn turn<V: Lane>(sin: V, cos: V, a: V, b: V, d: V) -> (V, V, V) {
    let w = cos * (a - d) - sin * (b + b);
    (d + cos * w, b + sin * w, a - cos * w)
}

/// First and second moments of what a link carries.
#[derive(Clone, Copy)]
struct Moments<V> {
    first: Three<V>,
    second: [V; 6],
}

/// Moments about the link's origin, about the origin of the frame before and in its axes, added to `to`.
#[inline(always)]
fn gather<const TWIST: u8, V: Lane>(link: &Link, pose: &Pose<V>, of: &Moments<V>, to: &mut Moments<V>) {
    let [xx, xy, xz, yy, yz, zz] = of.second;
    let (xx, xy, yy) = turn(pose.sin, pose.cos, xx, xy, yy);
    let (xz, yz) = (pose.cos * xz - pose.sin * yz, pose.sin * xz + pose.cos * yz);
    let [xy, xz, yy, yz, zz] = match TWIST {
        PARALLEL => [xy, xz, yy, yz, zz],
        RIGHT => [-xz, xy, zz, -yz, yy],
        _ => {
            let (sa, ca) = (pose.sin.splat(link.sin), pose.sin.splat(link.cos));
            let (yy, yz, zz) = turn(sa, ca, yy, yz, zz);
            [ca * xy - sa * xz, sa * xy + ca * xz, yy, yz, zz]
        }
    };
    let mut first = inward::<TWIST, V>(link, pose, of.first);
    let mut second = [xx, xy, xz, yy, yz, zz];
    if !link.meets {
        let p = pose.origin;
        let mut k = first;
        if link.outboard != 0.0 {
            let (mass, half) = (pose.sin.splat(link.outboard), pose.sin.splat(0.5 * link.outboard));
            for j in 0..3 {
                k[j] = first[j] + half * p[j];
                first[j] = first[j] + mass * p[j];
            }
        }
        let two = pose.sin.splat(2.0);
        second[0] = xx + two * k[0] * p[0];
        second[1] = xy + (k[0] * p[1] + k[1] * p[0]);
        second[3] = yy + two * k[1] * p[1];
        if TWIST == ANY {
            second[2] = xz + (k[0] * p[2] + k[2] * p[0]);
            second[4] = yz + (k[1] * p[2] + k[2] * p[1]);
            second[5] = zz + two * k[2] * p[2];
        } else {
            second[2] = xz + k[2] * p[0];
            second[4] = yz + k[2] * p[1];
        }
    }
    for j in 0..6 {
        to.second[j] = to.second[j] + second[j];
    }
    for j in 0..3 {
        to.first[j] = to.first[j] + first[j];
    }
}

/// Motion of the link that the sweep outwards has come to.
struct Outward<V> {
    /// Angular velocity and acceleration.
    w: Three<V>,
    wd: Three<V>,
    /// Acceleration of the frame's origin, less gravity.
    a: Three<V>,
    /// `[ω̇]× + [ω]×²`.
    u: [Three<V>; 3],
}

impl<V: Lane> Outward<V> {
    /// The first link, behind a base that does not turn, and the effort that its own motion needs.
    #[inline(always)]
    fn first(link: &Link, pose: &Pose<V>, v: V, lift: &[f64; 3]) -> (Self, V) {
        let zero = v.splat(0.0);
        let none = [zero; 3];
        let a = outward::<PARALLEL, V>(link, pose, splat(v, lift));
        if link.prismatic {
            return (Self { w: none, wd: none, a, u: [none; 3] }, v.splat(link.mass) * a[2]);
        }
        let square = -(v * v);
        let u = [[square, zero, zero], [zero, square, zero], none];
        let effort = v.splat(link.first[0]) * a[1] - v.splat(link.first[1]) * a[0];
        (Self { w: [zero, zero, v], wd: none, a, u }, effort)
    }

    /// Goes on to the next link, and gives the moment and the force that its motion needs.
    #[inline(always)]
    fn next<const TWIST: u8>(&mut self, link: &Link, pose: &Pose<V>, v: V) -> (Three<V>, Three<V>) {
        if !link.meets {
            let (u, p) = (&self.u, &pose.origin);
            for j in 0..3 {
                let mut moved = u[j][0] * p[0] + u[j][1] * p[1];
                if TWIST == ANY {
                    moved = moved + u[j][2] * p[2];
                }
                self.a[j] = self.a[j] + moved;
            }
        }
        self.a = outward::<TWIST, V>(link, pose, self.a);
        self.w = outward::<TWIST, V>(link, pose, self.w);
        self.wd = outward::<TWIST, V>(link, pose, self.wd);
        let Self { w, wd, a, .. } = self;
        if link.prismatic {
            let twice = v + v;
            a[0] = a[0] + w[1] * twice;
            a[1] = a[1] - w[0] * twice;
        } else {
            wd[0] = wd[0] + w[1] * v;
            wd[1] = wd[1] - w[0] * v;
            w[2] = w[2] + v;
        }
        let (xx, yy, zz) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        let u = [
            [-(yy + zz), xy - wd[2], xz + wd[1]],
            [xy + wd[2], -(xx + zz), yz - wd[0]],
            [xz - wd[1], yz + wd[0], -(xx + yy)],
        ];
        self.u = u;
        let a = &self.a;
        let Moments { first: h, second: s } = moments(v, link);
        // Rows of U Σ, whose last column has no Σ_zz behind a revolute joint, and of U m c.
        let row = |x: &Three<V>, y: &Three<V>| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let short = |x: &Three<V>, y: &Three<V>| x[0] * y[0] + x[1] * y[1];
        let rows = [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]];
        let mut force = [short(&u[0], &h), short(&u[1], &h), short(&u[2], &h)];
        let (mut yz, mut xz) = (short(&u[1], &rows[2]), short(&u[0], &rows[2]));
        let (yx, xy) = (row(&u[1], &rows[0]), row(&u[0], &rows[1]));
        let (zx, zy) = (row(&u[2], &rows[0]), row(&u[2], &rows[1]));
        let mut moment = [h[1] * a[2], -(h[0] * a[2]), h[0] * a[1] - h[1] * a[0]];
        if link.prismatic {
            let mass = v.splat(link.mass);
            for j in 0..3 {
                force[j] = force[j] + (u[j][2] * h[2] + mass * a[j]);
            }
            (yz, xz) = (yz + u[1][2] * s[5], xz + u[0][2] * s[5]);
            (moment[0], moment[1]) = (moment[0] - h[2] * a[1], moment[1] + h[2] * a[0]);
        }
        (add(moment, [zy - yz, xz - zx, yx - xy]), force)
    }
}

/// What the sweep inwards carries from frame to frame.
struct Inward<const N: usize, V> {
    /// Moment and force that the motion of all links from here on needs.
    n: Three<V>,
    f: Three<V>,
    carried: Moments<V>,
    /// Moment and force that accelerate joint k alone, for every k from here on.
    column_n: [Three<V>; N],
    column_f: [Three<V>; N],
}

impl<const N: usize, V: Lane> Inward<N, V> {
    /// Expresses everything in the frame before link `i` and takes in `before`, the moments of the link there.
    #[inline(always)]
    fn next<const TWIST: u8>(&mut self, i: usize, link: &Link, pose: &Pose<V>, before: Moments<V>) {
        (self.n, self.f) = carry::<TWIST, V>(link, pose, self.n, self.f);
        for k in i..N {
            (self.column_n[k], self.column_f[k]) = carry::<TWIST, V>(link, pose, self.column_n[k], self.column_f[k]);
        }
        let mut next = before;
        gather::<TWIST, V>(link, pose, &self.carried, &mut next);
        self.carried = next;
    }
}

/// The rigid part of the equations of motion in one state.
#[derive(Clone, Copy)]
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

    /// Efforts `tau` less the bias.
    #[inline(always)]
    pub(crate) fn free(&self, tau: &[V; N]) -> [V; N] {
        let mut out = *tau;
        for i in 0..N {
            out[i] = tau[i] - self.bias[i];
        }
        out
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

impl<const N: usize> Chain<N> {
    /// Accelerations of the joints of one arm, and the rigid part of its equations, compiled once.
    #[inline(never)]
    pub(crate) fn accelerate_alone(&self, q: &[f64; N], v: &[f64; N], tau: &[f64; N]) -> ([f64; N], Rigid<N, f64>) {
        let (taken, rigid) = self.parts(q, v);
        (rigid.accelerations(tau, &taken), rigid)
    }

    /// Efforts that friction takes at `q` and `v`, and the rigid part there.
    #[inline(always)]
    pub(crate) fn parts<V: Lane>(&self, q: &[V; N], v: &[V; N]) -> ([V; N], Rigid<N, V>) {
        self.sweep::<V, true>(q, v)
    }

    /// The rigid part at `q` and `v`.
    #[inline(always)]
    pub(crate) fn rigid<V: Lane>(&self, q: &[V; N], v: &[V; N]) -> Rigid<N, V> {
        self.sweep::<V, false>(q, v).1
    }

    /// Both, or no friction.
    #[inline(always)]
    fn sweep<V: Lane, const FRICTION: bool>(&self, q: &[V; N], v: &[V; N]) -> ([V; N], Rigid<N, V>) {
        let one = q[0];
        let zero = one.splat(0.0);
        let none = [zero; 3];
        let links = &self.links;
        let mut angles = *q;
        for i in 0..N {
            let offset = one.splat(links[i].offset);
            angles[i] = if links[i].prismatic { offset } else { q[i] + offset };
        }
        let sines = sines(&angles);
        let mut poses = [Pose { sin: zero, cos: zero, origin: none }; N];
        for i in 0..N {
            let mut origin = splat(one, &links[i].origin);
            if links[i].prismatic {
                origin[1] = origin[1] - one.splat(links[i].sin) * q[i];
                origin[2] = origin[2] + one.splat(links[i].cos) * q[i];
            }
            poses[i] = Pose { sin: sines[i].0, cos: sines[i].1, origin };
        }
        let (mut forces, mut torques) = ([none; N], [none; N]);
        let (mut outward, effort) = Outward::first(&links[0], &poses[0], v[0], &self.lift);
        for i in 1..N {
            let (link, pose) = (&links[i], &poses[i]);
            (torques[i], forces[i]) = match link.twist {
                Twist::Any => outward.next::<ANY>(link, pose, v[i]),
                Twist::Parallel => outward.next::<PARALLEL>(link, pose, v[i]),
                Twist::Right => outward.next::<RIGHT>(link, pose, v[i]),
            };
        }
        // Here, between the sweeps, it waits for neither.
        let taken = if FRICTION { self.forces.torque(q, v) } else { [zero; N] };
        let mut bias = [zero; N];
        let mut factor = Factor::nothing(zero);
        let mut inward =
            Inward { n: none, f: none, carried: moments(one, &links[N - 1]), column_n: [none; N], column_f: [none; N] };
        for i in (0..N).rev() {
            let link = &links[i];
            if i > 0 {
                inward.n = add(inward.n, torques[i]);
                inward.f = add(inward.f, forces[i]);
            }
            let (h, s) = (inward.carried.first, inward.carried.second);
            (inward.column_n[i], inward.column_f[i]) = if link.prismatic {
                ([h[1], -h[0], zero], [zero, zero, one.splat(link.outboard)])
            } else {
                ([-s[2], -s[4], s[0] + s[3]], [-h[1], h[0], zero])
            };
            let along = |n: &Three<V>, f: &Three<V>| if link.prismatic { f[2] } else { n[2] };
            bias[i] = along(&inward.n, &inward.f);
            if i == 0 {
                bias[i] = bias[i] + effort;
            }
            let mut row = [zero; N];
            for k in i..N {
                row[k] = along(&inward.column_n[k], &inward.column_f[k]) + one.splat(self.rotors[k][i]);
            }
            // Here, where the sweep does not wait for it.
            factor.take_row(i, &row);
            if i > 0 {
                let (pose, before) = (&poses[i], moments(one, &links[i - 1]));
                match link.twist {
                    Twist::Any => inward.next::<ANY>(i, link, pose, before),
                    Twist::Parallel => inward.next::<PARALLEL>(i, link, pose, before),
                    Twist::Right => inward.next::<RIGHT>(i, link, pose, before),
                }
            }
        }
        (taken, Rigid { bias, factor })
    }
}
