//! What a study stores of the reproduction.

use super::claim::Claim;
use super::table_two_comparison::TableLine;

/// The claims of `radkhah2007` and its Table II, as evaluated in a study.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reproduction {
    /// One entry per claim.
    pub claims: Vec<Claim>,
    /// One line per base parameter of the rigid arm.
    pub table: Vec<TableLine>,
}
