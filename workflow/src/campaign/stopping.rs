//! When a campaign ends.

use armid::estimation::{Estimate, Finding};
use serde::Serialize;

use super::target::Target;

/// Probability with which any of the intervals of a campaign misses.
const CHANCE: f64 = 0.05;

/// Part of that probability below which a p-value is beyond doubt: a campaign looks at several laws and joints after every round.
const SURE: f64 = 0.1;

/// A round that makes the part by the model's errors narrower by no more than to this share of it does not help.
const HELPS: f64 = 0.9;

/// The interval of a quantity after a round.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Width {
    /// The value; of torque its RMS value on the evaluation motions.
    pub value: f64,
    /// Half width of the interval; of torque the upper end of that of its RMS error. A share where the target is one.
    pub half_width: f64,
    /// What is left of that without noise.
    pub by_model_error: f64,
}

impl Width {
    /// Both as shares of the value.
    pub(super) fn relative(self) -> Self {
        let by = self.value.abs();
        Self { half_width: self.half_width / by, by_model_error: self.by_model_error / by, ..self }
    }
}

/// How a campaign stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Another round is to come.
    Unfinished,
    /// All targets are met.
    Reached,
    /// Errors of the model keep a target out of reach.
    ModelError,
    /// The rounds are used up.
    MostRounds,
}

/// What keeps a target out of reach.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Obstacle {
    /// The target.
    pub target: Target,
    /// What is supported most, as a sentence.
    pub effect: String,
    /// What to do about it.
    pub advice: String,
}

/// Probability with which one of the intervals misses, at most.
pub(super) fn chance_of_a_look(most_rounds: usize) -> f64 {
    CHANCE / most_rounds as f64
}

/// Whether a target is out of reach by its widths after every round.
pub(super) fn is_out_of_reach(limit: f64, widths: &[Width]) -> bool {
    let [.., before, last] = widths else { return false };
    // Once may be chance.
    let are_errors_wide = before.by_model_error > limit && last.by_model_error > limit;
    last.half_width > limit && are_errors_wide && last.by_model_error > HELPS * before.by_model_error
}

/// Whether an estimate shows an error of the model, where each interval may miss with this probability: an effect or torque beyond noise
/// that is supported well beyond it, or a residual that is a multiple of the noise. What the robot file declares of its motors counts too. Otherwise their bound is wide for want of data.
pub(super) fn is_model_error_shown(estimate: &Estimate, chance: f64) -> bool {
    let is_declared = estimate.base.iter().any(|parameter| parameter.declared_std > 0.0);
    is_declared
        || estimate.findings.iter().any(|finding| match finding {
            Finding::EffectShown { p_adjusted, .. } | Finding::LackOfFit { p_adjusted, .. } => {
                *p_adjusted < SURE * chance
            }
            Finding::ResidualAboveNoise { .. } => true,
            _ => false,
        })
}

/// How a campaign stands by the widths of every target (limits beside) after each of its rounds, and by whether an error of the model is
/// shown.
pub(super) fn outcome(targets: &[(f64, Vec<Width>)], most_rounds: usize, is_error_shown: bool) -> Outcome {
    let rounds = targets.iter().map(|(_, widths)| widths.len()).min().unwrap_or(0);
    let is_met = |(limit, widths): &(f64, Vec<Width>)| widths.last().is_some_and(|last| last.half_width <= *limit);
    if rounds > 0 && targets.iter().all(is_met) {
        Outcome::Reached
    } else if is_error_shown && targets.iter().any(|(limit, widths)| is_out_of_reach(*limit, widths)) {
        Outcome::ModelError
    } else if rounds >= most_rounds {
        Outcome::MostRounds
    } else {
        Outcome::Unfinished
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widths(all: &[(f64, f64)]) -> Vec<Width> {
        all.iter().map(|&(half_width, by_model_error)| Width { value: 2.0, half_width, by_model_error }).collect()
    }

    #[test]
    fn a_campaign_ends_where_every_target_is_met_or_one_is_out_of_reach() {
        let of = |targets: &[&[(f64, f64)]]| {
            let targets: Vec<_> = targets.iter().map(|all| (1.0, widths(all))).collect();
            assert_ne!(outcome(&targets, 4, false), Outcome::ModelError, "none is shown");
            outcome(&targets, 4, true)
        };
        assert_eq!(of(&[&[]]), Outcome::Unfinished);
        assert_eq!(of(&[&[(3.0, 0.0), (0.9, 0.0)], &[(0.5, 0.2), (0.4, 0.2)]]), Outcome::Reached);
        assert_eq!(of(&[&[(0.9, 0.0)], &[(1.1, 0.0)]]), Outcome::Unfinished);
        // Only what the model's errors leave is too wide, and the last round did not help.
        assert_eq!(of(&[&[(3.0, 1.5), (2.0, 1.4)]]), Outcome::ModelError);
        assert_eq!(of(&[&[(3.0, 1.5), (2.0, 1.2)]]), Outcome::Unfinished, "a tenth narrower");
        assert_eq!(of(&[&[(3.0, 0.9), (2.0, 1.4)]]), Outcome::Unfinished, "once may be chance");
        assert_eq!(of(&[&[(3.0, 1.5)]]), Outcome::Unfinished, "one round shows no change");
        assert_eq!(of(&[&[(f64::INFINITY, 0.0); 4]]), Outcome::MostRounds);
        assert_eq!(chance_of_a_look(10), 0.005);
        assert_eq!(widths(&[(4.0, 1.0)])[0].relative().half_width, 2.0);
    }
}
