//! Tables of numbers: CSV with one heading per column, and Parquet.

mod number_table;
mod parquet_table;
mod states_csv;

pub(crate) use number_table::NumberTable;
pub(crate) use parquet_table::{Column, ParquetTable};
pub use states_csv::{Third, parse as parse_states};
