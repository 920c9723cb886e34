//! The path of minimisers from the guess to the optimum, and the certificate at its end.
//!
//! ```text
//! φ(λ) = argmin λ f(φ) + B(φ)        f = ½ χ² + R        λ → ∞
//! f(φ) − f(φ') ≤ ( ν + δ (ν + 2√ν) + ½ δ² )/λ        for every consistent φ'
//! ```
//! ν counts the logarithms of B and δ is the decrement at φ. The right side over f(φ) is the gap, found from φ alone: no other
//! solver has to be believed. Where there is no prior, S(φ') ≤ H is one more condition ([`Region::horizon`]): without it the data can
//! have links grow for ever, and there is no optimum. S is counted from the guess scaled to the size of the
//! estimate. Of the sets with the base parameters of the optimum the one nearest to the guess is taken.
//!
//! References: Y. Nesterov, "Lectures on Convex Optimization", Springer, 2018, section 5.3; S. Boyd, L. Vandenberghe, "Convex
//! Optimization", Cambridge, 2004, section 11.3.

use nalgebra::DVector;

use super::newton::{DataTerm, Ending, Minimum, STEPS, minimise, project, unconstrained};
use super::prior::{NEAREST, Prior};
use super::region::Region;
use crate::estimation::termination::Termination;

/// λ grows by this factor from one minimum to the next.
const GROWTH: f64 = 20.0;

/// Minima at most: from any χ² of an estimate to its rounding.
const MINIMA: usize = 40;

/// Part of the objective within which the optimum is: a tenth of what another solver's optimum is compared to.
const GAP: f64 = 1e-7;

/// χ² at which the estimated base parameters may be had exactly.
const NEARLY_EXACT: f64 = 1e-2;

/// χ² at which a set is indistinguishable from the estimate.
const INDISTINGUISHABLE: f64 = 1e-8;

/// Decrement at which a minimum on the way is near enough.
const ON_THE_WAY: f64 = 0.1;

/// Times that λ grows beyond what the gap asks, and steps for each: the base parameters are then known far better than by the gap.
const REFINEMENTS: usize = 3;
const REFINING_STEPS: usize = 12;

/// Decrement of a minimum that is handed on.
const AT_REST: f64 = 1e-7;

/// The end of the path.
pub(super) struct PathEnd {
    /// The set, nearest to the guess of those with its base parameters.
    pub(super) phi: DVector<f64>,
    /// The set at the end of the path, with the same base parameters.
    pub(super) optimum: DVector<f64>,
    /// λ, infinite where the base parameters are the estimated ones.
    pub(super) lambda: f64,
    pub(super) termination: Termination,
}

/// Follows the path from the guess.
pub(super) fn follow(region: &Region, data: &DataTerm<'_>, prior: Prior) -> PathEnd {
    let at_once = |phi: DVector<f64>, lambda| {
        let termination = Termination::Optimal { iterations: 1, gap: 0.0 };
        PathEnd { optimum: DVector::clone(&phi), phi, lambda, termination }
    };
    match prior {
        Prior::None => {
            let (mut way, start) = (Way { region, data, prior, iterations: 0 }, region.centre());
            if let Some(exact) = way.exact(&start) {
                return exact;
            }
            // A guess as large as the data say: whatever unit the torque has, the search is the same.
            let size = libm::sqrt(data.size_of_estimate() / data.size_of(&start));
            let size = if size.is_finite() && size > 0.0 { size } else { 1.0 };
            let scaled = region.scaled(size);
            let iterations = way.iterations;
            let mut way = Way { region: &scaled, data, prior, iterations };
            let end = way.barrier(scaled.centre());
            Way { region, ..way }.nearest(end)
        }
        Prior::Pullback | Prior::Euclidean => match unconstrained(region, data, prior) {
            Some(phi) if region.contains(&phi) => at_once(phi, 1.0),
            _ => Way { region, data, prior, iterations: 0 }.barrier(region.centre()),
        },
        Prior::Entropic => Way { region, data, prior, iterations: 0 }.barrier(region.centre()),
    }
}

struct Way<'a> {
    region: &'a Region,
    data: &'a DataTerm<'a>,
    prior: Prior,
    iterations: usize,
}

