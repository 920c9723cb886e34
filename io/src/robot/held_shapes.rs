//! Which collision shapes of a robot a clearance is held against, and which not and why.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use armid::excitation::clearance::{TouchingLinks, touching_links};
use armid::input::size::COLLISION_SHAPES;
use armid::model::format::{CollisionShape, Geometry};
use armid::model::{Robot, Shape, Solid};
use nalgebra::Vector3;

use super::package_path::PackagePath;
use crate::error::Error;
use crate::mesh;

/// A shape that a clearance is held against.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldShape {
    /// The link of the chain; 0 is the base.
    pub link: usize,
    /// What the file calls its link.
    pub body: String,
    /// What it is: `box`, `capsule`, `cylinder`, `sphere`, `mesh`.
    pub kind: &'static str,
    /// The file of a mesh.
    pub file: Option<PathBuf>,
    /// Points of its hull; none of a shape that is held exactly.
    pub points: usize,
    /// By how much it may be larger than the hull of what the file states, m.
    pub margin_m: f64,
}

/// A shape that nothing is held against.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeLeftOut {
    /// What the file calls its link.
    pub body: String,
    /// What it is; `shape` where that could not be read.
    pub kind: &'static str,
    /// Why.
    pub reason: String,
}

/// What a clearance is held against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeldShapes {
    /// The shapes.
    pub held: Vec<HeldShape>,
    /// Those that are not.
    pub left_out: Vec<ShapeLeftOut>,
    /// Pairs of links that no clearance is held between since no posture keeps them apart.
    pub touching: Vec<TouchingLinks>,
}

/// The robot with the collision shapes of its URDF, whose files lie relative to `folder`.
///
/// A link for which the robot has shapes already keeps those. Pairs of links that come within `clearance` (m) in nearly
/// every posture may touch.
pub(super) fn hold(
    robot: &Robot,
    shapes: &[CollisionShape],
    packages: &PackagePath,
    folder: Option<&Path>,
    clearance: f64,
) -> Result<(Robot, HeldShapes), Error> {
    COLLISION_SHAPES.check_count("number of collision shapes", shapes.len())?;
    let mut found = HeldShapes { held: own(robot), ..HeldShapes::default() };
    let mut meshes = Meshes { packages, folder, read: HashMap::new() };
    let mut all = robot.shapes().to_vec();
    for shape in shapes {
        let kind = shape.geometry.as_ref().map_or("shape", Geometry::kind);
        let solid = if robot.shapes().iter().any(|own| own.link == shape.link) {
            Err("the robot file has shapes of its own for that link".to_owned())
        } else {
            meshes.solid(shape)
        };
        match solid {
            Ok((solid, file)) => {
                let (points, margin_m) = match &solid {
                    Solid::Hull(hull) => (hull.points.len(), hull.margin),
                    Solid::Capsule(_) | Solid::Cuboid(_) => (0, 0.0),
                };
                let body = shape.body.clone();
                found.held.push(HeldShape { link: shape.link, body, kind, file, points, margin_m });
                all.push(Shape { link: shape.link, solid });
            }
            Err(reason) => found.left_out.push(ShapeLeftOut { body: shape.body.clone(), kind, reason }),
        }
    }
    let may_touch = robot.may_touch().to_vec();
    let with = |may_touch| {
        let with = robot.clone().with_spec(|spec| (spec.shapes, spec.may_touch) = (all.clone(), may_touch));
        with.map_err(|error| Error::new(format!("the collision shapes of robot \"{}\": {error}", robot.name())))
    };
    let shaped = with(may_touch.clone())?;
    if all.len() == robot.shapes().len() {
        return Ok((shaped, found));
    }
    found.touching = touching_links(&shaped, clearance);
    let may_touch = may_touch.into_iter().chain(found.touching.iter().map(|touching| touching.links)).collect();
    Ok((with(may_touch)?, found))
}

/// The shapes of a robot file.
fn own(robot: &Robot) -> Vec<HeldShape> {
    let of = |shape: &Shape| {
        let (kind, points, margin_m) = match &shape.solid {
            Solid::Capsule(_) => ("capsule", 0, 0.0),
            Solid::Cuboid(_) => ("box", 0, 0.0),
            Solid::Hull(hull) => ("mesh", hull.points.len(), hull.margin),
        };
        let body = robot.link_name(shape.link).to_owned();
        HeldShape { link: shape.link, body, kind, file: None, points, margin_m }
    };
    robot.shapes().iter().map(of).collect()
}

/// The meshes of a robot, each read once.
struct Meshes<'a> {
    packages: &'a PackagePath,
    folder: Option<&'a Path>,
    read: HashMap<PathBuf, Result<Vec<Vector3<f64>>, String>>,
}

impl Meshes<'_> {
    /// A shape as a body and the file of its points, or why there is none.
    fn solid(&mut self, shape: &CollisionShape) -> Result<(Solid, Option<PathBuf>), String> {
        let without_points = || "it has no points".to_owned();
        match &shape.geometry {
            Err(fault) => Err(fault.to_string()),
            Ok(Geometry::Mesh { file, .. }) => {
                let path = self.packages.find(file, self.folder).map_err(|error| {
                    let help = error.hint().map_or_else(String::new, |help| format!("; {help}"));
                    format!("{error}{help}")
                })?;
                let read = || mesh::read(&path).map_err(|error| error.to_string());
                let points = self.read.entry(path.clone()).or_insert_with(read).as_ref().map_err(Clone::clone)?;
                Ok((shape.solid(points).ok_or_else(without_points)?, Some(path)))
            }
            Ok(_) => Ok((shape.solid(&[]).ok_or_else(without_points)?, None)),
        }
    }
}
