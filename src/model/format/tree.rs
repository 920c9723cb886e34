//! From a tree of bodies to a serial chain: bodies that are fixed to each other become one link.
//!
//! ```text
//! φ_link = Σ_b φ_b seen from the link's frame
//! ```
//! A joint that does not lie on the chain is held at zero, and its bodies are carried along.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::FormatError;
use super::reading::Check;
use super::reading::quoted;
use crate::model::{
    Drive, DriveParameters, EffortInterface, Joint, JointKind, Limits, Robot, RobotSpec, StandardParameters,
};
use crate::spatial::{Inertia, Placement};

/// Which serial chain of a tree is meant; what is not given is chosen where there is no choice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainEnds {
    /// The link (URDF) or body (MJCF) that stands still; the root where not given.
    pub base: Option<String>,
    /// The link or body that the chain ends at; the end of the longest chain where not given.
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
    /// What else was read otherwise than it is written, a sentence each.
    pub remarks: Vec<String>,
}

impl ImportedModel {
    /// The same model, whose robot says which text it was read from.
    pub(super) fn read_from(mut self, text: &str) -> Self {
        self.robot = self.robot.read_from(text);
        self
    }
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

/// A sentence for each link whose inertia no body has; one without mass, or a point mass, is what a file may state.
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
                    "the link of joint \"{}\" cannot be a real body: the smallest eigenvalue of its pseudo-inertia is \
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
    /// A joint with more than one degree of freedom, or one that follows another: its name and what it is.
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
    pub(super) connection: Connection,
    /// In its own frame; a fault that counts only where the body moves.
    pub(super) inertia: Result<Inertia, FormatError>,
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
    pub(super) remarks: Vec<String>,
}

impl Tree<'_> {
    /// The serial chain between two bodies.
    pub(super) fn chain(self, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
        let base = ends.base.as_ref().map_or(Ok(0), |name| self.find("base", name))?;
        let tip = match &ends.tip {
            Some(name) => self.find("tip", name)?,
            None => self.only_tip(base)?,
        };
        if !self.path(tip).contains(&base) {
            let (base, tip) = (&self.bodies[base].name, &self.bodies[tip].name);
            return self
                .check
                .fault(self.at.clone(), format!("\"{tip}\" does not hang on \"{base}\", expected a tip that does"));
        }
        let moving = self.moving(base, tip);
        if moving.is_empty() {
            let (base, tip) = (&self.bodies[base].name, &self.bodies[tip].name);
            let message = format!("no joint moves between \"{base}\" and \"{tip}\", expected at least one");
            return self.check.fault(self.at.clone(), message);
        }
        self.assemble(base, &moving)
    }

    /// A body by its name.
    fn find(&self, end: &str, name: &str) -> Result<usize, FormatError> {
        self.bodies.iter().position(|body| body.name == name).map_or_else(
            || {
                let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
                let message = format!("{end} \"{name}\" is not there, expected one of {}", quoted(&names));
                self.check.fault(self.at.clone(), message)
            },
            Ok,
        )
    }

    /// The bodies from the root to this one.
    fn path(&self, body: usize) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(Some(body), |&b| self.bodies[b].parent).collect();
        path.reverse();
        path
    }

    /// The bodies below `base` on the way to `tip` that move against their parent.
    fn moving(&self, base: usize, tip: usize) -> Vec<usize> {
        let path = self.path(tip);
        path.into_iter()
            .skip_while(|&b| b != base)
            .skip(1)
            .filter(|&b| !matches!(self.bodies[b].connection, Connection::Fixed))
            .collect()
    }

    /// The leaf at the end of the longest chain, provided that no joint moves outside of that chain.
    fn only_tip(&self, base: usize) -> Result<usize, FormatError> {
        let is_leaf = |b: &usize| !self.bodies.iter().any(|body| body.parent == Some(*b));
        let leaves: Vec<usize> =
            (0..self.bodies.len()).filter(is_leaf).filter(|&b| self.path(b).contains(&base)).collect();
        let chains: Vec<Vec<usize>> = leaves.iter().map(|&leaf| self.moving(base, leaf)).collect();
        let mut longest = 0;
        for (i, chain) in chains.iter().enumerate() {
            if chain.len() > chains[longest].len() {
                longest = i;
            }
        }
        if chains.iter().all(|chain| chains[longest].starts_with(chain)) {
            return Ok(leaves[longest]);
        }
        let names: Vec<&str> = leaves.iter().map(|&leaf| self.bodies[leaf].name.as_str()).collect();
        let message = format!("the robot is a tree, expected a tip to choose the chain, one of {}", quoted(&names));
        self.check.fault(self.at.clone(), message)
    }

    fn assemble(self, base: usize, moving: &[usize]) -> Result<ImportedModel, FormatError> {
        let n = moving.len();
        let mut parameters = StandardParameters::zero(n);
        let mut joints = Vec::with_capacity(n);
        let mut locked = Vec::new();
        // For each body below the base: the link that carries it (0 the base), and its pose in that link.
        let mut carried: Vec<Option<(usize, Placement)>> = vec![None; self.bodies.len()];
        carried[base] = Some((0, Placement::identity()));
        for (b, body) in self.bodies.iter().enumerate() {
            let Some((link, pose)) = body.parent.and_then(|parent| carried[parent]) else { continue };
            let pose = pose.compose(&body.placement);
            let chain_index = moving.iter().position(|&m| m == b);
            let (link, pose) = match (&body.connection, chain_index) {
                (Connection::Moving(joint), Some(index)) => {
                    joints.push(joint.on_chain(&pose));
                    parameters.drives[index].clone_from(&joint.drive);
                    (index + 1, Placement::identity())
                }
                (Connection::Unsupported(name, what), Some(_)) => {
                    let message = format!("joint \"{name}\" is {what}, expected a joint with one degree of freedom");
                    return self.check.fault(body.at.clone(), message);
                }
                (Connection::Moving(MovingJoint { name, .. }) | Connection::Unsupported(name, _), None) => {
                    locked.push(name.clone());
                    (link, pose)
                }
                (Connection::Fixed, _) => (link, pose),
            };
            if link > 0 {
                let inertia = body.inertia.as_ref().map_err(Clone::clone)?;
                parameters.links[link - 1] = sum(&parameters.links[link - 1], &moved(inertia, &pose));
            }
            carried[b] = Some((link, pose));
        }
        let spec = RobotSpec {
            name: self.name.clone(),
            gravity: self.gravity,
            base: self
                .path(base)
                .iter()
                .fold(Placement::identity(), |pose, &b| pose.compose(&self.bodies[b].placement)),
            joints,
            coupling: None,
            shapes: Vec::new(),
            obstacles: Vec::new(),
            may_touch: Vec::new(),
        };
        if let Some(joint) = overflowing(&spec.joints, &parameters) {
            let message = format!(
                "the link of joint \"{joint}\" has an inertia or a place beyond all numbers, expected finite ones"
            );
            return self.check.fault(self.at.clone(), message);
        }
        match Robot::new(spec) {
            Ok(robot) => {
                let robot = robot.with_effort(EffortInterface::Torque);
                let mut remarks = self.remarks;
                remarks.extend(impossible(&robot, &parameters));
                Ok(ImportedModel { robot, parameters, locked, remarks })
            }
            Err(fault) => self.check.fault(self.at.clone(), fault.to_string()),
        }
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

fn sum(a: &Inertia, b: &Inertia) -> Inertia {
    Inertia {
        mass: a.mass + b.mass,
        first_moment: a.first_moment + b.first_moment,
        rotational: a.rotational + b.rotational,
    }
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
