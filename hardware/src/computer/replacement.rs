//! How a motion is replaced by another one: the behaviours of versions of `joint_trajectory_controller`.

/// What becomes of a motion under way where another one is handed over: versions of `joint_trajectory_controller` differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Replacement {
    /// The old one is dropped at once; where the new one's first points are past, it is joined in its midst (issue 896).
    #[default]
    AtOnce,
    /// One that begins later waits until then (pull request 2401); otherwise as `AtOnce`.
    Deferred,
    /// One that begins later is spliced in where it begins; one whose stamp is past begins anew, now (pull request 2419).
    Spliced,
    /// As `AtOnce`, but that the old one has ended is said when the new one has (issue 1519).
    LateEnd,
    /// It is refused.
    Refused,
    /// Both end (issue 1241).
    BothCancelled,
}

armid::input::named! { Replacement {
    AtOnce: "at-once", Deferred: "deferred", Spliced: "spliced", LateEnd: "late-end", Refused: "refused",
    BothCancelled: "both-cancelled"
} }
