//! The change of the base parameters between two logs, and what of it is a load's.
//!
//! ```text
//! d = K θ + u        u ~ N(0, w² V)        V = C + s_F² diag(x²) + s_O² diag(r²)        w² = max(1, χ²/ν)        χ² = uᵀ V⁻¹ u
//! −2 ln L(s_F, s_O) = ν ln w² + χ²/w² + ln det V + ln det KᵀV⁻¹K
//! θ̂ = E[θ(s)]        cov θ̂ = E[w² (KᵀV⁻¹K)⁻¹] + cov θ(s)        over s_F, s_O in proportion to L
//! ```
//! C is the sum of both covariances less what one declared error of a motor does to both estimates alike: D₀ D₁ᵀ and its transpose, with
//! D its shifts of β̂.
//!
//! x are coefficients of friction, and r at offsets the residual of their joint, means of both logs. L is the restricted likelihood, over θ
//! and, where the estimates scatter more than they say, over w. ν counts the rows less those that θ takes. With means over s in place of the
//! likeliest s, intervals know that few joints say how much changed.

use std::ops::RangeInclusive;

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::base::{BaseReduction, LOAD_UNITS};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::linalg::product;
use crate::model::term::Structure;
use crate::statistics::chi_squared_quantile;

/// Level of the test that the change of the arm is that of a load.
const CONFIDENCE: f64 = 0.95;

/// Octaves of s_F and s_O, which may be zero too: to all of friction, and beyond all that a fit leaves.
const FRICTION: RangeInclusive<i32> = -5..=0;
const OFFSETS: RangeInclusive<i32> = -3..=4;

/// β_with − β_without.
pub(super) struct Change {
    values: DVector<f64>,
    covariance: DMatrix<f64>,
    /// x, zero in other rows.
    friction: DVector<f64>,
    /// r, zero in other rows.
    offsets: DVector<f64>,
}

/// The load's combinations, fitted to a change.
pub(super) struct Fitted {
    pub(super) values: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    pub(super) chi_squared: f64,
    pub(super) limit: f64,
    pub(super) widened_by: f64,
    /// Root mean square of s_F.
    pub(super) friction_change: f64,
    /// Root mean square of s_O.
    pub(super) offset_change: f64,
}

/// The fit for one s, of combinations in units of [`LOAD_UNITS`].
struct Fit {
    /// s_F, s_O.
    changes: [f64; 2],
    solution: DVector<f64>,
    /// w² (KᵀV⁻¹K)⁻¹.
    covariance: DMatrix<f64>,
    chi_squared: f64,
    excess: f64,
    /// −2 ln L.
    value: f64,
}

impl Change {
    pub(super) fn between(base: &BaseReduction, without: &Estimate, with: &Estimate) -> Self {
        let mean = |row: usize| 0.5 * (with.base[row].value + without.base[row].value);
        let residual = |joint: usize| {
            let of = |estimate: &Estimate| estimate.residual_rms.get(joint).copied().unwrap_or(0.0);
            0.5 * (of(with) + of(without))
        };
        let (mut friction, mut offsets) = (DVector::zeros(base.rank()), DVector::zeros(base.rank()));
        for (row, &kept) in base.kept.iter().enumerate() {
            let id = base.parameters[kept];
            match id.kind.term().map(|term| term.entry().structure) {
                None | Some(Structure::Inertia) => {}
                Some(Structure::Constant) => offsets[row] = residual(id.index),
                Some(Structure::Viscous | Structure::Function { .. }) => friction[row] = mean(row),
            }
        }
        let mut covariance = with.covariance_matrix() + without.covariance_matrix();
        let [first, second] = [without, with].map(Estimate::motor_errors_matrix);
        if first.ncols() == second.ncols() {
            let shared = product(&first, &second.transpose());
            covariance -= &shared + shared.transpose();
        }
        Self { values: with.beta() - without.beta(), covariance, friction, offsets }
    }

