//! The study, and the best of its candidates.

use std::collections::BTreeMap;
use std::path::Path;

use armid::excitation::Termination;
use armid::model::DriveKind;
use armid::model::format::ChainEnds;
use armid::observer::Observer;
use armid::remedy::{Remedy, Setting};
use armid::statistics::{Interval, Spread, mean, t_interval};
use armid::study::{AdvicePlan, FamilyScore, Metric, Purpose, StudyDesign, StudyPlans, StudyResult};
use armid_io::output::write_text;
use armid_io::study::{RunValue, run_errors, run_values};
use armid_io::{Error, Text, robot};

use super::answer::{AdviceAnswer, Candidate, Longer, Undetermined};
use super::part::Part;
use super::settings::AdviceSettings;
use crate::study::{StudyAnswer, StudySettings, perform};

/// Rate that an experiment is sampled at, at most, Hz.
const MOST_RATE_HZ: f64 = 500.0;

/// Error over that of the best candidate of a run, up to which another one is near it.
const NEAR: f64 = 1.1;

/// What more time is looked at, min.
const MORE_MINUTES: f64 = 60.0;

/// Performs the study, and finds the best candidate. The folder of the settings gets the study with its page, the motion, and an
/// experiment to run; and the robot file that it is for, where something had to be assumed. `None` where the observer ended it.
///
/// # Errors
/// [`Error`] where the robot states too little, the folder holds another study, or no candidate gave an estimate.
pub fn advise(settings: &AdviceSettings, observer: &dyn Observer) -> Result<Option<AdviceAnswer>, Error> {
    let folder = settings.output.as_path();
    check_free(folder)?;
    let place = folder.join("robot.toml");
    let noise = settings.log.as_ref().and_then(|log| log.noise.as_deref());
    let assumed = robot::assume(&settings.robot, &settings.ends, &place, noise)?;
    let mut assumptions = Vec::new();
    // The file that is made chooses the chain already.
    let ends = if assumed.is_some() { ChainEnds::default() } else { settings.ends.clone() };
    let named = match assumed {
        Some(file) => {
            let own = [("robot.toml", file.text)];
            for (name, text) in own.into_iter().chain(file.beside) {
                let place = folder.join(name);
                if Text::read(&place).is_ok_and(|there| *there.content != *text) {
                    return Err(taken(&place));
                }
                write_text(&place, &text)?;
            }
            assumptions = file.assumptions;
            "robot.toml".to_owned()
        }
        None if robot::find(&settings.robot).is_ok() => settings.robot.clone(),
        None => {
            let path = Path::new(&settings.robot);
            std::path::absolute(path).map_err(|error| Error::unreadable(path, &error))?.display().to_string()
        }
    };
    let loaded = robot::load(&named, &ends, Some(folder))?;
    let servo_hz = loaded.robot.servo().rate_hz;
    let drive = settings.drive.or(loaded.robot.drive_kind()).unwrap_or_else(|| {
        assumptions.push("harmonic drives, since the robot file does not state `drives`".to_owned());
        DriveKind::Harmonic
    });
    let made = AdvicePlan {
        robot: named.clone(),
        drive,
        purpose: settings.purpose,
        periods: settings.periods(),
        rate_hz: servo_hz / (servo_hz / MOST_RATE_HZ).ceil(),
        shown: settings.log.as_ref().map_or_else(Vec::new, |log| log.shown(drive)),
        arms: settings.arms,
        seed: settings.seed,
    };
    let plan = made.plan().map_err(Error::new)?;
    let study = StudySettings {
        output: folder.to_path_buf(),
        beside: Some(folder.to_path_buf()),
        threads: settings.threads,
        resume: settings.resume,
        ..StudySettings::default()
    };
    let StudyAnswer::Whole(summary) = perform(&StudyPlans::One(Box::new(plan)), &study, observer)? else {
        return Ok(None);
    };
    let part = Part::of(settings.purpose, &loaded.robot, &summary.result)?;
    let values = |metric| values(folder, &summary.result, metric, part.as_ref());
    let candidates = candidates(values(settings.purpose.metric())?, &summary.result, !made.shown.is_empty());
    let Some(best) = candidates.first() else {
        return Err(Error::new(format!(
            "{} of {} runs of the study failed, expected a candidate that gives an estimate at every level of an arm",
            summary.failed, summary.runs
        )));
    };
    let family = summary.result.plan.designs.iter().position(|design| design.name == best.design).unwrap_or(0);
    let is_inside = |design: &StudyDesign| design.termination.as_ref().is_some_and(Termination::is_feasible);
    let designs = summary.result.designs.iter().filter(|design| design.family == family);
    let design =
        designs.min_by(|a, b| is_inside(b).cmp(&is_inside(a)).then_with(|| a.own_value().total_cmp(&b.own_value())));
    let trajectory = folder.join("trajectory.toml");
    if let Some(design) = design {
        write_text(&trajectory, &design.trajectory.to_toml())?;
    }
    let experiment = folder.join("experiment.toml");
    write_text(
        &experiment,
        &format!(
            "# The best motion for this arm by its study: {} with {}.\nname = \"advised\"\nrobot = {}\ntrajectory = \"trajectory.toml\"\n\
             rate_hz = {:?}\nperiods = {}\ndiscarded_periods = {}\n",
            best.design,
            best.estimator,
            serde_json::Value::from(named),
            made.rate_hz,
            made.periods,
            AdvicePlan::DISCARDED_PERIODS
        ),
    )?;
    Ok(Some(AdviceAnswer {
        robot: loaded.robot.name().to_owned(),
        drive,
        from_log: settings.log.as_ref().map_or_else(Vec::new, |log| log.sentences(drive)),
        longer: longer(&values, best, settings.purpose, &made)?,
        purpose: settings.purpose,
        duration_s: AdvicePlan::PERIOD_S * made.periods as f64,
        poorly_determined: poorly_determined(&summary.result, best, AdvicePlan::PERIOD_S * made.periods as f64 / 60.0),
        parameters: summary.result.parameters.len(),
        limits_kept: design.is_some_and(is_inside),
        candidates,
        assumptions,
        trajectory,
        experiment,
        report: summary.report,
        runs: summary.runs,
        failed: summary.failed,
    }))
}

