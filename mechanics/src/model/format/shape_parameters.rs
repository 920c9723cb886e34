//! The part of `robot.toml` that says which shape parameters the torque laws of a drive have.
//!
//! ```text
//! [joint.drive.shape]
//! stribeck_velocity_rad_s = 0.05
//! ```
//! The Coulomb velocity is one too, with a key of its own beside the table.

use std::collections::BTreeMap;

use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Number, quoted};
use crate::model::columns::Columns;
use crate::model::parameters::DriveParameters;
use crate::model::term::{ShapeParameter, Term};

const COULOMB_VELOCITY: &str = ShapeParameter::COULOMB_VELOCITY.key;

/// Reads the table `shape` of a drive: what each key, which a term of the list must have, is set to.
pub(super) fn read_shape_parameters(
    check: Check<'_>,
    table: &BTreeMap<Spanned<String>, Number>,
) -> Result<BTreeMap<String, f64>, FormatError> {
    let known: Vec<&str> = all().map(|shape| shape.key).filter(|key| *key != COULOMB_VELOCITY).collect();
    let mut shapes = BTreeMap::new();
    for (key, number) in table {
        let found = key.get_ref();
        if !known.contains(&found.as_str()) {
            let message = format!("shape parameter \"{found}\" belongs to no term, expected one of {}", quoted(&known));
            return check.fault(key.span(), message);
        }
        shapes.insert(found.clone(), check.finite(found, number)?);
    }
    Ok(shapes)
}

/// The shape parameters of all terms, each once.
pub(super) fn all() -> impl Iterator<Item = ShapeParameter> {
    Term::ALL.iter().fold(Columns::RIGID, |columns, &term| columns.with_term(term)).shapes().into_iter()
}

/// Those of the laws of terms whose coefficient is not zero.
pub(super) fn laws(drive: &DriveParameters) -> Vec<ShapeParameter> {
    let acting = drive.iter().filter(|(_, value)| *value != 0.0);
    acting.fold(Columns::RIGID, |columns, (term, _)| columns.with_term(term)).shapes()
}
