//! One step over all nodes and parameters.
//!
//! ```text
//! [ −W G_j   W I   −W H_j ] [ δx_j     ]   [ −W c_j ]        c_j = x_{j+1} − F_j
//! [  J_x      0      J_β  ] [ δx_{j+1} ] = [   r_j  ]
//! [ √μ D_x    0       0   ] [ δβ       ]   [    0   ]
//! ```
//! Rows of an interval, and what the intervals before it leave of x_j and β, are reflected into a triangle whose first s rows give
//! δx_j; the others belong to the next interval. The damping is Levenberg and Marquardt's, over nodes and parameters alike, with D the
//! lengths of columns where gaps are weighed lightly: what moves all intervals together is not held by the weight of gaps.

use nalgebra::{DMatrix, DVector};

use super::interval::{Interval, Point, Weights};
use crate::linalg::{RowFactor, solve_upper};

/// Lengths of columns are at least this: what nothing depends on stays where it is.
const LEAST: f64 = 1e-100;

/// The step that solves the linear equations with damping μ > 0.
pub(super) fn step(point: &Point, intervals: &[Interval], weights: &Weights, damping: f64) -> Point {
    let (b, s) = (point.beta.len(), weights.gap.len());
    let root = damping.sqrt();
    let mut lengths = DVector::zeros(b);
    let mut triangles: Vec<DMatrix<f64>> = Vec::with_capacity(intervals.len());
    // What is left of β once all nodes of a recording are eliminated: b + 1 columns.
    let mut of_parameters = RowFactor::new(b + 1);
    // Of x_j and β, within a recording: s + b + 1 columns.
    let mut carried: Option<DMatrix<f64>> = None;
    for (j, interval) in intervals.iter().enumerate() {
        let equations = Equations::of(interval, point.nodes.get(j + 1), weights);
        let (of_state, of_beta) = squares_of_columns(interval, weights);
        lengths += of_beta;
        let next = if interval.end.is_some() { s } else { 0 };
        let columns = s + next + b + 1;
        let mut factor = RowFactor::new(columns);
        // The heaviest rows first.
        equations.add_to(&mut factor, next);
        if let Some(carried) = &carried {
            // Columns of x_{j+1} are not among those that are carried.
            factor.add(carried.nrows(), |row, column| match column {
                _ if column < s => carried[(row, column)],
                _ if column < s + next => 0.0,
                _ => carried[(row, column - next)],
            });
        }
        let damped: Vec<f64> = of_state.iter().map(|square| root * square.sqrt().max(LEAST)).collect();
        factor.add(s, |row, column| if row == column { damped[row] } else { 0.0 });
        let triangle = factor.finish();
        let rest = triangle.view((s, s), (columns - s, columns - s)).into_owned();
        carried = if interval.end.is_some() {
            Some(rest)
        } else {
            of_parameters.add(rest.nrows(), |row, column| rest[(row, column)]);
            None
        };
        triangles.push(triangle);
    }
    let damped: Vec<f64> = lengths.iter().map(|square: &f64| root * square.sqrt().max(LEAST)).collect();
    of_parameters.add(b, |row, column| if row == column { damped[row] } else { 0.0 });
    let last = of_parameters.finish();
    let beta = solve_upper(&last.view((0, 0), (b, b)).into_owned(), &last.column(b).rows(0, b).into_owned());
    let mut nodes: Vec<DVector<f64>> = vec![DVector::zeros(s); intervals.len()];
    for j in (0..intervals.len()).rev() {
        let triangle = &triangles[j];
        let known = match intervals[j].end {
            Some(_) => DVector::from_iterator(s + b, nodes[j + 1].iter().chain(beta.iter()).copied()),
            None => beta.clone(),
        };
        let top = triangle.rows(0, s);
        let right = top.column(s + known.len()) - top.columns(s, known.len()) * known;
        nodes[j] = solve_upper(&top.columns(0, s).into_owned(), &right);
    }
    Point { beta, nodes }
}

/// Squared lengths of the columns of x_j and of β, gaps weighed lightly.
fn squares_of_columns(interval: &Interval, weights: &Weights) -> (DVector<f64>, DVector<f64>) {
    let of = |residuals: &DMatrix<f64>, gaps: Option<&DMatrix<f64>>| {
        DVector::from_fn(residuals.ncols(), |k, _| {
            let of_residuals = residuals.column(k);
            let weighted =
                of_residuals.iter().enumerate().map(|(row, x)| x * weights.outputs[row % weights.outputs.len()]);
            let of_gaps = gaps.map_or(0.0, |gaps| gaps.column(k).component_mul(&weights.light_gap).norm_squared());
            weighted.map(|x| x * x).sum::<f64>() + of_gaps
        })
    };
    let end = interval.end.as_ref();
    (
        of(&interval.by_state, end.map(|end| &end.by_state)),
        of(&interval.by_parameters, end.map(|end| &end.by_parameters)),
    )
}

/// Weighted rows of one interval: its gap's, then its residual's.
struct Equations {
    by_state: DMatrix<f64>,
    by_next: DVector<f64>,
    by_parameters: DMatrix<f64>,
    right: DVector<f64>,
}

impl Equations {
    fn of(interval: &Interval, next: Option<&DVector<f64>>, weights: &Weights) -> Self {
        let (s, b, m) = (weights.gap.len(), interval.by_parameters.ncols(), interval.residual.len());
        let g = if interval.end.is_some() { s } else { 0 };
        let mut own = Self {
            by_state: DMatrix::zeros(g + m, s),
            by_next: weights.gap.clone(),
            by_parameters: DMatrix::zeros(g + m, b),
            right: DVector::zeros(g + m),
        };
        if let (Some(end), Some(gap)) = (&interval.end, interval.gap(next)) {
            for row in 0..g {
                let w = weights.gap[row];
                own.by_state.set_row(row, &(end.by_state.row(row) * -w));
                own.by_parameters.set_row(row, &(end.by_parameters.row(row) * -w));
                own.right[row] = -w * gap[row];
            }
        }
        for row in 0..m {
            let w = weights.outputs[row % weights.outputs.len()];
            own.by_state.set_row(g + row, &(interval.by_state.row(row) * w));
            own.by_parameters.set_row(g + row, &(interval.by_parameters.row(row) * w));
            own.right[g + row] = w * interval.residual[row];
        }
        own
    }

    /// Columns x_j, x_{j+1} (`next` of them), β, right side.
    fn add_to(&self, factor: &mut RowFactor, next: usize) {
        let (s, b) = (self.by_state.ncols(), self.by_parameters.ncols());
        factor.add(self.right.len(), |row, column| match column {
            _ if column < s => self.by_state[(row, column)],
            _ if column < s + next => {
                if row == column - s {
                    self.by_next[row]
                } else {
                    0.0
                }
            }
            _ if column < s + next + b => self.by_parameters[(row, column - s - next)],
            _ => self.right[row],
        });
    }
}
