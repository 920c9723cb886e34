//! The entries of equations of like samples, as columns to be condensed into few rows.

use std::ops::Range;

use nalgebra::DMatrix;

use super::observation::Observation;
use crate::linalg::{ColumnProducts, RowFactor};

/// Groups of more samples than this many times their columns are replaced by their factor.
const WORTH_FACTORING: usize = 2;
/// Groups of more samples than this many times their columns are worth the check of what products of the columns lose.
const WORTH_PRODUCTS: usize = 16;

/// Samples whose entries are looked at together.
const AT_ONCE: usize = 8;

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

/// Samples that follow each other, as they mostly do.
fn in_a_row(samples: &[usize]) -> Option<Range<usize>> {
    let (&first, &last) = (samples.first()?, samples.last()?);
    (last - first + 1 == samples.len()).then_some(first..last + 1)
}

/// Whether any entry of each joint is not zero, in a column of `dof` rows for each sample: all but the signs of many samples at once.
fn are_loaded(column: &[f64], dof: usize) -> Vec<bool> {
    let mut bits = vec![0; AT_ONCE * dof];
    let is_set = |i: usize, bits: &[u64]| bits.iter().skip(i).step_by(dof).any(|bits| *bits != 0);
    for samples in column.chunks(64 * bits.len()) {
        for samples in samples.chunks(bits.len()) {
            bits.iter_mut().zip(samples).for_each(|(bits, entry)| *bits |= entry.to_bits() << 1);
        }
        if (0..dof).all(|i| is_set(i, &bits)) {
            break;
        }
    }
    (0..dof).map(|i| is_set(i, &bits)).collect()
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
        let seen = |column: &'a [f64]| match in_a_row(samples) {
            Some(samples) => are_loaded(&column[samples.start * n..samples.end * n], n),
            None => (0..n).map(|i| samples.iter().any(|&k| column[k * n + i] != 0.0)).collect(),
        };
        let seen: Vec<bool> = w.as_slice().chunks_exact(rows.max(1)).flat_map(seen).collect();
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
        let (distinct, alike) = self.distinct();
        let (mut products, n) = (ColumnProducts::new(distinct.len()), self.sizes.0);
        match in_a_row(self.samples) {
            Some(samples) => products.add(samples.len(), |column, rows| {
                let source = &self.sources[distinct[column]][(samples.start + rows.start) * n..];
                source.chunks(n).take(rows.len()).map(|sample| sample[0])
            }),
            None => products.add(self.samples.len(), |column, rows| {
                let entry = distinct[column];
                rows.map(move |k| self.at(k, entry))
            }),
        }
        let root = products.root()?;
        Some(self.rows(root.nrows(), |k, entry| root[(k, alike[entry])]))
    }

    /// The entries that differ from each other, and which of them each is: joints on parallel axes carry the inertia of a link alike. The
    /// joints of a column follow each other, so that it is read while it is in a cache.
    fn distinct(&self) -> (Vec<usize>, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.places.len()).collect();
        order.sort_by_key(|&entry| self.places[entry].1);
        let (mut distinct, mut alike): (Vec<usize>, _) = (Vec::new(), vec![0; order.len()]);
        let are_alike = |a: usize, b: usize| {
            self.places[a].1 == self.places[b].1 && (0..self.samples.len()).all(|k| self.at(k, a) == self.at(k, b))
        };
        for entry in order {
            if !distinct.last().is_some_and(|&last| are_alike(last, entry)) {
                distinct.push(entry);
            }
            alike[entry] = distinct.len() - 1;
        }
        (distinct, alike)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::tests::a460_samples;

    #[test]
    fn identity_products_of_columns_that_differ_are_those_by_reflections() {
        let (robot, _, regressor, base, samples) = a460_samples(3500);
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let (n, used) = (observation.dof, [true; 6]);
        let all: Vec<usize> = (0..observation.samples()).collect();
        // The second is of samples that do not follow each other.
        for samples in [all.clone(), all.into_iter().filter(|k| k % 10 != 3).collect()] {
            let entries = Entries::of(&observation, &used, &samples);
            let (distinct, alike) = entries.distinct();
            // Axes 2 and 3 are parallel: five columns of the inertia of each link after them.
            assert_eq!(alike.len() - distinct.len(), 20);
            for (entry, &column) in alike.iter().enumerate() {
                assert_eq!(entries.places[distinct[column]].1, entries.places[entry].1);
            }
            let (found, expected) = (entries.rows_by_products().unwrap(), entries.rows_by_reflections());
            // Products of all pairs of joints.
            let products = |rows: &DMatrix<f64>, i: usize, j: usize| {
                let of = |joint: usize| {
                    DMatrix::from_fn(rows.nrows() / n, rows.ncols(), |k, column| rows[(k * n + joint, column)])
                };
                of(i).tr_mul(&of(j))
            };
            let squares: Vec<_> = (0..n).map(|i| products(&expected, i, i)).collect();
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let (found, expected) = (products(&found, i, j), products(&expected, i, j));
                for (a, b) in (0..found.nrows()).flat_map(|a| (0..found.ncols()).map(move |b| (a, b))) {
                    let size = (squares[i][(a, a)] * squares[j][(b, b)]).sqrt();
                    assert!((found[(a, b)] - expected[(a, b)]).abs() <= 1e-12 * size, "joints {i} {j}, {a} {b}");
                }
            }
        }
    }
}
