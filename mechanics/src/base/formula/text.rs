//! A base parameter as text.

use crate::model::term::Dimension;
use std::fmt;

use super::coefficient::{Coefficient, Product};
use super::family::Family;
use super::recognise::coefficient;
use crate::base::geometry::Geometry;
use crate::base::reduction::BaseReduction;
use crate::model::{JointKind, ParameterId, ParameterKind, Robot};

/// One base parameter: the parameters that it sums, each with its coefficient, in order.
///
/// Prints as `m2 − Izz2/a2² + m3 + m4 + m5 + m6`.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// The terms; the first is the parameter that stands for the sum, with coefficient 1.
    pub terms: Vec<(ParameterId, Coefficient)>,
}

impl BaseReduction {
    /// Each base parameter as a formula in the robot's own DH lengths.
    ///
    /// A coefficient of a reduction on a trajectory gets a formula only where it equals that of the robot's full
    /// reduction; others are printed as numbers.
    pub fn formulas(&self, robot: &Robot) -> Vec<Formula> {
        let family = Family::of(&Geometry::of(robot), &self.parameters, self.base_motion);
        let index_of = |id: ParameterId| self.parameters.iter().position(|&other| other == id);
        let term = |row: usize, id: ParameterId, value: f64| {
            let exact = family.as_ref().and_then(|family| {
                let full = &family.original.reduction;
                let own = full.kept.iter().position(|kept| *kept == self.kept[row])?;
                let column = index_of(id)?;
                let same = (full.k[(own, column)] - value).abs() <= SAME * value.abs();
                let degree = degree(robot, self.parameters[self.kept[row]]) - degree(robot, id);
                same.then(|| coefficient(family, own, column, degree))
            });
            (id, exact.unwrap_or(Coefficient::Number(value)))
        };
        (0..self.rank())
            .map(|row| Formula { terms: self.terms(row).into_iter().map(|(id, value)| term(row, id, value)).collect() })
            .collect()
    }

    /// [`BaseReduction::formulas`] as texts.
    ///
    /// ```
    /// # use armid_mechanics as armid;
    /// # use armid::{base::{Method, reduce}, model::Columns, seed::Seed};
    /// # let robot = armid::chains::planar_2r();
    /// let base = reduce(&robot, Columns::RIGID_ROTOR, Method::Structural, Seed::new(1))?;
    /// assert_eq!(base.expressions(&robot)[0], "m1 − Izz1/a1² + Izz2/a2² − Ia1/a1²");
    /// # Ok::<(), armid::base::BaseError>(())
    /// ```
    pub fn expressions(&self, robot: &Robot) -> Vec<String> {
        self.formulas(robot).iter().map(Formula::to_string).collect()
    }
}

/// Two values of a coefficient by different methods are the same up to this fraction.
const SAME: f64 = 1e-7;

/// Dimension of a parameter in lengths.
fn degree(robot: &Robot, id: ParameterId) -> i32 {
    let prismatic = robot.joints()[id.index].kind == JointKind::Prismatic;
    match id.kind {
        ParameterKind::M => 0,
        ParameterKind::Mcx | ParameterKind::Mcy | ParameterKind::Mcz => 1,
        // An effort is mass · length / s² at a prismatic joint, one length more at a revolute one; so is its
        // coordinate.
        ParameterKind::Term(term) => {
            let Dimension { effort, coordinate, .. } = term.entry().dimension;
            (1 - effort) * (1 + i32::from(!prismatic)) - coordinate * i32::from(prismatic)
        }
        _ => 2,
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (position, (id, coefficient)) in self.terms.iter().enumerate() {
            let (negative, text) = term(coefficient, &id.to_string());
            match (position, negative) {
                (0, false) => {}
                (0, true) => f.write_str("−")?,
                (_, false) => f.write_str(" + ")?,
                (_, true) => f.write_str(" − ")?,
            }
            f.write_str(&text)?;
        }
        Ok(())
    }
}

