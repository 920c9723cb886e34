//! Weights of the regressor's entries, for gradients of a few samples at once.
//!
//! ```text
//! g_ic, n × p for each sample        L = Σ_ic g_ic Y_ic
//! ```

use super::stack::BLOCKS_OF_PART;
use crate::linalg::column_products::Line;

/// Weights at a few samples: a line holds those of one entry, sample by sample.
#[derive(Debug)]
pub struct PartWeights {
    /// Number of the first sample.
    pub first: usize,
    /// Number of samples, at most [`BLOCKS_OF_PART`].
    pub count: usize,
    columns: usize,
    lines: Vec<Line>,
}

impl PartWeights {
    /// Zeros, for n rows and p columns.
    pub(super) fn new(n: usize, p: usize) -> Self {
        Self { first: 0, count: 0, columns: p, lines: vec![Line::ZERO; n * p] }
    }

    /// Goes on with sample `first` of `all`.
    pub(super) fn begin(&mut self, first: usize, all: usize) {
        self.first = first;
        self.count = BLOCKS_OF_PART.min(all - first);
    }

    /// The line at a place of the n × p.
    #[inline(always)]
    pub(super) fn line(&self, place: usize) -> &[f64; BLOCKS_OF_PART] {
        &self.lines[place].0
    }

    /// The weights of row `joint` and column `column`, to be written. Those beyond the last sample mean nothing.
    ///
    /// # Panics
    /// If there is no such joint or column.
    #[inline(always)]
    pub fn line_mut(&mut self, joint: usize, column: usize) -> &mut [f64; BLOCKS_OF_PART] {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        &mut self.lines[joint * self.columns + column].0
    }

    /// Writes all weights of one sample, n × p row-major; `sample` counts from the part's first.
    ///
    /// # Panics
    /// If `sample` is not below [`BLOCKS_OF_PART`].
    pub fn put_sample(&mut self, sample: usize, g: &[f64]) {
        for (line, &weight) in self.lines.iter_mut().zip(g) {
            line.0[sample] = weight;
        }
    }

    /// Reads the weights of one sample in the columns from `start` on, row-major.
    pub(super) fn sample(&self, sample: usize, start: usize, g: &mut [f64]) {
        let rows = self.lines.chunks_exact(self.columns).map(|row| &row[start..]);
        for (to, line) in g.iter_mut().zip(rows.flatten()) {
            *to = line.0[sample];
        }
    }
}
