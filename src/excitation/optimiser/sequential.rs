//! Sequential quadratic programming whose iterates never leave the linear limits.
//!
//! ```text
//! d = argmin ½ dᵀ B d + ∇f(x)ᵀ d    subject to   x + d inside the linear limits,   c_r(x) + ∇c_r(x)ᵀ d ≤ 0
//! x ← x + t d                        t ∈ (0, 1] by the merit f + ρ · excess
//! ```
//! The linear limits form a convex set that holds for all times, so a step of any length t ≤ 1 stays inside, and only
//! the smooth limits (torque) need a merit function. B is a damped BFGS matrix (Powell), ρ grows with the multipliers.
//! The rows that were active warm-start the next program.
//!
//! Reference: J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed., 2006, ch. 18.

use std::mem::replace;

use nalgebra::{DMatrix, DVector};

use super::quadratic::{QuadraticFault, QuadraticSolution, solve_quadratic};
use super::row::{Row, RowSource};

/// A function to be minimised.
pub trait Objective {
    /// Its value at `x`.
    fn value(&mut self, x: &[f64]) -> f64;

    /// Its gradient at the point of the last [`Self::value`].
    fn gradient(&mut self, gradient: &mut [f64]);
}

/// Linear limits, possibly infinitely many, as rows around a point.
pub trait LinearLimits: RowSource {
    /// Rows are for steps from `x` from now on.
    fn recenter(&mut self, x: &[f64]);
}

/// Limits that are smooth functions of the variables.
pub trait SmoothLimits {
    /// Sum over groups of the worst excess of each, 0 where all hold.
    fn excess(&mut self, x: &[f64]) -> f64;

    /// Rows of those limits that are nearly active at `x`: `∇c_rᵀ d ≤ −c_r`.
    fn linearise(&mut self, x: &[f64], rows: &mut Vec<Row>);
}

/// Several kinds of smooth limits at once.
#[derive(Default)]
pub struct Together {
    /// Each kind.
    pub limits: Vec<Box<dyn SmoothLimits>>,
}

impl SmoothLimits for Together {
    fn excess(&mut self, x: &[f64]) -> f64 {
        self.limits.iter_mut().map(|limits| limits.excess(x)).sum()
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<Row>) {
        for limits in &mut self.limits {
            limits.linearise(x, rows);
        }
    }
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
    hessian: DMatrix<f64>,
    scaled: bool,
    warm: Vec<Row>,
    penalty: f64,
    settings: SequentialSettings,
}

/// Steps towards the inside of the smooth limits before they count as out of reach.
const RESTORATIONS: usize = 8;

/// Part of the predicted decrease that a step must reach.
const SUFFICIENT: f64 = 1e-4;

