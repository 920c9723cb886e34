//! Where a design is sought.

use std::sync::Arc;

use crate::excitation::error::{ExcitationError, above_zero, at_least_one, finite};
use crate::trajectory::TrajectoryFamily;

/// The trajectories among which a design is sought: family, period, harmonics, and the joints that stand still.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::DesignSpace;
/// use armid::trajectory::Family;
/// let space = DesignSpace::new(Family::CubicBSpline, 8.0, vec![5, 3]).unwrap().with_frozen(1, 0.2).unwrap();
/// assert_eq!(space.frozen(), [None, Some(0.2)]);
/// assert!(space.with_frozen(2, 0.0).is_err());
/// ```
#[derive(Clone, Debug)]
pub struct DesignSpace {
    family: Arc<dyn TrajectoryFamily>,
    period_s: f64,
    harmonics: Vec<usize>,
    frozen: Vec<Option<f64>>,
}

impl DesignSpace {
    /// The members of a family, of the list ([`Family`](crate::trajectory::Family)) or from outside, with this period (s) and with as many `harmonics` of each joint (n); splines have 2H + 1
    /// knots.
    ///
    /// # Errors
    /// [`ExcitationError::NotPositive`] if the period is no finite number above zero, [`ExcitationError::TooFew`] without
    /// joints.
    pub fn new(
        family: impl Into<Arc<dyn TrajectoryFamily>>,
        period_s: f64,
        harmonics: Vec<usize>,
    ) -> Result<Self, ExcitationError> {
        let family = family.into();
        above_zero("period", period_s, "s")?;
        at_least_one("joints", harmonics.len())?;
        let frozen = vec![None; harmonics.len()];
        Ok(Self { family, period_s, harmonics, frozen })
    }

    /// Returns this space with joint `index` standing still at `place` (rad).
    ///
    /// # Errors
    /// [`ExcitationError::NoSuchJoint`] if there is no such joint, [`ExcitationError::NotFinite`] if the place is no
    /// number. Whether it is within the joint's range is asked by the problem that takes the space.
    pub fn with_frozen(mut self, index: usize, place: f64) -> Result<Self, ExcitationError> {
        let joints = self.frozen.len();
        finite("frozen position", place, "rad")?;
        *self.frozen.get_mut(index).ok_or(ExcitationError::NoSuchJoint { found: index, joints })? = Some(place);
        Ok(self)
    }

    /// The family.
    pub const fn family(&self) -> &Arc<dyn TrajectoryFamily> {
        &self.family
    }

    /// Period T, s.
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Number of harmonics H of each joint, n.
    pub fn harmonics(&self) -> &[usize] {
        &self.harmonics
    }

    /// Where joints stand still, rad, n; `None` for those that move.
    pub fn frozen(&self) -> &[Option<f64>] {
        &self.frozen
    }

    /// The most harmonics that a joint has.
    pub fn highest_harmonic(&self) -> usize {
        self.harmonics.iter().copied().max().unwrap_or(0)
    }
}
