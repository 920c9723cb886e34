//! The covariance of all samples as an operator, which is never written down as a matrix.
//!
//! ```text
//! (C W)_k = Σ_l R(l) W_k+l        C(k, k+l) = R(l), R(−l) = R(l)ᵀ
//! ```
//! By sums over few lags, by transforms ([`NoiseSpectrum`]) over many.

use nalgebra::{Complex, DMatrix};

use super::noise_spectrum::NoiseSpectrum;
use crate::linalg::product::add_product;

/// Lags up to which sums over lags are faster than transforms.
const FEW_LAGS: usize = 16;

/// C for series of one length.
pub struct CovarianceOperator {
    lags: Vec<DMatrix<f64>>,
    wraps: bool,
    /// The covariance as a spectrum, if there are many lags.
    spectrum: Option<NoiseSpectrum>,
}

impl CovarianceOperator {
    /// For `count` samples with these R(0), R(1), …; `wraps` where they are one period.
    pub(super) fn new(lags: Vec<DMatrix<f64>>, wraps: bool, count: usize) -> Self {
        // Two transforms of some 40 operations a sample are worth as many lags.
        let many = lags.len() > FEW_LAGS + 1 && lags.len() <= count;
        let spectrum = many.then(|| NoiseSpectrum::new(&lags, wraps, count));
        Self { lags, wraps, spectrum }
    }

    /// `C W`, (n·N) × b, sample-major.
    pub fn apply(&self, w: &DMatrix<f64>) -> DMatrix<f64> {
        self.apply_to_columns(w.as_slice(), w.nrows())
    }

    /// The same for columns of `rows` numbers that follow each other; a part of a column at the end is left out.
    pub fn apply_to_columns(&self, columns: &[f64], rows: usize) -> DMatrix<f64> {
        let n = self.lags[0].nrows();
        let (count, columns_of) = (rows / n, columns.chunks_exact(rows.max(1)));
        let mut out = DMatrix::zeros(rows, columns_of.len());
        if let Some(spectrum) = &self.spectrum {
            apply_by_spectrum(spectrum, n, columns, &mut out);
            return out;
        }
        if let [of_sample] = &self.lags[..] {
            // Samples are columns in memory.
            add_product(of_sample.as_slice(), columns, n, out.as_mut_slice());
            return out;
        }
        // One series per joint, so that the inner loop runs over consecutive numbers.
        let (mut from, mut to) = (vec![vec![0.0; count]; n], vec![vec![0.0; count]; n]);
        for (of_column, mut out) in columns_of.zip(out.column_iter_mut()) {
            for (k, sample) in of_column.chunks_exact(n).enumerate() {
                from.iter_mut().zip(sample).for_each(|(series, value)| series[k] = *value);
            }
            to.iter_mut().for_each(|series| series.fill(0.0));
            self.add_lags(&from, &mut to);
            for (k, sample) in out.as_mut_slice().chunks_exact_mut(n).enumerate() {
                to.iter().zip(sample).for_each(|(series, value)| *value = series[k]);
            }
        }
        out
    }

    fn add_lags(&self, from: &[Vec<f64>], to: &mut [Vec<f64>]) {
        let count = from.first().map_or(0, Vec::len);
        for (l, r) in self.lags.iter().enumerate().take(count) {
            for (i, to) in to.iter_mut().enumerate() {
                for (j, from) in from.iter().enumerate() {
                    self.add_lag(to, from, r[(i, j)], l, true);
                    if l > 0 {
                        self.add_lag(to, from, r[(j, i)], l, false);
                    }
                }
            }
        }
    }

    /// Adds `value` times the samples `lag` later (or earlier) to each sample.
    fn add_lag(&self, to: &mut [f64], from: &[f64], value: f64, lag: usize, later: bool) {
        if value == 0.0 {
            return;
        }
        let inner = to.len() - lag;
        let add = |to: &mut [f64], from: &[f64]| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += value * from;
            }
        };
        if later {
            add(&mut to[..inner], &from[lag..]);
        } else {
            add(&mut to[lag..], &from[..inner]);
        }
        if self.wraps {
            if later {
                add(&mut to[inner..], &from[..lag]);
            } else {
                add(&mut to[..lag], &from[inner..]);
            }
        }
    }
}

/// Two columns as real and imaginary part of one.
fn apply_by_spectrum(spectrum: &NoiseSpectrum, n: usize, columns: &[f64], out: &mut DMatrix<f64>) {
    let rows = out.nrows();
    let entry = |row: usize, column: usize| columns[column * rows + row];
    let mut from = vec![vec![Complex::new(0.0, 0.0); rows / n]; n];
    let mut to = from.clone();
    for first in (0..out.ncols()).step_by(2) {
        let second = (first + 1 < out.ncols()).then_some(first + 1);
        for row in 0..rows {
            from[row % n][row / n] = Complex::new(entry(row, first), second.map_or(0.0, |second| entry(row, second)));
        }
        spectrum.apply(&from, &mut to);
        for row in 0..rows {
            let value = to[row % n][row / n];
            out[(row, first)] = value.re;
            if let Some(second) = second {
                out[(row, second)] = value.im;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_many_lags_by_transform_equal_the_sums() {
        for count in [61, 200] {
            let lags: Vec<DMatrix<f64>> = (0..40)
                .map(|l| DMatrix::from_fn(3, 3, |i, j| libm::cos((7 * l + 3 * i + 5 * j) as f64) / (l + 1) as f64))
                .collect();
            let w = DMatrix::from_fn(3 * count, 2, |i, j| libm::sin((3 * i + 5 * j) as f64));
            for wraps in [false, true] {
                let operator = CovarianceOperator { lags: lags.clone(), wraps, spectrum: None };
                let spectrum = Some(NoiseSpectrum::new(&lags, wraps, count));
                let by_transform = CovarianceOperator { lags: lags.clone(), wraps, spectrum }.apply(&w);
                let mut expected = vec![vec![0.0; count]; 3];
                for column in 0..2 {
                    let from: Vec<Vec<f64>> =
                        (0..3).map(|i| (0..count).map(|k| w[(3 * k + i, column)]).collect()).collect();
                    expected.iter_mut().for_each(|series| series.fill(0.0));
                    operator.add_lags(&from, &mut expected);
                    for row in 0..3 * count {
                        assert!((by_transform[(row, column)] - expected[row % 3][row / 3]).abs() < 1e-12);
                    }
                }
            }
        }
    }
}
