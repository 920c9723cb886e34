//! Colours, and those of what surrounds the data.

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Colour(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl Colour {
    pub(crate) const WHITE: Self = Self(0xFF, 0xFF, 0xFF);
    pub(crate) const TEXT: Self = Self(0x1A, 0x1A, 0x1A);
    pub(crate) const MUTED: Self = Self(0x55, 0x55, 0x55);
    pub(crate) const FRAME: Self = Self(0x66, 0x66, 0x66);
    pub(crate) const GRID: Self = Self(0xE4, 0xE4, 0xE4);
    pub(crate) const STRIPE: Self = Self(0xF5, 0xF5, 0xF5);
    pub(crate) const BAND: Self = Self(0xDD, 0xE9, 0xDF);
}
