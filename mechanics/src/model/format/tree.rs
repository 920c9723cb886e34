//! From a tree of bodies to a serial chain: bodies that are fixed to each other become one link.
//!
//! ```text
//! φ_link = Σ_b φ_b seen from the link's frame
//! ```
//! A joint that does not lie on the chain is held at zero, and its bodies are carried along.

use std::ops::Range;

use nalgebra::{DMatrix, Matrix3, RowDVector, Vector3};

use crate::model::term::ROTOR;

use super::collision::{CollisionShape, Geometry};
use super::error::FormatError;
use super::reading::Check;
use crate::model::drive::Drive;
use crate::model::joint::{Joint, JointKind, Limits};
use crate::model::parameters::{DriveParameters, StandardParameters};
use crate::model::robot::{Robot, RobotSpec};
use crate::model::servo::EffortInterface;
use crate::spatial::{Inertia, Placement};

/// Which serial chain of a tree is meant; what is not given is chosen where there is no choice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainEnds {
    /// The link (URDF) or body (MJCF) that stands still; the root where not given.
    pub base: Option<String>,
    /// The link or body that the chain ends at. Where not given, the last joint of the only chain; where chains part, the
    /// place where they do, provided that they are a gripper's: each has at most half as many joints as the arm before.
    pub tip: Option<String>,
}

/// A robot that another tool's file describes, with the parameters of that file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedModel {
    /// The serial chain.
    pub robot: Robot,
    /// Inertias of its links, and friction and rotor inertia of its joints.
    pub parameters: StandardParameters,
    /// Joints of the tree that the chain does not have, held at zero.
    pub locked: Vec<String>,
    /// Collision shapes of the file, in the frames of the chain's links; [`Robot::shapes`] has none of them.
    pub collisions: Vec<CollisionShape>,
    /// Joints whose angles are read as right angles, although they are written a little off.
    pub snapped: Vec<SnappedJoint>,
    /// What else was read otherwise than it is written, a sentence each.
    pub remarks: Vec<String>,
}

/// A joint of a URDF, from base to tip, whose angles are read as right angles.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SnappedJoint {
    /// Its name.
    pub name: String,
    /// The largest angle by which it was off, rad.
    pub angle_rad: f64,
}

/// The first joint whose place, or the inertia of its link, is no longer finite where numbers of the file came together.
fn overflowing<'a>(joints: &'a [Joint], parameters: &StandardParameters) -> Option<&'a str> {
    let finite = |place: &Placement| place.translation.iter().chain(place.rotation.iter()).all(|x| x.is_finite());
    let mut links = joints.iter().zip(&parameters.links);
    let found = links.find(|(joint, link)| {
        !(finite(&joint.before) && finite(&joint.after) && link.to_array().iter().all(|x| x.is_finite()))
    });
    found.map(|(joint, _)| joint.name.as_str())
}

/// A sentence for each physically inconsistent link; a file may state one without mass, or a point mass.
fn impossible(robot: &Robot, parameters: &StandardParameters) -> Vec<String> {
    let links = robot.joints().iter().zip(&parameters.links);
    links
        .filter_map(|(joint, link)| {
            let pseudo = link.pseudo();
            let least = pseudo.smallest_eigenvalue();
            let size = pseudo.0.diagonal().abs().max();
            // Beyond rounding.
            (least < -1e-9 * size).then(|| {
                format!(
                    "the link of joint \"{}\" is physically inconsistent: the smallest eigenvalue of its pseudo-inertia is \
                     {least:.3e}, expected none below zero",
                    joint.name
                )
            })
        })
        .collect()
}

/// How a body hangs on its parent.
pub(super) enum Connection {
    Fixed,
    Moving(MovingJoint),
    /// A joint that follows another.
    Follows {
        joint: String,
        leader: String,
    },
    /// A joint with more than one degree of freedom: its name and what it is.
    Unsupported(String, String),
}

/// A joint with one degree of freedom.
pub(super) struct MovingJoint {
    pub(super) name: String,
    pub(super) kind: JointKind,
    /// The frame in that of the body whose z axis is the joint's.
    pub(super) axis: Placement,
    pub(super) limits: Limits,
    pub(super) drive: DriveParameters,
}

/// One body of the tree.
pub(super) struct Body {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// Pose of its frame in the parent's, at zero.
    pub(super) placement: Placement,
    /// The joint that carries it and by how much its angles were off the right ones that they are read as, rad.
    pub(super) snapped: Option<SnappedJoint>,
    pub(super) connection: Connection,
    /// In its own frame; a fault that counts only where the body moves.
    pub(super) inertia: Result<Inertia, FormatError>,
    /// Its collision shapes, each with the pose of its frame in that of the body.
    pub(super) shapes: Vec<(Placement, Result<Geometry, FormatError>)>,
    pub(super) at: Range<usize>,
}

impl Body {
    /// One without a parent and without mass.
    pub(super) fn root(name: impl Into<String>, at: Range<usize>) -> Self {
        Self {
            name: name.into(),
            parent: None,
            placement: Placement::identity(),
            snapped: None,
            connection: Connection::Fixed,
            inertia: Ok(Inertia::zero()),
            shapes: Vec::new(),
            at,
        }
    }
}

