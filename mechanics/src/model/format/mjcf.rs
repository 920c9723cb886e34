//! MJCF: the serial chain of a MuJoCo model.
//!
//! The frame of a link is that of its body. A joint stands at `pos` in it and moves about or along `axis`:
//!
//! ```text
//! T(q) = body · Tr(pos) · Rot(axis, q) · Tr(−pos)        (hinge)
//! T(q) = body · Tr(axis · q)                             (slide)
//! ```
//! Read: nested bodies with one hinge or slide each, `inertial`, `armature`, `damping`, `frictionloss`, `range`,
//! `actuatorfrcrange`, gravity, classes of defaults for joints, and the armature of a fixed tendon: the rotor of a coupled motor,
//! `q_motor = Σ c_j q_j`. What would change the motion and is not supported is
//! refused by name (springs, balls, spatial tendons, equalities, includes, frames, inertia from shapes, …); shapes, assets,
//! sensors and actuators are passed over. Reference: the MuJoCo XML reference, version 3.

use crate::input::size::LINKS;
use crate::model::term::{COULOMB, ROTOR, VISCOUS};
use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Attribute;

use super::element::{Element, parse_xml, turn_z_to};
use super::error::FormatError;
use super::mjcf_settings::{InertiaFromShapes, Settings};
use super::tree::{Body, ChainEnds, Connection, CoupledRotor, ImportedModel, MovingJoint, Tree, moved};
use crate::model::joint::{JointKind, Limits};
use crate::model::parameters::DriveParameters;
use crate::spatial::{Inertia, Placement};

/// Elements of a body that say nothing about its motion; shapes count only where a body has no `inertial`.
const PASSED_OVER: [&str; 6] = ["geom", "site", "camera", "light", "body", "inertial"];

/// Reads the serial chain of an MJCF.
///
/// Bodies without a joint are part of the one that carries them. Armature becomes the rotor inertia, damping the
/// viscous and frictionloss the Coulomb friction; the effort interface is a torque.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{ChainEnds, parse_mjcf};
/// use armid::model::term::ROTOR;
/// let text = r#"<mujoco model="pendulum"><worldbody><body name="rod">
///   <joint name="swing" axis="0 1 0" armature="0.01" range="-90 90"/>
///   <inertial pos="0 0 -0.5" mass="2" diaginertia="0.1 0.1 0.01"/></body></worldbody></mujoco>"#;
/// let model = parse_mjcf(text, &ChainEnds::default()).unwrap();
/// assert_eq!(model.robot.joints()[0].limits.position.1, std::f64::consts::FRAC_PI_2);
/// assert_eq!(model.parameters.drives[0][ROTOR], 0.01);
/// assert_eq!(model.parameters.links[0].to_array(), [2.0, 0.0, 0.0, -1.0, 0.6, 0.0, 0.0, 0.6, 0.0, 0.01]);
/// ```
///
/// # Errors
/// [`FormatError`] with line and column: malformed XML, a missing or malformed attribute, anything that is not supported (by
/// its name), a tree without a tip (the leaves are listed).
pub fn parse_mjcf(text: &str, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
    let document = parse_xml(text)?;
    let root = Element::root(&document);
    let model = read_tree(root, &Settings::read(root)?)?.chain(ends)?;
    Ok(ImportedModel { robot: model.robot.with_source(text), ..model })
}

/// The bodies of a model.
pub(super) fn read_tree<'a>(root: Element<'a>, settings: &Settings<'a>) -> Result<Tree<'a>, FormatError> {
    let mut reader = BodyReader { settings, bodies: Vec::new(), joints: 0, geoms: 0 };
    reader.bodies.push(Body::root("world", root.span()));
    for world in root.all("worldbody") {
        reader.children(world, 0, None)?;
    }
    let (bodies, geoms) = (reader.bodies, reader.geoms);
    let not_held = || format!("shapes of an MJCF are not read, and no clearance is held against them: {geoms} × geom");
    let remarks = (geoms > 0).then(not_held).into_iter().collect();
    let tendons = root.all("tendon").flat_map(|tendons| tendons.elements());
    let rotors = tendons.filter_map(|tendon| coupled_rotor(tendon).transpose()).collect::<Result<_, _>>()?;
    let name = root.attribute("model").map_or("unnamed", |name| name.value()).to_owned();
    Ok(Tree {
        check: root.check,
        at: root.span(),
        name,
        gravity: settings.gravity,
        bodies,
        rotors,
        snapped: Vec::new(),
        remarks,
    })
}

