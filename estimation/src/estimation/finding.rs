//! Findings about an estimate: what limits its use, with the number measured and advice. Their sentences are written as those of errors are.

use super::residual_shape::{Against, probability};
use super::termination::Termination;
use crate::number::significant;

/// Something that does not stop an estimator and must not be overlooked; carries the number that was measured.
///
/// ```
/// # use armid_estimation as armid;
/// use armid::estimation::Finding;
/// let finding = Finding::FewPeriods { periods: 2 };
/// assert!(finding.to_string().contains("2 periods"));
/// assert!(finding.advice().contains("rough"));
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Finding {
    /// A parameter whose standard deviation is more than a third of its value: its sign is in doubt at three sigma.
    #[error("{parameter} = {} ± {} {unit} (standard deviation)", three(*value), three(*std))]
    PoorlyDetermined {
        /// Name of the base parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// Its standard deviation.
        std: f64,
        /// Unit of both.
        unit: String,
    },
    /// The condition number of the equations with columns of unit length is large.
    #[error("the column-normalised condition number is {condition_scaled:.0}")]
    LargeCondition {
        /// The condition number with columns of unit length.
        condition_scaled: f64,
    },
    /// The residual of a joint is much larger than the noise that scattered over periods.
    #[error(
        "joint {joint}: the residual, {} {unit} RMS, is {ratio:.1} times that of noise alone ({} {unit})",
        three(*residual_rms), three(*expected_rms)
    )]
    ResidualAboveNoise {
        /// Joint, from one.
        joint: usize,
        /// RMS residual.
        residual_rms: f64,
        /// RMS residual expected of noise alone.
        expected_rms: f64,
        /// Their ratio.
        ratio: f64,
        /// Unit of both.
        unit: String,
    },
    /// A joint's own equations leave more torque than noise explains, whatever the parameters of the other joints: at 5 % over
    /// all joints, by an F test against the scatter over periods and one of each group of functions.
    #[error(
        "joint {joint}: neither model nor noise explains {} {unit} RMS ({} % of the joint's torque; noise {} {unit}; {}){}",
        three(*beyond_noise_rms), three(100.0 * beyond_noise_rms / torque_rms), three(*noise_rms), probability(*p_adjusted),
        most.as_ref().map_or_else(String::new, |most| most.words(unit))
    )]
    LackOfFit {
        /// Joint, from one.
        joint: usize,
        /// RMS of what is left beyond noise, means over blocks of a 360th of the record.
        beyond_noise_rms: f64,
        /// RMS of the noise of such a mean.
        noise_rms: f64,
        /// RMS of the joint's torque.
        torque_rms: f64,
        /// p-value, adjusted over all tests and joints.
        p_adjusted: f64,
        /// Where most of it is.
        most: Option<MisfitPart>,
        /// Unit of the RMS values.
        unit: String,
    },
    /// The log supports a law that the model omits: at 5 % over all laws, by an F test beside those that it supports more.
    #[error(
        "the log shows {}, which the model omits: about {} ({})",
        effect.replace('-', " "), size_in(*size, unit), probability(*p_adjusted)
    )]
    EffectShown {
        /// Name of the effect.
        effect: String,
        /// RMS of its size over the drives, with what noise leaves open.
        size: f64,
        /// Unit of the size; empty for a share.
        unit: String,
        /// p-value, adjusted over all laws.
        p_adjusted: f64,
    },
    /// Neighbouring residuals of a joint are more correlated than the noise.
    #[error("joint {joint}: neighbouring residuals correlate by {correlation:.2}, the noise by {expected:.2}")]
    ResidualCorrelated {
        /// Joint, from one.
        joint: usize,
        /// Correlation of the residual with the one before.
        correlation: f64,
        /// Correlation of the noise with the one before.
        expected: f64,
    },
    /// Few periods were repeated, so that the noise is poorly known.
    #[error("{periods} periods are too few to estimate the noise")]
    FewPeriods {
        /// Recorded periods.
        periods: usize,
    },
    /// The log has no noise, as that of a rehearsal, so that nothing can be compared with it.
    #[error("this log has no noise; findings that compare with noise do not apply")]
    NoNoise,
    /// Nothing was repeated: the noise was taken from the residual, and model errors with it.
    #[error("the noise is estimated from the residual, so it includes model error")]
    NoiseFromResidual,
    /// Columns that no torque sensor distinguishes from the others were left out of the base.
    #[error(
        "{} left out of the base: the columns differ from the others by less than {tolerance:.0e}", parameters.join(", ")
    )]
    NearlyDependent {
        /// Names of the parameters that structure alone would keep.
        parameters: Vec<String>,
        /// The fraction of the others' columns by which theirs differ at most.
        tolerance: f64,
    },
    /// The completed standard parameters of a link are physically inconsistent.
    #[error(
        "link {link} is physically inconsistent: its pseudo-inertia has the eigenvalue {}", three(*eigenvalue)
    )]
    InconsistentLink {
        /// Link, from one.
        link: usize,
        /// Smallest eigenvalue of its pseudo-inertia.
        eigenvalue: f64,
    },
    /// Equations of a joint that a robust estimator hardly counts or not at all.
    #[error(
        "joint {joint}: {outliers} of {equations} equations are beyond 5 robust standard deviations of {} {unit}", three(*scale)
    )]
    Outliers {
        /// Joint, from one.
        joint: usize,
        /// How many.
        outliers: usize,
        /// Equations of the joint.
        equations: usize,
        /// Robust standard deviation of its residual; outliers are beyond five of them.
        scale: f64,
        /// Its unit.
        unit: String,
    },
    /// A base parameter that was left out because the data do not tell it from zero.
    #[error(
        "{parameter} is set to zero: its estimate, {} ± {} {unit}, is not significantly different from zero",
        three(*value), three(*std)
    )]
    LeftOut {
        /// Its name.
        parameter: String,
        /// Its value where it is not left out.
        value: f64,
        /// The standard deviation of that.
        std: f64,
        /// Unit of both.
        unit: String,
    },
    /// No noise of positions is known, and an estimator that would use it did without.
    #[error("the noise of positions is unknown: the motion is assumed exact, as in weighted least squares")]
    MotionTakenAsExact,
    /// Physical consistency, or a prior, holds the estimate away from what the equations alone say.
    #[error(
        "the constraint moves the estimate away from the data: χ² = {}, and noise alone stays below {} (95 %)",
        three(*chi_squared), three(*limit)
    )]
    HeldBack {
        /// The distance from the unconstrained estimate, `(β̂ − β)ᵀ C⁻¹ (β̂ − β)`.
        chi_squared: f64,
        /// What it exceeds by chance with a probability of 5 %.
        limit: f64,
    },
    /// The nominal body of a link reaches beyond the link's shape, which then bounds nothing.
    #[error("the nominal body of link {link} reaches beyond its shape, which does not bound the estimate")]
    BeyondShape {
        /// Link, from one.
        link: usize,
    },
    /// Whether errors of the measured motion bias weighted least squares.
    #[error(
        "Durbin–Wu–Hausman: {statistic:.1} of {freedom} degrees of freedom, 95 % limit {limit:.1}: {}",
        of_motion(statistic > limit, *largest_change)
    )]
    DurbinWuHausman {
        /// What was measured of them.
        statistic: f64,
        /// What is exceeded by chance in one of twenty cases without such a bias.
        limit: f64,
        /// Its degrees of freedom.
        freedom: usize,
        /// Largest change of a parameter by the instruments, over its standard deviation; not known of estimates of earlier versions.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        largest_change: Option<f64>,
    },
    /// Combinations of parameters that the motion of a closed loop does not show.
    #[error(
        "positions alone do not determine {combinations} combinations of {} under this servo{}", parameters.join(", "),
        if *nominal { "; they keep nominal values, because an arm with those of `wls` cannot be simulated" } else { "" }
    )]
    HiddenFromPositions {
        /// How many.
        combinations: usize,
        /// Parameters that they move.
        parameters: Vec<String>,
        /// Whether they keep nominal values, since an arm with those of weighted least squares could not be simulated.
        nominal: bool,
    },
    /// The search began by multiple shooting, since the motion of weighted least squares, or of the nominal set, runs away.
    #[error(
        "the search began by multiple shooting over {intervals} intervals, whose gaps it closed to {gap:.0e} of the motion"
    )]
    MultipleShooting {
        /// Intervals of the motion.
        intervals: usize,
        /// Largest gap between two of them at its end, over the spread of that number along the motion.
        gap: f64,
    },
    /// The iteration did not come to its result: the values are those of its last step.
    #[error("the search {termination}")]
    Unfinished {
        /// How it ended.
        termination: Termination,
    },
    /// A drive parameter that cannot be negative is.
    #[error("{parameter} = {} is negative", three(*value))]
    NegativeDrive {
        /// Its name.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// Coefficients that no arm has: errors of the model, whose intervals are withheld.
    #[error(
        "{} below zero by more than 3 standard deviations, which no arm has: the model is wrong there, and their intervals \
         are withheld",
        parameters.join(", ")
    )]
    Impossible {
        /// Names of the base parameters.
        parameters: Vec<String>,
    },
}