/// Nothing of another kind is written over.
fn check_free(folder: &Path) -> Result<(), Error> {
    let places = ["robot.toml", "nominal.toml", "truth.toml", "trajectory.toml", "experiment.toml"]
        .map(|name| folder.join(name));
    match places.iter().find(|place| place.exists()) {
        Some(place) if !folder.join("study.toml").exists() => Err(taken(place)),
        _ => Ok(()),
    }
}

fn taken(place: &Path) -> Error {
    let message =
        format!("{} is there already, expected a folder without it: nothing is written over", place.display());
    Error::new(message).help(Remedy::default().setting(Setting::Output).say(" chooses another folder"))
}

/// The errors of all runs: by a metric of the study, or of the part of the parameters that counts.
fn values(folder: &Path, result: &StudyResult, metric: Metric, part: Option<&Part>) -> Result<Vec<RunValue>, Error> {
    let mut values = run_values(folder, metric)?;
    let Some(part) = part else { return Ok(values) };
    let families: Vec<&str> =
        result.designs.iter().map(|design| result.plan.designs[design.family].name.as_str()).collect();
    let errors = run_errors(folder, &families)?;
    let errors: BTreeMap<_, _> = errors
        .iter()
        .map(|of| ((&*of.family, &*of.condition, &*of.estimator, of.run), part.error(&of.errors)))
        .collect();
    for run in &mut values {
        let own = errors.get(&(&*run.family, &*run.condition, &*run.estimator, run.run)).copied();
        run.value = run.value.and(own);
    }
    Ok(values)
}

