//! The arithmetic that a torque law is written in, so that one text serves values, slopes and the lanes of a processor.

use std::ops::{Add, Mul, Neg, Sub};

use crate::model::friction::smooth_sign;

/// A positive number that laws divide by: a velocity scale. An engine that shares one evaluation among several runs
/// multiplies by the reciprocal instead, which it computes once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The number itself; 0 makes a smooth sign the plain one.
    pub value: f64,
    /// Its reciprocal; 0 where the number is 0.
    pub reciprocal: f64,
}

impl Scale {
    /// From the number.
    #[must_use]
    pub fn new(value: f64) -> Self {
        Self { value, reciprocal: if value == 0.0 { 0.0 } else { 1.0 / value } }
    }
}

/// A number in a torque law: of one sample ([`f64`]), of one sample with its derivatives ([`Slope`]), or one of each of
/// several runs (the engines' own).
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// A constant, for as many runs as this number is of.
    #[must_use]
    fn constant(self, x: f64) -> Self;

    /// `|x|`.
    #[must_use]
    fn magnitude(self) -> Self;

    /// `x / s`.
    #[must_use]
    fn over(self, scale: Scale) -> Self;

    /// The smooth sign `tanh(x / s)`; the plain sign where `s` is 0. See [`smooth_sign`].
    #[must_use]
    fn smooth_sign(self, scale: Scale) -> Self;

    /// `eˣ`.
    #[must_use]
    fn exponential(self) -> Self;

    /// `(sin x, cos x)`.
    #[must_use]
    fn sine_cosine(self) -> (Self, Self);
}

impl Number for f64 {
    #[inline]
    fn constant(self, x: f64) -> Self {
        x
    }

    #[inline]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline]
    fn over(self, scale: Scale) -> Self {
        self / scale.value
    }

    #[inline]
    fn smooth_sign(self, scale: Scale) -> Self {
        smooth_sign(self, scale.value)
    }

    #[inline]
    fn exponential(self) -> Self {
        libm::exp(self)
    }

    #[inline]
    fn sine_cosine(self) -> (Self, Self) {
        libm::sincos(self)
    }
}

/// A number with its derivatives by position, velocity, acceleration, transmitted torque: forward differentiation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The number.
    pub value: f64,
    /// `∂/∂(q, q̇, q̈, τ_t)`.
    pub by: [f64; Slope::COUNT],
}

impl Slope {
    /// How many derivatives it carries.
    pub const COUNT: usize = 4;

    /// The variable of number `index` in `(q, q̇, q̈, τ_t)`.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        Self { value, by: std::array::from_fn(|k| if k == index { 1.0 } else { 0.0 }) }
    }

    /// A number that does not vary.
    #[must_use]
    pub const fn fixed(value: f64) -> Self {
        Self { value, by: [0.0; Self::COUNT] }
    }

    /// `f(x)` by its value and its derivative.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, by: self.by.map(|d| derivative * d) }
    }
}

crate::lanes::arithmetic_of! { impl[] Slope, |a, b|
    Self { value: a.value + b.value, by: std::array::from_fn(|k| a.by[k] + b.by[k]) },
    Self { value: a.value - b.value, by: std::array::from_fn(|k| a.by[k] - b.by[k]) },
    Self { value: a.value * b.value, by: std::array::from_fn(|k| a.by[k] * b.value + a.value * b.by[k]) },
    Self { value: -a.value, by: a.by.map(|d| -d) }
}

impl Number for Slope {
    fn constant(self, x: f64) -> Self {
        Self::fixed(x)
    }

    fn magnitude(self) -> Self {
        let sign = if self.value < 0.0 { -1.0 } else { 1.0 };
        self.chain(self.value.abs(), sign)
    }

    fn over(self, scale: Scale) -> Self {
        Self { value: self.value / scale.value, by: self.by.map(|d| d / scale.value) }
    }

    fn smooth_sign(self, scale: Scale) -> Self {
        // d/dx tanh(x / s) = (1 − tanh²) / s; the plain sign is flat wherever it has a slope.
        let t = smooth_sign(self.value, scale.value);
        self.chain(t, if scale.value > 0.0 { (1.0 - t * t) / scale.value } else { 0.0 })
    }

    fn exponential(self) -> Self {
        let e = libm::exp(self.value);
        self.chain(e, e)
    }

    fn sine_cosine(self) -> (Self, Self) {
        let (sine, cosine) = libm::sincos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_slopes_are_central_differences() {
        let scale = Scale::new(0.3);
        let (wave, bend) = (|(s, c): (f64, f64)| s * c - c, |(s, c): (Slope, Slope)| s * c - c);
        let f = |x: f64| {
            x * x.over(scale) - x.smooth_sign(scale) * (-x * x).exponential() + x.magnitude() + wave(x.sine_cosine())
        };
        let g = |x: Slope| {
            x * x.over(scale) - x.smooth_sign(scale) * (-x * x).exponential() + x.magnitude() + bend(x.sine_cosine())
        };
        for x in [-1.3, -0.2, 0.05, 0.7] {
            let h = 1e-5;
            let found = g(Slope::variable(x, 1));
            assert!((found.value - f(x)).abs() < 1e-15 && found.by[0] == 0.0 && found.by[2] == 0.0);
            // Truncation h² f‴/6, f‴ up to 2/0.3³.
            assert!((found.by[1] - (f(x + h) - f(x - h)) / (2.0 * h)).abs() < 1e-8, "{x}");
        }
    }
}
