//! An element of an XML text with its place.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};
use roxmltree::{Attribute, Document, Node};

use super::error::FormatError;
use super::reading::Check;
use crate::model::joint::exact_sincos;

/// Elements inside elements at most; far more than any arm has, and few enough for any stack.
const DEEPEST: usize = 200;

/// Parses XML, or says where it is malformed or nested too deeply.
pub(super) fn parse_xml(text: &str) -> Result<Document<'_>, FormatError> {
    let document = Document::parse(text).map_err(|fault| {
        let (place, message) = (fault.pos(), fault.to_string());
        let message = message.strip_suffix(&format!(" at {place}")).unwrap_or(&message);
        FormatError::at_line(place.row as usize, place.col as usize, format!("malformed XML: {message}"))
    })?;
    // Depth by node, parents before children.
    let mut depth: Vec<usize> = Vec::new();
    for node in document.descendants() {
        let here = node.parent().map_or(0, |parent| depth[parent.id().get_usize()] + 1);
        if here > DEEPEST {
            let message = format!("an element inside {DEEPEST} others, expected fewer");
            return Err(FormatError::at_span(text, node.range(), message));
        }
        depth.resize(node.id().get_usize() + 1, here);
    }
    Ok(document)
}

/// One element and the checks of its text.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    pub(super) check: Check<'a>,
}

impl<'a> Element<'a> {
    pub(super) fn root(document: &'a Document<'a>) -> Self {
        Self { node: document.root_element(), check: Check::new(document.input_text()) }
    }

    /// Its tag, such as `joint`.
    pub(super) fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Whether its tag has this prefix, as in `xacro:macro`.
    pub(super) fn is_of(&self, prefix: &str) -> bool {
        let written = &self.check.text[self.node.range()];
        written.strip_prefix('<').and_then(|rest| rest.strip_prefix(prefix)).is_some_and(|rest| rest.starts_with(':'))
    }

    /// Where its opening tag begins, up to the end of the tag's name.
    pub(super) fn span(&self) -> Range<usize> {
        let start = self.node.range().start;
        start..start + 1 + self.tag().len()
    }

    /// All of it in the text, to the end of its closing tag.
    pub(super) fn range(&self) -> Range<usize> {
        self.node.range()
    }

    pub(super) fn fault<T>(&self, message: impl Into<String>) -> Result<T, FormatError> {
        self.check.fault(self.span(), message)
    }

    pub(super) fn elements(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let check = self.check;
        self.node.children().filter(Node::is_element).map(move |node| Element { node, check })
    }

