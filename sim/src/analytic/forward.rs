//! Forward dynamics in one pass out and one pass in: bias forces, composite inertias and the mass matrix together.
//!
//! ```text
//! M(q) q̈ = τ − h(q, q̇) − friction(q̇)
//! ```
//! Out: velocities, accelerations without q̈, and the forces they need, with `U = [ω̇]× + [ω]×²` so that a point `x` of
//! a link accelerates by `a + U x`; a link needs `f = m a + U m c` and `n = m c × a + vee(U Σ − Σ Uᵀ)`. In: forces and
//! composite inertias go to the frame before; the force that accelerates joint k alone travels inwards and leaves
//! `M_jk` at every joint j. Then `M = L D Lᵀ`.
//!
//! Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, tables 5.1 and 6.2.

use super::chain::{Chain, Link};
use super::elementary::sin_cos;
use super::lane::Lane;

type Three<V> = [V; 3];

/// Where a link's frame stands: sine and cosine of its turn about z, and its origin in the frame before.
#[derive(Clone, Copy)]
struct Pose<V> {
    sin: V,
    cos: V,
    origin: Three<V>,
}

/// `M = L D Lᵀ`: `L` below the diagonal, and the reciprocals of `D`.
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
fn splat<V: Lane>(a: &[f64; 3]) -> Three<V> {
    [V::splat(a[0]), V::splat(a[1]), V::splat(a[2])]
}

/// A vector of the frame before, in the link's frame: `Rzᵀ Rxᵀ v`.
#[inline(always)]
fn outward<V: Lane>(link: &Link, pose: &Pose<V>, v: Three<V>) -> Three<V> {
    let (sa, ca) = (V::splat(link.sin), V::splat(link.cos));
    let y = ca * v[1] + sa * v[2];
    let z = ca * v[2] - sa * v[1];
    [pose.cos * v[0] + pose.sin * y, pose.cos * y - pose.sin * v[0], z]
}

/// A vector of the link's frame, in the frame before: `Rx Rz v`.
#[inline(always)]
fn inward<V: Lane>(link: &Link, pose: &Pose<V>, v: Three<V>) -> Three<V> {
    let (sa, ca) = (V::splat(link.sin), V::splat(link.cos));
    let x = pose.cos * v[0] - pose.sin * v[1];
    let y = pose.sin * v[0] + pose.cos * v[1];
    [x, ca * y - sa * v[2], sa * y + ca * v[2]]
}