    /// The combinations that the base shows.
    pub(super) fn fitted(&self, base: &BaseReduction, load: &BaseReduction) -> Result<Fitted, EstimationError> {
        let columns = base.columns_of_last_link();
        let unit = |j: usize| LOAD_UNITS[load.kept[j]];
        let k = DMatrix::from_fn(base.rank(), load.rank(), |i, j| base.k[(i, columns[load.kept[j]])] * unit(j));
        let amounts = |octaves: RangeInclusive<i32>| [0.0].into_iter().chain(octaves.map(|k| libm::exp2(f64::from(k))));
        let fits: Vec<Fit> = amounts(FRICTION)
            .flat_map(|friction| amounts(OFFSETS).map(move |offsets| [friction, offsets]))
            .filter_map(|changes| self.fit(&k, changes))
            .collect();
        if fits.is_empty() {
            return Err(EstimationError::NotDefinite);
        }
        let least = fits.iter().map(|fit| fit.value).fold(f64::INFINITY, f64::min);
        let likelihoods: Vec<f64> = fits.iter().map(|fit| libm::exp(0.5 * (least - fit.value))).collect();
        let all: f64 = likelihoods.iter().sum();
        let mean = |of: &dyn Fn(&Fit) -> f64| {
            fits.iter().zip(&likelihoods).map(|(fit, likelihood)| likelihood * of(fit)).sum::<f64>() / all
        };
        let rank = load.rank();
        let solution = DVector::from_fn(rank, |j, _| mean(&|fit| fit.solution[j]));
        let covariance = |i: usize, j: usize| {
            let off = |fit: &Fit, j: usize| fit.solution[j] - solution[j];
            mean(&|fit| fit.covariance[(i, j)] + off(fit, i) * off(fit, j)) * unit(i) * unit(j)
        };
        let freedom = (base.rank() - rank) as f64;
        Ok(Fitted {
            values: DVector::from_fn(rank, |j, _| solution[j] * unit(j)),
            covariance: DMatrix::from_fn(rank, rank, covariance),
            chi_squared: mean(&|fit| fit.chi_squared),
            limit: if freedom > 0.0 { chi_squared_quantile(CONFIDENCE, freedom) } else { 0.0 },
            widened_by: mean(&|fit| fit.excess).sqrt(),
            friction_change: mean(&|fit| fit.changes[0].powi(2)).sqrt(),
            offset_change: mean(&|fit| fit.changes[1].powi(2)).sqrt(),
        })
    }

    /// Generalised least squares by K (b × rank) for s_F and s_O; `None` where V or KᵀV⁻¹K is not positive definite.
    fn fit(&self, k: &DMatrix<f64>, changes: [f64; 2]) -> Option<Fit> {
        let (rows, rank) = k.shape();
        let changed = (&self.friction * changes[0]).map(|x| x * x) + (&self.offsets * changes[1]).map(|x| x * x);
        let std = (self.covariance.diagonal() + &changed).map(f64::sqrt);
        let factor = Cholesky::new(DMatrix::from_fn(rows, rows, |i, j| {
            (self.covariance[(i, j)] + if i == j { changed[i] } else { 0.0 }) / (std[i] * std[j])
        }))?
        .l();
        let a = factor.solve_lower_triangular(&DMatrix::from_fn(rows, rank, |i, j| k[(i, j)] / std[i]))?;
        let y = factor.solve_lower_triangular(&self.values.component_div(&std))?;
        let normal = Cholesky::new(product(&a.transpose(), &a))?;
        let solution = normal.solve(&a.tr_mul(&y));
        let chi_squared = (&y - &a * &solution).norm_squared();
        let freedom = (rows - rank) as f64;
        let excess = if freedom > 0.0 { (chi_squared / freedom).max(1.0) } else { 1.0 };
        let logarithm = |diagonal: DVector<f64>| diagonal.iter().map(|&d| 2.0 * libm::log(d)).sum::<f64>();
        let determinants = logarithm(factor.diagonal()) + logarithm(std) + logarithm(normal.l_dirty().diagonal());
        let value = freedom * libm::log(excess) + chi_squared / excess + determinants;
        let covariance = normal.inverse() * excess;
        value.is_finite().then_some(Fit { changes, solution, covariance, chi_squared, excess, value })
    }
}
