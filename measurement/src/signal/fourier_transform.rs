//! The discrete Fourier transform of one period, for any number of samples.
//!
//! ```text
//! X[h] = Σ_k x[k] exp(−2πi h k / N)        x[k] = 1/N Σ_h X[h] exp(2πi h k / N)
//! ```
//! Mixed-radix decimation in time (Cooley and Tukey 1965): `O(N Σ p)` over the factors p of N, so a period of
//! 10,000 samples is fast and one of 10,007 still right. The order of sums is fixed: the same bits on every machine, and of a signal alone and
//! beside others.

use nalgebra::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::butterfly::{Level, Numbers, Pair};
use crate::lanes::Wide;

/// Signals that are transformed side by side.
pub(super) const TOGETHER: usize = 8;

/// A complex number of each of [`TOGETHER`] signals.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Line {
    pub(super) re: [f64; TOGETHER],
    pub(super) im: [f64; TOGETHER],
}

impl Line {
    pub(super) const ZERO: Self = Self { re: [0.0; TOGETHER], im: [0.0; TOGETHER] };
}

/// The transform for one length N; keeps the roots of unity.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::FourierTransform;
/// let transform = FourierTransform::new(4);
/// let spectrum = transform.forward_real(&[1.0, 0.0, -1.0, 0.0]); // cos(2π k / 4)
/// assert!((spectrum[1].re - 2.0).abs() < 1e-15 && spectrum[0].norm() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct FourierTransform {
    /// From the whole signal to single samples.
    levels: Vec<Level>,
    /// Which sample comes at which place, so that those of one part of the signal follow each other.
    order: Vec<usize>,
}

impl FourierTransform {
    /// A transform of `len` samples.
    pub fn new(len: usize) -> Self {
        let root = |k: usize| {
            let (s, c) = libm::sincos(-std::f64::consts::TAU * k as f64 / len as f64);
            Complex::new(c, s)
        };
        let mut stride = 1;
        let level = |factor: usize| {
            // exp(−2πi j / p m) is the root number j · stride, since p m · stride is the whole length.
            let (own, m) = (stride, len / (stride * factor));
            stride *= factor;
            let turns = (0..m).flat_map(|k| (1..factor).map(move |r| r * k * own)).map(root).collect();
            let roots = (0..factor).map(|s| root(s * m * own)).collect();
            Level { factor, turns, roots }
        };
        let levels: Vec<Level> = radices(len).into_iter().map(level).collect();
        let mut order = vec![0; len.min(1)];
        for level in &levels {
            // Sample k of part r is sample k p + r; parts of parts so on.
            let stride = order.len();
            order = order.iter().flat_map(|&k| (0..level.factor).map(move |r| k + r * stride)).collect();
        }
        Self { levels, order }
    }

    /// Number of samples N.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether the transform is of no samples at all.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// The spectrum X (N lines) of a real signal.
    ///
    /// # Panics
    /// If the signal has another length than the transform.
    pub fn forward_real(&self, x: &[f64]) -> Vec<Complex<f64>> {
        let x: Vec<Complex<f64>> = x.iter().map(|&value| Complex::new(value, 0.0)).collect();
        self.forward(&x)
    }

    /// The spectra of two real signals at the price of one.
    ///
    /// # Panics
    /// If a signal has another length than the transform.
    pub fn forward_pair(&self, x: &[f64], y: &[f64]) -> (Vec<Complex<f64>>, Vec<Complex<f64>>) {
        assert_eq!(x.len(), y.len(), "two signals of one length");
        let both: Vec<Complex<f64>> = x.iter().zip(y).map(|(&x, &y)| Complex::new(x, y)).collect();
        let z = self.forward(&both);
        let n = z.len();
        (0..n)
            .map(|h| {
                // x real and y real: X is the Hermitian part of Z, iY the rest.
                let (a, b) = (z[h], z[(n - h) % n].conj());
                let difference = (a - b) * 0.5;
                ((a + b) * 0.5, Complex::new(difference.im, -difference.re))
            })
            .unzip()
    }

    /// The spectrum X (N lines) of a complex signal.
    ///
    /// # Panics
    /// If the signal has another length than the transform.
    pub fn forward(&self, x: &[Complex<f64>]) -> Vec<Complex<f64>> {
        assert_eq!(x.len(), self.len(), "one value per sample of the transform");
        let mut out: Vec<Complex<f64>> = self.order.iter().map(|&k| x[k]).collect();
        self.transform(&mut Alone(&mut out), 0.0);
        out
    }

    /// The spectra X (N lines) of the first `count` of several complex signals, whose sample k is `sample(k)`.
    pub(super) fn forward_together(&self, count: usize, sample: impl Fn(usize) -> Line) -> Vec<Line> {
        let mut lines: Vec<Line> = self.order.iter().map(|&k| sample(k)).collect();
        Arch::new().dispatch(Together { transform: self, count, lines: &mut lines });
        lines
    }

