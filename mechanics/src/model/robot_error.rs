//! Why a robot cannot be as specified, and the checks that say so.

use nalgebra::Vector3;

use super::capsule::Capsule;
use super::hull::Hull;
use super::joint::{DhConvention, DhRow, Joint, JointKind};
use super::motor_circuit::MotorCircuit;
use super::point::NamedPoint;
use super::servo::ServoTuning;
use super::shape::{Cuboid, Obstacle, Shape, Solid};
use crate::input::SizeError;
use crate::spatial::Placement;

/// How far the length of a plane's normal may be from one, and a frame from that of its DH row: rounding.
const ROUNDING: f64 = 1e-9;

const ABOVE_ZERO: &str = "a number above zero";
const FINITE_ABOVE_ZERO: &str = "a finite number above zero";
const FINITE_NOT_BELOW: &str = "a finite number not below zero";
const FINITE: &str = "finite numbers";
const RIGID: &str = "an orthonormal right-handed rotation and a finite translation";

/// Why a robot cannot be as specified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum RobotError {
    /// No joints.
    #[error("robot \"{robot}\" has no joints, expected at least one")]
    NoJoints { robot: String },
    /// More joints than are allowed.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Two joints of one name.
    #[error("joint name \"{joint}\" occurs twice, expected each name once")]
    DuplicateJoint { joint: String },
    /// A quantity is outside what is possible.
    #[error("joint \"{joint}\": {quantity} is {found}, expected {expected}")]
    Joint { joint: String, quantity: &'static str, found: String, expected: &'static str },
    /// The coupling matrix is not n × n and invertible.
    #[error("coupling is a {rows} × {columns} matrix, expected an invertible {dof} × {dof} matrix")]
    Coupling { rows: usize, columns: usize, dof: usize },
    /// A named point is on a link that does not exist, or its position is not finite.
    #[error(
        "point \"{point}\": link {link} at {position:?} m, expected a link from 0 (the base) to {dof} and finite numbers"
    )]
    Point { point: String, link: usize, position: [f64; 3], dof: usize },
    /// A shape names a link that does not exist.
    #[error("shape {index}: link is {found}, expected 0 (the base) to {dof}")]
    Shape { index: usize, found: usize, dof: usize },
    /// Two links may touch, one of which does not exist, or they are not in ascending order.
    #[error("links {first} and {second} may touch, expected 0 (the base) to {dof}, the lower first")]
    MayTouch { first: usize, second: usize, dof: usize },
    /// A quantity of the robot as a whole, of its servo, of a shape or of an obstacle is outside what is possible.
    #[error("{place}: {quantity} is {found}, expected {expected}")]
    Quantity { place: String, quantity: &'static str, found: String, expected: &'static str },
}

/// Gravity, base, shapes, obstacles and the pairs that may touch, of a robot of `dof` links.
pub(super) fn check_surroundings(
    gravity: &Vector3<f64>,
    base: &Placement,
    shapes: &[Shape],
    obstacles: &[Obstacle],
    may_touch: &[(usize, usize)],
    dof: usize,
) -> Result<(), RobotError> {
    let robot = || "robot".to_owned();
    if !gravity.iter().all(|x| x.is_finite()) {
        return fault(robot(), "gravity", format!("{:?}", gravity.as_slice()), FINITE);
    }
    if !base.is_rigid() {
        return fault(robot(), "base", shown(base), RIGID);
    }
    for (index, Shape { link, solid }) in shapes.iter().enumerate() {
        if *link > dof {
            return Err(RobotError::Shape { index: index + 1, found: *link, dof });
        }
        check_solid(solid, || format!("shape {}", index + 1))?;
    }
    for obstacle in obstacles {
        let place = || format!("obstacle \"{}\"", obstacle.name());
        match obstacle {
            Obstacle::Floor { z } if !z.is_finite() => return fault(place(), "height", z.to_string(), FINITE),
            Obstacle::Plane { offset, .. } if !offset.is_finite() => {
                return fault(place(), "offset", offset.to_string(), FINITE);
            }
            Obstacle::Plane { normal, .. } if (normal.norm() - 1.0).abs() <= ROUNDING => {}
            Obstacle::Plane { normal, .. } => {
                return fault(place(), "normal", format!("{:?}", normal.as_slice()), "a vector of length one");
            }
            Obstacle::Floor { .. } => {}
            Obstacle::Body { solid, .. } => check_solid(solid, place)?,
        }
    }
    match may_touch.iter().find(|(first, second)| first > second || *second > dof) {
        Some(&(first, second)) => Err(RobotError::MayTouch { first, second, dof }),
        None => Ok(()),
    }
}

