//! One optimisation: descents along a growing sharpness, and hops for as long as the budget lasts.
//!
//! ```text
//! x_hop = ½ x_best + ½ x_fresh
//! ```
//! Good trajectories are many, and a descent ends at the nearest. What a converged descent leaves of the budget goes
//! into another one, from halfway between the best trajectory so far and a fresh first guess: inside the linear
//! limits, since they are convex, and with half of what made the best one good.
//!
//! Iterates approach smooth limits from outside, and a small budget may end before one is inside. Where one that is
//! nearly inside promises much, the last evaluation is kept for the nearest point to it that is.

use super::error::ExcitationError;
use super::feasibility::{EXCESS_TOLERANCE, Feasibility};
use super::objective::InformationObjective;
use super::problem::DesignProblem;
use super::termination::{HistoryPoint, Termination};
use super::watched::WatchedProblem;
use crate::optimiser::{Progress, Sequential, SequentialSettings, SmoothLimits, nearest_inside};
use crate::seed::Seed;

/// Sharpnesses p of the smoothed criteria, one after the other.
pub(crate) const SHARPNESS: [f64; 6] = [4.0, 8.0, 16.0, 32.0, 64.0, 128.0];

/// Predicted decrease of the minimised value, a logarithm, that ends a descent.
const TOLERANCE: f64 = 1e-5;

/// Tolerance at a sharpness that another follows.
const STAGE_TOLERANCE: f64 = 1e-4;

/// Evaluations that must be left for another descent.
const HOP_EVALUATIONS: usize = 60;

/// Share of the fresh first guess in the start of another descent.
const HOP_SHARE: f64 = 0.5;

/// An iterate that exceeds the smooth limits by no more than this can be moved into them at little cost.
const NEARLY_INSIDE: f64 = 0.02;

/// What excess costs in the choice among such iterates, in the minimised value.
const EXCESS_WEIGHT: f64 = 50.0;

/// How much better, in the minimised value, an iterate must be to be worth moving.
const WORTH_RESTORING: f64 = 0.25;

/// What an optimisation found.
pub(crate) struct Found {
    /// Variables of the best iterate inside the limits, or of the last one.
    pub(crate) x: Vec<f64>,
    pub(crate) ending: Termination,
    pub(crate) iterations: usize,
    pub(crate) evaluations: usize,
    pub(crate) history: Vec<HistoryPoint>,
}

/// Optimises a problem from the variables of a first guess inside the limits.
pub(crate) fn optimise(
    watched: WatchedProblem<'_>,
    feasibility: &mut Feasibility,
    start: Vec<f64>,
    seed: Seed,
) -> Result<Found, ExcitationError> {
    let problem = watched.problem;
    let mut objective = InformationObjective::of(problem, SHARPNESS[0])?;
    let mut search = Search::begin(watched, feasibility, &mut objective, start);
    // The search ends as its last descent does: where that was cut off, more evaluations might have found more.
    let mut last = search.descend();
    let mut hop = 0;
    while last.is_converged() && search.state.evaluations + HOP_EVALUATIONS <= problem.budget().evaluations {
        search.hop(seed, hop)?;
        hop += 1;
        last = search.descend();
    }
    if search.is_worth_restoring() && search.state.evaluations < problem.budget().evaluations {
        search.restore_nearly_inside();
    }
    Ok(search.found(last))
}

fn settings(problem: &DesignProblem) -> SequentialSettings {
    SequentialSettings { max_evaluations: problem.budget().evaluations, ..SequentialSettings::default() }
}

struct Search<'a> {
    problem: &'a DesignProblem,
    watched: WatchedProblem<'a>,
    feasibility: &'a mut Feasibility,
    objective: &'a mut InformationObjective,
    state: Sequential,
    /// Variables and reported value of the best iterate inside the limits.
    best: Option<(Vec<f64>, f64)>,
    /// Variables and value of the last iterate.
    last: (Vec<f64>, f64),
    /// The minimised value of the best.
    least: f64,
    /// Variables and minimised value, excess added, of the best iterate that is nearly inside the limits.
    nearly: Option<(Vec<f64>, f64)>,
    history: Vec<HistoryPoint>,
}

impl<'a> Search<'a> {
    /// At the first guess, judged.
    fn begin(
        watched: WatchedProblem<'a>,
        feasibility: &'a mut Feasibility,
        objective: &'a mut InformationObjective,
        start: Vec<f64>,
    ) -> Self {
        let problem = watched.problem;
        let state = Sequential::new(start, objective, &mut feasibility.smooth, settings(problem));
        let last = (state.x.clone(), f64::NAN);
        let (best, least, nearly, history) = (None, f64::INFINITY, None, Vec::new());
        let mut search = Self { problem, watched, feasibility, objective, state, best, last, least, nearly, history };
        search.record();
        search
    }

    /// Judges the current iterate by the criterion itself.
    fn record(&mut self) {
        let (exact, excess) = (self.objective.exact, self.state.excess);
        let current = self.problem.objective().criterion.report(exact);
        self.last = (self.state.x.clone(), current);
        if excess <= EXCESS_TOLERANCE && exact < self.least {
            self.least = exact;
            self.best = Some(self.last.clone());
        }
        let weighted = exact + EXCESS_WEIGHT * excess;
        if excess > EXCESS_TOLERANCE
            && excess <= NEARLY_INSIDE
            && self.nearly.as_ref().is_none_or(|nearly| weighted < nearly.1)
        {
            self.nearly = Some((self.state.x.clone(), weighted));
        }
        let value = self.best.as_ref().map_or(current, |best| best.1);
        self.history.push(HistoryPoint { evaluations: self.state.evaluations, value, current, excess });
    }

