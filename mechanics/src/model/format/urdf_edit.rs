//! A URDF with other parameters: only the numbers of inertias, damping and friction change.
//!
//! Names, frames, meshes, comments, other tools' extensions and the formatting stay byte for byte. A link of the chain may be
//! several of the file, joined by fixed or locked joints. Those keep what they can of
//! their inertia ([`SharedInertias`]).
//! What URDF has no place for (rotor inertia, offset, other laws of friction) is left to the caller to say.

use nalgebra::Vector3;

use super::element::{Element, NearlyRight, parse_xml};
use super::error::FormatError;
use super::shared_inertias::SharedInertias;
use super::text_edit::{EditedText, TextEdit, numbers};
use super::tree::ChainEnds;
use super::urdf::{read_origin, read_tree};
use crate::model::parameters::StandardParameters;
use crate::model::term::{COULOMB, VISCOUS};
use crate::spatial::Inertia;

/// Puts parameters of the chain that [`parse_urdf`](super::parse_urdf) reads into the same text.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{ChainEnds, edit_urdf, parse_urdf};
/// let text = r#"<robot name="pendulum"><link name="world"/>
///   <link name="rod"><!-- steel --><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
///     <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial></link>
///   <joint name="swing" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#;
/// let mut parameters = parse_urdf(text, &ChainEnds::default()).unwrap().parameters;
/// assert_eq!(edit_urdf(text, &ChainEnds::default(), &parameters).unwrap().text, text);
/// parameters.links[0].mass = 4.0;
/// parameters.links[0].first_moment.z = -2.0;
/// parameters.links[0].rotational *= 2.0;
/// let edited = edit_urdf(text, &ChainEnds::default(), &parameters).unwrap().text;
/// assert!(edited.contains("<!-- steel --><inertial><origin xyz=\"0 0 -0.5\"/><mass value=\"4.0\"/>"), "{edited}");
/// assert_eq!(parse_urdf(&edited, &ChainEnds::default()).unwrap().parameters, parameters);
/// ```
///
/// # Errors
/// [`FormatError`] as [`parse_urdf`](super::parse_urdf), and where the parameters are of another chain.
pub fn edit_urdf(text: &str, ends: &ChainEnds, parameters: &StandardParameters) -> Result<EditedText, FormatError> {
    let document = parse_xml(text)?;
    let root = Element::root(&document);
    let mut tree = read_tree(root, text, NearlyRight::Snapped)?;
    let (base, moving) = tree.select(ends)?;
    if moving.len() != parameters.links.len() || moving.len() != parameters.drives.len() {
        let (found, expected) = (parameters.links.len(), moving.len());
        return root.fault(format!("parameters of {found} links, expected those of the chain's {expected}"));
    }
    let SharedInertias { bodies, remarks } = SharedInertias::of(&tree, base, &moving, &parameters.links)?;
    let mut edit = TextEdit::of(text);
    for (b, inertia) in &bodies {
        let name = &tree.bodies[*b].name;
        if let Some(link) = root.all("link").find(|link| link.attribute("name").is_some_and(|own| own.value() == name))
        {
            edit_inertial(&mut edit, link, inertia)?;
        }
    }
    for (index, &main) in moving.iter().enumerate() {
        let child = &tree.bodies[main].name;
        let of_child = |joint: &Element<'_>| {
            let end = joint.all("child").next().and_then(|end| end.attribute("link"));
            end.is_some_and(|link| link.value() == child)
        };
        if let Some(joint) = root.all("joint").find(of_child) {
            let drive = &parameters.drives[index];
            edit_dynamics(&mut edit, joint, drive[VISCOUS], drive[COULOMB])?;
        }
    }
    Ok(EditedText { text: edit.done(), remarks })
}

/// The inertia of a link, in the orientation that the file gives its `<inertial>`.
fn edit_inertial(edit: &mut TextEdit<'_>, link: Element<'_>, inertia: &Inertia) -> Result<(), FormatError> {
    // Nothing has no centre: where it stands in the file says as much as any place.
    let placed = inertia.com();
    let com = placed.unwrap_or_default();
    let about = inertia.about_com();
    let Some(inertial) = link.only("inertial")? else {
        let words = format!(
            "<inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/><mass value=\"{}\"/><inertia ixx=\"{:?}\" ixy=\"{:?}\" \
             ixz=\"{:?}\" iyy=\"{:?}\" iyz=\"{:?}\" izz=\"{:?}\"/></inertial>",
            numbers(com.as_slice()),
            numbers(&[inertia.mass]),
            about[(0, 0)],
            about[(0, 1)],
            about[(0, 2)],
            about[(1, 1)],
            about[(1, 2)],
            about[(2, 2)]
        );
        edit.first_child(link, &words);
        return Ok(());
    };
    let r = read_origin(inertial)?.rotation;
    let turned = r.transpose() * about * r;
    if let Some(mass) = inertial.only("mass")? {
        match inertial.only("origin")? {
            Some(origin) if placed.is_some() => edit.set(origin, "xyz", [com.x, com.y, com.z])?,
            Some(_) => {}
            None if com == Vector3::zeros() => {}
            None => {
                let gap = edit.gap_before(mass.span().start).to_owned();
                edit.insert(mass.span().start, format!("<origin xyz=\"{}\"/>{gap}", numbers(com.as_slice())));
            }
        }
        edit.set(mass, "value", [inertia.mass])?;
    }
    if let Some(six) = inertial.only("inertia")? {
        for (key, (i, j)) in
            [("ixx", (0, 0)), ("ixy", (0, 1)), ("ixz", (0, 2)), ("iyy", (1, 1)), ("iyz", (1, 2)), ("izz", (2, 2))]
        {
            edit.set(six, key, [0.5 * (turned[(i, j)] + turned[(j, i)])])?;
        }
    }
    Ok(())
}

