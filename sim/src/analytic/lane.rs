//! One number, or one number of each of several runs: the arithmetic that the equations of motion are written in.
//!
//! Every operation is the IEEE one on each lane, nothing is contracted or reordered, so that a run has the same bits
//! whether it is computed alone or beside others, and on whatever width.

use std::ops::{Add, Mul, Neg, Sub};

use super::elementary;

/// A number per run.
pub(crate) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The same number for every run.
    fn splat(x: f64) -> Self;

    /// `1 / self`.
    fn reciprocal(self) -> Self;

    /// `self / other`.
    fn over(self, other: Self) -> Self;

    /// The nearest whole number, of sizes below 2⁵¹; halves go to the even one.
    fn nearest(self) -> Self;

    /// `|self|`.
    fn magnitude(self) -> Self;

    /// The smaller of the two; `other` where they do not compare.
    fn smaller(self, other: Self) -> Self;

    /// `a` where `self < other`, otherwise `b`.
    fn less(self, other: Self, a: Self, b: Self) -> Self;

    /// `2^self` for whole numbers between −1000 and 1000.
    fn power_of_two(self) -> Self;

    /// Sines and cosines of N numbers.
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N];

    /// Hyperbolic tangents of N numbers.
    fn tangents<const N: usize>(x: &[Self; N]) -> [Self; N];
}

/// Adding and taking away this number rounds to a whole number.
const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²

impl Lane for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self / other
    }

    #[inline(always)]
    fn nearest(self) -> Self {
        (self + ROUND) - ROUND
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn less(self, other: Self, a: Self, b: Self) -> Self {
        if self < other { a } else { b }
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        // The sum's low bits are the whole number; moved into the exponent.
        Self::from_bits((self + (ROUND + 1023.0)).to_bits() << 52)
    }

    /// Two at a time: every processor this runs on has lanes for two.
    #[inline(always)]
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N] {
        let mut out = [(0.0, 0.0); N];
        for i in 0..N / 2 {
            let (s, c) = elementary::sin_cos(Lanes([x[2 * i], x[2 * i + 1]]));
            (out[2 * i], out[2 * i + 1]) = ((s.0[0], c.0[0]), (s.0[1], c.0[1]));
        }
        if N % 2 == 1 {
            out[N - 1] = elementary::sin_cos(x[N - 1]);
        }
        out
    }

    #[inline(always)]
    fn tangents<const N: usize>(x: &[Self; N]) -> [Self; N] {
        let mut out = [0.0; N];
        for i in 0..N / 2 {
            let t = elementary::tanh(Lanes([x[2 * i], x[2 * i + 1]]));
            (out[2 * i], out[2 * i + 1]) = (t.0[0], t.0[1]);
        }
        if N % 2 == 1 {
            out[N - 1] = elementary::tanh(x[N - 1]);
        }
        out
    }
}

/// `L` runs side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const L: usize>(pub(crate) [f64; L]);

impl<const L: usize> Lanes<L> {
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l])))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl<const L: usize> Add for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const L: usize> Sub for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const L: usize> Mul for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const L: usize> Lane for Lanes<L> {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; L])
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.map(Lane::reciprocal)
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.zip(other, Lane::over)
    }

    #[inline(always)]
    fn nearest(self) -> Self {
        self.map(Lane::nearest)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.map(Lane::magnitude)
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.zip(other, Lane::smaller)
    }

    #[inline(always)]
    fn less(self, other: Self, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l].less(other.0[l], a.0[l], b.0[l])))
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.map(Lane::power_of_two)
    }

    #[inline(always)]
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N] {
        x.map(elementary::sin_cos)
    }

    #[inline(always)]
    fn tangents<const N: usize>(x: &[Self; N]) -> [Self; N] {
        x.map(elementary::tanh)
    }
}
