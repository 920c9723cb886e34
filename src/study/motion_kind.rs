//! The kinds of motion on which a study tests predictions of torque.

/// A kind of motion on which torque predictions are tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionKind {
    /// Random trajectories.
    #[default]
    Random,
    /// Random motions at 30 % of their speed.
    Slow,
    /// Quintic moves between random poses.
    PointToPoint,
    /// Random poses at rest.
    Static,
}

crate::input::named! { MotionKind as title {
    Random: "random", Slow: "slow", PointToPoint: "point to point", Static: "static"
} }

impl MotionKind {
    /// The kind of motion of this name, as plans have it: `random`, `slow` or `point-to-point`.
    pub fn moving(name: &str) -> Option<Self> {
        [Self::Random, Self::Slow, Self::PointToPoint].into_iter().find(|kind| kind.title().replace(' ', "-") == name)
    }

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub(super) const fn is_random(&self) -> bool {
        matches!(self, Self::Random)
    }
}
