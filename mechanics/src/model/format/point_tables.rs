//! The part of `robot.toml` that names points of the arm.
//!
//! ```text
//! [[point]]                        # a point of a link whose speed matters
//! name = "gripper_tip"
//! link = "tool_roll"               # or "base"
//! position_m = [0, 0, 0.12]        # in the frame of the link
//! ```

use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Row};
use crate::model::point::NamedPoint;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointTable {
    name: Spanned<String>,
    link: Spanned<String>,
    position_m: Row,
}

/// Every named point, each name once; `link_index` finds a link by its name.
pub(super) fn read_points(
    check: Check<'_>,
    tables: &[PointTable],
    link_index: &dyn Fn(&Spanned<String>) -> Result<usize, FormatError>,
) -> Result<Vec<NamedPoint>, FormatError> {
    let mut points: Vec<NamedPoint> = Vec::with_capacity(tables.len());
    for table in tables {
        let name = table.name.get_ref();
        if name.is_empty() || name == "flange" || points.iter().any(|point| point.name == *name) {
            let message = format!("point name \"{name}\" is taken, expected one that no other point has");
            return check.fault(table.name.span(), message);
        }
        let (link, position) = (link_index(&table.link)?, check.vector("position_m", &table.position_m)?);
        points.push(NamedPoint { name: name.clone(), link, position });
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use crate::model::format::parse_robot;

    const ROBOT: &str = r#"
name = "two"
convention = "standard"
effort = "torque"
[[joint]]
name = "first"
kind = "revolute"
dh = { offset_deg = 0, d_m = 0, a_m = 0.5, alpha_deg = 0 }
[[joint]]
name = "second"
kind = "revolute"
dh = { offset_deg = 0, d_m = 0, a_m = 0.25, alpha_deg = 0 }
"#;

    #[test]
    fn analytic_a_point_is_carried_by_its_link() {
        let text = format!(
            "{ROBOT}[[point]]\nname = \"elbow\"\nlink = \"first\"\nposition_m = [0, 0.1, 0]\n\
             [[point]]\nname = \"foot\"\nlink = \"base\"\nposition_m = [0.3, 0, 0]\n"
        );
        let robot = parse_robot(&text).unwrap();
        let poses = robot.poses(&[std::f64::consts::FRAC_PI_2, 1.0]);
        let [elbow, foot] = robot.points() else { panic!("{:?}", robot.points()) };
        // The first link points along y; what is beside it by 0.1 m is at x = −0.1.
        assert!((elbow.place(&poses) - Vector3::new(-0.1, 0.5, 0.0)).norm() < 1e-15);
        assert_eq!(foot.place(&poses), Vector3::new(0.3, 0.0, 0.0));
        assert!(parse_robot(ROBOT).unwrap().points().is_empty());
    }

    #[test]
    fn points_that_cannot_be_are_named_with_their_place() {
        for (point, line, word) in [
            ("name = \"a\"\nlink = \"third\"\nposition_m = [0, 0, 0]", 15, "link \"third\" is not there"),
            ("name = \"a\"\nlink = \"first\"\nposition_m = [0, 0]", 16, "position_m has 2 numbers, expected 3"),
            ("name = \"a\"\nlink = \"first\"\nposition_m = [0, 0, nan]", 16, "expected a finite number"),
            ("name = \"flange\"\nlink = \"first\"\nposition_m = [0, 0, 0]", 14, "point name \"flange\" is taken"),
            ("name = \"\"\nlink = \"first\"\nposition_m = [0, 0, 0]", 14, "point name \"\" is taken"),
            ("name = \"a\"\nlink = \"first\"\nposition = [0, 0, 0]", 16, "unknown field `position`"),
        ] {
            let fault = parse_robot(&format!("{ROBOT}[[point]]\n{point}\n")).unwrap_err();
            assert!(fault.line == line && fault.to_string().contains(word), "{fault:?}");
        }
        let twice = "[[point]]\nname = \"a\"\nlink = \"first\"\nposition_m = [0, 0, 0]\n".repeat(2);
        assert!(parse_robot(&format!("{ROBOT}{twice}")).unwrap_err().to_string().contains("\"a\" is taken"));
    }
}