/// What everybody does where a fit with more terms gives no estimate: the same estimator without them, on the same log.
fn without_terms_where_failed(mut values: Vec<RunValue>) -> Vec<RunValue> {
    let key = |of: &RunValue, estimator: &str| (of.family.clone(), of.condition.clone(), estimator.to_owned(), of.run);
    let all: BTreeMap<_, _> = values.iter().map(|of| (key(of, &of.estimator), of.value)).collect();
    for run in values.iter_mut().filter(|run| run.value.is_none()) {
        let plain = AdvicePlan::columns_of(&run.estimator).1;
        run.value = all.get(&key(run, plain)).copied().flatten();
    }
    values
}

/// Every design with every estimator, by the runs of the study; without those of arms without effects, where a log shows that this arm is
/// none.
fn candidates(mut values: Vec<RunValue>, result: &StudyResult, has_effects: bool) -> Vec<Candidate> {
    values.retain(|run| !(has_effects && run.condition == AdvicePlan::LEVELS[0].0));
    let filled = without_terms_where_failed(values.clone());
    let mut least: BTreeMap<(&str, usize), f64> = BTreeMap::new();
    for run in &filled {
        let least = least.entry((&run.condition, run.run)).or_insert(f64::INFINITY);
        *least = least.min(run.value.unwrap_or(f64::INFINITY));
    }
    let mut all: Vec<(Candidate, BTreeMap<usize, f64>, usize)> = Vec::new();
    for design in &result.plan.designs {
        for estimator in &result.plan.identification.estimators {
            let is_own = |run: &&RunValue| run.family == design.name && run.estimator == *estimator;
            let own = || filled.iter().filter(is_own);
            let failed = values.iter().filter(is_own).filter(|run| run.value.is_none()).count();
            // What never gives an estimate is its fallback, which is in the list.
            if failed == own().count() {
                continue;
            }
            let of = |condition: Option<&str>| {
                let runs = own().filter(|run| condition.is_none_or(|condition| run.condition == condition));
                runs.filter_map(|run| run.value).collect::<Vec<f64>>()
            };
            let levels = result.conditions.iter().map(|condition| &condition.condition.name);
            let arms = by_arm(own().map(|run| (run.run, run.value)));
            let Some((expected, error)) = expected(&arms).zip(Spread::new(&of(None))) else { continue };
            let by_level = levels.filter_map(|name| Some((name.clone(), Spread::new(&of(Some(name)))?))).collect();
            let (design, columns) = (design.name.clone(), AdvicePlan::columns_of(estimator).0);
            let estimator = estimator.clone();
            let without = own().filter(|run| run.value.is_none()).count();
            let is_near =
                |run: &&RunValue| run.value.is_some_and(|own| own <= NEAR * least[&(&*run.condition, run.run)]);
            let near_best = own().filter(is_near).count() as f64 / own().count() as f64;
            all.push((
                Candidate { design, estimator, columns, expected, near_best, failed, error, over_best: None, by_level },
                arms,
                without,
            ));
        }
    }
    // An estimator that fails does so on the hard arms. Errors of a high level would outweigh all others in a mean.
    all.sort_by(|(a, _, of_a), (b, _, of_b)| {
        let by_share = || b.near_best.total_cmp(&a.near_best);
        of_a.cmp(of_b).then_with(by_share).then_with(|| a.expected.total_cmp(&b.expected))
    });
    let best = all.first().map(|(_, arms, _)| arms.clone()).unwrap_or_default();
    for (candidate, arms, _) in all.iter_mut().skip(1) {
        let logs: Vec<f64> = arms.iter().filter_map(|(arm, own)| Some(libm::log(own / best.get(arm)?))).collect();
        candidate.over_best = t_interval(&logs, 0.95).map(Interval::exponentiated);
    }
    all.into_iter().map(|(candidate, ..)| candidate).collect()
}

