//! Limits that are smooth functions of the variables.

use super::row::Row;
use super::vectors::axpy;

/// Limits that are smooth functions of the variables.
pub trait SmoothLimits {
    /// Sum over limits of the worst excess of each, 0 where all hold.
    fn excess(&mut self, x: &[f64]) -> f64;

    /// Rows of those limits that are nearly active at `x`: `∇c_rᵀ d ≤ −c_r`.
    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>);
}

/// A smooth limit around a point, and which one it is.
#[derive(Clone, Debug)]
pub struct SmoothRow {
    /// `∇c_rᵀ d ≤ −c_r`.
    pub row: Row,
    /// Number of the limit among those of its kind.
    pub limit: usize,
    /// When it is nearest to being reached, in periods: a limit may have several such times, and they move with the
    /// variables.
    pub at: f64,
}

/// Several kinds of smooth limits at once.
#[derive(Default)]
pub struct CombinedLimits {
    /// Each kind.
    pub limits: Vec<Box<dyn SmoothLimits>>,
}

impl SmoothLimits for CombinedLimits {
    fn excess(&mut self, x: &[f64]) -> f64 {
        self.limits.iter_mut().map(|limits| limits.excess(x)).sum()
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
        let kinds = self.limits.len();
        for (kind, limits) in self.limits.iter_mut().enumerate() {
            let first = rows.len();
            limits.linearise(x, rows);
            for row in &mut rows[first..] {
                row.limit = row.limit * kinds + kind;
            }
        }
    }
}

/// How far the time of a limit may move in one step to count as the same, in periods.
const FOLLOWED: f64 = 0.05;

impl SmoothRow {
    /// Adds to `sum` how this limit's gradient has changed on the way to the point of `rows`, times a multiplier; nothing
    /// where it is no longer near.
    pub(super) fn add_gradient_change(&self, rows: &[Self], multiplier: f64, sum: &mut [f64]) {
        let away = |row: &Self| (row.at - self.at).abs();
        let same = rows.iter().filter(|row| row.limit == self.limit && away(row) < FOLLOWED);
        if let Some(now) = same.min_by(|x, y| away(x).total_cmp(&away(y))) {
            axpy(multiplier, &now.row.normal, sum);
            axpy(-multiplier, &self.row.normal, sum);
        }
    }
}

/// The largest sum of the multipliers of one limit: above it the excess of a limit, the worst of its rows, costs more than
/// it gains.
pub(super) fn largest_of_limits(active: &[(SmoothRow, f64)]) -> f64 {
    let of_limit = |limit: usize| -> f64 {
        active.iter().filter(|(row, _)| row.limit == limit).map(|(_, multiplier)| multiplier).sum()
    };
    active.iter().map(|(row, _)| of_limit(row.limit)).fold(0.0, f64::max)
}

/// The rows around `x`.
pub(super) fn linearised(smooth: &mut dyn SmoothLimits, x: &[f64]) -> Vec<SmoothRow> {
    let mut rows = Vec::new();
    smooth.linearise(x, &mut rows);
    rows
}
