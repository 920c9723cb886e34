//! The coefficients of torque terms, each in a unit of its own.
//!
//! ```text
//! not negative   g (z − ln z)        either sign   ½ g z²        z = x/x⁰
//! ```
//! A rotor inertia that the robot file states has x⁰ from there and g = 1, like a body. Every other coefficient is hardly held: g is
//! small, and x⁰ is the coefficient with which its column alone would be as large as the torque.

use nalgebra::{DMatrix, DVector};

use crate::model::term::{ROTOR, Sign};
use crate::model::{ParameterId, ParameterKind, StandardParameters};

/// g of what the robot file does not state.
const WIDE: f64 = 1e-2;

/// One coefficient.
#[derive(Clone, Debug)]
pub(super) struct Coefficient {
    pub(super) at: usize,
    /// x⁰; zero where no row shows the coefficient, which then stays as the guess has it.
    pub(super) unit: f64,
    weight: f64,
    sign: Sign,
}

impl Coefficient {
    /// Of a column with this length, beside a torque with that one.
    pub(super) fn of(at: usize, id: ParameterId, guess: &StandardParameters, column: f64, torque: f64) -> Option<Self> {
        let ParameterKind::Term(term) = id.kind else { return None };
        let (sign, stated) = (term.entry().sign, guess.get(id));
        let unit = if column > 0.0 { torque.max(f64::MIN_POSITIVE) / column } else { 0.0 };
        let is_stated = term == ROTOR && stated > 0.0 && unit > 0.0;
        let (unit, weight) = if is_stated { (stated, 1.0) } else { (unit, WIDE) };
        Some(Self { at, unit, weight, sign })
    }

    /// z where a search begins.
    pub(super) fn centre(&self) -> f64 {
        match self.sign {
            Sign::NotNegative if self.weight < 1.0 => 0.1,
            Sign::NotNegative => 1.0,
            Sign::Any => 0.0,
        }
    }

    /// Adds `w g (…)` with its derivatives at z; the value. `None` where z is not allowed.
    pub(super) fn add(
        &self,
        w: f64,
        x: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Option<f64> {
        let (z, g) = (x[self.at], w * self.weight);
        let (value, slope, bend) = match self.sign {
            Sign::NotNegative if z > 0.0 => (z - libm::log(z), 1.0 - 1.0 / z, 1.0 / (z * z)),
            Sign::NotNegative => return None,
            Sign::Any => (0.5 * z * z, z, 1.0),
        };
        gradient[self.at] += g * slope;
        hessian[(self.at, self.at)] += g * bend;
        Some(g * value)
    }
}
