//! The mass matrix by composite bodies (Featherstone, table 6.2) and the bias torque, in joint frames.
//!
//! ```text
//! I^C_i = I_i + X* I^C_{i+1} X         F = I^C_j S_j         H_ij = S_iᵀ X* F   for i ≤ j
//! ```

use nalgebra::Vector3;

use super::joint_frames::{Body, JointChain, JointFrame, JointPose, State, Turns};
use crate::spatial::{Force, Motion};

/// What the recursion keeps of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct CompositeJoint {
    pose: JointPose,
    body: Body,
    wrench: Force,
}

/// What the recursions write to.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    joints: Vec<CompositeJoint>,
    /// Row-major n × n.
    pub(super) mass: Vec<f64>,
    bias: Vec<f64>,
}

impl Workspace {
    pub(super) fn new(chain: &JointChain) -> Self {
        let n = chain.joints.len();
        let joint = |&body: &Body| CompositeJoint { pose: JointPose::nowhere(0.0), body, wrench: Force::zero() };
        Self { joints: chain.bodies.iter().map(joint).collect(), mass: vec![0.0; n * n], bias: vec![0.0; n] }
    }
}

/// Fills the lower triangle of the row-major n × n mass matrix of the links for positions whose poses are in `work`.
#[inline(always)]
fn mass_matrix(joints: &[JointFrame], work: &mut [CompositeJoint], mass: &mut [f64]) {
    let n = joints.len();
    let (work, mass) = (&mut work[..n], &mut mass[..n * n]);
    for j in (0..n).rev() {
        let body = work[j].body;
        let h = &body.first_moment;
        let mut force;
        if joints[j].revolute {
            let i = &body.rotational;
            force = Force::new(Vector3::new(i.xz, i.yz, i.zz), Vector3::new(-h.y, h.x, 0.0));
            mass[j * n + j] = i.zz;
        } else {
            force = Force::new(Vector3::new(h.y, -h.x, 0.0), Vector3::new(0.0, 0.0, body.mass));
            mass[j * n + j] = body.mass;
        }
        for i in (0..j).rev() {
            force = work[i + 1].pose.force_to_parent(&force);
            mass[j * n + i] = if joints[i].revolute { force.ang.z } else { force.lin.z };
        }
        if j > 0 {
            let seen = body.to_parent(&work[j].pose);
            work[j - 1].body = work[j - 1].body.joined(&seen);
        }
    }
}

/// The lower triangle of the row-major n × n mass matrix of the links at `q`.
pub(super) fn mass_matrix_at(chain: &JointChain, work: &mut Workspace, q: &[f64], turns: &Turns) {
    for (k, ((w, joint), body)) in work.joints.iter_mut().zip(&chain.joints).zip(&chain.bodies).enumerate() {
        w.pose = joint.pose(q[k], turns.sine_and_cosine(k));
        w.body = *body;
    }
    mass_matrix(&chain.joints, &mut work.joints, &mut work.mass);
}

/// Turns efforts into accelerations, in place: `x ← (H(q) + D)⁻¹ (x − c(q, q̇) − g(q))`, `D` row-major n × n.
pub(super) fn accelerations(chain: &JointChain, work: &mut Workspace, added: &[f64], state: State<'_>, x: &mut [f64]) {
    // The usual numbers of joints with loops of known length: a tenth faster, the same operations in the same order.
    match chain.joints.len() {
        6 => sized::<6>(chain, work, added, state, x),
        7 => sized::<7>(chain, work, added, state, x),
        _ => accelerations_of(&chain.joints, &chain.bodies, chain.base_acceleration, work, added, state, x),
    }
}

fn sized<const N: usize>(chain: &JointChain, work: &mut Workspace, added: &[f64], state: State<'_>, x: &mut [f64]) {
    if let (Some(joints), Some(bodies)) = (chain.joints.first_chunk::<N>(), chain.bodies.first_chunk::<N>()) {
        accelerations_of(joints, bodies, chain.base_acceleration, work, added, state, x);
    }
}

