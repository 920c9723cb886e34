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

crate::input::named! { Level { Realistic: "realistic", Severe: "severe" } }
