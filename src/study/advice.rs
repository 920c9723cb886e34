//! Plans of studies that choose design, duration and estimator for an arm before it moves.

use super::metric::Metric;
use super::plan::StudyPlan;
use crate::experiment::EffectKind;
use crate::model::DriveKind;
use crate::model::format::FormatError;
use crate::model::term::{LOAD_FRICTION, STRIBECK, Term};

/// The effects that an arm with such drives may have and a model omit.
pub const fn effects_of(drive: DriveKind) -> &'static [EffectKind] {
    use EffectKind as E;
    match drive {
        DriveKind::Harmonic => &[E::LoadFriction, E::Elasticity, E::Hysteresis, E::TorqueRipple, E::Warming],
        DriveKind::Planetary => &[E::LoadFriction, E::Backlash, E::Stribeck, E::Warming],
        DriveKind::Belt => &[E::Elasticity, E::Hysteresis, E::Stribeck],
        DriveKind::Direct => &[E::Cogging, E::TorqueRipple, E::TorqueConstant, E::CurrentLag],
        DriveKind::Servo => &[E::LoadFriction, E::Backlash, E::Stribeck, E::CurrentLag],
    }
}

/// Columns that every candidate has.
const COLUMNS: &str = "rigid+rotor+friction";

/// The term that a model can have for an effect.
const fn term_of(effect: EffectKind) -> Option<Term> {
    match effect {
        EffectKind::LoadFriction => Some(LOAD_FRICTION),
        EffectKind::Stribeck => Some(STRIBECK),
        _ => None,
    }
}

/// What a model is for: the error that decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// Measured torque on fast random motions.
    Torque,
    /// Torque of an arm without its effects, as a simulator has it, on fast random motions.
    Simulation,
    /// Measured torque on moves from point to point.
    PointToPoint,
    /// Measured torque on random motions at 30 % of their speed.
    Slow,
    /// The parameters themselves, in reference units.
    Parameters,
    /// Those of friction and offsets, in reference units.
    Friction,
    /// Those of a load on the last link: what errors of the parameters look like there, in reference units.
    Payload,
}

crate::input::named! { Purpose {
    Torque: "torque", Simulation: "simulation", PointToPoint: "point-to-point", Slow: "slow", Parameters: "parameters",
    Friction: "friction", Payload: "payload"
} }

impl Purpose {
    /// The metric by which arms without effects show what noise does: torque on the same kind of motion, as the parameters give it.
    pub const fn noise_metric(self) -> Metric {
        match self {
            Self::Torque | Self::Simulation => Metric::Prediction,
            Self::PointToPoint => Metric::PointToPoint,
            Self::Slow => Metric::Slow,
            Self::Parameters | Self::Friction | Self::Payload => Metric::Reference,
        }
    }

    /// The metric that decides; of friction and a payload, the parameters that are theirs do.
    pub const fn metric(self) -> Metric {
        match self {
            Self::Torque | Self::PointToPoint | Self::Slow => Metric::Measured,
            Self::Simulation => Metric::Prediction,
            Self::Parameters | Self::Friction | Self::Payload => Metric::Reference,
        }
    }

    /// The kind of motions on which torque is measured.
    const fn measured_on(self) -> &'static str {
        match self {
            Self::PointToPoint => "point-to-point",
            Self::Slow => "slow",
            Self::Torque | Self::Simulation | Self::Parameters | Self::Friction | Self::Payload => "random",
        }
    }
}

/// What a study that gives advice is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct AdvicePlan {
    /// Bundled name of the robot, or path of its file.
    pub robot: String,
    /// Its drives.
    pub drive: DriveKind,
    /// What its model is for.
    pub purpose: Purpose,
    /// Recorded periods of the experiment, of [`AdvicePlan::PERIOD_S`] each.
    pub periods: usize,
    /// Samples in a second.
    pub rate_hz: f64,
    /// Effects whose sizes a log of the arm shows: it has them at every level of the others.
    pub shown: Vec<(EffectKind, f64)>,
    /// Arms that are drawn around the nominal one.
    pub arms: usize,
    /// Every random number comes from it.
    pub seed: u64,
}

