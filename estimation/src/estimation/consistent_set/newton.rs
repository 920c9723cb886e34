//! Newton's method inside the consistent sets.
//!
//! ```text
//! step η in coordinates in which all but the data has unit curvature, V = K J, λ the weight of the data:
//!     (V Vᵀ + C/λ) z = r − V g        η = −g − Vᵀ z        δ² = ηᵀη + λ (V η)ᵀ C⁻¹ (V η)
//! (a horizon adds a row to V, and 1 to C/λ)
//! length t:   δ² (1 − t) + t² Σ c e³/(1 + t e) = 0
//! ```
//! The factor of the b × b matrix is that of a QR of `[ V  C^{½}/√λ ]ᵀ`: nothing is squared, so neither a large λ nor a link on the
//! edge of what is possible spoils it; λ = ∞ is the equation K φ = β̂ itself. e are the relative changes of what stands in the
//! logarithms, so the length is the exact minimum along the step and stays inside.
//!
//! Reference: Y. Nesterov, "Lectures on Convex Optimization", Springer, 2018, sections 5.2 and 5.3.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::coordinates::{Coordinates, Logarithms};
use super::prior::{NEAREST, Prior, Weights};
use super::region::Region;
use crate::estimation::error::EstimationError;
use crate::linalg::{RowFactor, product};

/// Newton steps for one λ: some ten are enough but where links must grow far beyond the guess.
pub(super) const STEPS: usize = 300;

/// Times that what is left of the equations of a step is solved again.
const REFINEMENTS: usize = 2;

/// Squared decrement below which only rounding keeps it from falling as fast as Newton's method does.
const ROUNDING: f64 = 1e-4;

/// Halvings of an interval that holds the length.
const HALVINGS: usize = 60;

/// The longest step, in lengths of Newton's.
const LONGEST: f64 = 1e6;

/// Steps onto the sets with the estimated base parameters.
const PROJECTIONS: usize = 3;

/// Part of what is summed to a base parameter that a set with the estimated one may be away from it.
const EXACT: f64 = 1e-10;

/// The estimated base parameters: `r = K φ − β̂` with its covariance C and information C⁻¹.
pub(super) struct DataTerm<'a> {
    k: &'a DMatrix<f64>,
    beta: &'a DVector<f64>,
    information: DMatrix<f64>,
    /// Lower factor of C.
    root: DMatrix<f64>,
}

impl<'a> DataTerm<'a> {
    /// Of K (b × p), β̂ (b), its information and its covariance (b × b).
    ///
    /// # Errors
    /// [`EstimationError::NotDefinite`] where the covariance is none.
    pub(super) fn of(
        k: &'a DMatrix<f64>,
        beta: &'a DVector<f64>,
        information: DMatrix<f64>,
        covariance: &DMatrix<f64>,
    ) -> Result<Self, EstimationError> {
        // In units in which its diagonal is one.
        let unit = covariance.diagonal().map(f64::sqrt);
        let b = unit.len();
        let scaled =
            DMatrix::from_fn(b, b, |i, j| 0.5 * (covariance[(i, j)] + covariance[(j, i)]) / (unit[i] * unit[j]));
        let lower = Cholesky::new(scaled).ok_or(EstimationError::NotDefinite)?.l();
        let root = DMatrix::from_fn(b, b, |i, j| unit[i] * lower[(i, j)]);
        Ok(Self { k, beta, information, root })
    }

    /// The base parameters K φ.
    pub(super) fn base(&self, phi: &DVector<f64>) -> DVector<f64> {
        self.k * phi
    }

    /// This data term around other base parameters.
    pub(super) fn at<'b>(&self, beta: &'b DVector<f64>) -> DataTerm<'b>
    where
        'a: 'b,
    {
        DataTerm { k: self.k, beta, information: self.information.clone(), root: self.root.clone() }
    }

    /// K φ − β̂.
    pub(super) fn residual(&self, phi: &DVector<f64>) -> DVector<f64> {
        self.k * phi - self.beta
    }

    /// χ², the squared Mahalanobis distance of a set from the estimate.
    pub(super) fn chi_squared(&self, phi: &DVector<f64>) -> f64 {
        self.square(&self.residual(phi))
    }

    /// `β̂ᵀ C⁻¹ β̂`.
    pub(super) fn size_of_estimate(&self) -> f64 {
        self.square(self.beta)
    }

    /// `(K φ)ᵀ C⁻¹ K φ`.
    pub(super) fn size_of(&self, phi: &DVector<f64>) -> f64 {
        self.square(&self.base(phi))
    }

    fn square(&self, r: &DVector<f64>) -> f64 {
        r.dot(&(&self.information * r))
    }
}

