//! What a robot and its surroundings look like to a collision check: capsules, boxes, hulls of points, and planes.

use nalgebra::Vector3;

use super::capsule::Capsule;
use super::hull::Hull;
use crate::spatial::Placement;

/// A box, m.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Its centre and axes, in the frame of its link.
    pub placement: Placement,
    /// Half of its lengths along its own axes.
    #[serde(with = "crate::plain::vector")]
    pub half: Vector3<f64>,
}

/// A convex body.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Solid {
    /// A rounded rod; a ball where it has no length.
    Capsule(Capsule),
    /// A box.
    Cuboid(Cuboid),
    /// The hull of some points.
    Hull(Hull),
}

impl Solid {
    /// A capsule that holds the body: the body itself, the box's longest axis thickened to its corners, or a line through a
    /// hull thickened to its points.
    pub fn enclosing_capsule(&self) -> Capsule {
        match self {
            Self::Capsule(capsule) => *capsule,
            Self::Cuboid(Cuboid { placement, half }) => {
                let long = half.imax();
                let axis = placement.rotation.column(long) * half[long];
                let radius = (half.norm_squared() - half[long] * half[long]).sqrt();
                Capsule { from: placement.translation - axis, to: placement.translation + axis, radius }
            }
            Self::Hull(hull) => hull.enclosing_capsule(),
        }
    }

    /// The furthest that the body reaches along a unit vector of its frame, m.
    pub fn extent(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Self::Capsule(Capsule { from, to, radius }) => direction.dot(from).max(direction.dot(to)) + radius,
            Self::Cuboid(Cuboid { placement, half }) => {
                let along = placement.rotation.tr_mul(direction);
                direction.dot(&placement.translation) + along.abs().dot(half)
            }
            Self::Hull(hull) => hull.extent(direction),
        }
    }

    /// Largest distance of a point of the body from the origin of its frame, m.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Capsule(Capsule { from, to, radius }) => from.norm().max(to.norm()) + radius,
            Self::Cuboid(Cuboid { placement, half }) => placement.translation.norm() + half.norm(),
            Self::Hull(Hull { points, margin }) => points.iter().map(Vector3::norm).fold(0.0, f64::max) + margin,
        }
    }
}

/// The shape of one link, for collisions and for what a link can weigh; `link` 0 is the base, link i the i-th.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// The link whose frame the body is given in; 0 is the base.
    pub link: usize,
    /// What it looks like.
    pub solid: Solid,
}

/// Something that stands in the way, in the base frame.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Obstacle {
    /// Everything below the height `z`, m.
    Floor {
        /// Height in the base frame, m.
        z: f64,
    },
    /// Everything behind a plane: the robot keeps to `normal · x ≥ offset`.
    Plane {
        /// What messages call it.
        name: String,
        /// Unit vector towards the side that is free.
        #[serde(with = "crate::plain::vector")]
        normal: Vector3<f64>,
        /// Distance of the plane from the origin along the normal, m.
        offset: f64,
    },
    /// A body that stands still.
    Body {
        /// What messages call it.
        name: String,
        /// What it looks like.
        solid: Solid,
    },
}

impl Obstacle {
    /// Everything below the height `z` (m, base frame), under a name of its own.
    pub fn everything_below(name: &str, z: f64) -> Self {
        Self::Plane { name: name.to_owned(), normal: Vector3::z(), offset: z }
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        match self {
            Self::Floor { .. } => "floor",
            Self::Plane { name, .. } | Self::Body { name, .. } => name,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_capsule_around_a_box_reaches_its_corners() {
        let half = Vector3::new(0.3, 0.1, 0.2);
        let placement = Placement::translation(0.0, 0.0, 1.0);
        let solid = Solid::Cuboid(Cuboid { placement, half });
        let capsule = solid.enclosing_capsule();
        assert_eq!((capsule.from.x, capsule.to.x), (-0.3, 0.3));
        assert!((capsule.radius - libm::hypot(0.1, 0.2)).abs() < 1e-15);
        assert!((solid.reach() - (1.0 + half.norm())).abs() < 1e-15);
    }
}