/// The fifth of a record, by size of a joint's speed or load, in which its fit is worst.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MisfitPart {
    /// Speed or load, whichever the misfit is less even over.
    pub against: Against,
    /// From and to, of its size.
    pub range: [f64; 2],
    /// Unit of the range.
    pub range_unit: String,
    /// RMS of what is left beyond noise there, in the unit of the finding.
    pub rms: f64,
}

impl Finding {
    /// Whether it is a comparison with noise, which says nothing where there is none.
    pub const fn compares_with_noise(&self) -> bool {
        matches!(
            self,
            Self::ResidualAboveNoise { .. }
                | Self::LackOfFit { .. }
                | Self::EffectShown { .. }
                | Self::ResidualCorrelated { .. }
                | Self::FewPeriods { .. }
                | Self::NoiseFromResidual
                | Self::MotionTakenAsExact
                | Self::DurbinWuHausman { .. }
        )
    }

    /// Advice.
    pub const fn advice(&self) -> &'static str {
        match self {
            Self::PoorlyDetermined { .. } => "do not interpret them one by one; predicted torque depends on their sums",
            Self::LargeCondition { .. } => {
                "the motion excites the parameters unevenly: trust predicted torque, not single parameters"
            }
            Self::ResidualAboveNoise { .. } => {
                "the model has an error: friction law, torque constant, elasticity, or too narrow a filter; the intervals \
                 include what the residual shows of it"
            }
            Self::LackOfFit { .. } => {
                "look for a missing term in the residual figures of the report; thousandths of the torque may be encoder \
                 counts, which repeat with the motion. The intervals include what the residual shows of it"
            }
            Self::EffectShown { .. } => {
                "the intervals include it; identify with selected terms to estimate it, if it is one of them"
            }
            Self::ResidualCorrelated { .. } => "look for a missing term in the residual over time and over velocity",
            Self::FewPeriods { .. } => "take the intervals as rough",
            Self::NoNoise => "judge the estimate by its held-out torque",
            Self::NoiseFromResidual => "the intervals include what the residual shows of both",
            Self::NearlyDependent { .. } => {
                "check the geometry: axes that should be parallel, perpendicular or meet may be off by a rounding of the file"
            }
            Self::Outliers { .. } => "look at these instants: a collision, a slip of the clock, or a missing term",
            Self::LeftOut { .. } => "its interval comes from the full model",
            Self::MotionTakenAsExact => "compare with `wls`, which also assumes an exact motion",
            Self::HeldBack { .. } => {
                "above the limit, data and constraint contradict each other: look for a missing term"
            }
            Self::BeyondShape { .. } => {
                "make the shape in the robot file hold the whole link, or correct its nominal body"
            }
            Self::DurbinWuHausman { statistic, limit, largest_change: Some(change), .. }
                if *statistic > *limit && *change < 1.0 =>
            {
                "use `wls`: its bias is below the standard deviation of every parameter"
            }
            Self::DurbinWuHausman { statistic, limit, .. } if *statistic > *limit => {
                "use instruments, unless the model has an error: compare with `wls`"
            }
            Self::DurbinWuHausman { .. } => "use `wls`, which has the shorter intervals",
            Self::HiddenFromPositions { nominal: false, .. } => {
                "their values and intervals are those of `wls`, from measured torque"
            }
            Self::HiddenFromPositions { nominal: true, .. } => {
                "do not use their values, nor their intervals, whose widths alone are those of `wls`: look for what makes an arm \
                 with the parameters of `wls` run away, a sign or a unit first"
            }
            Self::Unfinished { .. } => {
                "do not use these values: take another estimator, or leave out terms that the data hardly show"
            }
            Self::MultipleShooting { .. } => {
                "the estimate is that of the whole motion all the same; an arm with the parameters of `wls` runs away: look for a \
                 sign, a unit or a torque constant first"
            }
            Self::Impossible { .. } => "identify with selected terms, to find the missing one",
            Self::InconsistentLink { .. } | Self::NegativeDrive { .. } => {
                "simulate with an exported file: its bodies and drives are fitted so that they are possible"
            }
        }
    }
}

impl MisfitPart {
    /// Where it is; `unit` is that of the finding.
    fn words(&self, unit: &str) -> String {
        let Self { against, range: [from, to], range_unit, rms } = self;
        let (variable, rms) = (against.name(), three(*rms));
        format!("; largest at a {variable} of {from:.3} to {to:.3} {range_unit}: {rms} {unit}")
    }
}

/// A size in its unit, or a share in per cent.
fn size_in(size: f64, unit: &str) -> String {
    if unit.is_empty() { format!("{} %", three(100.0 * size)) } else { format!("{} {unit}", three(size)) }
}

/// What errors of the motion do to weighted least squares.
fn of_motion(is_biased: bool, largest_change: Option<f64>) -> String {
    let what = if is_biased { "bias" } else { "do not detectably bias" };
    let moved = |change| format!("; instruments move no parameter by more than {change:.2} standard deviations");
    format!("errors of the motion {what} weighted least squares{}", largest_change.map_or_else(String::new, moved))
}

/// With three significant digits.
fn three(value: f64) -> String {
    significant(value, 3)
}
