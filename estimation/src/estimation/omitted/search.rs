//! Which laws the samples of an observation show, and how large they may be.

use std::ops::Range;

use nalgebra::DMatrix;

use super::evidence::Evidence;
use super::laws::{self, Law};
use super::scales::moments;
use super::torque::OmittedTorque;
use crate::estimation::effect_size::EffectSize;
use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::finding::Finding;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::motion::motion_noise;
use crate::model::Robot;
use crate::signal::Samples;

/// What the samples of an observation show; `None` where the torque has no noise to compare with, or a motion shows no law.
///
/// # Errors
/// [`EstimationError`] where the weighted equations have no answer.
pub(in crate::estimation) fn omitted_torque(
    robot: &Robot,
    equations: &Factorisation<'_>,
    samples: &Samples,
) -> Result<Option<OmittedTorque>, EstimationError> {
    let observation = equations.observation();
    if samples.is_noise_free() || samples.blocks() != observation.samples() {
        return Ok(None);
    }
    let linear = LinearFit::weighted(equations)?;
    let laws = laws::omitted(robot, observation, samples, linear.fit.solution())?;
    let columns: Vec<_> = laws.iter().flat_map(|law| law.columns.column_iter()).collect();
    let columns = DMatrix::from_columns(&columns);
    let mut first = 0;
    let groups: Vec<Range<usize>> = laws
        .iter()
        .map(|law| {
            let group = first..first + law.columns.ncols();
            first = group.end;
            group
        })
        .collect();
    let motion = motion_noise(robot, observation, samples, linear.fit.solution());
    let Some(evidence) = Evidence::new(observation, &linear, &columns, motion.as_ref())? else { return Ok(None) };
    let Some((mean, second_moment)) = moments(&evidence, &groups) else { return Ok(None) };
    let supported = evidence.supported(&groups);
    let size = |(group, Law { effect, level, unit, .. }): (usize, &Law)| {
        let square: f64 = groups[group].clone().map(|c| second_moment[(c, c)]).sum();
        EffectSize {
            effect: effect.name().to_owned(),
            size: level * (square / groups[group].len() as f64).sqrt(),
            unit: (*unit).to_owned(),
            shown: supported.iter().any(|(of, _)| *of == group),
        }
    };
    let sizes: Vec<EffectSize> = laws.iter().enumerate().map(size).collect();
    let finding = |&(group, p_adjusted): &(usize, f64)| {
        let EffectSize { effect, size, unit, .. } = sizes[group].clone();
        Finding::EffectShown { effect, size, unit, p_adjusted }
    };
    let findings = supported.iter().map(finding).collect();
    let places: Vec<usize> = supported.iter().flat_map(|&(group, _)| groups[group].clone()).collect();
    Ok(Some(OmittedTorque { columns, mean, second_moment, supported: places, motion, sizes, findings }))
}
