//! A serial chain, valid by construction.

use nalgebra::{DMatrix, Vector3};

use serde::{Deserialize, Serialize};

use super::declared_uncertainty::DeclaredUncertainty;
use super::drive::Drive;
use super::drive_kind::DriveKind;
use super::joint::Joint;
use super::point::NamedPoint;
use super::robot_error::{RobotError, check_joint, check_points, check_servo, check_surroundings};
use super::servo::{EffortInterface, ServoTuning};
use super::shape::{Obstacle, Shape};
use crate::input::size::JOINTS;
use crate::provenance::sha256;
use crate::spatial::{Motion, Placement};

/// What a [`Robot`] is made of; [`Robot::new`] checks it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Name, as in the file.
    pub name: String,
    /// Gravity in the world frame, m/s².
    #[serde(rename = "gravity_m_s2", with = "crate::plain::vector")]
    pub gravity: Vector3<f64>,
    /// Pose of the base frame in the world.
    pub base: Placement,
    /// The joints from the base outwards.
    pub joints: Vec<Joint>,
    /// Motor coordinates from joint coordinates, `q_motor = C q` (n × n), where motors are coupled.
    #[serde(with = "crate::plain::matrix::option")]
    pub coupling: Option<DMatrix<f64>>,
    /// Shapes of the links.
    pub shapes: Vec<Shape>,
    /// What stands around the robot.
    pub obstacles: Vec<Obstacle>,
    /// Pairs of links (0 is the base, the lower first) whose shapes may touch, beside those that follow each other.
    pub may_touch: Vec<(usize, usize)>,
    /// Points of the arm that have a name, beside the frames of the links.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<NamedPoint>,
    /// What its controller reports as effort.
    pub effort: EffortInterface,
    /// How its servo is tuned, where anything states it.
    #[serde(default)]
    pub servo: Option<ServoTuning>,
    /// What is uncertain about it and leaves no trace in a recording.
    #[serde(default, skip_serializing_if = "DeclaredUncertainty::is_none")]
    pub uncertainty: DeclaredUncertainty,
    /// What turns its joints, where anything states it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drives: Option<DriveKind>,
    /// SHA-256 of the text that it was read from; empty for a robot that was made otherwise.
    pub source_sha256: String,
}

/// A serial robot arm: kinematics, limits, drives, shapes. No inertia.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::{Robot, bundled, format::parse_robot};
/// let robot = parse_robot(bundled()[0].robot)?;
/// let json = serde_json::to_string(&robot)?;
/// assert_eq!(serde_json::from_str::<Robot>(&json)?, robot);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RobotSpec", into = "RobotSpec")]
pub struct Robot {
    spec: RobotSpec,
    axes: Vec<Motion>,
}

impl TryFrom<RobotSpec> for Robot {
    type Error = RobotError;

    fn try_from(spec: RobotSpec) -> Result<Self, RobotError> {
        Self::new(spec)
    }
}

impl From<Robot> for RobotSpec {
    fn from(robot: Robot) -> Self {
        robot.spec
    }
}

impl Robot {
    /// Checks a specification.
    ///
    /// # Errors
    /// [`RobotError`] with what was found and what is possible.
    pub fn new(spec: RobotSpec) -> Result<Self, RobotError> {
        let (joints, n) = (&spec.joints, spec.joints.len());
        if joints.is_empty() {
            return Err(RobotError::NoJoints { robot: spec.name });
        }
        JOINTS.check_count("number of joints", n)?;
        for (i, joint) in joints.iter().enumerate() {
            if joints[..i].iter().any(|other| other.name == joint.name) {
                return Err(RobotError::DuplicateJoint { joint: joint.name.clone() });
            }
            check_joint(joint)?;
        }
        if let Some(c) = &spec.coupling
            && (c.shape() != (n, n) || c.clone().try_inverse().is_none())
        {
            return Err(RobotError::Coupling { rows: c.nrows(), columns: c.ncols(), dof: n });
        }
        check_surroundings(&spec)?;
        check_points(&spec.points, n)?;
        spec.servo.as_ref().map_or(Ok(()), check_servo)?;
        Ok(Self { axes: joints.iter().map(Joint::axis).collect(), spec })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.spec.name
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.spec.joints.len()
    }

    /// The joints from the base outwards; joint i moves link i.
    pub fn joints(&self) -> &[Joint] {
        &self.spec.joints
    }

    /// Axis of each joint as a motion in its link's frame.
    pub fn axes(&self) -> &[Motion] {
        &self.axes
    }

    /// Gravity in the frame of the base, m/s².
    pub fn gravity(&self) -> Vector3<f64> {
        self.spec.base.rotation.tr_mul(&self.spec.gravity)
    }

