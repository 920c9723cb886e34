//! Which columns of a log mean what: what `--map` and a `[log]` table say.
//!
//! ```text
//! t=time_ms, q=joint_[1-6]_pos deg, current=actual_current_[1-6] mA
//! t = column unit
//! q = [file:]columns [unit] [motor] [gear=…] [sign=…] [offset=…|offset_deg=…|offset_rad=…]
//! ```
//! Columns are headings, with `[1-6]` for the numbers of the joints, or `#2` for the second column. Values that differ from
//! joint to joint stand with `/` between them: `gear=32/32/45/-48/45/32`.

mod column_map;
mod columns;
mod quantity;
mod text;
mod unit;

pub use column_map::ColumnMap;
pub(crate) use columns::expand;
pub use quantity::Quantity;
pub use text::Mapping;
pub use unit::Unit;
