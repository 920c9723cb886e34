//! Which columns of a log mean what: what `--map` and a `[log]` table say.
//!
//! ```text
//! t=time_ms, q=joint_[1-6]_pos deg, current=actual_current_[1-6] mA
//! t = column unit
//! q = [file:]columns [unit] [motor] [gear=…] [sign=…] [offset=…|offset_deg=…|offset_rad=…]
//! q_cmd = [file:]columns [unit] [sign=…] [offset=…] kp=… kd=… [delay_ms=…] [unknown=…]
//! ```
//! Columns are headings, with `[1-6]` for the numbers of the joints (`[01-06]` with zeros in front), or `#2` for the second
//! column; several stand with `/` between them: `#1/#3/#2`, `base/shoulder/elbow`. Values that differ from joint to joint do
//! as well: `gear=32/32/45/-48/45/32`. Of joint states of ROS 2 the columns are the names of joints, and
//! `topic=/arm/joint_states` says which are meant.

mod column_map;
mod columns;
mod corrected;
mod quantity;
mod text;
mod unit;

pub use column_map::ColumnMap;
pub(crate) use columns::listed;
pub(crate) use corrected::corrected;
pub use quantity::Quantity;
pub use text::Mapping;
pub use unit::Unit;