/// A force `(n, f)` about the link's origin, about the origin of the frame before and in its axes.
#[inline(always)]
fn carry<V: Lane>(link: &Link, pose: &Pose<V>, n: Three<V>, f: Three<V>) -> (Three<V>, Three<V>) {
    let f = inward(link, pose, f);
    (add(inward(link, pose, n), cross(pose.origin, f)), f)
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
fn gather<V: Lane>(link: &Link, pose: &Pose<V>, of: &Moments<V>, to: &mut Moments<V>) {
    let (sa, ca) = (V::splat(link.sin), V::splat(link.cos));
    let [xx, xy, xz, yy, yz, zz] = of.second;
    let (xx, xy, yy) = turn(pose.sin, pose.cos, xx, xy, yy);
    let (xz, yz) = (pose.cos * xz - pose.sin * yz, pose.sin * xz + pose.cos * yz);
    let (yy, yz, zz) = turn(sa, ca, yy, yz, zz);
    let (xy, xz) = (ca * xy - sa * xz, sa * xy + ca * xz);
    let rotated = inward(link, pose, of.first);
    let p = pose.origin;
    let mass = V::splat(link.outboard);
    let half = V::splat(0.5 * link.outboard);
    let k = [rotated[0] + half * p[0], rotated[1] + half * p[1], rotated[2] + half * p[2]];
    let two = V::splat(2.0);
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

impl<const N: usize> Chain<N> {
    /// Accelerations of the joints, and the factor of the mass matrix at `q`.
    #[inline(always)]
    pub(crate) fn accelerate<V: Lane>(&self, q: &[V; N], v: &[V; N], tau: &[V; N]) -> ([V; N], Factor<N, V>) {
        let zero = V::splat(0.0);
        let none = [zero; 3];
        let mut poses = [Pose { sin: zero, cos: zero, origin: none }; N];
        let (mut forces, mut moments) = ([none; N], [none; N]);
        let (mut w, mut wd, mut a) = (none, none, splat(&self.lift));
        // U of the link before; the base does not turn.
        let mut u = [none; 3];
        for i in 0..N {
            let link = &self.links[i];
            let mut origin = splat(&link.origin);
            let pose = if link.prismatic {
                origin[1] = origin[1] - V::splat(link.sin) * q[i];
                origin[2] = origin[2] + V::splat(link.cos) * q[i];
                let (sin, cos) = sin_cos(V::splat(link.offset));
                Pose { sin, cos, origin }
            } else {
                let (sin, cos) = sin_cos(q[i] + V::splat(link.offset));
                Pose { sin, cos, origin }
            };
            poses[i] = pose;
            if i > 0 {
                for j in 0..3 {
                    a[j] = a[j] + (u[j][0] * origin[0] + u[j][1] * origin[1] + u[j][2] * origin[2]);
                }
            }
            a = outward(link, &pose, a);
            w = outward(link, &pose, w);
            wd = outward(link, &pose, wd);
            if link.prismatic {
                let twice = v[i] + v[i];
                a[0] = a[0] + w[1] * twice;
                a[1] = a[1] - w[0] * twice;
            } else {
                wd[0] = wd[0] + w[1] * v[i];
                wd[1] = wd[1] - w[0] * v[i];
                w[2] = w[2] + v[i];
            }
            let (xx, yy, zz) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
            let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
            u = [
                [-(yy + zz), xy - wd[2], xz + wd[1]],
                [xy + wd[2], -(xx + zz), yz - wd[0]],
                [xz - wd[1], yz + wd[0], -(xx + yy)],
            ];
            let h: Three<V> = splat(&link.first);
            let mass = V::splat(link.mass);
            for j in 0..3 {
                forces[i][j] = mass * a[j] + (u[j][0] * h[0] + u[j][1] * h[1] + u[j][2] * h[2]);
            }
            let s = link.second.map(V::splat);
            let rows = [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]];
            let product = |j: usize, k: usize| u[j][0] * rows[k][0] + u[j][1] * rows[k][1] + u[j][2] * rows[k][2];
            let spin = [product(2, 1) - product(1, 2), product(0, 2) - product(2, 0), product(1, 0) - product(0, 1)];
            moments[i] = add(cross(h, a), spin);
        }
        let friction = self.friction.torque(v);
        let mut right = [zero; N];
        let mut matrix = [[zero; N]; N];
        let own = |link: &Link| Moments { first: splat(&link.first), second: link.second.map(V::splat) };
        let mut carried = own(&self.links[N - 1]);
        let (mut column_n, mut column_f) = ([none; N], [none; N]);
        let (mut n, mut f) = (none, none);
        for i in (0..N).rev() {
            let link = &self.links[i];
            n = add(n, moments[i]);
            f = add(f, forces[i]);
            let h = carried.first;
            let s = carried.second;
            (column_n[i], column_f[i]) = if link.prismatic {
                ([h[1], -h[0], zero], [zero, zero, V::splat(link.outboard)])
            } else {
                ([-s[2], -s[4], s[0] + s[3]], [-h[1], h[0], zero])
            };
            let along = |n: &Three<V>, f: &Three<V>| if link.prismatic { f[2] } else { n[2] };
            right[i] = tau[i] - friction[i] - along(&n, &f);
            for k in i..N {
                matrix[k][i] = along(&column_n[k], &column_f[k]) + V::splat(self.rotors[k][i]);
            }
            if i > 0 {
                let pose = &poses[i];
                (n, f) = carry(link, pose, n, f);
                for k in i..N {
                    (column_n[k], column_f[k]) = carry(link, pose, column_n[k], column_f[k]);
                }
                let mut next = own(&self.links[i - 1]);
                gather(link, pose, &carried, &mut next);
                carried = next;
            }
        }
        let factor = Factor::new(&matrix);
        (factor.solve(right), factor)
    }
}

impl<const N: usize, V: Lane> Factor<N, V> {
    /// Factors a symmetric positive definite matrix of which only the lower triangle is read.
    #[inline(always)]
    fn new(matrix: &[[V; N]; N]) -> Self {
        let zero = V::splat(0.0);
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

impl<const N: usize> Factor<N, f64> {
    /// The inverse of the factored matrix.
    pub(crate) fn inverse(&self) -> [[f64; N]; N] {
        std::array::from_fn(|j| {
            let mut unit = [0.0; N];
            unit[j] = 1.0;
            self.solve(unit)
        })
    }
}
