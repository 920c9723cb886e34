//! Which step is best for a convex quadratic under linear rows, when there are far more rows than can be active?
//!
//! ```text
//! minimise  ½ dᵀ B d + gᵀ d      subject to  a_rᵀ d ≤ b_r  for every row r of a source
//! ```
//! The dual active-set method of Goldfarb and Idnani starts at the unconstrained minimum and takes rows in one at a
//! time, so rows need not be known beforehand: a [`RowSource`] is asked for violated rows only when those already in
//! the pool hold. That suits limits that hold for all times: the source answers with rows at the true extrema of the
//! trial step. A set of rows that were active last time warm-starts it.
//!
//! With B = L Lᵀ the method keeps J and the triangular R such that
//!
//! ```text
//! Jᵀ B J = 1,      Jᵀ A_active = [R; 0]
//! ```
//! It solves strictly convex problems only.
//!
//! Reference: D. Goldfarb, A. Idnani, "A numerically stable dual method for solving strictly convex quadratic
//! programs", Mathematical Programming 27, 1983.

use nalgebra::{DMatrix, DVector};

/// One linear row `aᵀ d ≤ b`; `a` is zero outside `start .. start + normal.len()`.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// First variable with a coefficient.
    pub start: usize,
    /// Coefficients a from there on.
    pub normal: Vec<f64>,
    /// Right-hand side b.
    pub bound: f64,
}

impl Row {
    /// `aᵀ d − b`: positive where the row is violated.
    #[must_use]
    pub fn excess(&self, d: &[f64]) -> f64 {
        dot(&self.normal, &d[self.start..self.start + self.normal.len()]) - self.bound
    }
}

/// Where rows come from.
pub trait RowSource {
    /// Appends rows that `step` violates by more than their tolerance; none means that the step is feasible.
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>);
}

/// A fixed list of rows, each held to a tolerance.
#[derive(Clone, Debug)]
pub struct FixedRows {
    /// The rows.
    pub rows: Vec<Row>,
    /// Largest excess that counts as none.
    pub tolerance: f64,
}

impl RowSource for FixedRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        rows.extend(self.rows.iter().filter(|row| row.excess(step) > self.tolerance).cloned());
    }
}

/// The solution of a quadratic program.
#[derive(Clone, Debug)]
pub struct QuadraticSolution {
    /// The step d.
    pub step: DVector<f64>,
    /// Rows that hold with equality, with their multipliers u ≥ 0: `B d + g + Σ u a = 0`.
    pub active: Vec<(Row, f64)>,
    /// Rows taken in or let go.
    pub iterations: usize,
}

/// Why a quadratic program has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuadraticFault {
    /// The matrix B is not positive definite.
    #[error("the Hessian is not positive definite")]
    NotConvex,
    /// No step satisfies all rows.
    #[error("no step satisfies all rows; one is violated by {excess:.3e} whatever the step")]
    Infeasible {
        /// By how much the row that could not be taken in is violated.
        excess: f64,
    },
    /// More iterations than allowed, which means cycling by rounding.
    #[error("more than {limit} rows taken in and let go")]
    Iterations {
        /// How many were allowed.
        limit: usize,
    },
}

/// Solves the program; `warm` holds rows that are likely to be active.
///
/// `hessian` is B (n × n, symmetric positive definite; the lower triangle is read), `gradient` is g (n).
///
/// # Errors
/// [`QuadraticFault`] if B is not positive definite, no step satisfies all rows, or rounding makes the method cycle.
pub fn solve_quadratic(
    hessian: &DMatrix<f64>,
    gradient: &[f64],
    warm: Vec<Row>,
    source: &mut dyn RowSource,
) -> Result<QuadraticSolution, QuadraticFault> {
    let mut state = ActiveSet::new(hessian, gradient)?;
    state.warm_start(warm);
    let n = gradient.len();
    let limit = 60 * n + 200;
    let mut pool: Vec<Row> = Vec::new();
    loop {
        let violated = pool
            .iter()
            .enumerate()
            .map(|(i, row)| (i, row.excess(&state.step)))
            .max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0)));
        match violated {
            Some((i, excess)) if excess > POOL_TOLERANCE * (1.0 + pool[i].bound.abs()) => {
                let row = pool.swap_remove(i);
                state.add(row, &mut pool, limit)?;
            }
            _ => {
                let before = pool.len();
                source.violated(&state.step, &mut pool);
                if pool.len() == before {
                    break;
                }
                // Rows that the source calls violated but the pool's tolerance does not: nothing left to gain.
                if pool[before..].iter().all(|row| row.excess(&state.step) <= POOL_TOLERANCE * (1.0 + row.bound.abs()))
                {
                    break;
                }
            }
        }
        if state.iterations > limit {
            return Err(QuadraticFault::Iterations { limit });
        }
    }
    let active = state.rows.into_iter().zip(state.multipliers).collect();
    Ok(QuadraticSolution { step: DVector::from_vec(state.step), active, iterations: state.iterations })
}

