//! From a processed log to estimates and everything that is said of them.

use std::sync::Arc;

use armid::estimation::{
    Estimate, Estimator, EstimatorKind, FrictionSpeeds, ResidualTrends, Termination, candidate_terms,
};
use armid::model::Columns;
use armid::observer::Observer;
use armid_io::log::LogResidual;
use armid_io::{Error, Inputs, ProcessedLog};
use armid_sim::closed_loop;

use super::answer::{Identified, IdentifyAnswer};
use super::verdict::{FileError, Verdict};
use crate::counter::Latch;
use crate::report::LogFigures;

/// What errors call an estimate that is in no file.
const NAME: &str = "the estimate";

/// What is estimated, and by what.
#[derive(Clone, Debug)]
pub struct IdentifySettings {
    /// Parameters of the model.
    pub columns: Columns,
    /// The estimators, which share base, nominal set and closed loop.
    pub estimators: Vec<EstimatorKind>,
    /// Estimators from outside, whose estimates come after those of the list.
    pub others: Vec<Arc<dyn Estimator>>,
    /// Terms from which those that the data decide are selected; their columns take the place of [`Self::columns`].
    pub select: Option<Columns>,
    /// Finds the speeds in which Coulomb friction sets in, or takes those of the robot file. Where `None` they are found beside
    /// selected terms and for logs of other tools without periods.
    pub onset_speed: Option<bool>,
    /// Estimates the speeds at which friction falls, for columns with Stribeck friction.
    pub stribeck_speed: bool,
}

impl Default for IdentifySettings {
    fn default() -> Self {
        Self {
            columns: Columns::RIGID_ROTOR_FRICTION,
            estimators: vec![EstimatorKind::Wls],
            others: Vec::new(),
            select: None,
            onset_speed: None,
            stribeck_speed: false,
        }
    }
}

/// Estimates the parameters of a log's robot. `inputs` say what the log was made from, where it came from files; they are stored
/// with the estimates, so that other commands find robot and mapping again.
///
/// # Errors
/// [`Error`] where the motion does not show the parameters, the equations have no answer, or the speeds at which friction falls
/// are asked for and no column is one of Stribeck friction; of [`armid_io::ErrorKind::Interrupted`] where the observer ended the
/// work before the estimators. What it ends within them is a last iterate.
pub fn identify(
    mut log: ProcessedLog,
    inputs: Option<Inputs>,
    settings: &IdentifySettings,
    observer: &dyn Observer,
) -> Result<IdentifyAnswer, Error> {
    let (mut columns, among) = (settings.columns, settings.select);
    let stated = log.robot.robot.clone();
    log.closed_loops.get_or_insert(closed_loop);
    let seeks = settings.onset_speed.unwrap_or_else(|| among.is_some() || log.has_no_periods());
    let mut onset = match log.servo().is_some_and(|servo| !servo.unknown.is_empty()) {
        _ if !seeks => None,
        false => log.find_onset(among.map_or(columns, basic), observer)?,
        // What other estimators lack is said below.
        true if settings.estimators != [EstimatorKind::Cloe] => None,
        true => onset_by_servo(&mut log, columns, observer)?,
    };
    let mut selection = among.map(|among| log.select_watched(among, observer)).transpose()?;
    if let Some(selection) = &mut selection {
        selection.terms.splice(0..0, onset.as_ref().map(FrictionSpeeds::evidence));
        let named = Columns::parse_among(&selection.columns, &candidate_terms());
        columns = named.or_else(|| Columns::parse(&selection.columns)).ok_or_else(|| {
            Error::new(format!("the selected columns are \"{}\", expected ones of the model", selection.columns))
        })?;
        // With the terms that were selected, the onset is another one.
        if onset.as_ref().is_some_and(FrictionSpeeds::predict_better) {
            log.robot.robot = stated;
            onset = log.find_onset(columns, observer)?;
        }
    }
    let speeds = match settings.stribeck_speed.then(|| log.find_stribeck_speeds(columns, observer)).transpose()? {
        Some(None) => {
            let message = format!("the columns are {columns}, expected ones of Stribeck friction to find its speeds");
            return Err(Error::new(message).help("such columns are rigid+rotor+friction+stribeck"));
        }
        Some(speeds) => speeds,
        None => None,
    };
    let listed = settings.estimators.iter().map(|kind| kind.estimator());
    let estimators: Vec<&dyn Estimator> = listed.chain(settings.others.iter().map(|own| &**own)).collect();
    let estimates = log.identify_watched(columns, &estimators, observer)?;
    if let Some(first) = estimates.first() {
        log.take_servo(first, NAME)?;
    }
    // What was ended returns at once.
    let ended = estimates.iter().any(|one| matches!(one.termination, Termination::Interrupted { .. }));
    let latch = Latch::new(observer);
    let (suspicions, files) =
        if ended { Default::default() } else { (log.suspicions(columns)?, FileError::all(&log, &latch)) };
    let interrupted = ended || latch.has_ended();
    // What was ended has a page as well, which reads its log again; a list of estimates has none.
    let has_page = estimates.len() == 1 && !interrupted;
    let expressions = log.base_expressions(columns)?;
    let trends = log
        .residual_trends(&estimates, NAME)
        .map_or_else(|_| vec![None; estimates.len()], |trends| trends.into_iter().map(Some).collect());
    let residuals = log.residuals(&estimates, NAME)?;
    let identified = |((estimate, residual), trends): ((Estimate, LogResidual), Option<ResidualTrends>)| {
        let verdict = Verdict::new(&estimate, &residual, trends.as_ref(), &log, &suspicions, &files);
        // Where one cannot be drawn, the page says why.
        let figures = trends.filter(|_| has_page);
        let figures = figures.and_then(|trends| LogFigures::new(&estimate, NAME, &log, &residual, &trends).ok());
        let LogResidual { used, held_out } = residual;
        Ok(Identified { expressions: expressions.of(&estimate, NAME)?, verdict, estimate, used, held_out, figures })
    };
    let estimates =
        estimates.into_iter().zip(residuals).zip(trends).map(identified).collect::<Result<Vec<_>, Error>>()?;
    let transmissions = estimates.first().map_or(Ok(None), |first| log.transmissions(&first.estimate, NAME))?;
    Ok(IdentifyAnswer { log, inputs, estimates, suspicions, selection, onset, speeds, transmissions, interrupted })
}

/// The onset of friction in torque by the servos that are estimated, first with the onset that a guess of them shows: a law that jumps is
/// not simulated.
fn onset_by_servo(
    log: &mut ProcessedLog,
    columns: Columns,
    observer: &dyn Observer,
) -> Result<Option<FrictionSpeeds>, Error> {
    if log.find_onset(columns, observer)?.is_none() {
        return Ok(None);
    }
    let found = log.identify_watched(columns, &[EstimatorKind::Cloe.estimator()], observer)?;
    let mut known = log.clone();
    if let Some(found) = found.first() {
        known.take_servo(found, NAME)?;
    }
    let onset = known.find_onset(columns, observer)?;
    log.robot = known.robot;
    Ok(onset)
}

/// Those of these columns beside which the onset of Coulomb friction is looked for before terms are selected.
fn basic(among: Columns) -> Columns {
    let known = Columns::RIGID_ROTOR_FRICTION;
    among.terms().filter(|&term| known.has(term)).fold(Columns::RIGID, Columns::with_term)
}
