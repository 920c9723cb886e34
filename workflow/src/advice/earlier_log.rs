//! What an earlier log of an arm shows of it: its noise, and effects that its model omits.

use armid::estimation::EffectSize;
use armid::experiment::EffectKind;
use armid::model::DriveKind;
use armid::number::significant;
use armid::study::effects_of;

use crate::identification::IdentifyAnswer;

/// What an earlier log shows.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlierLog {
    /// Name of the log.
    pub name: String,
    /// Standard deviation of one sample of each joint's torque, n, N·m (N); `None` where no period repeats.
    pub noise: Option<Vec<f64>>,
    /// Effects that it was tested for.
    pub effects: Vec<EffectSize>,
}

impl EarlierLog {
    /// What an identification by a log found. Nothing of one without an estimate.
    pub fn new(answer: &IdentifyAnswer) -> Self {
        let covariance = answer.log.samples.torque_covariance.as_ref();
        let noise = covariance.map(|covariance| covariance.diagonal().iter().map(|of| of.sqrt()).collect::<Vec<f64>>());
        Self {
            name: answer.log.name(),
            noise: noise.filter(|noise| noise.iter().all(|of| *of > 0.0)),
            effects: answer.estimates.first().map_or_else(Vec::new, |first| first.estimate.effects.clone()),
        }
    }

    /// The sizes of effects, each in its own unit: of those that it supports, and of those that such drives may have and it bounds. Where
    /// its size is of another kind, the realistic one.
    pub fn shown(&self, drive: DriveKind) -> Vec<(EffectKind, f64)> {
        let size = |of: &EffectSize| {
            let kind = EffectKind::parse(&of.effect)?;
            let entry = kind.entry();
            match (of.unit == entry.unit, of.shown) {
                (true, shown) if shown || effects_of(drive).contains(&kind) => Some((kind, of.size.min(entry.most))),
                (false, true) => Some((kind, entry.realistic)),
                _ => None,
            }
        };
        self.effects.iter().filter_map(size).filter(|(_, size)| *size > 0.0).collect()
    }

    /// What was taken from it, a sentence each.
    pub fn sentences(&self, drive: DriveKind) -> Vec<String> {
        let noise = match &self.noise {
            Some(noise) => {
                let each: Vec<String> = noise.iter().map(|of| significant(*of, 3)).collect();
                format!("torque noise of {} N·m (N for a prismatic joint)", each.join(", "))
            }
            None => "no noise, since no period repeats in it".to_owned(),
        };
        let effect = |(kind, size): (EffectKind, f64)| {
            let is_shown = self.effects.iter().any(|of| of.effect == kind.name() && of.shown);
            let why = if is_shown { "which it shows" } else { "which is what its noise leaves open" };
            let unit = kind.entry().unit;
            format!(
                "{} of {}{}{unit}, {why}",
                kind.name(),
                significant(size, 3),
                if unit.is_empty() { "" } else { " " }
            )
        };
        std::iter::once(noise).chain(self.shown(drive).into_iter().map(effect)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_taken_of_what_the_log_supports_and_of_what_it_bounds_among_the_effects_of_the_drive() {
        let of = |effect: EffectKind, size: f64, shown: bool| EffectSize {
            effect: effect.name().to_owned(),
            size,
            unit: effect.entry().unit.to_owned(),
            shown,
        };
        let presliding = EffectSize { unit: String::new(), ..of(EffectKind::Presliding, 0.2, true) };
        let log = EarlierLog {
            name: "log".to_owned(),
            noise: None,
            effects: vec![
                of(EffectKind::LoadFriction, 0.04, true),
                of(EffectKind::CurrentLag, 0.2, false),
                of(EffectKind::Elasticity, 900.0, false),
                presliding,
            ],
        };
        // The lag is no effect of such drives; a wind-up of 900 mrad is beyond the law; a share of friction is no distance.
        let expected = vec![
            (EffectKind::LoadFriction, 0.04),
            (EffectKind::Elasticity, EffectKind::Elasticity.entry().most),
            (EffectKind::Presliding, EffectKind::Presliding.entry().realistic),
        ];
        assert_eq!(log.shown(DriveKind::Harmonic), expected);
        assert_eq!(log.sentences(DriveKind::Harmonic)[1], "load-friction of 0.04, which it shows");
    }
}
