//! What an MJCF says once for all of its bodies: units of angles, gravity, defaults by class.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Attribute;

use super::element::{Element, sincos, turn_z_to};
use super::error::FormatError;
use super::reading::STANDARD_GRAVITY;
use crate::model::joint::exact_sincos;
use crate::spatial::Placement;

/// The class of everything that names none.
const MAIN: &str = "main";

/// Sections that say nothing about the motion of the bodies.
const WITHOUT_DYNAMICS: [&str; 12] = [
    "worldbody",
    "compiler",
    "option",
    "default",
    "asset",
    "visual",
    "statistic",
    "size",
    "contact",
    "sensor",
    "keyframe",
    "custom",
];

/// Whether the inertia of a body comes from its shapes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum InertiaFromShapes {
    Never,
    WhereNotGiven,
    Always,
}

/// The settings of one file.
pub(super) struct Settings<'a> {
    degrees: bool,
    euler_sequence: String,
    pub(super) limits_follow_range: bool,
    pub(super) from_shapes: InertiaFromShapes,
    pub(super) gravity: Vector3<f64>,
    /// Attributes of `<joint>` by class, with those of the classes around it.
    joint_defaults: BTreeMap<String, BTreeMap<&'a str, Attribute<'a, 'a>>>,
}

impl<'a> Settings<'a> {
    pub(super) fn read(root: Element<'a>) -> Result<Self, FormatError> {
        if root.tag() != "mujoco" {
            return root.fault(format!("the root element is <{}>, expected <mujoco>", root.tag()));
        }
        let mut settings = Self {
            degrees: true,
            euler_sequence: "xyz".to_owned(),
            limits_follow_range: true,
            from_shapes: InertiaFromShapes::WhereNotGiven,
            gravity: Vector3::from(STANDARD_GRAVITY),
            joint_defaults: BTreeMap::new(),
        };
        for section in root.elements() {
            match section.tag() {
                "compiler" => settings.compiler(section)?,
                "option" => settings.option(section)?,
                "default" => settings.defaults(section, &BTreeMap::new(), true)?,
                // Motors: their gears and gains say nothing about the torque that a motion needs.
                "actuator" => {}
                // Read after the bodies.
                "tendon" => {}
                tag if WITHOUT_DYNAMICS.contains(&tag) => {}
                tag => return section.fault(format!("<{tag}> is not supported")),
            }
        }
        Ok(settings)
    }

