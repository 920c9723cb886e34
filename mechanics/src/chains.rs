//! Robots made for tests: random serial chains with physically consistent parameters, a planar arm for closed forms, and the
//! CRS A460.
//!
//! A random chain mixes revolute and prismatic joints and standard and modified DH rows; right angles and vanishing
//! lengths are frequent, as on real arms, so that degenerate geometry is met. Each link is a sum of point masses, so
//! its ten parameters are physically consistent.

use crate::model::term::{COULOMB, MOTOR_COULOMB, MOTOR_VISCOUS, OFFSET, ROTOR, VISCOUS};
use nalgebra::{DMatrix, Vector3};
use rand::{Rng, RngExt};

use crate::model::format::{parse_nominal, parse_robot};
use crate::model::{
    DhConvention, DhRow, Drive, DriveParameters, Joint, JointKind, Limits, Robot, RobotSpec, StandardParameters,
    bundled,
};
use crate::spatial::{Inertia, Placement};

/// Which chains to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainRecipe {
    /// Number of joints.
    pub dof: usize,
    /// Probability that a joint is prismatic.
    pub prismatic: f64,
    /// The convention of every row; `None` draws one per joint.
    pub convention: Option<DhConvention>,
    /// Whether the last two motors are coupled.
    pub coupled: bool,
    /// Whether the base is tilted by a random rotation.
    pub tilted: bool,
}

impl ChainRecipe {
    /// Mixed conventions, one joint in four prismatic, upright, not coupled.
    pub const fn new(dof: usize) -> Self {
        Self { dof, prismatic: 0.25, convention: None, coupled: false, tilted: false }
    }

    /// Draws a robot and a physically consistent set of parameters.
    ///
    /// # Panics
    /// If `dof` is zero.
    pub fn draw(&self, rng: &mut impl Rng) -> (Robot, StandardParameters) {
        let joints: Vec<Joint> = (0..self.dof).map(|i| self.joint(i, rng)).collect();
        let coupling = (self.coupled && self.dof > 1).then(|| {
            let mut c = DMatrix::identity(self.dof, self.dof);
            c[(self.dof - 1, self.dof - 2)] = rng.random_range(-1.0..1.0);
            c
        });
        let base = if self.tilted {
            let (s, c) = libm::sincos(rng.random_range(-3.0..3.0));
            let (t, d) = libm::sincos(rng.random_range(-3.0..3.0));
            Placement::rotation_x(s, c).compose(&Placement::rotation_y(t, d))
        } else {
            Placement::identity()
        };
        let robot = Robot::new(RobotSpec {
            name: format!("random-{}", self.dof),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            base,
            joints,
            coupling,
            ..RobotSpec::default()
        })
        .expect("a drawn chain is valid by construction");
        let mut parameters = StandardParameters::zero(self.dof);
        for (index, (link, drive)) in parameters.links.iter_mut().zip(&mut parameters.drives).enumerate() {
            *link = random_inertia(rng);
            *drive = random_drive(rng, robot.is_coupled(index));
        }
        (robot, parameters)
    }

    fn joint(&self, index: usize, rng: &mut impl Rng) -> Joint {
        let kind = if rng.random_range(0.0..1.0) < self.prismatic { JointKind::Prismatic } else { JointKind::Revolute };
        let convention = self.convention.unwrap_or_else(|| {
            if rng.random_range(0.0..1.0) < 0.5 { DhConvention::Standard } else { DhConvention::Modified }
        });
        let mut angle = || match rng.random_range(0..5) {
            0 => 0.0,
            1 => 90.0,
            2 => -90.0,
            3 => 180.0,
            _ => rng.random_range(-180.0..180.0),
        };
        let (offset_deg, alpha_deg) = (angle(), angle());
        let mut length = || if rng.random_range(0.0..1.0) < 0.4 { 0.0 } else { rng.random_range(-0.5..0.5) };
        let row = DhRow { offset_deg, d: length(), a: length(), alpha_deg };
        let limits = Limits {
            position: (-2.5, 2.5),
            velocity: rng.random_range(1.0..3.0),
            acceleration: rng.random_range(5.0..20.0),
            ..Limits::NONE
        };
        let drive = Drive { coulomb_velocity: rng.random_range(0.02..0.2), ..Drive::ideal() };
        Joint::from_dh(format!("joint{}", index + 1), kind, (convention, row), limits, drive)
    }
}

