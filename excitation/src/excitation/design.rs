//! A designed trajectory, and the best of several.

use serde::{Deserialize, Serialize};

use super::certificate::Certificate;
use super::termination::{HistoryPoint, Termination};
use crate::provenance::sha256;
use crate::trajectory::PeriodicTrajectory;

/// A designed trajectory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct Design {
    /// The trajectory.
    pub trajectory: PeriodicTrajectory,
    /// Name of the criterion that was optimised.
    pub criterion: String,
    /// Its value as it is reported, on the optimiser's samples.
    #[serde(deserialize_with = "crate::plain::infinite::undecided")]
    pub value: f64,
    /// Whether a larger value is better.
    pub larger_is_better: bool,
    /// What the trajectory is worth and that it is safe.
    pub certificate: Certificate,
    /// How the optimisation ended.
    pub termination: Termination,
    /// Steps of the optimiser, or draws.
    pub iterations: usize,
    /// Evaluations spent: a value is one, a gradient one more.
    pub evaluations: usize,
    /// How the value developed.
    pub history: Vec<HistoryPoint>,
    /// Where it started.
    pub start: PeriodicTrajectory,
}

// Refuses a certificate that is not of its trajectory, or was changed.
crate::plain::checked_when_read!(Design, |mut value| {
    value.put_infinities();
    value.check().map(|()| value)
});

impl Design {
    /// Where JSON has no number, the value was the worst: the criterion says whether that is +∞ or −∞.
    fn put_infinities(&mut self) {
        let worst = if self.larger_is_better { f64::NEG_INFINITY } else { f64::INFINITY };
        let points = self.history.iter_mut().flat_map(|point| [&mut point.value, &mut point.current]);
        for value in points.chain([&mut self.value]).filter(|value| value.is_nan()) {
            *value = worst;
        }
    }

    fn check(&self) -> Result<(), String> {
        let (found, expected) = (self.start.names(), self.trajectory.names());
        if found != expected {
            return Err(format!("the start moves the joints {found:?}, expected {expected:?} as the trajectory"));
        }
        if self.certificate.trajectory_sha256 != sha256(&self.trajectory.to_toml()) {
            return Err("the certificate is that of another trajectory, expected that of the design".to_owned());
        }
        if !self.certificate.is_unchanged() {
            return Err("the certificate was changed, expected the figures that its checksum states".to_owned());
        }
        Ok(())
    }

    /// The value, so turned that smaller is better.
    pub fn cost(&self) -> f64 {
        if self.larger_is_better { -self.value } else { self.value }
    }
}

/// The best of a set of designs by their own criterion, among those that hold all limits; the first of equals.
pub fn best_of(designs: &[Design]) -> Option<&Design> {
    designs.iter().filter(|design| design.termination.is_feasible()).min_by(|x, y| x.cost().total_cmp(&y.cost()))
}

/// Where no design holds all limits, the one that exceeds them least, relative; the first of equals.
pub fn nearest_of(designs: &[Design]) -> Option<&Design> {
    let excess = |design: &Design| match &design.termination {
        Termination::Infeasible { worst, .. } => worst.ratio,
        Termination::Singular => f64::INFINITY,
        _ => 0.0,
    };
    designs.iter().min_by(|x, y| excess(x).total_cmp(&excess(y)))
}
