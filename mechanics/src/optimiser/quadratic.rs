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
//! It solves strictly convex problems only.
//!
//! Reference: D. Goldfarb, A. Idnani, "A numerically stable dual method for solving strictly convex quadratic
//! programs", Mathematical Programming 27, 1983.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use super::active_set::ActiveSet;
use super::error::QuadraticError;
use super::row::{Row, RowSource};
use super::vectors::axpy;

/// The solution of a quadratic program.
#[derive(Clone, Debug)]
pub struct QuadraticSolution {
    /// The step d.
    pub step: DVector<f64>,
    /// Rows that hold with equality, with their multipliers u ≥ 0: `B d + g + Σ u a = 0`.
    pub active: Vec<(Row, f64)>,
    /// Rows added or dropped.
    pub iterations: usize,
}

impl QuadraticSolution {
    /// Gradient of the Lagrangian without its quadratic term, `g + Σ u a`, which is `−B d`.
    pub fn lagrangian_gradient(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let mut sum = gradient.clone();
        for (row, multiplier) in &self.active {
            axpy(*multiplier, &row.normal, &mut sum.as_mut_slice()[row.start..row.start + row.normal.len()]);
        }
        sum
    }
}

/// Solves the program; `warm` holds rows that are likely to be active.
///
/// `inverse` is H = B⁻¹ (n × n, symmetric positive definite), `gradient` is g (n).
///
/// # Errors
/// [`QuadraticError`] if H is not positive definite, no step satisfies all rows, or rounding makes the method cycle.
pub fn solve_quadratic(
    inverse: &DMatrix<f64>,
    gradient: &[f64],
    warm: Vec<Row>,
    source: &mut dyn RowSource,
) -> Result<QuadraticSolution, QuadraticError> {
    Arch::new().dispatch(Program { inverse, gradient, warm, source })
}

/// A program, solved by loops that are compiled for the vectors of the processor by their width alone: sums are those of the text.
struct Program<'a> {
    inverse: &'a DMatrix<f64>,
    gradient: &'a [f64],
    warm: Vec<Row>,
    source: &'a mut dyn RowSource,
}

impl WithSimd for Program<'_> {
    type Output = Result<QuadraticSolution, QuadraticError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        solution(self)
    }
}

#[inline(always)]
fn solution(Program { inverse, gradient, warm, source }: Program<'_>) -> Result<QuadraticSolution, QuadraticError> {
    let mut state = ActiveSet::new(inverse, gradient)?;
    state.warm_start(warm)?;
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
            return Err(QuadraticError::Iterations { limit });
        }
    }
    let active = state.rows.into_iter().zip(state.multipliers).collect();
    Ok(QuadraticSolution { step: DVector::from_vec(state.step), active, iterations: state.iterations })
}

/// Excess of a row of the pool that counts as none, relative to 1 + |b|.
const POOL_TOLERANCE: f64 = 1e-10;
