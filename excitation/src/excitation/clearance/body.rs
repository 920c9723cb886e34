//! Bodies in space and the distance between two of them.

use std::sync::Arc;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::Contact;
use parry3d_f64::query::details::{closest_points_segment_segment_with_locations, contact_support_map_support_map};
use parry3d_f64::shape::{Cuboid as ParryCuboid, Segment, SupportMap};

use crate::model::{Capsule, PointHull, Solid};
use crate::spatial::Placement;

/// Beyond this, m, two bodies are not looked at more closely.
const FAR: f64 = 1e6;

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
#[derive(Clone, Debug)]
pub(super) struct Placed {
    core: Core,
    radius: f64,
    /// A ball around the core.
    centre: Vector3<f64>,
    ball: f64,
}

#[derive(Clone, Debug)]
enum Core {
    Line(Vector3<f64>, Vector3<f64>),
    Cuboid(Placement, Vector3<f64>),
    Hull(Placement, Arc<HullCore>),
}

/// A hull in its link's frame.
#[derive(Debug)]
struct HullCore {
    support: PointHull,
    middle: Vector3<f64>,
    /// Around the whole body.
    capsule: Capsule,
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
            Solid::Hull(hull) => {
                let middle = hull.middle();
                let support = PointHull::new(&hull.points);
                let core = HullCore { support, middle, capsule: hull.enclosing_capsule() };
                let ball = hull.points.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
                let centre = pose.point(&middle);
                Self { core: Core::Hull(*pose, Arc::new(core)), radius: hull.margin, centre, ball }
            }
        }
    }

    /// Moves this body to where its link's frame is at `pose`; `solid` is what it was made of.
    pub(super) fn moved(&mut self, solid: &Solid, pose: &Placement) {
        if let Core::Hull(placement, hull) = &mut self.core {
            *placement = *pose;
            self.centre = pose.point(&hull.middle);
        } else {
            *self = Self::new(solid, pose);
        }
    }

    /// No less than the distance to another body, cheaply: that of the balls around them, or of the capsules around hulls
    /// where the balls are within `near`.
    pub(super) fn at_least(&self, other: &Self, near: f64) -> f64 {
        let balls = (other.centre - self.centre).norm() - self.ball - other.ball - self.radius - other.radius;
        if balls > near || !(self.is_hull() || other.is_hull()) {
            return balls;
        }
        match (self.rod(), other.rod()) {
            (Some((a, b, first)), Some((c, d, second))) => balls.max(lines((&a, &b), (&c, &d)).1 - first - second),
            _ => balls,
        }
    }

    fn is_hull(&self) -> bool {
        matches!(self.core, Core::Hull(..))
    }

    /// Ends and radius of a rod around the body; of a box there is none.
    fn rod(&self) -> Option<(Vector3<f64>, Vector3<f64>, f64)> {
        match &self.core {
            Core::Line(a, b) => Some((*a, *b, self.radius)),
            Core::Cuboid(..) => None,
            Core::Hull(pose, hull) => {
                let Capsule { from, to, radius } = &hull.capsule;
                Some((pose.point(from), pose.point(to), *radius))
            }
        }
    }

    /// The distance to a second body. Where one of them is a hull it is that between two planes across the normal, one on
    /// each body: never above the true distance, however well the normal was found.
    pub(super) fn separation(&self, second: &Self) -> Separation {
        let (first, radii) = (self, self.radius + second.radius);
        let (normal, core_distance, point) = match (&first.core, &second.core) {
            (Core::Line(a, b), Core::Line(c, d)) => lines((a, b), (c, d)),
            (x @ Core::Hull(..), y) | (x, y @ Core::Hull(..)) => {
                let (normal, point) = x.contact(y).map_or_else(
                    || ((second.centre - first.centre).try_normalize(0.0).unwrap_or_else(Vector3::z), second.centre),
                    |contact| (from_parry(contact.normal1), from_parry(contact.point2)),
                );
                (normal, -y.extent(&-normal) - x.extent(&normal), point)
            }
            // A separating normal and distance, or those of the deepest overlap.
            (x, y) => match x.contact(y) {
                Some(contact) => (from_parry(contact.normal1), contact.dist, from_parry(contact.point2)),
                None => (Vector3::z(), 0.0, second.centre),
            },
        };
        Separation { distance: core_distance - radii, normal, point }
    }

    /// The distance from a half space.
    pub(super) fn above(&self, normal: &Vector3<f64>, offset: f64) -> Separation {
        let lowest = self.core.furthest(&-normal);
        Separation { distance: normal.dot(&lowest) - offset - self.radius, normal: *normal, point: lowest }
    }
}

