//! A robot with its parameters, rewritten for speed.
//!
//! ```text
//! x_{i-1} = Rx(α) Rz(θ + q) x_i + p                (revolute)
//! x_{i-1} = Rx(α) (Rz(θ) x_i + q z) + p            (prismatic)
//! ```
//! Every chain of revolute and prismatic joints can be written so: the constant rotation between two joint axes is
//! `Rz(γ) Rx(α) Rz(β)`; `Rz(β)` turns about the next axis and joins its angle, `Rz(γ)` turns about the axis before and
//! joins that one's. A change of frame then costs 8 products instead of 18. Links' inertias are given in these frames,
//! as mass, first moment and second moments `Σ = ∫ x xᵀ dm` (upper left of the pseudo-inertia), which shift by sums
//! of products and rotate in planes.
//!
//! Masses on the axis of a revolute joint move alike on both of its links. So a link's mass and its moments along the axis go to
//! the link before, and those of the first link to the base: no joint's effort changes, and less is left to compute
//! (W. Khalil, J.-F. Kleinfinger, IEEE J. Robotics and Automation 3, 1987, group parameters so).

use armid::dynamics::TorqueTerms;
use armid::model::{Columns, JointKind, Robot, StandardParameters};
use armid::spatial::Placement;
use nalgebra::{Matrix3, Vector3};

use super::forces::Forces;

/// The angle between two joint axes, where it saves work. Where it does, the link's origin has no z in the frame before: that frame
/// may stand anywhere on its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Twist {
    /// Any angle, and joints that slide along the axis before.
    Any,
    /// Parallel: α = 0.
    Parallel,
    /// At right angles: α = 90° (with γ and β for the sign).
    Right,
}

/// A joint and the link it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) prismatic: bool,
    pub(crate) twist: Twist,
    /// Sine and cosine of α.
    pub(crate) sin: f64,
    pub(crate) cos: f64,
    /// θ, rad.
    pub(crate) offset: f64,
    /// Origin of this link's frame (at zero coordinate) in the frame before it.
    pub(crate) origin: [f64; 3],
    /// Whether the origin is that of the frame before, at every coordinate.
    pub(crate) meets: bool,
    /// Zero behind a revolute joint, as `first[2]` and the last of `second` are.
    pub(crate) mass: f64,
    pub(crate) first: [f64; 3],
    /// xx, xy, xz, yy, yz, zz.
    pub(crate) second: [f64; 6],
    /// Mass of this link and all after it.
    pub(crate) outboard: f64,
}

impl Link {
    /// Moves the frame along its axis, m. Moments of the link follow.
    fn slide(&mut self, along: f64) {
        self.origin[1] -= along * self.sin;
        self.origin[2] += along * self.cos;
        let [x, y, z] = self.first;
        self.second[2] -= along * x;
        self.second[4] -= along * y;
        self.second[5] += along * (along * self.mass - 2.0 * z);
        self.first[2] -= along * self.mass;
    }

    /// Takes from a link behind a revolute joint what moves alike on the link before, about the origin of the frame of that one:
    /// mass, first moment and second moments.
    fn take_from_axis(&mut self) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let (mass, first, second) = (self.mass, self.first[2], self.second[5]);
        (self.mass, self.first[2], self.second[5]) = (0.0, 0.0, 0.0);
        let (axis, origin) = (Vector3::new(0.0, -self.sin, self.cos), Vector3::from(self.origin));
        let shift = axis * origin.transpose() * first;
        let second = axis * axis.transpose() * second + shift + shift.transpose() + origin * origin.transpose() * mass;
        (mass, axis * first + origin * mass, second)
    }

    fn add(&mut self, (mass, first, second): (f64, Vector3<f64>, Matrix3<f64>)) {
        self.mass += mass;
        for j in 0..3 {
            self.first[j] += first[j];
        }
        for (own, (j, k)) in self.second.iter_mut().zip([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]) {
            *own += second[(j, k)];
        }
    }
}

/// All links, motors and torque terms of a robot with N joints.
#[derive(Clone, Debug)]
pub(crate) struct Chain<const N: usize> {
    pub(crate) links: [Link; N],
    /// Upward acceleration of the base that acts like gravity, in the first link's frame before it turns.
    pub(crate) lift: [f64; 3],
    /// Inertia of the rotors.
    pub(crate) rotors: [[f64; N]; N],
    pub(crate) forces: Forces<N>,
}

