//! The wrench on one body as a linear function of its ten parameters.

use crate::lanes::Lane;
use crate::spatial::{Force, LaneForce, LaneMotion, Motion, cross, sum};

/// `K(v, a)` with `K φ = I a + v ×* I v`, φ the ten parameters of one body in its frame (Atkeson, An, Hollerbach,
/// "Estimation of inertial parameters of manipulator loads and links", IJRR 5(3), 1986, eq. 12, angular part first).
///
/// ```text
/// K = [ 0   −[b]×             L(α) + [ω]× L(ω) ]      b = a_lin + ω × v_lin
/// K = [ b   [α]× + [ω]×[ω]×   0                ]      L(ω) J = J ω for the six of a symmetric J
/// ```
/// Only the blocks are stored: `b`, the 3×3 block of the first moment, and the 3×6 block of the rotational inertia.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::regressor::BodyRegressor;
/// use armid::spatial::{Inertia, Motion};
/// use nalgebra::Vector3;
/// let phi = [2.0, 0.1, -0.2, 0.3, 0.5, 0.01, -0.02, 0.6, 0.03, 0.7];
/// let v = Motion::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.5, 0.6));
/// let a = Motion::new(Vector3::new(-1.0, 2.0, 0.5), Vector3::new(0.7, -0.3, 9.0));
/// let body = Inertia::from_array(&phi);
/// let wrench = body.apply(&a) + v.cross_force(&body.apply(&v));
/// let by_k = BodyRegressor::new(&v, &a).wrench(&phi);
/// assert!((by_k.ang - wrench.ang).norm() < 1e-14 && (by_k.lin - wrench.lin).norm() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRegressor<V = f64> {
    /// Acceleration of the point at the frame's origin, `b = a_lin + ω × v_lin`.
    pub b: [V; 3],
    /// Rows of `[α]× + [ω]×[ω]×`: force per first moment.
    pub moment: [[V; 3]; 3],
    /// Rows of `L(α) + [ω]× L(ω)`: moment per rotational inertia.
    pub inertia: [[V; 6]; 3],
}

/// Weights P of the entries of K: rows of the moment, and of the force's first four columns; the rest of K is zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights<V> {
    moment: [[V; 10]; 3],
    force: [[V; 4]; 3],
}

impl<V: Lane> Weights<V> {
    /// None yet.
    #[inline(always)]
    pub(super) fn nothing(zero: V) -> Self {
        Self { moment: [[zero; 10]; 3], force: [[zero; 4]; 3] }
    }

    /// Adds `s φᵀ`.
    #[inline(always)]
    pub(super) fn add(&mut self, s: &LaneMotion<V>, phi: &[V; 10]) {
        for r in 0..3 {
            for c in 0..10 {
                self.moment[r][c] = self.moment[r][c] + s.ang[r] * phi[c];
            }
            for c in 0..4 {
                self.force[r][c] = self.force[r][c] + s.lin[r] * phi[c];
            }
        }
    }
}

impl<V: Lane> BodyRegressor<V> {
    /// The regressors of bodies with spatial velocity `v` and acceleration `a`, each in its own frame.
    #[inline(always)]
    pub fn in_lanes(v: &LaneMotion<V>, a: &LaneMotion<V>) -> Self {
        let ([x, y, z], [dx, dy, dz]) = (v.ang, a.ang);
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (xy, xz, yz) = (x * y, x * z, y * z);
        #[rustfmt::skip]
        let moment = [
            [-yy - zz, xy - dz,  xz + dy],
            [xy + dz,  -xx - zz, yz - dx],
            [xz - dy,  yz + dx,  -xx - yy],
        ];
        #[rustfmt::skip]
        let inertia = [
            [dx,  dy - xz, dz + xy, -yz, yy - zz, yz],
            [xz,  dx + yz, zz - xx, dy,  dz - xy, -xz],
            [-xy, xx - yy, dx - yz, xy,  dy + xz, dz],
        ];
        Self { b: sum(&a.lin, &cross(&v.ang, &v.lin)), moment, inertia }
    }

    /// Entry `c` of `sᵀ K`: what the parameter of number `c` of the ten contributes to the effort along the axis `s`, given in
    /// the body's frame.
    ///
    /// # Panics
    /// Unless `c` is below ten.
    #[inline(always)]
    pub fn entry(&self, s: &LaneMotion<V>, c: usize) -> V {
        let (n, f) = (&s.ang, &s.lin);
        match c {
            0 => self.b[0] * f[0] + self.b[1] * f[1] + self.b[2] * f[2],
            1..=3 => {
                // b × n, and the column of [α]× + [ω]×[ω]×.
                let (c, next, last) = (c - 1, c % 3, (c + 1) % 3);
                let k = &self.moment;
                let turned = self.b[next] * n[last] - self.b[last] * n[next];
                turned + (k[0][c] * f[0] + k[1][c] * f[1] + k[2][c] * f[2])
            }
            _ => {
                let k = &self.inertia;
                k[0][c - 4] * n[0] + k[1][c - 4] * n[1] + k[2][c - 4] * n[2]
            }
        }
    }

