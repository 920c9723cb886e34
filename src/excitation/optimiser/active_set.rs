//! The rows that hold with equality, and the factor that solves the program on them.
//!
//! With H = B⁻¹ the method keeps H A and the triangular R such that
//!
//! ```text
//! Rᵀ R = Aᵀ H A,        d = −H (g + A u),        Rᵀ R u = −Aᵀ H g − b
//! ```
//! Rows touch the variables of one joint only, so a column of H A costs one block of H, and taking a row in or letting
//! one go costs no more than the square of their number.

use nalgebra::DMatrix;

use super::quadratic::QuadraticFault;
use super::row::Row;
use super::vectors::{axpy, dot};

/// Part of a normal, by the measure of H and squared, that must be independent of the active ones for a step in the
/// primal space: above what rounding leaves of a difference.
const INDEPENDENCE: f64 = 1e-12;

/// The same for a row that is only likely to be active: a nearly dependent one is better taken in by a step of its own.
const WARM_INDEPENDENCE: f64 = 1e-10;

/// The state of the dual method.
pub(super) struct ActiveSet<'a> {
    /// H.
    inverse: &'a DMatrix<f64>,
    /// −H g: the minimum without rows.
    free: Vec<f64>,
    /// Columns of H A.
    reach: Vec<Vec<f64>>,
    /// Columns of R, as long as they are not zero.
    r: Vec<Vec<f64>>,
    pub(super) step: Vec<f64>,
    pub(super) rows: Vec<Row>,
    pub(super) multipliers: Vec<f64>,
    pub(super) iterations: usize,
}

/// One more row, as the active ones see it.
struct Seen {
    /// H a.
    reach: Vec<f64>,
    /// R⁻ᵀ Aᵀ H a.
    shared: Vec<f64>,
    /// aᵀ H a.
    total: f64,
    /// What of it the active rows leave.
    own: f64,
}

impl<'a> ActiveSet<'a> {
    pub(super) fn new(inverse: &'a DMatrix<f64>, gradient: &[f64]) -> Result<Self, QuadraticFault> {
        // That the rest of H is positive definite shows row by row, in `see`.
        if inverse.diagonal().iter().any(|entry| entry.is_nan() || *entry <= 0.0) {
            return Err(QuadraticFault::NotConvex);
        }
        let mut free = vec![0.0; gradient.len()];
        for (g, column) in gradient.iter().zip(inverse.as_slice().chunks_exact(free.len())) {
            axpy(-g, column, &mut free);
        }
        Ok(Self {
            inverse,
            step: free.clone(),
            free,
            reach: Vec::new(),
            r: Vec::new(),
            rows: Vec::new(),
            multipliers: Vec::new(),
            iterations: 0,
        })
    }

    /// Takes the rows in as equalities, then lets go those that would pull.
    pub(super) fn warm_start(&mut self, warm: Vec<Row>) -> Result<(), QuadraticFault> {
        for row in warm {
            let seen = self.see(&row)?;
            if self.rows.len() < self.step.len() && seen.own > WARM_INDEPENDENCE * seen.total {
                self.append(row, seen, 0.0);
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
    fn solve_on_active(&mut self) {
        let mut u: Vec<f64> = self.rows.iter().map(|row| row.excess(&self.free)).collect();
        self.forward_substitute(&mut u);
        self.back_substitute(&mut u);
        self.step.copy_from_slice(&self.free);
        for (u, reach) in u.iter().zip(&self.reach) {
            axpy(-u, reach, &mut self.step);
        }
        self.multipliers = u;
    }

    /// Takes in one violated row, letting go of others whose multiplier reaches zero on the way.
    pub(super) fn add(&mut self, row: Row, pool: &mut Vec<Row>, limit: usize) -> Result<(), QuadraticFault> {
        let mut multiplier = 0.0;
        loop {
            self.iterations += 1;
            if self.iterations > limit {
                return Err(QuadraticFault::Iterations { limit });
            }
            let seen = self.see(&row)?;
            let mut r = seen.shared.clone();
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
            let independent = self.rows.len() < self.step.len() && seen.own > INDEPENDENCE * seen.total;
            let full = independent.then(|| excess / seen.own);
            let (length, lets_go) = match (full, partial) {
                (None, None) => return Err(QuadraticFault::Infeasible { excess }),
                (Some(full), None) => (full, None),
                (None, Some((i, t))) => (t, Some(i)),
                (Some(full), Some((i, t))) => {
                    if t < full {
                        (t, Some(i))
                    } else {
                        (full, None)
                    }
                }
            };
            if full.is_some() {
                axpy(-length, &seen.reach, &mut self.step);
                for (ri, reach) in r.iter().zip(&self.reach) {
                    axpy(length * ri, reach, &mut self.step);
                }
            }
            for (u, ri) in self.multipliers.iter_mut().zip(&r) {
                *u -= length * ri;
            }
            multiplier += length;
            match lets_go {
                Some(i) => pool.push(self.remove(i)),
                None => {
                    self.append(row, seen, multiplier);
                    return Ok(());
                }
            }
        }
    }

    /// A row as the active ones see it.
    fn see(&self, row: &Row) -> Result<Seen, QuadraticFault> {
        let n = self.step.len();
        let mut reach = vec![0.0; n];
        for (k, a) in row.normal.iter().enumerate() {
            axpy(*a, &self.inverse.as_slice()[(row.start + k) * n..][..n], &mut reach);
        }
        let along = |row: &Row| dot(&row.normal, &reach[row.start..row.start + row.normal.len()]);
        let total = along(row);
        if total.is_nan() || total <= 0.0 {
            return Err(QuadraticFault::NotConvex);
        }
        let mut shared: Vec<f64> = self.rows.iter().map(along).collect();
        self.forward_substitute(&mut shared);
        let own = total - dot(&shared, &shared);
        Ok(Seen { reach, shared, total, own })
    }

    /// R⁻ᵀ v in place.
    fn forward_substitute(&self, v: &mut [f64]) {
        for (i, column) in self.r.iter().enumerate() {
            v[i] = (v[i] - dot(&column[..i], &v[..i])) / column[i];
        }
    }

    /// R⁻¹ v in place.
    fn back_substitute(&self, v: &mut [f64]) {
        for (i, column) in self.r.iter().enumerate().rev() {
            v[i] /= column[i];
            let x = v[i];
            axpy(-x, &column[..i], &mut v[..i]);
        }
    }

    /// Makes a row active.
    fn append(&mut self, row: Row, seen: Seen, multiplier: f64) {
        let mut column = seen.shared;
        column.push(seen.own.sqrt());
        self.r.push(column);
        self.reach.push(seen.reach);
        self.rows.push(row);
        self.multipliers.push(multiplier);
    }

    /// Lets go of active row `index`: the columns of R after it have one entry too many, which turns of two rows each
    /// take away.
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
        self.reach.remove(index);
        self.multipliers.remove(index);
        self.rows.remove(index)
    }
}
