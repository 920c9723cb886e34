//! The rows that hold with equality, and the factor that solves the program on them.
//!
//! With H = B⁻¹ the method keeps H A and the triangular R such that
//!
//! ```text
//! Rᵀ R = Aᵀ H A,        d = −H (g + A u),        Rᵀ R u = −Aᵀ H g − b
//! ```
//! Rows touch the variables of one joint only, so a column of H A costs one block of H, and taking a row in or dropping
//! one costs no more than the square of their number.
//!
//! All of it is inlined where a program is solved, and compiled there for the vectors of the processor: sums are loops, since a
//! function of an iterator would not be.

use nalgebra::DMatrix;

use super::error::QuadraticError;
use super::row::Row;
use super::vectors::{axpy, dot};

/// Part of a normal, by the measure of H and squared, that must be independent of the active ones for a step in the
/// primal space: above what rounding leaves of a difference.
const INDEPENDENCE: f64 = 1e-12;

/// Independence asked of a row that is only likely to be active: a nearly dependent one is better taken in by a step of its own.
const WARM_INDEPENDENCE: f64 = 1e-10;

/// The state of the dual method.
pub(super) struct ActiveSet<'a> {
    /// H.
    inverse: &'a DMatrix<f64>,
    /// −H g: the minimum without rows.
    free: Vec<f64>,
    /// Columns of H A.
    h_normals: Vec<Vec<f64>>,
    /// Columns of R, as long as they are not zero.
    r: Vec<Vec<f64>>,
    pub(super) step: Vec<f64>,
    pub(super) rows: Vec<Row>,
    pub(super) multipliers: Vec<f64>,
    pub(super) iterations: usize,
}

/// One more row, projected on the active ones in the measure of H.
struct RowProjection {
    /// H a.
    h_normal: Vec<f64>,
    /// R⁻ᵀ Aᵀ H a: the part along the active rows.
    along_active: Vec<f64>,
    /// aᵀ H a.
    total: f64,
    /// What of it the active rows leave.
    residual: f64,
}

impl<'a> ActiveSet<'a> {
    #[inline(always)]
    pub(super) fn new(inverse: &'a DMatrix<f64>, gradient: &[f64]) -> Result<Self, QuadraticError> {
        // That the rest of H is positive definite shows row by row, in `project`.
        if inverse.diagonal().iter().any(|entry| entry.is_nan() || *entry <= 0.0) {
            return Err(QuadraticError::NotConvex);
        }
        let mut free = vec![0.0; gradient.len()];
        for (g, column) in gradient.iter().zip(inverse.as_slice().chunks_exact(free.len())) {
            axpy(-g, column, &mut free);
        }
        Ok(Self {
            inverse,
            step: free.clone(),
            free,
            h_normals: Vec::new(),
            r: Vec::new(),
            rows: Vec::new(),
            multipliers: Vec::new(),
            iterations: 0,
        })
    }

