//! The motion of the next round.

use std::sync::Arc;

use armid::estimation::{Estimate, Finding};
use armid::excitation::criterion::LinearOptimal;
use armid::excitation::{Criterion, CriterionKind, LimitSettings};
use armid::experiment::{EffectKind, Effects};
use armid::model::Columns;
use armid::observer::Observer;
use armid_io::output::write_text;
use armid_io::{Error, LoadedRobot, Text};

use super::aim::Aim;
use super::folder::Round;
use super::settings::CampaignSettings;
use super::target::Quantity;
use crate::design::{DesignGoal, DesignSettings, design};

/// What a motion is designed for.
pub(super) struct Motion<'a> {
    pub(super) settings: &'a CampaignSettings,
    pub(super) columns: Columns,
    pub(super) loaded: &'a LoadedRobot,
    /// The targets that are not met.
    pub(super) aims: Vec<&'a Aim>,
    /// The rounds before, with the estimate by all of them.
    pub(super) before: Option<(&'a [Round], &'a Estimate)>,
}

impl Motion<'_> {
    /// Writes the motion of a round; `false` where the observer ended the search. Motions are designed for what all rounds before have
    /// not shown; the first, of which nothing is known, is D-optimal.
    ///
    /// # Errors
    /// [`Error`] where no motion is found within the limits of the arm.
    pub(super) fn write(&self, round: &Round, observer: &dyn Observer) -> Result<bool, Error> {
        let last = self.before.and_then(|(rounds, _)| rounds.last());
        if let Some(last) = last.filter(|_| self.settings.repeats) {
            write_text(&round.trajectory(), &Text::read(&last.trajectory())?.content)?;
            return Ok(true);
        }
        let Some(found) = design(self.loaded, &self.design(round), observer)? else { return Ok(false) };
        match last {
            _ if found.interrupted => return Ok(false),
            // The search began at the motion of the last round.
            Some(last) if !found.is_feasible() => {
                write_text(&round.trajectory(), &Text::read(&last.trajectory())?.content)?;
            }
            None if !found.is_feasible() => {
                let message = format!("no motion of \"{}\" was found within its limits", self.loaded.robot.name());
                return Err(Error::new(message).help("a longer period leaves more room, as do more evaluations"));
            }
            _ => write_text(&round.trajectory(), &found.toml())?,
        }
        Ok(true)
    }

    fn design(&self, round: &Round) -> DesignSettings {
        let settings = self.settings;
        let (criterion, expected) = self.criterion();
        let goal = settings.load.map_or(DesignGoal::Arm(criterion), DesignGoal::Load);
        let rounds = self.before.map_or(&[][..], |(rounds, _)| rounds);
        DesignSettings {
            columns: self.columns,
            period_s: settings.period_s,
            harmonics: vec![settings.harmonics],
            seed: settings.seed.wrapping_add(round.number as u64),
            starts: settings.starts,
            from: rounds.last().map(|last| last.trajectory().display().to_string()).into_iter().collect(),
            evaluations: settings.evaluations,
            limits: LimitSettings { ramp_s: Some(settings.ramp_s()), ..LimitSettings::default() },
            weighted: rounds.is_empty() && settings.load.is_none() && self.states_noise(),
            prior: rounds.iter().map(Round::estimate).collect(),
            expected,
            periods: settings.periods(),
            baseline: false,
            ..DesignSettings::new(goal)
        }
    }

    /// Does the robot file state the noise of every current sensor?
    fn states_noise(&self) -> bool {
        self.loaded.robot.joints().iter().all(|joint| joint.drive.current_noise > 0.0)
    }

    /// The criterion, and effects that it expects.
    fn criterion(&self) -> (Arc<dyn Criterion>, Effects) {
        let Some((_, pooled)) = self.before else { return (CriterionKind::DOptimal.into(), Effects::none()) };
        let of_torque = self.aims.iter().any(|aim| aim.target.quantity == Quantity::Torque);
        let shown = shown_effects(pooled);
        if of_torque && !shown.is_none() && self.states_noise() && self.loaded.guess().is_some() {
            return (CriterionKind::MeasuredTorque.into(), shown);
        }
        let forms = self.aims.iter().filter_map(|aim| aim.form(pooled));
        match forms.reduce(|sum, form| sum + form) {
            Some(form) if form.iter().all(|entry| entry.is_finite()) => {
                (Arc::new(LinearOptimal::new(form)), Effects::none())
            }
            _ => (CriterionKind::DOptimal.into(), Effects::none()),
        }
    }
}

/// The effects that an estimate shows, with their sizes, as far as a design can expect them.
fn shown_effects(estimate: &Estimate) -> Effects {
    estimate.findings.iter().fold(Effects::none(), |all, finding| match finding {
        Finding::EffectShown { effect, size, .. } => match EffectKind::parse(effect) {
            Some(kind) if Effects::EXPECTABLE.contains(&kind) && *size > 0.0 => {
                all.with_effect(kind, size.min(kind.entry().most))
            }
            _ => all,
        },
        _ => all,
    })
}
