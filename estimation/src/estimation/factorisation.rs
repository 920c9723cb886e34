//! One factorisation of a recording, from which every linear estimate follows.
//!
//! ```text
//! W_k, τ_k of sample k       one row of   [ w_1k … w_nk  τ_1k … τ_nk ] = Q R̂       (joint i's equation is w_ik β = τ_ik)
//! ```
//! Rows of R̂ are samples too, as few as there are columns: any sum over samples of products of two equations, with any
//! weights between the joints of a sample, is the same sum over the rows of R̂. So ordinary and weighted least squares,
//! the covariance of a residual, the covariance of β̂ under noise that is white in time, and each repetition of an
//! estimator that finds weights for joints by iteration cost as much as for some hundred samples.
//!
//! ```text
//! e ε √b κ ‖s/σ‖ ≤ 1e-4        s_i = ‖τ_i‖ + Σ_j |β_j| ‖w_ij‖,  σ_i: deviation of joint i's residual
//! ```
//! R̂ of long groups is a root of the columns' products ([`ColumnProducts`](crate::linalg::ColumnProducts)) where that is harmless. Rounding moves a product by at
//! most e errors ε of its columns' lengths. So it moves no estimate by more than the left side, in its own standard deviations, with
//! the condition number κ of the equations that are weighted by 1/σ, of columns of unit length. Squares of joint i's residual change by
//! `e ε s_i²` at most, which is bounded alike.
//! Elsewhere, as on a recording without noise, R̂ is found by reflections ([`RowFactor`]), which square nothing: condition numbers of
//! 1e8 do as little harm as in a QR of W itself. Solutions are found from R̂ by reflections in either case.
//!
//! Samples of which some joints are no equation are a group of their own for each set of such joints. A group that is not longer
//! than two such factors stays as it is.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::discrepancy::Discrepancy;
use super::entries::Entries;
use super::error::EstimationError;
use super::joint_products::JointProducts;
use super::observation::Observation;
use super::omitted::OmittedTorque;
use super::residual::{ResidualScale, scatter_noise};
use crate::linalg::product::add_product;
use crate::linalg::{BlockWhitening, LeastSquares, LeastSquaresError, RowFactor, product};
use crate::signal::Samples;

/// Standard deviations by which rounding of products may move an estimate, and share by which it may move a residual's squares.
const HARMLESS: f64 = 1e-4;

/// The method that condensed the equations of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FactorisedBy {
    /// Products of their columns, which square the condition number. The data showed that it does no harm.
    NormalEquations,
    /// Reflections, or they were few and none was replaced.
    #[default]
    Qr,
}

/// The equations of an observation in as few samples as hold all that linear estimators ask.
///
/// ```
/// # use armid_estimation as armid;
/// # use armid::estimation::{EstimationError, Factorisation, Observation};
/// # use armid::linalg::BlockWhitening;
/// # fn fit(observation: &Observation) -> Result<(), EstimationError> {
/// let equations = Factorisation::new(observation)?;
/// let ordinary = equations.least_squares()?;
/// // Feasible weighted least squares, repeated: neither step reads the recording again.
/// let mut beta = ordinary.solution().clone();
/// for _ in 0..5 {
///     let weights = BlockWhitening::new(&equations.residual_covariance(&beta))?;
///     beta = equations.weighted(&weights)?.solution().clone();
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Factorisation<'a> {
    observation: &'a Observation,
    groups: Vec<SampleGroup>,
    /// The method that condensed the equations.
    pub factorised_by: FactorisedBy,
    ordinary: OnceLock<Result<LeastSquares, EstimationError>>,
    by_scatter: OnceLock<Result<Option<(BlockWhitening, LeastSquares)>, EstimationError>>,
    discrepancy: OnceLock<Result<Option<Discrepancy>, EstimationError>>,
    /// The torque of laws that the model omits, which the intervals of all its estimates include; `None` where it was not looked for.
    pub(super) omitted: Option<OmittedTorque>,
}

/// Samples that have the same joints as equations.
#[derive(Clone, Debug)]
struct SampleGroup {
    used: Vec<bool>,
    /// Equations and torque, (n · samples) × (b + 1), sample by sample as in an observation.
    rows: DMatrix<f64>,
    /// Of the equations, found once.
    products: OnceLock<JointProducts>,
}

