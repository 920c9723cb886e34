//! The entries of equations of like samples, as columns to be condensed into few rows.

use nalgebra::DMatrix;

use super::observation::Observation;
use crate::linalg::{ColumnProducts, RowFactor};

/// Groups of more samples than this many times their columns are replaced by their factor.
const WORTH_FACTORING: usize = 2;
/// Groups of more samples than this many times their columns are worth the check of what products of the columns lose.
const WORTH_PRODUCTS: usize = 16;

/// Entries of column j in the rows of joint i, from a matrix whose rows are `dof` joints of each sample.
pub(super) fn joint_entries(w: &DMatrix<f64>, dof: usize, i: usize, j: usize) -> impl Iterator<Item = f64> {
    w.as_slice()[j * w.nrows()..(j + 1) * w.nrows()].iter().skip(i).step_by(dof).copied()
}

/// Writes these entries, as many as there are places.
pub(super) fn put_joint_entries(w: &DMatrix<f64>, dof: usize, i: usize, j: usize, to: &mut [f64]) {
    for (to, sample) in to.iter_mut().zip(w.as_slice()[j * w.nrows()..(j + 1) * w.nrows()].chunks_exact(dof)) {
        *to = sample[i];
    }
}

/// The columns of the joints of a group that are not zero, joint by joint, each with its torque last.
pub(super) struct Entries<'a> {
    /// Joint and column of each; the torque's column is b.
    places: Vec<(usize, usize)>,
    /// Each from its joint's first row on.
    sources: Vec<&'a [f64]>,
    samples: &'a [usize],
    /// n and b.
    sizes: (usize, usize),
}

impl<'a> Entries<'a> {
    pub(super) fn of(observation: &'a Observation, used: &[bool], samples: &'a [usize]) -> Self {
        let (n, b, w) = (observation.dof, observation.regressor.ncols(), &observation.regressor);
        let rows = w.nrows();
        // Column by column, so that one stays in a cache for all joints.
        let seen = |column: &[f64], i: usize| used[i] && samples.iter().any(|&k| column[k * n + i] != 0.0);
        let seen: Vec<bool> =
            w.as_slice().chunks_exact(rows.max(1)).flat_map(|column| (0..n).map(move |i| seen(column, i))).collect();
        let places: Vec<(usize, usize)> = (0..n)
            .filter(|&i| used[i])
            .flat_map(|i| (0..b).map(move |j| (i, j)).filter(|(i, j)| seen[j * n + i]).chain([(i, b)]))
            .collect();
        let source = |&(i, j): &(usize, usize)| {
            if j < b { &w.as_slice()[j * rows + i..(j + 1) * rows] } else { &observation.y.as_slice()[i..] }
        };
        Self { sources: places.iter().map(source).collect(), places, samples, sizes: (n, b) }
    }

    /// Whether there are more samples than so many times the columns.
    const fn fill(&self, times: usize) -> bool {
        self.samples.len() > times * self.places.len()
    }

    pub(super) const fn are_worth_products(&self) -> bool {
        self.fill(WORTH_PRODUCTS)
    }

    /// Rounding errors of a product of two columns, as [`ColumnProducts::rounding_errors`] counts them.
    pub(super) fn rounding_errors(&self) -> f64 {
        ColumnProducts::rounding_errors(self.samples.len(), self.places.len())
    }

    fn at(&self, k: usize, entry: usize) -> f64 {
        self.sources[entry][self.samples[k] * self.sizes.0]
    }

    /// Samples whose numbers `of(k, entry)` gives, as rows of an observation.
    fn rows(&self, samples: usize, of: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let (n, b) = self.sizes;
        let mut rows = DMatrix::zeros(n * samples, b + 1);
        for (entry, &(i, j)) in self.places.iter().enumerate() {
            for k in 0..samples {
                rows[(k * n + i, j)] = of(k, entry);
            }
        }
        rows
    }

    pub(super) fn rows_by_reflections(&self) -> DMatrix<f64> {
        if !self.fill(WORTH_FACTORING) {
            return self.rows(self.samples.len(), |k, entry| self.at(k, entry));
        }
        let mut factor = RowFactor::new(self.places.len());
        factor.add(self.samples.len(), |k, entry| self.at(k, entry));
        let factor = factor.finish();
        self.rows(factor.nrows(), |k, entry| factor[(k, entry)])
    }

    /// By products where there are many samples; `None` where those have no root.
    pub(super) fn rows_by_products(&self) -> Option<DMatrix<f64>> {
        if !self.fill(WORTH_PRODUCTS) {
            return Some(self.rows_by_reflections());
        }
        let (mut products, n) = (ColumnProducts::new(self.places.len()), self.sizes.0);
        match self.samples {
            // Mostly they are all, one after the other.
            &[first, .., last] if last - first + 1 == self.samples.len() => {
                let sources: Vec<&[f64]> = self.sources.iter().map(|source| &source[first * n..]).collect();
                products.add(self.samples.len(), |k, entry| sources[entry][k * n]);
            }
            _ => products.add(self.samples.len(), |k, entry| self.at(k, entry)),
        }
        let root = products.root()?;
        Some(self.rows(root.nrows(), |k, entry| root[(k, entry)]))
    }
}
