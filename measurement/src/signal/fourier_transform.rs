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
    len: usize,
    /// From the whole signal to single samples.
    levels: Vec<Level>,
}

/// How p transforms of m samples each become one of p m.
#[derive(Clone, Debug)]
struct Level {
    /// p.
    factor: usize,
    /// `exp(−2πi r k / p m)` for r = 1 … p − 1, k by k, in the order in which they are needed.
    turns: Vec<Complex<f64>>,
    /// `exp(−2πi s / p)`.
    roots: Vec<Complex<f64>>,
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
        Self { len, levels: radices(len).into_iter().map(level).collect() }
    }

    /// Number of samples N.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the transform is of no samples at all.
    pub fn is_empty(&self) -> bool {
        self.len == 0
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
        let widest = self.levels.iter().map(|level| level.factor).max().unwrap_or(1);
        let mut scratch = vec![Complex::new(0.0, 0.0); widest];
        transform(x, 1, &self.levels, &mut out, &mut scratch);
        out
    }
}

/// `out` becomes the transform of the n = `out.len()` values `x[0], x[stride], …`, where n is the product of the levels' factors.
fn transform(
    x: &[Complex<f64>],
    stride: usize,
    levels: &[Level],
    out: &mut [Complex<f64>],
    scratch: &mut [Complex<f64>],
) {
    let Some((level, rest)) = levels.split_first() else {
        out.copy_from_slice(&x[..out.len()]);
        return;
    };
    let p = level.factor;
    let m = out.len() / p;
    if m == 1 {
        for (out, &x) in out.iter_mut().zip(x.iter().step_by(stride)) {
            *out = x;
        }
    } else {
        for (r, out) in out.chunks_exact_mut(m).enumerate() {
            transform(&x[r * stride..], stride * p, rest, out, scratch);
        }
    }
    match p {
        2 => level.combine(out, &mut [Complex::ZERO; 2]),
        3 => level.combine(out, &mut [Complex::ZERO; 3]),
        4 => level.combine_four(out),
        5 => level.combine(out, &mut [Complex::ZERO; 5]),
        _ => level.combine(out, &mut scratch[..p]),
    }
}

impl Level {
    /// Inlined, with as many parts as the factor, so that a known number of them is unrolled.
    #[inline(always)]
    fn combine(&self, out: &mut [Complex<f64>], parts: &mut [Complex<f64>]) {
        let p = parts.len();
        let m = out.len() / p;
        for (k, turns) in self.turns.chunks_exact(p - 1).enumerate() {
            parts[0] = out[k];
            for r in 1..p {
                parts[r] = out[r * m + k] * turns[r - 1];
            }
            self.sums(parts, |s, sum| out[s * m + k] = sum);
        }
    }

    /// The transform of two values or an odd number of them.
    ///
    /// Roots w and w̄ of a pair share their products: `a w + b w̄ = Re w (a + b) + i Im w (a − b)`.
    #[inline(always)]
    fn sums(&self, parts: &mut [Complex<f64>], mut put: impl FnMut(usize, Complex<f64>)) {
        let (p, half) = (parts.len(), parts.len() / 2);
        if p == 2 {
            put(0, parts[0] + parts[1]);
            put(1, parts[0] - parts[1]);
            return;
        }
        let roots = &self.roots[..p];
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
                let root = roots[turn];
                even += parts[r] * root.re;
                odd += parts[p - r] * root.im;
            }
            let odd = Complex::new(-odd.im, odd.re);
            put(s, even + odd);
            put(p - s, even - odd);
        }
    }

    /// Four, whose roots are ±1 and ±i.
    fn combine_four(&self, out: &mut [Complex<f64>]) {
        let m = out.len() / 4;
        let (first, rest) = out.split_at_mut(m);
        let (second, rest) = rest.split_at_mut(m);
        let (third, fourth) = rest.split_at_mut(m);
        let (second, third, fourth) = (&mut second[..m], &mut third[..m], &mut fourth[..m]);
        for (k, turns) in self.turns.as_chunks::<3>().0[..m].iter().enumerate() {
            let (x, y, z) = (second[k] * turns[0], third[k] * turns[1], fourth[k] * turns[2]);
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
