//! What turns the joints of an arm.

/// What turns a joint: it says which effects an arm may have that its model omits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriveKind {
    /// A strain wave gear.
    Harmonic,
    /// A planetary or spur gear.
    Planetary,
    /// A toothed belt.
    Belt,
    /// A motor without a gear.
    Direct,
    /// A hobby servo.
    Servo,
}

crate::input::named! { DriveKind {
    Harmonic: "harmonic", Planetary: "planetary", Belt: "belt", Direct: "direct", Servo: "servo"
} }