/// The rotor that a fixed tendon stands for; none where it has no armature.
fn coupled_rotor(tendon: Element<'_>) -> Result<Option<CoupledRotor>, FormatError> {
    if tendon.tag() != "fixed" {
        return tendon.fault(format!("<{}> in <tendon> is not supported, expected <fixed>", tendon.tag()));
    }
    for key in ["stiffness", "damping", "frictionloss"] {
        if let Some(attribute) = tendon.attribute(key)
            && !attribute.value().split_ascii_whitespace().all(|word| word.parse() == Ok(0.0))
        {
            let message = format!("{key} of a tendon is {}, expected 0: only its armature is read", attribute.value());
            return tendon.check.fault(attribute.range_value(), message);
        }
    }
    let mut joints = Vec::new();
    for joint in tendon.elements() {
        if joint.tag() != "joint" {
            return joint.fault(format!("<{}> in <fixed> is not supported, expected <joint>", joint.tag()));
        }
        joints.push((joint.required("joint")?.value().to_owned(), joint.required_number("coef")?));
    }
    let inertia = tendon.number("armature")?.unwrap_or(0.0);
    if inertia < 0.0 {
        return tendon.fault(format!("armature is {inertia}, expected a number not below zero"));
    }
    let motor = tendon.attribute("name").and_then(|name| name.value().strip_prefix("motor")?.parse().ok());
    Ok((inertia > 0.0).then_some(CoupledRotor { motor, inertia, joints, at: tendon.span() }))
}

/// Reads nested bodies, parents before children.
struct BodyReader<'s, 'a> {
    settings: &'s Settings<'a>,
    bodies: Vec<Body>,
    joints: usize,
    /// Shapes, which nothing is read of.
    geoms: usize,
}

impl<'a> BodyReader<'_, 'a> {
    fn children(&mut self, parent: Element<'a>, index: usize, class: Option<&'a str>) -> Result<(), FormatError> {
        for element in parent.elements() {
            match element.tag() {
                "body" => self.body(element, index, class)?,
                "joint" | "freejoint" if parent.tag() == "body" => {}
                tag if PASSED_OVER.contains(&tag) => self.geoms += usize::from(tag == "geom"),
                tag => return element.fault(format!("<{tag}> in <{}> is not supported", parent.tag())),
            }
        }
        Ok(())
    }

    fn body(&mut self, element: Element<'a>, parent: usize, class: Option<&'a str>) -> Result<(), FormatError> {
        let index = self.bodies.len();
        LINKS.check_count("number of bodies", index).or_else(|fault| element.fault(fault.to_string()))?;
        let name = element.attribute("name").map_or_else(|| format!("body{index}"), |name| name.value().to_owned());
        let class = element.attribute("childclass").map(|class| class.value()).or(class);
        if let Some(flag) = element.attribute("mocap").filter(|flag| flag.value() == "true") {
            let message = format!("body \"{name}\" is a mocap body, which is not supported");
            return element.check.fault(flag.range(), message);
        }
        if element.number("gravcomp")?.is_some_and(|share| share != 0.0) {
            return element.fault(format!("body \"{name}\" has a gravcomp other than 0, which is not supported"));
        }
        let connection = self.connection(element, &name, class)?;
        let inertia = self.inertia(element, &name);
        let placement = self.settings.placement(element)?;
        let root = Body::root(name, element.span());
        self.bodies.push(Body { parent: Some(parent), placement, connection, inertia, ..root });
        self.children(element, index, class)
    }

    fn connection(&mut self, body: Element<'a>, name: &str, class: Option<&str>) -> Result<Connection, FormatError> {
        let mut joints = body.elements().filter(|element| matches!(element.tag(), "joint" | "freejoint"));
        let Some(joint) = joints.next() else { return Ok(Connection::Fixed) };
        if let Some(second) = joints.next() {
            return second.fault(format!("a second joint of body \"{name}\", expected one at most"));
        }
        self.joints += 1;
        let name =
            joint.attribute("name").map_or_else(|| format!("joint{}", self.joints), |name| name.value().to_owned());
        if joint.tag() == "freejoint" {
            return Ok(Connection::Unsupported(name, "free".to_owned()));
        }
        let attributes = self.settings.joint_attributes(joint, class)?;
        JointReader { joint, attributes, settings: self.settings }.connection(name)
    }

    fn inertia(&self, body: Element<'a>, name: &str) -> Result<Inertia, FormatError> {
        let weighs = |shape: &Element<'_>| shape.attribute("mass").is_none_or(|mass| mass.value().parse() != Ok(0.0));
        let shaped = body.all("geom").any(|shape| weighs(&shape));
        let from_shapes = self.settings.from_shapes;
        let inertial = body.only("inertial")?;
        if shaped
            && (from_shapes == InertiaFromShapes::Always
                || (inertial.is_none() && from_shapes == InertiaFromShapes::WhereNotGiven))
        {
            let message =
                format!("body \"{name}\" takes its inertia from its shapes, expected an <inertial> that counts");
            return body.fault(message);
        }
        let Some(inertial) = inertial else { return Ok(Inertia::zero()) };
        inertial.required("pos")?;
        let mass = inertial.number_not_below_zero("mass")?;
        let placement = self.settings.placement(inertial)?;
        let rotational = match (inertial.numbers::<3>("diaginertia")?, inertial.numbers::<6>("fullinertia")?) {
            (Some(diagonal), None) => Matrix3::from_diagonal(&Vector3::from(diagonal)),
            (None, Some([xx, yy, zz, xy, xz, yz])) => {
                if self.settings.orientation(inertial)?.is_some() {
                    return inertial.fault("<inertial> has a fullinertia and an orientation, expected one of them");
                }
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            }
            (None, None) => return inertial.fault("<inertial> has neither diaginertia nor fullinertia, expected one"),
            (Some(_), Some(_)) => {
                return inertial.fault("<inertial> has both diaginertia and fullinertia, expected one");
            }
        };
        Ok(moved(&Inertia { mass, first_moment: Vector3::zeros(), rotational }, &placement))
    }
}

