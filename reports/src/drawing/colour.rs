//! Colours, those of what surrounds the data, and their partners on a dark page.

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
    /// Text on a light colour that stays light on a dark page.
    pub(crate) const ON_LIGHT: Self = Self(0x1B, 0x1B, 0x1B);
}

/// What a colour becomes where the reader's screen is dark. Colours that are legible on both are not listed.
const DARK: [(Colour, &str); 10] = [
    (Colour::TEXT, "#E8E8E8"),
    (Colour::MUTED, "#B0B6BC"),
    (Colour::FRAME, "#9AA0A6"),
    (Colour::GRID, "#343A40"),
    (Colour::STRIPE, "#1E2327"),
    (Colour::BAND, "#23392B"),
    (Colour(0x00, 0x00, 0x00), "#FFFFFF"),
    (Colour(0x00, 0x72, 0xB2), "#4AA8E0"),
    (Colour(0x33, 0x22, 0x88), "#A99CF5"),
    (Colour(0x88, 0x22, 0x55), "#E07BA8"),
];

/// A style element with which a figure follows the reader's setting. Paper stays white; white text is on a dark colour.
pub(crate) fn dark_style() -> String {
    let rule = |(Colour(red, green, blue), dark): &(Colour, &str)| {
        let name = format!("#{red:02X}{green:02X}{blue:02X}");
        format!("[fill=\"{name}\"]{{fill:{dark}}}[stroke=\"{name}\"]{{stroke:{dark}}}")
    };
    let rules: String = DARK.iter().map(rule).collect();
    let paper = "[fill=\"#FFFFFF\"]:not(text){fill:#14171A}[stroke=\"#FFFFFF\"]{stroke:#14171A}";
    format!("<style>@media screen and (prefers-color-scheme:dark){{{paper}{rules}}}</style>\n")
}
