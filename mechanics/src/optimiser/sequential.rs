//! Sequential quadratic programming whose iterates never leave the linear limits.
//!
//! ```text
//! d = argmin ½ dᵀ B d + ∇f(x)ᵀ d    subject to   x + d inside the linear limits,   c_r(x) + ∇c_r(x)ᵀ d ≤ 0
//! x ← x + t d + e                    t ∈ (0, 1] by the merit f + ρ · excess
//! ```
//! The linear limits form a convex set that holds for all times, so a step of any length t ≤ 1 stays inside, and only
//! the smooth limits need a merit function. They are curved: the second-order correction e takes the end of a step back
//! to them where it has left them by much. B is a damped BFGS matrix (Powell) of the Lagrangian `f + Σ u_r c_r`, so that it
//! includes their curvature, and is kept as its inverse; ρ follows the multipliers u up and, slowly, down. The rows that were active
//! warm-start the next program.
//!
//! References: J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed., 2006, ch. 18; M. J. D. Powell, "A fast algorithm
//! for nonlinearly constrained optimization calculations", Lecture Notes in Mathematics 630, 1978.

use nalgebra::{DMatrix, DVector};

use super::error::QuadraticError;
use super::quadratic::{QuadraticSolution, solve_quadratic};
use super::restoration::{Both, solve_relaxed};
use super::row::{LinearLimits, Row};
use super::smooth::{SmoothLimits, SmoothRow, largest_of_limits, linearised};

/// A function to be minimised.
pub trait Objective {
    /// Its value at `x`.
    fn value(&mut self, x: &[f64]) -> f64;

    /// Its gradient at the point of the last [`Self::value`].
    fn gradient(&mut self, gradient: &mut [f64]);
}

/// What a step of the optimiser led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// A better point.
    Moved,
    /// The model promises less than the tolerance.
    Stationary,
    /// No step along the direction lowers the merit.
    Stalled,
    /// A value and a gradient more would exceed the allowed evaluations.
    OutOfBudget,
}

/// Settings of the optimiser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SequentialSettings {
    /// Predicted decrease that counts as none.
    pub tolerance: f64,
    /// Largest first step, in the variables' own scale.
    pub first_step: f64,
    /// Shortenings of a step before it counts as stalled.
    pub shortenings: usize,
    /// Evaluations allowed in all.
    pub max_evaluations: usize,
}

impl Default for SequentialSettings {
    fn default() -> Self {
        Self { tolerance: 1e-6, first_step: 0.3, shortenings: 12, max_evaluations: usize::MAX }
    }
}

/// The optimiser's state between steps.
#[derive(Clone, Debug)]
pub struct Sequential {
    /// Current point.
    pub x: Vec<f64>,
    /// Value there.
    pub value: f64,
    /// Excess over the smooth limits there.
    pub excess: f64,
    /// Values counted as one evaluation and gradients as one more.
    pub evaluations: usize,
    /// Steps taken.
    pub iterations: usize,
    gradient: DVector<f64>,
    /// The smooth limits there.
    rows: Vec<SmoothRow>,
    /// H = B⁻¹.
    inverse: DMatrix<f64>,
    scaled: bool,
    warm: Vec<Row>,
    penalty: f64,
    /// How far it goes; may change between steps.
    pub settings: SequentialSettings,
}

/// Part of the predicted decrease that a step must reach.
const SUFFICIENT: f64 = 1e-4;

impl Sequential {
    /// Starts at `x`, which the linear limits allow, but for a little.
    pub fn new(
        x: Vec<f64>,
        objective: &mut dyn Objective,
        smooth: &mut dyn SmoothLimits,
        settings: SequentialSettings,
    ) -> Self {
        let n = x.len();
        let mut state = Self {
            x,
            value: 0.0,
            excess: 0.0,
            evaluations: 0,
            iterations: 0,
            gradient: DVector::zeros(n),
            rows: Vec::new(),
            inverse: DMatrix::identity(n, n),
            scaled: false,
            warm: Vec::new(),
            penalty: 0.0,
            settings,
        };
        state.restart(objective, smooth);
        let steepest = state.gradient.amax();
        if steepest > 0.0 && steepest.is_finite() {
            state.inverse *= settings.first_step / steepest;
        }
        state
    }

    /// Evaluates the current point anew, after the objective has changed.
    pub fn restart(&mut self, objective: &mut dyn Objective, smooth: &mut dyn SmoothLimits) {
        self.value = objective.value(&self.x);
        objective.gradient(self.gradient.as_mut_slice());
        self.excess = smooth.excess(&self.x);
        self.rows = linearised(smooth, &self.x);
        self.evaluations += 2;
    }

