//! Coordinates around a consistent set in which everything but the data has the unit matrix as curvature.
//!
//! ```text
//! P = L (1 + Σ ξ_k E_k) Lᵀ        x = x (1 + ξ)        φ + J η,   JᵀHJ = 1
//! ```
//! E_k is an orthonormal basis of symmetric matrices and H the Hessian of all terms without the data. In ξ the logarithms are as
//! curved near the edge as in the middle, so a link that is hardly a body costs no digits.

use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, SVector, SymmetricEigen};

use super::prior::{Prior, Weights, euclidean_size};
use super::region::{LinkRegion, Region, margin, pseudo};
use crate::spatial::PseudoInertia;

type Ten = SVector<f64, 10>;
type TenByTen = SMatrix<f64, 10, 10>;

/// Coordinates at one set.
pub(super) struct Coordinates {
    links: Vec<LinkCoordinates>,
    /// Position, J, and x of each drive where it has a logarithm.
    drives: Vec<(usize, f64, f64)>,
    /// Position and J.
    offsets: Vec<(usize, f64)>,
    /// Gradient of all terms without the data, by η, p.
    pub(super) gradient: DVector<f64>,
    horizon: Option<Horizon>,
    weights: Weights,
}

/// The bound S < H.
struct Horizon {
    /// Gradient of S by η, over H − S.
    slope: DVector<f64>,
    /// Curvature of S by η in the quantities of either sign, over H − S: their positions with it.
    curvature: Vec<(usize, f64)>,
}

struct LinkCoordinates {
    at: usize,
    /// ∂(ten)/∂η.
    jacobian: TenByTen,
    /// ∂ξ/∂η.
    unit: TenByTen,
    /// Gradient of tr(P₀⁻¹ P) by η.
    growth: Ten,
    /// Change of each bound over its value, by ξ.
    bounds: Vec<Ten>,
}

/// What happens along a line: `Σ c ln(1 + t e)` are the logarithms at a step of length t.
pub(super) type Logarithms = Vec<(f64, f64)>;

