//! What multiple shooting varies, and what it sees of one interval.

use nalgebra::{DMatrix, DVector};

/// Parameters, and the state at each node.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point {
    /// β, b.
    pub(super) beta: DVector<f64>,
    /// x_j, s each.
    pub(super) nodes: Vec<DVector<f64>>,
}

impl Point {
    /// The point that a step leads to.
    pub(super) fn moved_by(&self, step: &Self) -> Self {
        let nodes = self.nodes.iter().zip(&step.nodes).map(|(x, step)| x + step).collect();
        Self { beta: &self.beta + &step.beta, nodes }
    }
}

/// One interval of a motion, linearised.
#[derive(Clone, Debug)]
pub(super) struct Interval {
    /// y_j − f_j(x_j, β); rows of outputs in turn.
    pub(super) residual: DVector<f64>,
    /// ∂f_j/∂x_j.
    pub(super) by_state: DMatrix<f64>,
    /// ∂f_j/∂β.
    pub(super) by_parameters: DMatrix<f64>,
    /// What continues in the next interval; none at the end of a recording.
    pub(super) end: Option<End>,
}

/// The end of an interval.
#[derive(Clone, Debug)]
pub(super) struct End {
    /// F_j(x_j, β), s.
    pub(super) state: DVector<f64>,
    /// ∂F_j/∂x_j, s × s.
    pub(super) by_state: DMatrix<f64>,
    /// ∂F_j/∂β, s × b.
    pub(super) by_parameters: DMatrix<f64>,
}

/// What counts how much.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// Of each output, 1/σ.
    pub(super) outputs: DVector<f64>,
    /// Of each number of a gap between two intervals.
    pub(super) gap: DVector<f64>,
    /// Of each number of a gap in the lengths that steps are damped by: not so heavy that damping holds what the gaps leave free.
    pub(super) light_gap: DVector<f64>,
}

impl Interval {
    /// `x_{j+1} − F_j`, where the interval continues.
    pub(super) fn gap(&self, next: Option<&DVector<f64>>) -> Option<DVector<f64>> {
        Some(next? - &self.end.as_ref()?.state)
    }

    /// Weighted squares of residuals and of gaps.
    pub(super) fn squares(&self, next: Option<&DVector<f64>>, weights: &Weights) -> (f64, f64) {
        let outputs = weights.outputs.len();
        let of_residual = self.residual.iter().enumerate().map(|(row, r)| r * weights.outputs[row % outputs]);
        let of_gap = self.gap(next).map_or(0.0, |gap| gap.component_mul(&weights.gap).norm_squared());
        (of_residual.map(|r| r * r).sum(), of_gap)
    }
}