    /// Transforms numbers in order. What a part needs is near, so that it is still in a cache.
    #[inline(always)]
    fn transform<V: crate::lanes::Lane>(&self, numbers: &mut impl Numbers<V>, zero: V) {
        let widest = self.levels.iter().map(|level| level.factor).max().unwrap_or(1);
        let mut parts = vec![Pair { re: zero, im: zero }; widest];
        let smallest = self.levels.last().map_or(1, |level| level.factor);
        for end in (smallest..=self.len()).step_by(smallest) {
            let mut size = 1;
            for level in self.levels.iter().rev() {
                size *= level.factor;
                if !end.is_multiple_of(size) {
                    break;
                }
                level.combine(numbers, end - size, &mut parts);
            }
        }
    }
}

/// One signal.
struct Alone<'a>(&'a mut [Complex<f64>]);

impl Numbers<f64> for Alone<'_> {
    #[inline(always)]
    fn get(&self, at: usize) -> Pair<f64> {
        Pair { re: self.0[at].re, im: self.0[at].im }
    }

    #[inline(always)]
    fn put(&mut self, at: usize, Pair { re, im }: Pair<f64>) {
        self.0[at] = Complex::new(re, im);
    }
}

/// Several signals.
struct Together<'a> {
    transform: &'a FourierTransform,
    count: usize,
    lines: &'a mut [Line],
}

/// As many of several signals as the processor has lanes.
struct Lanes<'a, S> {
    simd: S,
    lines: &'a mut [Line],
    vector: usize,
}

impl<S: Simd> Numbers<Wide<S>> for Lanes<'_, S> {
    #[inline(always)]
    fn get(&self, at: usize) -> Pair<Wide<S>> {
        let line = &self.lines[at];
        let [re, im] = [&line.re, &line.im].map(|x| Wide::new(self.simd, S::as_simd_f64s(x).0[self.vector]));
        Pair { re, im }
    }

    #[inline(always)]
    fn put(&mut self, at: usize, Pair { re, im }: Pair<Wide<S>>) {
        let line = &mut self.lines[at];
        S::as_mut_simd_f64s(&mut line.re).0[self.vector] = re.x;
        S::as_mut_simd_f64s(&mut line.im).0[self.vector] = im.x;
    }
}

impl WithSimd for Together<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { transform, count, lines } = self;
        for vector in 0..count.div_ceil(S::F64_LANES) {
            let zero = Wide::new(simd, simd.splat_f64s(0.0));
            transform.transform(&mut Lanes { simd, lines: &mut *lines, vector }, zero);
        }
    }
}

/// Factors of n, by which the transform divides it: as many fours as possible, then primes.
fn radices(mut n: usize) -> Vec<usize> {
    let mut factors = Vec::new();
    let mut p = 4;
    while p * p <= n || p == 4 {
        while n > 1 && n.is_multiple_of(p) {
            factors.push(p);
            n /= p;
        }
        p = match p {
            4 => 2,
            2 => 3,
            odd => odd + 2,
        };
    }
    if n > 1 {
        factors.push(n);
    }
    factors
}

/// The smallest length from `least` on with no prime factor above five.
pub(super) fn smooth_length(least: usize) -> usize {
    (least.max(1)..)
        .find(|&length| {
            let mut rest = length;
            for p in [2, 3, 5] {
                while rest.is_multiple_of(p) {
                    rest /= p;
                }
            }
            rest == 1
        })
        .unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    fn noise(n: usize, run: u64) -> Vec<f64> {
        let mut rng = Seed::new(1).stream("transform test", run);
        (0..n).map(|_| rng.random_range(-1.0..1.0)).collect()
    }

    #[test]
    fn identity_transform_is_the_defining_sum_for_every_length() {
        for n in (1..=40).chain([49, 97, 100, 120, 360]) {
            let x = noise(n, n as u64);
            let spectrum = FourierTransform::new(n).forward_real(&x);
            for (h, &line) in spectrum.iter().enumerate() {
                let mut sum = Complex::new(0.0, 0.0);
                for (k, &value) in x.iter().enumerate() {
                    let (s, c) = libm::sincos(-std::f64::consts::TAU * ((h * k) % n) as f64 / n as f64);
                    sum += Complex::new(c, s) * value;
                }
                // n terms of size one, each rounded: n ε, with room for the roots' own rounding.
                assert!((line - sum).norm() < 1e-15 * (n as f64 + 10.0), "length {n}, line {h}");
            }
        }
    }

    #[test]
    fn identity_two_real_signals_at_once_and_parseval() {
        let (x, y) = (noise(1000, 1), noise(1000, 2));
        let transform = FourierTransform::new(1000);
        let (a, b) = transform.forward_pair(&x, &y);
        let (c, d) = (transform.forward_real(&x), transform.forward_real(&y));
        for h in 0..1000 {
            assert!((a[h] - c[h]).norm() < 1e-12 && (b[h] - d[h]).norm() < 1e-12);
        }
        let power: f64 = a.iter().map(Complex::norm_sqr).sum::<f64>() / 1000.0;
        let energy: f64 = x.iter().map(|x| x * x).sum();
        assert!((power / energy - 1.0).abs() < 1e-13);
    }
}
