//! A serial chain, valid by construction.

use nalgebra::{DMatrix, Vector3};

use serde::{Deserialize, Serialize};

use super::declared_uncertainty::DeclaredUncertainty;
use super::drive::Drive;
use super::joint::Joint;
use super::point::NamedPoint;
use super::robot_error::{RobotError, check_joint, check_points, check_servo, check_surroundings};
use super::servo::{EffortInterface, ServoTuning};
use super::shape::{Obstacle, Shape};
use crate::input::size::JOINTS;
use crate::provenance::sha256;
use crate::spatial::{Motion, Placement};

/// What a [`Robot`] is made of; [`Robot::new`] checks it.
#[derive(Clone, Debug)]
pub struct RobotSpec {
    /// Name, as in the file.
    pub name: String,
    /// Gravity in the world frame, m/s².
    pub gravity: Vector3<f64>,
    /// Pose of the base frame in the world.
    pub base: Placement,
    /// The joints from the base outwards.
    pub joints: Vec<Joint>,
    /// Motor coordinates from joint coordinates, `q_motor = C q` (n × n), where motors are coupled.
    pub coupling: Option<DMatrix<f64>>,
    /// Shapes of the links.
    pub shapes: Vec<Shape>,
    /// What stands around the robot.
    pub obstacles: Vec<Obstacle>,
    /// Pairs of links (0 is the base, the lower first) whose shapes may touch, beside those that follow each other.
    pub may_touch: Vec<(usize, usize)>,
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
#[serde(remote = "Self", deny_unknown_fields)]
pub struct Robot {
    name: String,
    #[serde(rename = "gravity_m_s2", with = "crate::plain::vector")]
    gravity: Vector3<f64>,
    base: Placement,
    joints: Vec<Joint>,
    #[serde(skip)]
    axes: Vec<Motion>,
    #[serde(with = "crate::plain::matrix::option")]
    coupling: Option<DMatrix<f64>>,
    shapes: Vec<Shape>,
    obstacles: Vec<Obstacle>,
    may_touch: Vec<(usize, usize)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    points: Vec<NamedPoint>,
    effort: EffortInterface,
    #[serde(default)]
    servo: Option<ServoTuning>,
    #[serde(default, skip_serializing_if = "DeclaredUncertainty::is_none")]
    uncertainty: DeclaredUncertainty,
    source_sha256: String,
}

// Refuses what `Robot::new` refuses.
crate::plain::checked_when_read!(Robot, Robot::checked);

impl Robot {
    /// Returns this robot if it passes the checks of a specification.
    fn checked(self) -> Result<Self, RobotError> {
        self.servo.as_ref().map_or(Ok(()), check_servo)?;
        check_points(&self.points, self.joints.len())?;
        let axes = Self::new(self.clone().into_spec())?.axes;
        Ok(Self { axes, ..self })
    }

    /// Checks a specification.
    ///
    /// # Errors
    /// [`RobotError`] with what was found and what is possible.
    pub fn new(spec: RobotSpec) -> Result<Self, RobotError> {
        let RobotSpec { name, gravity, base, joints, coupling, shapes, obstacles, may_touch } = spec;
        if joints.is_empty() {
            return Err(RobotError::NoJoints { robot: name });
        }
        JOINTS.check_count("number of joints", joints.len())?;
        for (i, joint) in joints.iter().enumerate() {
            if joints[..i].iter().any(|other| other.name == joint.name) {
                return Err(RobotError::DuplicateJoint { joint: joint.name.clone() });
            }
            check_joint(joint)?;
        }
        let n = joints.len();
        if let Some(c) = &coupling
            && (c.shape() != (n, n) || c.clone().try_inverse().is_none())
        {
            return Err(RobotError::Coupling { rows: c.nrows(), columns: c.ncols(), dof: n });
        }
        check_surroundings(&gravity, &base, &shapes, &obstacles, &may_touch, n)?;
        let axes = joints.iter().map(Joint::axis).collect();
        let (effort, servo, uncertainty) = (EffortInterface::default(), None, DeclaredUncertainty::default());
        let source_sha256 = String::new();
        Ok(Self {
            name,
            gravity,
            base,
            joints,
            axes,
            coupling,
            shapes,
            obstacles,
            may_touch,
            points: Vec::new(),
            effort,
            servo,
            uncertainty,
            source_sha256,
        })
    }