impl Way<'_> {
    fn barrier(&mut self, mut phi: DVector<f64>) -> PathEnd {
        let (inside, bounds) = self.region.logarithms();
        // The entropic prior has the logarithms of its own; without bounds nothing else is asked.
        let nu = (bounds
            + match self.prior {
                Prior::None => inside + 1,
                Prior::Entropic => 0,
                Prior::Pullback | Prior::Euclidean => inside,
            }) as f64;
        let mut lambda = (nu.max(1.0) / self.objective(&phi).max(INDISTINGUISHABLE)).min(1.0);
        if self.prior == Prior::Entropic {
            // Its logarithms are self-concordant from here on.
            lambda = 1.0;
        }
        for _ in 0..MINIMA {
            let minimum = self.minimise(phi.clone(), lambda, ON_THE_WAY, STEPS);
            if minimum.ending != Ending::Reached {
                return self.stopped(minimum, lambda);
            }
            phi = minimum.phi;
            let f = self.objective(&phi);
            if self.prior == Prior::None
                && 2.0 * f <= NEARLY_EXACT
                && let Some(exact) = self.exact(&phi)
            {
                return exact;
            }
            let is_optimal =
                excess(nu, minimum.decrement, lambda) <= GAP * f || 2.0 * f <= INDISTINGUISHABLE || nu == 0.0;
            if is_optimal {
                return self.refined(phi, lambda, nu, minimum.decrement);
            }
            // No farther than the gap asks: rounding grows with λ.
            lambda *= GROWTH.min(1.2 * excess(nu, ON_THE_WAY, lambda) / (GAP * f));
        }
        let termination = Termination::IterationLimit { iterations: self.iterations, last_step: f64::NAN };
        PathEnd { optimum: phi.clone(), phi, lambda, termination }
    }

    /// The nearest set with exactly the estimated base parameters; `None` where no consistent one is found.
    fn exact(&mut self, phi: &DVector<f64>) -> Option<PathEnd> {
        let start = project(phi.clone(), self.region, self.data)?;
        let minimum = minimise(start, self.region, self.data, Prior::None, NEAREST, AT_REST, STEPS);
        self.iterations += minimum.iterations;
        (minimum.ending == Ending::Reached).then(|| PathEnd {
            optimum: minimum.phi.clone(),
            phi: minimum.phi,
            lambda: f64::INFINITY,
            termination: Termination::Optimal { iterations: self.iterations, gap: 0.0 },
        })
    }

    /// From a certified set as far on as rounding lets it.
    fn refined(&mut self, mut phi: DVector<f64>, mut lambda: f64, nu: f64, decrement: f64) -> PathEnd {
        let mut left = excess(nu, decrement, lambda);
        let mut next = lambda;
        for _ in 0..=REFINEMENTS {
            let last = self.minimise(phi.clone(), next, AT_REST, REFINING_STEPS);
            // Where it does not get there, the certificate holds where it was.
            if last.ending != Ending::Reached {
                break;
            }
            (phi, lambda, left) = (last.phi, next, excess(nu, last.decrement, next));
            if nu == 0.0 {
                break;
            }
            next *= GROWTH;
        }
        let gap = left / self.objective(&phi).max(INDISTINGUISHABLE);
        let termination = Termination::Optimal { iterations: self.iterations, gap };
        PathEnd { optimum: phi.clone(), phi, lambda, termination }
    }

    /// Of the sets with the base parameters of an optimum the one nearest to the guess.
    fn nearest(mut self, mut end: PathEnd) -> PathEnd {
        let Termination::Optimal { gap, .. } = end.termination else { return end };
        if end.lambda.is_infinite() && self.region.contains(&end.phi) {
            // Around the guess of another size it was another distance.
            return self.exact(&end.phi).unwrap_or(end);
        }
        let beta = self.data.base(&end.optimum);
        let data = self.data.at(&beta);
        let minimum = minimise(end.optimum.clone(), self.region, &data, Prior::None, NEAREST, ON_THE_WAY, STEPS);
        // The optimum itself where rounding on the way would cost more than the gap allows.
        let phi = project(minimum.phi, self.region, &data);
        let rounding = GAP * 0.1 * self.data.chi_squared(&end.optimum);
        if let Some(phi) =
            phi.filter(|phi| self.data.chi_squared(phi) - self.data.chi_squared(&end.optimum) <= rounding)
        {
            end.phi = phi;
        }
        let iterations = self.iterations + minimum.iterations;
        PathEnd { termination: Termination::Optimal { iterations, gap }, ..end }
    }

    fn minimise(&mut self, phi: DVector<f64>, lambda: f64, enough: f64, steps: usize) -> Minimum {
        let weights = self.prior.weights(lambda);
        let minimum = minimise(phi, self.region, self.data, self.prior, weights, enough, steps);
        self.iterations += minimum.iterations;
        minimum
    }

    /// f, with a prior that is zero at the guess.
    fn objective(&self, phi: &DVector<f64>) -> f64 {
        0.5 * self.data.chi_squared(phi) + self.prior.value(self.region, phi)
    }

    fn stopped(&self, minimum: Minimum, lambda: f64) -> PathEnd {
        let (iterations, last_step) = (self.iterations, minimum.decrement);
        let termination = match minimum.ending {
            Ending::Reached | Ending::Stalled => Termination::Stalled { iterations, last_step },
            Ending::StepLimit => Termination::IterationLimit { iterations, last_step },
            Ending::Singular => Termination::Singular { iterations },
        };
        PathEnd { optimum: minimum.phi.clone(), phi: minimum.phi, lambda, termination }
    }
}

/// By how much f of another consistent set can be lower.
fn excess(nu: f64, decrement: f64, lambda: f64) -> f64 {
    if nu == 0.0 {
        return decrement * decrement / lambda;
    }
    let off = decrement * (nu + 2.0 * nu.sqrt()) + 0.5 * decrement * decrement;
    (nu + off) / lambda
}