    /// Resets B to a multiple of the identity of the same mean curvature.
    fn reset_hessian(&mut self) {
        let n = self.x.len();
        let stiffness: f64 = self.inverse.diagonal().iter().map(|flexibility| 1.0 / flexibility).sum();
        self.inverse = DMatrix::identity(n, n) * (n as f64 / stiffness);
        self.scaled = false;
    }

    /// One step.
    pub fn step(
        &mut self,
        objective: &mut dyn Objective,
        linear: &mut dyn LinearLimits,
        smooth: &mut dyn SmoothLimits,
    ) -> Progress {
        if self.evaluations + 2 > self.settings.max_evaluations {
            return Progress::OutOfBudget;
        }
        linear.recenter(&self.x);
        let Some(solution) = self.direction(linear) else { return Progress::Stalled };
        let d = &solution.step;
        let still = DVector::zeros(d.len());
        let slope = self.gradient.dot(d);
        // What the model says the merit will lose: along d the excess of all limits goes to zero, also the little by which x is
        // outside linear ones. Getting inside those may raise f by `restoring`, which is no reason to stay.
        let active = self.active_rows(&solution);
        let multiplier = largest_of_limits(&active);
        self.penalty = (2.0 * multiplier).max(0.5 * self.penalty + multiplier);
        let restoring = self.cost_of_restoring(&solution);
        let promised = -slope + self.penalty * self.excess + restoring;
        if promised < self.settings.tolerance {
            self.keep_active(solution, &still);
            return Progress::Stationary;
        }
        let merit = self.value + self.penalty * self.excess;
        let mut length = 1.0;
        for _ in 0..self.settings.shortenings {
            if self.evaluations + 2 > self.settings.max_evaluations {
                self.keep_active(solution, &still);
                return Progress::OutOfBudget;
            }
            let CorrectedPoint { x: trial, excess, correction_gradient } =
                self.second_order_correction(d, length, promised, linear, smooth);
            let value = objective.value(&trial);
            self.evaluations += 1;
            let trial_merit = value + self.penalty * excess - length * restoring;
            if trial_merit <= merit - SUFFICIENT * length * promised {
                let mut gradient = DVector::zeros(self.x.len());
                objective.gradient(gradient.as_mut_slice());
                self.evaluations += 1;
                self.iterations += 1;
                let step = DVector::from_iterator(self.x.len(), trial.iter().zip(&self.x).map(|(to, from)| to - from));
                let rows = linearised(smooth, &trial);
                let mut change = &gradient - &self.gradient;
                for (row, multiplier) in active {
                    row.add_gradient_change(&rows, multiplier, change.as_mut_slice());
                }
                // B d = −g − Σ u a: the program's own condition.
                let expected = solution.lagrangian_gradient(&self.gradient) * -length - correction_gradient;
                self.x = trial;
                self.value = value;
                self.excess = excess;
                self.gradient = gradient;
                self.rows = rows;
                self.update_hessian(&step, change, expected);
                self.keep_active(solution, &step);
                return Progress::Moved;
            }
            // The minimum of the parabola through the two merits and the slope.
            let curve = trial_merit - merit + length * promised;
            let best = if curve.is_finite() && curve > 0.0 { 0.5 * promised * length * length / curve } else { 0.0 };
            length = best.clamp(0.1 * length, 0.5 * length);
        }
        self.keep_active(solution, &still);
        Progress::Stalled
    }

    /// The point `x + t d`, moved into the smooth limits where their excess, beyond what the model leaves of it at that
    /// length, would cost more than is promised:
    ///
    /// ```text
    /// e = argmin ½ eᵀ B e    subject to   y + e inside the linear limits,   c_r(y) + ∇c_r(y)ᵀ e ≤ 0,   y = x + t d
    /// ```
    /// Without this second-order correction a step along curved limits would have to be short (the Maratos effect).
    fn second_order_correction(
        &self,
        d: &DVector<f64>,
        length: f64,
        promised: f64,
        linear: &mut dyn LinearLimits,
        smooth: &mut dyn SmoothLimits,
    ) -> CorrectedPoint {
        let x: Vec<f64> = self.x.iter().zip(d).map(|(x, d)| x + length * d).collect();
        let still = DVector::zeros(x.len());
        let excess = smooth.excess(&x);
        let straight = CorrectedPoint { x, excess, correction_gradient: still.clone() };
        if self.penalty * (excess - (1.0 - length) * self.excess) <= length * promised {
            return straight;
        }
        linear.recenter(&straight.x);
        let rows = linearised(smooth, &straight.x).into_iter().map(|smooth| smooth.row).collect();
        let mut source = Both { smooth: rows, linear };
        let Ok(solution) = solve_quadratic(&self.inverse, still.as_slice(), Vec::new(), &mut source) else {
            return straight;
        };
        let x: Vec<f64> = straight.x.iter().zip(&solution.step).map(|(x, e)| x + e).collect();
        let excess = smooth.excess(&x);
        if excess < straight.excess {
            CorrectedPoint { x, excess, correction_gradient: solution.lagrangian_gradient(&still) }
        } else {
            straight
        }
    }

