//! Getting inside limits: of a step's program, and of a point without a look at the objective.

use nalgebra::DMatrix;

use super::error::QuadraticError;
use super::quadratic::{QuadraticSolution, solve_quadratic};
use super::row::{LinearLimits, Row, RowSource};
use super::smooth::{SmoothLimits, SmoothRow, linearised};

/// Steps towards the inside before it counts as out of reach.
const STEPS: usize = 8;

/// Parts of the way into the smooth limits that are asked for, one after the other, where the linear ones do not allow more.
const PARTS: [f64; 3] = [1.0, 0.5, 0.0];

/// A point inside all limits near `x` (n), by steps that are each the shortest:
///
/// ```text
/// d = argmin ½ |d|²    subject to   x + d inside the linear limits,   c_r(x) + ∇c_r(x)ᵀ d ≤ 0        x ← x + d
/// ```
/// One step at least, and more until the excess of the smooth limits is `tolerance` at most: from nearly inside two or three. `None`
/// where a few do not reach that. The point is the nearest one to first order.
pub fn nearest_inside(
    x: &[f64],
    linear: &mut dyn LinearLimits,
    smooth: &mut dyn SmoothLimits,
    tolerance: f64,
) -> Option<Vec<f64>> {
    let n = x.len();
    let (even, still) = (DMatrix::identity(n, n), vec![0.0; n]);
    let mut x = x.to_vec();
    for _ in 0..STEPS {
        linear.recenter(&x);
        let rows = linearised(smooth, &x);
        let solution = solve_relaxed(&even, &still, Vec::new(), &rows, linear).ok()?;
        for (x, d) in x.iter_mut().zip(&solution.step) {
            *x += d;
        }
        if smooth.excess(&x) <= tolerance {
            return Some(x);
        }
    }
    None
}

/// [`solve_quadratic`] under smooth limits around a point and linear ones; where these contradict each other, the smooth ones
/// are asked for less.
pub(super) fn solve_relaxed(
    inverse: &DMatrix<f64>,
    gradient: &[f64],
    warm: Vec<Row>,
    smooth: &[SmoothRow],
    linear: &mut dyn LinearLimits,
) -> Result<QuadraticSolution, QuadraticError> {
    let mut solution = Err(QuadraticError::Infeasible { excess: f64::INFINITY });
    for part in PARTS {
        let rows = smooth.iter().map(|SmoothRow { row, .. }| {
            let bound = if row.bound < 0.0 { part * row.bound } else { row.bound };
            Row { bound, ..row.clone() }
        });
        let mut source = Both { smooth: rows.collect(), linear };
        solution = solve_quadratic(inverse, gradient, warm.clone(), &mut source);
        if !matches!(solution, Err(QuadraticError::Infeasible { .. })) {
            break;
        }
    }
    solution
}

/// The rows of both kinds of limits.
pub(super) struct Both<'a> {
    pub(super) smooth: Vec<Row>,
    pub(super) linear: &'a mut dyn LinearLimits,
}

impl RowSource for Both<'_> {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        let tolerance = |row: &Row| 1e-9 * (1.0 + row.bound.abs());
        rows.extend(self.smooth.iter().filter(|row| row.excess(step) > tolerance(row)).cloned());
        self.linear.violated(step, rows);
    }
}