impl Sequential {
    /// Starts at `x`, which the linear limits allow.
    #[must_use]
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
            hessian: DMatrix::identity(n, n),
            scaled: false,
            warm: Vec::new(),
            penalty: 0.0,
            settings,
        };
        state.restart(objective, smooth);
        let steepest = state.gradient.amax();
        if steepest > 0.0 && steepest.is_finite() {
            state.hessian *= steepest / settings.first_step;
        }
        state
    }

    /// Evaluates the current point anew, after the objective has changed.
    pub fn restart(&mut self, objective: &mut dyn Objective, smooth: &mut dyn SmoothLimits) {
        self.value = objective.value(&self.x);
        objective.gradient(self.gradient.as_mut_slice());
        self.excess = smooth.excess(&self.x);
        self.evaluations += 2;
    }

    /// Moves to the nearest point inside the smooth limits, without looking at the objective:
    ///
    /// ```text
    /// d = argmin ½ |d|²    subject to   x + d inside the linear limits,   c_r(x) + ∇c_r(x)ᵀ d ≤ 0        x ← x + d
    /// ```
    /// until the excess is `tolerance` at most: from nearly inside two or three such steps. Returns whether it got there.
    pub fn restore(&mut self, linear: &mut dyn LinearLimits, smooth: &mut dyn SmoothLimits, tolerance: f64) -> bool {
        let n = self.x.len();
        let (still, even) = (DVector::zeros(n), DMatrix::identity(n, n));
        let (gradient, hessian) = (replace(&mut self.gradient, still), replace(&mut self.hessian, even));
        for _ in 0..RESTORATIONS {
            self.excess = smooth.excess(&self.x);
            if self.excess <= tolerance {
                break;
            }
            linear.recenter(&self.x);
            let mut rows = Vec::new();
            smooth.linearise(&self.x, &mut rows);
            self.warm.clear();
            let Some(solution) = self.direction(linear, &rows) else { break };
            for (x, d) in self.x.iter_mut().zip(&solution.step) {
                *x += d;
            }
        }
        (self.gradient, self.hessian) = (gradient, hessian);
        self.excess = smooth.excess(&self.x);
        self.excess <= tolerance
    }

    /// Allows this many evaluations in all from now on.
    pub fn allow(&mut self, evaluations: usize) {
        self.settings.max_evaluations = evaluations;
    }

    /// Forgets the curvature learnt so far.
    pub fn forget(&mut self) {
        let n = self.x.len();
        let size = self.hessian.trace() / n as f64;
        self.hessian = DMatrix::identity(n, n) * size;
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
        let mut smooth_rows = Vec::new();
        smooth.linearise(&self.x, &mut smooth_rows);
        let Some(solution) = self.direction(linear, &smooth_rows) else { return Progress::Stalled };
        let d = &solution.step;
        let slope = self.gradient.dot(d);
        // What the model says the merit will lose: the smooth limits' excess goes to zero along d.
        let multiplier = solution
            .active
            .iter()
            .filter(|(row, _)| smooth_rows.iter().any(|other| other.normal == row.normal))
            .map(|active| active.1)
            .fold(0.0, f64::max);
        self.penalty = self.penalty.max(2.0 * multiplier);
        let promised = -slope + self.penalty * self.excess;
        if promised < self.settings.tolerance {
            self.keep_active(solution, 0.0);
            return Progress::Stationary;
        }
        let merit = self.value + self.penalty * self.excess;
        let mut length = 1.0;
        for _ in 0..self.settings.shortenings {
            if self.evaluations + 2 > self.settings.max_evaluations {
                self.keep_active(solution, 0.0);
                return Progress::OutOfBudget;
            }
            let trial: Vec<f64> = self.x.iter().zip(d).map(|(x, d)| x + length * d).collect();
            let value = objective.value(&trial);
            let excess = smooth.excess(&trial);
            self.evaluations += 1;
            let trial_merit = value + self.penalty * excess;
            if trial_merit <= merit - SUFFICIENT * length * promised {
                let mut gradient = DVector::zeros(self.x.len());
                objective.gradient(gradient.as_mut_slice());
                self.evaluations += 1;
                self.iterations += 1;
                let step = DVector::from_iterator(self.x.len(), d.iter().map(|d| length * d));
                let change = &gradient - &self.gradient;
                self.x = trial;
                self.value = value;
                self.excess = excess;
                self.gradient = gradient;
                self.learn(&step, change);
                self.keep_active(solution, length);
                return Progress::Moved;
            }
            // The minimum of the parabola through the two merits and the slope.
            let curve = trial_merit - merit + length * promised;
            let best = if curve.is_finite() && curve > 0.0 { 0.5 * promised * length * length / curve } else { 0.0 };
            length = best.clamp(0.1 * length, 0.5 * length);
        }
        self.keep_active(solution, 0.0);
        Progress::Stalled
    }

    /// Solves the program; where its smooth rows contradict the limits, they are asked for less.
    fn direction(&mut self, linear: &mut dyn LinearLimits, smooth_rows: &[Row]) -> Option<QuadraticSolution> {
        for part in [1.0, 0.5, 0.0] {
            let rows = smooth_rows.iter().map(|row| {
                let bound = if row.bound < 0.0 { part * row.bound } else { row.bound };
                Row { bound, ..row.clone() }
            });
            let mut source = Both { smooth: rows.collect(), linear: &mut *linear };
            let warm = self.warm.clone();
            match solve_quadratic(&self.hessian, self.gradient.as_slice(), warm, &mut source) {
                Ok(solution) => return Some(solution),
                Err(QuadraticFault::NotConvex | QuadraticFault::Iterations { .. }) => self.forget(),
                Err(QuadraticFault::Infeasible { .. }) => {}
            }
        }
        None
    }

    /// Damped BFGS update with a step and the change of the gradient along it.
    fn learn(&mut self, step: &DVector<f64>, mut change: DVector<f64>) {
        let along = step.dot(&change);
        if !self.scaled && along > 0.0 {
            let n = self.x.len();
            self.hessian = DMatrix::identity(n, n) * (change.norm_squared() / along);
            self.scaled = true;
        }
        let turned = &self.hessian * step;
        let curvature = step.dot(&turned);
        if curvature.is_nan() || curvature <= 0.0 {
            return;
        }
        if along < 0.2 * curvature {
            let theta = 0.8 * curvature / (curvature - along);
            change = change * theta + &turned * (1.0 - theta);
        }
        let along = step.dot(&change);
        self.hessian.ger(1.0 / along, &change, &change, 1.0);
        self.hessian.ger(-1.0 / curvature, &turned, &turned, 1.0);
    }

    /// Keeps the linear rows that were active as the next program's first guess, as seen from the new point.
    fn keep_active(&mut self, solution: QuadraticSolution, length: f64) {
        self.warm.clear();
        for (mut row, _) in solution.active {
            if row.normal.len() < self.x.len() {
                let range = row.start..row.start + row.normal.len();
                let moved: f64 = row.normal.iter().zip(&solution.step.as_slice()[range]).map(|(a, d)| a * d).sum();
                row.bound -= length * moved;
                self.warm.push(row);
            }
        }
    }
}

struct Both<'a> {
    smooth: Vec<Row>,
    linear: &'a mut dyn LinearLimits,
}

impl RowSource for Both<'_> {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        let tolerance = |row: &Row| 1e-9 * (1.0 + row.bound.abs());
        rows.extend(self.smooth.iter().filter(|row| row.excess(step) > tolerance(row)).cloned());
        self.linear.violated(step, rows);
    }
}
