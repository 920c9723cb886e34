//! When a column counts as zero and when as independent.

/// Two fractions that decide a rank.
///
/// ```text
/// zero:         ‖a_j‖ ≤ zero · max_k ‖a_k‖
/// independent:  ‖(1 − Q Qᵀ) a_j‖ > independent · ‖a_j‖
/// ```
/// Both are relative, and independence is judged on columns of unit length: multiplying a column by any factor that
/// keeps it away from zero changes no decision.
///
/// ```
/// use armid::linalg::RankTolerance;
/// let tolerance = RankTolerance::default();
/// assert!(tolerance.independent == 1e-9 && tolerance.zero == 1e-10);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankTolerance {
    /// A column shorter than this fraction of the longest one is zero.
    pub zero: f64,
    /// A column keeps its place when this fraction of it, or more, is orthogonal to those kept before.
    pub independent: f64,
}

impl Default for RankTolerance {
    /// `independent = 1e-9`, `zero = 1e-10`.
    ///
    /// Rounding leaves a dependent column of a stacked regressor (some thousand rows, some ten terms an entry) with an
    /// orthogonal part of 1e-15 to 1e-13 of its length; independent columns of real arms keep 1e-1 to 1e-4. 1e-9 is
    /// the geometric middle, four decades from either. A zero column is the same rounding without a length to compare
    /// it with, hence against the longest column, with a decade less because units may part the lengths.
    fn default() -> Self {
        Self { zero: 1e-10, independent: 1e-9 }
    }
}
