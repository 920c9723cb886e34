//! How well the parameters of `nominal.toml` are known.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Number};
use crate::model::columns::distinct;
use crate::model::term::Term;

/// How far the truth may be from a guess: one standard deviation per group of parameters.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RelativeUncertainty {
    /// Of the mass.
    pub mass: f64,
    /// Of the first moment, as a share of its length.
    pub first_moment: f64,
    /// Of the rotational inertia, as a share of its trace.
    pub inertia: f64,
    /// Of the coefficients of terms, by the key of their prior: a share of the value or an amount, as the prior says.
    pub terms: BTreeMap<String, f64>,
}

impl RelativeUncertainty {
    /// The uncertainty of a term's coefficient: as stated, else the prior's default, else none.
    pub fn of_term(&self, term: Term) -> f64 {
        let prior = term.entry().prior;
        self.terms.get(prior.key).copied().or(prior.default).unwrap_or(0.0)
    }
}

/// The table as it stands in the file.
#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct UncertaintyTable(BTreeMap<Spanned<String>, Number>);

impl UncertaintyTable {
    /// The checked table, which stands at `at` in the text.
    pub(super) fn read(&self, check: Check<'_>, at: Range<usize>) -> Result<RelativeUncertainty, FormatError> {
        let of_terms = Term::ALL.iter().map(|term| term.entry().prior.key);
        let known = distinct(["mass", "first_moment", "inertia"].into_iter().chain(of_terms));
        if let Some(unknown) = self.0.keys().find(|key| !known.contains(&key.get_ref().as_str())) {
            let keys: Vec<String> = known.iter().map(|key| format!("`{key}`")).collect();
            let message = format!("unknown field `{}`, expected one of {}", unknown.get_ref(), keys.join(", "));
            return check.fault(unknown.span(), message);
        }
        let stated = |key: &str| {
            let found = self.0.iter().find(|(own, _)| own.get_ref() == key);
            found.map(|(_, number)| check.not_negative(key, number)).transpose()
        };
        let missing = |key: &str| check.fault(at.clone(), format!("missing field `{key}`"));
        let needed = |key: &str| stated(key)?.map_or_else(|| missing(key), Ok);
        let mut terms = BTreeMap::new();
        for term in Term::ALL {
            let prior = term.entry().prior;
            let value = if prior.default.is_none() { Some(needed(prior.key)?) } else { stated(prior.key)? };
            if let Some(value) = value {
                terms.insert(prior.key.to_owned(), value);
            }
        }
        Ok(RelativeUncertainty {
            mass: needed("mass")?,
            first_moment: needed("first_moment")?,
            inertia: needed("inertia")?,
            terms,
        })
    }
}
