//! Options whose values are a list that the library keeps: one place for names, completions and errors.

use armid::estimation::EstimatorKind;
use armid::model::Columns;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// A parser for the values with these names.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    all: &[T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> + use<T> {
    let named: Vec<(&'static str, T)> = all.iter().map(|&value| (name(value), value)).collect();
    let names: Vec<&'static str> = named.iter().map(|(name, _)| *name).collect();
    PossibleValuesParser::new(names).try_map(move |found| {
        named.iter().find(|(name, _)| *name == found).map(|(_, value)| *value).ok_or("not in the list")
    })
}

/// An estimator by its name, or by one of its other names.
pub(crate) fn estimator() -> impl TypedValueParser<Value = EstimatorKind> {
    let names =
        EstimatorKind::ALL.iter().map(|kind| PossibleValue::new(kind.name()).aliases(kind.aliases().iter().copied()));
    PossibleValuesParser::new(names).try_map(|name| EstimatorKind::parse(&name).ok_or("not in the list"))
}

/// Reads a set of columns: `rigid`, or `rigid` and names of torque terms joined by `+`.
pub(crate) fn columns(text: &str) -> Result<Columns, String> {
    Columns::parse_estimable(text).map_err(|fault| fault.to_string())
}