    /// Solves the program.
    fn direction(&mut self, linear: &mut dyn LinearLimits) -> Option<QuadraticSolution> {
        let solve = |state: &Self, linear: &mut dyn LinearLimits| {
            solve_relaxed(&state.inverse, state.gradient.as_slice(), state.warm.clone(), &state.rows, linear)
        };
        match solve(self, linear) {
            // The same once more without the Hessian so far, which rounding may have spoilt.
            Err(QuadraticError::NotConvex | QuadraticError::Iterations { .. }) => {
                self.reset_hessian();
                solve(self, linear).ok()
            }
            solution => solution.ok(),
        }
    }

    /// What it costs by the multipliers to come back into the linear limits that x is outside of, `Σ u_r max(−b_r, 0)`: at most what
    /// the slope along the step has lost to them.
    fn cost_of_restoring(&self, solution: &QuadraticSolution) -> f64 {
        let is_linear = |row: &Row| self.rows.iter().all(|smooth| smooth.row.normal != row.normal);
        let outside = solution.active.iter().filter(|(row, _)| row.bound < 0.0 && is_linear(row));
        outside.map(|(row, multiplier)| -multiplier * row.bound).sum()
    }

    /// The smooth limits that are active in a solution, with their multipliers.
    fn active_rows(&self, solution: &QuadraticSolution) -> Vec<(SmoothRow, f64)> {
        let multiplier = |smooth: &SmoothRow| {
            solution.active.iter().find(|(row, _)| row.normal == smooth.row.normal).map(|(_, multiplier)| *multiplier)
        };
        self.rows.iter().filter_map(|row| Some((row.clone(), multiplier(row)?))).collect()
    }

    /// Damped BFGS update with a step, the change of the gradient along it, and what the model said it would be, `B s`.
    ///
    /// ```text
    /// H ← (1 − s yᵀ/sᵀy) H (1 − y sᵀ/sᵀy) + s sᵀ/sᵀy
    /// ```
    fn update_hessian(&mut self, step: &DVector<f64>, mut change: DVector<f64>, mut expected: DVector<f64>) {
        let along = step.dot(&change);
        if !self.scaled && along > 0.0 {
            let n = self.x.len();
            let stiffness = change.norm_squared() / along;
            self.inverse = DMatrix::identity(n, n) / stiffness;
            expected = step * stiffness;
            self.scaled = true;
        }
        let curvature = step.dot(&expected);
        if curvature.is_nan() || curvature <= 0.0 {
            return;
        }
        if along < 0.2 * curvature {
            let theta = 0.8 * curvature / (curvature - along);
            change = change * theta + expected * (1.0 - theta);
        }
        let along = step.dot(&change);
        let turned = &self.inverse * &change;
        self.inverse.ger(-1.0 / along, step, &turned, 1.0);
        self.inverse.ger(-1.0 / along, &turned, step, 1.0);
        self.inverse.ger((1.0 + change.dot(&turned) / along) / along, step, step, 1.0);
    }

    /// Keeps the linear rows that were active as the next program's first guess, as seen from where the step led.
    fn keep_active(&mut self, solution: QuadraticSolution, step: &DVector<f64>) {
        self.warm.clear();
        for (mut row, _) in solution.active {
            if row.normal.len() < self.x.len() {
                row.bound = -row.excess(step.as_slice());
                self.warm.push(row);
            }
        }
    }
}

/// The end of a step, with its second-order correction.
struct CorrectedPoint {
    x: Vec<f64>,
    /// Their excess there.
    excess: f64,
    /// −B e of the correction e.
    correction_gradient: DVector<f64>,
}
