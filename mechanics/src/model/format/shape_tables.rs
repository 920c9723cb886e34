//! The part of `robot.toml` that says what the arm and its surroundings look like.
//!
//! ```text
//! [[shape]]                        # of a link: a capsule, or a box
//! link = "elbow"                   # or "base"
//! from_m = [0, 0, 0]               # capsule: from, to, radius
//! to_m = [0, 0, 0.33]
//! radius_m = 0.065
//!
//! [[obstacle]]                     # in the base frame: a capsule, a box, or a plane
//! name = "cabinet"
//! centre_m = [0.8, 0, 0.5]         # box: centre, whole lengths, and where it is turned
//! size_m = [0.2, 1.0, 1.0]
//! roll_pitch_yaw_deg = [0, 0, 30]
//!
//! [[obstacle]]
//! name = "wall"
//! normal = [0, -1, 0]              # plane: the robot keeps to normal · x ≥ offset, here y ≤ 0.6
//! offset_m = -0.6
//!
//! [[may_touch]]                    # a pair of links that is not checked
//! links = ["base", "shoulder"]
//! ```

use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Number, Row, quoted, roll_pitch_yaw};
use crate::model::capsule::Capsule;
use crate::model::shape::{Cuboid, Obstacle, Shape, Solid};
use crate::spatial::Placement;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeTable {
    link: Spanned<String>,
    from_m: Option<Row>,
    to_m: Option<Row>,
    radius_m: Option<Number>,
    centre_m: Option<Row>,
    size_m: Option<Row>,
    roll_pitch_yaw_deg: Option<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObstacleTable {
    name: Spanned<String>,
    from_m: Option<Row>,
    to_m: Option<Row>,
    radius_m: Option<Number>,
    centre_m: Option<Row>,
    size_m: Option<Row>,
    roll_pitch_yaw_deg: Option<Row>,
    normal: Option<Row>,
    offset_m: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TouchTable {
    links: Spanned<Vec<Spanned<String>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FloorTable {
    z_m: Number,
}

/// The keys of one body, of which either the first three or the next ones are there.
struct BodyKeys<'a> {
    capsule: (Option<&'a Row>, Option<&'a Row>, Option<&'a Number>),
    cuboid: (Option<&'a Row>, Option<&'a Row>, Option<&'a Row>),
    /// What the faults point at.
    owner: &'a Spanned<String>,
}

impl BodyKeys<'_> {
    fn read(&self, check: Check<'_>) -> Result<Solid, FormatError> {
        match (self.capsule, self.cuboid) {
            ((Some(from), Some(to), Some(radius)), (None, None, None)) => Ok(Solid::Capsule(Capsule {
                from: check.vector("from_m", from)?,
                to: check.vector("to_m", to)?,
                radius: check.positive("radius_m", radius)?,
            })),
            ((None, None, None), (Some(centre), Some(size), turn)) => {
                let half = 0.5 * check.vector("size_m", size)?;
                if half.min() <= 0.0 {
                    return check.fault(size.span(), "size_m has a length that is not above zero, expected three");
                }
                let mut placement = Placement::identity();
                placement.translation = check.vector("centre_m", centre)?;
                if let Some(turn) = turn {
                    placement.rotation = roll_pitch_yaw(check.numbers("roll_pitch_yaw_deg", turn)?);
                }
                Ok(Solid::Cuboid(Cuboid { placement, half }))
            }
            _ => {
                let message = format!(
                    "the body of \"{}\" is neither a capsule nor a box, expected from_m, to_m and radius_m, or \
                     centre_m and size_m",
                    self.owner.get_ref()
                );
                check.fault(self.owner.span(), message)
            }
        }
    }
}

/// Index of a link by the name of the joint that moves it; 0 is the base.
pub(super) fn link_index(check: Check<'_>, link: &Spanned<String>, joints: &[&str]) -> Result<usize, FormatError> {
    let name = link.get_ref();
    let found = if name == "base" { Some(0) } else { joints.iter().position(|joint| joint == name).map(|i| i + 1) };
    match found {
        Some(link) => Ok(link),
        None => {
            let message = format!("link \"{name}\" is not there, expected \"base\" or one of {}", quoted(joints));
            check.fault(link.span(), message)
        }
    }
}

pub(super) fn read_shape(check: Check<'_>, table: &ShapeTable, joints: &[&str]) -> Result<Shape, FormatError> {
    let link = link_index(check, &table.link, joints)?;
    let keys = BodyKeys {
        capsule: (table.from_m.as_ref(), table.to_m.as_ref(), table.radius_m.as_ref()),
        cuboid: (table.centre_m.as_ref(), table.size_m.as_ref(), table.roll_pitch_yaw_deg.as_ref()),
        owner: &table.link,
    };
    Ok(Shape { link, solid: keys.read(check)? })
}

/// The floor and everything else that stands around.
pub(super) fn read_obstacles(
    check: Check<'_>,
    floor: Option<&FloorTable>,
    tables: &[ObstacleTable],
) -> Result<Vec<Obstacle>, FormatError> {
    let mut obstacles = Vec::new();
    if let Some(floor) = floor {
        obstacles.push(Obstacle::Floor { z: check.finite("z_m", &floor.z_m)? });
    }
    for table in tables {
        obstacles.push(read_obstacle(check, table)?);
    }
    Ok(obstacles)
}

fn read_obstacle(check: Check<'_>, table: &ObstacleTable) -> Result<Obstacle, FormatError> {
    let name = table.name.get_ref().clone();
    let keys = BodyKeys {
        capsule: (table.from_m.as_ref(), table.to_m.as_ref(), table.radius_m.as_ref()),
        cuboid: (table.centre_m.as_ref(), table.size_m.as_ref(), table.roll_pitch_yaw_deg.as_ref()),
        owner: &table.name,
    };
    let no_body = matches!((keys.capsule, keys.cuboid), ((None, None, None), (None, None, None)));
    match (&table.normal, &table.offset_m) {
        (Some(row), Some(offset)) if no_body => {
            let normal = check.vector("normal", row)?;
            let length = normal.norm();
            if length <= 0.0 {
                return check.fault(row.span(), "normal has no direction, expected a vector other than zero");
            }
            Ok(Obstacle::Plane { name, normal: normal / length, offset: check.finite("offset_m", offset)? })
        }
        (None, None) => Ok(Obstacle::Body { name, solid: keys.read(check)? }),
        _ => {
            let message =
                format!("obstacle \"{name}\" mixes kinds, expected normal and offset_m alone, or the keys of one body");
            check.fault(table.name.span(), message)
        }
    }
}

/// A pair of links that is not checked, the lower first.
pub(super) fn read_touch(check: Check<'_>, table: &TouchTable, joints: &[&str]) -> Result<(usize, usize), FormatError> {
    let links = table.links.get_ref();
    let [first, second] = links.as_slice() else {
        return check.fault(table.links.span(), format!("links has {} names, expected 2", links.len()));
    };
    let (first, second) = (link_index(check, first, joints)?, link_index(check, second, joints)?);
    Ok((first.min(second), first.max(second)))
}