/// Where a minimisation ended.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) phi: DVector<f64>,
    pub(super) iterations: usize,
    /// δ: how far from the minimum, in its own curvature.
    pub(super) decrement: f64,
    pub(super) ending: Ending,
}

/// How a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// At the minimum.
    Reached,
    /// Rounding hides the way on.
    Stalled,
    /// After as many steps as are allowed.
    StepLimit,
    /// The equations of a step have no solution.
    Singular,
}

/// The linear equations of a step.
pub(super) struct StepEquations {
    /// b.
    base: usize,
    coordinates: Coordinates,
    /// V, b × p, and a row more where the horizon counts.
    seen: DMatrix<f64>,
    /// R with `RᵀR = V Vᵀ + C/λ` (1 for the horizon), and the units of its columns.
    triangle: DMatrix<f64>,
    unit: DVector<f64>,
    /// Lower factor of what stands beside V Vᵀ.
    beside: DMatrix<f64>,
}

impl StepEquations {
    /// `None` where the set is not consistent, or the equations are singular.
    pub(super) fn of(
        phi: &DVector<f64>,
        region: &Region,
        data: &DataTerm<'_>,
        prior: Prior,
        weights: Weights,
    ) -> Option<Self> {
        let coordinates = Coordinates::at(region, phi, prior, weights)?;
        let seen = coordinates.seen(data.k);
        let ((rows, p), b) = (seen.shape(), data.beta.len());
        let share = if weights.data.is_finite() { 1.0 / weights.data.sqrt() } else { 0.0 };
        // The root of what stands beside V Vᵀ: C/λ, and 1 for the horizon.
        let beside = DMatrix::from_fn(rows, rows, |i, j| match (i < b, j < b) {
            (true, true) => data.root[(i, j)] * share,
            (false, false) => 1.0,
            (true, false) | (false, true) => 0.0,
        });
        let unit = DVector::from_fn(rows, |i, _| {
            let own = if i < b { data.root.row(i).norm() * share } else { 1.0 };
            1.0 / libm::hypot(seen.row(i).norm(), own)
        });
        let mut factor = RowFactor::new(rows);
        factor.add(p, |row, column| seen[(column, row)] * unit[column]);
        if share > 0.0 {
            factor.add(rows, |row, column| beside[(column, row)] * unit[column]);
        }
        let triangle = factor.finish();
        let sound = triangle.iter().all(|x| x.is_finite()) && triangle.diagonal().iter().all(|&x| x != 0.0);
        sound.then_some(Self { base: b, coordinates, seen, triangle, unit, beside })
    }

    /// `(V Vᵀ + C/λ)⁻¹ y`; `None` where a number is none.
    fn solve(&self, y: &DVector<f64>) -> Option<DVector<f64>> {
        let half = self.triangle.tr_solve_upper_triangular(&y.component_mul(&self.unit))?;
        Some(self.triangle.solve_upper_triangular(&half)?.component_mul(&self.unit))
    }

    /// Newton's step in η, with what is left of its equations solved again: V can be 1e12 times what stands beside it.
    fn newton(&self, r: &DVector<f64>) -> Option<DVector<f64>> {
        let mut left = DVector::zeros(self.seen.nrows());
        left.rows_mut(0, r.len()).copy_from(r);
        let r = left.clone();
        let mut eta = -&self.coordinates.gradient;
        left += &self.seen * &eta;
        let mut z = DVector::zeros(left.len());
        for _ in 0..=REFINEMENTS {
            let more = self.solve(&left)?;
            // By what is added, not anew: of η = −g − Vᵀ z little is left, and V would make much of its rounding.
            eta -= self.seen.tr_mul(&more);
            z += more;
            left = &r + &self.seen * &eta - &self.beside * (self.beside.tr_mul(&z));
        }
        Some(eta)
    }

    /// `K H⁻¹ Kᵀ`, b × b, H the Hessian of all but the data.
    pub(super) fn spread(&self) -> DMatrix<f64> {
        let spread = product(&self.seen, &self.seen.transpose());
        (&spread + spread.transpose()) * 0.5
    }
}

