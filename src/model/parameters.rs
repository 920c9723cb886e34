//! The names, the order and the values of a robot's dynamic parameters φ.
//!
//! First the ten of each link in turn, then the drive parameters of each joint in turn:
//!
//! ```text
//! φ = (m1, mcx1, mcy1, mcz1, Ixx1, Ixy1, Ixz1, Iyy1, Iyz1, Izz1, m2, …, Izz_n, Ia1, Fv1, Fc1, Fo1, Ia2, …)
//! ```
//! A robot whose motors are coupled has two more columns for each coupled motor, `Fvm` and `Fcm`: friction of the
//! motor itself, which acts on every joint that the motor drives.

use std::fmt;

use super::Robot;
use crate::spatial::Inertia;

/// Which quantity a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names are the notation of NOTATION.md")]
pub enum ParameterKind {
    M,
    Mcx,
    Mcy,
    Mcz,
    Ixx,
    Ixy,
    Ixz,
    Iyy,
    Iyz,
    Izz,
    /// Rotor inertia at the joint, `J_m N²`, kg·m².
    Ia,
    /// Viscous friction, N·m·s/rad.
    Fv,
    /// Coulomb friction, N·m.
    Fc,
    /// Torque offset, N·m.
    Fo,
    /// Viscous friction of a coupled motor, N·m·s/rad.
    Fvm,
    /// Coulomb friction of a coupled motor, N·m.
    Fcm,
}

impl ParameterKind {
    /// The ten of a link, in order.
    pub const LINK: [Self; 10] =
        [Self::M, Self::Mcx, Self::Mcy, Self::Mcz, Self::Ixx, Self::Ixy, Self::Ixz, Self::Iyy, Self::Iyz, Self::Izz];

    /// The symbol, without the number.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Mcx => "mcx",
            Self::Mcy => "mcy",
            Self::Mcz => "mcz",
            Self::Ixx => "Ixx",
            Self::Ixy => "Ixy",
            Self::Ixz => "Ixz",
            Self::Iyy => "Iyy",
            Self::Iyz => "Iyz",
            Self::Izz => "Izz",
            Self::Ia => "Ia",
            Self::Fv => "Fv",
            Self::Fc => "Fc",
            Self::Fo => "Fo",
            Self::Fvm => "Fvm",
            Self::Fcm => "Fcm",
        }
    }

    /// Unit on a revolute joint.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::M => "kg",
            Self::Mcx | Self::Mcy | Self::Mcz => "kg·m",
            Self::Ixx | Self::Ixy | Self::Ixz | Self::Iyy | Self::Iyz | Self::Izz | Self::Ia => "kg·m²",
            Self::Fv | Self::Fvm => "N·m·s/rad",
            Self::Fc | Self::Fo | Self::Fcm => "N·m",
        }
    }
}

/// One parameter: which quantity, of which link or joint. Prints as `mcx2`, `Iyy1`, `Fc4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ParameterId {
    /// Which quantity.
    pub kind: ParameterKind,
    /// Index of the link or joint, from zero; names count from one.
    pub index: usize,
}

impl fmt::Display for ParameterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.kind.symbol(), self.index + 1)
    }
}

/// Which columns a model has: rigid bodies alone, with rotors, or with rotors and friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Columns {
    /// The ten parameters of each link.
    Rigid,
    /// And the rotor inertia of each drive.
    RigidRotor,
    /// And viscous friction, Coulomb friction and offset of each joint.
    #[default]
    RigidRotorFriction,
}