    /// Takes the rows in as equalities, then drops those with a negative multiplier.
    #[inline(always)]
    pub(super) fn warm_start(&mut self, warm: Vec<Row>) -> Result<(), QuadraticError> {
        for row in warm {
            let projection = self.project(&row)?;
            if self.rows.len() < self.step.len() && projection.residual > WARM_INDEPENDENCE * projection.total {
                self.append(row, projection, 0.0);
            }
        }
        loop {
            self.solve_on_active();
            let worst =
                self.multipliers.iter().copied().enumerate().min_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)));
            match worst {
                Some((i, u)) if u < 0.0 => {
                    self.remove(i);
                    self.iterations += 1;
                }
                _ => return Ok(()),
            }
        }
    }

    /// The minimum with the active rows as equalities, and its multipliers.
    #[inline(always)]
    fn solve_on_active(&mut self) {
        let mut u = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            u.push(row.excess(&self.free));
        }
        self.forward_substitute(&mut u);
        self.back_substitute(&mut u);
        self.step.copy_from_slice(&self.free);
        for (u, h_normal) in u.iter().zip(&self.h_normals) {
            axpy(-u, h_normal, &mut self.step);
        }
        self.multipliers = u;
    }

    /// Takes in one violated row, dropping others whose multiplier reaches zero on the way.
    #[inline(always)]
    pub(super) fn add(&mut self, row: Row, pool: &mut Vec<Row>, limit: usize) -> Result<(), QuadraticError> {
        let mut multiplier = 0.0;
        loop {
            self.iterations += 1;
            if self.iterations > limit {
                return Err(QuadraticError::Iterations { limit });
            }
            let projection = self.project(&row)?;
            let mut r = projection.along_active.clone();
            self.back_substitute(&mut r);
            let excess = row.excess(&self.step);
            // Largest step that keeps every multiplier at zero or above.
            let mut partial: Option<(usize, f64)> = None;
            for (i, (&u, &ri)) in self.multipliers.iter().zip(&r).enumerate() {
                if ri > 0.0 {
                    let length = u / ri;
                    if partial.is_none_or(|(_, best)| length < best) {
                        partial = Some((i, length));
                    }
                }
            }
            let independent =
                self.rows.len() < self.step.len() && projection.residual > INDEPENDENCE * projection.total;
            let full = independent.then(|| excess / projection.residual);
            let dropped = partial.filter(|&(_, t)| full.is_none_or(|full| t < full));
            let Some(length) = dropped.map(|(_, t)| t).or(full) else {
                return Err(QuadraticError::Infeasible { excess });
            };
            if full.is_some() {
                axpy(-length, &projection.h_normal, &mut self.step);
                for (ri, h_normal) in r.iter().zip(&self.h_normals) {
                    axpy(length * ri, h_normal, &mut self.step);
                }
            }
            for (u, ri) in self.multipliers.iter_mut().zip(&r) {
                *u -= length * ri;
            }
            multiplier += length;
            match dropped {
                Some((i, _)) => pool.push(self.remove(i)),
                None => {
                    self.append(row, projection, multiplier);
                    return Ok(());
                }
            }
        }
    }

    /// The projection of a row on the active ones.
    #[inline(always)]
    fn project(&self, row: &Row) -> Result<RowProjection, QuadraticError> {
        let n = self.step.len();
        let mut h_normal = vec![0.0; n];
        for (k, a) in row.normal.iter().enumerate() {
            axpy(*a, &self.inverse.as_slice()[(row.start + k) * n..][..n], &mut h_normal);
        }
        let total = row.along(&h_normal);
        if total.is_nan() || total <= 0.0 {
            return Err(QuadraticError::NotConvex);
        }
        let mut along_active = Vec::with_capacity(self.rows.len() + 1);
        for row in &self.rows {
            along_active.push(row.along(&h_normal));
        }
        self.forward_substitute(&mut along_active);
        let residual = total - dot(&along_active, &along_active);
        Ok(RowProjection { h_normal, along_active, total, residual })
    }

    /// R⁻ᵀ v in place.
    #[inline(always)]
    fn forward_substitute(&self, v: &mut [f64]) {
        for (i, column) in self.r.iter().enumerate() {
            v[i] = (v[i] - dot(&column[..i], &v[..i])) / column[i];
        }
    }

    /// R⁻¹ v in place.
    #[inline(always)]
    fn back_substitute(&self, v: &mut [f64]) {
        for (i, column) in self.r.iter().enumerate().rev() {
            v[i] /= column[i];
            let x = v[i];
            axpy(-x, &column[..i], &mut v[..i]);
        }
    }

    /// Makes a row active.
    #[inline(always)]
    fn append(&mut self, row: Row, projection: RowProjection, multiplier: f64) {
        let mut column = projection.along_active;
        column.push(projection.residual.sqrt());
        self.r.push(column);
        self.h_normals.push(projection.h_normal);
        self.rows.push(row);
        self.multipliers.push(multiplier);
    }

    /// Drops active row `index`: the columns of R after it have one entry too many, which Givens rotations of two rows
    /// take away.
    #[inline(always)]
    fn remove(&mut self, index: usize) -> Row {
        self.r.remove(index);
        for c in index..self.r.len() {
            let (x, y) = (self.r[c][c], self.r[c][c + 1]);
            let h = libm::hypot(x, y);
            let (cos, sin) = if h > 0.0 { (x / h, y / h) } else { (1.0, 0.0) };
            for column in &mut self.r[c..] {
                (column[c], column[c + 1]) =
                    (cos * column[c] + sin * column[c + 1], cos * column[c + 1] - sin * column[c]);
            }
            self.r[c].pop();
        }
        self.h_normals.remove(index);
        self.multipliers.remove(index);
        self.rows.remove(index)
    }
}