#[inline(always)]
fn accelerations_of(
    joints: &[JointFrame],
    bodies: &[Body],
    base_acceleration: Vector3<f64>,
    work: &mut Workspace,
    added: &[f64],
    state: State<'_>,
    x: &mut [f64],
) {
    let n = joints.len();
    let (mass, bias, x) = (&mut work.mass[..n * n], &mut work.bias[..n], &mut x[..n]);
    mass_matrix_and_bias((joints, bodies, base_acceleration), &mut work.joints, state, mass, bias);
    for (m, d) in mass.iter_mut().zip(&added[..n * n]) {
        *m += d;
    }
    for (x, bias) in x.iter_mut().zip(bias) {
        *x -= *bias;
    }
    solve(n, mass, x);
}

/// Mass matrix (lower triangle) and bias efforts `c(q, q̇) + g(q)` (n) of the links.
#[inline(always)]
fn mass_matrix_and_bias(
    (joints, bodies, base_acceleration): (&[JointFrame], &[Body], Vector3<f64>),
    work: &mut [CompositeJoint],
    (q, qd, turns): State<'_>,
    mass: &mut [f64],
    bias: &mut [f64],
) {
    let n = joints.len();
    let (q, qd, bias) = (&q[..n], &qd[..n], &mut bias[..n]);
    let work = &mut work[..n];
    let mut v = Motion::zero();
    let mut a = Motion::new(Vector3::zeros(), base_acceleration);
    for (k, (joint, body)) in joints.iter().zip(bodies).enumerate() {
        let pose = joint.pose(q[k], turns.sine_and_cosine(k));
        v = pose.motion_to_child(&v);
        a = pose.motion_to_child(&a);
        let rate = qd[k];
        if joint.revolute {
            v.ang.z += rate;
            a.ang.x += v.ang.y * rate;
            a.ang.y -= v.ang.x * rate;
            a.lin.x += v.lin.y * rate;
            a.lin.y -= v.lin.x * rate;
        } else {
            v.lin.z += rate;
            a.lin.x += v.ang.y * rate;
            a.lin.y -= v.ang.x * rate;
        }
        work[k] = CompositeJoint { pose, body: *body, wrench: body.wrench(&v, &a) };
    }
    let mut force = Force::zero();
    for k in (0..n).rev() {
        force += work[k].wrench;
        bias[k] = if joints[k].revolute { force.ang.z } else { force.lin.z };
        if k > 0 {
            force = work[k].pose.force_to_parent(&force);
        }
    }
    mass_matrix(joints, work, mass);
}

/// Solves `M x = b` in place for a symmetric positive definite M given by its lower triangle (row-major n × n), by
/// `M = L D Lᵀ`; M is overwritten.
#[inline(always)]
fn solve(n: usize, m: &mut [f64], b: &mut [f64]) {
    let (m, b) = (&mut m[..n * n], &mut b[..n]);
    for j in 0..n {
        let (above, rest) = m.split_at_mut(j * n);
        let row = &mut rest[..n];
        // Row j of L, times D until it is divided.
        for i in 0..j {
            let other = &above[i * n..i * n + n];
            let mut sum = row[i];
            for k in 0..i {
                sum -= row[k] * other[k];
            }
            row[i] = sum;
        }
        let (mut d, mut x) = (row[j], b[j]);
        for k in 0..j {
            // above[k][k] holds 1/D_k.
            let l = row[k] * above[k * n + k];
            d -= l * row[k];
            x -= l * b[k];
            row[k] = l;
        }
        row[j] = 1.0 / d;
        b[j] = x;
    }
    for j in (0..n).rev() {
        let mut x = b[j] * m[j * n + j];
        for k in j + 1..n {
            x -= m[k * n + j] * b[k];
        }
        b[j] = x;
    }
}
