//! Parameters back into the text that [`parse_parameters`](super::parse_parameters) reads.

use std::fmt::Write;

use super::shape_parameters::laws;
use crate::model::columns::Columns;
use crate::model::parameters::StandardParameters;
use crate::model::robot::Robot;

/// Writes a set of parameters as TOML that [`parse_parameters`](super::parse_parameters) reads back to the last bit, with the numbers of
/// the robot's laws of friction that they were estimated with.
///
/// First moments and inertias are about the origin of each link's frame, where they are stored. `header` stands on top
/// as a comment.
pub fn write_parameters(robot: &Robot, parameters: &StandardParameters, header: &str) -> String {
    let mut out: String = header.lines().map(|line| format!("# {line}\n")).collect();
    for (joint, link) in robot.joints().iter().zip(&parameters.links) {
        let [m, x, y, z, ixx, ixy, ixz, iyy, iyz, izz] = link.to_array();
        let name = toml::Value::from(joint.name.as_str());
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "\n[[link]]\nname = {name}\nmass_kg = {m:?}\nfirst_moment_kg_m = [{x:?}, {y:?}, {z:?}]\ninertia_kg_m2 = \
             {{ xx = {ixx:?}, xy = {ixy:?}, xz = {ixz:?}, yy = {iyy:?}, yz = {iyz:?}, zz = {izz:?} }}\n"
        );
    }
    for (index, (joint, drive)) in robot.joints().iter().zip(&parameters.drives).enumerate() {
        let name = toml::Value::from(joint.name.as_str());
        let _ = write!(out, "\n[[drive]]\njoint = {name}\n");
        let stated = Columns::default().with_terms_of(parameters);
        for term in stated.terms().filter(|term| term.is_at(robot, index)) {
            let _ = writeln!(out, "{} = {:?}", term.entry().key.for_kind(joint.kind), drive[term]);
        }
        for shape in laws(drive) {
            let _ = writeln!(out, "{} = {:?}", shape.key, joint.drive.shape(&shape));
        }
    }
    out
}