fn check_solid(solid: &Solid, place: impl Fn() -> String) -> Result<(), RobotError> {
    match solid {
        Solid::Capsule(Capsule { radius, .. }) if !(radius.is_finite() && *radius > 0.0) => {
            fault(place(), "radius", radius.to_string(), FINITE_ABOVE_ZERO)
        }
        Solid::Capsule(Capsule { from, to, .. }) if !from.iter().chain(to).all(|x| x.is_finite()) => {
            fault(place(), "segment", format!("{:?} to {:?}", from.as_slice(), to.as_slice()), FINITE)
        }
        Solid::Cuboid(Cuboid { half, .. }) if !half.iter().all(|x| x.is_finite() && *x > 0.0) => {
            fault(place(), "half length", format!("{:?}", half.as_slice()), FINITE_ABOVE_ZERO)
        }
        Solid::Cuboid(Cuboid { placement, .. }) if !placement.is_rigid() => {
            fault(place(), "placement", shown(placement), RIGID)
        }
        Solid::Hull(Hull { points, .. }) if points.is_empty() => {
            fault(place(), "number of points", "0".to_owned(), "at least one")
        }
        Solid::Hull(Hull { points, .. }) if !points.iter().flatten().all(|x| x.is_finite()) => {
            fault(place(), "points", "one that is not finite".to_owned(), FINITE)
        }
        Solid::Hull(Hull { margin, .. }) if !(margin.is_finite() && *margin >= 0.0) => {
            fault(place(), "margin", margin.to_string(), FINITE_NOT_BELOW)
        }
        Solid::Capsule(_) | Solid::Cuboid(_) | Solid::Hull(_) => Ok(()),
    }
}

pub(super) fn check_points(points: &[NamedPoint], dof: usize) -> Result<(), RobotError> {
    let wrong = |point: &&NamedPoint| point.link > dof || !point.position.iter().all(|x| x.is_finite());
    match points.iter().find(wrong) {
        Some(NamedPoint { name, link, position }) => {
            Err(RobotError::Point { point: name.clone(), link: *link, position: (*position).into(), dof })
        }
        None => Ok(()),
    }
}

pub(super) fn check_servo(servo: &ServoTuning) -> Result<(), RobotError> {
    let ServoTuning { rate_hz, bandwidth_hz, damping, integral_hz, friction: _ } = *servo;
    let place = || "servo".to_owned();
    for (quantity, value) in [("rate_hz", rate_hz), ("bandwidth_hz", bandwidth_hz), ("damping", damping)] {
        if !(value.is_finite() && value > 0.0) {
            return fault(place(), quantity, value.to_string(), FINITE_ABOVE_ZERO);
        }
    }
    if !(integral_hz.is_finite() && integral_hz >= 0.0) {
        return fault(place(), "integral_hz", integral_hz.to_string(), FINITE_NOT_BELOW);
    }
    Ok(())
}

fn fault<T>(place: String, quantity: &'static str, found: String, expected: &'static str) -> Result<T, RobotError> {
    Err(RobotError::Quantity { place, quantity, found, expected })
}

fn shown(placement: &Placement) -> String {
    format!("{:?} at {:?}", placement.rotation.as_slice(), placement.translation.as_slice())
}

/// Whether two frames are the same but for rounding.
fn same(a: &Placement, b: &Placement) -> bool {
    (a.rotation - b.rotation).amax() <= ROUNDING && (a.translation - b.translation).amax() <= ROUNDING
}

