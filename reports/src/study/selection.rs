//! What figures show where a study holds more than one figure can.

/// Families of designs that a figure can distinguish by colour.
pub(super) const GROUPS: usize = 8;
