//! The names of a robot's dynamic parameters.

use std::fmt;

use super::joint::JointKind;
use super::term::Term;

/// Which quantity a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names are the notation of NOTATION.md")]
pub enum ParameterKind {
    M,
    Mcx,
    Mcy,
    Mcz,
    Ixx,
    Ixy,
    Ixz,
    Iyy,
    Iyz,
    Izz,
    /// The coefficient of a torque term.
    Term(Term),
}

impl ParameterKind {
    /// The ten of a link, in order.
    pub const LINK: [Self; 10] =
        [Self::M, Self::Mcx, Self::Mcy, Self::Mcz, Self::Ixx, Self::Ixy, Self::Ixz, Self::Iyy, Self::Iyz, Self::Izz];

    /// The symbol, without the number.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Mcx => "mcx",
            Self::Mcy => "mcy",
            Self::Mcz => "mcz",
            Self::Ixx => "Ixx",
            Self::Ixy => "Ixy",
            Self::Ixz => "Ixz",
            Self::Iyy => "Iyy",
            Self::Iyz => "Iyz",
            Self::Izz => "Izz",
            Self::Term(term) => term.symbol(),
        }
    }

    /// Unit where its joint is of this kind.
    pub fn unit(self, kind: JointKind) -> &'static str {
        match self {
            Self::M => "kg",
            Self::Mcx | Self::Mcy | Self::Mcz => "kg·m",
            Self::Ixx | Self::Ixy | Self::Ixz | Self::Iyy | Self::Iyz | Self::Izz => "kg·m²",
            Self::Term(term) => term.unit(kind),
        }
    }

    /// Its place among the ten of a link; `None` for the coefficient of a term.
    pub fn link_place(self) -> Option<usize> {
        Self::LINK.iter().position(|&kind| kind == self)
    }

    /// The torque term that it is the coefficient of; `None` for a link's.
    pub const fn term(self) -> Option<Term> {
        if let Self::Term(term) = self { Some(term) } else { None }
    }
}

/// One parameter: which quantity, of which link or joint. Prints as `mcx2`, `Iyy1`, `Fc4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ParameterId {
    /// Which quantity.
    pub kind: ParameterKind,
    /// Index of the link or joint, from zero; names count from one.
    pub index: usize,
}

impl ParameterId {
    /// The parameter with this name; `None` where it is neither one of a link's ten nor of a term of the list.
    ///
    /// ```
    /// # use armid_mechanics as armid;
    /// use armid::model::ParameterId;
    /// assert_eq!(ParameterId::parse("Iyy1").map(|id| id.index), Some(0));
    /// assert_eq!(ParameterId::parse("Iyy0"), None);
    /// ```
    pub fn parse(name: &str) -> Option<Self> {
        let symbol = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let number: usize = name[symbol.len()..].parse().ok()?;
        let terms = Term::ALL.iter().map(|&term| ParameterKind::Term(term));
        let kind = ParameterKind::LINK.into_iter().chain(terms).find(|kind| kind.symbol() == symbol)?;
        Some(Self { kind, index: number.checked_sub(1)? })
    }
}

/// As its name.
impl serde::Serialize for ParameterId {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// From its name. The coefficient of a term from outside the list has none that can be read.
impl<'de> serde::Deserialize<'de> for ParameterId {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::parse(&name).ok_or_else(|| {
            serde::de::Error::custom(format!(
                "parameter \"{name}\", expected a symbol of the list and a number, as mcx2"
            ))
        })
    }
}

impl fmt::Display for ParameterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.kind.symbol(), self.index + 1)
    }
}
