//! Formulas say what K says, on the arm and on others of its shape.

use std::collections::HashMap;

use nalgebra::DVector;
use rand::RngExt;

use super::chains::{bundled_robots, random_chains, relengthened};
use crate::base::{BaseReduction, Coefficient, Formula, Method, Product, reduce};
use crate::model::{Columns, Robot};
use crate::seed::Seed;

fn structural(robot: &Robot, columns: Columns) -> BaseReduction {
    reduce(robot, columns, Method::Structural, Seed::new(0)).unwrap()
}

fn numbers(formulas: &[Formula]) -> usize {
    let coefficients = formulas.iter().flat_map(|formula| &formula.terms);
    coefficients.filter(|(_, coefficient)| matches!(coefficient, Coefficient::Number(_))).count()
}

/// The value of a coefficient on an arm that has all of its letters.
pub(super) fn evaluated(coefficient: &Coefficient, robot: &Robot) -> f64 {
    let of = |product: &Product| {
        let factor = f64::from(product.numerator) / f64::from(product.denominator);
        let powers = product.powers.iter().map(|(symbol, exponent)| symbol.value(robot).unwrap().powi(*exponent));
        factor * powers.product::<f64>()
    };
    match coefficient {
        Coefficient::Number(value) => *value,
        Coefficient::Sum(products) => products.iter().map(of).sum(),
    }
}

/// Formulas of one arm, evaluated on another of the same shape, against the K of the latter.
fn assert_hold(formulas: &[Formula], robot: &Robot, base: &BaseReduction) {
    for (row, formula) in formulas.iter().enumerate() {
        let terms = base.terms(row);
        assert_eq!(formula.terms.len(), terms.len());
        for ((id, coefficient), (other, value)) in formula.terms.iter().zip(terms) {
            assert_eq!(*id, other);
            let evaluated = evaluated(coefficient, robot);
            let error = (evaluated - value).abs();
            // The accuracy to which a formula is accepted in the first place, with room for a new arm.
            assert!(error <= 1e-8 * value.abs(), "{}: {formula} at {id}: {evaluated} {value}", robot.name());
        }
    }
}

#[test]
fn identity_formulas_of_bundled_robots_hold_on_other_lengths() {
    let mut rng = Seed::new(12).stream("lengths", 0);
    for robot in bundled_robots() {
        let formulas = structural(&robot, Columns::RIGID_ROTOR_FRICTION).formulas(&robot);
        assert_eq!(numbers(&formulas), 0, "{}", robot.name());
        for _ in 0..3 {
            let other = relengthened(&robot, || rng.random_range(0.3..3.0));
            assert_hold(&formulas, &other, &structural(&other, Columns::RIGID_ROTOR_FRICTION));
        }
    }
}

#[test]
fn identity_formulas_of_random_chains_evaluate_to_their_coefficients() {
    let mut rng = Seed::new(13).stream("lengths", 0);
    let (mut all, mut unknown) = (0, 0);
    for (robot, columns) in random_chains(105) {
        let base = structural(&robot, columns);
        let formulas = base.formulas(&robot);
        assert_hold(&formulas, &robot, &base);
        let terms: usize = formulas.iter().map(|formula| formula.terms.len()).sum();
        all += terms;
        unknown += numbers(&formulas);
        if numbers(&formulas) == 0 {
            let other = relengthened(&robot, || rng.random_range(0.5..2.0));
            assert_hold(&formulas, &other, &structural(&other, columns));
        }
    }
    // One angle in five is oblique and brings sums of many products; what is left is printed as a number.
    assert!(unknown * 10 < all, "{unknown} of {all} coefficients without a formula");
}

#[test]
fn identity_printed_texts_read_back() {
    let mut rng = Seed::new(14).stream("parameters", 0);
    let bundled = bundled_robots().into_iter().map(|robot| (robot, Columns::RIGID_ROTOR_FRICTION));
    for (robot, columns) in bundled.chain(random_chains(35)) {
        let base = structural(&robot, columns);
        let phi = DVector::from_fn(base.parameters.len(), |_, _| rng.random_range(0.5..1.5));
        let mut values: HashMap<String, f64> =
            base.parameters.iter().map(ToString::to_string).zip(phi.iter().copied()).collect();
        for (i, joint) in robot.joints().iter().enumerate() {
            let (_, row) = joint.dh.unwrap();
            for (name, value) in [
                ("a", row.a),
                ("d", row.d),
                ("sin(α", row.alpha_deg.to_radians().sin()),
                ("cos(α", row.alpha_deg.to_radians().cos()),
                ("sin(θ", row.offset_deg.to_radians().sin()),
                ("cos(θ", row.offset_deg.to_radians().cos()),
            ] {
                let end = if name.len() > 1 { ")" } else { "" };
                values.insert(format!("{name}{}{end}", i + 1), value);
            }
        }
        let beta = base.beta(&phi);
        for (row, text) in base.expressions(&robot).iter().enumerate() {
            let size: f64 = base.terms(row).iter().map(|(_, c)| c.abs() * 1.5).sum();
            let read = Reader::new(text, &values).sum();
            // 12 digits where a number is printed.
            assert!((read - beta[row]).abs() <= 1e-10 * size, "{text}: {read} {}", beta[row]);
        }
    }
}

/// Reads a printed formula: sums of products and quotients, brackets, superscripts.
struct Reader<'a> {
    rest: std::iter::Peekable<std::vec::IntoIter<char>>,
    values: &'a HashMap<String, f64>,
}

impl<'a> Reader<'a> {
    fn new(text: &str, values: &'a HashMap<String, f64>) -> Self {
        let characters: Vec<char> = text.chars().filter(|c| *c != ' ').collect();
        Self { rest: characters.into_iter().peekable(), values }
    }

    fn take(&mut self, wanted: char) -> bool {
        self.rest.next_if_eq(&wanted).is_some()
    }

    fn sum(&mut self) -> f64 {
        let mut total = if self.take('−') { -self.product() } else { self.product() };
        loop {
            if self.take('+') {
                total += self.product();
            } else if self.take('−') {
                total -= self.product();
            } else {
                return total;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut total = self.factor();
        loop {
            if self.take('·') {
                total *= self.factor();
            } else if self.take('/') {
                total /= self.factor();
            } else {
                return total;
            }
        }
    }

    fn factor(&mut self) -> f64 {
        let value = if self.take('(') {
            let inner = self.sum();
            assert!(self.take(')'));
            inner
        } else {
            let mut word = String::new();
            while let Some(c) = self.rest.next_if(|c| c.is_ascii_alphanumeric() || *c == '.') {
                word.push(c);
            }
            if self.rest.peek() == Some(&'(') {
                while !word.ends_with(')') {
                    word.extend(self.rest.next());
                }
            }
            word.parse().unwrap_or_else(|_| *self.values.get(&word).unwrap_or_else(|| panic!("unknown {word}")))
        };
        let exponent = self.rest.next_if(|c| "²³⁴".contains(*c)).map_or(1, |c| match c {
            '²' => 2,
            '³' => 3,
            _ => 4,
        });
        value.powi(exponent)
    }
}
