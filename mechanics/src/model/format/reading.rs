//! Values with their place in the text, and the checks that every file shares.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};
use serde::de::DeserializeOwned;
use toml::Spanned;

use super::error::FormatError;
use crate::model::joint::exact_sincos;
use crate::spatial::Placement;

/// A number and where it stands.
pub(super) type Number = Spanned<f64>;
/// A list of numbers and where they stand.
pub(super) type Row = Spanned<Vec<Number>>;

/// Gravity where a file does not say otherwise, m/s².
pub(super) const STANDARD_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Reads TOML into the shape of a file.
pub(super) fn read<T: DeserializeOwned>(text: &str) -> Result<T, FormatError> {
    toml::from_str(text).map_err(|fault| FormatError::of_toml(text, &fault))
}

/// The checks of one text.
#[derive(Clone, Copy)]
pub(super) struct Check<'a> {
    pub(super) text: &'a str,
}

impl<'a> Check<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text }
    }

    pub(super) fn fault<T>(&self, span: Range<usize>, message: impl Into<String>) -> Result<T, FormatError> {
        Err(FormatError::at_span(self.text, span, message))
    }

    /// The place of a name among others; it must be one of them, and not have been there before.
    pub(super) fn place(
        &self,
        what: &str,
        name: &Spanned<String>,
        names: &[&str],
        seen: &mut [bool],
    ) -> Result<usize, FormatError> {
        let found = name.get_ref();
        match names.iter().position(|known| known == found) {
            Some(index) if std::mem::replace(&mut seen[index], true) => {
                self.fault(name.span(), format!("{what} \"{found}\" is there twice, expected it once"))
            }
            Some(index) => Ok(index),
            None => {
                let message = format!("{what} \"{found}\" is not there, expected one of {}", quoted(names));
                self.fault(name.span(), message)
            }
        }
    }

    pub(super) fn finite(&self, key: &str, number: &Number) -> Result<f64, FormatError> {
        self.held(key, number, f64::is_finite, "a finite number")
    }

    pub(super) fn positive(&self, key: &str, number: &Number) -> Result<f64, FormatError> {
        self.finite(key, number)?;
        self.held(key, number, |x| x > 0.0, "a number above zero")
    }

    pub(super) fn not_negative(&self, key: &str, number: &Number) -> Result<f64, FormatError> {
        self.finite(key, number)?;
        self.held(key, number, |x| x >= 0.0, "a number not below zero")
    }

    /// The number, if it `holds`.
    fn held(&self, key: &str, number: &Number, holds: fn(f64) -> bool, expected: &str) -> Result<f64, FormatError> {
        let value = *number.get_ref();
        if holds(value) {
            return Ok(value);
        }
        self.fault(number.span(), format!("{key} is {value}, expected {expected}"))
    }

    /// As [`Self::positive`]; `otherwise` where the key is not stated.
    pub(super) fn positive_or(&self, key: &str, number: &Option<Number>, otherwise: f64) -> Result<f64, FormatError> {
        number.as_ref().map_or(Ok(otherwise), |number| self.positive(key, number))
    }

    /// As [`Self::not_negative`]; `otherwise` where the key is not stated.
    pub(super) fn not_negative_or(
        &self,
        key: &str,
        number: &Option<Number>,
        otherwise: f64,
    ) -> Result<f64, FormatError> {
        number.as_ref().map_or(Ok(otherwise), |number| self.not_negative(key, number))
    }

    /// A list of exactly `N` finite numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str, row: &Row) -> Result<[f64; N], FormatError> {
        let found = row.get_ref();
        if found.len() != N {
            return self.fault(row.span(), format!("{key} has {} numbers, expected {N}", found.len()));
        }
        let mut out = [0.0; N];
        for (slot, number) in out.iter_mut().zip(found) {
            *slot = self.finite(key, number)?;
        }
        Ok(out)
    }

    pub(super) fn vector(&self, key: &str, row: &Row) -> Result<Vector3<f64>, FormatError> {
        self.numbers::<3>(key, row).map(Vector3::from)
    }
}

/// Rotation by roll, pitch and yaw in degrees about the fixed x, y and z axes: `Rz(yaw) Ry(pitch) Rx(roll)`.
pub(super) fn roll_pitch_yaw(degrees: [f64; 3]) -> Matrix3<f64> {
    let [roll, pitch, yaw] = degrees.map(exact_sincos);
    let turn = Placement::rotation_z(yaw.0, yaw.1)
        .compose(&Placement::rotation_y(pitch.0, pitch.1))
        .compose(&Placement::rotation_x(roll.0, roll.1));
    turn.rotation
}

/// Names for a message: `"a", "b", "c"`.
pub(super) fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}
