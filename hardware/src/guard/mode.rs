//! How the motion reaches the robot, and so what a guard on this side of the wire can do about it.

/// How the motion reaches the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Handed over whole before it begins: the guard observes, and cancels.
    Trajectory,
    /// Set-point by set-point: the guard sees each before it is sent, and can withhold it.
    Stream,
}

armid::input::named! { Mode { Trajectory: "trajectory", Stream: "stream" } }
