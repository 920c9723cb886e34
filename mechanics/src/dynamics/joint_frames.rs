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

use nalgebra::{Matrix3, Vector3};

use super::symmetric::Symmetric3;
use crate::lanes::sines_and_cosines;
use crate::model::{JointKind, Robot};
use crate::spatial::{Force, Inertia, Motion, Placement};

/// One joint in the form of the module's header.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointFrame {
    pub(super) revolute: bool,
    /// `θ`, rad.
    offset: f64,
    sin_alpha: f64,
    cos_alpha: f64,
    /// `p`, m.
    origin: Vector3<f64>,
}

/// Where a joint's frame stands in the one before, at some coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointPose {
    sin: f64,
    cos: f64,
    sin_alpha: f64,
    cos_alpha: f64,
    origin: Vector3<f64>,
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
        let gammas: Vec<f64> = steps.iter().map(|step| gamma(&step.rotation)).collect();
        let mut joints = Vec::with_capacity(n);
        let mut bodies = Vec::with_capacity(n);
        for k in 0..n {
            let step = turn_back(gammas[k]).compose(&steps[k]);
            let r = &step.rotation;
            let next_gamma = gammas.get(k + 1).copied().unwrap_or(0.0);
            joints.push(JointFrame {
                revolute: robot.joints()[k].kind == JointKind::Revolute,
                offset: libm::atan2(-r[(0, 1)], r[(0, 0)]) + next_gamma,
                sin_alpha: -r[(1, 2)],
                cos_alpha: r[(2, 2)],
                origin: step.translation,
            });
            let link = turn_back(next_gamma).compose(&robot.joints()[k].after);
            bodies.push(Body::placed(&links[k], &link));
        }
        Self { joints, bodies, base_acceleration: -(turn_back(gammas[0]).rotation * robot.gravity()) }
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
    #[inline]
    pub(super) fn take(&mut self, joints: &[JointFrame], q: &[f64]) {
        for ((angle, joint), q) in self.angles.iter_mut().zip(joints).zip(q) {
            *angle = if joint.revolute { joint.offset + q } else { joint.offset };
        }
        sines_and_cosines(&self.angles, &mut self.sines, &mut self.cosines);
    }

    /// Sine and cosine of joint k.
    #[inline(always)]
    pub(super) fn of(&self, k: usize) -> (f64, f64) {
        (self.sines[k], self.cosines[k])
    }
}

/// `γ` of `R = Rz(γ) Rx(α) Rz(θ)`; any value serves where `α` is a multiple of 180°.
fn gamma(r: &Matrix3<f64>) -> f64 {
    let (x, y) = (r[(0, 2)], -r[(1, 2)]);
    if x == 0.0 && y == 0.0 { 0.0 } else { libm::atan2(x, y) }
}

/// `Rz(−γ)`.
fn turn_back(gamma: f64) -> Placement {
    let (s, c) = libm::sincos(gamma);
    Placement::rotation_z(-s, c)
}

impl JointFrame {
    /// The pose at coordinate `q`, whose angle about the axis has this sine and cosine.
    #[inline(always)]
    pub(super) fn pose(&self, q: f64, (sin, cos): (f64, f64)) -> JointPose {
        let slide = if self.revolute { 0.0 } else { q };
        let (sin_alpha, cos_alpha) = (self.sin_alpha, self.cos_alpha);
        let origin = Vector3::new(self.origin.x, self.origin.y - sin_alpha * slide, self.origin.z + cos_alpha * slide);
        JointPose { sin, cos, sin_alpha, cos_alpha, origin }
    }
}

impl JointFrame {
    /// Velocity and acceleration of the child from those of its parent, both given in the child's frame:
    /// `v + S q̇`, `a + S q̈ + v × S q̇`.
    #[inline]
    pub(super) fn moved(&self, v: &Motion, a: &Motion, qd: f64, qdd: f64) -> (Motion, Motion) {
        let (mut v, mut a) = (*v, *a);
        // v × ẑ q̇, of either half.
        let turned = |x: &Vector3<f64>| Vector3::new(x.y * qd, -(x.x * qd), 0.0);
        if self.revolute {
            (a.ang, a.lin) = (a.ang + turned(&v.ang), a.lin + turned(&v.lin));
            v.ang.z += qd;
            a.ang.z += qdd;
        } else {
            a.lin += turned(&v.ang);
            v.lin.z += qd;
            a.lin.z += qdd;
        }
        (v, a)
    }

    /// What a force on the child asks of the joint: `Sᵀ f`.
    #[inline]
    pub(super) fn effort(&self, f: &Force) -> f64 {
        if self.revolute { f.ang.z } else { f.lin.z }
    }
}

impl JointPose {
    /// Before anything is known.
    pub(super) const NOWHERE: Self =
        Self { sin: 0.0, cos: 1.0, sin_alpha: 0.0, cos_alpha: 1.0, origin: Vector3::new(0.0, 0.0, 0.0) };

    /// `Rᵀ x`.
    #[inline]
    fn turn_in(&self, x: &Vector3<f64>) -> Vector3<f64> {
        let (sa, ca, s, c) = (self.sin_alpha, self.cos_alpha, self.sin, self.cos);
        let y = ca * x.y + sa * x.z;
        Vector3::new(c * x.x + s * y, c * y - s * x.x, ca * x.z - sa * x.y)
    }

    /// `R x`.
    #[inline]
    pub(super) fn turn_out(&self, x: &Vector3<f64>) -> Vector3<f64> {
        let (sa, ca, s, c) = (self.sin_alpha, self.cos_alpha, self.sin, self.cos);
        let y = s * x.x + c * x.y;
        Vector3::new(c * x.x - s * x.y, ca * y - sa * x.z, sa * y + ca * x.z)
    }

    /// `R M Rᵀ`.
    #[inline]
    pub(super) fn turn_symmetric(&self, m: &Symmetric3) -> Symmetric3 {
        m.turned_about_z(self.sin, self.cos).turned_about_x(self.sin_alpha, self.cos_alpha)
    }

    /// The child's origin in the parent.
    #[inline]
    pub(super) fn origin(&self) -> &Vector3<f64> {
        &self.origin
    }

    #[inline]
    pub(super) fn motion_to_child(&self, m: &Motion) -> Motion {
        Motion { ang: self.turn_in(&m.ang), lin: self.turn_in(&(m.lin + m.ang.cross(&self.origin))) }
    }

    #[inline]
    pub(super) fn force_to_parent(&self, f: &Force) -> Force {
        let lin = self.turn_out(&f.lin);
        Force { ang: self.turn_out(&f.ang) + self.origin.cross(&lin), lin }
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
    #[inline]
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
    #[inline]
    pub(super) fn to_parent(self, pose: &JointPose) -> Self {
        Self {
            mass: self.mass,
            first_moment: pose.turn_out(&self.first_moment),
            rotational: pose.turn_symmetric(&self.rotational),
        }
        .moved(&pose.origin)
    }

    /// Both bodies held together.
    #[inline]
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
    pub(super) fn wrench(&self, v: &Motion, a: &Motion) -> Force {
        let (j, h) = (&self.rotational, &self.first_moment);
        let b = a.lin + v.ang.cross(&v.lin);
        Force {
            ang: j.times(&a.ang) + v.ang.cross(&j.times(&v.ang)) + h.cross(&b),
            lin: b * self.mass + a.ang.cross(h) + v.ang.cross(&v.ang.cross(h)),
        }
    }
}