/// A rotor that turns by `Σ c_j q_j`.
pub(super) struct CoupledRotor {
    /// Number of its motor, from one, where its name says it.
    pub(super) motor: Option<usize>,
    /// Its inertia, kg·m².
    pub(super) inertia: f64,
    /// Joints by name, with their c.
    pub(super) joints: Vec<(String, f64)>,
    pub(super) at: Range<usize>,
}

/// A tree of bodies with one root; every parent stands before its children.
pub(super) struct Tree<'a> {
    pub(super) check: Check<'a>,
    /// Where the whole robot begins in the text.
    pub(super) at: Range<usize>,
    pub(super) name: String,
    pub(super) gravity: Vector3<f64>,
    pub(super) bodies: Vec<Body>,
    /// Rotors that turn with several joints.
    pub(super) rotors: Vec<CoupledRotor>,
    /// Joints from base to tip whose angles are not read as they are written.
    pub(super) snapped: Vec<SnappedJoint>,
    pub(super) remarks: Vec<String>,
}

impl Tree<'_> {
    /// For each body beyond the base: the link of the chain that carries it (0 the base), and its pose in that link.
    pub(super) fn carried(&self, base: usize, moving: &[usize]) -> Vec<Option<(usize, Placement)>> {
        let mut carried: Vec<Option<(usize, Placement)>> = vec![None; self.bodies.len()];
        carried[base] = Some((0, Placement::identity()));
        for (b, body) in self.bodies.iter().enumerate() {
            let Some((link, pose)) = body.parent.and_then(|parent| carried[parent]) else { continue };
            carried[b] = Some(match moving.iter().position(|&m| m == b) {
                Some(index) => (index + 1, Placement::identity()),
                None => (link, pose.compose(&body.placement)),
            });
        }
        carried
    }

    /// The bodies from the root to this one.
    pub(super) fn path(&self, body: usize) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(Some(body), |&b| self.bodies[b].parent).collect();
        path.reverse();
        path
    }

    /// The bodies below `base` on the way to `tip` that move against their parent.
    pub(super) fn moving(&self, base: usize, tip: usize) -> Vec<usize> {
        let below = self.path(tip).into_iter().skip_while(|&b| b != base).skip(1);
        below.filter(|&b| !matches!(self.bodies[b].connection, Connection::Fixed)).collect()
    }

    pub(super) fn assemble(self, base: usize, moving: &[usize]) -> Result<ImportedModel, FormatError> {
        let n = moving.len();
        let mut parameters = StandardParameters::zero(n);
        let mut joints = Vec::with_capacity(n);
        let mut locked = Vec::new();
        let carried = self.carried(base, moving);
        for (b, body) in self.bodies.iter().enumerate() {
            let Some((_, pose_of_parent)) = body.parent.and_then(|parent| carried[parent]) else { continue };
            match (&body.connection, moving.iter().position(|&m| m == b)) {
                (Connection::Moving(joint), Some(index)) => {
                    joints.push(joint.on_chain(&pose_of_parent.compose(&body.placement)));
                    parameters.drives[index].clone_from(&joint.drive);
                }
                (Connection::Follows { joint, leader }, Some(_)) => {
                    let message = format!(
                        "joint \"{joint}\" is a mimic of joint \"{leader}\", expected a chain whose joints move on their own"
                    );
                    return self.check.fault(body.at.clone(), message);
                }
                (Connection::Follows { joint, leader }, None) => {
                    locked.push(format!("{joint} (a mimic of {leader})"));
                }
                (Connection::Unsupported(name, what), Some(_)) => {
                    let message = format!("joint \"{name}\" is {what}, expected a joint with one degree of freedom");
                    return self.check.fault(body.at.clone(), message);
                }
                (Connection::Moving(MovingJoint { name, .. }), None) => locked.push(name.clone()),
                (Connection::Unsupported(name, what), None) => locked.push(format!("{name} ({what})")),
                (Connection::Fixed, _) => {}
            }
            if let Some((link @ 1.., pose)) = carried[b] {
                let inertia = body.inertia.as_ref().map_err(Clone::clone)?;
                parameters.links[link - 1] += moved(inertia, &pose);
            }
        }
        let collisions = self.collisions(base, &carried);
        let spec = RobotSpec {
            name: self.name.clone(),
            gravity: self.gravity,
            base: self.pose_in_root(base),
            coupling: self.coupling(&joints, &mut parameters)?,
            joints,
            effort: EffortInterface::Torque,
            ..RobotSpec::default()
        };
        if let Some(joint) = overflowing(&spec.joints, &parameters) {
            let message = format!(
                "the link of joint \"{joint}\" has an inertia or a place beyond all numbers, expected finite ones"
            );
            return self.check.fault(self.at.clone(), message);
        }
        let robot = Robot::new(spec).or_else(|fault| self.check.fault(self.at.clone(), fault.to_string()))?;
        let mut remarks = self.remarks;
        remarks.extend(impossible(&robot, &parameters));
        Ok(ImportedModel { robot, parameters, locked, collisions, snapped: self.snapped, remarks })
    }

    /// Pose of a body in the frame of the root.
    fn pose_in_root(&self, body: usize) -> Placement {
        self.path(body).iter().fold(Placement::identity(), |pose, &b| pose.compose(&self.bodies[b].placement))
    }

    /// The collision shapes on the links that carry their bodies; what does not hang on the base stands with it.
    fn collisions(&self, base: usize, carried: &[Option<(usize, Placement)>]) -> Vec<CollisionShape> {
        let to_base = self.pose_in_root(base).inverse();
        let mut shapes = Vec::new();
        for (b, body) in self.bodies.iter().enumerate() {
            let beside = || (0, to_base.compose(&self.pose_in_root(b)));
            for (placement, geometry) in &body.shapes {
                let (link, pose) = carried[b].unwrap_or_else(beside);
                let placement = pose.compose(placement);
                shapes.push(CollisionShape { link, body: body.name.clone(), placement, geometry: geometry.clone() });
            }
        }
        shapes
    }

    /// `q_motor = C q` and the inertia of the rotors behind it. A rotor stands for the motor that its name says, else for
    /// the last of its joints that has no rotor of its own.
    fn coupling(
        &self,
        joints: &[Joint],
        parameters: &mut StandardParameters,
    ) -> Result<Option<DMatrix<f64>>, FormatError> {
        let n = joints.len();
        let mut coupling = DMatrix::identity(n, n);
        let mut taken = vec![false; n];
        for rotor in &self.rotors {
            let mut row = vec![0.0; n];
            for (name, coefficient) in &rotor.joints {
                if let Some(j) = joints.iter().position(|joint| joint.name == *name) {
                    row[j] += coefficient;
                }
            }
            if row.iter().all(|&c| c == 0.0) {
                continue;
            }
            let is_free = |&j: &usize| !taken[j] && row[j] != 0.0 && parameters.drives[j][ROTOR] == 0.0;
            let named = rotor.motor.and_then(|motor| motor.checked_sub(1)).filter(|&j| j < n).filter(is_free);
            let Some(motor) = named.or_else(|| (0..n).rfind(is_free)) else {
                let message = "each joint of the tendon has a rotor of its own, expected one whose motor this is";
                return self.check.fault(rotor.at.clone(), message);
            };
            taken[motor] = true;
            parameters.drives[motor][ROTOR] = rotor.inertia;
            coupling.set_row(motor, &RowDVector::from_vec(row));
        }
        Ok(taken.contains(&true).then_some(coupling))
    }
}

