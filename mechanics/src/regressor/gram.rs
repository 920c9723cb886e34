//! Normal equations of many samples, whose regressor is never held.
//!
//! ```text
//! WᵀW = Σ_i w_i Σ_k y_kiᵀ y_ki        Wᵀτ = Σ_i w_i Σ_k y_kiᵀ τ_ki        y_ki: row i of Y at sample k
//! ```
//! Column by column, over the joints that both columns load: a link loads the joints up to its own, so that half of the products
//! are never made. Each entry is summed in eight running sums, sample k in sum k mod 8, the same bits on any processor.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use pulp::Arch;

use super::cells::Cells;
use super::joint_torque::JointTorqueRegressor;
use crate::dynamics::{TOGETHER, samples_of};
use crate::linalg::Gram;
use crate::linalg::column_products::{Line, Products, Run};

/// Lines of eight samples that are held of each joint and column before they are multiplied.
const DEPTH: usize = 8;

impl JointTorqueRegressor {
    /// `Σ w YᵀY`, `Σ w Yᵀτ` and `Σ w τ²` over all samples, for these columns of Y. `q`, `qd`, `qdd` and `torque` are N × n row-major, the
    /// last in N·m, and there is one weight of each joint (n), not below zero.
    ///
    /// # Panics
    /// If the arrays are not as long as each other or not those of whole samples, there is not one weight per joint, or a column is
    /// beyond p.
    pub fn gram(&self, samples: [&[f64]; 3], columns: &[usize], torque: &[f64], weights: &[f64]) -> Gram {
        let n = self.rows();
        let expected = (samples_of(n, samples) * n, n);
        assert_eq!((torque.len(), weights.len()), expected, "one torque per joint and sample, one weight per joint");
        let mut sums = Sums::new(columns.len(), weights);
        let mut cells = Cells::in_columns(self, columns, DEPTH);
        self.stack_by(&mut cells, samples, 1, |cells, first, count| {
            cells.put_last(&torque[first * n..(first + count) * n]);
            sums.take(cells, count);
        });
        sums.finish(cells, torque.len())
    }
}

/// The sums over the samples so far.
struct Sums {
    /// Columns, the torque being the last.
    width: usize,
    /// Square roots of the joints' weights.
    roots: Vec<f64>,
    /// From the first to the last joint that each column was seen to load.
    spans: Vec<Range<usize>>,
    /// `row · width + column`, upper triangle.
    sums: Vec<Line>,
}

impl Sums {
    fn new(columns: usize, weights: &[f64]) -> Self {
        let (width, zero) = (columns + 1, Line::ZERO);
        let roots = weights.iter().map(|weight| weight.sqrt()).collect();
        Self { width, roots, spans: vec![0..0; width], sums: vec![zero; width * width] }
    }

    /// The line of every cell, of which `count` samples are there.
    fn take(&mut self, cells: &mut Cells<'_>, count: usize) {
        if count < TOGETHER {
            for cell in &cells.touched {
                cells.sums[cell.index + cells.line].0[count..].fill(0.0);
            }
        }
        cells.line += 1;
        if cells.line == DEPTH {
            self.add(cells);
        }
    }

    /// Adds the products of all lines.
    fn add(&mut self, cells: &mut Cells<'_>) {
        for cell in &cells.touched {
            let lines = &mut cells.sums[cell.index..][..DEPTH];
            lines[cells.line..].fill(Line::ZERO);
            let root = self.roots[cell.joint];
            if root != 1.0 {
                lines.iter_mut().flat_map(|line| &mut line.0).for_each(|entry| *entry *= root);
            }
            let (joint, span) = (cell.joint, &mut self.spans[cell.place]);
            if !span.contains(&joint) && lines.iter().any(|line| line.0 != Line::ZERO.0) {
                *span = if span.start == span.end {
                    joint..joint + 1
                } else {
                    span.start.min(joint)..span.end.max(joint + 1)
                };
            }
        }
        cells.line = 0;
        let spans = self.spans.iter().enumerate().filter(|(_, span)| !span.is_empty());
        let run = |(place, span): (usize, &Range<usize>)| Run { place, lines: span.start * DEPTH..span.end * DEPTH };
        let runs: Vec<Run> = spans.map(run).collect();
        let (held, stride) = (&cells.sums, cells.strides[1]);
        Arch::new().dispatch(Products { runs: &runs, held, stride, width: self.width, sums: &mut self.sums });
    }

    fn finish(mut self, mut cells: Cells<'_>, rows: usize) -> Gram {
        if cells.line > 0 {
            self.add(&mut cells);
        }
        let b = self.width - 1;
        let entry = |i: usize, j: usize| self.sums[i * self.width + j].sum();
        let upper = DMatrix::from_fn(b, b, |i, j| if i <= j { entry(i, j) } else { 0.0 });
        Gram { upper, moment: DVector::from_fn(b, |i, _| entry(i, b)), energy: entry(b, b), rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::dynamics::States;
    use crate::model::Columns;
    use crate::model::term::LOAD_FRICTION;
    use crate::seed::Seed;

    #[test]
    fn identity_normal_equations_are_those_of_the_stack() {
        for run in 0..9 {
            let dof = 1 + usize::try_from(run).unwrap();
            let mut rng = Seed::new(15).stream("gram", run);
            let (robot, parameters) = ChainRecipe { coupled: run % 2 == 0, ..ChainRecipe::new(dof) }.draw(&mut rng);
            let columns = Columns::RIGID_ROTOR_FRICTION;
            let free = JointTorqueRegressor::new(&robot, columns).unwrap();
            let loaded = JointTorqueRegressor::with_load(&robot, columns.with_term(LOAD_FRICTION), &parameters);
            for (regressor, count) in [(free, 150), (loaded, 67)] {
                let mut states = States::new(dof);
                for _ in 0..count {
                    let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                    states.push(&q, &qd, &qdd);
                }
                let wanted: Vec<usize> = (0..regressor.cols()).filter(|column| column % 7 != 3).collect();
                let torque: Vec<f64> = (0..dof * count).map(|row| libm::sin((row * row) as f64)).collect();
                let weights: Vec<f64> = (0..dof).map(|joint| (joint + 1) as f64 / 2.0).collect();
                let gram = regressor.gram(states.arrays(), &wanted, &torque, &weights);
                let mut w = regressor.stack_means(&states, &wanted, 1);
                let mut y = DVector::from_vec(torque);
                for (row, (mut w, y)) in w.row_iter_mut().zip(y.iter_mut()).enumerate() {
                    w *= weights[row % dof].sqrt();
                    *y *= weights[row % dof].sqrt();
                }
                let size = w.norm_squared();
                assert!((gram.information() - w.tr_mul(&w)).amax() < 1e-13 * size, "{dof} joints");
                assert!((&gram.moment - w.tr_mul(&y)).amax() < 1e-13 * (size * y.norm_squared()).sqrt());
                assert!((gram.energy - y.norm_squared()).abs() < 1e-12 * y.norm_squared().max(1e-300));
                assert_eq!(gram.rows, dof * count);
            }
        }
    }
}
