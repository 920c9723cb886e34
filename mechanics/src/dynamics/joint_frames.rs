//! The chain seen from frames that stand on the joints, where rotations are cheap.
//!
//! Any two consecutive joint axes are related by `Rz(γ) Rx(α) Rz(θ)` and a translation. The frame on joint k may be
//! turned about its own axis, so `γ` of the next joint is absorbed there, and for every robot in any convention,
//!
//! ```text
//! T_k(q) = Tr(p_k) Rx(α_k) Rz(θ_k + q)            S_k = (ẑ, 0)      revolute
//! T_k(q) = Tr(p_k) Rx(α_k) Tz(q) Rz(θ_k)          S_k = (0, ẑ)      prismatic
//! ```
//! A vector then turns with 8 products and a symmetric matrix with 16, where full rotation matrices take 9 and 45
//! (Featherstone, appendix A.4, for the same idea). Efforts and accelerations of joints do not depend on the frames.
//! Where axes are parallel, at right angles or meet, the products that are zero are left out.

use nalgebra::{Matrix3, Vector3};

use super::symmetric::Symmetric3;
use crate::lanes::{Lane, sines_and_cosines};
use crate::model::{JointKind, Robot};
use crate::spatial::{Force, Inertia, LaneForce, LaneMotion, Motion, Placement, Three, cross, sum};

/// The angle between two joint axes, where it saves work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Twist {
    /// Any angle.
    Any,
    /// α = 0.
    Parallel,
    /// α = 90°.
    Right,
}

/// One joint in the form of the module's header.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointFrame {
    pub(super) revolute: bool,
    /// `θ`, rad.
    offset: f64,
    twist: Twist,
    sin_alpha: f64,
    cos_alpha: f64,
    /// `p`, m.
    origin: Vector3<f64>,
    /// Whether `p` is zero at every coordinate.
    meets: bool,
}

/// Where a joint's frame stands in the one before, at some coordinate, of one sample or of several.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointPose<V = f64> {
    sin: V,
    cos: V,
    twist: Twist,
    sin_alpha: V,
    cos_alpha: V,
    origin: Three<V>,
    /// Whether the origin is that of the frame before.
    meets: bool,
}

/// The inertia of a link, or of several that are held together, in a joint's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub(super) mass: f64,
    pub(super) first_moment: Vector3<f64>,
    pub(super) rotational: Symmetric3,
}

/// The joints of a robot, and gravity and link inertias in their frames.
#[derive(Clone, Debug)]
pub(super) struct JointChain {
    pub(super) joints: Vec<JointFrame>,
    pub(super) bodies: Vec<Body>,
    /// Acceleration of the base, minus gravity, in the frame that the first joint's is given in.
    pub(super) base_acceleration: Vector3<f64>,
}

impl JointChain {
    pub(super) fn new(robot: &Robot, links: &[Inertia]) -> Self {
        let n = robot.dof();
        // From the previous joint's frame, before its turn by γ, to this joint's axis.
        let steps: Vec<Placement> = (0..n)
            .map(|k| {
                let before = robot.joints()[k].before;
                if k == 0 { before } else { robot.joints()[k - 1].after.compose(&before) }
            })
            .collect();
        let gammas: Vec<Gamma> = steps.iter().map(|step| Gamma::of(&step.rotation)).collect();
        let mut joints = Vec::with_capacity(n);
        let mut bodies = Vec::with_capacity(n);
        for k in 0..n {
            let step = gammas[k].turn_back().compose(&steps[k]);
            let r = &step.rotation;
            let next_gamma = gammas.get(k + 1).copied().unwrap_or(Gamma::ZERO);
            let (revolute, sin_alpha, cos_alpha) =
                (robot.joints()[k].kind == JointKind::Revolute, -r[(1, 2)], r[(2, 2)]);
            joints.push(JointFrame {
                revolute,
                offset: libm::atan2(-r[(0, 1)], r[(0, 0)]) + next_gamma.angle,
                twist: match (sin_alpha, cos_alpha) {
                    (0.0, 1.0) => Twist::Parallel,
                    (1.0, 0.0) => Twist::Right,
                    _ => Twist::Any,
                },
                sin_alpha,
                cos_alpha,
                origin: step.translation,
                meets: revolute && step.translation == Vector3::zeros(),
            });
            let link = next_gamma.turn_back().compose(&robot.joints()[k].after);
            bodies.push(Body::placed(&links[k], &link));
        }
        Self { joints, bodies, base_acceleration: -(gammas[0].turn_back().rotation * robot.gravity()) }
    }
}