/// Reads one `<joint>`, its classes applied.
struct JointReader<'s, 'a> {
    joint: Element<'a>,
    attributes: BTreeMap<&'a str, Attribute<'a, 'a>>,
    settings: &'s Settings<'a>,
}

impl JointReader<'_, '_> {
    fn connection(&self, name: String) -> Result<Connection, FormatError> {
        let kind = match self.text("type") {
            None | Some("hinge") => JointKind::Revolute,
            Some("slide") => JointKind::Prismatic,
            Some(many @ ("ball" | "free")) => return Ok(Connection::Unsupported(name, many.to_owned())),
            Some(other) => {
                return self.fault("type", format!("type is \"{other}\", expected hinge, slide, ball or free"));
            }
        };
        for (key, why) in [
            ("stiffness", "a spring"),
            ("springdamper", "a spring"),
            ("ref", "a reference other than the pose of the file"),
        ] {
            if let Some(attribute) = self.attributes.get(key)
                && !attribute.value().split_ascii_whitespace().all(|word| word.parse() == Ok(0.0))
            {
                let message =
                    format!("joint \"{name}\" has {why}, {key} = {}, which is not supported", attribute.value());
                return self.fault(key, message);
            }
        }
        if self.text("actuatorgravcomp") == Some("true") {
            let message = format!("joint \"{name}\" has actuatorgravcomp, which is not supported");
            return self.fault("actuatorgravcomp", message);
        }
        let position = Vector3::from(self.numbers::<3>("pos")?.unwrap_or([0.0; 3]));
        let axis = self.attributes.get("axis").map_or(Ok(Vector3::z()), |axis| self.joint.direction_of(axis))?;
        let not_negative = |key| match self.numbers::<1>(key)? {
            Some([value]) if value < 0.0 => {
                self.fault(key, format!("{key} is {value}, expected a number not below zero"))
            }
            value => Ok(value.map_or(0.0, |[value]| value)),
        };
        Ok(Connection::Moving(MovingJoint {
            name,
            kind,
            axis: Placement::new(turn_z_to(&axis), position),
            limits: self.limits(kind)?,
            drive: DriveParameters::from_iter([
                (ROTOR, not_negative("armature")?),
                (VISCOUS, not_negative("damping")?),
                (COULOMB, not_negative("frictionloss")?),
            ]),
        }))
    }

    fn limits(&self, kind: JointKind) -> Result<Limits, FormatError> {
        let mut limits = Limits::NONE;
        if let Some((low, high)) = self.range("range", "limited")? {
            let si = |value| if kind == JointKind::Revolute { self.settings.angle(value) } else { value };
            limits.position = (si(low), si(high));
        }
        if let Some((low, high)) = self.range("actuatorfrcrange", "actuatorfrclimited")? {
            // One number for both directions: the one that holds in both.
            limits.torque = high.min(-low);
            if limits.torque <= 0.0 {
                let message = format!("actuatorfrcrange is {low} {high}, expected a force in both directions");
                return self.fault("actuatorfrcrange", message);
            }
        }
        Ok(limits)
    }

    /// A range that is in force.
    fn range(&self, key: &str, limited: &str) -> Result<Option<(f64, f64)>, FormatError> {
        let Some([low, high]) = self.numbers::<2>(key)? else { return Ok(None) };
        let in_force = match self.text(limited) {
            Some("true") => true,
            Some("false") => false,
            None | Some("auto") => self.settings.limits_follow_range,
            Some(other) => {
                return self.fault(limited, format!("{limited} is \"{other}\", expected true, false or auto"));
            }
        };
        if in_force && low >= high {
            return self.fault(key, format!("{key} is {low} {high}, expected the lower below the upper"));
        }
        Ok(in_force.then_some((low, high)))
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.attributes.get(key).map(Attribute::value)
    }

    fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, FormatError> {
        self.attributes.get(key).map(|attribute| self.joint.numbers_of(attribute)).transpose()
    }

    fn fault<T>(&self, key: &str, message: String) -> Result<T, FormatError> {
        let at = self.attributes.get(key).map_or_else(|| self.joint.span(), Attribute::range_value);
        self.joint.check.fault(at, message)
    }
}