impl Coordinates {
    /// `None` where the set is not consistent or a number is none.
    pub(super) fn at(region: &Region, phi: &DVector<f64>, prior: Prior, weights: Weights) -> Option<Self> {
        let mut gradient = DVector::zeros(region.parameters());
        let room = if weights.horizon > 0.0 { region.horizon() - region.growth(phi) } else { f64::INFINITY };
        if room.is_nan() || room <= 0.0 {
            return None;
        }
        let mut horizon = Horizon { slope: gradient.clone(), curvature: Vec::new() };
        let size = euclidean_size(&region.centre());
        let mut links = Vec::with_capacity(region.links.len());
        for link in &region.links {
            let (coordinates, slope) = LinkCoordinates::at(link, phi, prior, weights, size)?;
            gradient.rows_mut(link.at, 10).copy_from(&slope);
            horizon.slope.rows_mut(link.at, 10).copy_from(&(coordinates.growth / room));
            links.push(coordinates);
        }
        let mut drives = Vec::with_capacity(region.drives.len());
        for &(at, x0) in &region.drives {
            let x = phi[at];
            if weights.logarithms > 0.0 && x.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
                return None;
            }
            let quadratic = weights.quadratic / if prior == Prior::Euclidean { size } else { x0 * x0 };
            // In units of x0, in which a value of zero is no division.
            let curvature = if weights.logarithms > 0.0 { weights.logarithms / (x * x) } else { 0.0 } + quadratic;
            let inverse = if weights.logarithms > 0.0 { weights.logarithms / x } else { 0.0 };
            let slope = weights.linear / x0 - inverse + quadratic * (x - x0);
            let jacobian = 1.0 / curvature.sqrt();
            gradient[at] = slope * jacobian;
            horizon.slope[at] = jacobian / (x0 * room);
            drives.push((at, jacobian, x));
        }
        let mut offsets = Vec::with_capacity(region.offsets.len());
        for &(at, value, unit) in &region.offsets {
            let euclidean = if prior == Prior::Euclidean { weights.quadratic / size } else { 0.0 };
            let near = weights.horizon / (unit * unit * room);
            let jacobian = 1.0 / (weights.offsets / (unit * unit) + euclidean + near).sqrt();
            gradient[at] = (weights.offsets / (unit * unit) + euclidean) * (phi[at] - value) * jacobian;
            horizon.slope[at] = (phi[at] - value) * jacobian / (unit * unit * room);
            horizon.curvature.push((at, jacobian * jacobian / (unit * unit * room)));
            offsets.push((at, jacobian));
        }
        let horizon = (weights.horizon > 0.0).then_some(horizon);
        if let Some(horizon) = &horizon {
            gradient += &horizon.slope;
        }
        let is_finite = gradient.iter().all(|g| g.is_finite());
        is_finite.then_some(Self { links, drives, offsets, gradient, horizon, weights })
    }

    /// `K J`, b × p, and below it, where the horizon counts, the gradient of its logarithm: its curvature beside the unit matrix.
    pub(super) fn seen(&self, k: &DMatrix<f64>) -> DMatrix<f64> {
        let b = k.nrows();
        let mut seen = DMatrix::zeros(b + usize::from(self.horizon.is_some()), k.ncols());
        for link in &self.links {
            for c in 0..10 {
                for r in 0..10 {
                    let factor = link.jacobian[(r, c)];
                    if factor != 0.0 {
                        seen.column_mut(link.at + c).rows_mut(0, b).axpy(factor, &k.column(link.at + r), 1.0);
                    }
                }
            }
        }
        let singles = self.drives.iter().map(|&(at, jacobian, _)| (at, jacobian)).chain(self.offsets.iter().copied());
        for (at, jacobian) in singles {
            seen.column_mut(at).rows_mut(0, b).axpy(jacobian, &k.column(at), 0.0);
        }
        if let Some(horizon) = &self.horizon {
            seen.row_mut(b).copy_from(&horizon.slope.transpose());
        }
        seen
    }

    /// `J η`, p.
    pub(super) fn step(&self, eta: &DVector<f64>) -> DVector<f64> {
        let mut step = DVector::zeros(eta.len());
        for link in &self.links {
            let of = link.jacobian * eta.fixed_rows::<10>(link.at);
            step.rows_mut(link.at, 10).copy_from(&of);
        }
        for &(at, jacobian, _) in &self.drives {
            step[at] = jacobian * eta[at];
        }
        for &(at, jacobian) in &self.offsets {
            step[at] = jacobian * eta[at];
        }
        step
    }

    /// The logarithms along η, each with its factor.
    pub(super) fn logarithms(&self, eta: &DVector<f64>) -> Logarithms {
        let (logarithms, bounds) = (self.weights.logarithms, self.weights.bounds);
        let mut all = Vec::new();
        for link in &self.links {
            let xi: Ten = link.unit * eta.fixed_rows::<10>(link.at);
            if logarithms > 0.0 {
                let eigenvalues = SymmetricEigen::new(symmetric(&xi)).eigenvalues;
                all.extend(eigenvalues.iter().map(|&e| (logarithms, e)));
            }
            all.extend(link.bounds.iter().map(|bound| (bounds, bound.dot(&xi))));
        }
        if logarithms > 0.0 {
            all.extend(self.drives.iter().map(|&(at, jacobian, x)| (logarithms, jacobian * eta[at] / x)));
        }
        if let Some(horizon) = &self.horizon {
            // 1 − a t − ½ c t² = (1 + e₁ t)(1 + e₂ t).
            let a = horizon.slope.dot(eta);
            let c: f64 = horizon.curvature.iter().map(|&(at, curvature)| curvature * eta[at] * eta[at]).sum();
            let root = libm::sqrt(0.25 * a * a + 0.5 * c);
            all.extend([(self.weights.horizon, -0.5 * a + root), (self.weights.horizon, -0.5 * a - root)]);
        }
        all
    }
}

