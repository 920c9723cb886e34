//! An MJCF with other parameters: only inertials, armature, damping, frictionloss and force range of the chain's joints change.
//!
//! Names, classes, geoms, actuators, sensors, keyframes, sites, options and the formatting stay byte for byte. Bodies that are fixed to one
//! which a joint moves keep what they can of their inertia ([`SharedInertias`]). What a class of defaults says of a joint is
//! overruled at the joint itself, so that other joints of the class keep theirs. A new inertia is a `fullinertia` in the frame of the body.

use super::element::{Element, parse_xml};
use super::error::FormatError;
use super::mjcf::read_tree;
use super::mjcf_settings::Settings;
use super::shared_inertias::SharedInertias;
use super::text_edit::{EditedText, TextEdit, numbers};
use super::tree::ChainEnds;
use crate::model::parameters::StandardParameters;
use crate::model::robot::Robot;
use crate::model::term::{COULOMB, ROTOR, VISCOUS};
use crate::spatial::Inertia;

/// Puts parameters, and the torque limits of a robot, into the chain that [`parse_mjcf`](super::parse_mjcf) reads.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{ChainEnds, edit_mjcf, parse_mjcf};
/// let text = r#"<mujoco model="pendulum"><option timestep="0.005"/><worldbody><body name="rod">
///   <joint name="swing" axis="0 1 0" armature="0.01"/><geom size="0.1"/>
///   <inertial pos="0 0 -0.5" mass="2" diaginertia="0.1 0.1 0.01"/></body></worldbody></mujoco>"#;
/// let ends = ChainEnds::default();
/// let read = parse_mjcf(text, &ends).unwrap();
/// let mut parameters = read.parameters.clone();
/// assert_eq!(edit_mjcf(text, &ends, &read.robot, &parameters).unwrap().text, text);
/// parameters.links[0].mass = 3.0;
/// parameters.links[0].rotational *= 2.0;
/// let edited = edit_mjcf(text, &ends, &read.robot, &parameters).unwrap().text;
/// assert!(edited.contains("timestep=\"0.005\"") && edited.contains("<geom size=\"0.1\"/>"), "{edited}");
/// assert_eq!(parse_mjcf(&edited, &ends).unwrap().parameters.links[0].mass, 3.0);
/// ```
///
/// # Errors
/// [`FormatError`] as [`parse_mjcf`](super::parse_mjcf), where the parameters are of another chain, and where motors drive several joints.
pub fn edit_mjcf(
    text: &str,
    ends: &ChainEnds,
    robot: &Robot,
    parameters: &StandardParameters,
) -> Result<EditedText, FormatError> {
    let document = parse_xml(text)?;
    let root = Element::root(&document);
    let settings = Settings::read(root)?;
    let mut tree = read_tree(root, &settings)?;
    let (base, moving) = tree.select(ends)?;
    if moving.len() != parameters.links.len() || moving.len() != robot.dof() {
        let (found, expected) = (parameters.links.len(), moving.len());
        return root.fault(format!("parameters of {found} links, expected those of the chain's {expected}"));
    }
    if robot.coupling().is_some() {
        return root
            .fault("a motor drives several joints, expected one joint for each: a tendon is not edited in place");
    }
    let mut elements = vec![(root, None)];
    for world in root.all("worldbody") {
        collect(world, None, &mut elements);
    }
    let SharedInertias { bodies, remarks } = SharedInertias::of(&tree, base, &moving, &parameters.links)?;
    let mut edit = TextEdit::of(text);
    for (b, inertia) in &bodies {
        write_inertial(&mut edit, elements[*b].0, inertia)?;
    }
    for (index, &main) in moving.iter().enumerate() {
        let (body, class) = elements[main];
        let Some(joint) = body.all("joint").next() else { continue };
        let drive = &parameters.drives[index];
        let known = settings.joint_attributes(joint, class)?;
        for (key, value) in [("armature", drive[ROTOR]), ("damping", drive[VISCOUS]), ("frictionloss", drive[COULOMB])]
        {
            let stated = known.get(key).and_then(|attribute| attribute.value().trim().parse::<f64>().ok());
            if stated.unwrap_or(0.0) != value {
                edit.set_words(joint, key, numbers(&[value]));
            }
        }
        let limit = robot.joints()[index].limits.torque;
        let range = known.get("actuatorfrcrange").map(|range| joint.numbers_of::<2>(range)).transpose()?;
        if limit.is_finite() && range.is_none_or(|[low, high]| high.min(-low) != limit) {
            edit.set_words(joint, "actuatorfrcrange", numbers(&[-limit, limit]));
            if !settings.limits_follow_range {
                edit.set_words(joint, "actuatorfrclimited", "true".to_owned());
            }
        }
    }
    Ok(EditedText { text: edit.done(), remarks })
}

/// Every body in the order of the tree, with the class that its joints are of where they name none.
fn collect<'a>(parent: Element<'a>, class: Option<&'a str>, into: &mut Vec<(Element<'a>, Option<&'a str>)>) {
    for body in parent.all("body") {
        let class = body.attribute("childclass").map(|class| class.value()).or(class);
        into.push((body, class));
        collect(body, class, into);
    }
}

