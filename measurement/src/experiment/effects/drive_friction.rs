//! The torque terms that one joint's or motor's drive carries, for where the plant does not hold them.
//!
//! A term that depends on the transmitted torque or on temperature is held over a part of a servo step, at what the links
//! took over the part before. Where a spring stands between motor and link, all terms of the drive move with the motor.
//! Where Coulomb friction follows displacement it is no term of the drive any more.

use super::presliding::Presliding;
use super::warming::Warming;
use crate::model::term::{COULOMB, Carrier, MOTOR_COULOMB, Shapes, Slope, Term, TermInput};
use crate::model::{DriveParameters, Joint};

/// The terms of one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DriveFriction {
    laws: Vec<(Term, f64, Shapes)>,
    warming: Warming,
    presliding: Option<Presliding>,
}

/// Whether a term's place is taken by friction that follows displacement, where an arm has that.
pub(super) fn is_displaced(term: Term) -> bool {
    term == COULOMB || term == MOTOR_COULOMB
}

impl DriveFriction {
    /// Those of a drive that act on its joint, or at its motor where `at_motor`. Coulomb friction slides after `distance` rad
    /// (m), or by its term where that is 0.
    pub(super) fn new(joint: &Joint, drive: &DriveParameters, at_motor: bool, warming: Warming, distance: f64) -> Self {
        let carried = |term: Term| {
            let is_term = distance == 0.0 || !is_displaced(term);
            is_term && !term.is_inertia() && term.entry().carrier == Carrier::Drive
        };
        let coulomb = drive[if at_motor { MOTOR_COULOMB } else { COULOMB }];
        let laws = drive.iter().filter(|&(term, _)| carried(term) && term.is_motors() == at_motor);
        Self {
            laws: laws.map(|(term, value)| (term, value, joint.drive.shapes_of(term))).collect(),
            warming,
            presliding: (distance > 0.0 && coulomb > 0.0).then(|| Presliding::new(coulomb, distance)),
        }
    }

    /// Comes to rest at `q`.
    pub(super) fn rest_at(&mut self, q: f64) {
        if let Some(presliding) = &mut self.presliding {
            presliding.rest_at(q);
        }
    }

    /// Moves to `q`; returns the friction that follows displacement, N·m.
    pub(super) fn slide(&mut self, q: f64) -> f64 {
        self.presliding.as_mut().map_or(0.0, |presliding| presliding.slide(q))
    }

    /// Stiffness about rest of friction that follows displacement, N·m/rad.
    pub(super) fn stiffness(&self) -> f64 {
        self.presliding.as_ref().map_or(0.0, Presliding::stiffness)
    }

    /// What the plant cannot hold, at position `q` and speed `v` under a transmitted torque, N·m.
    pub(super) fn held(&self, q: f64, v: f64, load: f64) -> f64 {
        self.sum(q, v, load, |term| !term.entry().needs.is_motion())
    }

    /// All of it, N·m.
    pub(super) fn whole(&self, q: f64, v: f64, load: f64) -> f64 {
        self.sum(q, v, load, |_| true)
    }

    /// Slope at standstill, the steepest, of what the plant cannot hold, N·m·s/rad, under a load of at most `load`.
    pub(super) fn held_slope(&self, load: f64) -> f64 {
        self.slopes(load, |term| !term.entry().needs.is_motion())
    }

    /// Slope at standstill of all of it.
    pub(super) fn slope(&self, load: f64) -> f64 {
        self.slopes(load, |_| true)
    }

    /// Warms up at speed `v` for `dt` s.
    pub(super) fn turn(&mut self, v: f64, dt: f64) {
        self.warming.turn(v, dt);
    }

    fn sum(&self, q: f64, v: f64, load: f64, which: impl Fn(Term) -> bool) -> f64 {
        let laws = self.laws.iter().filter(|&&(term, ..)| which(term));
        laws.fold(0.0, |sum, &(term, value, shape)| sum + value * term.torque(&self.input(q, v, load, shape)))
    }

    fn slopes(&self, load: f64, which: impl Fn(Term) -> bool) -> f64 {
        const BY_VELOCITY: usize = 1;
        let slope = |&(term, value, shape): &(Term, f64, Shapes)| {
            let by: [f64; Slope::COUNT] = term.slopes(&self.input(0.0, 0.0, load, shape));
            (value * by[BY_VELOCITY]).max(0.0)
        };
        self.laws.iter().filter(|&&(term, ..)| which(term)).map(slope).sum()
    }

    fn input(&self, q: f64, qd: f64, load: f64, shape: Shapes) -> TermInput<f64> {
        TermInput { q, qd, qdd: 0.0, load, warmth: self.warming.warmth(), shape }
    }
}
