//! One family of designs of a study: how they are made, and where they are sought.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::motion_kind::MotionKind;
use super::own_methods::OwnMethods;
use super::plan_error::{StudyPlanError, name};
use crate::excitation::Criterion;
use crate::experiment::Effects;
use crate::trajectory::Family;

/// How the designs of a family are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignMethod {
    /// By the optimiser, from independent starts.
    #[default]
    Optimised,
    /// The best of as many random draws as the optimiser has evaluations.
    Random,
    /// `radkhah2007` Table I, corrected.
    TableOne,
    /// The designs of the family that it continues, once more.
    Repeated,
}

/// Harmonics of every joint, or of each.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(untagged)]
pub enum HarmonicsPlan {
    /// One number for all joints.
    Every(usize),
    /// One number for each joint.
    Each(Vec<usize>),
}

/// Designs of one method and criterion; a criterion is judged by its family, never by one design.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FamilyPlan {
    /// Name in tables and figures.
    pub name: String,
    /// How its designs are made.
    #[serde(rename = "making", alias = "method")]
    pub method: DesignMethod,
    /// What is optimised, or by what the best draw is chosen; absent for a fixed trajectory.
    #[serde(default)]
    pub criterion: Option<String>,
    /// In which family of trajectories; Fourier series where absent.
    #[serde(default)]
    pub family: Option<String>,
    /// Harmonics, where they differ from the experiment's.
    #[serde(default)]
    pub harmonics: Option<HarmonicsPlan>,
    /// Joints that stand still, by name, and where, rad.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub freeze: BTreeMap<String, f64>,
    /// Largest RMS speed of its designs as a part of the speed limits, [`rms_speed`](crate::excitation::rms_speed); unlimited where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_speed: Option<f64>,
    /// An earlier family whose experiment goes before: its information counts, and its estimates too.
    #[serde(default)]
    pub after: Option<String>,
    /// Number of designs, each from a start of its own.
    pub starts: usize,
    /// Evaluations of the criterion that each design may use; a gradient counts as one more.
    #[serde(default)]
    pub evaluations: usize,
    /// Effects that the criterion expects of the arm; [`Effects::expected_by`] where absent.
    #[serde(default, skip_serializing_if = "Effects::is_none")]
    pub expected: Effects,
    /// The kind of motions whose torque its criterion predicts, drawn for the designs alone; random ones, fast and slow, where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predict: Option<MotionKind>,
    /// Runs of each design, where it differs from the study's.
    #[serde(default)]
    pub runs: Option<usize>,
    /// On which of the plan's robots it is made; on all where absent. Empty once the text is read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<String>,
    /// Of how many starts these are the first, where a study ended before all of them: their runs have the random numbers
    /// that they have among all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_starts: Option<usize>,
}

impl FamilyPlan {
    /// The criterion of an optimised or random family: of those from outside, or of the list.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`] where it is absent or unknown.
    pub fn criterion(&self, own: &OwnMethods) -> Result<Arc<dyn Criterion>, StudyPlanError> {
        own.criterion(self.criterion.as_deref().unwrap_or(""))
    }

    /// The effects that its designs expect.
    pub fn expected_effects(&self, criterion: &dyn Criterion) -> Effects {
        if self.expected.is_none() { Effects::expected_by(criterion) } else { self.expected.clone() }
    }

    /// The family of trajectories.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`] where it is unknown.
    pub fn family(&self) -> Result<Family, StudyPlanError> {
        let found = self.family.as_deref().unwrap_or(Family::Fourier.name());
        Family::parse(found).ok_or_else(|| name("design.family", found, Family::ALL.map(Family::name)))
    }
}
