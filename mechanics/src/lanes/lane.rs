//! One number, or one number of each of several runs: the arithmetic that recursions are written in.
//!
//! Every operation is the IEEE one on each lane, nothing is contracted or reordered, so that a run has the same bits
//! whether it is computed alone or beside others, and on the width of the lanes.

use std::ops::{Add, Mul, Neg, Sub};

/// A number per run.
pub trait Lane: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// The number `x` for as many runs as this one is of.
    fn splat(self, x: f64) -> Self;

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

    /// The largest of all runs.
    fn most(self) -> f64;

    /// Whether no run's number is below `least`; not where one is no number.
    fn reaches(self, least: f64) -> bool;

    /// `2^self` for whole numbers between −1000 and 1000.
    fn power_of_two(self) -> Self;

    /// A function of single numbers, lane by lane.
    fn each<const K: usize>(x: [Self; K], f: impl FnMut([f64; K]) -> f64) -> Self;
}

/// Adding and taking away this number rounds to a whole number.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²

impl Lane for f64 {
    #[inline(always)]
    fn splat(self, x: f64) -> Self {
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
    fn most(self) -> f64 {
        self
    }

    #[inline(always)]
    fn reaches(self, least: f64) -> bool {
        self >= least
    }

    #[inline(always)]
    fn each<const K: usize>(x: [Self; K], mut f: impl FnMut([f64; K]) -> f64) -> Self {
        f(x)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        // The sum's low bits are the whole number; moved into the exponent.
        Self::from_bits((self + (ROUND + 1023.0)).to_bits() << 52)
    }
}
