//! Tables of numbers: CSV with one heading per column, and Parquet.

mod dialect;
mod foreign_table;
mod line_length;
mod number_table;
mod parquet_file;
mod states_csv;

pub(crate) use dialect::Separator;
pub(crate) use foreign_table::ForeignTable;
pub(crate) use parquet_file::{Cell, Kind, ParquetFile};
pub use states_csv::{Third, parse as parse_states};
