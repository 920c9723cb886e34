//! Newton's method for the objective of one weight.
//!
//! ```text
//! f(x) = ½ xᵀ A x − gᵀ x + w D(x)        step −H⁻¹ ∇f, halved until f falls by a fifth of what its slope promises
//! ```
//! f is convex and D a barrier, so each iterate is a set of bodies; the end is certified by the decrement, `f − f* ≈ ½ δ²`.

use nalgebra::{DMatrix, DVector};

use super::bodies::Body;
use super::drives::Coefficient;
use super::equations::NormalEquations;
use crate::estimation::termination::Termination;

/// Steps at most.
const STEPS: usize = 500;

/// δ² at which a search ends, in units of the objective: χ² beyond the optimum. Its root is how far a parameter may be from there, in
/// standard deviations.
const AT_REST: f64 = 1e-6;

/// Part of the promised fall that a step must bring, and halvings before it is given up.
const ARMIJO: f64 = 0.2;
const HALVINGS: usize = 40;

/// What the prior is made of.
#[derive(Clone, Debug)]
pub(super) struct Divergence {
    pub(super) bodies: Vec<Body>,
    pub(super) coefficients: Vec<Coefficient>,
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) x: DVector<f64>,
    pub(super) termination: Termination,
}

struct Point {
    value: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Divergence {
    /// Where a search begins: the guess.
    pub(super) fn centre(&self, p: usize) -> DVector<f64> {
        let mut x = DVector::zeros(p);
        for body in &self.bodies {
            x.fixed_rows_mut::<10>(body.at).copy_from(&Body::centre());
        }
        for coefficient in &self.coefficients {
            x[coefficient.at] = coefficient.centre();
        }
        x
    }

    fn at(&self, equations: &NormalEquations, w: f64, x: &DVector<f64>) -> Option<Point> {
        let mut gradient = &equations.information * x - &equations.moment;
        let mut hessian = equations.information.clone();
        let mut value = 0.5 * x.dot(&(&gradient - &equations.moment));
        for body in &self.bodies {
            value += body.add(w, x, &mut gradient, &mut hessian)?;
        }
        for coefficient in &self.coefficients {
            value += coefficient.add(w, x, &mut gradient, &mut hessian)?;
        }
        value.is_finite().then_some(Point { value, gradient, hessian })
    }

    /// The minimum for the last of falling weights, from the guess and then each from the one before: a small weight alone is far from
    /// the guess, on the edge of what bodies can be.
    pub(super) fn descend(&self, equations: &NormalEquations, weights: impl IntoIterator<Item = f64>) -> Minimum {
        let x = self.centre(equations.moment.len());
        let mut minimum = Minimum { x, termination: Termination::Direct };
        for w in weights {
            minimum = self.minimise(equations, w, &minimum.x);
        }
        minimum
    }

    /// The minimum from `start`, a set inside.
    pub(super) fn minimise(&self, equations: &NormalEquations, w: f64, start: &DVector<f64>) -> Minimum {
        let mut x = start.clone();
        let ended = |x: DVector<f64>, termination| Minimum { x, termination };
        let Some(mut here) = self.at(equations, w, &x) else {
            return ended(x, Termination::Singular { iterations: 0 });
        };
        let mut decrement = f64::INFINITY;
        for iterations in 0..STEPS {
            let Some(step) = newton(&here) else {
                return ended(x, Termination::Singular { iterations });
            };
            decrement = -here.gradient.dot(&step);
            // What rounding of the value hides is no way on.
            let gap = 0.5 * decrement.max(0.0) / (here.value + 0.5 * equations.square).abs().max(1.0);
            if decrement <= AT_REST.max(4.0 * f64::EPSILON * here.value.abs()) {
                return ended(x, Termination::Optimal { iterations, gap });
            }
            let mut length = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let trial = &x + &step * length;
                if let Some(there) = self.at(equations, w, &trial)
                    && there.value <= here.value - ARMIJO * length * decrement
                {
                    next = Some((trial, there));
                    break;
                }
                length *= 0.5;
            }
            let Some((trial, there)) = next else {
                if decrement <= equations.rounding(&x) {
                    return ended(x, Termination::Optimal { iterations, gap });
                }
                return ended(x, Termination::Stalled { iterations, last_step: decrement.sqrt() });
            };
            (x, here) = (trial, there);
        }
        ended(x, Termination::IterationLimit { iterations: STEPS, last_step: decrement.sqrt() })
    }
}

/// `−H⁻¹ ∇f`, in units in which the diagonal of H is one.
fn newton(point: &Point) -> Option<DVector<f64>> {
    let unit = point.hessian.diagonal().map(|d| 1.0 / d.sqrt());
    let p = unit.len();
    let scaled = DMatrix::from_fn(p, p, |i, j| point.hessian[(i, j)] * unit[i] * unit[j]);
    let step = scaled.cholesky()?.solve(&point.gradient.component_mul(&unit));
    let step = -step.component_mul(&unit);
    step.iter().all(|x| x.is_finite()).then_some(step)
}
