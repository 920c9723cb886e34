//! A load, by two estimates of one arm.

use super::body::PayloadBody;
use super::change::{Change, Fitted};
use crate::base::{BaseReduction, Category};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{BaseEstimate, Estimate, rows_of};
use crate::estimation::measured::Measured;
use crate::estimation::termination::Termination;
use crate::model::{JointKind, ParameterKind};
use crate::statistics::student_quantile;

/// Place of the mass among the ten.
const MASS: usize = 0;

/// Standard deviations wider than by this factor: the arm changed in more than a load.
const TOO_WIDE: f64 = 3.0;

/// One of the load's ten parameters.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PayloadParameter {
    /// Symbol: `m`, `mcx`, …, `Izz`.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Estimate with its standard deviation and 95 % interval; `None` where the motion does not show it alone, and for a mass below zero.
    pub shown: Option<Measured>,
    /// Its value in the body.
    pub consistent: f64,
}

/// A mass below zero, as no load has.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct NegativeMass {
    /// The free estimate.
    pub free: Measured,
    /// Why it is.
    pub cause: NegativeMassCause,
}

/// Why a free estimate of a mass is below zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NegativeMassCause {
    /// More than a load changed between the logs.
    ArmChanged,
    /// The arm is lighter with the load than without it: logs are exchanged, or their torques have the wrong sign.
    Lighter,
    /// The interval holds zero: there is no load, or the motion does not show it.
    NotShown,
}

/// A load on the last link.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// The ten, in the frame of the last link.
    pub parameters: Vec<PayloadParameter>,
    /// The combinations of them that the motion shows, with their covariance.
    pub combinations: Estimate,
    /// What the combinations are made of: coefficients of the ten.
    pub base: BaseReduction,
    /// The body that agrees best with them.
    pub body: PayloadBody,
    /// The mass, where its free estimate is below zero.
    pub negative_mass: Option<NegativeMass>,
    /// Standard deviation of the change of friction between the logs, as a part of it, as far as the logs show it.
    pub friction_change: f64,
    /// Standard deviation of the change of offsets between the logs, as a part of the RMS residual of their joints.
    pub offset_change: f64,
    /// Squared distance of the change from that of any load, in standard deviations.
    pub chi_squared: f64,
    /// What it exceeds with a probability of 5 % where the covariances are right.
    pub chi_squared_limit: f64,
    /// Factor on the standard deviations, 1 where the change scatters no more than the covariances say.
    pub widened_by: f64,
}

/// The load by which an arm `with` it differs from the same arm `without`.
///
/// # Errors
/// [`EstimationError::OtherBase`] where an estimate is not one of this base, [`EstimationError::OtherRobot`] where they are of two
/// robots, [`EstimationError::NotDefinite`] where their covariances are none, [`EstimationError::NothingShared`] where the motion shows
/// nothing of a load.
pub fn payload(base: &BaseReduction, without: &Estimate, with: &Estimate) -> Result<Payload, EstimationError> {
    if without.robot != with.robot {
        let (first, second) = (without.robot.clone(), with.robot.clone());
        return Err(EstimationError::OtherRobot { first, second });
    }
    for estimate in [without, with] {
        if estimate.names() != base.names() {
            return Err(EstimationError::OtherBase { found: estimate.names(), expected: base.names() });
        }
    }
    let load = base.of_load();
    if load.rank() == 0 {
        return Err(EstimationError::NothingShared);
    }
    let freedom = without.degrees_of_freedom.min(with.degrees_of_freedom);
    let fitted = Change::between(base, without, with).fitted(base, &load)?;
    let combinations = estimate(with, &load, &fitted, freedom);
    let body = PayloadBody::of(&load, &fitted)?;
    let shown = |column: usize| -> Option<Measured> {
        let row = load.kept.iter().position(|&kept| kept == column)?;
        let &BaseEstimate { value, std, ci95, .. } = &combinations.base[row];
        (load.categories[column] == Category::Identifiable).then_some(Measured { value, std, ci95 })
    };
    let below = shown(MASS).filter(|free| free.value < 0.0);
    let negative_mass = below.map(|free| NegativeMass { free, cause: NegativeMassCause::of(&free, fitted.widened_by) });
    let parameter = |(column, kind): (usize, &ParameterKind)| PayloadParameter {
        name: kind.symbol().to_owned(),
        unit: kind.unit(JointKind::Revolute),
        shown: match column {
            MASS => shown(MASS).filter(|_| below.is_none()).map(not_negative),
            _ => shown(column),
        },
        consistent: body.inertia.to_array()[column],
    };
    Ok(Payload {
        parameters: ParameterKind::LINK.iter().enumerate().map(parameter).collect(),
        body,
        negative_mass,
        friction_change: fitted.friction_change,
        offset_change: fitted.offset_change,
        chi_squared: fitted.chi_squared,
        chi_squared_limit: fitted.limit,
        widened_by: fitted.widened_by,
        combinations,
        base: load,
    })
}

impl Payload {
    /// Whether the arm changed as a load on its last link changes it.
    pub fn is_of_a_load(&self) -> bool {
        self.widened_by <= TOO_WIDE
    }
}

/// Of the interval, the part that is not below zero.
fn not_negative(value: Measured) -> Measured {
    Measured { ci95: value.ci95.map(|end| end.max(0.0)), ..value }
}

impl NegativeMassCause {
    fn of(free: &Measured, widened_by: f64) -> Self {
        match free.ci95[1] < 0.0 {
            _ if widened_by > TOO_WIDE => Self::ArmChanged,
            true => Self::Lighter,
            false => Self::NotShown,
        }
    }
}

/// The combinations as an estimate of one body.
fn estimate(of: &Estimate, load: &BaseReduction, fitted: &Fitted, freedom: f64) -> Estimate {
    let t = student_quantile(0.975, freedom);
    let parameter = |(row, name): (usize, String)| {
        let (value, std) = (fitted.values[row], fitted.covariance[(row, row)].max(0.0).sqrt());
        let unit = load.parameters[load.kept[row]].kind.unit(JointKind::Revolute).to_owned();
        BaseEstimate { name, value, std, ci95: [value - t * std, value + t * std], unit, declared_std: 0.0 }
    };
    Estimate {
        columns: "rigid".to_owned(),
        base: load.names().into_iter().enumerate().map(parameter).collect(),
        covariance: rows_of(&fitted.covariance),
        noise_covariance: Vec::new(),
        motor_errors: Vec::new(),
        servo: Vec::new(),
        standard: None,
        consistent: None,
        degrees_of_freedom: freedom,
        effects: Vec::new(),
        findings: Vec::new(),
        termination: Termination::Direct,
        ..of.clone()
    }
}