    fn compiler(&mut self, compiler: Element<'a>) -> Result<(), FormatError> {
        for attribute in compiler.attributes() {
            let (key, value) = (attribute.name(), attribute.value());
            let fault = |expected: &str| {
                let message = format!("{key} is \"{value}\", expected {expected}");
                compiler.check.fault(attribute.range_value(), message)
            };
            match (key, value) {
                ("angle", "degree") => self.degrees = true,
                ("angle", "radian") => self.degrees = false,
                ("angle", _) => return fault("degree or radian"),
                ("eulerseq", sequence) => {
                    if sequence.len() != 3 || !sequence.chars().all(|c| "xyzXYZ".contains(c)) {
                        return fault("three letters out of xyzXYZ");
                    }
                    sequence.clone_into(&mut self.euler_sequence);
                }
                ("autolimits", "true" | "false") => self.limits_follow_range = value == "true",
                ("inertiafromgeom", "auto") => self.from_shapes = InertiaFromShapes::WhereNotGiven,
                ("inertiafromgeom", "true") => self.from_shapes = InertiaFromShapes::Always,
                ("inertiafromgeom", "false") => self.from_shapes = InertiaFromShapes::Never,
                ("balanceinertia", "true") => return fault("false: it changes the inertias of the file"),
                ("coordinate", "global") => return fault("local"),
                ("boundmass" | "boundinertia", _) if compiler.number(key)? != Some(0.0) => {
                    return fault("0: it changes the inertias of the file");
                }
                ("settotalmass", _) if compiler.number(key)?.is_some_and(|mass| mass > 0.0) => {
                    return fault("-1: it changes the inertias of the file");
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn option(&mut self, option: Element<'a>) -> Result<(), FormatError> {
        if let Some(gravity) = option.numbers::<3>("gravity")? {
            self.gravity = Vector3::from(gravity);
        }
        for medium in ["density", "viscosity"] {
            if let Some(attribute) = option.attribute(medium)
                && option.number(medium)? != Some(0.0)
            {
                let message = format!("{medium} is {}, expected 0: the arm moves in a vacuum", attribute.value());
                return option.check.fault(attribute.range_value(), message);
            }
        }
        for flag in option.all("flag") {
            for key in ["gravity", "passive", "spring", "damper", "frictionloss"] {
                if let Some(attribute) = flag.attribute(key).filter(|attribute| attribute.value() == "disable") {
                    let message = format!("flag {key} is \"disable\", expected \"enable\"");
                    return option.check.fault(attribute.range_value(), message);
                }
            }
        }
        Ok(())
    }

    fn defaults(
        &mut self,
        default: Element<'a>,
        around: &BTreeMap<&'a str, Attribute<'a, 'a>>,
        outermost: bool,
    ) -> Result<(), FormatError> {
        let class = match default.attribute("class") {
            Some(class) => class.value(),
            None if outermost => MAIN,
            None => return default.fault("<default> has no class, expected one inside another <default>"),
        };
        let mut attributes = around.clone();
        for joint in default.all("joint") {
            attributes.extend(joint.attributes().map(|attribute| (attribute.name(), attribute)));
        }
        for inner in default.all("default") {
            self.defaults(inner, &attributes, false)?;
        }
        self.joint_defaults.insert(class.to_owned(), attributes);
        Ok(())
    }

    /// The attributes of a joint: its own before those of its class, its body's class, the main class.
    pub(super) fn joint_attributes(
        &self,
        joint: Element<'a>,
        body_class: Option<&str>,
    ) -> Result<BTreeMap<&'a str, Attribute<'a, 'a>>, FormatError> {
        let own = joint.attribute("class");
        let class = own.as_ref().map(Attribute::value).or(body_class).unwrap_or(MAIN);
        let mut attributes = match (self.joint_defaults.get(class), own) {
            (Some(defaults), _) => defaults.clone(),
            (None, Some(own)) => {
                let message = format!("class \"{class}\" is not there, expected one of the <default> classes");
                return joint.check.fault(own.range_value(), message);
            }
            (None, None) => BTreeMap::new(),
        };
        attributes.extend(joint.attributes().map(|attribute| (attribute.name(), attribute)));
        Ok(attributes)
    }

    /// An angle of the file in rad.
    pub(super) fn angle(&self, value: f64) -> f64 {
        if self.degrees { value.to_radians() } else { value }
    }

    /// Sine and cosine of an angle of the file, exact at right angles.
    fn sincos(&self, value: f64) -> (f64, f64) {
        if self.degrees { exact_sincos(value) } else { sincos(value) }
    }

    /// Position and orientation of a body or an inertial.
    pub(super) fn placement(&self, element: Element<'a>) -> Result<Placement, FormatError> {
        let position = Vector3::from(element.numbers::<3>("pos")?.unwrap_or([0.0; 3]));
        Ok(Placement::new(self.orientation(element)?.unwrap_or_else(Matrix3::identity), position))
    }

    /// The orientation that an element states in one of five ways, if any.
    pub(super) fn orientation(&self, element: Element<'a>) -> Result<Option<Matrix3<f64>>, FormatError> {
        let mut found = None;
        for key in ["quat", "axisangle", "euler", "xyaxes", "zaxis"] {
            let Some(attribute) = element.attribute(key) else { continue };
            if found.is_some() {
                let message = format!("a second orientation, {key}, expected one");
                return element.check.fault(attribute.range(), message);
            }
            found = Some(match key {
                "quat" => from_quaternion(element, &attribute)?,
                "axisangle" => {
                    let [x, y, z, angle] = element.numbers_of::<4>(&attribute)?;
                    let axis = Vector3::new(x, y, z);
                    if axis.norm() == 0.0 {
                        let message = "axisangle has the zero vector as its axis, expected a direction";
                        return element.check.fault(attribute.range_value(), message);
                    }
                    // z onto the axis, turn, and back.
                    let (to, (s, c)) = (turn_z_to(&axis.normalize()), self.sincos(angle));
                    to * Placement::rotation_z(s, c).rotation * to.transpose()
                }
                "euler" => self.euler(element.numbers_of::<3>(&attribute)?),
                "xyaxes" => {
                    let [a, b, c, d, e, f] = element.numbers_of::<6>(&attribute)?;
                    let (x, y) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
                    let z = x.cross(&y);
                    if z.norm() == 0.0 {
                        let message = "xyaxes are parallel, expected two directions";
                        return element.check.fault(attribute.range_value(), message);
                    }
                    let (x, z) = (x.normalize(), z.normalize());
                    Matrix3::from_columns(&[x, z.cross(&x), z])
                }
                _ => turn_z_to(&element.direction_of(&attribute)?),
            });
        }
        Ok(found)
    }

    /// Three turns in sequence: small letters about axes that turn along, capitals about fixed ones.
    fn euler(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let mut r = Matrix3::identity();
        for (letter, angle) in self.euler_sequence.chars().zip(angles) {
            let (s, c) = self.sincos(angle);
            let turn = match letter.to_ascii_lowercase() {
                'x' => Placement::rotation_x(s, c).rotation,
                'y' => Placement::rotation_y(s, c).rotation,
                _ => Placement::rotation_z(s, c).rotation,
            };
            r = if letter.is_ascii_lowercase() { r * turn } else { turn * r };
        }
        r
    }
}

/// The rotation of a quaternion (w, x, y, z) of any length.
fn from_quaternion<'a>(element: Element<'a>, quat: &Attribute<'a, 'a>) -> Result<Matrix3<f64>, FormatError> {
    let q = element.numbers_of::<4>(quat)?;
    let norm = q.iter().map(|x| x * x).sum::<f64>();
    if norm == 0.0 {
        return element.check.fault(quat.range_value(), "quat is zero, expected a rotation");
    }
    let [w, x, y, z] = q;
    // Scaled by 2 / |q|², so that the quaternion need not be a unit one.
    let s = 2.0 / norm;
    Ok(Matrix3::new(
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    ))
}
