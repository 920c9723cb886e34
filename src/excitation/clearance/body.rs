//! Bodies in space and the distance between two of them.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::contact;
use parry3d_f64::query::details::closest_points_segment_segment_with_locations;
use parry3d_f64::shape::{Cuboid as ParryCuboid, Segment, Shape};

use crate::model::{Obstacle, Solid};
use crate::spatial::Placement;

/// Beyond this, m, two bodies are not looked at more closely.
const FAR: f64 = 1e6;

/// Something that does not move, in the base frame.
#[derive(Clone, Debug)]
pub enum Still {
    /// A body.
    Body(Solid),
    /// Everything with `normal · x < offset`.
    HalfSpace {
        /// Unit vector out of it.
        normal: Vector3<f64>,
        /// Where it ends along the normal, m.
        offset: f64,
    },
}

impl Still {
    /// What an obstacle of a robot file is to a distance.
    #[must_use]
    pub fn of(obstacle: &Obstacle) -> Self {
        match obstacle {
            Obstacle::Floor { z } => Self::HalfSpace { normal: Vector3::z(), offset: *z },
            Obstacle::Plane { normal, offset, .. } => Self::HalfSpace { normal: *normal, offset: *offset },
            Obstacle::Body { solid, .. } => Self::Body(*solid),
        }
    }
}

/// How far two bodies are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Distance between the surfaces, m; negative where they overlap.
    pub distance: f64,
    /// Unit vector from the first body to the second: along it the second moves away.
    pub normal: Vector3<f64>,
    /// The nearest point of the second body, or of its core line.
    pub point: Vector3<f64>,
}

/// A body where it stands: a core, of which every point within `radius` belongs to the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    core: Core,
    radius: f64,
    /// A ball around the core.
    centre: Vector3<f64>,
    ball: f64,
}

#[derive(Clone, Copy, Debug)]
enum Core {
    Line(Vector3<f64>, Vector3<f64>),
    Cuboid(Placement, Vector3<f64>),
}

impl Placed {
    /// A body of a link whose frame stands at `pose`.
    pub(super) fn new(solid: &Solid, pose: &Placement) -> Self {
        match solid {
            Solid::Capsule(capsule) => {
                let (from, to) = (pose.point(&capsule.from), pose.point(&capsule.to));
                let ball = 0.5 * (to - from).norm();
                Self { core: Core::Line(from, to), radius: capsule.radius, centre: 0.5 * (from + to), ball }
            }
            Solid::Cuboid(cuboid) => {
                let placement = pose.compose(&cuboid.placement);
                let core = Core::Cuboid(placement, cuboid.half);
                Self { core, radius: 0.0, centre: placement.translation, ball: cuboid.half.norm() }
            }
        }
    }

    /// No less than the distance to another body, cheaply: that of the balls around them.
    pub(super) fn at_least(&self, other: &Self) -> f64 {
        (other.centre - self.centre).norm() - self.ball - other.ball - self.radius - other.radius
    }

    /// The distance to a second body.
    pub(super) fn separation(&self, second: &Self) -> Separation {
        let (first, radii) = (self, self.radius + second.radius);
        let (normal, core_distance, point) = match (&first.core, &second.core) {
            (Core::Line(a, b), Core::Line(c, d)) => lines((a, b), (c, d)),
            // A separating normal and distance, or those of the deepest overlap.
            (x, y) => match contact(&x.pose(), &*x.shape(), &y.pose(), &*y.shape(), FAR) {
                Ok(Some(contact)) => (from_parry(contact.normal1), contact.dist, from_parry(contact.point2)),
                _ => (Vector3::z(), 0.0, second.centre),
            },
        };
        Separation { distance: core_distance - radii, normal, point }
    }

    /// The distance from a half space.
    pub(super) fn above(&self, normal: &Vector3<f64>, offset: f64) -> Separation {
        let lowest = match &self.core {
            Core::Line(from, to) => {
                if normal.dot(from) <= normal.dot(to) {
                    *from
                } else {
                    *to
                }
            }
            Core::Cuboid(placement, half) => {
                let local = placement.rotation.tr_mul(normal);
                placement.point(&half.zip_map(&local, |half, along| if along > 0.0 { -half } else { half }))
            }
        };
        Separation { distance: normal.dot(&lowest) - offset - self.radius, normal: *normal, point: lowest }
    }
}

impl Core {
    /// The shape in the core's own frame.
    fn shape(&self) -> Box<dyn Shape> {
        match self {
            Self::Line(a, b) => Box::new(segment(a, b)),
            Self::Cuboid(_, half) => Box::new(ParryCuboid::new(to_parry(half))),
        }
    }