/// `R = Rz(γ) Rx(α) Rz(β)`: sine and cosine of γ and α, and β.
fn split(r: &Matrix3<f64>) -> ((f64, f64), (f64, f64), f64) {
    let sin = (r[(0, 2)] * r[(0, 2)] + r[(1, 2)] * r[(1, 2)]).sqrt();
    let gamma = if sin > 0.0 { (r[(0, 2)] / sin, -r[(1, 2)] / sin) } else { (0.0, 1.0) };
    // β is the angle of Rz(−γ) R's first column, which Rx(α) leaves in place.
    let (s, c) = gamma;
    let x = c * r[(0, 0)] + s * r[(1, 0)];
    let turned = c * r[(1, 0)] - s * r[(0, 0)];
    let y = r[(2, 2)] * turned + sin * r[(2, 0)];
    (gamma, (sin, r[(2, 2)]), libm::atan2(y, x))
}

impl<const N: usize> Chain<N> {
    /// `N` must be the robot's number of joints.
    pub(crate) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let joints = robot.joints();
        let mut before = Placement::identity();
        let splits: Vec<_> = joints
            .iter()
            .map(|joint| {
                let between = before.compose(&joint.before);
                before = joint.after;
                (between, split(&between.rotation))
            })
            .collect();
        let mut links: Vec<Link> = (0..N)
            .map(|i| {
                let (between, ((sin_gamma, cos_gamma), (sin, cos), beta)) = &splits[i];
                let origin = Placement::rotation_z(-sin_gamma, *cos_gamma).rotation * between.translation;
                let (sin_next, cos_next) = splits.get(i + 1).map_or((0.0, 1.0), |(_, (gamma, _, _))| *gamma);
                let own = Placement::rotation_z(-sin_next, cos_next).compose(&joints[i].after);
                let body = &parameters.links[i];
                let rotated = own.rotation * body.first_moment;
                let sigma = body.pseudo().0.fixed_view::<3, 3>(0, 0).into_owned();
                let shift = rotated * own.translation.transpose();
                let second = own.rotation * sigma * own.rotation.transpose()
                    + shift
                    + shift.transpose()
                    + own.translation * own.translation.transpose() * body.mass;
                let first = rotated + own.translation * body.mass;
                let prismatic = joints[i].kind == JointKind::Prismatic;
                let twist = match (*sin, *cos) {
                    (0.0, 1.0) if !prismatic => Twist::Parallel,
                    (1.0, 0.0) => Twist::Right,
                    _ => Twist::Any,
                };
                Link {
                    prismatic,
                    twist,
                    sin: *sin,
                    cos: *cos,
                    offset: beta + libm::atan2(sin_next, cos_next),
                    origin: origin.into(),
                    meets: false,
                    mass: body.mass,
                    first: first.into(),
                    second: [
                        second[(0, 0)],
                        second[(0, 1)],
                        second[(0, 2)],
                        second[(1, 1)],
                        second[(1, 2)],
                        second[(2, 2)],
                    ],
                    outboard: 0.0,
                }
            })
            .collect();
        for i in (1..N).rev().filter(|&i| links[i].twist != Twist::Any).collect::<Vec<_>>() {
            let along = std::mem::take(&mut links[i].origin[2]);
            links[i - 1].slide(along);
        }
        for link in &mut links {
            link.meets = !link.prismatic && link.origin == [0.0; 3];
        }
        for i in (0..N).rev().filter(|&i| joints[i].kind == JointKind::Revolute) {
            let on_axis = links[i].take_from_axis();
            if i > 0 {
                links[i - 1].add(on_axis);
            }
        }
        let mut outboard = 0.0;
        for link in links.iter_mut().rev() {
            outboard += link.mass;
            link.outboard = outboard;
        }
        let (sin_gamma, cos_gamma) = splits[0].1.0;
        let lift: Vector3<f64> = Placement::rotation_z(-sin_gamma, cos_gamma).rotation * -robot.gravity();
        let (sin, cos) = splits[0].1.1;
        let lift = Vector3::new(lift.x, cos * lift.y + sin * lift.z, cos * lift.z - sin * lift.y);
        let rotors = TorqueTerms::new(robot, Columns::RIGID_ROTOR).inertia(parameters);
        Self {
            links: std::array::from_fn(|i| links[i]),
            lift: lift.into(),
            rotors: std::array::from_fn(|i| std::array::from_fn(|j| rotors[(i, j)])),
            forces: Forces::new(robot, parameters),
        }
    }
}
