//! Tables of numbers: text with or without headings, columns by name, and Parquet.

mod column_table;
mod dialect;
mod foreign_table;
mod line_length;
mod log_table;
mod number_table;
mod parquet_file;
mod states_csv;

pub(crate) use column_table::{ColumnTable, MOST_COLUMNS};
use dialect::Separator;
use foreign_table::ForeignTable;
pub(crate) use log_table::LogTable;
pub(crate) use parquet_file::{Cell, Kind, ParquetFile};
pub use states_csv::{Third, parse as parse_states};
