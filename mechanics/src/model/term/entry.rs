//! The properties of a term beside its law.

use crate::model::joint::JointKind;

/// In which coordinate a term acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Of every joint.
    Joint,
    /// Of every motor, `q_motor = C q`; the joint's own where motors are not coupled.
    Motor,
    /// Of those motors alone that drive several joints.
    CoupledMotor,
}

/// On which side of a transmission that gives a term acts: an elastic drive carries the motor's with the rotor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// With the motor and its gear, before the spring.
    Drive,
    /// With the link, behind the spring.
    Link,
}

/// Which signs the coefficient of a real arm can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Zero or above.
    NotNegative,
    /// Any.
    Any,
}

/// Whether a term with a coefficient of an allowed sign can give energy to the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dissipation {
    /// Never: `φ g v ≥ 0`.
    Always,
    /// Never beside another term of the same coordinate whose coefficient is at least as large: `g_other v ± g v ≥ 0`.
    Beside(&'static str),
    /// It stores energy and gives it back; [`TermLaw::energy`](super::TermLaw::energy) says how much.
    Stores,
    /// It may: the text says why.
    No(&'static str),
}

/// Dimension of a law `g`: effort^`effort` · coordinate^`coordinate` · s^−`per_time`. That of its coefficient is an effort
/// divided by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Power of N·m (N).
    pub effort: i32,
    /// Power of rad (m).
    pub coordinate: i32,
    /// Power of 1/s.
    pub per_time: i32,
}

/// One text or number for a revolute and a prismatic joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByJoint {
    /// For a revolute joint.
    pub revolute: &'static str,
    /// For a prismatic joint.
    pub prismatic: &'static str,
}

impl ByJoint {
    /// The entry for a joint of this kind.
    pub const fn for_kind(self, kind: JointKind) -> &'static str {
        match kind {
            JointKind::Revolute => self.revolute,
            JointKind::Prismatic => self.prismatic,
        }
    }

    /// Whether a text is one of the two.
    pub fn is(self, text: &str) -> bool {
        self.revolute == text || self.prismatic == text
    }
}

/// How the structural reduction sees a term's law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// `g = a`: a constant of the mass matrix, beside what the links add to it.
    Inertia,
    /// `g = 1`: a constant effort, beside gravity's.
    Constant,
    /// `g = v`, linear in velocity: terms with this law add up as matrices.
    Viscous,
    /// A function of its own of the coordinate, of nothing that the links contribute: terms of one `family` with equal
    /// shape parameters and parallel directions add up, others are independent.
    Function {
        /// Name of the function.
        family: &'static str,
        /// `g(−x) = −g(x)`; otherwise `g(−x) = g(x)`.
        odd: bool,
    },
}

/// Prior uncertainty of a coefficient: the standard deviation that `nominal.toml` states in its
/// table `relative_uncertainty`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Key in that table; terms of a joint and of its motor share one.
    pub key: &'static str,
    /// Whether it is a share of the nominal value, or an amount in the coefficient's unit.
    pub of: PriorOf,
    /// What holds where the file does not state it; `None` where it must.
    pub default: Option<f64>,
}

/// What the standard deviation of a prior is a multiple of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PriorOf {
    /// The nominal value.
    Value,
    /// The coefficient's unit.
    Unit,
}

/// What a law needs beside the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The torque that the links take.
    pub load: bool,
    /// The temperature of the gear.
    pub warmth: bool,
    /// The change of the whole torque with time.
    pub rate: bool,
}

impl Needs {
    /// The motion alone.
    pub const MOTION: Self = Self { load: false, warmth: false, rate: false };

    /// Whether motion and torque are enough to estimate the coefficient: the torque of the links is estimated beside it.
    pub const fn is_estimable(self) -> bool {
        !self.warmth && !self.rate
    }

    /// Whether the motion alone is enough.
    pub const fn is_motion(self) -> bool {
        !self.load && !self.warmth && !self.rate
    }
}

/// A number that a law depends on in another way than in proportion. It stands in the robot file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeParameter {
    /// Its key in the table `shape` of a joint's drive in `robot.toml`.
    pub key: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its value where the robot file does not state it.
    pub default: f64,
    /// Whether it is a velocity in which the law turns over: its plain law (at 0) jumps, and no engine simulates a jump.
    pub smooths: bool,
}

impl ShapeParameter {
    /// Velocity scale of the smooth sign of Coulomb friction; `drive.coulomb_velocity` of the robot file.
    pub const COULOMB_VELOCITY: Self = Self {
        key: "coulomb_velocity_rad_s",
        meaning: "velocity scale of the smooth sign, rad/s (m/s)",
        default: 0.0,
        smooths: true,
    };
}

/// Everything but the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermEntry {
    /// Symbol of the coefficient, without the number of the joint.
    pub symbol: &'static str,
    /// Its word in `--columns`; terms of a joint and of its motor share one.
    pub name: &'static str,
    /// What it is, as a phrase for reports.
    pub meaning: &'static str,
    /// What its coefficients are called together, in tables and figures.
    pub group: &'static str,
    /// Where it acts.
    pub place: Place,
    /// With what it moves.
    pub carrier: Carrier,
    /// Dimension of the law.
    pub dimension: Dimension,
    /// Unit of the coefficient.
    pub unit: ByJoint,
    /// Key of the coefficient in the table `drive` of `truth.toml` and `nominal.toml`.
    pub key: ByJoint,
    /// Its sign.
    pub sign: Sign,
    /// Whether it dissipates.
    pub dissipation: Dissipation,
    /// How the structural reduction sees it.
    pub structure: Structure,
    /// How well it is known before measuring.
    pub prior: Prior,
    /// What it needs beside the motion.
    pub needs: Needs,
    /// Its shape parameters, at most [`MOST_SHAPES`](super::MOST_SHAPES).
    pub shapes: &'static [ShapeParameter],
}
