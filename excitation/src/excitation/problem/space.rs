//! Where a design is sought.

use std::sync::Arc;

use crate::trajectory::TrajectoryFamily;

/// The trajectories among which a design is sought: family, period, harmonics, and the joints that stand still. The problem
/// that takes it asks whether it is possible.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::DesignSpace;
/// use armid::trajectory::Family;
/// let mut space = DesignSpace::new(Family::CubicBSpline, 8.0, vec![5, 3]);
/// space.frozen[1] = Some(0.2);
/// ```
#[derive(Clone, Debug)]
pub struct DesignSpace {
    /// The family.
    pub family: Arc<dyn TrajectoryFamily>,
    /// Period T, s.
    pub period_s: f64,
    /// Number of harmonics H of each joint, n.
    pub harmonics: Vec<usize>,
    /// Where joints stand still, rad, n; `None` for those that move.
    pub frozen: Vec<Option<f64>>,
}

impl DesignSpace {
    /// The members of a family, of the list ([`Family`](crate::trajectory::Family)) or from outside, with this period (s)
    /// and with as many `harmonics` of each joint (n); splines have 2H + 1 knots. No joint stands still.
    pub fn new(family: impl Into<Arc<dyn TrajectoryFamily>>, period_s: f64, harmonics: Vec<usize>) -> Self {
        Self { family: family.into(), period_s, frozen: vec![None; harmonics.len()], harmonics }
    }

    /// The most harmonics that a joint has.
    pub fn highest_harmonic(&self) -> usize {
        self.harmonics.iter().copied().max().unwrap_or(0)
    }
}
