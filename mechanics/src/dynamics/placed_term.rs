//! One term in its place: what an engine needs that has equations of motion of its own.

use crate::model::ParameterId;
use crate::model::term::{Shapes, Slope, Term, TermInput};

/// One law of one joint or motor, with the direction in joint space in which it acts.
///
/// ```text
/// τ += φ d g(dᵀq, dᵀq̇)
/// ```
/// For terms that need the motion alone ([`Needs::MOTION`](crate::model::term::Needs)).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::{chains, dynamics::TorqueTerms, model::Columns};
/// let terms = TorqueTerms::new(&chains::planar_2r(), Columns::RIGID_ROTOR_FRICTION).placed();
/// // The elbow's viscous friction, 2 N·m·s/rad at 3 rad/s.
/// let mut tau = [0.0; 2];
/// terms[5].add_torque(2.0, &[0.0; 2], &[0.0, 3.0], &mut tau);
/// assert_eq!((terms[5].parameter.to_string().as_str(), tau), ("Fv2", [0.0, 6.0]));
/// ```
#[derive(Clone, Debug)]
pub struct PlacedTerm {
    /// The parameter `φ` that multiplies the law.
    pub parameter: ParameterId,
    /// The term.
    pub term: Term,
    pub(super) shape: Shapes,
    /// The entries `(joint, d)` of its direction that are not zero: one, unless motors are coupled.
    pub direction: Vec<(usize, f64)>,
}

impl PlacedTerm {
    /// The joint quantity `x` (n) in the coordinate of the term: `dᵀ x`.
    pub fn project(&self, x: &[f64]) -> f64 {
        self.direction.iter().fold(0.0, |sum, &(joint, d)| sum + d * x[joint])
    }

    /// The law's slopes `∂g/∂(q, q̇, q̈, τ_t)` at position `q` and velocity `qd` of its own coordinate, at rest otherwise.
    pub fn slopes(&self, q: f64, qd: f64) -> [f64; Slope::COUNT] {
        self.term.slopes(&self.input(q, qd))
    }

    /// Adds the torque of `value` units of the parameter at the joint positions `q` and velocities `qd`, without
    /// acceleration; n each.
    pub fn add_torque(&self, value: f64, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        let g = value * self.term.torque(&self.input(self.project(q), self.project(qd)));
        for &(joint, d) in &self.direction {
            tau[joint] += d * g;
        }
    }

    fn input(&self, q: f64, qd: f64) -> TermInput<f64> {
        TermInput { q, qd, qdd: 0.0, load: 0.0, warmth: 0.0, shape: self.shape }
    }
}