impl LinkCoordinates {
    /// With the gradient by η.
    fn at(link: &LinkRegion, phi: &DVector<f64>, prior: Prior, weights: Weights, size: f64) -> Option<(Self, Ten)> {
        let p = pseudo(phi, link.at);
        // Where nothing asks for a consistent set, the guess gives the coordinates.
        let root = if weights.logarithms > 0.0 { p } else { link.p0 }.cholesky()?.l();
        let mut tens = TenByTen::zeros();
        for k in 0..10 {
            let change = root * basis(k) * root.transpose();
            tens.column_mut(k).copy_from_slice(&PseudoInertia(change).inertia().to_array());
        }
        // The curvature is RᵀR with R by a QR of its rows: a bound that is nearly active has one 1e12 times as large as the others.
        let mut rows = vec![TenByTen::identity() * weights.logarithms.sqrt()];
        let mut active: Vec<Ten> = Vec::new();
        let inner = |m: &Matrix4<f64>| Ten::from_fn(|k, _| margin(&basis(k), m));
        let mut slope = -inner(&Matrix4::identity()) * weights.logarithms;
        let whitened = link.whitening * root;
        let growth = inner(&(whitened.transpose() * whitened));
        slope += growth * weights.linear;
        let mut bounds = Vec::new();
        if weights.bounds > 0.0 {
            for q in &link.bounds {
                let value = margin(q, &p);
                if value.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
                    return None;
                }
                let bound = inner(&(root.transpose() * q * root)) / value;
                active.push(bound * weights.bounds.sqrt());
                slope -= bound * weights.bounds;
                bounds.push(bound);
            }
        }
        if weights.quadratic > 0.0 {
            let away = p - link.p0;
            if prior == Prior::Euclidean {
                let ten = Ten::from_row_slice(&PseudoInertia(away).inertia().to_array());
                rows.push(tens * (weights.quadratic / size).sqrt());
                slope += tens.transpose() * ten * (weights.quadratic / size);
            } else {
                let images: Vec<Ten> = (0..10).map(|k| inner(&(whitened * basis(k) * whitened.transpose()))).collect();
                let images = TenByTen::from_columns(&images);
                rows.push(images * weights.quadratic.sqrt());
                slope += images.transpose() * inner(&link.whitened(&away)) * weights.quadratic;
            }
        }
        let factor = root_of(&rows, &active);
        let unit = factor.solve_upper_triangular(&TenByTen::identity())?;
        let gradient = factor.tr_solve_upper_triangular(&slope)?;
        let growth = factor.tr_solve_upper_triangular(&growth)?;
        Some((Self { at: link.at, jacobian: tens * unit, unit, growth, bounds }, gradient))
    }
}

/// R of a QR of these rows.
fn root_of(blocks: &[TenByTen], single: &[Ten]) -> TenByTen {
    let mut stack = DMatrix::zeros(10 * blocks.len() + single.len(), 10);
    for (k, block) in blocks.iter().enumerate() {
        stack.view_mut((10 * k, 0), (10, 10)).copy_from(block);
    }
    for (k, row) in single.iter().enumerate() {
        stack.row_mut(10 * blocks.len() + k).copy_from(&row.transpose());
    }
    TenByTen::from_iterator(stack.qr().r().iter().copied())
}

/// The k-th of an orthonormal basis of symmetric 4 × 4 matrices.
pub(in crate::estimation) fn basis(k: usize) -> Matrix4<f64> {
    let mut e = Matrix4::zeros();
    let (i, j) = PLACES[k];
    let value = if i == j { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
    e[(i, j)] = value;
    e[(j, i)] = value;
    e
}

const PLACES: [(usize, usize); 10] = [(0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

pub(in crate::estimation) fn symmetric(xi: &Ten) -> Matrix4<f64> {
    let mut sum = Matrix4::zeros();
    for (k, &x) in xi.iter().enumerate() {
        sum += basis(k) * x;
    }
    sum
}