impl<'a> Factorisation<'a> {
    /// Reads an observation once: `O(M c²)` for M samples with c columns of all joints that are not zero.
    ///
    /// # Errors
    /// [`EstimationError::LeastSquares`] where there are fewer rows than parameters, sizes do not fit, or a number is not
    /// finite.
    pub fn new(observation: &'a Observation) -> Result<Self, EstimationError> {
        let (n, (rows, columns)) = (observation.dof, observation.regressor.shape());
        for found in [observation.y.len(), observation.used.len()] {
            if found != rows {
                return Err(LeastSquaresError::Shape { found, expected: rows }.into());
            }
        }
        if rows < columns {
            return Err(LeastSquaresError::TooFewRows { rows, columns }.into());
        }
        if !rows.is_multiple_of(n) {
            return Err(LeastSquaresError::Blocks { rows, size: n }.into());
        }
        let patterns = patterns(observation);
        if let Some(found) = Self::by_products(observation, &patterns) {
            return Ok(found);
        }
        let groups: Vec<SampleGroup> = patterns
            .iter()
            .map(|(used, samples)| {
                SampleGroup::new(used, Entries::of(observation, used, samples).rows_by_reflections())
            })
            .collect();
        // A number that is not finite is in the factor too.
        if groups.iter().any(|group| group.rows.iter().any(|value| !value.is_finite())) {
            let w = observation.regressor.iter().enumerate().map(|(at, &value)| (at % rows, value));
            let mut all = w.chain(observation.y.iter().copied().enumerate());
            let (row, value) = all.find(|(_, value)| !value.is_finite()).unwrap_or((0, f64::INFINITY));
            return Err(LeastSquaresError::NotFinite { row, value }.into());
        }
        Ok(Self::of(observation, groups, FactorisedBy::Qr))
    }

    const fn of(observation: &'a Observation, groups: Vec<SampleGroup>, factorised_by: FactorisedBy) -> Self {
        Self {
            observation,
            groups,
            factorised_by,
            ordinary: OnceLock::new(),
            by_scatter: OnceLock::new(),
            discrepancy: OnceLock::new(),
            omitted: None,
        }
    }

    /// Of long groups the factor by products, if there are any and rounding does no harm.
    fn by_products(observation: &'a Observation, patterns: &[(Vec<bool>, Vec<usize>)]) -> Option<Self> {
        let entries: Vec<_> = patterns.iter().map(|(used, samples)| Entries::of(observation, used, samples)).collect();
        if !entries.iter().any(|entries| entries.are_worth_products()) {
            return None;
        }
        let groups = patterns
            .iter()
            .zip(&entries)
            .map(|((used, _), entries)| Some(SampleGroup::new(used, entries.rows_by_products()?)));
        let found = Self::of(observation, groups.collect::<Option<_>>()?, FactorisedBy::NormalEquations);
        let errors = |entries: &Entries<'_>| entries.rounding_errors();
        let errors = entries.iter().map(errors).fold(0.0, f64::max);
        (found.harm(errors)? <= HARMLESS).then_some(found)
    }

    /// Standard deviations by which so many rounding errors of each product move an estimate at most, or the share of a joint's residual
    /// squares if that is more; `None` where a residual is zero. Noise of different joints counts as independent.
    fn harm(&self, errors: f64) -> Option<f64> {
        let (n, b, ordinary) = (self.observation.dof, self.observation.regressor.ncols(), self.least_squares().ok()?);
        let products = self.residual_products(ordinary.solution());
        let covariance = ResidualScale::of(self.observation).covariance(&products);
        let mut weights = DMatrix::identity(n, n);
        // Of ordinary least squares no deviation is below the quietest joint's.
        let (mut weighted, mut all, mut least, mut of_residual) = (0.0, 0.0, f64::INFINITY, 0.0);
        for i in (0..n).filter(|&i| self.groups.iter().any(|group| group.used[i])) {
            let (variance, length) = (covariance[(i, i)], self.summed_length(i, ordinary.solution()));
            let squares = length * length;
            if variance <= 0.0 {
                return None;
            }
            weights[(i, i)] = variance;
            (weighted, all, least) = (weighted + squares / variance, all + squares, f64::min(least, variance));
            of_residual = f64::max(of_residual, squares / products[(i, i)]);
        }
        let weights = BlockWhitening::new(&weights).ok()?;
        let by_weights = self.weighted(&weights).ok()?.condition_scaled() * weighted.sqrt();
        let by_none = ordinary.condition_scaled() * (all / least).sqrt();
        let of_estimates = (b as f64).sqrt() * by_weights.max(by_none);
        Some(errors * f64::EPSILON * of_estimates.max(of_residual)).filter(|harm| harm.is_finite())
    }

