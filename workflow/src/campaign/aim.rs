//! A target on the base parameters of an arm: the interval of its quantity, and what a design must know of it.
//!
//! ```text
//! parameter j   half width t s_j                                 s_j² = C_jj
//! torque        √(g χ²_h (t/z)² + u²) / √(βᵀ G β)                g = tr((C G)²) / tr(C G)      h = tr(C G)² / tr((C G)²)
//! ```
//! C is the covariance of β̂, and G the mean square of torque on the usual evaluation motions. `eᵀ G e` for `e ~ N(0, C)` is taken for a
//! multiple of χ² with its mean and variance (F. E. Satterthwaite, *Biometrics Bulletin* 2(6), 1946), and z is the normal quantile beside t. u is
//! the torque that the model leaves beyond noise in the last round.

use armid::base::BaseReduction;
use armid::estimation::{Estimate, Measured, payload};
use armid::excitation::EvaluationMotions;
use armid::model::{Columns, ParameterKind};
use armid::regressor::JointTorqueRegressor;
use armid::statistics::{chi_squared_quantile, mean, normal_quantile, student_quantile};
use armid_io::{Error, LoadedRobot, suggestion};
use nalgebra::DMatrix;

use super::stopping::Width;
use super::target::{Quantity, Target};

/// Noise that is left where only errors of the model are looked at: covariances have to stay definite.
const QUIET: f64 = 1e-6;

/// A target, and what it is computed by.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    pub(super) target: Target,
    /// Unit of the quantity.
    pub(super) unit: String,
    measure: Measure,
}

#[derive(Clone, Debug)]
enum Measure {
    /// The place of a base parameter.
    Parameter(usize),
    /// Mean square of torque by an error of the parameters, b × b.
    Torque(DMatrix<f64>),
    /// The symbol of a parameter of the load, with what the load adds to.
    Payload { symbol: &'static str, base: Box<BaseReduction>, without: Box<Estimate> },
}

impl Aim {
    /// A target on the base of these columns; `without` is the arm without its load.
    ///
    /// # Errors
    /// [`Error`] where its name is none of the base parameters, or of a load.
    pub(super) fn of(
        target: Target,
        loaded: &LoadedRobot,
        (base, columns): (&BaseReduction, Columns),
        without: Option<&Estimate>,
    ) -> Result<Self, Error> {
        let unknown = |names: &[&str], found: &str| {
            Error::unknown(format!("\"{target}\": \"{found}\" is no base parameter of \"{}\"", loaded.robot.name()))
                .help(suggestion::help(found, names))
        };
        let (unit, measure) = match &target.quantity {
            Quantity::Parameter(name) => {
                let names = base.names();
                let Some(place) = names.iter().position(|of| of == name) else {
                    return Err(unknown(&names.iter().map(String::as_str).collect::<Vec<_>>(), name));
                };
                let id = base.parameters[base.kept[place]];
                (id.kind.unit(loaded.robot.joints()[id.index].kind), Measure::Parameter(place))
            }
            Quantity::Torque => {
                let regressor = match loaded.guess() {
                    // Friction of the load is that of the load by the guess, as in designs.
                    Some(guess) => JointTorqueRegressor::with_load(&loaded.robot, columns, guess),
                    None => JointTorqueRegressor::new(&loaded.robot, columns).map_err(Error::new)?,
                };
                let motions = EvaluationMotions::default_for(&loaded.robot).map_err(Error::new)?;
                (
                    loaded.robot.joints()[0].kind.effort_unit(),
                    Measure::Torque(motions.gram(&loaded.robot, &regressor, base)),
                )
            }
            Quantity::Payload(name) => {
                let symbols = ParameterKind::LINK.map(|kind| kind.symbol());
                let Some(place) = symbols.iter().position(|symbol| *symbol == name.as_str()) else {
                    return Err(unknown(&symbols, name));
                };
                let without =
                    without.ok_or_else(|| Error::new(format!("\"{target}\" needs the arm without its load")))?;
                let (base, without) = (Box::new(base.clone()), Box::new(without.clone()));
                let kind = armid::model::JointKind::Revolute;
                (ParameterKind::LINK[place].unit(kind), Measure::Payload { symbol: symbols[place], base, without })
            }
        };
        let unit = unit.to_owned();
        Ok(Self { target, unit, measure })
    }

