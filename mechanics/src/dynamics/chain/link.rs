//! A joint and the link it moves, in a frame that stands on the joint.

use nalgebra::{Matrix3, Vector3};

use crate::lanes::Lane;
use crate::model::{JointKind, Robot};
use crate::spatial::{Inertia, Placement};

/// The angle between two joint axes, where it saves work. Where it does, the link's origin has no z in the frame before: that frame
/// may stand anywhere on its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::dynamics) enum Twist {
    /// Any angle, and joints that slide along the axis before.
    Any,
    /// Parallel: α = 0.
    Parallel,
    /// At right angles: α = 90° (with γ and β for the sign).
    Right,
}

/// A joint and the link it moves.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub(in crate::dynamics) prismatic: bool,
    pub(in crate::dynamics) twist: Twist,
    /// Sine and cosine of α.
    pub(in crate::dynamics) sin: f64,
    pub(in crate::dynamics) cos: f64,
    /// θ, rad.
    pub(in crate::dynamics) offset: f64,
    /// Origin of this link's frame (at zero coordinate) in the frame before it.
    pub(in crate::dynamics) origin: [f64; 3],
    /// Whether the origin is that of the frame before, at every coordinate.
    pub(in crate::dynamics) meets: bool,
    /// Zero behind a revolute joint, as `first[2]` and the last of `second` are.
    pub(in crate::dynamics) mass: f64,
    pub(in crate::dynamics) first: [f64; 3],
    /// xx, xy, xz, yy, yz, zz.
    pub(in crate::dynamics) second: [f64; 6],
    /// Mass of this link and all after it.
    pub(in crate::dynamics) outboard: f64,
}

impl Link {
    /// The angle about the axis at coordinate `q`, rad.
    #[inline(always)]
    pub fn angle<V: Lane>(&self, q: V) -> V {
        let offset = q.splat(self.offset);
        if self.prismatic { offset } else { q + offset }
    }

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

/// All links of a robot.
#[derive(Clone, Debug)]
pub struct Links {
    /// From the base to the tip.
    pub links: Vec<Link>,
    /// Upward acceleration of the base that acts like gravity, in the first link's frame before it turns, m/s².
    pub lift: [f64; 3],
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

impl Links {
    /// Of a robot whose links have these inertias.
    ///
    /// # Panics
    /// If they are not as many as its joints.
    pub fn new(robot: &Robot, inertias: &[Inertia]) -> Self {
        let joints = robot.joints();
        let n = joints.len();
        let mut before = Placement::identity();
        let splits: Vec<_> = joints
            .iter()
            .map(|joint| {
                let between = before.compose(&joint.before);
                before = joint.after;
                (between, split(&between.rotation))
            })
            .collect();
        let mut links: Vec<Link> = (0..n)
            .map(|i| {
                let (between, ((sin_gamma, cos_gamma), (sin, cos), beta)) = &splits[i];
                let origin = Placement::rotation_z(-sin_gamma, *cos_gamma).rotation * between.translation;
                let (sin_next, cos_next) = splits.get(i + 1).map_or((0.0, 1.0), |(_, (gamma, _, _))| *gamma);
                let own = Placement::rotation_z(-sin_next, cos_next).compose(&joints[i].after);
                let body = &inertias[i];
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
        for i in (1..n).rev().filter(|&i| links[i].twist != Twist::Any).collect::<Vec<_>>() {
            let along = std::mem::take(&mut links[i].origin[2]);
            links[i - 1].slide(along);
        }
        for link in &mut links {
            link.meets = !link.prismatic && link.origin == [0.0; 3];
        }
        for i in (0..n).rev().filter(|&i| joints[i].kind == JointKind::Revolute) {
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
        Self { links, lift: lift.into() }
    }
}