/// Angles of all joints about their axes, with their sines and cosines, n each.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    angles: Vec<f64>,
    sines: Vec<f64>,
    cosines: Vec<f64>,
}

/// Positions, velocities (n each), and the sines and cosines of the positions.
pub(super) type State<'a> = (&'a [f64], &'a [f64], &'a Turns);

impl Turns {
    pub(super) fn new(chain: &JointChain) -> Self {
        let n = chain.joints.len();
        Self { angles: vec![0.0; n], sines: vec![0.0; n], cosines: vec![1.0; n] }
    }

    /// Takes the positions `q` (n): one evaluation for as many joints as the processor has lanes.
    #[inline(always)]
    pub(super) fn take(&mut self, joints: &[JointFrame], q: &[f64]) {
        for ((angle, joint), q) in self.angles.iter_mut().zip(joints).zip(q) {
            *angle = joint.angle(*q);
        }
        sines_and_cosines(&self.angles, &mut self.sines, &mut self.cosines);
    }

    /// Sine and cosine of joint k.
    #[inline(always)]
    pub(super) fn sine_and_cosine(&self, k: usize) -> (f64, f64) {
        (self.sines[k], self.cosines[k])
    }
}

/// `γ` of `R = Rz(γ) Rx(α) Rz(θ)`, 0 ≤ α ≤ 180°; any value serves where `α` is a multiple of 180°.
#[derive(Clone, Copy)]
struct Gamma {
    /// rad.
    angle: f64,
    /// Exact at right angles, as those of the rotation are.
    sin: f64,
    cos: f64,
}

impl Gamma {
    const ZERO: Self = Self { angle: 0.0, sin: 0.0, cos: 1.0 };

    fn of(r: &Matrix3<f64>) -> Self {
        let (x, y) = (r[(0, 2)], -r[(1, 2)]);
        let sin_alpha = (x * x + y * y).sqrt();
        if sin_alpha == 0.0 {
            return Self::ZERO;
        }
        Self { angle: libm::atan2(x, y), sin: x / sin_alpha, cos: y / sin_alpha }
    }

    /// `Rz(−γ)`.
    fn turn_back(self) -> Placement {
        Placement::rotation_z(-self.sin, self.cos)
    }
}

impl JointFrame {
    /// The pose at coordinate `q`, whose angle about the axis has this sine and cosine.
    #[inline(always)]
    pub(super) fn pose<V: Lane>(&self, q: V, (sin, cos): (V, V)) -> JointPose<V> {
        let (sin_alpha, cos_alpha) = (q.splat(self.sin_alpha), q.splat(self.cos_alpha));
        let mut origin = three(q, &self.origin);
        if !self.revolute {
            origin[1] = origin[1] - sin_alpha * q;
            origin[2] = origin[2] + cos_alpha * q;
        }
        JointPose { sin, cos, twist: self.twist, sin_alpha, cos_alpha, origin, meets: self.meets }
    }

    /// The angle about the axis at coordinate `q`.
    #[inline(always)]
    pub(super) fn angle<V: Lane>(&self, q: V) -> V {
        let offset = q.splat(self.offset);
        if self.revolute { offset + q } else { offset }
    }

