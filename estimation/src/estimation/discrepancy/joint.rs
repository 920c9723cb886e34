//! What the equations of one joint leave of its torque, and whether that is more than noise.
//!
//! ```text
//! r̃ = (1 − Q Qᵀ) L⁻¹ y_i        L⁻¹ W_i = Q R        L Lᵀ = cov ε_i, circulant
//! F = ‖r̃‖² / m        m = M − rank W_i        S_k = ‖Φ̃_kᵀ r̃‖² / tr Φ̃_kᵀΦ̃_k        Φ̃ = (1 − Q Qᵀ) L⁻¹ Φ
//! ```
//! The joint's own equations alone: a fit of all joints leaves in one what parameters of another do. F is one of m and ν
//! degrees of freedom where there is noise alone, ν those of the scatter; S_k nearly one of (tr G)²/tr G² and ν, G = Φ̃_kᵀΦ̃_k
//! (F. E. Satterthwaite, Biometrics Bulletin 2(6), 1946).

use nalgebra::{Complex, DMatrix, DVector};

use super::blocks::BlockedEquations;
use super::features::{Functions, SHARED};
use super::sizes::ReducedResidual;
use crate::linalg::{RowFactor, column_squares, product, symmetric_eigen, transpose_product};
use crate::signal::{FourierTransform, NoiseModel};
use crate::statistics::f_tail;

/// A joint shows more than noise where chance exceeds its F with less than this probability,
const LACK_OF_FIT: f64 = 0.02;
/// or that of one of its groups with less than this.
const GROUP: f64 = 0.002;
/// Least part of a column, of its length, that is independent of those before it.
const INDEPENDENT: f64 = 1e-6;
/// Least variance of noise at any frequency, as a part of that of white noise of the same power.
const LEAST_SPECTRUM: f64 = 0.05;
/// Where F is exceeded with less than this, groups are not looked at.
const CERTAIN: f64 = 1e-9;
/// Directions of a group whose square is below this part of its largest are not looked at.
const LEAST_DIRECTION: f64 = 0.02;

/// The residual of one joint's own fit, and what is left of its functions, in units of the noise.
pub(super) struct JointResidual {
    residual: DVector<f64>,
    groups: Vec<DMatrix<f64>>,
    shared: [DMatrix<f64>; SHARED],
    /// Sum of the squares of each shared law, before what the regressor holds of it is taken out.
    power: [f64; SHARED],
    /// Degrees of freedom of the residual, and of the scatter.
    freedom: f64,
    scatter_freedom: f64,
    /// Variance of the noise of one block, (N·m)².
    pub(super) unit: f64,
    /// Which blocks are used.
    used: Vec<bool>,
}

/// How probable it is that noise alone leaves a residual as large.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chances {
    /// By F.
    whole: f64,
    /// The least of the groups of functions.
    group: f64,
    /// How many groups there are.
    groups: usize,
}

impl Chances {
    /// Whether either is less than what the intervals take for chance.
    pub(super) fn show_more_than_noise(self) -> bool {
        self.whole < LACK_OF_FIT || self.group < GROUP
    }

    /// That of all tests together, by Bonferroni.
    pub(super) fn adjusted(self) -> f64 {
        (self.whole.min(self.group) * (self.groups + 1) as f64).min(1.0)
    }
}

