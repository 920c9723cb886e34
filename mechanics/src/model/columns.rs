//! Which parameters a model has: those of the links, and the coefficients of a set of torque terms.

use std::fmt;

use super::columns_error::ColumnsError;
use super::parameter_id::{ParameterId, ParameterKind};
use super::robot::Robot;
use super::term::{COULOMB, MOTOR_COULOMB, MOTOR_VISCOUS, OFFSET, ROTOR, ShapeParameter, Term, VISCOUS};

/// Terms of one model at most.
pub const MOST_TERMS: usize = 24;

/// The columns of a regressor: the ten of each link, and one for each joint or motor that a term acts on.
///
/// Written as words joined by `+`: `rigid` alone, or `rigid` and the names of terms. `friction` is short for
/// `viscous+coulomb+offset`.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::Columns;
/// let columns = Columns::parse("rigid+rotor+viscous+coulomb+offset").unwrap();
/// assert_eq!(columns, Columns::RIGID_ROTOR_FRICTION);
/// assert_eq!(columns.to_string(), "rigid+rotor+friction");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Columns {
    /// In the order of the terms, none twice; what is set stands in front.
    terms: [Option<Term>; MOST_TERMS],
}

const RIGID: &str = "rigid";
const FRICTION: &str = "friction";
/// What `friction` is short for.
const FRICTION_NAMES: [&str; 3] = ["viscous", "coulomb", "offset"];

impl Columns {
    /// The ten parameters of each link.
    pub const RIGID: Self = Self::of_listed(&[]);
    /// And the rotor inertia of each drive.
    pub const RIGID_ROTOR: Self = Self::of_listed(&[ROTOR]);
    /// And viscous friction, Coulomb friction and offset of each joint, and of coupled motors.
    pub const RIGID_ROTOR_FRICTION: Self =
        Self::of_listed(&[ROTOR, VISCOUS, COULOMB, OFFSET, MOTOR_VISCOUS, MOTOR_COULOMB]);

    /// The choices with a name of their own.
    pub const ALL: [Self; 3] = [Self::RIGID, Self::RIGID_ROTOR, Self::RIGID_ROTOR_FRICTION];

    /// From terms in the order of the list.
    const fn of_listed(terms: &[Term]) -> Self {
        let mut all = [None; MOST_TERMS];
        let mut k = 0;
        while k < terms.len() {
            all[k] = Some(terms[k]);
            k += 1;
        }
        Self { terms: all }
    }

    /// These columns and those of another term.
    ///
    /// # Panics
    /// Beyond [`MOST_TERMS`].
    #[must_use]
    pub fn with_term(self, term: Term) -> Self {
        if self.has(term) {
            return self;
        }
        let mut terms: Vec<Term> = self.terms().chain([term]).collect();
        assert!(terms.len() <= MOST_TERMS, "{} terms in one model, expected at most {MOST_TERMS}", terms.len());
        terms.sort();
        Self::of_listed(&terms)
    }

    /// These columns without those of a term.
    #[must_use]
    pub fn without_term(self, term: Term) -> Self {
        let terms: Vec<Term> = self.terms().filter(|&own| own != term).collect();
        Self::of_listed(&terms)
    }