    /// Where the core's own frame stands; a line is given in the base frame.
    fn pose(&self) -> Pose {
        match self {
            Self::Line(..) => Pose::IDENTITY,
            Self::Cuboid(placement, _) => {
                let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(placement.rotation));
                let rotation = Rotation::from_xyzw(turn.i, turn.j, turn.k, turn.w);
                Pose::from_parts(to_parry(&placement.translation), rotation)
            }
        }
    }
}

/// Direction, distance and nearest point of the second of two lines; where they meet, any direction across both.
fn lines(
    (a, b): (&Vector3<f64>, &Vector3<f64>),
    (c, d): (&Vector3<f64>, &Vector3<f64>),
) -> (Vector3<f64>, f64, Vector3<f64>) {
    let (first, second) = (segment(a, b), segment(c, d));
    let (on_first, on_second) = closest_points_segment_segment_with_locations(&Pose::IDENTITY, &first, &second);
    let (p, q) = (from_parry(first.point_at(&on_first)), from_parry(second.point_at(&on_second)));
    let apart = q - p;
    let distance = apart.norm();
    let normal = if distance > 0.0 {
        apart / distance
    } else {
        (b - a).cross(&(d - c)).try_normalize(0.0).unwrap_or_else(Vector3::z)
    };
    (normal, distance, q)
}

fn segment(a: &Vector3<f64>, b: &Vector3<f64>) -> Segment {
    Segment::new(to_parry(a), to_parry(b))
}

fn to_parry(x: &Vector3<f64>) -> Vector {
    Vector::new(x.x, x.y, x.z)
}

fn from_parry(x: Vector) -> Vector3<f64> {
    Vector3::new(x.x, x.y, x.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Capsule, Cuboid};

    fn rod(from: [f64; 3], to: [f64; 3], radius: f64) -> Placed {
        let capsule = Capsule { from: from.into(), to: to.into(), radius };
        Placed::new(&Solid::Capsule(capsule), &Placement::identity())
    }

    fn block(centre: [f64; 3], half: [f64; 3]) -> Placed {
        let placement = Placement::translation(centre[0], centre[1], centre[2]);
        Placed::new(&Solid::Cuboid(Cuboid { placement, half: half.into() }), &Placement::identity())
    }

    #[test]
    fn analytic_distances_of_rods_boxes_and_planes() {
        let along_x = rod([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.1);
        let along_y = rod([0.2, -1.0, 0.5], [0.2, 1.0, 0.5], 0.05);
        let crossed = along_x.separation(&along_y);
        assert!((crossed.distance - 0.35).abs() < 1e-14 && (crossed.normal - Vector3::z()).norm() < 1e-14);
        assert!((crossed.point - Vector3::new(0.2, 0.0, 0.5)).norm() < 1e-14);
        // Parallel rods, and rods whose cores meet.
        assert!((along_x.separation(&rod([0.0, 0.3, 0.0], [2.0, 0.3, 0.0], 0.1)).distance - 0.1).abs() < 1e-14);
        let meeting = along_x.separation(&rod([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.1));
        assert!((meeting.distance + 0.2).abs() < 1e-14 && (meeting.normal.y.abs() - 1.0).abs() < 1e-14);
        // A box of edges 1, seen by a rod above its top, and a rod that dives in by 0.2 from above.
        let cube = block([0.0, 0.0, -0.5], [0.5, 0.5, 0.5]);
        let above = cube.separation(&rod([-0.2, 0.1, 0.3], [0.3, 0.0, 0.4], 0.1));
        assert!((above.distance - 0.2).abs() < 1e-9 && (above.normal - Vector3::z()).norm() < 1e-7, "{above:?}");
        let below = rod([-0.2, 0.1, 0.3], [0.3, 0.0, 0.4], 0.1).separation(&cube);
        assert!((below.distance - 0.2).abs() < 1e-9 && (below.normal + Vector3::z()).norm() < 1e-7, "{below:?}");
        let inside = cube.separation(&rod([0.0, 0.0, -0.2], [0.0, 0.0, 1.0], 0.1));
        assert!((inside.distance + 0.3).abs() < 1e-9, "{inside:?}");
        let corner = cube.separation(&block([2.0, 2.0, 1.5], [0.5, 0.5, 0.5]));
        assert!((corner.distance - (3.0_f64).sqrt()).abs() < 1e-9, "{corner:?}");
        let floor = along_y.above(&Vector3::z(), 0.2);
        assert!((floor.distance - 0.25).abs() < 1e-15);
        assert!((cube.above(&Vector3::x(), -1.0).distance - 0.5).abs() < 1e-15);
        for pair in [(&along_x, &along_y), (&cube, &along_y)] {
            assert!(pair.0.at_least(pair.1) <= pair.0.separation(pair.1).distance + 1e-12);
        }
    }
}