impl MovingJoint {
    /// The joint between two links, where `pose` places this one's frame in the previous link at zero.
    fn on_chain(&self, pose: &Placement) -> Joint {
        Joint {
            name: self.name.clone(),
            kind: self.kind,
            before: pose.compose(&self.axis),
            after: self.axis.inverse(),
            dh: None,
            limits: self.limits,
            drive: Drive::ideal(),
        }
    }
}

/// The inertia of a body about the frame in which `pose` places its own: Steiner's theorem about any point.
///
/// ```text
/// h = R h_b    I = R I_b Rᵀ + 2 (p·h) 1 − p hᵀ − h pᵀ + m (p·p 1 − p pᵀ)    m c = h + m p
/// ```
pub(super) fn moved(inertia: &Inertia, pose: &Placement) -> Inertia {
    let (r, p, m) = (pose.rotation, pose.translation, inertia.mass);
    let h = r * inertia.first_moment;
    let cross = p * h.transpose();
    let diagonal = Matrix3::from_diagonal_element(2.0 * p.dot(&h) + m * p.norm_squared());
    // What the displacement adds comes first: its zeros are exact, and small inertias keep their digits.
    let displaced = diagonal - cross - cross.transpose() - p * p.transpose() * m;
    let rotational = r * inertia.rotational * r.transpose() + displaced;
    Inertia { mass: m, first_moment: h + p * m, rotational: (rotational + rotational.transpose()) * 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::format::element::turn_z_to;
    use crate::spatial::PseudoInertia;
    use nalgebra::Matrix4;

    #[test]
    fn identity_a_moved_inertia_is_the_congruence_of_its_pseudo_inertia() {
        let inertia = Inertia::from_array(&[2.0, 0.1, -0.2, 0.3, 0.5, 0.01, -0.02, 0.6, 0.03, 0.7]);
        let pose = Placement::new(turn_z_to(&Vector3::new(0.48, 0.6, -0.64)), Vector3::new(0.4, -1.1, 0.7));
        let mut x = Matrix4::identity();
        x.fixed_view_mut::<3, 3>(0, 0).copy_from(&pose.rotation);
        x.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
        let expected = PseudoInertia(x * inertia.pseudo().0 * x.transpose()).inertia();
        for (a, b) in moved(&inertia, &pose).to_array().iter().zip(expected.to_array()) {
            // Entries are of order one.
            assert!((a - b).abs() < 1e-14, "{a} against {b}");
        }
    }
}