    /// Velocity and acceleration of the child from those of its parent, both given in the child's frame:
    /// `v + S q̇`, `a + S q̈ + v × S q̇`.
    #[inline(always)]
    pub(super) fn moved<V: Lane>(
        &self,
        (mut v, mut a): (LaneMotion<V>, LaneMotion<V>),
        qd: V,
        qdd: V,
    ) -> (LaneMotion<V>, LaneMotion<V>) {
        // v × ẑ q̇, of either half.
        let turned = |a: &mut Three<V>, x: &Three<V>| (a[0], a[1]) = (a[0] + x[1] * qd, a[1] - x[0] * qd);
        if self.revolute {
            turned(&mut a.ang, &v.ang);
            turned(&mut a.lin, &v.lin);
            v.ang[2] = v.ang[2] + qd;
            a.ang[2] = a.ang[2] + qdd;
        } else {
            turned(&mut a.lin, &v.ang);
            v.lin[2] = v.lin[2] + qd;
            a.lin[2] = a.lin[2] + qdd;
        }
        (v, a)
    }

    /// What a force on the child asks of the joint: `Sᵀ f`.
    #[inline(always)]
    pub(super) fn effort<V: Lane>(&self, f: &LaneForce<V>) -> V {
        if self.revolute { f.ang[2] } else { f.lin[2] }
    }
}

/// One vector in every lane.
#[inline(always)]
fn three<V: Lane>(one: V, x: &Vector3<f64>) -> Three<V> {
    [one.splat(x.x), one.splat(x.y), one.splat(x.z)]
}

impl<V: Lane> JointPose<V> {
    /// Before anything is known; `zero` says of how many samples.
    #[inline(always)]
    pub(super) fn nowhere(zero: V) -> Self {
        let one = zero.splat(1.0);
        let (twist, meets) = (Twist::Parallel, true);
        Self { sin: zero, cos: one, twist, sin_alpha: zero, cos_alpha: one, origin: [zero; 3], meets }
    }

    /// Zero, for as many samples.
    #[inline(always)]
    pub(super) fn zero(&self) -> V {
        self.sin.splat(0.0)
    }

    /// `Rᵀ x`.
    #[inline(always)]
    fn turned_in(&self, x: &Three<V>) -> Three<V> {
        let (sa, ca, s, c) = (self.sin_alpha, self.cos_alpha, self.sin, self.cos);
        let (y, z) = match self.twist {
            Twist::Parallel => (x[1], x[2]),
            Twist::Right => (x[2], -x[1]),
            Twist::Any => (ca * x[1] + sa * x[2], ca * x[2] - sa * x[1]),
        };
        [c * x[0] + s * y, c * y - s * x[0], z]
    }

    /// `R x`.
    #[inline(always)]
    fn turned_out(&self, x: &Three<V>) -> Three<V> {
        let (sa, ca, s, c) = (self.sin_alpha, self.cos_alpha, self.sin, self.cos);
        let y = s * x[0] + c * x[1];
        let (y, z) = match self.twist {
            Twist::Parallel => (y, x[2]),
            Twist::Right => (-x[2], y),
            Twist::Any => (ca * y - sa * x[2], sa * y + ca * x[2]),
        };
        [c * x[0] - s * x[1], y, z]
    }

    #[inline(always)]
    pub(super) fn in_child(&self, m: &LaneMotion<V>) -> LaneMotion<V> {
        let lin = if self.meets { m.lin } else { sum(&m.lin, &cross(&m.ang, &self.origin)) };
        LaneMotion { ang: self.turned_in(&m.ang), lin: self.turned_in(&lin) }
    }

    #[inline(always)]
    pub(super) fn in_parent(&self, f: &LaneForce<V>) -> LaneForce<V> {
        let (ang, lin) = (self.turned_out(&f.ang), self.turned_out(&f.lin));
        LaneForce { ang: if self.meets { ang } else { sum(&ang, &cross(&self.origin, &lin)) }, lin }
    }
}

impl JointPose {
    /// `R x`.
    #[inline(always)]
    pub(super) fn turn_out(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.turned_out(&(*x).into()).into()
    }

