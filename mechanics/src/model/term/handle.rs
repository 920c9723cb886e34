//! A term by reference: small, and comparable by what it is.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use super::entry::{Place, Structure, TermEntry};
use super::input::TermInput;
use super::law::TorqueTerm;
use super::list::Listed;
use super::number::Slope;
use crate::model::joint::JointKind;
use crate::model::robot::Robot;

/// A term of the model. Two are equal where their symbols are; they are ordered as the list is, those from outside last.
#[derive(Clone, Copy)]
pub struct Term {
    pub(super) law: &'static dyn TorqueTerm,
    pub(super) listed: Option<Listed>,
}

impl Term {
    /// A term that is not in the list.
    pub const fn new(law: &'static dyn TorqueTerm) -> Self {
        Self { law, listed: None }
    }

    /// Its law.
    pub const fn law(self) -> &'static dyn TorqueTerm {
        self.law
    }

    /// Everything but its law.
    pub fn entry(self) -> &'static TermEntry {
        self.law.entry()
    }

    /// Symbol of its coefficient.
    pub fn symbol(self) -> &'static str {
        self.entry().symbol
    }

    /// Unit of its coefficient on a joint of this kind.
    pub fn unit(self, kind: JointKind) -> &'static str {
        self.entry().unit.for_kind(kind)
    }

    /// Whether it is a part of the mass matrix.
    pub fn is_inertia(self) -> bool {
        self.entry().structure == Structure::Inertia
    }

    /// Whether joint or motor `index` of a robot has it.
    pub fn is_at(self, robot: &Robot, index: usize) -> bool {
        match self.entry().place {
            Place::Joint | Place::Motor => true,
            Place::CoupledMotor => robot.is_coupled(index),
        }
    }

    /// Whether it acts in the coordinates of motors.
    pub fn is_motors(self) -> bool {
        self.entry().place != Place::Joint
    }

    /// `g` of one entry.
    pub fn torque(self, x: &TermInput<f64>) -> f64 {
        let mut out = [0.0];
        self.law.torques(&x.block(), &mut out);
        out[0]
    }

    /// `∂g/∂(q, q̇, q̈, τ_t)` of one entry.
    pub fn slopes(self, x: &TermInput<f64>) -> [f64; Slope::COUNT] {
        let mut out = [[0.0; Slope::COUNT]];
        self.law.slopes(&x.block(), &mut out);
        out[0]
    }

    fn rank(self) -> (usize, &'static str) {
        (self.listed.map_or(usize::MAX, |listed| listed as usize), self.symbol())
    }
}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        self.rank() == other.rank()
    }
}

impl Eq for Term {}

impl PartialOrd for Term {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Term {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank().cmp(&other.rank())
    }
}

impl Hash for Term {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.symbol().hash(state);
    }
}

impl fmt::Debug for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}
