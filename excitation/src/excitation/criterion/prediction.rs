//! What predicted torque is judged by, where a criterion asks what the estimate is for.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

/// Evaluation motions as a criterion sees them, for b base parameters and E discrepancies of what the model leaves out.
///
/// ```text
/// G = (1/(n N)) Σ_k Y_b(k)ᵀ Λ Y_b(k)        ‖ΔT‖² = βᵀ G β        Λ = diag(weights)², n joints, N evaluation samples
/// ```
/// `βᵀ G β` is the mean square of the torque that an error β of the parameters makes there, (N·m)².
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// G, b × b.
    pub gram: DMatrix<f64>,
    /// Torque rows of the whole experiment, of which each has the noise that M is weighted by.
    pub rows: f64,
    /// The discrepancies of each effect that is expected, by their numbers.
    pub effects: Vec<Range<usize>>,
    /// What of the discrepancies the estimate is to carry; nothing where it is to be that of the arm without them.
    pub carried: Option<Carried>,
}

/// Discrepancies on the evaluation motions, where the estimate is to predict torque with them.
///
/// ```text
/// h_e = (1/(n N)) Σ_k Y_b(k)ᵀ Λ d_e(k)        s_e = (1/(n N)) Σ_k d_e(k)ᵀ Λ d_e(k)
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// h, b × E.
    pub moments: DMatrix<f64>,
    /// s, E.
    pub squares: DVector<f64>,
}