    /// The terms, in order.
    pub fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        self.terms.iter().map_while(|term| *term)
    }

    /// Whether a term is among them.
    pub fn has(&self, term: Term) -> bool {
        self.terms().any(|own| own == term)
    }

    /// The shape parameters of the laws of the terms, each once.
    pub fn shapes(&self) -> Vec<ShapeParameter> {
        distinct(self.terms().flat_map(|term| term.entry().shapes).copied())
    }

    /// The first term that needs more than the motion: the transmitted torque, or a temperature.
    pub fn beyond_motion(&self) -> Option<Term> {
        self.terms().find(|term| !term.entry().needs.is_motion())
    }

    /// The choice with this name, of the terms in the list.
    pub fn parse(name: &str) -> Option<Self> {
        Self::parse_among(name, Term::ALL)
    }

    /// The choice with this name, of these terms.
    pub fn parse_among(name: &str, known: &[Term]) -> Option<Self> {
        let mut words = name.split('+').map(str::trim);
        if words.next()? != RIGID {
            return None;
        }
        let mut columns = Self::RIGID;
        for word in words {
            let has_name = |name: &'static str| name == word || (word == FRICTION && FRICTION_NAMES.contains(&name));
            let named: Vec<Term> = known.iter().copied().filter(|term| has_name(term.entry().name)).collect();
            if named.is_empty() {
                return None;
            }
            columns = named.into_iter().fold(columns, Self::with_term);
        }
        Some(columns)
    }

    /// The choice with this name, of terms that can be estimated from motion and torque.
    ///
    /// # Errors
    /// [`ColumnsError`] that says what keeps it from being estimated.
    pub fn parse_estimable(text: &str) -> Result<Self, ColumnsError> {
        let columns =
            Self::parse(text).ok_or_else(|| ColumnsError::Unknown { found: text.to_owned(), words: Self::words() })?;
        columns.check_estimable()?;
        Ok(columns)
    }

    /// Checks that motion and torque are enough to estimate every term.
    ///
    /// # Errors
    /// [`ColumnsError::Warmth`] for the first that needs more.
    pub fn check_estimable(&self) -> Result<(), ColumnsError> {
        let Some(term) = self.terms().find(|term| !term.entry().needs.is_estimable()) else { return Ok(()) };
        let (name, meaning) = (term.entry().name, term.entry().meaning);
        Err(ColumnsError::Warmth { name, meaning, words: Self::words() })
    }

    /// Checks that the motion alone gives every column.
    ///
    /// # Errors
    /// [`ColumnsError`] for the first that needs more.
    pub fn check_motion(&self) -> Result<(), ColumnsError> {
        self.check_estimable()?;
        let Some(term) = self.beyond_motion() else { return Ok(()) };
        Err(ColumnsError::Load { name: term.entry().name, meaning: term.entry().meaning })
    }

    /// The words that [`Columns::parse`] reads beside `rigid`, of terms that motion and torque are enough to estimate.
    pub fn words() -> Vec<&'static str> {
        let estimable = Term::ALL.iter().filter(|term| term.entry().needs.is_estimable());
        distinct(std::iter::once(FRICTION).chain(estimable.map(|term| term.entry().name)))
    }

    /// The parameters of a robot in order: length p, the columns of its regressor.
    pub fn parameters(&self, robot: &Robot) -> Vec<ParameterId> {
        let links = (0..robot.dof()).flat_map(|index| ParameterKind::LINK.map(|kind| ParameterId { kind, index }));
        let terms = (0..robot.dof()).flat_map(|index| {
            let here = self.terms().filter(move |term| term.is_at(robot, index));
            here.map(move |term| ParameterId { kind: ParameterKind::Term(term), index }).collect::<Vec<_>>()
        });
        links.chain(terms).collect()
    }
}

/// Each of them once, where it comes first.
pub fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

impl Default for Columns {
    fn default() -> Self {
        Self::RIGID_ROTOR_FRICTION
    }
}

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = distinct(self.terms().map(|term| term.entry().name));
        let mut text = RIGID.to_owned();
        let all_friction = FRICTION_NAMES.iter().all(|name| words.contains(name));
        for word in words {
            match FRICTION_NAMES.iter().position(|&name| name == word) {
                Some(0) if all_friction => text = format!("{text}+{FRICTION}"),
                Some(_) if all_friction => {}
                _ => text = format!("{text}+{word}"),
            }
        }
        f.write_str(&text)
    }
}

impl fmt::Debug for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_cannot_be_estimated_say_what_keeps_them() {
        for term in Term::ALL {
            let text = format!("rigid+{}", term.entry().name);
            let found = Columns::parse_estimable(&text);
            let needs = term.entry().needs;
            match found {
                Ok(columns) => assert!(needs.is_estimable() && columns.has(*term)),
                Err(ColumnsError::Warmth { name, .. }) => assert!(needs.warmth && name == term.entry().name),
                Err(other) => panic!("{text}: {other}"),
            }
        }
        let fault = Columns::parse_estimable("rigid+stiction").unwrap_err().to_string();
        assert!(fault.contains("rigid+stiction") && fault.contains("coulomb"), "{fault}");
    }
}
