//! Sums of products of series with themselves, some samples apart.
//!
//! ```text
//! c_ij(l) = Σ_k x_i,k x_j,k+l
//! ```
//! over all k that have a partner; in a period the last sample is followed by the first. The first lags are summed as they are
//! written. A caller that asks for more gets all of them by the convolution theorem, `O(n² N log N)` instead of a product for each
//! sample and lag.

use nalgebra::{Complex, DMatrix};

use super::fourier_transform::{FourierTransform, smooth_length};
use crate::linalg::product::transposed_product_of_parts;

/// Lags up to which sums are faster than transforms.
const FEW_LAGS: usize = 16;

/// Products of n series of N samples.
#[derive(Clone, Debug)]
pub struct LagProducts {
    dof: usize,
    wraps: bool,
    /// Series after series.
    series: Vec<f64>,
    /// c_ij for i ≤ j, column by column of the upper triangle, at lags 0, 1, … and, from the end, −1, −2, …; empty until
    /// it is needed.
    all: Vec<Vec<f64>>,
}

impl LagProducts {
    /// The products of `x`, N × n row-major; `wraps` where the samples are one period.
    pub fn new(x: &[f64], dof: usize, wraps: bool) -> Self {
        let (count, mut series) = (x.len() / dof.max(1), vec![0.0; x.len()]);
        for (k, sample) in x.chunks_exact(dof.max(1)).enumerate() {
            sample.iter().enumerate().for_each(|(i, value)| series[i * count + k] = *value);
        }
        Self { dof, wraps, series, all: Vec::new() }
    }

    /// c(l), n × n, for a lag shorter than the series.
    pub fn product(&mut self, l: usize) -> DMatrix<f64> {
        if l <= FEW_LAGS {
            return self.summed(l);
        }
        let (n, count) = (self.dof, self.count());
        if self.all.is_empty() {
            self.all = self.correlations(count);
        }
        let len = self.all[0].len();
        DMatrix::from_fn(n, n, |i, j| {
            let (low, high) = (i.min(j), i.max(j));
            let c = &self.all[high * (high + 1) / 2 + low];
            // c_ji(l) = c_ij(−l); what wraps around is N − l samples the other way.
            let (own, around) = if i <= j { (l, len - (count - l)) } else { (len - l, count - l) };
            if self.wraps { c[own] + c[around] } else { c[own] }
        })
    }

    /// N.
    fn count(&self) -> usize {
        self.series.len() / self.dof.max(1)
    }

    /// c(l), n × n, summed as it is written.
    pub(super) fn summed(&self, l: usize) -> DMatrix<f64> {
        let count = self.count();
        let inner = transposed_product_of_parts(&self.series, &self.series[l..], count, count - l);
        if self.wraps && l > 0 {
            // What follows the last l samples of each series is its own beginning.
            inner + transposed_product_of_parts(&self.series[count - l..], &self.series, count, l)
        } else {
            inner
        }
    }

    /// The diagonal of c(0), n.
    pub(super) fn squares(&self) -> Vec<f64> {
        let count = self.count();
        self.series.chunks_exact(count).map(|own| transposed_product_of_parts(own, own, count, count)[(0, 0)]).collect()
    }

    /// Linear correlations of all pairs, padded with zeros so that nothing of one end meets the other.
    fn correlations(&self, count: usize) -> Vec<Vec<f64>> {
        let transform = FourierTransform::new(smooth_length(2 * count));
        let len = transform.len();
        let padded = |i: usize| {
            let mut x = self.series[i * count..(i + 1) * count].to_vec();
            x.resize(len, 0.0);
            x
        };
        let spectra: Vec<Vec<Complex<f64>>> = (0..self.dof).map(|i| transform.forward_real(&padded(i))).collect();
        let pairs: Vec<(usize, usize)> = (0..self.dof).flat_map(|j| (0..=j).map(move |i| (i, j))).collect();
        let mut all = Vec::with_capacity(pairs.len());
        for two in pairs.chunks(2) {
            // conj(X_i) X_j is the spectrum of a real sequence: two of them share a transform as real and imaginary part.
            let cross = |&(i, j): &(usize, usize), h: usize| spectra[i][h].conj() * spectra[j][h];
            let both: Vec<Complex<f64>> = (0..len)
                .map(|h| {
                    let second = two.get(1).map_or(Complex::new(0.0, 0.0), |pair| cross(pair, h));
                    // Conjugated, so that the forward transform runs backwards.
                    (cross(&two[0], h) + Complex::new(-second.im, second.re)).conj()
                })
                .collect();
            let back = transform.forward(&both);
            all.push(back.iter().map(|z| z.re / len as f64).collect());
            if two.len() == 2 {
                all.push(back.iter().map(|z| -z.im / len as f64).collect());
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn identity_every_lag_is_the_sum_of_products() {
        for (count, n) in [(40, 1), (61, 2), (97, 3)] {
            let mut rng = Seed::new(4).stream("lag products", count as u64);
            let x: Vec<f64> = (0..count * n).map(|_| rng.random_range(-1.0..1.0)).collect();
            for wraps in [false, true] {
                let mut products = LagProducts::new(&x, n, wraps);
                for l in 0..count - 1 {
                    let found = products.product(l);
                    for i in 0..n {
                        for j in 0..n {
                            let partners = (0..if wraps { count } else { count - l }).map(|k| (k, (k + l) % count));
                            let expected: f64 = partners.map(|(k, other)| x[k * n + i] * x[other * n + j]).sum();
                            // Sums of at most a hundred products of size one.
                            assert!((found[(i, j)] - expected).abs() < 1e-13, "{count} {wraps} {l} {i} {j}");
                        }
                    }
                }
            }
        }
    }
}
