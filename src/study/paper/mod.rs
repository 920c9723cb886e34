//! The paper's claims, one function each, examined in simulation; and its Table II beside what armid finds.
//!
//! Each claim becomes a quantity with its sample size and, where it is statistical, an interval. The verdict follows
//! from the numbers by a rule that stands in the code, so that a report cannot say more than was measured.

mod claim;
mod examination;
mod table;

pub use claim::{Claim, Quantity, Verdict};
pub use examination::{Performer, examine};
pub use table::{TableLine, compare_with_table_two};