    pub(super) fn all(&self, tag: &'static str) -> impl Iterator<Item = Element<'a>> {
        self.elements().filter(move |element| element.tag() == tag)
    }

    /// The only element of a tag inside this one, if any; a second one is a fault.
    pub(super) fn only(&self, tag: &'static str) -> Result<Option<Element<'a>>, FormatError> {
        let mut found = self.all(tag);
        let first = found.next();
        match found.next() {
            Some(second) => second.fault(format!("a second <{tag}> in <{}>, expected one at most", self.tag())),
            None => Ok(first),
        }
    }

    pub(super) fn attributes(&self) -> impl Iterator<Item = Attribute<'a, 'a>> {
        self.node.attributes()
    }

    pub(super) fn attribute(&self, key: &str) -> Option<Attribute<'a, 'a>> {
        self.node.attribute_node(key)
    }

    pub(super) fn required(&self, key: &str) -> Result<Attribute<'a, 'a>, FormatError> {
        let missing = || self.fault(format!("<{}> has no attribute {key}, expected one", self.tag()));
        self.attribute(key).map_or_else(missing, Ok)
    }

    /// Exactly `N` finite numbers of one attribute.
    pub(super) fn numbers_of<const N: usize>(&self, attribute: &Attribute<'a, 'a>) -> Result<[f64; N], FormatError> {
        let (key, value) = (attribute.name(), attribute.value());
        let fault = |found: String| {
            let expected = if N == 1 { "a finite number".to_owned() } else { format!("{N} finite numbers") };
            self.check.fault(attribute.range_value(), format!("{key} is {found}, expected {expected}"))
        };
        let words: Vec<&str> = value.split_ascii_whitespace().collect();
        if words.len() != N {
            return fault(format!("\"{value}\""));
        }
        let mut out = [0.0; N];
        for (slot, word) in out.iter_mut().zip(words) {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => *slot = number,
                _ => return fault(format!("\"{word}\"")),
            }
        }
        Ok(out)
    }

    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, FormatError> {
        self.attribute(key).map(|attribute| self.numbers_of(&attribute)).transpose()
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, FormatError> {
        Ok(self.numbers::<1>(key)?.map(|[x]| x))
    }

    pub(super) fn required_number(&self, key: &str) -> Result<f64, FormatError> {
        self.numbers_of::<1>(&self.required(key)?).map(|[x]| x)
    }

    /// A number that cannot be negative: a mass.
    pub(super) fn number_not_below_zero(&self, key: &str) -> Result<f64, FormatError> {
        let number = self.required_number(key)?;
        if number < 0.0 {
            let message = format!("{key} is {number}, expected a number not below zero");
            return self.check.fault(self.required(key)?.range_value(), message);
        }
        Ok(number)
    }

    /// A direction: three numbers that are not all zero, made a unit vector.
    pub(super) fn direction_of(&self, attribute: &Attribute<'a, 'a>) -> Result<Vector3<f64>, FormatError> {
        let axis = Vector3::from(self.numbers_of::<3>(attribute)?);
        let length = axis.norm();
        if length > 0.0 {
            Ok(axis / length)
        } else {
            let message = format!("{} is the zero vector, expected a direction", attribute.name());
            self.check.fault(attribute.range_value(), message)
        }
    }
}

/// Sine and cosine of an angle in rad, exact where the text means a multiple of 90°: within four roundings of one.
pub(super) fn sincos(angle: f64) -> (f64, f64) {
    snapped_sincos(angle, NearlyRight::AsWritten).0
}

/// How far from a multiple of 90° an angle of the geometry may be that means one, rad: half a unit of the fourth decimal.
///
/// Files write π/2 as 1.5708 or 1.57079632679. An axis that is off by that much makes parameters visible that no torque
/// sensor resolves (their columns are 1e-6 to 1e-11 of the others), and a tool a metre away moves by 0.05 mm at most.
pub(super) const RIGHT_ANGLE: f64 = 5e-5;

/// The multiple of 90° that is nearest to an angle.
#[derive(Clone, Copy)]
struct RightAngle {
    quarters: f64,
    /// The angle minus the multiple, rad.
    off: f64,
}

impl RightAngle {
    fn nearest(angle: f64) -> Self {
        let quarters = (angle / std::f64::consts::FRAC_PI_2).round();
        Self { quarters, off: angle - quarters * std::f64::consts::FRAC_PI_2 }
    }

    fn is_rounding(self) -> bool {
        self.off.abs() <= 4.0 * f64::EPSILON * (self.quarters * std::f64::consts::FRAC_PI_2).abs()
    }

    fn sincos(self) -> (f64, f64) {
        exact_sincos(90.0 * self.quarters)
    }
}

/// How angles of the geometry that are nearly right are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NearlyRight {
    /// As the right angles that they mean.
    Snapped,
    /// As they are written.
    AsWritten,
}

impl NearlyRight {
    /// Whether an angle that is off a right one by so much is read as that, rad.
    fn snaps(self, off: f64) -> bool {
        self == Self::Snapped && off.abs() <= RIGHT_ANGLE
    }
}

/// Sine and cosine of an angle of the geometry, exact within [`RIGHT_ANGLE`] of a multiple of 90° where that is snapped, and by
/// how much the angle was off, rad: zero where it means what it says.
pub(super) fn snapped_sincos(angle: f64, nearly: NearlyRight) -> ((f64, f64), f64) {
    let right = RightAngle::nearest(angle);
    if right.is_rounding() {
        (right.sincos(), 0.0)
    } else if nearly.snaps(right.off) {
        (right.sincos(), right.off.abs())
    } else {
        (libm::sincos(angle), 0.0)
    }
}

/// A direction of the geometry, along a coordinate axis where it is within [`RIGHT_ANGLE`] of one and that is snapped, and by how
/// much it was off, rad.
pub(super) fn snapped_direction(axis: &Vector3<f64>, nearly: NearlyRight) -> (Vector3<f64>, f64) {
    let along = axis.iamax();
    let across = axis.iter().enumerate().filter(|&(i, _)| i != along).fold(0.0, |sum, (_, x)| libm::hypot(sum, *x));
    if nearly.snaps(across) {
        let mut exact = Vector3::zeros();
        exact[along] = if axis[along] < 0.0 { -1.0 } else { 1.0 };
        (exact, across)
    } else {
        (*axis, 0.0)
    }
}

/// The shortest turn that brings z onto a unit vector; exact where that is one of the axes. Straight down it is about x.
///
/// ```text
/// R = c 1 + [v]× + (1 − c) u uᵀ      v = z × a,  c = z · a,  u = v / |v|
/// ```
/// Upwards `(1 − c) u uᵀ = v vᵀ / (1 + c)`, which needs no direction of a small `v`.
pub(super) fn turn_z_to(axis: &Vector3<f64>) -> Matrix3<f64> {
    let (v, c) = (Vector3::z().cross(axis), axis.z);
    let along = if c >= 0.0 {
        v * v.transpose() / (1.0 + c)
    } else {
        let u = v.try_normalize(0.0).unwrap_or_else(Vector3::x);
        u * u.transpose() * (1.0 - c)
    };
    Matrix3::from_diagonal_element(c) + v.cross_matrix() + along
}

#[cfg(test)]
#[allow(
    clippy::float_cmp,
    clippy::approx_constant,
    reason = "right angles are exact, and files write them with few digits"
)]
mod tests {
    use super::*;