pub(super) fn check_joint(joint: &Joint) -> Result<(), RobotError> {
    let fault = |quantity, found: String, expected| {
        Err(RobotError::Joint { joint: joint.name.clone(), quantity, found, expected })
    };
    for (quantity, placement) in [("frame before it", &joint.before), ("frame after it", &joint.after)] {
        if !placement.is_rigid() {
            return fault(quantity, shown(placement), RIGID);
        }
    }
    if let Some((convention, row)) = &joint.dh {
        check_dh(joint, *convention, row)?;
    }
    let (low, high) = joint.limits.position;
    if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
        return fault("position limit", format!("{low} to {high}"), "the lower below the upper");
    }
    for (quantity, value) in [
        ("velocity limit", joint.limits.velocity),
        ("acceleration limit", joint.limits.acceleration),
        ("jerk limit", joint.limits.jerk),
        ("torque limit", joint.limits.torque),
        ("continuous torque", joint.limits.continuous_torque),
        ("current limit", joint.drive.current_limit),
        ("continuous current", joint.drive.continuous_current),
        ("converter range", joint.drive.adc_range),
    ] {
        if value.is_nan() || value <= 0.0 {
            return fault(quantity, value.to_string(), ABOVE_ZERO);
        }
    }
    for (quantity, value) in [("gear ratio", joint.drive.gear), ("torque constant", joint.drive.torque_constant)] {
        if !(value.is_finite() && value > 0.0) {
            return fault(quantity, value.to_string(), FINITE_ABOVE_ZERO);
        }
    }
    for (quantity, value) in [
        ("encoder counts", joint.drive.counts_per_revolution),
        ("current noise", joint.drive.current_noise),
        ("Coulomb velocity", joint.drive.coulomb_velocity),
        ("voltage noise", joint.drive.voltage_noise),
    ] {
        if !(value.is_finite() && value >= 0.0) {
            return fault(quantity, value.to_string(), FINITE_NOT_BELOW);
        }
    }
    if ![1.0, -1.0].contains(&joint.drive.encoder_sign) {
        return fault("encoder sign", joint.drive.encoder_sign.to_string(), "1 or -1");
    }
    if joint.drive.adc_bits > 30 {
        return fault("converter bits", joint.drive.adc_bits.to_string(), "0 (none) to 30");
    }
    if joint.kind == JointKind::Revolute && joint.drive.adc_bits > 0 && !joint.drive.adc_range.is_finite() {
        return fault("converter range", joint.drive.adc_range.to_string(), "a finite number where there are bits");
    }
    if let Some((_, shape)) = joint.drive.shapes.iter().find(|(_, shape)| !shape.is_finite()) {
        return fault("shape parameter", shape.to_string(), "a finite number");
    }
    joint.drive.circuit.as_ref().map_or(Ok(()), |circuit| check_circuit(joint, circuit))
}

/// A DH row and the frames that were made from it say the same: formulas use the one, dynamics the other.
fn check_dh(joint: &Joint, convention: DhConvention, row: &DhRow) -> Result<(), RobotError> {
    let (before, after) = row.placements(convention);
    if same(&before, &joint.before) && same(&after, &joint.after) {
        return Ok(());
    }
    Err(RobotError::Joint {
        joint: joint.name.clone(),
        quantity: "DH row",
        found: format!("{row:?}"),
        expected: "the row of the joint's frames",
    })
}

fn check_circuit(joint: &Joint, circuit: &MotorCircuit) -> Result<(), RobotError> {
    let MotorCircuit { resistance, inductance, back_emf, brush_drop, supply } = *circuit;
    let fault = |quantity, found: f64, expected| {
        Err(RobotError::Joint { joint: joint.name.clone(), quantity, found: found.to_string(), expected })
    };
    if !(resistance.is_finite() && resistance > 0.0) {
        return fault("resistance", resistance, FINITE_ABOVE_ZERO);
    }
    if supply.is_nan() || supply <= 0.0 {
        return fault("supply voltage", supply, ABOVE_ZERO);
    }
    for (quantity, value) in [("inductance", inductance), ("back-EMF constant", back_emf), ("brush drop", brush_drop)] {
        if !(value.is_finite() && value >= 0.0) {
            return fault(quantity, value, FINITE_NOT_BELOW);
        }
    }
    Ok(())
}
