//! Collision shapes as a URDF states them.
//!
//! ```text
//! <collision><origin xyz="…" rpy="…"/><geometry> box | cylinder | sphere | capsule | mesh </geometry></collision>
//! ```
//! Cylinders and capsules are about the z axis of their frame; `length` of a capsule is that between the centres of its ends.
//! What cannot be read is a shape with a fault: it does not stop the robot from being read, and nothing can be held against it.

use nalgebra::Vector3;

use super::element::Element;
use super::error::FormatError;
use crate::model::capsule::Capsule;
use crate::model::hull::Hull;
use crate::model::shape::{Cuboid, Solid};
use crate::spatial::Placement;

/// What a collision shape looks like in its own frame, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A box, by half of its lengths.
    Cuboid(Vector3<f64>),
    /// A cylinder about z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half of its length.
        half_length: f64,
    },
    /// A capsule about z.
    Capsule {
        /// Radius.
        radius: f64,
        /// Half of the distance between the centres of its ends.
        half_length: f64,
    },
    /// A ball.
    Sphere(f64),
    /// The points of a file, whose convex hull counts.
    Mesh {
        /// The file as the text names it: a path, `package://…` or `file://…`.
        file: String,
        /// Factors on the three coordinates.
        scale: Vector3<f64>,
    },
}

impl Geometry {
    /// What it is called: `box`, `cylinder`, `capsule`, `sphere`, `mesh`.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Cuboid(_) => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Sphere(_) => "sphere",
            Self::Mesh { .. } => "mesh",
        }
    }
}

/// A collision shape of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct CollisionShape {
    /// The link of the chain that carries it; 0 is the base and what stands with it.
    pub link: usize,
    /// What the file calls its link.
    pub body: String,
    /// Its frame in that of the chain's link.
    pub placement: Placement,
    /// What it looks like, or why that is not known.
    pub geometry: Result<Geometry, FormatError>,
}

impl CollisionShape {
    /// The shape as a body in the frame of its link: exact for boxes, balls and capsules, within the margin of a [`Hull`]
    /// for cylinders and meshes. `points` are those of a mesh, as its file has them.
    ///
    /// `None` where the shape could not be read or a mesh has no points.
    pub fn solid(&self, points: &[Vector3<f64>]) -> Option<Solid> {
        let placement = &self.placement;
        let rod = |half_length: f64, radius: f64| {
            let along = Vector3::z() * half_length;
            let (from, to) = (placement.point(&-along), placement.point(&along));
            Solid::Capsule(Capsule { from, to, radius })
        };
        let around = |points: Vec<Vector3<f64>>| Hull::enclosing(&points).map(Solid::Hull);
        match self.geometry.as_ref().ok()? {
            Geometry::Cuboid(half) if half.min() > 0.0 => {
                Some(Solid::Cuboid(Cuboid { placement: *placement, half: *half }))
            }
            // A plate without thickness.
            Geometry::Cuboid(half) => {
                let sign = |k: usize, axis: usize| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner = |k: usize| Vector3::new(sign(k, 0), sign(k, 1), sign(k, 2)).component_mul(half);
                around((0..8).map(|k| placement.point(&corner(k))).collect())
            }
            Geometry::Cylinder { radius, half_length } => {
                Some(Solid::Hull(Hull::cylinder(placement, *radius, *half_length)))
            }
            Geometry::Capsule { radius, half_length } => Some(rod(*half_length, *radius)),
            Geometry::Sphere(radius) => Some(rod(0.0, *radius)),
            Geometry::Mesh { scale, .. } => {
                around(points.iter().map(|p| placement.point(&p.component_mul(scale))).collect())
            }
        }
    }
}

/// The geometry of a `<collision>`.
pub(super) fn read_geometry(collision: Element<'_>) -> Result<Geometry, FormatError> {
    let Some(geometry) = collision.only("geometry")? else {
        return collision.fault("<collision> has no <geometry>, expected one");
    };
    let mut shapes = geometry.elements();
    let (Some(shape), None) = (shapes.next(), shapes.next()) else {
        let found = geometry.elements().count();
        return geometry.fault(format!("<geometry> has {found} shapes, expected one"));
    };
    let above_zero = |key: &'static str| {
        let value = shape.required_number(key)?;
        if value > 0.0 {
            return Ok(value);
        }
        let message = format!("{key} is {value}, expected a number above zero");
        shape.check.fault(shape.required(key)?.range_value(), message)
    };
    match shape.tag() {
        "box" => {
            let size = shape.required("size")?;
            let half = 0.5 * Vector3::from(shape.numbers_of::<3>(&size)?);
            if half.min() < 0.0 {
                let message = format!("size is \"{}\", expected three numbers not below zero", size.value());
                return shape.check.fault(size.range_value(), message);
            }
            Ok(Geometry::Cuboid(half))
        }
        "cylinder" => Ok(Geometry::Cylinder {
            radius: above_zero("radius")?,
            half_length: 0.5 * shape.number_not_below_zero("length")?,
        }),
        "capsule" => Ok(Geometry::Capsule {
            radius: above_zero("radius")?,
            half_length: 0.5 * shape.number_not_below_zero("length")?,
        }),
        "sphere" => Ok(Geometry::Sphere(above_zero("radius")?)),
        "mesh" => Ok(Geometry::Mesh {
            file: shape.required("filename")?.value().to_owned(),
            scale: shape.numbers("scale")?.map_or_else(|| Vector3::repeat(1.0), Vector3::from),
        }),
        other => shape
            .fault(format!("<{other}> is no shape that is known, expected a box, cylinder, sphere, capsule or mesh")),
    }
}
