//! The letters of a formula.

use std::fmt;

use crate::base::geometry::Geometry;
use crate::model::{DhRow, JointKind, Robot};

/// Which entry of a Denavit–Hartenberg row, or which function of it, a letter stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Length along x, m.
    A,
    /// Offset along z, m.
    D,
    /// Sine of the twist.
    SinAlpha,
    /// Cosine of the twist.
    CosAlpha,
    /// Sine of the fixed angle of a prismatic joint.
    SinTheta,
    /// Cosine of the fixed angle of a prismatic joint.
    CosTheta,
}

/// One letter: a quantity of one joint's row. Prints as `a2`, `d4`, `sin(α3)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol {
    /// Which quantity.
    pub quantity: Quantity,
    /// Index of the joint, from zero; names count from one.
    pub joint: usize,
}

impl Symbol {
    /// Its value on a robot, m or 1; `None` where the joint is not given by a DH row.
    pub fn value(self, robot: &Robot) -> Option<f64> {
        robot.joints().get(self.joint)?.dh.map(|(_, row)| self.value_in_row(&row))
    }

    /// Its value in a row.
    pub(super) fn value_in_row(self, row: &DhRow) -> f64 {
        match self.quantity {
            Quantity::A => row.a,
            Quantity::D => row.d,
            Quantity::SinAlpha => libm::sin(row.alpha_deg.to_radians()),
            Quantity::CosAlpha => libm::cos(row.alpha_deg.to_radians()),
            Quantity::SinTheta => libm::sin(row.offset_deg.to_radians()),
            Quantity::CosTheta => libm::cos(row.offset_deg.to_radians()),
        }
    }

    /// Whether it is a length.
    pub(super) const fn is_length(self) -> bool {
        matches!(self.quantity, Quantity::A | Quantity::D)
    }
}

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.joint + 1;
        match self.quantity {
            Quantity::A => write!(f, "a{number}"),
            Quantity::D => write!(f, "d{number}"),
            Quantity::SinAlpha => write!(f, "sin(α{number})"),
            Quantity::CosAlpha => write!(f, "cos(α{number})"),
            Quantity::SinTheta => write!(f, "sin(θ{number})"),
            Quantity::CosTheta => write!(f, "cos(θ{number})"),
        }
    }
}

/// Something of a robot that can be changed: a length, or an oblique angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    /// A length other than zero.
    Length(Symbol),
    /// A twist that is not a multiple of 90°.
    Alpha(usize),
    /// The fixed angle of a prismatic joint that is not a multiple of 90°.
    Theta(usize),
}

impl Variable {
    /// Everything of a robot that formulas may depend on.
    pub(super) fn of(geometry: &Geometry) -> Vec<Self> {
        let oblique = |degrees: f64| (degrees / 90.0).fract() != 0.0;
        let mut variables = Vec::new();
        for (joint, row) in geometry.dh.iter().enumerate() {
            let Some((_, row)) = row else { continue };
            for quantity in [Quantity::A, Quantity::D] {
                let symbol = Symbol { quantity, joint };
                if symbol.value_in_row(row) != 0.0 {
                    variables.push(Self::Length(symbol));
                }
            }
            if oblique(row.alpha_deg) {
                variables.push(Self::Alpha(joint));
            }
            if geometry.kinds[joint] == JointKind::Prismatic && oblique(row.offset_deg) {
                variables.push(Self::Theta(joint));
            }
        }
        variables
    }

    /// The letters in which a formula writes it.
    pub(super) fn symbols(self) -> Vec<Symbol> {
        let letter = |quantity, joint| Symbol { quantity, joint };
        match self {
            Self::Length(symbol) => vec![symbol],
            Self::Alpha(joint) => vec![letter(Quantity::CosAlpha, joint), letter(Quantity::SinAlpha, joint)],
            Self::Theta(joint) => vec![letter(Quantity::CosTheta, joint), letter(Quantity::SinTheta, joint)],
        }
    }
}
