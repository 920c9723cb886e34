//! One coefficient of K, as it is printed.

use super::symbol::Symbol;

/// A rational factor times powers of letters: `−2·d4²/a2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// Numerator of the factor, with its sign.
    pub numerator: i32,
    /// Denominator of the factor, positive.
    pub denominator: i32,
    /// Letters with their exponents, none of them zero, in order.
    pub powers: Vec<(Symbol, i32)>,
}

impl Product {
    /// Its value when each letter has the value that `letter` gives.
    pub(super) fn value(&self, letter: impl Fn(Symbol) -> f64) -> f64 {
        let factor = f64::from(self.numerator) / f64::from(self.denominator);
        self.powers.iter().fold(factor, |product, &(symbol, exponent)| product * power(letter(symbol), exponent))
    }
}

/// `x^k` by repeated multiplication.
pub(super) fn power(x: f64, k: i32) -> f64 {
    let magnitude = (0..k.unsigned_abs()).fold(1.0, |product, _| product * x);
    if k < 0 { 1.0 / magnitude } else { magnitude }
}

/// A coefficient of K: a formula that holds on every arm of this shape, or a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// A sum of products of the robot's own lengths; at least one.
    Sum(Vec<Product>),
    /// No formula was found: the value itself, SI units.
    Number(f64),
}