    /// `R M Rᵀ`.
    #[inline(always)]
    pub(super) fn turn_symmetric(&self, m: &Symmetric3) -> Symmetric3 {
        let m = m.turned_about_z(self.sin, self.cos);
        match self.twist {
            Twist::Parallel => m,
            Twist::Right => Symmetric3 { xx: m.xx, xy: -m.xz, xz: m.xy, yy: m.zz, yz: -m.yz, zz: m.yy },
            Twist::Any => m.turned_about_x(self.sin_alpha, self.cos_alpha),
        }
    }

    /// The child's origin in the parent.
    #[inline(always)]
    pub(super) fn origin(&self) -> Vector3<f64> {
        self.origin.into()
    }

    #[inline(always)]
    pub(super) fn motion_to_child(&self, m: &Motion) -> Motion {
        self.in_child(&m.into()).into()
    }

    #[inline(always)]
    pub(super) fn force_to_parent(&self, f: &Force) -> Force {
        self.in_parent(&f.into()).into()
    }
}

impl Body {
    /// A link whose frame stands at `placement`.
    fn placed(link: &Inertia, placement: &Placement) -> Self {
        let r = &placement.rotation;
        let turned = Self {
            mass: link.mass,
            first_moment: r * link.first_moment,
            rotational: Symmetric3::from_matrix(&(r * link.rotational * r.transpose())),
        };
        turned.moved(&placement.translation)
    }

    /// About the origin of a frame that stands at `−p`: `h' = h + m p`,
    /// `J' = J + (p·(h + h')) 1 − p hᵀ − h' pᵀ`.
    #[inline(always)]
    fn moved(&self, p: &Vector3<f64>) -> Self {
        let h = &self.first_moment;
        let moved = h + p * self.mass;
        let (gx, gy, gz) = (p.x * (h.x + moved.x), p.y * (h.y + moved.y), p.z * (h.z + moved.z));
        let j = &self.rotational;
        Self {
            mass: self.mass,
            first_moment: moved,
            rotational: Symmetric3 {
                xx: j.xx + (gy + gz),
                yy: j.yy + (gx + gz),
                zz: j.zz + (gx + gy),
                xy: j.xy - (p.x * h.y + moved.x * p.y),
                xz: j.xz - (p.x * h.z + moved.x * p.z),
                yz: j.yz - (p.y * h.z + moved.y * p.z),
            },
        }
    }

    /// Returns this body as seen from the parent's frame.
    #[inline(always)]
    pub(super) fn to_parent(self, pose: &JointPose) -> Self {
        let turned = Self {
            mass: self.mass,
            first_moment: pose.turn_out(&self.first_moment),
            rotational: pose.turn_symmetric(&self.rotational),
        };
        if pose.meets { turned } else { turned.moved(&pose.origin()) }
    }

    /// Both bodies held together.
    #[inline(always)]
    pub(super) fn joined(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            rotational: self.rotational.plus(&other.rotational),
        }
    }

    /// `I a + v ×* I v`, with `b = a_lin + ω × v_lin` the acceleration of the origin.
    ///
    /// ```text
    /// n = J α + ω × J ω + h × b        f = m b + α × h + ω × (ω × h)
    /// ```
    #[inline(always)]
    pub(super) fn lane_wrench<V: Lane>(&self, v: &LaneMotion<V>, a: &LaneMotion<V>) -> LaneForce<V> {
        let one = v.ang[0];
        let (j, h) = (&self.rotational, three(one, &self.first_moment));
        let b = sum(&a.lin, &cross(&v.ang, &v.lin));
        let [x, y, z] = b;
        let mass = one.splat(self.mass);
        let turned = cross(&v.ang, &j.lane_times(&v.ang));
        LaneForce {
            ang: sum(&sum(&j.lane_times(&a.ang), &turned), &cross(&h, &b)),
            lin: sum(&sum(&[x * mass, y * mass, z * mass], &cross(&a.ang, &h)), &cross(&v.ang, &cross(&v.ang, &h))),
        }
    }

    /// [`Self::lane_wrench`] of one sample.
    #[inline(always)]
    pub(super) fn wrench(&self, v: &Motion, a: &Motion) -> Force {
        self.lane_wrench(&v.into(), &a.into()).into()
    }
}
