//! A serial chain, valid by construction.

use nalgebra::{DMatrix, Vector3};

use super::{Drive, EffortInterface, Joint, JointKind, Obstacle, ServoTuning, Shape};
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

/// Why a robot cannot be as specified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotFault {
    /// No joints.
    #[error("robot \"{robot}\" has no joints, expected at least one")]
    NoJoints {
        /// Name of the robot.
        robot: String,
    },
    /// Two joints of one name.
    #[error("joint name \"{joint}\" occurs twice, expected each name once")]
    DuplicateJoint {
        /// The name.
        joint: String,
    },
    /// A quantity is outside what is possible.
    #[error("joint \"{joint}\": {quantity} is {found}, expected {expected}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Which quantity.
        quantity: &'static str,
        /// What was found.
        found: String,
        /// What is possible.
        expected: &'static str,
    },
    /// The coupling matrix is not n × n and invertible.
    #[error("coupling is {found}, expected {expected}")]
    Coupling {
        /// What was found.
        found: String,
        /// What is possible.
        expected: String,
    },
    /// A shape names a link that is not there.
    #[error("shape {index}: link is {found}, expected 0 (the base) to {dof}")]
    Shape {
        /// Position among the shapes, from one.
        index: usize,
        /// What was found.
        found: usize,
        /// Number of links.
        dof: usize,
    },
}

/// A serial robot arm: kinematics, limits, drives, shapes. No inertia.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    name: String,
    gravity: Vector3<f64>,
    base: Placement,
    joints: Vec<Joint>,
    axes: Vec<Motion>,
    coupling: Option<DMatrix<f64>>,
    shapes: Vec<Shape>,
    obstacles: Vec<Obstacle>,
    may_touch: Vec<(usize, usize)>,
    effort: EffortInterface,
    servo: ServoTuning,
    source_sha256: String,
}

impl Robot {
    /// Checks a specification.
    ///
    /// # Errors
    /// [`RobotFault`] with what was found and what is possible.
    pub fn new(spec: RobotSpec) -> Result<Self, RobotFault> {
        let RobotSpec { name, gravity, base, joints, coupling, shapes, obstacles, may_touch } = spec;
        if joints.is_empty() {
            return Err(RobotFault::NoJoints { robot: name });
        }
        for (i, joint) in joints.iter().enumerate() {
            if joints[..i].iter().any(|other| other.name == joint.name) {
                return Err(RobotFault::DuplicateJoint { joint: joint.name.clone() });
            }
            check_joint(joint)?;
        }
        let n = joints.len();
        if let Some(c) = &coupling
            && (c.shape() != (n, n) || c.clone().try_inverse().is_none())
        {
            return Err(RobotFault::Coupling {
                found: format!("a {} × {} matrix", c.nrows(), c.ncols()),
                expected: format!("an invertible {n} × {n} matrix"),
            });
        }
        for (index, shape) in shapes.iter().enumerate() {
            if shape.link > n {
                return Err(RobotFault::Shape { index: index + 1, found: shape.link, dof: n });
            }
        }
        let axes = joints.iter().map(Joint::axis).collect();
        let (effort, servo) = (EffortInterface::default(), ServoTuning::default());
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
            effort,
            servo,
            source_sha256,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of joints n.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The joints from the base outwards; joint i moves link i.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Axis of each joint as a motion in its link's frame.
    #[must_use]
    pub fn axes(&self) -> &[Motion] {
        &self.axes
    }

    /// Gravity in the frame of the base, m/s².
    #[must_use]
    pub fn gravity(&self) -> Vector3<f64> {
        self.base.rotation.tr_mul(&self.gravity)
    }

    /// Pose of the base frame in the world.
    #[must_use]
    pub fn base(&self) -> &Placement {
        &self.base
    }

    /// Motor coordinates from joint coordinates, `q_motor = C q`, where motors are coupled.
    #[must_use]
    pub fn coupling(&self) -> Option<&DMatrix<f64>> {
        self.coupling.as_ref()
    }

    /// Whether motor `index` drives more than its own joint.
    #[must_use]
    pub fn is_coupled(&self, index: usize) -> bool {
        self.coupling.as_ref().is_some_and(|c| c.row(index).iter().enumerate().any(|(j, &x)| j != index && x != 0.0))
    }

    /// Shapes of the links.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// What stands around the robot.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Pairs of links (0 is the base, the lower first) whose shapes may touch.
    #[must_use]
    pub fn may_touch(&self) -> &[(usize, usize)] {
        &self.may_touch
    }

    /// Name of a link: that of the joint which moves it, or "base" for link 0.
    #[must_use]
    pub fn link_name(&self, link: usize) -> &str {
        if link == 0 { "base" } else { &self.joints[link - 1].name }
    }

    /// SHA-256 of the text that it was read from; empty for a robot that was made otherwise.
    ///
    /// It stays when limits are changed afterwards: it says which file is meant, and a certificate names it.
    #[must_use]
    pub fn source_sha256(&self) -> &str {
        &self.source_sha256
    }

    /// The same robot as read from this text.
    #[must_use]
    pub fn read_from(mut self, text: &str) -> Self {
        self.source_sha256 = sha256(text);
        self
    }

    /// The same robot with another obstacle in its way.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: Obstacle) -> Self {
        self.obstacles.push(obstacle);
        self
    }

