//! Linear rows `aᵀ d ≤ b`, and where they come from.

use super::vectors::dot;

/// One linear row `aᵀ d ≤ b`; `a` is zero outside `start .. start + normal.len()`.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// First variable with a coefficient.
    pub start: usize,
    /// Coefficients a from there on.
    pub normal: Vec<f64>,
    /// Right-hand side b.
    pub bound: f64,
}

impl Row {
    /// `aᵀ d − b`: positive where the row is violated.
    #[inline(always)]
    pub fn excess(&self, d: &[f64]) -> f64 {
        self.along(d) - self.bound
    }

    /// `aᵀ d`.
    #[inline(always)]
    pub(super) fn along(&self, d: &[f64]) -> f64 {
        dot(&self.normal, &d[self.start..self.start + self.normal.len()])
    }
}

/// Where rows come from.
pub trait RowSource {
    /// Appends rows that `step` violates by more than their tolerance; none means that the step is feasible.
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>);
}

/// Linear limits, possibly infinitely many, as rows around a point.
pub trait LinearLimits: RowSource {
    /// Rows are for steps from `x` from now on.
    fn recenter(&mut self, x: &[f64]);
}
