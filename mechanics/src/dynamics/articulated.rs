//! Forward dynamics by articulated bodies (Featherstone, table 7.1), in joint frames.
//!
//! ```text
//! U = I^A S,  D = SᵀU + Ia,  u = τ − Sᵀ p^A
//! I^a = I^A − U Uᵀ / D,      p^a = p^A + I^a c + U u / D,      I^A_parent += X* I^a X,  p^A_parent += X* p^a
//! ```
//! The rotor inertia `Ia` stands between the two links of its joint and adds to `D` alone; the articulated inertia is
//! kept as `[A B; Bᵀ C]`, angular first, with `B` split into its symmetric part and a cross product, so that all of
//! it turns cheaply.

use nalgebra::Vector3;

use super::joint_frames::{Body, JointChain, JointPose, State};
use super::symmetric::Symmetric3;
use crate::spatial::{Force, Motion};

/// `[A B; Bᵀ C]` with `B = sym + [skew]×`: moment `A ω + B v`, force `Bᵀ ω + C v`.
#[derive(Clone, Copy, Debug)]
struct ArticulatedInertia {
    a: Symmetric3,
    b_sym: Symmetric3,
    b_skew: Vector3<f64>,
    c: Symmetric3,
}

impl ArticulatedInertia {
    const ZERO: Self =
        Self { a: Symmetric3::ZERO, b_sym: Symmetric3::ZERO, b_skew: Vector3::new(0.0, 0.0, 0.0), c: Symmetric3::ZERO };

    /// Adds a rigid body: `A = J`, `B = [h]×`, `C = m 1`.
    #[inline]
    fn add_body(&mut self, body: &Body) {
        self.a = self.a.plus(&body.rotational);
        self.b_skew += body.first_moment;
        self.c = self.c.plus(&Symmetric3::scalar(body.mass));
    }

    #[inline]
    fn add(&mut self, o: &Self) {
        self.a = self.a.plus(&o.a);
        self.b_sym = self.b_sym.plus(&o.b_sym);
        self.b_skew += o.b_skew;
        self.c = self.c.plus(&o.c);
    }

    #[inline]
    fn times(&self, m: &Motion) -> Force {
        Force {
            ang: self.a.times(&m.ang) + self.b_sym.times(&m.lin) + self.b_skew.cross(&m.lin),
            lin: self.b_sym.times(&m.ang) - self.b_skew.cross(&m.ang) + self.c.times(&m.lin),
        }
    }

    /// The column `U = I^A S` of a joint about (or along) z, and `SᵀU`.
    #[inline]
    fn axis_column(&self, revolute: bool) -> (Force, f64) {
        let (s, k) = (&self.b_sym, &self.b_skew);
        if revolute {
            let ang = Vector3::new(self.a.xz, self.a.yz, self.a.zz);
            (Force::new(ang, Vector3::new(s.xz - k.y, s.yz + k.x, s.zz)), self.a.zz)
        } else {
            let lin = Vector3::new(self.c.xz, self.c.yz, self.c.zz);
            (Force::new(Vector3::new(s.xz + k.y, s.yz - k.x, s.zz), lin), self.c.zz)
        }
    }

    /// `I − U Wᵀ` with `W` parallel to `U`.
    #[inline]
    fn minus_outer(&self, u: &Force, w: &Force) -> Self {
        // B − U_ang W_linᵀ, by symmetric and skew part: [x × y]× = y xᵀ − x yᵀ.
        let (x, y) = (&u.ang, &w.lin);
        let (xy, yx, xz, zx, yz, zy) = (x.x * y.y, x.y * y.x, x.x * y.z, x.z * y.x, x.y * y.z, x.z * y.y);
        let b = &self.b_sym;
        Self {
            a: self.a.minus_outer(&u.ang, &w.ang),
            b_sym: Symmetric3 {
                xx: b.xx - x.x * y.x,
                yy: b.yy - x.y * y.y,
                zz: b.zz - x.z * y.z,
                xy: b.xy - 0.5 * (xy + yx),
                xz: b.xz - 0.5 * (xz + zx),
                yz: b.yz - 0.5 * (yz + zy),
            },
            b_skew: self.b_skew + Vector3::new(yz - zy, zx - xz, xy - yx) * 0.5,
            c: self.c.minus_outer(&u.lin, &w.lin),
        }
    }