    /// What its controller reports as effort.
    #[must_use]
    pub fn effort(&self) -> EffortInterface {
        self.effort
    }

    /// How its servo is tuned.
    #[must_use]
    pub fn servo(&self) -> &ServoTuning {
        &self.servo
    }

    /// The same robot with other drives, one for each joint.
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

    /// The same robot with another effort interface.
    #[must_use]
    pub fn with_effort(mut self, effort: EffortInterface) -> Self {
        self.effort = effort;
        self
    }

    /// The same robot with another tuning of its servo.
    #[must_use]
    pub fn with_servo(mut self, servo: ServoTuning) -> Self {
        self.servo = servo;
        self
    }

    /// The same robot with every joint changed, as for other limits or another friction law.
    ///
    /// # Errors
    /// [`RobotFault`] if a joint is no longer possible.
    pub fn with_joints(mut self, mut change: impl FnMut(&mut Joint)) -> Result<Self, RobotFault> {
        for joint in &mut self.joints {
            change(joint);
            check_joint(joint)?;
        }
        self.axes = self.joints.iter().map(Joint::axis).collect();
        Ok(self)
    }

    /// Pose of every link's frame in the base frame at joint coordinates `q` (n).
    #[must_use]
    pub fn poses(&self, q: &[f64]) -> Vec<Placement> {
        let mut pose = Placement::identity();
        self.joints
            .iter()
            .zip(q)
            .map(|(joint, &q)| {
                pose = pose.compose(&joint.placement(q));
                pose
            })
            .collect()
    }

    /// Index of the joint with this name.
    #[must_use]
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The same robot with another gravity in the world frame, m/s².
    #[must_use]
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.gravity = gravity;
        self
    }
}

fn check_joint(joint: &Joint) -> Result<(), RobotFault> {
    let fault = |quantity, found: String, expected| {
        Err(RobotFault::Joint { joint: joint.name.clone(), quantity, found, expected })
    };
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
        ("gear ratio", joint.drive.gear),
        ("torque constant", joint.drive.torque_constant),
        ("current limit", joint.drive.current_limit),
        ("continuous current", joint.drive.continuous_current),
        ("converter range", joint.drive.adc_range),
    ] {
        if value.is_nan() || value <= 0.0 {
            return fault(quantity, value.to_string(), "a number above zero");
        }
    }
    for (quantity, value) in [
        ("encoder counts", joint.drive.counts_per_revolution),
        ("current noise", joint.drive.current_noise),
        ("Coulomb velocity", joint.drive.coulomb_velocity),
    ] {
        if !(value.is_finite() && value >= 0.0) {
            return fault(quantity, value.to_string(), "a finite number not below zero");
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
    Ok(())
}
