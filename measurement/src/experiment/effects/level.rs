//! How strong an effect is, in a word.

/// One of two magnitudes that every effect has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// An arm in good order.
    Realistic,
    /// A worn or carelessly built arm.
    Severe,
}

impl Level {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Realistic, Self::Severe];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Realistic => "realistic",
            Self::Severe => "severe",
        }
    }

    /// The level of this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }
}
