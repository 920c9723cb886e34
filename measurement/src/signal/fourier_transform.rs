//! The discrete Fourier transform of one period, for any number of samples.
//!
//! ```text
//! X[h] = Σ_k x[k] exp(−2πi h k / N)        x[k] = 1/N Σ_h X[h] exp(2πi h k / N)
//! ```
//! Mixed-radix decimation in time (Cooley and Tukey 1965): `O(N Σ p)` over the factors p of N, so a period of
//! 10,000 samples is fast and one of 10,007 still right. Scalar, fixed order of sums: the same bits on every machine.

use nalgebra::Complex;

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
    roots: Vec<Complex<f64>>,
    factors: Vec<usize>,
}

impl FourierTransform {
    /// A transform of `len` samples.
    pub fn new(len: usize) -> Self {
        let roots = (0..len)
            .map(|k| {
                let (s, c) = libm::sincos(-std::f64::consts::TAU * k as f64 / len as f64);
                Complex::new(c, s)
            })
            .collect();
        Self { roots, factors: radices(len) }
    }

    /// Number of samples N.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether the transform is of no samples at all.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
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
        let mut out = vec![Complex::new(0.0, 0.0); x.len()];
        let widest = self.factors.iter().copied().max().unwrap_or(1);
        let mut scratch = vec![Complex::new(0.0, 0.0); widest];
        self.transform(x, 1, &self.factors, &mut out, &mut scratch);
        out
    }

    /// `out` becomes the transform of the n = `out.len()` values `x[0], x[stride], …`, where n is the product of `factors`.
    fn transform(
        &self,
        x: &[Complex<f64>],
        stride: usize,
        factors: &[usize],
        out: &mut [Complex<f64>],
        scratch: &mut [Complex<f64>],
    ) {
        let Some((&p, rest)) = factors.split_first() else {
            out.copy_from_slice(&x[..out.len()]);
            return;
        };
        let m = out.len() / p;
        if m == 1 {
            for (out, &x) in out.iter_mut().zip(x.iter().step_by(stride)) {
                *out = x;
            }
        } else {
            for (r, out) in out.chunks_exact_mut(m).enumerate() {
                self.transform(&x[r * stride..], stride * p, rest, out, scratch);
            }
        }
        match p {
            2 => self.combine(stride, m, out, &mut [Complex::ZERO; 2]),
            3 => self.combine(stride, m, out, &mut [Complex::ZERO; 3]),
            4 => self.combine_four(stride, m, out),
            5 => self.combine(stride, m, out, &mut [Complex::ZERO; 5]),
            _ => self.combine(stride, m, out, &mut scratch[..p]),
        }
    }

    // exp(−2πi j / n) is the root number j · stride, since n · stride is the whole length.

    /// As many transforms of m values each as `parts` has places to one: inlined, so that a known number of them is unrolled.
    #[inline(always)]
    fn combine(&self, stride: usize, m: usize, out: &mut [Complex<f64>], parts: &mut [Complex<f64>]) {
        for k in 0..m {
            parts[0] = out[k];
            for r in 1..parts.len() {
                parts[r] = out[r * m + k] * self.roots[r * k * stride];
            }
            self.sums(parts, m * stride, |s, sum| out[s * m + k] = sum);
        }
    }

    /// The transform of two values or an odd number of them; roots of their number are `apart` places from each other.
    ///
    /// Roots w and w̄ of a pair share their products: `a w + b w̄ = Re w (a + b) + i Im w (a − b)`.
    #[inline(always)]
    fn sums(&self, parts: &mut [Complex<f64>], apart: usize, mut put: impl FnMut(usize, Complex<f64>)) {
        let (p, half) = (parts.len(), parts.len() / 2);
        if p == 2 {
            put(0, parts[0] + parts[1]);
            put(1, parts[0] - parts[1]);
            return;
        }
        let mut all = parts[0];
        for r in 1..=half {
            let (a, b) = (parts[r], parts[p - r]);
            (parts[r], parts[p - r]) = (a + b, a - b);
            all += parts[r];
        }
        put(0, all);
        for s in 1..=half {
            let (mut even, mut odd, mut turn) = (parts[0], Complex::<f64>::ZERO, 0);
            for r in 1..=half {
                turn += s;
                if turn >= p {
                    turn -= p;
                }
                let root = self.roots[turn * apart];
                even += parts[r] * root.re;
                odd += parts[p - r] * root.im;
            }
            let odd = Complex::new(-odd.im, odd.re);
            put(s, even + odd);
            put(p - s, even - odd);
        }
    }

    /// Four, whose roots are ±1 and ±i.
    fn combine_four(&self, stride: usize, m: usize, out: &mut [Complex<f64>]) {
        let (first, rest) = out.split_at_mut(m);
        let (second, rest) = rest.split_at_mut(m);
        let (third, fourth) = rest.split_at_mut(m);
        let (second, third, fourth) = (&mut second[..m], &mut third[..m], &mut fourth[..m]);
        for k in 0..m {
            let root = |r: usize| self.roots[r * k * stride];
            let (x, y, z) = (second[k] * root(1), third[k] * root(2), fourth[k] * root(3));
            let (a, b) = (first[k] + y, first[k] - y);
            let (c, d) = (x + z, x - z);
            let d = Complex::new(d.im, -d.re);
            first[k] = a + c;
            second[k] = b + d;
            third[k] = a - c;
            fourth[k] = b - d;
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
