//! The routes to the base parameters.

/// How the base parameters are found. All three give the same K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Steps 1–5 of `radkhah2007` section II.B, on random states.
    #[serde(rename = "paper")]
    Radkhah2007,
    /// One left-to-right rank-revealing QR, on random states.
    Qr,
    /// The recursion over the links: no random states.
    #[default]
    Structural,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 3] = [Self::Radkhah2007, Self::Qr, Self::Structural];

    /// Its name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radkhah2007 => "paper",
            Self::Qr => "qr",
            Self::Structural => "structural",
        }
    }

    /// The method with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}