/// Coefficient times name: its sign, and the text without it.
fn term(coefficient: &Coefficient, name: &str) -> (bool, String) {
    match coefficient {
        Coefficient::Number(value) => (*value < 0.0, format!("{}·{name}", digits(value.abs()))),
        Coefficient::Sum(products) => match products.as_slice() {
            [product] => (product.numerator < 0, absolute(product, Some(name))),
            products => {
                let negative = products.iter().all(|product| product.numerator < 0);
                (negative, format!("({})·{name}", sum(products, negative)))
            }
        },
    }
}

/// The products one after the other, all signs turned where `turned`.
fn sum(products: &[Product], turned: bool) -> String {
    let mut text = String::new();
    for (position, product) in products.iter().enumerate() {
        let minus = (product.numerator < 0) != turned;
        text.push_str(match (position, minus) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => " + ",
            (_, true) => " − ",
        });
        text.push_str(&absolute(product, None));
    }
    text
}

/// A product without its sign, with the parameter's name among the factors above the line.
fn absolute(product: &Product, name: Option<&str>) -> String {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    if product.numerator.abs() != 1 {
        above.push(product.numerator.abs().to_string());
    }
    if product.denominator != 1 {
        below.push(product.denominator.to_string());
    }
    for &(symbol, exponent) in &product.powers {
        let side = if exponent > 0 { &mut above } else { &mut below };
        side.push(format!("{symbol}{}", superscript(exponent.unsigned_abs())));
    }
    above.extend(name.map(str::to_owned));
    if above.is_empty() {
        above.push("1".to_owned());
    }
    match below.as_slice() {
        [] => above.join("·"),
        [one] => format!("{}/{one}", above.join("·")),
        many => format!("{}/({})", above.join("·"), many.join("·")),
    }
}

/// An exponent as superscript digits; nothing for 1.
fn superscript(exponent: u32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if exponent == 1 {
        return String::new();
    }
    exponent.to_string().bytes().map(|digit| DIGITS[usize::from(digit - b'0')]).collect()
}

/// A positive number with 12 significant digits, without trailing zeros.
fn digits(value: f64) -> String {
    format!("{value:.11e}").parse::<f64>().map_or_else(|_| value.to_string(), |rounded| rounded.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::formula::{Quantity, Symbol};
    use crate::model::term::ROTOR;

    #[test]
    fn analytic_texts() {
        let a2 = Symbol { quantity: Quantity::A, joint: 1 };
        let d4 = Symbol { quantity: Quantity::D, joint: 3 };
        let product = |numerator, denominator, powers: &[(Symbol, i32)]| Product {
            numerator,
            denominator,
            powers: powers.to_vec(),
        };
        let id = |kind, index| ParameterId { kind, index };
        let formula = Formula {
            terms: vec![
                (id(ParameterKind::M, 1), Coefficient::Sum(vec![product(1, 1, &[])])),
                (id(ParameterKind::Izz, 1), Coefficient::Sum(vec![product(-1, 1, &[(a2, -2)])])),
                (id(ParameterKind::Mcy, 3), Coefficient::Sum(vec![product(2, 1, &[(d4, 1)])])),
                (id(ParameterKind::Mcz, 3), Coefficient::Sum(vec![product(-1, 2, &[(a2, -1), (d4, 2)])])),
                (
                    id(ParameterKind::M, 4),
                    Coefficient::Sum(vec![product(-1, 1, &[(a2, 2)]), product(-3, 1, &[(d4, 10)])]),
                ),
                (id(ParameterKind::M, 5), Coefficient::Sum(vec![product(1, 1, &[]), product(-1, 1, &[(d4, 1)])])),
                (id(ParameterKind::Term(ROTOR), 5), Coefficient::Number(-1.0 / 3.0)),
            ],
        };
        assert_eq!(
            formula.to_string(),
            "m2 − Izz2/a2² + 2·d4·mcy4 − d4²·mcz4/(2·a2) − (a2² + 3·d4¹⁰)·m5 + (1 − d4)·m6 − 0.333333333333·Ia6"
        );
    }
}
