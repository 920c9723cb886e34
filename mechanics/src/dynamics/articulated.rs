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

use super::chain::{ANY, Link, Links, PARALLEL, Pose, RIGHT, Twist, Wrench};
use super::symmetric::Symmetric3;
use super::turns::State;
use crate::spatial::{Force, Motion, Three};

/// The inertia of a link in its joint's frame.
#[derive(Clone, Copy, Debug)]
struct Body {
    mass: f64,
    first_moment: Vector3<f64>,
    rotational: Symmetric3,
}

impl Body {
    fn of(link: &Link) -> Self {
        let [xx, xy, xz, yy, yz, zz] = link.second;
        Self {
            mass: link.mass,
            first_moment: link.first.into(),
            rotational: Symmetric3 { xx: yy + zz, xy: -xy, xz: -xz, yy: xx + zz, yz: -yz, zz: xx + yy },
        }
    }

    /// `v ×* I v`, with `b = ω × v_lin`: `n = ω × J ω + h × b`, `f = m b + ω × (ω × h)`.
    #[inline(always)]
    fn gyroscopic(&self, v: &Motion) -> Force {
        let (h, w) = (&self.first_moment, &v.ang);
        let b = w.cross(&v.lin);
        let turning = w.cross(&w.cross(h));
        // Behind a revolute joint no mass is left.
        let force = if self.mass == 0.0 { turning } else { b * self.mass + turning };
        Force::new(w.cross(&self.rotational.times(w)) + h.cross(&b), force)
    }
}

