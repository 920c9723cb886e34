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

crate::input::named! { Method { Radkhah2007: "paper", Qr: "qr", Structural: "structural" } }