    /// `‖τ_i‖ + Σ_j |β_j| ‖w_ij‖` over all samples, for the equations of joint i.
    fn summed_length(&self, i: usize, beta: &DVector<f64>) -> f64 {
        let n = self.observation.dof;
        let squares = |j: usize| {
            let of_group =
                |group: &SampleGroup| group.rows.column(j).iter().skip(i).step_by(n).map(|x| x * x).sum::<f64>();
            self.groups.iter().filter(|group| group.used[i]).map(of_group).sum::<f64>()
        };
        beta.iter()
            .enumerate()
            .fold(squares(beta.len()).sqrt(), |sum, (j, value)| sum + value.abs() * squares(j).sqrt())
    }

    /// The observation that was factored.
    pub const fn observation(&self) -> &'a Observation {
        self.observation
    }

    /// Number of samples that stand for all: those of the groups' factors.
    pub fn samples(&self) -> usize {
        self.groups.iter().map(|group| group.rows.nrows() / self.observation.dof).sum()
    }

    /// Ordinary least squares, found once.
    ///
    /// # Errors
    /// [`EstimationError::NotExcited`] with the parameter's name.
    pub fn least_squares(&self) -> Result<&LeastSquares, EstimationError> {
        self.ordinary.get_or_init(|| self.solve(|group| Ok(group.rows.clone()))).as_ref().map_err(Clone::clone)
    }

    /// Least squares weighted with the scatter over periods, found once, and its weights; `None` where there is none.
    ///
    /// # Errors
    /// As [`Self::weighted`].
    pub(super) fn by_scatter(&self) -> Result<Option<&(BlockWhitening, LeastSquares)>, EstimationError> {
        let found = self.by_scatter.get_or_init(|| {
            let Some(noise) = scatter_noise(self.observation) else { return Ok(None) };
            let weights = BlockWhitening::new(noise.covariance())?;
            let fit = self.weighted(&weights)?;
            Ok(Some((weights, fit)))
        });
        found.as_ref().map(Option::as_ref).map_err(Clone::clone)
    }

    /// What the samples that the equations were made from show of a torque that the model lacks, found once for all estimators;
    /// `None` where they show nothing, and where there is no scatter over periods to compare with. Loads are those of the weighted
    /// fit.
    pub(super) fn discrepancy(&self, samples: &Samples) -> Result<Option<&Discrepancy>, EstimationError> {
        let found = self.discrepancy.get_or_init(|| {
            let Some(noise) = scatter_noise(self.observation) else { return Ok(None) };
            let Some((_, fit)) = self.by_scatter()? else { return Ok(None) };
            let laws = self.omitted.as_ref().map(OmittedTorque::supported);
            let motion = self.omitted.as_ref().and_then(|omitted| omitted.motion.as_ref());
            let beta = fit.solution().as_slice();
            Ok(Discrepancy::find(self.observation, samples, (&noise, motion), beta, laws.as_ref()))
        });
        found.as_ref().map(Option::as_ref).map_err(Clone::clone)
    }

    /// Least squares weighted with the inverse of the covariance of one sample's noise.
    ///
    /// # Errors
    /// As [`Self::least_squares`]; [`EstimationError::LeastSquares`] where the covariance is of another size.
    pub fn weighted(&self, weights: &BlockWhitening) -> Result<LeastSquares, EstimationError> {
        let mut weights = weights.clone();
        self.solve(|group| Ok(weights.whiten(&group.rows, &group.marks())?))
    }

    /// `1/(√(M_i M_j) (1 − b/E)) Σ_k r_ik r_jk` of the residual of β (b), n × n: the covariance of one sample's noise as far
    /// from the residual, R(0) of [`residual_noise`](super::residual_noise).
    pub fn residual_covariance(&self, beta: &DVector<f64>) -> DMatrix<f64> {
        ResidualScale::of(self.observation).covariance(&self.residual_products(beta))
    }

    /// Weights by that covariance. A joint that has no equation, at rest say, has no residual: its weight is one, and nothing is
    /// weighted with it.
    ///
    /// # Errors
    /// [`EstimationError::LeastSquares`] where the covariance of the others is not positive definite.
    pub fn residual_weights(&self, beta: &DVector<f64>) -> Result<BlockWhitening, EstimationError> {
        let (n, mut covariance) = (self.observation.dof, self.residual_covariance(beta));
        for i in 0..n {
            if !self.observation.used.iter().skip(i).step_by(n).any(|&used| used) {
                covariance.row_mut(i).fill(0.0);
                covariance.column_mut(i).fill(0.0);
                covariance[(i, i)] = 1.0;
            }
        }
        Ok(BlockWhitening::new(&covariance)?)
    }

    /// `Σ_k r_k r_kᵀ` over all samples, n × n, for the residual of β (b).
    pub fn residual_products(&self, beta: &DVector<f64>) -> DMatrix<f64> {
        let n = self.observation.dof;
        let mut products = DMatrix::zeros(n, n);
        for group in &self.groups {
            let (rows, b) = (group.rows.nrows(), beta.len());
            let mut residual = group.rows.column(b).into_owned();
            let negative: Vec<f64> = beta.iter().map(|value| -value).collect();
            add_product(&group.rows.as_slice()[..rows * b], &negative, rows, residual.as_mut_slice());
            for r in residual.as_slice().chunks_exact(n) {
                for (j, &rj) in r.iter().enumerate() {
                    for (i, &ri) in r.iter().enumerate() {
                        products[(i, j)] += ri * rj;
                    }
                }
            }
        }
        products
    }

    /// `Σ_k B_kᵀ C B_k`, b × b, with `B_k = P W_k`: P is 1 or the inverse of the covariance that is weighted with, C (n × n)
    /// the covariance of the noise of one sample, white in time.
    ///
    /// # Errors
    /// [`EstimationError::LeastSquares`] where a covariance is of another size.
    pub fn white_noise_products(
        &self,
        weights: Option<&BlockWhitening>,
        covariance: &DMatrix<f64>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let (n, b) = (self.observation.dof, self.observation.regressor.ncols());
        let mut sum = DMatrix::zeros(b, b);
        for group in &self.groups {
            let products = group.products.get_or_init(|| JointProducts::new(&group.rows, b, &group.used));
            sum += match weights {
                Some(weights) => {
                    let weights = weights.clone().precision(&DMatrix::identity(n, n), &group.used)?;
                    products.between(&product(&product(&weights, covariance), &weights))
                }
                None => products.between(covariance),
            };
        }
        Ok(sum)
    }

    fn solve(
        &self,
        mut equations: impl FnMut(&SampleGroup) -> Result<DMatrix<f64>, EstimationError>,
    ) -> Result<LeastSquares, EstimationError> {
        let (n, columns) = (self.observation.dof, self.observation.regressor.ncols() + 1);
        let mut factor = RowFactor::new(columns);
        for group in &self.groups {
            let rows = equations(group)?;
            // Joint by joint, since a joint's rows begin with the same zeros.
            for i in (0..n).filter(|&i| group.used[i]) {
                factor.add(rows.nrows() / n, |k, column| rows[(k * n + i, column)]);
            }
        }
        LeastSquares::from_triangle(&factor.finish()).map_err(|error| self.observation.named(error))
    }
}

impl SampleGroup {
    fn new(used: &[bool], rows: DMatrix<f64>) -> Self {
        Self { used: used.to_vec(), rows, products: OnceLock::new() }
    }

    /// Which rows are equations.
    fn marks(&self) -> Vec<bool> {
        self.used.iter().copied().cycle().take(self.rows.nrows()).collect()
    }
}

/// The sets of joints that are equations of a sample, in the order in which they come, each with its samples.
fn patterns(observation: &Observation) -> Vec<(Vec<bool>, Vec<usize>)> {
    let mut groups: Vec<(Vec<bool>, Vec<usize>)> = Vec::new();
    let mut last = 0;
    for (k, used) in observation.used.chunks_exact(observation.dof).enumerate() {
        if !used.contains(&true) {
            continue;
        }
        // Neighbours mostly have the same.
        if groups.get(last).is_none_or(|(pattern, _)| pattern != used) {
            last = groups.iter().position(|(pattern, _)| pattern == used).unwrap_or_else(|| {
                groups.push((used.to_vec(), Vec::new()));
                groups.len() - 1
            });
        }
        groups[last].1.push(k);
    }
    groups
}
