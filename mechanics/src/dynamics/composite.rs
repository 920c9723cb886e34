//! The mass matrix by composite bodies (Featherstone, table 6.2) and the bias torque, in joint frames.
//!
//! ```text
//! I^C_i = I_i + X* I^C_{i+1} X         F = I^C_j S_j         H_ij = S_iᵀ X* F   for i ≤ j
//! ```

use super::chain::{Inward, Link, Links, Outward, Pose, Wrench};
use super::turns::{State, Turns};

/// What the recursion keeps of one joint.
#[derive(Clone, Copy, Debug)]
struct CompositeJoint {
    pose: Pose<f64>,
    /// What the motion of its link needs.
    wrench: Wrench<f64>,
}

/// What the recursions write to.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    joints: Vec<CompositeJoint>,
    /// What accelerates each joint alone, seen from the link that the sweep has come to.
    columns: Vec<Wrench<f64>>,
    /// Row-major n × n.
    pub(super) mass: Vec<f64>,
    bias: Vec<f64>,
}

const NOTHING: Wrench<f64> = ([0.0; 3], [0.0; 3]);

impl Workspace {
    pub(super) fn new(n: usize) -> Self {
        let joint = CompositeJoint { pose: Pose::nowhere(0.0), wrench: NOTHING };
        Self { joints: vec![joint; n], columns: vec![NOTHING; n], mass: vec![0.0; n * n], bias: vec![0.0; n] }
    }
}

/// Fills the lower triangle of the row-major n × n mass matrix of the links, and the efforts (n) that the wrenches take.
#[inline(always)]
fn sweep_inwards(
    links: &[Link],
    joints: &[CompositeJoint],
    columns: &mut [Wrench<f64>],
    mass: &mut [f64],
    efforts: &mut [f64],
) {
    let n = links.len();
    let (joints, columns) = (&joints[..n], &mut columns[..n]);
    let (mass, efforts) = (&mut mass[..n * n], &mut efforts[..n]);
    let mut inward = Inward::begin(0.0, &links[n - 1]);
    for i in (0..n).rev() {
        let link = &links[i];
        inward.take(&joints[i].wrench);
        efforts[i] = inward.effort(link);
        columns[i] = inward.column(link);
        for k in i..n {
            mass[k * n + i] = link.along(&columns[k]);
        }
        if i > 0 {
            inward.next(link, &joints[i].pose, &links[i - 1], &mut columns[i..]);
        }
    }
}

/// The lower triangle of the row-major n × n mass matrix of the links at `q`.
pub(super) fn mass_matrix_at(links: &Links, work: &mut Workspace, q: &[f64], turns: &Turns) {
    let Workspace { joints, columns, mass, bias } = work;
    for (k, (joint, link)) in joints.iter_mut().zip(&links.links).enumerate() {
        joint.pose = link.pose(q[k], turns.sine_and_cosine(k));
    }
    sweep_inwards(&links.links, joints, columns, mass, bias);
}

/// Turns efforts into accelerations, in place: `x ← (H(q) + D)⁻¹ (x − c(q, q̇) − g(q))`, `D` row-major n × n.
pub(super) fn accelerations(links: &Links, work: &mut Workspace, added: &[f64], state: State<'_>, x: &mut [f64]) {
    // The usual numbers of joints with loops of known length: a tenth faster, the same operations in the same order.
    match links.links.len() {
        6 => sized::<6>(links, work, added, state, x),
        7 => sized::<7>(links, work, added, state, x),
        _ => accelerations_of(&links.links, &links.lift, work, added, state, x),
    }
}

fn sized<const N: usize>(links: &Links, work: &mut Workspace, added: &[f64], state: State<'_>, x: &mut [f64]) {
    if let Some(own) = links.links.first_chunk::<N>() {
        accelerations_of(own, &links.lift, work, added, state, x);
    }
}

#[inline(always)]
fn accelerations_of(
    links: &[Link],
    lift: &[f64; 3],
    work: &mut Workspace,
    added: &[f64],
    (q, qd, turns): State<'_>,
    x: &mut [f64],
) {
    let n = links.len();
    let (q, qd, x) = (&q[..n], &qd[..n], &mut x[..n]);
    let joints = &mut work.joints[..n];
    joints[0].pose = links[0].pose(q[0], turns.sine_and_cosine(0));
    let (mut outward, effort) = Outward::first(&links[0], &joints[0].pose, qd[0], None, lift);
    for k in 1..n {
        let pose = links[k].pose(q[k], turns.sine_and_cosine(k));
        joints[k] = CompositeJoint { pose, wrench: outward.next(&links[k], &pose, qd[k], None) };
    }
    sweep_inwards(links, joints, &mut work.columns, &mut work.mass, &mut work.bias);
    let (mass, bias) = (&mut work.mass[..n * n], &mut work.bias[..n]);
    bias[0] += effort;
    for (m, d) in mass.iter_mut().zip(&added[..n * n]) {
        *m += d;
    }
    for (x, bias) in x.iter_mut().zip(bias) {
        *x -= *bias;
    }
    solve(n, mass, x);
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