/// Excess of a row of the pool that counts as none, relative to 1 + |b|.
const POOL_TOLERANCE: f64 = 1e-10;

/// Part of a normal that must be independent of the active ones for a step in the primal space.
const INDEPENDENCE: f64 = 1e-9;

struct ActiveSet {
    n: usize,
    /// J, column by column.
    j: Vec<f64>,
    /// R, column by column with stride n.
    r: Vec<f64>,
    gradient: Vec<f64>,
    step: Vec<f64>,
    rows: Vec<Row>,
    multipliers: Vec<f64>,
    iterations: usize,
}

impl ActiveSet {
    fn new(hessian: &DMatrix<f64>, gradient: &[f64]) -> Result<Self, QuadraticFault> {
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
    fn warm_start(&mut self, warm: Vec<Row>) {
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
    fn add(&mut self, row: Row, pool: &mut Vec<Row>, limit: usize) -> Result<(), QuadraticFault> {
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

/// Turns columns x and y (x < y) of an n × n matrix.
fn rotate(matrix: &mut [f64], n: usize, x: usize, y: usize, cos: f64, sin: f64) {
    let (head, tail) = matrix.split_at_mut(y * n);
    for (a, b) in head[x * n..(x + 1) * n].iter_mut().zip(&mut tail[..n]) {
        (*a, *b) = (cos * *a + sin * *b, cos * *b - sin * *a);
    }
}

/// Cholesky factor L, column by column, of which the lower triangle is set; `None` if not positive definite.
fn lower_factor(matrix: &DMatrix<f64>) -> Option<Vec<f64>> {
    let n = matrix.nrows();
    let mut l = matrix.as_slice().to_vec();
    for k in 0..n {
        let pivot = l[k * n + k];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let root = pivot.sqrt();
        for value in &mut l[k * n + k..(k + 1) * n] {
            *value /= root;
        }
        let (done, rest) = l.split_at_mut((k + 1) * n);
        let column = &done[k * n..];
        for c in k + 1..n {
            let offset = (c - k - 1) * n;
            axpy(-column[c], &column[c..n], &mut rest[offset + c..offset + n]);
        }
    }
    Some(l)
}

/// L⁻ᵀ, column by column, from a lower factor.
fn inverse_transposed(l: &[f64], n: usize) -> Vec<f64> {
    // Column c of L⁻ᵀ is row c of L⁻¹: solve Lᵀ x = e_c backwards; it has entries 0 ..= c only.
    let mut j = vec![0.0; n * n];
    for c in 0..n {
        let x = &mut j[c * n..c * n + c + 1];
        x[c] = 1.0 / l[c * n + c];
        for i in (0..c).rev() {
            x[i] = -dot(&l[i * n + i + 1..i * n + c + 1], &x[i + 1..=c]) / l[i * n + i];
        }
    }
    j
}

/// Scalar product in a fixed order: four running sums, then the rest.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let (xs, ys) = (x.chunks_exact(4), y.chunks_exact(4));
    let rest: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(a, b)| a * b).sum();
    let mut sum = [0.0; 4];
    for (a, b) in xs.zip(ys) {
        for i in 0..4 {
            sum[i] += a[i] * b[i];
        }
    }
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + rest
}

fn axpy(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SupportedConeT};
    use rand::RngExt;

    struct Program {
        hessian: DMatrix<f64>,
        gradient: Vec<f64>,
        rows: Vec<Row>,
    }

    fn random(n: usize, count: usize, run: u64) -> Program {
        let mut rng = Seed::new(5).stream("quadratic program", run);
        let root = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
        let hessian = &root * root.transpose() + DMatrix::identity(n, n) * 0.1;
        let gradient = (0..n).map(|_| rng.random_range(-3.0..3.0)).collect();
        let rows = (0..count)
            .map(|k| {
                let (start, length) = if k % 3 == 0 { (0, n) } else { (n / 3, n / 2) };
                Row {
                    start,
                    normal: (0..length).map(|_| rng.random_range(-1.0..1.0)).collect(),
                    bound: rng.random_range(0.0..0.3),
                }
            })
            .collect();
        Program { hessian, gradient, rows }
    }

    fn clarabel(program: &Program) -> Vec<f64> {
        let n = program.gradient.len();
        let upper = DMatrix::from_fn(n, n, |i, j| if i <= j { program.hessian[(i, j)] } else { 0.0 });
        let dense = |m: &DMatrix<f64>| {
            let rows: Vec<Vec<f64>> = m.row_iter().map(|row| row.iter().copied().collect()).collect();
            CscMatrix::from(&rows)
        };
        let mut a = DMatrix::zeros(program.rows.len(), n);
        for (r, row) in program.rows.iter().enumerate() {
            for (k, &value) in row.normal.iter().enumerate() {
                a[(r, row.start + k)] = value;
            }
        }
        let bounds: Vec<f64> = program.rows.iter().map(|row| row.bound).collect();
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let cones = [SupportedConeT::NonnegativeConeT(bounds.len())];
        let mut solver =
            DefaultSolver::new(&dense(&upper), &program.gradient, &dense(&a), &bounds, &cones, settings).unwrap();
        solver.solve();
        solver.solution.x.clone()
    }

    fn check_optimality(program: &Program, solution: &QuadraticSolution) {
        let mut residual = &program.hessian * &solution.step + DVector::from_column_slice(&program.gradient);
        for (row, multiplier) in &solution.active {
            assert!(*multiplier >= 0.0 && row.excess(solution.step.as_slice()).abs() < 1e-9);
            for (k, a) in row.normal.iter().enumerate() {
                residual[row.start + k] += multiplier * a;
            }
        }
        assert!(residual.norm() < 1e-8, "stationarity {}", residual.norm());
        for row in &program.rows {
            assert!(row.excess(solution.step.as_slice()) < 1e-9);
        }
    }

    #[test]
    fn identity_solution_equals_an_interior_point_solver() {
        for run in 0..12 {
            let (n, count) = [(6, 40), (20, 200), (40, 600)][run as usize % 3];
            let program = random(n, count, run);
            let mut source = FixedRows { rows: program.rows.clone(), tolerance: 1e-10 };
            let solution = solve_quadratic(&program.hessian, &program.gradient, Vec::new(), &mut source).unwrap();
            check_optimality(&program, &solution);
            let other = clarabel(&program);
            for (x, y) in solution.step.iter().zip(&other) {
                // The interior-point solver stops at relative gaps of 1e-8.
                assert!((x - y).abs() < 1e-5, "{x} against {y}");
            }
        }
    }

    #[test]
    fn identity_warm_start_changes_the_path_not_the_solution() {
        let program = random(40, 600, 77);
        let mut source = FixedRows { rows: program.rows.clone(), tolerance: 1e-10 };
        let cold = solve_quadratic(&program.hessian, &program.gradient, Vec::new(), &mut source).unwrap();
        let active: Vec<Row> = cold.active.iter().map(|(row, _)| row.clone()).collect();
        let same = solve_quadratic(&program.hessian, &program.gradient, active.clone(), &mut source).unwrap();
        assert!((&same.step - &cold.step).norm() < 1e-9 && same.iterations == 0);
        // A wrong guess: some of the active rows, others that are not, one of them twice.
        let mut wrong: Vec<Row> = active[..active.len() / 2].to_vec();
        wrong.extend(program.rows[..30].iter().cloned());
        wrong.push(wrong[0].clone());
        let other = solve_quadratic(&program.hessian, &program.gradient, wrong, &mut source).unwrap();
        check_optimality(&program, &other);
        assert!((&other.step - &cold.step).norm() < 1e-8);
    }

    #[test]
    fn analytic_box_projection() {
        // The point of the unit box nearest to (2, −3, 0.5).
        let rows: Vec<Row> =
            (0..3).flat_map(|i| [1.0, -1.0].map(|sign| Row { start: i, normal: vec![sign], bound: 1.0 })).collect();
        let mut source = FixedRows { rows, tolerance: 1e-12 };
        let solution = solve_quadratic(&DMatrix::identity(3, 3), &[-2.0, 3.0, -0.5], Vec::new(), &mut source).unwrap();
        assert!((&solution.step - DVector::from_vec(vec![1.0, -1.0, 0.5])).norm() < 1e-14);
        let mut multipliers: Vec<f64> = solution.active.iter().map(|active| active.1).collect();
        multipliers.sort_by(f64::total_cmp);
        assert!((multipliers[0] - 1.0).abs() < 1e-14 && (multipliers[1] - 2.0).abs() < 1e-14);
    }

    #[test]
    fn contradicting_rows_and_concave_problems_are_faults() {
        let rows = vec![
            Row { start: 0, normal: vec![1.0, 0.0], bound: -1.0 },
            Row { start: 0, normal: vec![-1.0, 0.0], bound: -1.0 },
        ];
        let mut source = FixedRows { rows, tolerance: 1e-12 };
        let fault = solve_quadratic(&DMatrix::identity(2, 2), &[0.0, 0.0], Vec::new(), &mut source).unwrap_err();
        assert!(matches!(fault, QuadraticFault::Infeasible { excess } if excess > 1.0));
        let concave = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, -1.0]));
        assert_eq!(
            solve_quadratic(&concave, &[0.0, 0.0], Vec::new(), &mut source).unwrap_err(),
            QuadraticFault::NotConvex
        );
    }
}
