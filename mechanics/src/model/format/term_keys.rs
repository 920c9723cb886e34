//! Coefficients of torque terms by their keys: in `robot.toml` over a URDF, and in parameter files.

use super::error::FormatError;
use super::reading::{Check, Number};
use crate::model::parameters::DriveParameters;
use crate::model::robot::Robot;
use crate::model::term::{Sign, Term};

/// Puts coefficients with the keys of terms into those of one joint; other keys are passed over.
///
/// # Errors
/// [`FormatError`] for a key of the other kind of joint, one of a coupled motor where none is, a number that is not finite,
/// and, where `require_consistent`, a number below zero where none may be.
pub(super) fn read_terms<'a>(
    check: Check<'_>,
    robot: &Robot,
    index: usize,
    numbers: impl Iterator<Item = (&'a str, &'a Number)>,
    require_consistent: bool,
    into: &mut DriveParameters,
) -> Result<(), FormatError> {
    let kind = robot.joints()[index].kind;
    for (key, number) in numbers {
        let Some(term) = Term::ALL.iter().copied().find(|term| term.entry().key.is(key)) else { continue };
        let expected = term.entry().key.for_kind(kind);
        if key != expected {
            let unit = kind.unit();
            let message = format!("{key} is given for a joint measured in {unit}, expected {expected}");
            return check.fault(number.span(), message);
        }
        if !term.is_at(robot, index) {
            let message = format!("{key} is given, expected it only where the robot's coupling drives more joints");
            return check.fault(number.span(), message);
        }
        into[term] = match term.entry().sign {
            Sign::NotNegative if require_consistent => check.not_negative(key, number)?,
            Sign::NotNegative | Sign::Any => check.finite(key, number)?,
        };
    }
    Ok(())
}

/// Every key of a term.
pub(super) fn term_keys() -> impl Iterator<Item = &'static str> {
    Term::ALL.iter().map(|term| term.entry().key).flat_map(|key| [key.revolute, key.prismatic])
}