/// What an hour more would give of the best candidate: noise falls with time, and what arms without effects do not have stays.
fn longer(
    values: &dyn Fn(Metric) -> Result<Vec<RunValue>, Error>,
    best: &Candidate,
    purpose: Purpose,
    made: &AdvicePlan,
) -> Result<Option<Longer>, Error> {
    let without_effects = AdvicePlan::LEVELS[0].0;
    let is_own = |run: &RunValue| run.family == best.design && run.estimator == best.estimator;
    let squares = |metric, is_meant: &dyn Fn(&str) -> bool| -> Result<Vec<(usize, Option<f64>)>, Error> {
        let runs = without_terms_where_failed(values(metric)?)
            .into_iter()
            .filter(|run| is_own(run) && is_meant(&run.condition));
        Ok(runs.map(|run| (run.run, run.value.map(|value| value * value))).collect())
    };
    let noise = squares(purpose.noise_metric(), &|condition| condition == without_effects)?;
    let noise: Vec<f64> = noise.into_iter().filter_map(|(_, square)| square).collect();
    let all = squares(purpose.metric(), &|condition| made.shown.is_empty() || condition != without_effects)?;
    let without = |share: f64| {
        let left = |square: f64| (square - share * mean(&noise)).max(0.0).sqrt();
        let left = by_arm(all.iter().map(|&(arm, square)| (arm, square.map(left))));
        expected(&left).filter(|_| !noise.is_empty())
    };
    let minutes = AdvicePlan::PERIOD_S * made.periods as f64 / 60.0;
    let found = without(MORE_MINUTES / (minutes + MORE_MINUTES)).zip(without(1.0));
    Ok(found.map(|(expected, floor)| Longer { minutes: MORE_MINUTES, expected, floor }))
}

/// Mean over levels of each arm's errors; of arms that have an estimate at every level, since those that fail are the hard ones.
fn by_arm(runs: impl Iterator<Item = (usize, Option<f64>)>) -> BTreeMap<usize, f64> {
    let mut arms: BTreeMap<usize, Option<Vec<f64>>> = BTreeMap::new();
    for (arm, value) in runs {
        let all = arms.entry(arm).or_insert_with(|| Some(Vec::new()));
        *all = all.take().zip(value).map(|(mut all, value)| {
            all.push(value);
            all
        });
    }
    arms.into_iter().filter_map(|(arm, all)| Some((arm, mean(&all?)))).collect()
}

/// Geometric mean over arms; `None` of none.
fn expected(arms: &BTreeMap<usize, f64>) -> Option<f64> {
    let logs: Vec<f64> = arms.values().copied().map(libm::log).collect();
    (!logs.is_empty()).then(|| libm::exp(mean(&logs)))
}

/// Parameters whose stated standard deviation is more than a third of their value, without effects, and how long would show them.
fn poorly_determined(result: &StudyResult, best: &Candidate, minutes: f64) -> Vec<Undetermined> {
    let scores = &result.findings().families;
    let of_estimator = scores.iter().filter(|score| score.estimator == best.estimator);
    let (own, others): (Vec<&FamilyScore>, Vec<_>) = of_estimator.partition(|score| score.family == best.design);
    let lines = result.parameters.iter().enumerate();
    let undetermined = lines.filter_map(|(k, line)| {
        let needed =
            |score: &FamilyScore| Some(minutes * (3.0 * score.parameters.get(k)?.stated_std / line.truth).powi(2));
        let own = needed(own.first()?)?;
        let other = others.iter().filter_map(|score| Some((score.family.clone(), needed(score)?)));
        let other = other.filter(|(_, time)| *time < own).min_by(|a, b| a.1.total_cmp(&b.1));
        let minutes_of = own.is_finite().then_some(own);
        (own > minutes).then(|| Undetermined { name: line.name.clone(), minutes: minutes_of, other })
    });
    undetermined.collect()
}
