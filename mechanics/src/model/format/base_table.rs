//! The part of `robot.toml` that says where the base stands.

use serde::Deserialize;

use super::error::FormatError;
use super::reading::{Check, Row, roll_pitch_yaw};
use crate::spatial::Placement;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BaseTable {
    position_m: Option<Row>,
    roll_pitch_yaw_deg: Option<Row>,
}

/// Pose of the base frame in the world.
pub(super) fn read_base(check: Check<'_>, table: &BaseTable) -> Result<Placement, FormatError> {
    let mut base = Placement::identity();
    if let Some(row) = &table.position_m {
        base.translation = check.vector("position_m", row)?;
    }
    if let Some(row) = &table.roll_pitch_yaw_deg {
        base.rotation = roll_pitch_yaw(check.numbers("roll_pitch_yaw_deg", row)?);
    }
    Ok(base)
}