    /// Pose of the base frame in the world.
    pub fn base(&self) -> &Placement {
        &self.spec.base
    }

    /// Motor coordinates from joint coordinates, `q_motor = C q`, where motors are coupled.
    pub fn coupling(&self) -> Option<&DMatrix<f64>> {
        self.spec.coupling.as_ref()
    }

    /// Whether motor `index` drives more than its own joint.
    pub fn is_coupled(&self, index: usize) -> bool {
        self.spec
            .coupling
            .as_ref()
            .is_some_and(|c| c.row(index).iter().enumerate().any(|(j, &x)| j != index && x != 0.0))
    }

    /// Shapes of the links.
    pub fn shapes(&self) -> &[Shape] {
        &self.spec.shapes
    }

    /// What stands around the robot.
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.spec.obstacles
    }

    /// Pairs of links (0 is the base, the lower first) whose shapes may touch.
    pub fn may_touch(&self) -> &[(usize, usize)] {
        &self.spec.may_touch
    }

    /// What is uncertain about it and leaves no trace in a recording.
    pub fn uncertainty(&self) -> &DeclaredUncertainty {
        &self.spec.uncertainty
    }

    /// What turns its joints, where anything states it.
    pub const fn drive_kind(&self) -> Option<DriveKind> {
        self.spec.drives
    }

    /// Returns this robot with this declared uncertainty.
    #[must_use]
    pub fn with_uncertainty(mut self, uncertainty: DeclaredUncertainty) -> Self {
        self.spec.uncertainty = uncertainty;
        self
    }

    /// Points of the arm that have a name, beside the frames of the links.
    pub fn points(&self) -> &[NamedPoint] {
        &self.spec.points
    }

    /// Name of a link: that of the joint which moves it, or "base" for link 0.
    pub fn link_name(&self, link: usize) -> &str {
        if link == 0 { "base" } else { &self.spec.joints[link - 1].name }
    }

    /// SHA-256 of the text that it was read from; empty for a robot that was made otherwise.
    ///
    /// It stays when limits are changed afterwards: it says which file is meant, and a certificate names it.
    pub fn source_sha256(&self) -> &str {
        &self.spec.source_sha256
    }

    /// Returns this robot with the text that it was read from, of which it keeps the checksum.
    #[must_use]
    pub fn with_source(mut self, text: &str) -> Self {
        self.spec.source_sha256 = sha256(text);
        self
    }

    /// Returns this robot with another obstacle in its way.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: Obstacle) -> Self {
        self.spec.obstacles.push(obstacle);
        self
    }

    /// What its controller reports as effort.
    pub fn effort(&self) -> EffortInterface {
        self.spec.effort
    }

    /// How its servo is tuned: as stated, or [`ServoTuning::ASSUMED`].
    pub fn servo(&self) -> &ServoTuning {
        self.spec.servo.as_ref().unwrap_or(&ServoTuning::ASSUMED)
    }

    /// How its servo is tuned, where anything states it.
    pub fn stated_servo(&self) -> Option<&ServoTuning> {
        self.spec.servo.as_ref()
    }

    /// Returns this robot with other drives, one for each joint.
    ///
    /// # Panics
    /// If there is not one drive for each joint.
    #[must_use]
    pub fn with_drives(mut self, drives: Vec<Drive>) -> Self {
        assert_eq!(drives.len(), self.dof(), "one drive for each joint");
        for (joint, drive) in self.spec.joints.iter_mut().zip(drives) {
            joint.drive = drive;
        }
        self
    }

    /// Returns this robot with its specification changed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_spec(mut self, change: impl FnOnce(&mut RobotSpec)) -> Result<Self, RobotError> {
        change(&mut self.spec);
        Self::new(self.spec)
    }

    /// Returns this robot with every joint changed, as for other limits or another friction law.
    ///
    /// # Errors
    /// [`RobotError`] if a joint is no longer possible.
    pub fn with_joints(self, change: impl FnMut(&mut Joint)) -> Result<Self, RobotError> {
        self.with_spec(|spec| spec.joints.iter_mut().for_each(change))
    }

    /// Pose of every link's frame in the base frame at joint coordinates `q` (n).
    pub fn poses(&self, q: &[f64]) -> Vec<Placement> {
        let mut pose = Placement::identity();
        let next = |(joint, &q): (&Joint, &f64)| {
            pose = pose.compose(&joint.placement(q));
            pose
        };
        self.spec.joints.iter().zip(q).map(next).collect()
    }

    /// Index of the joint with this name.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.spec.joints.iter().position(|joint| joint.name == name)
    }

    /// Returns this robot with another gravity in the world frame, m/s².
    #[must_use]
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.spec.gravity = gravity;
        self
    }
}
