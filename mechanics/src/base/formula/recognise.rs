//! From numbers to formulas.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::coefficient::{Coefficient, Product, power};
use super::family::{Family, STRETCH, WITNESSES};
use super::symbol::{Symbol, Variable};

/// A formula predicts a coefficient when it errs by less than this fraction of it: the recursion's own error is some
/// 1e-13, and witnesses drawn at random agree with a wrong formula to this extent with a chance of 1e-9 each.
const AGREEMENT: f64 = 1e-9;

/// Largest numerator and denominator of a factor.
const LARGEST_INTEGER: i32 = 8;

/// Largest exponent of a letter.
const LARGEST_EXPONENT: i32 = 4;

/// Largest sum of exponents, without their signs, of a product in a sum.
const MOST_COMPLEX: i32 = 6;

/// A sum that depends on more lengths and angles than this is not looked for.
const MOST_VARIABLES: usize = 4;

/// How many products, simplest first, are tried in pairs.
const MOST_IN_PAIRS: usize = 300;

/// How many are tried in threes.
const MOST_IN_THREES: usize = 60;

/// The values of one entry of K over a family, with what a formula for it may be made of.
struct Entry<'a> {
    family: &'a Family,
    /// Row and column in K.
    at: (usize, usize),
    /// The variables on which it depends.
    variables: Vec<Variable>,
}

/// The formula of entry (row, column) of K; `degree` is its dimension in lengths.
pub(super) fn coefficient(family: &Family, row: usize, column: usize, degree: i32) -> Coefficient {
    let value = family.original.reduction.k[(row, column)];
    let changes = |other: f64| (other - value).abs() > AGREEMENT * value.abs().max(other.abs());
    let of_entry = family.variables.iter().filter(|(_, relative)| changes(relative.reduction.k[(row, column)]));
    let variables = of_entry.map(|&(variable, _)| variable).collect();
    let entry = Entry { family, at: (row, column), variables };
    let found = entry.single_product().map(|product| vec![product]).or_else(|| entry.sum(degree));
    found.map_or(Coefficient::Number(value), Coefficient::Sum)
}