impl Columns {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Rigid, Self::RigidRotor, Self::RigidRotorFriction];

    /// Its name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::RigidRotor => "rigid+rotor",
            Self::RigidRotorFriction => "rigid+rotor+friction",
        }
    }

    /// The choice with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|columns| columns.name() == name)
    }

    /// The drive quantities of one joint; a coupled motor has two more.
    fn drive_kinds(self, coupled: bool) -> &'static [ParameterKind] {
        use ParameterKind::{Fc, Fcm, Fo, Fv, Fvm, Ia};
        match (self, coupled) {
            (Self::Rigid, _) => &[],
            (Self::RigidRotor, _) => &[Ia],
            (Self::RigidRotorFriction, false) => &[Ia, Fv, Fc, Fo],
            (Self::RigidRotorFriction, true) => &[Ia, Fv, Fc, Fo, Fvm, Fcm],
        }
    }

    /// The parameters of a robot in order: length p, the columns of its regressor.
    #[must_use]
    pub fn parameters(self, robot: &Robot) -> Vec<ParameterId> {
        let links = (0..robot.dof()).flat_map(|index| ParameterKind::LINK.map(|kind| ParameterId { kind, index }));
        let drives = (0..robot.dof()).flat_map(|index| {
            self.drive_kinds(robot.is_coupled(index)).iter().map(move |&kind| ParameterId { kind, index })
        });
        links.chain(drives).collect()
    }
}

/// What the drive of one joint adds to the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveParameters {
    /// Rotor inertia at the joint, kg·m².
    pub rotor: f64,
    /// Viscous friction, N·m·s/rad.
    pub viscous: f64,
    /// Coulomb friction, N·m.
    pub coulomb: f64,
    /// Torque offset, N·m.
    pub offset: f64,
    /// Viscous friction of a coupled motor, N·m·s/rad.
    pub motor_viscous: f64,
    /// Coulomb friction of a coupled motor, N·m.
    pub motor_coulomb: f64,
}

/// A full set of values for the parameters of a robot: a guess, an estimate or the truth of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardParameters {
    /// Inertia of each link in its own frame.
    pub links: Vec<Inertia>,
    /// Drive of each joint.
    pub drives: Vec<DriveParameters>,
}

impl StandardParameters {
    /// All zero, for a robot of `dof` joints.
    #[must_use]
    pub fn zero(dof: usize) -> Self {
        Self { links: vec![Inertia::zero(); dof], drives: vec![DriveParameters::default(); dof] }
    }

    /// The value of one parameter.
    #[must_use]
    pub fn get(&self, id: ParameterId) -> f64 {
        let drive = &self.drives[id.index];
        match id.kind {
            ParameterKind::Ia => drive.rotor,
            ParameterKind::Fv => drive.viscous,
            ParameterKind::Fc => drive.coulomb,
            ParameterKind::Fo => drive.offset,
            ParameterKind::Fvm => drive.motor_viscous,
            ParameterKind::Fcm => drive.motor_coulomb,
            link => self.links[id.index].to_array()[link as usize],
        }
    }

    /// Sets one parameter.
    pub fn set(&mut self, id: ParameterId, value: f64) {
        let drive = &mut self.drives[id.index];
        match id.kind {
            ParameterKind::Ia => drive.rotor = value,
            ParameterKind::Fv => drive.viscous = value,
            ParameterKind::Fc => drive.coulomb = value,
            ParameterKind::Fo => drive.offset = value,
            ParameterKind::Fvm => drive.motor_viscous = value,
            ParameterKind::Fcm => drive.motor_coulomb = value,
            link => {
                let mut ten = self.links[id.index].to_array();
                ten[link as usize] = value;
                self.links[id.index] = Inertia::from_array(&ten);
            }
        }
    }

    /// The vector φ for these columns of a robot, length p.
    #[must_use]
    pub fn vector(&self, robot: &Robot, columns: Columns) -> nalgebra::DVector<f64> {
        nalgebra::DVector::from_iterator(
            columns.parameters(robot).len(),
            columns.parameters(robot).into_iter().map(|id| self.get(id)),
        )
    }

    /// From a vector φ for these columns of a robot; parameters that it does not hold are zero.
    ///
    /// # Panics
    /// If the vector's length is not the number of columns.
    #[must_use]
    pub fn from_vector(robot: &Robot, columns: Columns, phi: &[f64]) -> Self {
        let ids = columns.parameters(robot);
        assert_eq!(ids.len(), phi.len(), "one value per column");
        let mut set = Self::zero(robot.dof());
        for (id, &value) in ids.into_iter().zip(phi) {
            set.set(id, value);
        }
        set
    }
}
