//! How groups of data are distinguished: by colour, and without colour by marker and dashes.
//!
//! Colours are those of Okabe and Ito ("Color universal design", 2008) without yellow, which stay apart for readers with any common
//! colour-vision deficiency, and a grey. A name of the project (a design criterion, an estimator) always has the same style, so
//! that a colour means the same in every figure of every report; other names get the next style that is free.

use crate::drawing::colour::Colour;

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Circle,
    /// Filled square.
    Square,
    /// Filled triangle, point up.
    Triangle,
    /// Filled diamond.
    Diamond,
    /// Filled triangle, point down.
    TriangleDown,
    /// Open circle.
    OpenCircle,
    /// Open square.
    OpenSquare,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
}

/// Stroke of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long dashes.
    Dashed,
    /// Short dashes.
    Dotted,
    /// A long and a short dash in turn.
    DashDot,
}

impl Dash {
    /// Lengths of stroke and gap in turn, px; empty where the line is unbroken.
    pub(crate) fn pattern(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[8.0, 4.5],
            Self::Dotted => &[2.5, 3.0],
            Self::DashDot => &[9.0, 3.5, 2.5, 3.5],
        }
    }
}

/// Colour, marker and line of one group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupStyle {
    pub(crate) colour: Colour,
    /// Shape of its points.
    pub marker: Marker,
    /// Stroke of its lines.
    pub dash: Dash,
    /// Width of its lines, px.
    pub width_px: f64,
}

/// Okabe–Ito, in the order of use; yellow is left out because a thin yellow line vanishes on white paper.
const CYCLE: [(Colour, Marker, Dash); 8] = [
    (Colour(0x00, 0x72, 0xB2), Marker::Circle, Dash::Solid),
    (Colour(0xD5, 0x5E, 0x00), Marker::Triangle, Dash::Dashed),
    (Colour(0x00, 0x9E, 0x73), Marker::Square, Dash::DashDot),
    (Colour(0xCC, 0x79, 0xA7), Marker::Diamond, Dash::Dotted),
    (Colour(0xE6, 0x9F, 0x00), Marker::TriangleDown, Dash::Dashed),
    (Colour(0x56, 0xB4, 0xE9), Marker::OpenSquare, Dash::DashDot),
    (Colour(0x00, 0x00, 0x00), Marker::Cross, Dash::Solid),
    (Colour(0x80, 0x80, 0x80), Marker::Plus, Dash::Dotted),
];

/// Of names beyond the cycle: indigo and wine of Tol's "muted" scheme (2021).
const INDIGO: Colour = Colour(0x33, 0x22, 0x88);
const WINE: Colour = Colour(0x88, 0x22, 0x55);

impl GroupStyle {
    /// A measured quantity: a broad grey line that others can be drawn upon.
    pub const MEASURED: Self =
        Self { colour: Colour(0x9A, 0x9A, 0x9A), marker: Marker::OpenCircle, dash: Dash::Solid, width_px: 2.6 };
    /// A predicted quantity.
    pub const PREDICTED: Self =
        Self { colour: Colour(0xD5, 0x5E, 0x00), marker: Marker::Triangle, dash: Dash::Solid, width_px: 1.2 };
    /// What the prediction leaves over.
    pub const RESIDUAL: Self =
        Self { colour: Colour(0x00, 0x72, 0xB2), marker: Marker::Circle, dash: Dash::Dotted, width_px: 1.2 };
    /// A true value, a target, anything that is not an estimate.
    pub const TRUTH: Self =
        Self { colour: Colour(0x00, 0x00, 0x00), marker: Marker::Cross, dash: Dash::Dashed, width_px: 1.6 };

    /// The style of the `index`-th group, counted from 0; colours repeat after 8.
    pub fn nth(index: usize) -> Self {
        let (colour, marker, dash) = CYCLE[index % CYCLE.len()];
        Self { colour, marker, dash, width_px: 1.6 }
    }

    /// The style that belongs to a name of the project for ever, if it has one.
    ///
    /// ```
    /// use armid_reports::GroupStyle;
    /// assert_eq!(GroupStyle::for_name("d-optimal"), GroupStyle::for_name("D-optimal"));
    /// assert!(GroupStyle::for_name("another").is_none());
    /// ```
    pub fn for_name(name: &str) -> Option<Self> {
        let index = match name.to_lowercase().as_str() {
            "condition" | "condition number" | "wls" => 0,
            "d-optimal" | "d-optimality" | "ols" => 1,
            "condition-scaled" | "column-normalised condition number" => 2,
            "random" | "best of random draws" | "best of n random draws" => 3,
            "a-optimal" | "a-optimality" => 4,
            "e-optimal" | "e-optimality" => 5,
            "table-one" | "table-i" | "table i" | "paper" => 6,
            "i-optimal" | "i-optimality" => {
                return Some(Self { colour: WINE, marker: Marker::Plus, dash: Dash::Dotted, width_px: 1.6 });
            }
            "model-error" | "model error" => {
                return Some(Self { colour: INDIGO, marker: Marker::OpenCircle, dash: Dash::Solid, width_px: 1.6 });
            }
            _ => return None,
        };
        Some(Self::nth(index))
    }

    /// Returns this style with lines `width_px` wide.
    #[must_use]
    pub fn with_width(self, width_px: f64) -> Self {
        Self { width_px, ..self }
    }
}

/// A group of data: its name in the legend, and its style.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name in the legend.
    pub label: String,
    /// Colour, marker, line.
    pub style: GroupStyle,
}

impl Group {
    /// A group with a style of its own.
    pub fn new(label: impl Into<String>, style: GroupStyle) -> Self {
        Self { label: label.into(), style }
    }

    /// One group per name: known names keep their style, the others get the first styles that are left.
    ///
    /// ```
    /// use armid_reports::{Group, GroupStyle};
    /// let groups = Group::assign(["d-optimal", "mine"]);
    /// assert_eq!(groups[0].style, GroupStyle::for_name("d-optimal").unwrap());
    /// assert_eq!(groups[1].style, GroupStyle::nth(0));
    /// ```
    pub fn assign<I: IntoIterator<Item = S>, S: Into<String>>(names: I) -> Vec<Self> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let mut taken: Vec<GroupStyle> = names.iter().filter_map(|name| GroupStyle::for_name(name)).collect();
        names
            .into_iter()
            .enumerate()
            .map(|(position, label)| {
                let style = GroupStyle::for_name(&label).unwrap_or_else(|| {
                    let free = (0..CYCLE.len()).map(GroupStyle::nth).find(|style| !taken.contains(style));
                    let style = free.unwrap_or_else(|| GroupStyle::nth(position));
                    taken.push(style);
                    style
                });
                Self { label, style }
            })
            .collect()
    }
}
