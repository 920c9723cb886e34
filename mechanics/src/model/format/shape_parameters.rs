//! The part of `robot.toml` that says which shape parameters the torque laws of a drive have.
//!
//! ```text
//! [joint.drive.shape]
//! stribeck_velocity_rad_s = 0.05
//! ```
//! The Coulomb velocity is one too, with a key of its own beside the table.

use std::collections::BTreeMap;

use toml::Spanned;

use super::FormatError;
use super::reading::{Check, Number, quoted};
use crate::model::term::{ShapeParameter, Term};

/// Reads the table `shape` of a drive: what each key, which a term of the list must have, is set to.
pub(super) fn read_shape_parameters(
    check: Check<'_>,
    table: &BTreeMap<Spanned<String>, Number>,
) -> Result<BTreeMap<String, f64>, FormatError> {
    let known = keys();
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

/// The keys of all shape parameters of the list of terms, each once.
fn keys() -> Vec<&'static str> {
    let mut keys: Vec<&str> = Vec::new();
    for shape in Term::ALL.iter().flat_map(|term| term.entry().shapes) {
        if *shape != ShapeParameter::COULOMB_VELOCITY && !keys.contains(&shape.key) {
            keys.push(shape.key);
        }
    }
    keys
}