impl Entry<'_> {
    fn original(&self) -> f64 {
        self.family.original.reduction.k[self.at]
    }

    /// Whether a sum of products predicts the entry on every relative.
    fn holds(&self, sum: &[Product]) -> bool {
        self.family.relatives().all(|relative| {
            let value = relative.reduction.k[self.at];
            let predicted: f64 = sum.iter().map(|product| product.value(|symbol| relative.letter(symbol))).sum();
            (predicted - value).abs() <= AGREEMENT * value.abs()
        })
    }

    /// Exponents from how the entry answers each variable, then the factor from its value.
    fn single_product(&self) -> Option<Product> {
        let mut powers = Vec::new();
        for &variable in &self.variables {
            let (_, relative) = self.family.variables.iter().find(|(other, _)| *other == variable)?;
            let ratio = relative.reduction.k[self.at] / self.original();
            match variable {
                Variable::Length(symbol) => {
                    let exponent = (-LARGEST_EXPONENT..=LARGEST_EXPONENT)
                        .find(|&k| (power(STRETCH, k) / ratio - 1.0).abs() < AGREEMENT)?;
                    powers.push((symbol, exponent));
                }
                Variable::Alpha(_) | Variable::Theta(_) => {
                    let growth =
                        |symbol: Symbol| (symbol, relative.letter(symbol) / self.family.original.letter(symbol));
                    let grown: Vec<(Symbol, f64)> = variable.symbols().into_iter().map(growth).collect();
                    let exponents = pairs_by_simplicity()
                        .find(|k| (power(grown[0].1, k.0) * power(grown[1].1, k.1) / ratio - 1.0).abs() < AGREEMENT)?;
                    powers.push((grown[0].0, exponents.0));
                    powers.push((grown[1].0, exponents.1));
                }
            }
        }
        powers.retain(|&(_, exponent)| exponent != 0);
        powers.sort_unstable();
        let unit = Product { numerator: 1, denominator: 1, powers };
        let (numerator, denominator) =
            rational(self.original() / unit.value(|symbol| self.family.original.letter(symbol)))?;
        let product = Product { numerator, denominator, ..unit };
        self.holds(std::slice::from_ref(&product)).then_some(product)
    }

    /// A sum of two, then of three products of the variables on which the entry depends.
    fn sum(&self, degree: i32) -> Option<Vec<Product>> {
        if self.variables.len() > MOST_VARIABLES {
            return None;
        }
        let candidates = self.candidates(degree);
        // Candidate over entry on each witness: a formula's factors make the sum 1 on all of them.
        let witnesses = &self.family.witnesses;
        let ratios: Vec<[f64; WITNESSES]> = candidates
            .iter()
            .map(|candidate| {
                std::array::from_fn(|w| {
                    let value = witnesses[w].reduction.k[self.at];
                    candidate.value(|symbol| witnesses[w].letter(symbol)) / value
                })
            })
            .collect();
        let accept = |chosen: &[(usize, f64)]| -> Option<Vec<Product>> {
            let sum = chosen
                .iter()
                .map(|&(j, factor)| {
                    let (numerator, denominator) = rational(factor)?;
                    Some(Product { numerator, denominator, ..candidates[j].clone() })
                })
                .collect::<Option<Vec<Product>>>()?;
            self.holds(&sum).then_some(sum)
        };
        for (j, second) in ratios.iter().enumerate() {
            for (i, first) in ratios[..j].iter().enumerate() {
                let matrix = Matrix2::from_fn(|w, c| if c == 0 { first[w] } else { second[w] });
                let factors = matrix.try_inverse().map(|inverse| inverse * Vector2::repeat(1.0));
                let found = factors.and_then(|x| accept(&[(i, x[0]), (j, x[1])]));
                if found.is_some() {
                    return found;
                }
            }
        }
        for (k, third) in ratios.iter().enumerate().take(MOST_IN_THREES) {
            for (j, second) in ratios[..k].iter().enumerate() {
                for (i, first) in ratios[..j].iter().enumerate() {
                    let matrix = Matrix3::from_fn(|w, c| [first[w], second[w], third[w]][c]);
                    let factors = matrix.try_inverse().map(|inverse| inverse * Vector3::repeat(1.0));
                    let found = factors.and_then(|x| accept(&[(i, x[0]), (j, x[1]), (k, x[2])]));
                    if found.is_some() {
                        return found;
                    }
                }
            }
        }
        None
    }

    /// Products of the entry's variables with the right dimension, simplest first.
    fn candidates(&self, degree: i32) -> Vec<Product> {
        let mut products = vec![Vec::<(Symbol, i32)>::new()];
        for variable in &self.variables {
            let choices: Vec<Vec<(Symbol, i32)>> = match variable {
                Variable::Length(symbol) => {
                    (-LARGEST_EXPONENT..=LARGEST_EXPONENT).map(|k| vec![(*symbol, k)]).collect()
                }
                Variable::Alpha(_) | Variable::Theta(_) => {
                    let symbols = variable.symbols();
                    pairs_by_simplicity().map(|k| vec![(symbols[0], k.0), (symbols[1], k.1)]).collect()
                }
            };
            products = products
                .iter()
                .flat_map(|product| choices.iter().map(move |choice| [product.clone(), choice.clone()].concat()))
                .filter(|product| complexity(product) <= MOST_COMPLEX)
                .collect();
        }
        let dimension = |powers: &[(Symbol, i32)]| -> i32 {
            powers.iter().filter(|(symbol, _)| symbol.is_length()).map(|&(_, k)| k).sum()
        };
        products.retain(|powers| dimension(powers) == degree);
        for powers in &mut products {
            powers.retain(|&(_, exponent)| exponent != 0);
            powers.sort_unstable();
        }
        products.sort_by_key(|powers| (complexity(powers), powers.clone()));
        products.truncate(MOST_IN_PAIRS);
        products.into_iter().map(|powers| Product { numerator: 1, denominator: 1, powers }).collect()
    }
}

/// Sum of the exponents' sizes.
fn complexity(powers: &[(Symbol, i32)]) -> i32 {
    powers.iter().map(|&(_, exponent)| exponent.abs()).sum()
}

/// Exponents of cosine and sine, the smallest first.
fn pairs_by_simplicity() -> impl Iterator<Item = (i32, i32)> {
    let mut pairs: Vec<(i32, i32)> = (-2..=2).flat_map(|c| (-2..=2).map(move |s| (c, s))).collect();
    pairs.sort_by_key(|&(c, s): &(i32, i32)| (c.abs() + s.abs(), -c, -s));
    pairs.into_iter()
}

/// The rational number with small numerator and denominator that is this one; the smallest denominator wins.
fn rational(x: f64) -> Option<(i32, i32)> {
    (1..=LARGEST_INTEGER).find_map(|denominator| {
        let scaled = x * f64::from(denominator);
        let numerator = scaled.round();
        let near = numerator != 0.0 && (scaled - numerator).abs() <= AGREEMENT * scaled.abs();
        (near && numerator.abs() <= f64::from(LARGEST_INTEGER)).then_some((numerator as i32, denominator))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_rational_numbers() {
        assert_eq!(rational(-0.75), Some((-3, 4)));
        assert_eq!(rational(2.0 + 1e-13), Some((2, 1)));
        assert_eq!(rational(0.0), None);
        assert_eq!(rational(std::f64::consts::PI), None);
        assert_eq!(pairs_by_simplicity().next(), Some((0, 0)));
    }
}
