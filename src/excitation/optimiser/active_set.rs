//! The rows that hold with equality, and the factors that solve the program on them.
//!
//! With B = L Lᵀ the method keeps J and the triangular R such that
//!
//! ```text
//! Jᵀ B J = 1,      Jᵀ A_active = [R; 0]
//! ```

use nalgebra::DMatrix;

use super::factor::{inverse_transposed, lower_factor, rotate};
use super::quadratic::QuadraticFault;
use super::row::Row;
use super::vectors::{axpy, dot};

/// Part of a normal that must be independent of the active ones for a step in the primal space.
const INDEPENDENCE: f64 = 1e-9;

/// The state of the dual method.
pub(super) struct ActiveSet {
    n: usize,
    /// J, column by column.
    j: Vec<f64>,
    /// R, column by column with stride n.
    r: Vec<f64>,
    gradient: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) rows: Vec<Row>,
    pub(super) multipliers: Vec<f64>,
    pub(super) iterations: usize,
}

impl ActiveSet {
    pub(super) fn new(hessian: &DMatrix<f64>, gradient: &[f64]) -> Result<Self, QuadraticFault> {
        let n = gradient.len();
        let factor = lower_factor(hessian).ok_or(QuadraticFault::NotConvex)?;
        let j = inverse_transposed(&factor, n);
        let mut state = Self {
            n,
            j,
            r: vec![0.0; n * n],
            gradient: gradient.to_vec(),
            step: vec![0.0; n],
            rows: Vec::new(),
            multipliers: Vec::new(),
            iterations: 0,
        };
        state.solve_on_active();
        Ok(state)
    }

    /// Takes the rows in as equalities, then lets go those that would pull.
    pub(super) fn warm_start(&mut self, warm: Vec<Row>) {
        for row in warm {
            let d = self.project(&row);
            let q = self.rows.len();
            let total = dot(&d, &d);
            let free = dot(&d[q..], &d[q..]);
            // More cautious than INDEPENDENCE: a nearly dependent row is better taken in by a step of its own.
            if q < self.n && free > 1e-10 * total {
                self.append(row, d, 0.0);
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
                _ => break,
            }
        }
    }

    /// The minimum with the active rows as equalities, and its multipliers.
    ///
    /// In y = J⁻¹ d: Rᵀ y₁ = b, y₂ = −J₂ᵀ g, and R u = −(y₁ + J₁ᵀ g).
    fn solve_on_active(&mut self) {
        let (n, q) = (self.n, self.rows.len());
        let mut y: Vec<f64> = (0..n).map(|c| -dot(self.column(c), &self.gradient)).collect();
        let pulled: Vec<f64> = y[..q].to_vec();
        for i in 0..q {
            let known = dot(&self.r[i * n..i * n + i], &y[..i]);
            y[i] = (self.rows[i].bound - known) / self.r[i * n + i];
        }
        let mut u: Vec<f64> = (0..q).map(|i| pulled[i] - y[i]).collect();
        self.back_substitute(&mut u);
        self.multipliers.copy_from_slice(&u);
        self.step.fill(0.0);
        for (c, &weight) in y.iter().enumerate() {
            axpy(weight, &self.j[c * n..(c + 1) * n], &mut self.step);
        }
    }

    /// Takes in one violated row, letting go of others whose multiplier reaches zero on the way.
    pub(super) fn add(&mut self, row: Row, pool: &mut Vec<Row>, limit: usize) -> Result<(), QuadraticFault> {
        let n = self.n;
        let mut multiplier = 0.0;
        loop {
            self.iterations += 1;
            if self.iterations > limit {
                return Err(QuadraticFault::Iterations { limit });
            }
            let q = self.rows.len();
            let d = self.project(&row);
            let mut r = d[..q].to_vec();
            self.back_substitute(&mut r);
            let total = dot(&d, &d);
            let free = dot(&d[q..], &d[q..]);
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
            let full = (q < n && free > INDEPENDENCE * INDEPENDENCE * total).then(|| excess / free);
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
                for c in q..n {
                    axpy(-length * d[c], &self.j[c * n..(c + 1) * n], &mut self.step);
                }
            }
            for (u, ri) in self.multipliers.iter_mut().zip(&r) {
                *u -= length * ri;
            }
            multiplier += length;
            match lets_go {
                Some(i) => pool.push(self.remove(i)),
                None => {
                    self.append(row, d, multiplier);
                    return Ok(());
                }
            }
        }
    }

    fn column(&self, c: usize) -> &[f64] {
        &self.j[c * self.n..(c + 1) * self.n]
    }

    /// Jᵀ a.
    fn project(&self, row: &Row) -> Vec<f64> {
        let range = row.start..row.start + row.normal.len();
        (0..self.n).map(|c| dot(&self.column(c)[range.clone()], &row.normal)).collect()
    }

    /// R⁻¹ v in place.
    fn back_substitute(&self, v: &mut [f64]) {
        let n = self.n;
        for i in (0..v.len()).rev() {
            v[i] /= self.r[i * n + i];
            let x = v[i];
            axpy(-x, &self.r[i * n..i * n + i], &mut v[..i]);
        }
    }

    /// Makes a row with `d = Jᵀ a` active: turns the free columns of J until only one sees it.
    fn append(&mut self, row: Row, mut d: Vec<f64>, multiplier: f64) {
        let (n, q) = (self.n, self.rows.len());
        for c in (q + 1..n).rev() {
            if d[c] != 0.0 {
                let h = libm::hypot(d[c - 1], d[c]);
                let (cos, sin) = (d[c - 1] / h, d[c] / h);
                (d[c - 1], d[c]) = (h, 0.0);
                rotate(&mut self.j, n, c - 1, c, cos, sin);
            }
        }
        self.r[q * n..q * n + q + 1].copy_from_slice(&d[..=q]);
        self.rows.push(row);
        self.multipliers.push(multiplier);
    }

    /// Lets go of active row `index`.
    fn remove(&mut self, index: usize) -> Row {
        let (n, q) = (self.n, self.rows.len());
        for c in index + 1..q {
            // Column c of R moves to c − 1 and has one entry too many.
            self.r.copy_within(c * n..c * n + c + 1, (c - 1) * n);
            let (x, y) = (self.r[(c - 1) * n + c - 1], self.r[(c - 1) * n + c]);
            let h = libm::hypot(x, y);
            if h > 0.0 {
                let (cos, sin) = (x / h, y / h);
                self.r[(c - 1) * n + c - 1] = h;
                self.r[(c - 1) * n + c] = 0.0;
                for later in c + 1..q {
                    let (x, y) = (self.r[later * n + c - 1], self.r[later * n + c]);
                    self.r[later * n + c - 1] = cos * x + sin * y;
                    self.r[later * n + c] = cos * y - sin * x;
                }
                rotate(&mut self.j, n, c - 1, c, cos, sin);
            }
        }
        self.multipliers.remove(index);
        self.rows.remove(index)
    }
}