    /// The interval of the quantity by all rounds so far, which misses it with this probability at most.
    ///
    /// # Errors
    /// [`Error`] where the estimate shows nothing of a load.
    pub(super) fn width(&self, estimate: &Estimate, chance: f64) -> Result<Width, Error> {
        let t = student_quantile(1.0 - 0.5 * chance, estimate.degrees_of_freedom);
        let (all, noise) = (estimate.covariance_matrix(), estimate.noise_covariance_matrix());
        let error = &all - &noise;
        let found = match &self.measure {
            &Measure::Parameter(j) => Width {
                value: estimate.base[j].value,
                half_width: t * all[(j, j)].max(0.0).sqrt(),
                by_model_error: t * error[(j, j)].max(0.0).sqrt(),
            },
            Measure::Torque(gram) => {
                let (z, beta) = (normal_quantile(1.0 - 0.5 * chance), estimate.beta());
                let unexplained = unexplained(estimate);
                let upper = |of: &DMatrix<f64>| (largest(of, gram, chance) * (t / z).powi(2) + unexplained).sqrt();
                let value = beta.dot(&(gram * &beta)).max(0.0).sqrt();
                Width { value, half_width: upper(&all), by_model_error: upper(&error) }
            }
            Measure::Payload { symbol, base, without } => {
                let shown = |with: &Estimate| {
                    let found = payload(base, without, with).map_err(Error::new)?;
                    let below = found.negative_mass.filter(|_| *symbol == ParameterKind::M.symbol()).map(|of| of.free);
                    let parameter = found.parameters.into_iter().find(|of| of.name == *symbol);
                    Ok::<_, Error>(parameter.and_then(|of| of.shown).or(below))
                };
                let quiet = error + noise * QUIET;
                let rows = quiet.row_iter().map(|row| row.iter().copied().collect()).collect();
                let quiet = shown(&Estimate { covariance: rows, noise_covariance: Vec::new(), ..estimate.clone() })?;
                let half = |of: Option<Measured>| of.map_or(f64::INFINITY, |of| t * of.std);
                let found = shown(estimate)?;
                let value = found.map_or(f64::NAN, |of| of.value);
                // What no motion shows is no error of the model.
                Width { value, half_width: half(found), by_model_error: quiet.map_or(0.0, |of| half(Some(of))) }
            }
        };
        // A quantile of a part may be above that of the whole, where both are of sums of squares.
        let found = Width { by_model_error: found.by_model_error.min(found.half_width), ..found };
        Ok(if self.target.is_share { found.relative() } else { found })
    }

    /// A of the criterion `tr(A M⁻¹)` in which a target that is just met counts one; none of a load, which has its own.
    pub(super) fn form(&self, estimate: &Estimate) -> Option<DMatrix<f64>> {
        let limit = |value: f64| if self.target.is_share { self.target.limit() * value } else { self.target.limit() };
        match &self.measure {
            &Measure::Parameter(j) => {
                let mut form = DMatrix::zeros(estimate.base.len(), estimate.base.len());
                form[(j, j)] = limit(estimate.base[j].value).powi(-2);
                Some(form)
            }
            Measure::Torque(gram) => {
                let beta = estimate.beta();
                Some(gram / limit(beta.dot(&(gram * &beta)).sqrt()).powi(2))
            }
            Measure::Payload { .. } => None,
        }
    }
}

/// What the mean square of torque, by an error with covariance `c`, exceeds with half of this probability.
fn largest(c: &DMatrix<f64>, gram: &DMatrix<f64>, chance: f64) -> f64 {
    let both = c * gram;
    let (first, square) = (both.trace(), (&both * &both).trace());
    if first > 0.0 && square > 0.0 {
        square / first * chi_squared_quantile(1.0 - 0.5 * chance, first * first / square)
    } else {
        0.0
    }
}

/// Mean square over the joints of the torque that the model leaves beyond noise.
fn unexplained(estimate: &Estimate) -> f64 {
    let joints = estimate.residual_rms.iter().zip(&estimate.noise_std);
    let beyond: Vec<f64> = joints.map(|(residual, noise)| (residual * residual - noise * noise).max(0.0)).collect();
    mean(&beyond)
}

#[cfg(test)]
mod tests {
    use super::largest;
    use armid::statistics::normal_quantile;
    use nalgebra::DMatrix;

    #[test]
    fn analytic_torque_of_a_campaign_by_one_parameter_and_by_many_alike() {
        // By one parameter with variance 4 and gram 9, the mean square is 36 times a squared normal variable.
        let (c, gram) = (DMatrix::from_element(1, 1, 4.0), DMatrix::from_element(1, 1, 9.0));
        let z = normal_quantile(1.0 - 0.25 * 0.05);
        assert!((largest(&c, &gram, 0.05) / (36.0 * z * z) - 1.0).abs() < 1e-6);
        // χ² of 60 degrees of freedom (Abramowitz and Stegun, table 26.8).
        let many = DMatrix::identity(60, 60);
        assert!((largest(&many, &many, 0.05) - 83.2977).abs() < 1e-4);
        assert_eq!(largest(&DMatrix::zeros(2, 2), &DMatrix::identity(2, 2), 0.05), 0.0);
    }
}