impl JointResidual {
    /// `None` where a joint has hardly more equations than parameters, or no noise.
    pub(super) fn new(
        blocks: &BlockedEquations,
        noise: &NoiseModel,
        joint: usize,
        functions: &Functions,
    ) -> Option<Self> {
        let weight = blocks.weight(joint);
        let lags = blocks.lags(noise, joint);
        let unit = *lags.first()?;
        let whitening = Whitening::new(&lags, blocks.count, unit)?;
        let white = |columns: &DMatrix<f64>| whitening.apply(columns, &weight);
        let basis = orthonormal(white(&blocks.explained(joint)));
        let used: Vec<bool> = weight.iter().map(|weight| *weight > 0.0).collect();
        let freedom =
            used.iter().filter(|used| **used).count().checked_sub(basis.ncols()).filter(|freedom| *freedom > 8)?;
        let left = |columns: DMatrix<f64>| {
            let inside = product(&basis, &transpose_product(&basis, &columns));
            columns - inside
        };
        let torque = blocks.torque(joint);
        let residual = left(white(&DMatrix::from_column_slice(torque.len(), 1, torque.as_slice())));
        // Functions stay in units of the noise, so that a size is a share of the noise's variance.
        let groups = functions.own.iter().map(|group| left(white(&(group * unit.sqrt())))).collect();
        let whole = functions.shared.each_ref().map(white);
        let power = whole.each_ref().map(DMatrix::norm_squared);
        let shared = whole.map(left);
        Some(Self {
            residual: residual.column(0).into_owned(),
            groups,
            shared,
            power,
            freedom: freedom as f64,
            scatter_freedom: noise.degrees_of_freedom,
            unit,
            used,
        })
    }

    /// How probable it is that noise alone leaves as much.
    pub(super) fn chances(&self) -> Chances {
        let whole = f_tail(self.residual.norm_squared() / self.freedom, self.freedom, self.scatter_freedom);
        if whole < CERTAIN {
            return Chances { whole, group: 1.0, groups: 0 };
        }
        let groups = self.groups.iter().chain(&self.shared);
        let count = groups.clone().count();
        Chances { whole, group: groups.map(|group| self.chance(group)).fold(1.0, f64::min), groups: count }
    }

    /// Square of each block's residual, in units of the noise, so that they sum to that of all degrees of freedom; `None` where
    /// a block is not used.
    pub(super) fn squares(&self) -> Vec<Option<f64>> {
        let used = self.used.iter().filter(|used| **used).count() as f64;
        let square = |r: &f64| r * r * used / self.freedom;
        self.residual.iter().zip(&self.used).map(|(r, used)| used.then(|| square(r))).collect()
    }

    /// Probability that chance exceeds the square of the residual along a group's functions.
    fn chance(&self, group: &DMatrix<f64>) -> f64 {
        let gram = column_squares(group);
        let (trace, square) = (gram.trace(), gram.norm_squared());
        let seen = group.tr_mul(&self.residual).norm_squared();
        if trace > 0.0 && square > 0.0 {
            f_tail(seen / trace, trace * trace / square, self.scatter_freedom)
        } else {
            1.0
        }
    }

    /// Residual and functions in the few directions that the functions have; only those of shared laws where `own` is not
    /// asked for.
    pub(super) fn reduced(&self, own: bool) -> ReducedResidual {
        let mut kept: Vec<DMatrix<f64>> = Vec::new();
        let mut visible = Vec::new();
        for group in self.groups.iter().filter(|_| own) {
            let eigen = symmetric_eigen(column_squares(group));
            let least = LEAST_DIRECTION * eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
            let places: Vec<usize> = (0..eigen.eigenvalues.len()).filter(|&j| eigen.eigenvalues[j] > least).collect();
            let directions = group * eigen.eigenvectors.select_columns(&places);
            let seen = directions.tr_mul(&self.residual);
            // Noise has one in each direction, in the mean.
            let noise = places.len() as f64;
            visible.push(
                places.iter().enumerate().map(|(at, &j)| seen[at] * seen[at] / eigen.eigenvalues[j]).sum::<f64>()
                    - noise,
            );
            kept.push(directions);
        }
        let shared_visible = self.shared.each_ref().map(|law| {
            let (square, seen) = (law.norm_squared(), law.tr_mul(&self.residual).norm_squared());
            if square > 0.0 { seen / square } else { 0.0 }
        });
        kept.extend(self.shared.iter().cloned());
        // Coordinates in an orthonormal basis of all directions, the residual last: the triangular factor.
        let width: usize = kept.iter().map(DMatrix::ncols).sum();
        let columns: Vec<_> = kept.iter().flat_map(DMatrix::column_iter).collect();
        let mut factor = RowFactor::new(width + 1);
        factor.add(self.residual.len(), |row, j| columns.get(j).map_or(self.residual[row], |column| column[row]));
        let factor = factor.finish();
        let mut first = 0;
        let group = |of: &DMatrix<f64>| {
            first += of.ncols();
            factor.view((0, first - of.ncols()), (width, of.ncols())).into_owned()
        };
        let groups = kept.iter().map(group).collect();
        let residual = factor.view((0, width), (width, 1)).column(0).into_owned();
        let rest_square = factor[(width, width)] * factor[(width, width)];
        let rest_freedom = (self.freedom - width as f64).max(0.0);
        let rows = self.residual.len() as f64;
        let visible = visible.iter().map(|square: &f64| square.max(0.0) / rows).collect();
        ReducedResidual { residual, groups, rest_square, rest_freedom, visible, shared_visible, power: self.power }
    }
}