    #[test]
    fn identity_the_turn_is_a_rotation_that_brings_z_onto_the_axis() {
        for axis in [
            Vector3::x(),
            -Vector3::x(),
            Vector3::y(),
            -Vector3::y(),
            Vector3::z(),
            -Vector3::z(),
            Vector3::new(0.6, -0.48, 0.64),
            Vector3::new(1e-9, 0.0, -1.0).normalize(),
            Vector3::new(-0.3, 0.2, -0.9).normalize(),
        ] {
            let r = turn_z_to(&axis);
            let exact = axis.iter().all(|x| x.fract() == 0.0);
            let bound = if exact { 0.0 } else { 4.0 * f64::EPSILON };
            assert!((r.column(2) - axis).amax() <= bound, "{axis}");
            assert!((r.transpose() * r - Matrix3::identity()).amax() <= bound && r.determinant() > 0.0, "{axis}");
            // The shortest turn is by the angle between both: its trace is 1 + 2 cos.
            assert!((r.trace() - (1.0 + 2.0 * axis.z)).abs() <= bound, "{axis}");
        }
    }

    #[test]
    fn analytic_right_angles_are_exact_and_others_are_not_touched() {
        use std::f64::consts::{FRAC_PI_2, PI};
        assert_eq!(sincos(0.0), (0.0, 1.0));
        assert_eq!(sincos(-FRAC_PI_2), (-1.0, 0.0));
        assert_eq!(sincos(PI), (0.0, -1.0));
        assert_eq!(sincos(1.57), libm::sincos(1.57));
        assert_eq!(sincos(1e-17), libm::sincos(1e-17));
    }

    #[test]
    fn analytic_angles_of_the_geometry_are_right_within_half_a_unit_of_the_fourth_decimal() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for (written, meant) in
            [(1.5708, (1.0, 0.0)), (-1.5708, (-1.0, 0.0)), (3.14159, (0.0, -1.0)), (4e-5, (0.0, 1.0))]
        {
            let (found, off) = snapped_sincos(written, NearlyRight::Snapped);
            assert_eq!(found, meant);
            let exact = (written - (written / FRAC_PI_2).round() * FRAC_PI_2).abs();
            assert!((off - exact).abs() < 1e-15 && off > 0.0, "{written}: {off}");
            assert_eq!(snapped_sincos(written, NearlyRight::AsWritten), (libm::sincos(written), 0.0));
        }
        assert_eq!(snapped_sincos(PI, NearlyRight::Snapped), ((0.0, -1.0), 0.0));
        for other in [1.57, 1.5707, 6e-5, 0.7854] {
            assert_eq!(snapped_sincos(other, NearlyRight::Snapped), (libm::sincos(other), 0.0));
        }
        let (axis, off) = snapped_direction(&Vector3::new(3e-5, -1.0, 4e-5).normalize(), NearlyRight::Snapped);
        assert_eq!(axis, -Vector3::y());
        assert!((off - 5e-5).abs() < 1e-12);
        let tilted = Vector3::new(6e-5, 0.0, 1.0).normalize();
        assert_eq!(snapped_direction(&tilted, NearlyRight::Snapped), (tilted, 0.0));
    }
}
