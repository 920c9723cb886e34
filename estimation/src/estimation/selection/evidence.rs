//! What the data say of a term.

use serde::{Deserialize, Serialize};

use super::beyond_motion::BeyondMotion;

/// Whether the data decide for a term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// By every criterion: it is in the selected set.
    Supported,
    /// The criteria disagree (the interval of the held-out change holds zero, say), or one of them could not be asked: it is left out.
    Undecided,
    /// The F-test does not distinguish its coefficients from zero: it is left out.
    NotSupported,
    /// The motion does not distinguish it from the other columns: it is left out.
    #[default]
    NotExcited,
}

/// On what the torque was predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOutData {
    /// Samples that were no part of any fit.
    Recording,
    /// Each fifth of the recording in turn, by a fit to the other four.
    Folds,
}

/// Error of predicted torque with a term, relative to that without: RMS over all joints, each joint's in units of its noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutChange {
    /// On what.
    pub data: HeldOutData,
    /// RMS without the term, in standard deviations of the noise.
    pub without: f64,
    /// RMS with it.
    pub with: f64,
    /// 95 % interval of the change of the squared error over the squared error without the term, for this motion.
    pub change_ci95: [f64; 2],
}

impl HeldOutChange {
    /// Whether the error falls, by its 95 % interval.
    pub fn is_improvement(&self) -> bool {
        self.change_ci95[1] < 0.0
    }
}

/// The evidence for one term, when it was left out or in the selected set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TermEvidence {
    /// Its word in `--columns`.
    pub term: String,
    /// What the data decide.
    pub verdict: Verdict,
    /// Coefficients r that it alone determines.
    pub coefficients: usize,
    /// F, and its degrees of freedom; `None` where the term was not tested.
    pub f: Option<FTest>,
    /// Akaike's criterion with the term less that without: negative for it.
    pub aic: Option<f64>,
    /// Schwarz's criterion with the term less that without: negative for it.
    pub bic: Option<f64>,
    /// Torque that was not fitted; `None` where a part of the recording does not determine the parameters.
    pub held_out: Option<HeldOutChange>,
    /// Coefficients that cannot be below zero and are by more than three standard deviations: it is not supported then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub negative: Vec<String>,
    /// Terms that could stand for it, or for which it could: the data do not decide between them and this one.
    #[serde(default)]
    pub alike: Vec<String>,
}

impl TermEvidence {
    /// A term that the motion does not show.
    pub(in crate::estimation) fn untested(word: &str) -> Self {
        Self { term: word.to_owned(), ..Self::default() }
    }
}

/// The test of all coefficients of a term together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FTest {
    /// F.
    pub value: f64,
    /// Its degrees of freedom; the second is infinite (`null`) where the noise is known.
    #[serde(with = "freedom")]
    pub freedom: [f64; 2],
    /// Probability of an F as large where all its coefficients are zero.
    pub p_value: f64,
}

/// What a recording decides of a list of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// The selected columns, as `--columns` reads them.
    pub columns: String,
    /// Probability below which the F-test supports a term: 5 % over the number of candidates.
    pub level: f64,
    /// N_e.
    pub effective_equations: f64,
    /// Equations of the recording.
    pub equations: usize,
    /// Every candidate, in the order of the list of terms.
    pub terms: Vec<TermEvidence>,
    /// Coefficients of supported terms that depend on more than the motion, which are no columns.
    #[serde(default)]
    pub beyond_motion: Vec<BeyondMotion>,
    /// Base parameters of the selected set estimated together with each of those terms, which is named with them.
    #[serde(default)]
    pub parameters_beside: Vec<BeyondMotion>,
}

/// JSON has no infinite number.
mod freedom {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
        value.map(|x| x.is_finite().then_some(x)).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
        <[Option<f64>; 2]>::deserialize(deserializer).map(|value| value.map(|x| x.unwrap_or(f64::INFINITY)))
    }
}
