//! An independent oracle for the regressor and its gradients: Newton's and Euler's equations of each body in the
//! base frame, with ordinary vectors, evaluated in dual numbers.
//!
//! ```text
//! f = m ö + ω̇ × h + ω × (ω × h)        n = J ω̇ + ω × J ω + h × ö        about the link frame's origin o
//! τ_i = z_i · (n + (o − o_i) × f)  or  z_i · f
//! ```
//! No spatial vectors, no link coordinates, no backward sweep. A dual number carries the derivative along one direction.

use std::ops::{Add, Mul, Sub};

use crate::model::{Joint, JointKind, Robot};

/// `value + ε derivative` with `ε² = 0`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) derivative: f64,
}

impl Dual {
    pub(super) const fn new(value: f64, derivative: f64) -> Self {
        Self { value, derivative }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.derivative + o.derivative)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.value - o.value, self.derivative - o.derivative)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(self.value * o.value, self.value * o.derivative + self.derivative * o.value)
    }
}

type Vector = [Dual; 3];
type Matrix = [Vector; 3];

fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn scale(a: Vector, s: Dual) -> Vector {
    a.map(|x| x * s)
}

fn dot(a: Vector, b: Vector) -> Dual {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn times(m: &Matrix, x: Vector) -> Vector {
    [dot(m[0], x), dot(m[1], x), dot(m[2], x)]
}

fn transpose(m: &Matrix) -> Matrix {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transpose(b);
    transpose(&columns.map(|column| times(a, column)))
}

fn constant(m: &nalgebra::Matrix3<f64>) -> Matrix {
    std::array::from_fn(|r| std::array::from_fn(|c| m[(r, c)].into()))
}

fn constant_vector(v: &nalgebra::Vector3<f64>) -> Vector {
    [v.x.into(), v.y.into(), v.z.into()]
}

/// One link as the base sees it.
struct Link {
    rotation: Matrix,
    origin: Vector,
    omega: Vector,
    alpha: Vector,
    /// Acceleration of the origin, gravity subtracted.
    acceleration: Vector,
    axis: Vector,
    on_axis: Vector,
}

fn step(joint: &Joint, link: &Link, q: Dual, qd: Dual, qdd: Dual) -> Link {
    let z = times(&product(&link.rotation, &constant(&joint.before.rotation)), [0.0.into(), 0.0.into(), 1.0.into()]);
    let at_zero = add(link.origin, times(&link.rotation, constant_vector(&joint.before.translation)));
    let frame = product(&link.rotation, &constant(&joint.before.rotation));
    let follow = |point: Vector| {
        let r = sub(point, link.origin);
        add(link.acceleration, add(cross(link.alpha, r), cross(link.omega, cross(link.omega, r))))
    };
    let (frame, on_axis, omega, alpha, acceleration) = match joint.kind {
        JointKind::Revolute => {
            let (s, c) = libm::sincos(q.value);
            let (s, c) = (Dual::new(s, c * q.derivative), Dual::new(c, -s * q.derivative));
            let zero = Dual::default();
            let turn = [[c, zero - s, zero], [s, c, zero], [zero, zero, 1.0.into()]];
            let omega = add(link.omega, scale(z, qd));
            let alpha = add(link.alpha, add(scale(z, qdd), scale(cross(link.omega, z), qd)));
            (product(&frame, &turn), at_zero, omega, alpha, follow(at_zero))
        }
        JointKind::Prismatic => {
            let slid = add(at_zero, scale(z, q));
            let coriolis = scale(cross(link.omega, z), qd + qd);
            (frame, slid, link.omega, link.alpha, add(follow(slid), add(coriolis, scale(z, qdd))))
        }
    };
    let arm = times(&frame, constant_vector(&joint.after.translation));
    Link {
        rotation: product(&frame, &constant(&joint.after.rotation)),
        origin: add(on_axis, arm),
        acceleration: add(acceleration, add(cross(alpha, arm), cross(omega, cross(omega, arm)))),
        omega,
        alpha,
        axis: z,
        on_axis,
    }
}

/// `Y_ik φ` for one link k and every joint i ≤ k: efforts of the joints when link k alone has the ten parameters `phi[i]`.
/// Returns `Σ_i Σ_k Y_ik φ_ik` for weights given as rows of ten per link, in dual numbers.
pub(super) fn weighted_efforts(
    robot: &Robot,
    (q, qd, qdd): (&[Dual], &[Dual], &[Dual]),
    weights: impl Fn(usize, usize) -> [f64; 10],
) -> Dual {
    let still = [Dual::default(); 3];
    let mut links = vec![Link {
        rotation: constant(&nalgebra::Matrix3::identity()),
        origin: still,
        omega: still,
        alpha: still,
        acceleration: constant_vector(&-robot.gravity()),
        axis: still,
        on_axis: still,
    }];
    for (k, joint) in robot.joints().iter().enumerate() {
        links.push(step(joint, &links[k], q[k], qd[k], qdd[k]));
    }
    let mut sum = Dual::default();
    for k in 0..robot.dof() {
        let link = &links[k + 1];
        for i in 0..=k {
            let p = weights(i, k).map(Dual::from);
            let h = times(&link.rotation, [p[1], p[2], p[3]]);
            let j = [[p[4], p[5], p[6]], [p[5], p[7], p[8]], [p[6], p[8], p[9]]];
            let j = product(&product(&link.rotation, &j), &transpose(&link.rotation));
            let f =
                add(scale(link.acceleration, p[0]), add(cross(link.alpha, h), cross(link.omega, cross(link.omega, h))));
            let n =
                add(times(&j, link.alpha), add(cross(link.omega, times(&j, link.omega)), cross(h, link.acceleration)));
            let joint = &links[i + 1];
            sum = sum
                + match robot.joints()[i].kind {
                    JointKind::Revolute => dot(joint.axis, add(n, cross(sub(link.origin, joint.on_axis), f))),
                    JointKind::Prismatic => dot(joint.axis, f),
                };
        }
    }
    sum
}
