//! Why a robot cannot be as specified, and the checks that say so.

use super::capsule::Capsule;
use super::hull::Hull;
use super::joint::{Joint, JointKind};
use super::motor_circuit::MotorCircuit;
use super::point::NamedPoint;
use super::robot::RobotSpec;
use super::servo::ServoTuning;
use super::shape::{Cuboid, Obstacle, Shape, Solid};
use crate::input::SizeError;
use crate::spatial::Placement;

/// How far the length of a plane's normal may be from one, and a frame from that of its DH row: rounding.
const ROUNDING: f64 = 1e-9;

const ABOVE_ZERO: Bound = Bound { expected: "a number above zero", holds: |x| x > 0.0 };
const FINITE_ABOVE_ZERO: Bound = Bound { expected: "a finite number above zero", holds: |x| x.is_finite() && x > 0.0 };
const FINITE_NOT_BELOW: Bound =
    Bound { expected: "a finite number not below zero", holds: |x| x.is_finite() && x >= 0.0 };
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
    /// A quantity of the robot as a whole, of a joint, of its servo, of a shape or of an obstacle is outside what is possible.
    #[error("{place}: {quantity} is {found}, expected {expected}")]
    Quantity { place: String, quantity: &'static str, found: String, expected: &'static str },
}

/// What numbers must be.
struct Bound {
    expected: &'static str,
    holds: fn(f64) -> bool,
}

impl Bound {
    fn check(&self, place: impl Fn() -> String, values: &[(&'static str, f64)]) -> Result<(), RobotError> {
        match values.iter().find(|(_, value)| !(self.holds)(*value)) {
            Some((quantity, value)) => fault(place(), quantity, value.to_string(), self.expected),
            None => Ok(()),
        }
    }
}

/// Gravity, base, shapes, obstacles and the pairs that may touch.
pub(super) fn check_surroundings(spec: &RobotSpec) -> Result<(), RobotError> {
    let RobotSpec { gravity, base, shapes, obstacles, may_touch, .. } = spec;
    let dof = spec.joints.len();
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
        Solid::Capsule(Capsule { from, to, radius }) => {
            FINITE_ABOVE_ZERO.check(&place, &[("radius", *radius)])?;
            if !from.iter().chain(to).all(|x| x.is_finite()) {
                return fault(place(), "segment", format!("{:?} to {:?}", from.as_slice(), to.as_slice()), FINITE);
            }
        }
        Solid::Cuboid(Cuboid { half, placement }) => {
            if !half.iter().all(|x| (FINITE_ABOVE_ZERO.holds)(*x)) {
                let found = format!("{:?}", half.as_slice());
                return fault(place(), "half length", found, FINITE_ABOVE_ZERO.expected);
            }
            if !placement.is_rigid() {
                return fault(place(), "placement", shown(placement), RIGID);
            }
        }
        Solid::Hull(Hull { points, margin }) => {
            if points.is_empty() {
                return fault(place(), "number of points", "0".to_owned(), "at least one");
            }
            if !points.iter().flatten().all(|x| x.is_finite()) {
                return fault(place(), "points", "one that is not finite".to_owned(), FINITE);
            }
            FINITE_NOT_BELOW.check(&place, &[("margin", *margin)])?;
        }
    }
    Ok(())
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
    FINITE_ABOVE_ZERO.check(place, &[("rate_hz", rate_hz), ("bandwidth_hz", bandwidth_hz), ("damping", damping)])?;
    FINITE_NOT_BELOW.check(place, &[("integral_hz", integral_hz)])
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
    let place = || format!("joint \"{}\"", joint.name);
    for (quantity, placement) in [("frame before it", &joint.before), ("frame after it", &joint.after)] {
        if !placement.is_rigid() {
            return fault(place(), quantity, shown(placement), RIGID);
        }
    }
    if let Some((convention, row)) = &joint.dh {
        // Formulas use the row, dynamics the frames.
        let (before, after) = row.placements(*convention);
        if !(same(&before, &joint.before) && same(&after, &joint.after)) {
            return fault(place(), "DH row", format!("{row:?}"), "the row of the joint's frames");
        }
    }
    let (limits, drive) = (&joint.limits, &joint.drive);
    let (low, high) = limits.position;
    if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
        return fault(place(), "position limit", format!("{low} to {high}"), "the lower below the upper");
    }
    let above_zero = [
        ("velocity limit", limits.velocity),
        ("acceleration limit", limits.acceleration),
        ("jerk limit", limits.jerk),
        ("torque limit", limits.torque),
        ("continuous torque", limits.continuous_torque),
        ("current limit", drive.current_limit),
        ("continuous current", drive.continuous_current),
        ("converter range", drive.adc_range),
    ];
    ABOVE_ZERO.check(place, &above_zero)?;
    FINITE_ABOVE_ZERO.check(place, &[("gear ratio", drive.gear), ("torque constant", drive.torque_constant)])?;
    let not_below = [
        ("encoder counts", drive.counts_per_revolution),
        ("current noise", drive.current_noise),
        ("Coulomb velocity", drive.coulomb_velocity),
        ("voltage noise", drive.voltage_noise),
    ];
    FINITE_NOT_BELOW.check(place, &not_below)?;
    if ![1.0, -1.0].contains(&drive.encoder_sign) {
        return fault(place(), "encoder sign", drive.encoder_sign.to_string(), "1 or -1");
    }
    if drive.adc_bits > 30 {
        return fault(place(), "converter bits", drive.adc_bits.to_string(), "0 (none) to 30");
    }
    if joint.kind == JointKind::Revolute && drive.adc_bits > 0 && !drive.adc_range.is_finite() {
        let expected = "a finite number where there are bits";
        return fault(place(), "converter range", drive.adc_range.to_string(), expected);
    }
    if let Some((_, shape)) = drive.shapes.iter().find(|(_, shape)| !shape.is_finite()) {
        return fault(place(), "shape parameter", shape.to_string(), "a finite number");
    }
    let Some(MotorCircuit { resistance, inductance, back_emf, brush_drop, supply }) = drive.circuit else {
        return Ok(());
    };
    FINITE_ABOVE_ZERO.check(place, &[("resistance", resistance)])?;
    ABOVE_ZERO.check(place, &[("supply voltage", supply)])?;
    let not_below = [("inductance", inductance), ("back-EMF constant", back_emf), ("brush drop", brush_drop)];
    FINITE_NOT_BELOW.check(place, &not_below)
}
