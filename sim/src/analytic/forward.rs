//! Forward dynamics in one pass out and one pass in: bias forces, composite inertias and the mass matrix together.
//!
//! ```text
//! H(q) q̈ = τ − friction(q, q̇) − c(q, q̇) − g(q)
//! ```
//! Out: velocities, accelerations without q̈, and the forces they need, with `U = [ω̇]× + [ω]×²` so that a point `x` of
//! a link accelerates by `a + U x`; a link needs `f = m a + U m c` and `n = m c × a + vee(U Σ − Σ Uᵀ)`. In: forces and
//! composite inertias go to the frame before; the force that accelerates joint k alone travels inwards and leaves
//! `H_jk` at every joint j. Then `H = L D Lᵀ`.
//!
//! Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, tables 5.1 and 6.2.

use super::chain::{Chain, Link, Twist};
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

/// `H = L D Lᵀ`: `L` below the diagonal, and the reciprocals of `D`.
#[derive(Clone, Copy)]
pub(crate) struct Factor<const N: usize, V> {
    lower: [[V; N]; N],
    reciprocal: [V; N],
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
    let f = inward::<TWIST, V>(link, pose, f);
    (add(inward::<TWIST, V>(link, pose, n), cross(pose.origin, f)), f)
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
    let rotated = inward::<TWIST, V>(link, pose, of.first);
    let p = pose.origin;
    let mass = pose.sin.splat(link.outboard);
    let half = pose.sin.splat(0.5 * link.outboard);
    let k = [rotated[0] + half * p[0], rotated[1] + half * p[1], rotated[2] + half * p[2]];
    let two = pose.sin.splat(2.0);
    let shifted = [
        xx + two * k[0] * p[0],
        xy + (k[0] * p[1] + k[1] * p[0]),
        xz + (k[0] * p[2] + k[2] * p[0]),
        yy + two * k[1] * p[1],
        yz + (k[1] * p[2] + k[2] * p[1]),
        zz + two * k[2] * p[2],
    ];
    for j in 0..6 {
        to.second[j] = to.second[j] + shifted[j];
    }
    for j in 0..3 {
        to.first[j] = to.first[j] + (rotated[j] + mass * p[j]);
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

#[inline(always)]
fn apply<V: Lane>(u: &[Three<V>; 3], x: &Three<V>) -> Three<V> {
    let row = |j: usize| u[j][0] * x[0] + u[j][1] * x[1] + u[j][2] * x[2];
    [row(0), row(1), row(2)]
}

impl<V: Lane> Outward<V> {
    /// Goes on to the next link, and gives the moment and the force that its motion needs.
    #[inline(always)]
    fn next<const TWIST: u8>(&mut self, link: &Link, pose: &Pose<V>, v: V) -> (Three<V>, Three<V>) {
        self.a = add(self.a, apply(&self.u, &pose.origin));
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
        let Moments { first: h, second: s } = moments(v, link);
        let mass = v.splat(link.mass);
        let turning = apply(&u, &h);
        let needed = |j: usize| mass * self.a[j] + turning[j];
        let force = [needed(0), needed(1), needed(2)];
        let rows = [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]];
        let product = |j: usize, k: usize| u[j][0] * rows[k][0] + u[j][1] * rows[k][1] + u[j][2] * rows[k][2];
        let spin = [product(2, 1) - product(1, 2), product(0, 2) - product(2, 0), product(1, 0) - product(0, 1)];
        (add(cross(h, self.a), spin), force)
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
        Self { bias: [zero; N], factor: Factor { lower: [[zero; N]; N], reciprocal: [zero; N] } }
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
        // The base does not turn.
        let mut outward = Outward { w: none, wd: none, a: splat(one, &self.lift), u: [none; 3] };
        for i in 0..N {
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
        let mut matrix = [[zero; N]; N];
        let mut inward =
            Inward { n: none, f: none, carried: moments(one, &links[N - 1]), column_n: [none; N], column_f: [none; N] };
        for i in (0..N).rev() {
            let link = &links[i];
            inward.n = add(inward.n, torques[i]);
            inward.f = add(inward.f, forces[i]);
            let (h, s) = (inward.carried.first, inward.carried.second);
            (inward.column_n[i], inward.column_f[i]) = if link.prismatic {
                ([h[1], -h[0], zero], [zero, zero, one.splat(link.outboard)])
            } else {
                ([-s[2], -s[4], s[0] + s[3]], [-h[1], h[0], zero])
            };
            let along = |n: &Three<V>, f: &Three<V>| if link.prismatic { f[2] } else { n[2] };
            bias[i] = along(&inward.n, &inward.f);
            for k in i..N {
                matrix[k][i] = along(&inward.column_n[k], &inward.column_f[k]) + one.splat(self.rotors[k][i]);
            }
            if i > 0 {
                let (pose, before) = (&poses[i], moments(one, &links[i - 1]));
                match link.twist {
                    Twist::Any => inward.next::<ANY>(i, link, pose, before),
                    Twist::Parallel => inward.next::<PARALLEL>(i, link, pose, before),
                    Twist::Right => inward.next::<RIGHT>(i, link, pose, before),
                }
            }
        }
        (taken, Rigid { bias, factor: Factor::new(&matrix) })
    }
}

impl<const N: usize> Factor<N, f64> {
    /// Whether the matrix is positive definite.
    pub(crate) fn is_positive(&self) -> bool {
        self.reciprocal.iter().all(|d| d.is_finite() && *d > 0.0)
    }

    /// `H⁻¹ X` in place, X of N rows of `d` numbers.
    #[inline(always)]
    pub(crate) fn solve_rows(&self, x: &mut [f64], d: usize) {
        for j in 1..N {
            let (before, own) = x.split_at_mut(j * d);
            for k in 0..j {
                let lower = self.lower[j][k];
                for (own, before) in own[..d].iter_mut().zip(&before[k * d..(k + 1) * d]) {
                    *own -= lower * before;
                }
            }
        }
        for j in (0..N).rev() {
            let (own, after) = x[j * d..].split_at_mut(d);
            for own in own.iter_mut() {
                *own *= self.reciprocal[j];
            }
            for k in j + 1..N {
                let lower = self.lower[k][j];
                for (own, after) in own.iter_mut().zip(&after[(k - j - 1) * d..(k - j) * d]) {
                    *own -= lower * after;
                }
            }
        }
    }
}

impl<const N: usize, V: Lane> Factor<N, V> {
    /// Factors a symmetric positive definite matrix of which only the lower triangle is read.
    #[inline(always)]
    fn new(matrix: &[[V; N]; N]) -> Self {
        let zero = matrix[0][0].splat(0.0);
        let mut lower = [[zero; N]; N];
        let mut reciprocal = [zero; N];
        for j in 0..N {
            // Row j of L D.
            let mut scaled = [zero; N];
            let mut d = matrix[j][j];
            for k in 0..j {
                let mut x = matrix[j][k];
                for l in 0..k {
                    x = x - scaled[l] * lower[k][l];
                }
                scaled[k] = x;
                lower[j][k] = x * reciprocal[k];
                d = d - x * lower[j][k];
            }
            reciprocal[j] = d.reciprocal();
        }
        Self { lower, reciprocal }
    }

    /// Returns this factor in other numbers.
    #[inline(always)]
    pub(crate) fn map<U: Copy>(&self, of: impl Fn(V) -> U) -> Factor<N, U> {
        Factor {
            lower: std::array::from_fn(|i| std::array::from_fn(|j| of(self.lower[i][j]))),
            reciprocal: std::array::from_fn(|i| of(self.reciprocal[i])),
        }
    }

    /// `H⁻¹`.
    #[inline(always)]
    pub(crate) fn inverse(&self) -> [[V; N]; N] {
        let (zero, one) = (self.reciprocal[0].splat(0.0), self.reciprocal[0].splat(1.0));
        let mut columns = [[zero; N]; N];
        for j in 0..N {
            columns[j][j] = one;
            columns[j] = self.solve(columns[j]);
        }
        columns
    }

    #[inline(always)]
    fn solve(&self, mut x: [V; N]) -> [V; N] {
        for j in 1..N {
            for k in 0..j {
                x[j] = x[j] - self.lower[j][k] * x[k];
            }
        }
        for j in (0..N).rev() {
            x[j] = x[j] * self.reciprocal[j];
            for k in j + 1..N {
                x[j] = x[j] - self.lower[k][j] * x[k];
            }
        }
        x
    }
}