/// A random robot of `dof` joints with a physically consistent set of parameters, by [`ChainRecipe::new`].
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::{chains, seed::Seed};
/// let (robot, parameters) = chains::random_robot(&mut Seed::new(1).stream("chains", 0), 6);
/// assert_eq!(robot.dof(), 6);
/// assert!(parameters.links.iter().all(|link| link.check().is_ok()));
/// ```
///
/// # Panics
/// If `dof` is zero.
pub fn random_robot(rng: &mut impl Rng, dof: usize) -> (Robot, StandardParameters) {
    ChainRecipe::new(dof).draw(rng)
}

/// A random point of the state space: positions within ±2.5 rad, velocities within ±2 rad/s, accelerations within
/// ±10 rad/s², as `(q, qd, qdd)` of length n each.
pub fn random_state(rng: &mut impl Rng, dof: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut draw = |bound: f64| (0..dof).map(|_| rng.random_range(-bound..bound)).collect();
    (draw(2.5), draw(2.0), draw(10.0))
}

/// The inertia of eight random point masses about a random centre: 1 kg to 8 kg within a few decimetres.
pub fn random_inertia(rng: &mut impl Rng) -> Inertia {
    let mut point = |scale: f64| Vector3::from_fn(|_, _| rng.random_range(-scale..scale));
    let centre = point(0.2);
    let points: Vec<Vector3<f64>> = (0..8).map(|_| centre + point(0.15)).collect();
    let mut whole = Inertia::zero();
    for x in points {
        whole += Inertia::from_com(rng.random_range(0.1..1.0), x, nalgebra::Matrix3::zeros());
    }
    whole
}

fn random_drive(rng: &mut impl Rng, coupled: bool) -> DriveParameters {
    let mut draw = |low: f64, high: f64| rng.random_range(low..high);
    let mut drive = DriveParameters::from_iter([
        (ROTOR, draw(0.05, 0.5)),
        (VISCOUS, draw(0.1, 5.0)),
        (COULOMB, draw(0.1, 5.0)),
        (OFFSET, draw(-1.0, 1.0)),
    ]);
    if coupled {
        drive[MOTOR_VISCOUS] = draw(0.1, 2.0);
        drive[MOTOR_COULOMB] = draw(0.1, 2.0);
    }
    drive
}

/// Two revolute joints with parallel horizontal axes: a vertical plane, links of 0.4 m and 0.3 m, standard DH.
///
/// The base frame is turned so that gravity, 9.81 m/s², points along −y of the plane in which the arm moves.
///
/// # Panics
/// Never: the robot is valid by construction.
pub fn planar_2r() -> Robot {
    let joint = |name: &str, a: f64| {
        let dh = (DhConvention::Standard, DhRow { offset_deg: 0.0, d: 0.0, a, alpha_deg: 0.0 });
        let limits = Limits { position: (-3.0, 3.0), velocity: 3.0, acceleration: 20.0, torque: 50.0, ..Limits::NONE };
        let drive = Drive { coulomb_velocity: 0.05, ..Drive::ideal() };
        Joint::from_dh(name.to_owned(), JointKind::Revolute, dh, limits, drive)
    };
    Robot::new(RobotSpec {
        name: "planar-2r".to_owned(),
        gravity: Vector3::new(0.0, 0.0, -9.81),
        base: Placement::rotation_x(1.0, 0.0),
        joints: vec![joint("shoulder", 0.4), joint("elbow", 0.3)],
        ..RobotSpec::default()
    })
    .expect("two distinct joints with positive limits")
}

/// The CRS A460 with 12.566 rad/s² on every joint, the limits of the published comparisons.
///
/// # Panics
/// Never: the robot is bundled.
pub fn crs_a460() -> Robot {
    let robot = parse_robot(bundled()[0].robot).expect("a bundled robot");
    robot.with_joints(|joint| joint.limits.acceleration = 12.566).expect("a positive limit")
}

/// What an experimenter would guess of the parameters of [`crs_a460`].
///
/// # Panics
/// Never: the parameters are bundled.
pub fn crs_a460_nominal() -> StandardParameters {
    parse_nominal(bundled()[0].nominal, &crs_a460()).expect("bundled parameters").parameters
}
