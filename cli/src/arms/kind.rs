//! The arms that can perform an experiment: one option switches between them.

use armid_sim::Engine;

/// Every arm, listed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArmKind {
    /// The arm simulated by an engine.
    Simulated(Engine),
    /// A stored recording.
    Replay,
    /// A real arm over ROS 2.
    Ros2,
}

impl ArmKind {
    pub(crate) const ALL: [Self; Engine::ALL.len() + 2] = {
        let mut arms = [Self::Replay; Engine::ALL.len() + 2];
        arms[Engine::ALL.len() + 1] = Self::Ros2;
        let mut i = 0;
        while i < Engine::ALL.len() {
            arms[i] = Self::Simulated(Engine::ALL[i]);
            i += 1;
        }
        arms
    };

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Simulated(engine) => engine.name(),
            Self::Replay => "replay",
            Self::Ros2 => "ros2",
        }
    }

    pub(crate) fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|arm| arm.name() == name)
    }
}