/// From a consistent set towards the minimum, until the decrement is below `enough`, by so many steps at most; every iterate is consistent. With λ = ∞ the
/// set that it starts from must have the estimated base parameters, and so has the minimum.
pub(super) fn minimise(
    mut phi: DVector<f64>,
    region: &Region,
    data: &DataTerm<'_>,
    prior: Prior,
    weights: Weights,
    enough: f64,
    steps: usize,
) -> Minimum {
    let mut before = f64::INFINITY;
    for iterations in 0..steps {
        let ended = |phi: DVector<f64>, decrement: f64, ending: Ending| Minimum { phi, iterations, decrement, ending };
        let Some(equations) = StepEquations::of(&phi, region, data, prior, weights) else {
            return ended(phi, f64::INFINITY, Ending::Singular);
        };
        let Some(eta) = equations.newton(&data.residual(&phi)) else {
            return ended(phi, f64::INFINITY, Ending::Singular);
        };
        let shift = &equations.seen * &eta;
        let (seen, horizon) = (shift.rows(0, equations.base).into_owned(), shift.rows_range(equations.base..));
        let pushed = if weights.data.is_finite() { weights.data * data.square(&seen) } else { 0.0 };
        let pushed = pushed + horizon.norm_squared();
        let squared = eta.norm_squared() + pushed;
        if squared.is_nan() {
            return ended(phi, f64::INFINITY, Ending::Singular);
        }
        if squared <= enough * enough || (squared < ROUNDING && squared > 0.25 * before) {
            return ended(phi, squared.sqrt(), Ending::Reached);
        }
        let is_inside = |phi: &DVector<f64>| {
            region.contains(phi) && (weights.horizon == 0.0 || region.growth(phi) < region.horizon())
        };
        let step = equations.coordinates.step(&eta);
        let mut length = along(squared, &equations.coordinates.logarithms(&eta));
        let mut trial = &phi + &step * length;
        // Rounding alone can lead outside.
        while !is_inside(&trial) && length > f64::EPSILON {
            length *= 0.5;
            trial = &phi + &step * length;
        }
        if !is_inside(&trial) {
            return ended(phi, squared.sqrt(), Ending::Stalled);
        }
        before = squared;
        phi = trial;
    }
    Minimum { phi, iterations: steps, decrement: before.sqrt(), ending: Ending::StepLimit }
}

/// The length at which the derivative along the step, `−δ² (1 − t) − t² Σ c e³/(1 + t e)`, is zero.
fn along(squared: f64, logarithms: &Logarithms) -> f64 {
    let end = logarithms.iter().map(|&(_, e)| if e < 0.0 { -1.0 / e } else { LONGEST }).fold(LONGEST, f64::min);
    let slope = |t: f64| {
        -squared * (1.0 - t) - t * t * logarithms.iter().map(|&(c, e)| c * e * e * e / (1.0 + t * e)).sum::<f64>()
    };
    let (mut low, mut high) = (0.0, end);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

/// The nearest set, in the curvature at `phi`, with the estimated base parameters: `None` where it is not consistent, or
/// rounding keeps it from having them.
pub(super) fn project(mut phi: DVector<f64>, region: &Region, data: &DataTerm<'_>) -> Option<DVector<f64>> {
    // The first step does it but for rounding, which the others take away.
    for _ in 0..PROJECTIONS {
        let equations = StepEquations::of(&phi, region, data, Prior::None, NEAREST)?;
        let z = equations.solve(&data.residual(&phi))?;
        phi -= equations.coordinates.step(&equations.seen.tr_mul(&z));
        if !region.contains(&phi) {
            return None;
        }
    }
    let size = data.k.abs() * phi.abs();
    let has_them = data.residual(&phi).iter().zip(&size).all(|(residual, size)| residual.abs() <= EXACT * size);
    has_them.then_some(phi)
}

/// The minimum of data and quadratic prior without any constraint: one step.
pub(super) fn unconstrained(region: &Region, data: &DataTerm<'_>, prior: Prior) -> Option<DVector<f64>> {
    let centre = region.centre();
    let equations = StepEquations::of(&centre, region, data, prior, prior.alone())?;
    let eta = equations.newton(&data.residual(&centre))?;
    Some(centre + equations.coordinates.step(&eta))
}
