//! One joint: what it moves along, where it stands, and how far, how fast and how hard it may go.

use super::drive::Drive;
use crate::spatial::{Motion, Placement};
use nalgebra::Vector3;

/// What a joint does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// Turns about its axis; coordinate in rad, effort in N·m. `radkhah2007`: σ = 1.
    Revolute,
    /// Slides along its axis; coordinate in m, effort in N. `radkhah2007`: σ = 0.
    Prismatic,
}

impl JointKind {
    /// Unit of the coordinate.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// Unit of the effort.
    pub const fn effort_unit(self) -> &'static str {
        match self {
            Self::Revolute => "N·m",
            Self::Prismatic => "N",
        }
    }
}

/// Which Denavit–Hartenberg convention a row is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DhConvention {
    /// Distal: `T = Rz(θ) Tz(d) Tx(a) Rx(α)`; link i's frame stands at its far end.
    Standard,
    /// Proximal (Khalil–Kleinfinger, Craig): `T = Rx(α) Tx(a) Rz(θ) Tz(d)`; link i's frame stands on its own joint.
    Modified,
}

/// One row of a Denavit–Hartenberg table, with the joint's own coordinate at zero.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DhRow {
    /// Offset added to the coordinate of a revolute joint (the whole angle of a prismatic one), degrees.
    pub offset_deg: f64,
    /// Offset along z, m; added to the coordinate of a prismatic joint.
    pub d: f64,
    /// Length along x, m.
    pub a: f64,
    /// Twist about x, degrees.
    pub alpha_deg: f64,
}

impl DhRow {
    /// The constant placements before and after the joint.
    pub fn placements(&self, convention: DhConvention) -> (Placement, Placement) {
        let (s_theta, c_theta) = exact_sincos(self.offset_deg);
        let (s_alpha, c_alpha) = exact_sincos(self.alpha_deg);
        let rz = Placement::rotation_z(s_theta, c_theta);
        let tz = Placement::translation(0.0, 0.0, self.d);
        let tx = Placement::translation(self.a, 0.0, 0.0);
        let rx = Placement::rotation_x(s_alpha, c_alpha);
        match convention {
            // Rz(q) and Tz(q) commute with Rz(θ) and Tz(d), so the offset angle may stand before either kind.
            DhConvention::Standard => (rz, tz.compose(&tx).compose(&rx)),
            DhConvention::Modified => (rx.compose(&tx).compose(&rz).compose(&tz), Placement::identity()),
        }
    }
}

/// How far, how fast and how hard a joint may go. A limit that is not stated is infinite.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Smallest and largest coordinate, rad or m.
    #[serde(deserialize_with = "crate::plain::infinite::range")]
    pub position: (f64, f64),
    /// Largest speed, rad/s or m/s.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub velocity: f64,
    /// Largest acceleration, rad/s² or m/s².
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub acceleration: f64,
    /// Largest jerk, rad/s³ or m/s³.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub jerk: f64,
    /// Largest effort at the joint, N·m or N.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub torque: f64,
    /// Largest root mean square of the effort over a period, N·m or N: what the drive can give for ever. Infinite
    /// where it is not stated: the peak then bounds the mean square as well.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub continuous_torque: f64,
}

impl Limits {
    /// No limit at all.
    pub const NONE: Self = Self {
        position: (f64::NEG_INFINITY, f64::INFINITY),
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        torque: f64::INFINITY,
        continuous_torque: f64::INFINITY,
    };
}

/// One joint and the link that it moves: `T(q) = before · J(q) · after`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Its name, unique in the robot.
    pub name: String,
    /// What it does.
    pub kind: JointKind,
    /// From the previous link's frame to the joint's axis, at coordinate zero.
    pub before: Placement,
    /// From the joint's axis to this link's frame.
    pub after: Placement,
    /// The row these came from, where the robot is given by a DH table; formulas use its lengths.
    pub dh: Option<(DhConvention, DhRow)>,
    /// How far, how fast and how hard it may go.
    pub limits: Limits,
    /// Its drive.
    pub drive: Drive,
}

impl Joint {
    /// The joint of a row of Denavit–Hartenberg parameters.
    pub fn from_dh(name: String, kind: JointKind, dh: (DhConvention, DhRow), limits: Limits, drive: Drive) -> Self {
        let (before, after) = dh.1.placements(dh.0);
        Self { name, kind, before, after, dh: Some(dh), limits, drive }
    }

    /// The pose of this link's frame in the previous one at coordinate `q` (rad or m).
    #[inline]
    pub fn placement(&self, q: f64) -> Placement {
        let moved = match self.kind {
            JointKind::Revolute => {
                let (s, c) = libm::sincos(q);
                let b = &self.before.rotation;
                // before · Rz(q), written out: the third column stays.
                let (x, y) = (b.column(0), b.column(1));
                let rotation =
                    nalgebra::Matrix3::from_columns(&[(x * c + y * s), (y * c - x * s), b.column(2).into_owned()]);
                Placement::new(rotation, self.before.translation)
            }
            JointKind::Prismatic => {
                Placement::new(self.before.rotation, self.before.translation + self.before.rotation.column(2) * q)
            }
        };
        moved.compose(&self.after)
    }

    /// The joint's axis as a motion in this link's frame: constant, since joint and frame move together.
    pub fn axis(&self) -> Motion {
        let z = Vector3::z();
        let at_joint = match self.kind {
            JointKind::Revolute => Motion::new(z, Vector3::zeros()),
            JointKind::Prismatic => Motion::new(Vector3::zeros(), z),
        };
        self.after.motion_to_child(&at_joint)
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90: a DH table's right angles stay right, so that
/// columns that vanish by geometry vanish to the last bit.
pub fn exact_sincos(degrees: f64) -> (f64, f64) {
    let quarter = degrees / 90.0;
    if quarter.fract() == 0.0 && quarter.abs() < 1e9 {
        match quarter.rem_euclid(4.0) as u8 {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        }
    } else {
        libm::sincos(degrees.to_radians())
    }
}
