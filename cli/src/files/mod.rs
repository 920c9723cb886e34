//! The files that the command reads and writes.

pub(crate) mod number_table;
pub(crate) mod states_csv;
pub(crate) mod trajectory;
