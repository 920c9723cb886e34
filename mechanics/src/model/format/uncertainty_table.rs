//! The part of `robot.toml` that declares what no recording shows.

use std::collections::BTreeMap;

use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Number};
use crate::model::declared_uncertainty::DeclaredUncertainty;

/// The table as it stands in the file.
pub(super) type UncertaintyTable = BTreeMap<Spanned<String>, Number>;

/// The declared uncertainty; none where there is no table.
pub(super) fn read_uncertainty(check: Check<'_>, table: &UncertaintyTable) -> Result<DeclaredUncertainty, FormatError> {
    let mut stated = BTreeMap::new();
    for (key, number) in table {
        let value = *number.get_ref();
        if let Err(fault) = DeclaredUncertainty::new(BTreeMap::from([(key.get_ref().clone(), value)])) {
            return check.fault(key.span(), fault.to_string());
        }
        stated.insert(key.get_ref().clone(), value);
    }
    DeclaredUncertainty::new(stated).or_else(|fault| check.fault(0..0, fault.to_string()))
}
