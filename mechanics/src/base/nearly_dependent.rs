//! What a reduction says of columns that it left out.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a reduction left out because no torque sensor would see it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NearlyDependent {
    /// Parameters that structure alone would keep, by their names.
    pub parameters: Vec<String>,
    /// Rank by structure alone.
    pub structural_rank: usize,
    /// The fraction at or below which a column is left out.
    pub tolerance: f64,
}

impl fmt::Display for NearlyDependent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the geometry is nearly special: {} would be base parameters, but over random states their columns differ from \
             the others by less than {:.0e}; they are left out",
            self.parameters.join(", "),
            self.tolerance
        )
    }
}