fn write_inertial(edit: &mut TextEdit<'_>, body: Element<'_>, inertia: &Inertia) -> Result<(), FormatError> {
    let (com, i) = (inertia.com().unwrap_or_default(), inertia.about_com());
    let six = [i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]];
    let words = format!(
        "<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
        numbers(com.as_slice()),
        numbers(&[inertia.mass]),
        numbers(&six)
    );
    match body.only("inertial")? {
        Some(inertial) => edit.replace(inertial.range(), words),
        None => edit.first_child(body, &words),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::super::{edit_urdf, parse_mjcf};
    use super::*;
    use crate::model::DriveParameters;

    const SCENE: &str = r#"<mujoco model="scene">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.005" integrator="implicitfast"/>
  <default><default class="arm"><joint damping="2" armature="0.1"/><geom rgba="1 0 0 1"/></default></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="base"><inertial pos="0 0 0" mass="0.472" diaginertia=".1 .1 .1"/>
      <body name="upper" pos="0 0 .3" childclass="arm">
        <inertial pos="0 0 .1" quat="1 0 0 0" mass="2" diaginertia="0.02 0.02 0.01"/>
        <joint name="one" axis="0 0 1" range="-2 2" actuatorfrcrange="-30 30"/><geom name="skin" size=".05" mass="0"/>
        <body name="lower" pos=".2 0 0"><!-- a note -->
          <joint name="two" axis="0 1 0" damping="3"/><site name="tip" pos=".1 0 0"/>
          <inertial pos=".1 0 0" mass="1" fullinertia="0.01 0.02 0.02 0 0 0"/>
          <body name="tool"><inertial pos=".05 0 0" mass="0.3" diaginertia="1e-3 1e-3 1e-3"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><position name="a" joint="one" kp="100"/></actuator>
  <sensor><jointpos joint="one"/></sensor>
  <keyframe><key name="home" qpos="0 1"/></keyframe>
</mujoco>
"#;

    /// The text without any number that may change.
    fn skeleton(text: &str) -> String {
        let mut out =
            text.split_inclusive('>').filter(|tag| !tag.trim_start().starts_with("<inertial")).collect::<String>();
        for key in ["armature", "damping", "frictionloss", "actuatorfrcrange"] {
            let key = format!(" {key}=\"");
            // The class of defaults stays as it is.
            while let Some(at) = out.rfind(&key).filter(|&at| at > out.find("<worldbody>").unwrap_or(0)) {
                let end = at + key.len() + out[at + key.len()..].find('"').unwrap() + 1;
                out.replace_range(at..end, "");
            }
        }
        out
    }

    #[test]
    fn identity_the_scene_has_the_parameters_and_everything_else_stays() {
        let ends = ChainEnds::default();
        let read = parse_mjcf(SCENE, &ends).unwrap();
        assert_eq!(edit_mjcf(SCENE, &ends, &read.robot, &read.parameters).unwrap().text, SCENE);
        let mut parameters = read.parameters.clone();
        for link in &mut parameters.links {
            let about = Matrix3::new(0.5, 0.02, 0.01, 0.02, 0.6, -0.03, 0.01, -0.03, 0.7);
            *link = Inertia::from_com(3.0, Vector3::new(0.01, 0.02, -0.03), about);
        }
        parameters.drives[0] = DriveParameters::from_iter([(VISCOUS, 0.7), (COULOMB, 0.4)]);
        parameters.drives[1] = DriveParameters::from_iter([(ROTOR, 0.25), (VISCOUS, 3.0)]);
        let robot = read.robot.with_joints(|joint| joint.limits.torque = 40.0).unwrap();
        let edited = edit_mjcf(SCENE, &ends, &robot, &parameters).unwrap();
        assert!(edited.remarks.is_empty(), "{:?}", edited.remarks);
        assert_eq!(skeleton(&edited.text), skeleton(SCENE));
        let back = parse_mjcf(&edited.text, &ends).unwrap();
        assert_eq!(back.parameters.drives, parameters.drives);
        assert!(back.robot.joints().iter().all(|joint| (joint.limits.torque - 40.0).abs() < 1e-12));
        for (found, expected) in back.parameters.links.iter().zip(&parameters.links) {
            for (found, expected) in found.to_array().iter().zip(expected.to_array()) {
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
        }
        // The tool keeps what it had, and the base what no torque shows.
        assert!(edited.text.contains("mass=\"0.3\"") && edited.text.contains("mass=\"0.472\""), "{}", edited.text);
    }

    #[test]
    fn another_format_and_another_chain_are_refused() {
        let ends = ChainEnds::default();
        let read = parse_mjcf(SCENE, &ends).unwrap();
        let fault = edit_mjcf("<robot name=\"r\"/>", &ends, &read.robot, &read.parameters).unwrap_err();
        assert!(fault.message.contains("expected <mujoco>"), "{fault}");
        assert!(edit_urdf(SCENE, &ends, &read.parameters).unwrap_err().message.contains("expected <robot>"));
        let other = ChainEnds { tip: Some("upper".to_owned()), ..ends };
        let fault = edit_mjcf(SCENE, &other, &read.robot, &read.parameters).unwrap_err();
        assert!(fault.message.contains("parameters of 2 links, expected those of the chain's 1"), "{fault}");
    }
}