    /// Whether an iterate outside the limits promises much more than the best one inside.
    fn is_worth_restoring(&self) -> bool {
        self.nearly.as_ref().is_some_and(|nearly| nearly.1 < self.least - WORTH_RESTORING)
    }

    /// Moves the best iterate that is nearly inside the limits into them, and judges it there.
    fn restore_nearly_inside(&mut self) {
        let Some((x, _)) = self.nearly.take() else { return };
        let Feasibility { linear, smooth, .. } = &mut *self.feasibility;
        if let Some(x) = nearest_inside(&x, linear, smooth, EXCESS_TOLERANCE) {
            self.state.excess = smooth.excess(&x);
            self.state.x = x;
            self.objective.exact_at(&self.state.x);
            self.state.evaluations += 1;
            self.record();
        }
    }

    /// Another start, halfway between the best trajectory and a fresh first guess.
    fn hop(&mut self, seed: Seed, index: u64) -> Result<(), ExcitationError> {
        let problem = self.problem;
        let fresh = self.feasibility.bring_inside(problem.start(seed, index)?);
        let fresh = self.feasibility.basis.coefficients(&fresh)?;
        let (best, _) = self.best.as_ref().unwrap_or(&self.last);
        let x = best.iter().zip(&fresh).map(|(best, fresh)| best + HOP_SHARE * (fresh - best)).collect();
        self.objective.criterion = problem.objective().smoothed(SHARPNESS[0]);
        let (evaluations, iterations) = (self.state.evaluations, self.state.iterations);
        self.state = Sequential::new(x, self.objective, &mut self.feasibility.smooth, settings(problem));
        // The limit is on all descents together.
        self.state.evaluations += evaluations;
        self.state.iterations += iterations;
        self.record();
        Ok(())
    }

    /// One descent, sharper and sharper.
    fn descend(&mut self) -> Termination {
        let wanted = self.problem.objective();
        let has_kinks = wanted.criterion.smoothed(SHARPNESS[0]).is_some();
        let stages: &[f64] = if has_kinks { &SHARPNESS } else { &SHARPNESS[..1] };
        let budget = self.problem.budget().evaluations;
        let first = self.state.evaluations;
        let mut ending = Termination::Converged;
        for (stage, &sharpness) in stages.iter().enumerate() {
            if stage > 0 {
                if self.state.evaluations + 2 > budget {
                    return Termination::EvaluationBudget;
                }
                self.objective.criterion = wanted.smoothed(sharpness);
                self.state.restart(self.objective, &mut self.feasibility.smooth);
            }
            self.state.settings.tolerance = if stage + 1 < stages.len() { STAGE_TOLERANCE } else { TOLERANCE };
            // Equal shares of what was left, so that the sharpest gets its turn even if none converges.
            let share = first + budget.saturating_sub(first) * (stage + 1) / stages.len();
            loop {
                if !self.watched.goes_on(self.state.evaluations) {
                    return Termination::Interrupted;
                }
                if self.state.iterations >= self.problem.budget().iterations {
                    return Termination::IterationBudget;
                }
                self.state.settings.max_evaluations = budget - usize::from(self.is_worth_restoring());
                let Feasibility { linear, smooth, .. } = &mut *self.feasibility;
                ending = match self.state.step(self.objective, linear, smooth) {
                    Progress::Moved => {
                        self.record();
                        if self.state.evaluations >= share && stage + 1 < stages.len() {
                            break;
                        }
                        continue;
                    }
                    Progress::Stationary => Termination::Converged,
                    Progress::Stalled => Termination::Stalled,
                    Progress::OutOfBudget => return Termination::EvaluationBudget,
                };
                break;
            }
        }
        ending
    }

    fn found(self, ending: Termination) -> Found {
        let (x, value) = self.best.unwrap_or(self.last);
        let ending = if value.is_finite() { ending } else { Termination::Singular };
        Found {
            x,
            ending,
            iterations: self.state.iterations,
            evaluations: self.state.evaluations,
            history: self.history,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{CriterionKind, DesignLimits};
    use crate::model::Columns;

    #[test]
    fn analytic_of_iterates_nearly_inside_the_most_promising_is_moved_at_the_cost_of_one_evaluation() {
        let (robot, limits) = (chains::crs_a460(), DesignLimits::motion());
        let problem = DesignProblem::new(robot, Columns::RIGID, CriterionKind::DOptimal, limits).unwrap();
        let mut feasibility = Feasibility::new(&problem);
        let start = feasibility.first_guess(&problem, Seed::new(7), 0).unwrap();
        let start = feasibility.basis.coefficients(&start).unwrap();
        let mut objective = InformationObjective::of(&problem, SHARPNESS[0]).unwrap();
        let mut search = Search::begin((&problem).into(), &mut feasibility, &mut objective, start);
        let inside = search.least;
        // At equal value the least excess counts; beyond the bound none does.
        for excess in [0.012, 0.004, 0.008, 0.021] {
            search.state.excess = excess;
            search.record();
        }
        let (_, weighted) = search.nearly.as_ref().unwrap();
        assert!((weighted - (inside + 50.0 * 0.004)).abs() < 1e-12, "{weighted} {inside}");
        // Worth it from 0.2 + 0.25 below the best inside.
        for (lead, is_worth) in [(0.44, false), (0.46, true)] {
            search.least = inside + lead;
            assert_eq!(search.is_worth_restoring(), is_worth, "{lead}");
        }
        let before = search.state.evaluations;
        search.restore_nearly_inside();
        let last = search.history.last().unwrap();
        assert_eq!((last.evaluations, search.state.evaluations), (before + 1, before + 1));
        assert!(last.excess <= EXCESS_TOLERANCE && search.least == inside, "{last:?}");
    }
}
