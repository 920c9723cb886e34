//! Parameters back into the text that [`parse_parameters`](super::parse_parameters) reads.

use std::fmt::Write;

use crate::model::{JointKind, Robot, StandardParameters};

/// Writes a set of parameters as TOML that [`parse_parameters`](super::parse_parameters) reads back to the last bit.
///
/// First moments and inertias are about the origin of each link's frame, where they are stored. `header` stands on top
/// as a comment.
#[must_use]
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
        let (inertia, viscous, force) = match joint.kind {
            JointKind::Revolute => ("kg_m2", "nm_s_rad", "nm"),
            JointKind::Prismatic => ("kg", "n_s_m", "n"),
        };
        let _ = write!(
            out,
            "\n[[drive]]\njoint = {name}\nrotor_{inertia} = {:?}\nviscous_{viscous} = {:?}\ncoulomb_{force} = \
             {:?}\noffset_{force} = {:?}\n",
            drive.rotor, drive.viscous, drive.coulomb, drive.offset
        );
        if robot.is_coupled(index) {
            let _ = write!(
                out,
                "motor_viscous_{viscous} = {:?}\nmotor_coulomb_{force} = {:?}\n",
                drive.motor_viscous, drive.motor_coulomb
            );
        }
    }
    out
}
