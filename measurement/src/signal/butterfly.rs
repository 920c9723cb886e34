//! How transforms of a part of the samples each become one of all, of one signal or of several side by side.
//!
//! ```text
//! X[s m + k] = Σ_r exp(−2πi r s / p) exp(−2πi r k / p m) X_r[k]        r, s = 0 … p − 1, k = 0 … m − 1
//! ```

use nalgebra::Complex;

use crate::lanes::Lane;

/// A complex number of each of several signals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<V> {
    pub(super) re: V,
    pub(super) im: V,
}

impl<V: Lane> Pair<V> {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }

    #[inline(always)]
    fn times(self, of: Complex<f64>) -> Self {
        let (re, im) = (self.re.splat(of.re), self.re.splat(of.im));
        Self { re: self.re * re - self.im * im, im: self.re * im + self.im * re }
    }

    #[inline(always)]
    fn scaled(self, size: f64) -> Self {
        let size = self.re.splat(size);
        Self { re: self.re * size, im: self.im * size }
    }
}

/// The numbers that a transform works on.
pub(super) trait Numbers<V> {
    fn get(&self, at: usize) -> Pair<V>;
    fn put(&mut self, at: usize, number: Pair<V>);
}

/// How p transforms of m samples each become one of p m.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// p.
    pub(super) factor: usize,
    /// `exp(−2πi r k / p m)` for r = 1 … p − 1, k by k, in the order in which they are needed.
    pub(super) turns: Vec<Complex<f64>>,
    /// `exp(−2πi s / p)`.
    pub(super) roots: Vec<Complex<f64>>,
}

impl Level {
    /// The p transforms that stand one behind the other from `first` on become one. `parts` is room for p numbers.
    #[inline(always)]
    pub(super) fn combine<V: Lane>(&self, numbers: &mut impl Numbers<V>, first: usize, parts: &mut [Pair<V>]) {
        let zero = parts[0];
        // A known number of parts is unrolled.
        match self.factor {
            2 => self.combine_any(numbers, first, &mut [zero; 2]),
            3 => self.combine_any(numbers, first, &mut [zero; 3]),
            4 => self.combine_four(numbers, first),
            5 => self.combine_any(numbers, first, &mut [zero; 5]),
            p => self.combine_any(numbers, first, &mut parts[..p]),
        }
    }

    #[inline(always)]
    fn combine_any<V: Lane>(&self, numbers: &mut impl Numbers<V>, first: usize, parts: &mut [Pair<V>]) {
        let p = parts.len();
        let m = self.turns.len() / (p - 1);
        for (k, turns) in self.turns.chunks_exact(p - 1).enumerate() {
            parts[0] = numbers.get(first + k);
            for r in 1..p {
                parts[r] = numbers.get(first + r * m + k).times(turns[r - 1]);
            }
            self.sums(
                parts,
                #[inline(always)]
                |s, sum| numbers.put(first + s * m + k, sum),
            );
        }
    }

    /// The transform of two values or an odd number of them.
    ///
    /// Roots w and w̄ of a pair share their products: `a w + b w̄ = Re w (a + b) + i Im w (a − b)`.
    #[inline(always)]
    fn sums<V: Lane>(&self, parts: &mut [Pair<V>], mut put: impl FnMut(usize, Pair<V>)) {
        let (p, half) = (parts.len(), parts.len() / 2);
        if p == 2 {
            put(0, parts[0].plus(parts[1]));
            put(1, parts[0].minus(parts[1]));
            return;
        }
        let roots = &self.roots[..p];
        let mut all = parts[0];
        for r in 1..=half {
            let (a, b) = (parts[r], parts[p - r]);
            (parts[r], parts[p - r]) = (a.plus(b), a.minus(b));
            all = all.plus(parts[r]);
        }
        put(0, all);
        let zero = all.re.splat(0.0);
        for s in 1..=half {
            let (mut even, mut odd, mut turn) = (parts[0], Pair { re: zero, im: zero }, 0);
            for r in 1..=half {
                turn += s;
                if turn >= p {
                    turn -= p;
                }
                let root = roots[turn];
                even = even.plus(parts[r].scaled(root.re));
                odd = odd.plus(parts[p - r].scaled(root.im));
            }
            let odd = Pair { re: -odd.im, im: odd.re };
            put(s, even.plus(odd));
            put(p - s, even.minus(odd));
        }
    }

    /// Four, whose roots are ±1 and ±i.
    #[inline(always)]
    fn combine_four<V: Lane>(&self, numbers: &mut impl Numbers<V>, first: usize) {
        let turns = self.turns.as_chunks::<3>().0;
        let m = turns.len();
        for (k, turns) in turns.iter().enumerate() {
            let at = first + k;
            let own = numbers.get(at);
            let x = numbers.get(at + m).times(turns[0]);
            let y = numbers.get(at + 2 * m).times(turns[1]);
            let z = numbers.get(at + 3 * m).times(turns[2]);
            let (a, b, c, d) = (own.plus(y), own.minus(y), x.plus(z), x.minus(z));
            let d = Pair { re: d.im, im: -d.re };
            numbers.put(at, a.plus(c));
            numbers.put(at + m, b.plus(d));
            numbers.put(at + 2 * m, a.minus(c));
            numbers.put(at + 3 * m, b.minus(d));
        }
    }
}