    /// What it is made of, without effort interface, servo and named points.
    pub fn into_spec(self) -> RobotSpec {
        let Self { name, gravity, base, joints, coupling, shapes, obstacles, may_touch, .. } = self;
        RobotSpec { name, gravity, base, joints, coupling, shapes, obstacles, may_touch }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The joints from the base outwards; joint i moves link i.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Axis of each joint as a motion in its link's frame.
    pub fn axes(&self) -> &[Motion] {
        &self.axes
    }

    /// Gravity in the frame of the base, m/s².
    pub fn gravity(&self) -> Vector3<f64> {
        self.base.rotation.tr_mul(&self.gravity)
    }

    /// Pose of the base frame in the world.
    pub fn base(&self) -> &Placement {
        &self.base
    }

    /// Motor coordinates from joint coordinates, `q_motor = C q`, where motors are coupled.
    pub fn coupling(&self) -> Option<&DMatrix<f64>> {
        self.coupling.as_ref()
    }

    /// Whether motor `index` drives more than its own joint.
    pub fn is_coupled(&self, index: usize) -> bool {
        self.coupling.as_ref().is_some_and(|c| c.row(index).iter().enumerate().any(|(j, &x)| j != index && x != 0.0))
    }

    /// Shapes of the links.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// What stands around the robot.
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Pairs of links (0 is the base, the lower first) whose shapes may touch.
    pub fn may_touch(&self) -> &[(usize, usize)] {
        &self.may_touch
    }

    /// What is uncertain about it and leaves no trace in a recording.
    pub fn uncertainty(&self) -> &DeclaredUncertainty {
        &self.uncertainty
    }

    /// Returns this robot with this declared uncertainty.
    #[must_use]
    pub fn with_uncertainty(mut self, uncertainty: DeclaredUncertainty) -> Self {
        self.uncertainty = uncertainty;
        self
    }

    /// Points of the arm that have a name, beside the frames of the links.
    pub fn points(&self) -> &[NamedPoint] {
        &self.points
    }

    /// Returns this robot with these named points.
    ///
    /// # Panics
    /// If a point is on a link that does not exist.
    #[must_use]
    pub fn with_points(mut self, points: Vec<NamedPoint>) -> Self {
        assert!(points.iter().all(|point| point.link <= self.dof()), "every point is on a link of the robot");
        self.points = points;
        self
    }

    /// Name of a link: that of the joint which moves it, or "base" for link 0.
    pub fn link_name(&self, link: usize) -> &str {
        if link == 0 { "base" } else { &self.joints[link - 1].name }
    }

    /// SHA-256 of the text that it was read from; empty for a robot that was made otherwise.
    ///
    /// It stays when limits are changed afterwards: it says which file is meant, and a certificate names it.
    pub fn source_sha256(&self) -> &str {
        &self.source_sha256
    }

    /// Returns this robot as read from this text.
    #[must_use]
    pub fn read_from(mut self, text: &str) -> Self {
        self.source_sha256 = sha256(text);
        self
    }

    /// Returns this robot with another obstacle in its way.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: Obstacle) -> Self {
        self.obstacles.push(obstacle);
        self
    }

    /// Returns this robot with other shapes of its links, and other pairs of links (0 is the base, the lower first) that may touch.
    ///
    /// # Errors
    /// [`RobotError`] if a shape is not possible, or a link does not exist.
    pub fn with_shapes(self, shapes: Vec<Shape>, may_touch: Vec<(usize, usize)>) -> Result<Self, RobotError> {
        Self { shapes, may_touch, ..self }.checked()
    }

    /// What its controller reports as effort.
    pub fn effort(&self) -> EffortInterface {
        self.effort
    }

    /// How its servo is tuned: as stated, or [`ServoTuning::ASSUMED`].
    pub fn servo(&self) -> &ServoTuning {
        self.servo.as_ref().unwrap_or(&ServoTuning::ASSUMED)
    }

    /// How its servo is tuned, where anything states it.
    pub fn stated_servo(&self) -> Option<&ServoTuning> {
        self.servo.as_ref()
    }

    /// Returns this robot with other drives, one for each joint.
    ///
    /// # Panics
    /// If there is not one drive for each joint.
    #[must_use]
    pub fn with_drives(mut self, drives: Vec<Drive>) -> Self {
        assert_eq!(drives.len(), self.dof(), "one drive for each joint");
        for (joint, drive) in self.joints.iter_mut().zip(drives) {
            joint.drive = drive;
        }
        self
    }

    /// Returns this robot with another effort interface.
    #[must_use]
    pub fn with_effort(mut self, effort: EffortInterface) -> Self {
        self.effort = effort;
        self
    }

    /// Returns this robot with another tuning of its servo.
    #[must_use]
    pub fn with_servo(mut self, servo: ServoTuning) -> Self {
        self.servo = Some(servo);
        self
    }

    /// Returns this robot with every joint changed, as for other limits or another friction law.
    ///
    /// # Errors
    /// [`RobotError`] if a joint is no longer possible.
    pub fn with_joints(mut self, mut change: impl FnMut(&mut Joint)) -> Result<Self, RobotError> {
        for joint in &mut self.joints {
            change(joint);
            check_joint(joint)?;
        }
        self.axes = self.joints.iter().map(Joint::axis).collect();
        Ok(self)
    }

    /// Pose of every link's frame in the base frame at joint coordinates `q` (n).
    pub fn poses(&self, q: &[f64]) -> Vec<Placement> {
        let mut pose = Placement::identity();
        let next = |(joint, &q): (&Joint, &f64)| {
            pose = pose.compose(&joint.placement(q));
            pose
        };
        self.joints.iter().zip(q).map(next).collect()
    }

    /// Index of the joint with this name.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Returns this robot with another gravity in the world frame, m/s².
    #[must_use]
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.gravity = gravity;
        self
    }
}