    /// Seen from the parent: turned, then moved by p: `C' = C`, `B' = B + [p]× C`, `A' = A − B [p]× + [p]× B'ᵀ`.
    #[inline]
    fn to_parent(self, pose: &JointPose) -> Self {
        let p = pose.origin();
        let a = pose.turn_symmetric(&self.a);
        let s = pose.turn_symmetric(&self.b_sym);
        let k = pose.turn_out(&self.b_skew);
        let c = pose.turn_symmetric(&self.c);
        // e = [p]× C, by entries e_rc.
        let (exx, exy, exz) = (p.y * c.xz - p.z * c.xy, p.y * c.yz - p.z * c.yy, p.y * c.zz - p.z * c.yz);
        let (eyx, eyy, eyz) = (p.z * c.xx - p.x * c.xz, p.z * c.xy - p.x * c.yz, p.z * c.xz - p.x * c.zz);
        let (ezx, ezy, ezz) = (p.x * c.xy - p.y * c.xx, p.x * c.yy - p.y * c.xy, p.x * c.yz - p.y * c.xz);
        // B and B' by entries; A' = A + [p]× Bᵀ + ([p]× B'ᵀ)ᵀ read off its upper triangle.
        let (bxx, bxy, bxz) = (s.xx, s.xy - k.z, s.xz + k.y);
        let (byx, byy, byz) = (s.xy + k.z, s.yy, s.yz - k.x);
        let (bzx, bzy, bzz) = (s.xz - k.y, s.yz + k.x, s.zz);
        let (fxx, fxy, fxz) = (bxx + exx, bxy + exy, bxz + exz);
        let (fyx, fyy, fyz) = (byx + eyx, byy + eyy, byz + eyz);
        let (fzx, fzy, fzz) = (bzx + ezx, bzy + ezy, bzz + ezz);
        let a = Symmetric3 {
            xx: a.xx + (p.y * (bxz + fxz) - p.z * (bxy + fxy)),
            yy: a.yy + (p.z * (byx + fyx) - p.x * (byz + fyz)),
            zz: a.zz + (p.x * (bzy + fzy) - p.y * (bzx + fzx)),
            xy: a.xy + (p.z * bxx - p.x * bxz) + (p.y * fyz - p.z * fyy),
            xz: a.xz + (p.x * bxy - p.y * bxx) + (p.y * fzz - p.z * fzy),
            yz: a.yz + (p.x * byy - p.y * byx) + (p.z * fzx - p.x * fzz),
        };
        Self {
            a,
            b_sym: Symmetric3 {
                xx: fxx,
                yy: fyy,
                zz: fzz,
                xy: 0.5 * (fxy + fyx),
                xz: 0.5 * (fxz + fzx),
                yz: 0.5 * (fyz + fzy),
            },
            b_skew: Vector3::new(fzy - fyz, fxz - fzx, fyx - fxy) * 0.5,
            c,
        }
    }
}

/// What the recursion keeps of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArticulatedJoint {
    pose: JointPose,
    /// `v × S q̇`.
    c: Motion,
    inertia: ArticulatedInertia,
    bias: Force,
    u_column: Force,
    inverse_d: f64,
    u: f64,
}

/// Workspace for `n` joints.
pub(super) fn workspace(chain: &JointChain) -> Vec<ArticulatedJoint> {
    let joint = ArticulatedJoint {
        pose: JointPose::nowhere(0.0),
        c: Motion::zero(),
        inertia: ArticulatedInertia::ZERO,
        bias: Force::zero(),
        u_column: Force::zero(),
        inverse_d: 0.0,
        u: 0.0,
    };
    vec![joint; chain.joints.len()]
}

/// Turns joint efforts (n), friction already subtracted, into accelerations, in place, with rotor inertias `rotors` (n).
pub(super) fn accelerations(
    chain: &JointChain,
    work: &mut [ArticulatedJoint],
    rotors: &[f64],
    (q, qd, turns): State<'_>,
    x: &mut [f64],
) {
    let n = chain.joints.len();
    let (q, qd, x, rotors) = (&q[..n], &qd[..n], &mut x[..n], &rotors[..n]);
    let work = &mut work[..n];
    let mut v = Motion::zero();
    for (k, (joint, body)) in chain.joints.iter().zip(&chain.bodies).enumerate() {
        let w = &mut work[k];
        w.pose = joint.pose(q[k], turns.sine_and_cosine(k));
        v = w.pose.motion_to_child(&v);
        let rate = qd[k];
        if joint.revolute {
            v.ang.z += rate;
            w.c = Motion::new(
                Vector3::new(v.ang.y * rate, -v.ang.x * rate, 0.0),
                Vector3::new(v.lin.y * rate, -v.lin.x * rate, 0.0),
            );
        } else {
            v.lin.z += rate;
            w.c = Motion::new(Vector3::zeros(), Vector3::new(v.ang.y * rate, -v.ang.x * rate, 0.0));
        }
        w.bias = body.wrench(&v, &Motion::zero());
        w.inertia = ArticulatedInertia::ZERO;
        w.inertia.add_body(body);
    }
    for k in (0..n).rev() {
        let revolute = chain.joints[k].revolute;
        let w = &mut work[k];
        let (column, along) = w.inertia.axis_column(revolute);
        w.u_column = column;
        w.inverse_d = 1.0 / (along + rotors[k]);
        w.u = x[k] - if revolute { w.bias.ang.z } else { w.bias.lin.z };
        if k > 0 {
            let scaled = column * w.inverse_d;
            let projected = w.inertia.minus_outer(&column, &scaled);
            let bias = w.bias + projected.times(&w.c) + scaled * w.u;
            let inertia = projected.to_parent(&w.pose);
            let bias = w.pose.force_to_parent(&bias);
            work[k - 1].inertia.add(&inertia);
            work[k - 1].bias += bias;
        }
    }
    let mut a = Motion::new(Vector3::zeros(), chain.base_acceleration);
    for (k, w) in work.iter().enumerate() {
        a = w.pose.motion_to_child(&a) + w.c;
        x[k] = (w.u - a.dot(&w.u_column)) * w.inverse_d;
        if chain.joints[k].revolute {
            a.ang.z += x[k];
        } else {
            a.lin.z += x[k];
        }
    }
}