fn edit_dynamics(edit: &mut TextEdit<'_>, joint: Element<'_>, damping: f64, friction: f64) -> Result<(), FormatError> {
    if let Some(dynamics) = joint.only("dynamics")? {
        for (key, value) in [("damping", damping), ("friction", friction)] {
            if value != dynamics.number(key)?.unwrap_or(0.0) {
                edit.set(dynamics, key, [value])?;
            }
        }
    } else if (damping, friction) != (0.0, 0.0)
        && let Some(last) = joint.elements().last()
    {
        let gap = edit.gap_before(last.range().start).to_owned();
        let (damping, friction) = (numbers(&[damping]), numbers(&[friction]));
        edit.insert(last.range().end, format!("{gap}<dynamics damping=\"{damping}\" friction=\"{friction}\"/>"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::parse_urdf;
    use super::*;
    use crate::dynamics::Dynamics;
    use crate::model::DriveParameters;
    use crate::seed::Seed;
    use rand::RngExt;

    const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm" xmlns:x="y">
	<!-- tabs, 'quotes' and a <joint> in a comment -->
	<link name="base"/>
	<link name='upper'>
		<visual><geometry><mesh filename="package://arm/upper.stl"/></geometry></visual>
		<inertial>
			<mass value="3.0"/><inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.02"/>
		</inertial>
	</link>
	<link name="lower" x:color="a>b"/>
	<link name="tool"><inertial><origin xyz="0.1 0 0" rpy="0.3 0.2 0.1"/><mass value="1.5"/>
		<inertia ixx="0.01" ixy="0.001" ixz="0" iyy="0.012" iyz="0" izz="0.015"/></inertial></link>
	<joint name="one" type="revolute"><origin xyz="0 0 0.3" rpy="1.5708 0 0"/><parent link="base"/><child link="upper"/>
		<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="10" velocity="1"/></joint>
	<joint name="two" type="continuous"><parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/><dynamics friction="0.5"/></joint>
	<joint name="mount" type="fixed"><origin xyz="0.2 0 0" rpy="0 0 0.7"/><parent link="lower"/><child link="tool"/></joint>
	<gazebo/></robot>
"#;

    /// The text without any number of an inertia or a friction.
    fn skeleton(text: &str) -> String {
        text.split_inclusive('>')
            .filter(|tag| {
                !["<inertial", "<origin", "<mass", "<inertia", "</inertial", "<dynamics"]
                    .iter()
                    .any(|own| tag.trim_start().starts_with(own))
            })
            .collect()
    }

    #[test]
    fn identity_the_edited_file_has_the_parameters_and_everything_else_stays() {
        let ends = ChainEnds::default();
        let read = parse_urdf(ARM, &ends).unwrap();
        assert_eq!(edit_urdf(ARM, &ends, &read.parameters).unwrap().text, ARM);
        for run in 0..8 {
            let mut rng = Seed::new(81).stream("edited", run);
            let mut parameters = read.parameters.clone();
            for link in &mut parameters.links {
                let com = Vector3::from_fn(|_, _| rng.random_range(-0.02..0.02));
                let about = nalgebra::Matrix3::new(0.5, 0.02, 0.01, 0.02, 0.6, -0.03, 0.01, -0.03, 0.7);
                // Lighter than the tool alone in every second run, so that the tool cannot keep its own.
                *link = Inertia::from_com(if run % 2 == 0 { 4.0 } else { 0.5 }, com, about);
            }
            for drive in &mut parameters.drives {
                *drive = DriveParameters::from_iter([
                    (VISCOUS, rng.random_range(0.1..2.0)),
                    (COULOMB, rng.random_range(0.1..2.0)),
                ]);
            }
            let edited = edit_urdf(ARM, &ends, &parameters).unwrap();
            assert_eq!(edited.remarks.is_empty(), run % 2 == 0, "{:?}", edited.remarks);
            let back = parse_urdf(&edited.text, &ends).unwrap();
            assert_eq!(back.parameters.drives, parameters.drives);
            assert_eq!(back.robot.joints(), read.robot.joints());
            for (found, expected) in back.parameters.links.iter().zip(&parameters.links) {
                for (found, expected) in found.to_array().iter().zip(expected.to_array()) {
                    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
                }
            }
            let (a, b) = (skeleton(&edited.text), skeleton(ARM));
            // The link without an inertial has one now, so its tag is closed in another way; nothing else differs.
            assert_eq!(a.replace("\"a>b\"></link>", "\"a>b\"/>"), b);
            let urdf = urdf_rs::read_from_string(&edited.text).expect("another reader takes it");
            assert_eq!(urdf.joints[1].dynamics.as_ref().unwrap().damping, parameters.drives[1][VISCOUS]);
            let mut torque = vec![0.0; 2];
            Dynamics::new(&back.robot, &back.parameters).inverse(&[0.1, 0.2], &[0.0; 2], &[1.0, 2.0], &mut torque);
            assert!(torque.iter().all(|tau| tau.is_finite()));
        }
    }

    #[test]
    fn parameters_of_another_chain_are_refused() {
        let read = parse_urdf(ARM, &ChainEnds::default()).unwrap();
        let other = ChainEnds { tip: Some("upper".to_owned()), ..ChainEnds::default() };
        let fault = edit_urdf(ARM, &other, &read.parameters).unwrap_err();
        assert!(fault.message.contains("parameters of 2 links, expected those of the chain's 1"), "{fault}");
    }
}