/// Multiplication with the inverse root of a circulant covariance.
struct Whitening {
    transform: FourierTransform,
    /// Inverse roots of the spectrum over the number of samples; one number where the noise is white.
    inverse_root: Vec<f64>,
}

impl Whitening {
    /// `None` where the variance is not above zero.
    fn new(lags: &[f64], count: usize, variance: f64) -> Option<Self> {
        if !(variance.is_finite() && variance > 0.0) {
            return None;
        }
        let transform = FourierTransform::new(count);
        let inverse_root = (0..count)
            .map(|f| {
                let phase = std::f64::consts::TAU * f as f64 / count as f64;
                let sum: f64 =
                    lags.iter().enumerate().skip(1).map(|(l, lag)| 2.0 * lag * libm::cos(phase * l as f64)).sum();
                1.0 / (variance + sum).max(LEAST_SPECTRUM * variance).sqrt()
            })
            .collect();
        Some(Self { transform, inverse_root })
    }

    /// Columns, weighted.
    fn apply(&self, columns: &DMatrix<f64>, weight: &[f64]) -> DMatrix<f64> {
        let rows = columns.nrows();
        let mut white = columns.clone();
        let first = self.inverse_root.first().copied().unwrap_or(1.0);
        let is_flat = self.inverse_root.iter().all(|root| (root - first).abs() <= 1e-12 * first);
        for mut column in white.column_iter_mut() {
            let column = column.as_mut_slice();
            if is_flat {
                column.iter_mut().zip(weight).for_each(|(value, weight)| *value = *value * weight * first);
                continue;
            }
            let weighted: Vec<f64> = column.iter().zip(weight).map(|(value, weight)| value * weight).collect();
            let spectrum = self.transform.forward_real(&weighted);
            let scaled: Vec<Complex<f64>> =
                spectrum.iter().zip(&self.inverse_root).map(|(value, root)| (value * *root).conj()).collect();
            // Conjugated, so that the forward transform runs backwards.
            for ((row, value), weight) in column.iter_mut().zip(self.transform.forward(&scaled)).zip(weight) {
                *row = if *weight > 0.0 { value.re / rows as f64 } else { 0.0 };
            }
        }
        white
    }
}

/// An orthonormal basis of the columns, by Gram and Schmidt done twice.
fn orthonormal(mut columns: DMatrix<f64>) -> DMatrix<f64> {
    let (rows, count) = columns.shape();
    let mut rank = 0;
    for j in 0..count {
        let length = columns.column(j).norm();
        if length <= 0.0 {
            continue;
        }
        let mut column = columns.column(j).into_owned() / length;
        for _ in 0..2 {
            for k in 0..rank {
                let part = columns.column(k).dot(&column);
                column.axpy(-part, &columns.column(k), 1.0);
            }
        }
        let left = column.norm();
        if left > INDEPENDENT {
            columns.set_column(rank, &(column / left));
            rank += 1;
        }
    }
    columns.resize(rows, rank, 0.0)
}