impl Core {
    /// A point that is furthest along a direction.
    fn furthest(&self, along: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Line(from, to) => {
                if along.dot(from) >= along.dot(to) {
                    *from
                } else {
                    *to
                }
            }
            Self::Cuboid(placement, half) => {
                let local = placement.rotation.tr_mul(along);
                placement.point(&half.zip_map(&local, |half, along| if along < 0.0 { -half } else { half }))
            }
            Self::Hull(pose, hull) => {
                let local = to_parry(&pose.rotation.tr_mul(along));
                pose.point(&from_parry(hull.support.local_support_point(local)))
            }
        }
    }

    /// How far it reaches along a unit vector.
    fn extent(&self, along: &Vector3<f64>) -> f64 {
        along.dot(&self.furthest(along))
    }

    /// Where this core and another come nearest or overlap most, in the base frame; `None` where the iteration did not end.
    fn contact(&self, other: &Self) -> Option<Contact> {
        let (here, there) = (self.pose(), other.pose());
        let (first, second) = (self.support(), other.support());
        let mut found = contact_support_map_support_map(&here.inv_mul(&there), &first, &second, FAR)?;
        found.transform_by_mut(&here, &there);
        Some(found)
    }

    fn support(&self) -> Support<'_> {
        match self {
            Self::Line(a, b) => Support::Line(segment(a, b)),
            Self::Cuboid(_, half) => Support::Cuboid(ParryCuboid::new(to_parry(half))),
            Self::Hull(_, hull) => Support::Hull(&hull.support),
        }
    }

    /// Where the core's own frame stands; a line is given in the base frame.
    fn pose(&self) -> Pose {
        match self {
            Self::Line(..) => Pose::IDENTITY,
            Self::Cuboid(placement, _) | Self::Hull(placement, _) => {
                let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(placement.rotation));
                let rotation = Rotation::from_xyzw(turn.i, turn.j, turn.k, turn.w);
                Pose::from_parts(to_parry(&placement.translation), rotation)
            }
        }
    }
}

/// A core as the furthest of its points along a direction of its own frame.
enum Support<'a> {
    Line(Segment),
    Cuboid(ParryCuboid),
    Hull(&'a PointHull),
}

impl SupportMap for Support<'_> {
    fn local_support_point(&self, direction: Vector) -> Vector {
        match self {
            Self::Line(line) => line.local_support_point(direction),
            Self::Cuboid(cuboid) => cuboid.local_support_point(direction),
            Self::Hull(hull) => hull.local_support_point(direction),
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
    fn analytic_a_ball_is_a_rod_without_length() {
        let ball = rod([0.0, 0.0, 0.5], [0.0, 0.0, 0.5], 0.1);
        assert!((ball.separation(&rod([1.0, 0.0, 0.5], [1.0, 0.0, 0.5], 0.2)).distance - 0.7).abs() < 1e-15);
        assert!((ball.above(&Vector3::z(), 0.0).distance - 0.4).abs() < 1e-15);
        assert!((block([0.0, 0.0, -0.5], [0.5, 0.5, 0.5]).separation(&ball).distance - 0.4).abs() < 1e-9);
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
            assert!(pair.0.at_least(pair.1, 1e9) <= pair.0.separation(pair.1).distance + 1e-12);
        }
    }
}