    /// `sᵀ K`: what the ten parameters contribute to the effort along the axis `s`, given in the body's frame.
    #[inline(always)]
    pub fn project(&self, s: &LaneMotion<V>) -> [V; 10] {
        let y = self;
        [
            y.entry(s, 0),
            y.entry(s, 1),
            y.entry(s, 2),
            y.entry(s, 3),
            y.entry(s, 4),
            y.entry(s, 5),
            y.entry(s, 6),
            y.entry(s, 7),
            y.entry(s, 8),
            y.entry(s, 9),
        ]
    }

    /// `K φ`: the wrenches on bodies with these ten parameters each.
    #[inline(always)]
    pub fn wrench_in_lanes(&self, phi: &[V; 10]) -> LaneForce<V> {
        let mut ang = cross(&[phi[1], phi[2], phi[3]], &self.b);
        let mut lin = [self.b[0] * phi[0], self.b[1] * phi[0], self.b[2] * phi[0]];
        for r in 0..3 {
            let (inertia, moment) = (&self.inertia[r], &self.moment[r]);
            let mut of_inertia = inertia[0] * phi[4];
            for c in 1..6 {
                of_inertia = of_inertia + inertia[c] * phi[4 + c];
            }
            ang[r] = ang[r] + of_inertia;
            lin[r] = lin[r] + (moment[0] * phi[1] + moment[1] * phi[2] + moment[2] * phi[3]);
        }
        LaneForce { ang, lin }
    }

    /// Slopes of `L = Σ_rc P_rc K_rc` with respect to `v` and `a`, where `v` is what this was made with.
    ///
    /// K depends on `b`, `α` and `ω` alone, quadratically on the last: `L = b̄·b + ᾱ·α + ωᵀ Q ω`.
    #[inline(always)]
    pub(super) fn pull_back(&self, p: &Weights<V>, v: &LaneMotion<V>) -> (LaneForce<V>, LaneForce<V>) {
        let (n, f) = (&p.moment, &p.force);
        let two = f[0][0].splat(2.0);
        let b = [f[0][0] + n[1][3] - n[2][2], f[1][0] + n[2][1] - n[0][3], f[2][0] + n[0][2] - n[1][1]];
        let dw = [
            f[2][2] - f[1][3] + n[0][4] + n[1][5] + n[2][6],
            f[0][3] - f[2][1] + n[0][5] + n[1][7] + n[2][8],
            f[1][1] - f[0][2] + n[0][6] + n[1][8] + n[2][9],
        ];
        let (xx, yy, zz) = (n[2][5] - n[1][6], n[0][8] - n[2][5], n[1][6] - n[0][8]);
        // Q + Qᵀ.
        let xx = two * (xx - f[1][2] - f[2][3]);
        let yy = two * (yy - f[0][1] - f[2][3]);
        let zz = two * (zz - f[0][1] - f[1][2]);
        let xy = n[0][6] - n[1][8] - n[2][4] + n[2][7] + f[0][2] + f[1][1];
        let xz = n[1][4] - n[0][5] - n[1][9] + n[2][8] + f[0][3] + f[2][1];
        let yz = n[0][9] - n[0][7] + n[1][5] - n[2][6] + f[1][3] + f[2][2];
        let w = &v.ang;
        let twice =
            [xx * w[0] + xy * w[1] + xz * w[2], xy * w[0] + yy * w[1] + yz * w[2], xz * w[0] + yz * w[1] + zz * w[2]];
        // b = a_lin + ω × v_lin.
        let by_v = LaneForce { ang: sum(&twice, &cross(&v.lin, &b)), lin: cross(&b, w) };
        (by_v, LaneForce { ang: dw, lin: b })
    }
}

impl BodyRegressor {
    /// The regressor of a body with spatial velocity `v` and acceleration `a`, in its own frame.
    #[inline]
    pub fn new(v: &Motion, a: &Motion) -> Self {
        Self::in_lanes(&v.into(), &a.into())
    }

    /// `K φ`: the wrench on a body with these ten parameters.
    #[inline]
    pub fn wrench(&self, phi: &[f64; 10]) -> Force {
        let LaneForce { ang, lin } = self.wrench_in_lanes(phi);
        Force { ang: ang.into(), lin: lin.into() }
    }
}