/// `R M Rᵀ`.
#[inline(always)]
fn turn_symmetric<const TWIST: u8>(link: &Link, pose: &Pose<f64>, m: &Symmetric3) -> Symmetric3 {
    let m = m.turned_about_z(pose.sin, pose.cos);
    match TWIST {
        PARALLEL => m,
        RIGHT => Symmetric3 { xx: m.xx, xy: -m.xz, xz: m.xy, yy: m.zz, yz: -m.yz, zz: m.yy },
        _ => m.turned_about_x(link.sin, link.cos),
    }
}

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
    #[inline(always)]
    fn with_body(&self, body: &Body) -> Self {
        Self {
            a: self.a.plus(&body.rotational),
            b_sym: self.b_sym,
            b_skew: self.b_skew + body.first_moment,
            c: if body.mass == 0.0 { self.c } else { self.c.plus(&Symmetric3::scalar(body.mass)) },
        }
    }

    /// The force that a motion takes which has no z, neither angular nor linear.
    #[inline(always)]
    fn times_across(&self, [wx, wy]: [f64; 2], [vx, vy]: [f64; 2]) -> Force {
        let of = |m: &Symmetric3, x: f64, y: f64| {
            Vector3::new(m.xx * x + m.xy * y, m.xy * x + m.yy * y, m.xz * x + m.yz * y)
        };
        // k × x of such an x.
        let k = &self.b_skew;
        let skew = |x: f64, y: f64| Vector3::new(-k.z * y, k.z * x, k.x * y - k.y * x);
        Force {
            ang: (of(&self.a, wx, wy) + of(&self.b_sym, vx, vy)) + skew(vx, vy),
            lin: (of(&self.b_sym, wx, wy) - skew(wx, wy)) + of(&self.c, vx, vy),
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
    #[inline(always)]
    fn to_parent<const TWIST: u8>(self, link: &Link, pose: &Pose<f64>) -> Self {
        let a = turn_symmetric::<TWIST>(link, pose, &self.a);
        let s = turn_symmetric::<TWIST>(link, pose, &self.b_sym);
        let c = turn_symmetric::<TWIST>(link, pose, &self.c);
        let k: Vector3<f64> = pose.inward::<TWIST>(link, &self.b_skew.into()).into();
        if link.meets {
            return Self { a, b_sym: s, b_skew: k, c };
        }
        let p = Vector3::from(pose.origin);
        // x + p_z y, where there is a p_z.
        let with = |x: f64, y: f64| if TWIST == ANY { x + p.z * y } else { x };
        // e = [p]× C, by entries e_rc.
        let (exx, exy, exz) = (with(p.y * c.xz, -c.xy), with(p.y * c.yz, -c.yy), with(p.y * c.zz, -c.yz));
        let (eyx, eyy, eyz) = (with(-p.x * c.xz, c.xx), with(-p.x * c.yz, c.xy), with(-p.x * c.zz, c.xz));
        let (ezx, ezy, ezz) = (p.x * c.xy - p.y * c.xx, p.x * c.yy - p.y * c.xy, p.x * c.yz - p.y * c.xz);
        // B and B' by entries; A' = A + [p]× Bᵀ + ([p]× B'ᵀ)ᵀ read off its upper triangle.
        let (bxx, bxy, bxz) = (s.xx, s.xy - k.z, s.xz + k.y);
        let (byx, byy, byz) = (s.xy + k.z, s.yy, s.yz - k.x);
        let (bzx, bzy, bzz) = (s.xz - k.y, s.yz + k.x, s.zz);
        let (fxx, fxy, fxz) = (bxx + exx, bxy + exy, bxz + exz);
        let (fyx, fyy, fyz) = (byx + eyx, byy + eyy, byz + eyz);
        let (fzx, fzy, fzz) = (bzx + ezx, bzy + ezy, bzz + ezz);
        let a = Symmetric3 {
            xx: a.xx + with(p.y * (bxz + fxz), -(bxy + fxy)),
            yy: a.yy + with(-p.x * (byz + fyz), byx + fyx),
            zz: a.zz + (p.x * (bzy + fzy) - p.y * (bzx + fzx)),
            xy: a.xy + with(p.y * fyz - p.x * bxz, bxx - fyy),
            xz: a.xz + with((p.x * bxy - p.y * bxx) + p.y * fzz, -fzy),
            yz: a.yz + with((p.x * byy - p.y * byx) - p.x * fzz, fzx),
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

/// Inertia and bias force of all links from some one on.
type Carried = (ArticulatedInertia, Force);

/// What the recursion keeps of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArticulatedJoint {
    body: Body,
    pose: Pose<f64>,
    /// `v × S q̇`.
    c: Motion,
    /// What the motion of the link needs.
    bias: Force,
    u_column: Force,
    inverse_d: f64,
    u: f64,
}

/// For these links.
pub(super) fn workspace(links: &[Link]) -> Vec<ArticulatedJoint> {
    let joint = |link: &Link| ArticulatedJoint {
        body: Body::of(link),
        pose: Pose::nowhere(0.0),
        c: Motion::zero(),
        bias: Force::zero(),
        u_column: Force::zero(),
        inverse_d: 0.0,
        u: 0.0,
    };
    links.iter().map(joint).collect()
}

impl ArticulatedJoint {
    /// Velocity of the link before (`v`) to its own, and what that needs.
    #[inline(always)]
    fn go_out<const TWIST: u8>(&mut self, link: &Link, v: &mut Wrench<f64>, rate: f64) {
        *v = self.pose.moved::<TWIST>(link, v);
        let (w, v) = v;
        let turned = |x: &Three<f64>| Vector3::new(x[1] * rate, -x[0] * rate, 0.0);
        if link.prismatic {
            v[2] += rate;
            self.c = Motion::new(Vector3::zeros(), turned(w));
        } else {
            w[2] += rate;
            self.c = Motion::new(turned(w), turned(v));
        }
        self.bias = self.body.gyroscopic(&Motion::new((*w).into(), (*v).into()));
    }

    /// What the joint here takes of an effort, and of the inertia and the bias from here on.
    #[inline(always)]
    fn meet(&mut self, link: &Link, (inertia, bias): &Carried, rotor: f64, effort: f64) {
        let (column, along) = inertia.axis_column(!link.prismatic);
        self.u_column = column;
        self.inverse_d = 1.0 / (along + rotor);
        self.u = effort - if link.prismatic { bias.lin.z } else { bias.ang.z };
    }

    /// What is left of them, seen from the link before.
    #[inline(always)]
    fn go_in<const TWIST: u8>(&self, link: &Link, (inertia, bias): &Carried) -> Carried {
        let scaled = self.u_column * self.inverse_d;
        let projected = inertia.minus_outer(&self.u_column, &scaled);
        let moved = projected.times_across([self.c.ang.x, self.c.ang.y], [self.c.lin.x, self.c.lin.y]);
        let bias = *bias + moved + scaled * self.u;
        let (n, f) = self.pose.carry::<TWIST>(link, &(bias.ang.into(), bias.lin.into()));
        (projected.to_parent::<TWIST>(link, &self.pose), Force::new(n.into(), f.into()))
    }

    /// Acceleration of the joint, which is added to that of the link (`a`).
    #[inline(always)]
    fn accelerate(&self, link: &Link, a: &mut Motion) -> f64 {
        let found = (self.u - a.dot(&self.u_column)) * self.inverse_d;
        if link.prismatic {
            a.lin.z += found;
        } else {
            a.ang.z += found;
        }
        found
    }

    /// The same, where `a` is that of the link before.
    #[inline(always)]
    fn accelerate_after<const TWIST: u8>(&self, link: &Link, a: &mut Motion) -> f64 {
        let (w, v) = self.pose.moved::<TWIST>(link, &(a.ang.into(), a.lin.into()));
        *a = Motion::new(w.into(), v.into()) + self.c;
        self.accelerate(link, a)
    }
}

/// Turns joint efforts (n), friction already subtracted, into accelerations, in place, with rotor inertias `rotors` (n).
pub(super) fn accelerations(
    Links { links, lift }: &Links,
    work: &mut [ArticulatedJoint],
    rotors: &[f64],
    (q, qd, turns): State<'_>,
    x: &mut [f64],
) {
    let n = links.len();
    let (q, qd, x, rotors) = (&q[..n], &qd[..n], &mut x[..n], &rotors[..n]);
    let (links, work) = (&links[..n], &mut work[..n]);
    let mut v = ([0.0; 3], [0.0; 3]);
    // The first link turns about an axis that stands still, or slides along it: no bias meets its joint.
    work[0].pose = links[0].pose(q[0], turns.sine_and_cosine(0));
    if links[0].prismatic {
        v.1[2] = qd[0];
    } else {
        v.0[2] = qd[0];
    }
    for (k, (w, link)) in work.iter_mut().zip(links).enumerate().skip(1) {
        w.pose = link.pose(q[k], turns.sine_and_cosine(k));
        match link.twist {
            Twist::Any => w.go_out::<ANY>(link, &mut v, qd[k]),
            Twist::Parallel => w.go_out::<PARALLEL>(link, &mut v, qd[k]),
            Twist::Right => w.go_out::<RIGHT>(link, &mut v, qd[k]),
        }
    }
    let mut carried = (ArticulatedInertia::ZERO, Force::zero());
    for k in (1..n).rev() {
        let (own, link) = (&mut work[k], &links[k]);
        carried = (carried.0.with_body(&own.body), carried.1 + own.bias);
        own.meet(link, &carried, rotors[k], x[k]);
        carried = match link.twist {
            Twist::Any => own.go_in::<ANY>(link, &carried),
            Twist::Parallel => own.go_in::<PARALLEL>(link, &carried),
            Twist::Right => own.go_in::<RIGHT>(link, &carried),
        };
    }
    carried.0 = carried.0.with_body(&work[0].body);
    work[0].meet(&links[0], &carried, rotors[0], x[0]);
    let mut a = Motion::new(Vector3::zeros(), work[0].pose.turn_back(lift).into());
    x[0] = work[0].accelerate(&links[0], &mut a);
    for ((w, link), x) in work.iter().zip(links).zip(x).skip(1) {
        *x = match link.twist {
            Twist::Any => w.accelerate_after::<ANY>(link, &mut a),
            Twist::Parallel => w.accelerate_after::<PARALLEL>(link, &mut a),
            Twist::Right => w.accelerate_after::<RIGHT>(link, &mut a),
        };
    }
}
