//! A number with its derivatives by K others, as recursions take it.
//!
//! ```text
//! (x, x') (y, y') = (x y, x' y + x y')        f(x, x') = (f(x), f'(x) x')
//! ```
//! Values have the bits that they have alone.

use std::array::from_fn;

use armid::lanes::{Lane, Sines};

/// A number and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet<const K: usize> {
    pub(crate) value: f64,
    pub(crate) by: [f64; K],
}

impl<const K: usize> Jet<K> {
    /// A number that nothing changes.
    #[inline(always)]
    pub(crate) fn fixed(value: f64) -> Self {
        Self { value, by: [0.0; K] }
    }

    /// The k-th of those by which derivatives are taken.
    #[inline(always)]
    pub(crate) fn variable(value: f64, k: usize) -> Self {
        let mut jet = Self::fixed(value);
        jet.by[k] = 1.0;
        jet
    }
}

armid::lanes::arithmetic_of! { impl[const K: usize] Jet<K>, |a, b|
    Self { value: a.value + b.value, by: from_fn(|k| a.by[k] + b.by[k]) },
    Self { value: a.value - b.value, by: from_fn(|k| a.by[k] - b.by[k]) },
    Self { value: a.value * b.value, by: from_fn(|k| a.by[k] * b.value + a.value * b.by[k]) },
    Self { value: -a.value, by: from_fn(|k| -a.by[k]) }
}

/// Step of the central difference by which a law from outside is differentiated: far below any velocity scale.
const STEP: f64 = 1e-6;

impl<const K: usize> Lane for Jet<K> {
    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        Self::fixed(x)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let value = self.value.reciprocal();
        Self { value, by: from_fn(|k| -self.by[k] * value * value) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let (value, per) = (self.value.over(other.value), other.value.reciprocal());
        Self { value, by: from_fn(|k| (self.by[k] - value * other.by[k]) * per) }
    }

    #[inline(always)]
    fn nearest(self) -> Self {
        Self::fixed(self.value.nearest())
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if self.value < other.value { self } else { other }
    }

    #[inline(always)]
    fn less(self, other: Self, a: Self, b: Self) -> Self {
        if self.value < other.value { a } else { b }
    }

    #[inline(always)]
    fn most(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn reaches(self, least: f64) -> bool {
        self.value >= least
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::fixed(self.value.power_of_two())
    }

    #[inline(always)]
    fn each<const M: usize>(x: [Self; M], mut f: impl FnMut([f64; M]) -> f64) -> Self {
        // Known by its values alone.
        let value = f(x.map(|x| x.value));
        let mut by = [0.0; K];
        for (k, by) in by.iter_mut().enumerate() {
            if x.iter().any(|x| x.by[k] != 0.0) {
                let mut at = |step: f64| f(x.map(|x| x.value + step * x.by[k]));
                *by = (at(STEP) - at(-STEP)) * (0.5 / STEP);
            }
        }
        Self { value, by }
    }
}

impl<const K: usize> Sines for Jet<K> {
    #[inline(always)]
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N] {
        let mut values = [0.0; N];
        for i in 0..N {
            values[i] = x[i].value;
        }
        let of_values = f64::sines(&values);
        let mut out = [(x[0], x[0]); N];
        for i in 0..N {
            let (sine, cosine) = of_values[i];
            (out[i].0.value, out[i].1.value) = (sine, cosine);
            for k in 0..K {
                (out[i].0.by[k], out[i].1.by[k]) = (cosine * x[i].by[k], -sine * x[i].by[k]);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use armid::lanes::{exp, sin_cos, tanh};

    #[test]
    fn analytic_derivatives_of_elementary_functions() {
        for k in -50..50 {
            let x = 0.173 * f64::from(k) + 0.01;
            let jet = Jet::<2>::variable(x, 1);
            let (s, c) = sin_cos(jet);
            assert_eq!((s.value, c.value, s.by[0]), (sin_cos(x).0, sin_cos(x).1, 0.0));
            assert!((s.by[1] - c.value).abs() < 1e-14 && (c.by[1] + s.value).abs() < 1e-14);
            assert_eq!(Jet::sines(&[jet])[0].0.value, s.value);
            assert!((Jet::sines(&[jet])[0].0.by[1] - s.by[1]).abs() < 1e-14);
            assert!((Jet::sines(&[jet])[0].1.by[1] - c.by[1]).abs() < 1e-14);
            let t = tanh(jet);
            assert!(t.value == tanh(x) && (t.by[1] - (1.0 - t.value * t.value)).abs() < 1e-14, "{x}");
            let e = exp(jet);
            assert!(e.value == exp(x) && (e.by[1] / e.value - 1.0).abs() < 1e-13);
            let r = jet.reciprocal();
            assert!((r.by[1] + 1.0 / (x * x)).abs() < 1e-12 / (x * x));
            assert!((s.over(jet).by[1] - (s * r).by[1]).abs() < 1e-9);
            assert_eq!((jet.magnitude().by[1], jet.nearest().by[1]), (x.signum(), 0.0));
            let square = Jet::each([jet, s], |[x, s]| x * s);
            assert!((square.by[1] - (jet * s).by[1]).abs() < 1e-8);
        }
    }
}