impl AdvicePlan {
    /// Period of each candidate, s.
    pub const PERIOD_S: f64 = 10.0;
    /// Periods that are performed and not recorded.
    pub const DISCARDED_PERIODS: usize = 1;
    /// Levels of the effects, in parts of the realistic one; each is as probable as the others. At the last, arms also have
    /// [`AdvicePlan::UNFORESEEN`].
    pub const LEVELS: [(&'static str, f64); 4] =
        [("no effects", 0.0), ("realistic level", 1.0), ("double level", 2.0), ("and unforeseen", 2.0)];
    /// An effect that no such drive is said to have: friction that differs between the directions. Real arms have effects that nobody
    /// thought of, and a candidate that only suits the others would be chosen without it.
    pub const UNFORESEEN: EffectKind = EffectKind::DirectionFriction;
    /// Estimators that are compared.
    pub const ESTIMATORS: [&'static str; 2] = ["wls", "irls-huber"];
    /// What the arms with [`AdvicePlan::shown`] have at each level.
    const WITH_SHOWN: [&'static str; 4] =
        ["as in the log", "others at realistic level", "others at double level", "and unforeseen"];
    /// Designs that are compared: their name, criterion, and largest RMS speed as a share of the speed limits.
    pub const DESIGNS: [(&'static str, &'static str, f64); 6] = [
        ("measured-torque", "measured-torque", 1.0),
        ("d-optimal", "d-optimal", 1.0),
        ("d-optimal, slower", "d-optimal", 0.4),
        ("condition", "condition", 1.0),
        ("i-optimal", "i-optimal", 1.0),
        ("a-optimal", "a-optimal", 1.0),
    ];

    /// The estimators that are compared, with the columns of the study and with terms for the effects of the arm.
    pub fn estimators(&self) -> Vec<String> {
        let kinds = effects_of(self.drive).iter().chain(self.shown.iter().map(|(kind, _)| kind));
        let mut terms: Vec<Term> = kinds.filter_map(|&kind| term_of(kind)).collect();
        terms.sort();
        terms.dedup();
        let more: String = terms.iter().map(|term| format!("+{}", term.entry().name)).collect();
        let sets = [Some(String::new()), Some(more).filter(|more| !more.is_empty())].into_iter().flatten();
        sets.flat_map(|more| Self::ESTIMATORS.map(|name| format!("{name}{more}"))).collect()
    }

    /// The columns of one of these estimators, and its name without them.
    pub fn columns_of(estimator: &str) -> (String, &str) {
        let (name, more) = estimator.split_at(estimator.find('+').unwrap_or(estimator.len()));
        (format!("{COLUMNS}{more}"), name)
    }

    /// Names of the levels at which candidates are compared, and the effects of the arms there. Arms without effects come first where a
    /// log shows some: they show what noise does, and no candidate is chosen by them.
    pub fn levels(&self) -> Vec<(&'static str, Vec<(EffectKind, f64)>)> {
        let is_shown = |kind: &EffectKind| self.shown.iter().any(|(shown, _)| shown == kind);
        let with = |part: f64, is_last: bool| {
            let others = effects_of(self.drive).iter().filter(|kind| part > 0.0 && !is_shown(kind));
            let others = others.map(|&kind| (kind, part * kind.entry().realistic));
            let is_open = is_last && !is_shown(&Self::UNFORESEEN);
            let unforeseen = (Self::UNFORESEEN, Self::UNFORESEEN.entry().realistic);
            self.shown.iter().copied().chain(others).chain(is_open.then_some(unforeseen)).collect()
        };
        let mut levels = Vec::new();
        for (k, ((name, part), with_shown)) in Self::LEVELS.into_iter().zip(Self::WITH_SHOWN).enumerate() {
            let effects = with(part, k + 1 == Self::LEVELS.len());
            if self.shown.is_empty() {
                levels.push((name, effects));
            } else {
                if part == 0.0 {
                    levels.push((name, Vec::new()));
                }
                levels.push((with_shown, effects));
            }
        }
        levels
    }

    /// The text of `study.toml`.
    pub fn text(&self) -> String {
        let levels = self.levels();
        let effect = |(kind, size): &(EffectKind, f64)| format!("{} = {size:?}", kind.name());
        let set = |(_, effects): &(_, Vec<_>)| {
            format!("    {{ {} }},", effects.iter().map(effect).collect::<Vec<_>>().join(", "))
        };
        let sets: Vec<String> = levels.iter().map(set).collect();
        let measured_on = self.purpose.measured_on();
        let designs = Self::DESIGNS.map(|(name, criterion, speed)| {
            let mut more = if speed < 1.0 { format!("rms_speed = {speed:?}\n") } else { String::new() };
            // By default such criteria predict random motions.
            if measured_on != "random" && ["measured-torque", "i-optimal"].contains(&criterion) {
                more.push_str(&format!("predict = \"{measured_on}\"\n"));
            }
            format!(
                "\n[[design]]\nname = \"{name}\"\nmaking = \"optimised\"\ncriterion = \"{criterion}\"\n{more}starts = 1\nevaluations = 600\n"
            )
        });
        format!(
            "# Which motion and which estimator, before the arm moves: arms around the nominal one, with effects of {drive} drives.\n\
             name = \"advice\"\n\
             question = \"Which motion, and which estimator, for this arm?\"\n\
             robot = {robot}\nseed = {seed}\nruns = {arms}\n\n\
             # No effect, the effects that such drives may have at two levels, and one that they should not have; the model has none of them.\n\
             conditions = [\n{sets}\n]\ncondition_names = [{names}]\n\n\
             [experiment]\nperiod_s = {period:?}\nharmonics = 5\nrate_hz = {rate:?}\nperiods = {periods}\ndiscarded_periods = {discarded}\n\n\
             [identification]\ncolumns = \"{COLUMNS}\"\nderivatives = \"fourier\"\nsamples_per_period = 250\n\
             estimators = [{estimators}]\n\n\
             [validation]\ntrajectories = 10\nsamples = 100\nmeasured = 3\nmeasured_on = \"{measured_on}\"\n\n\
             # Run k of every design is on arm k, with the signs and phases that effects have there.\n\
             [truths]\ncount = {arms}\ndraw_effects = true\n\n\
             [reference]\nmass_kg = 0.1\nfirst_moment_kg_m = 0.02\ninertia_kg_m2 = 0.01\nviscous_nm_s_rad = 0.1\ntorque_nm = 0.1\n\
             {designs}",
            drive = self.drive.name(),
            robot = toml::Value::from(self.robot.as_str()),
            seed = self.seed,
            arms = self.arms,
            sets = sets.join("\n"),
            names = quoted(levels.iter().map(|(name, _)| *name)),
            period = Self::PERIOD_S,
            rate = self.rate_hz,
            periods = self.periods,
            discarded = Self::DISCARDED_PERIODS,
            estimators = quoted(self.estimators().iter().map(String::as_str)),
            designs = designs.concat(),
        )
    }

    /// The plan.
    ///
    /// # Errors
    /// [`FormatError`] where a number is outside of what a study allows.
    pub fn plan(&self) -> Result<StudyPlan, FormatError> {
        StudyPlan::from_toml(&self.text())
    }
}

fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Effects;
    use crate::study::MotionKind;

    #[test]
    fn a_plan_of_every_drive_is_one_and_its_levels_are_parts_of_the_realistic_one() {
        for drive in DriveKind::ALL {
            let made = AdvicePlan {
                robot: "crs-a460".to_owned(),
                drive,
                purpose: Purpose::Slow,
                periods: 6,
                rate_hz: 500.0,
                shown: Vec::new(),
                arms: 4,
                seed: 3,
            };
            let plan = made.plan().unwrap();
            assert_eq!((plan.effect_sets.len(), plan.designs.len()), (4, 6));
            assert_eq!(plan.effect_sets[0], Effects::none());
            assert_eq!(plan.effect_sets[2].magnitude(AdvicePlan::UNFORESEEN), 0.0, "{drive:?}");
            assert!(plan.effect_sets[3].magnitude(AdvicePlan::UNFORESEEN) > 0.0);
            for (set, (_, part)) in plan.effect_sets.iter().zip(AdvicePlan::LEVELS) {
                for &kind in effects_of(drive) {
                    assert_eq!(set.magnitude(kind), part * kind.entry().realistic);
                }
            }
            // Designs that predict torque are told of the motions.
            for (purpose, kind) in [(Purpose::Torque, None), (Purpose::PointToPoint, Some(MotionKind::PointToPoint))] {
                let plan = AdvicePlan { purpose, ..made.clone() }.plan().unwrap();
                let told = plan.designs.iter().filter(|family| family.predict.is_some());
                assert!(told.clone().all(|family| family.predict == kind));
                assert_eq!(told.count(), if kind.is_some() { 2 } else { 0 });
            }
            // What a log shows is in every arm but those that show what noise does, whatever the drive.
            let shown = vec![(EffectKind::Elasticity, 1.5)];
            let sets = AdvicePlan { shown, ..made }.plan().unwrap().effect_sets;
            let sizes: Vec<f64> = sets.iter().map(|set| set.magnitude(EffectKind::Elasticity)).collect();
            assert_eq!(sizes, [0.0, 1.5, 1.5, 1.5, 1.5], "{drive:?}");
        }
    }
}
