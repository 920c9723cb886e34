//! The search for a design from several starts.

use armid::excitation::{Design, DesignProblem, Termination, design, design_from, random_design};
use armid::model::Robot;
use armid::observer::{Observer, Work};
use armid::seed::Seed;
use armid::trajectory::PeriodicTrajectory;
use armid_io::{Error, trajectory};
use rayon::prelude::*;

use super::settings::DesignSettings;
use crate::counter::Counter;

/// Where one search begins.
pub(super) enum Start {
    /// At a trajectory of a file, named for messages.
    Given(String, PeriodicTrajectory),
    /// At the first guess of this number.
    Drawn(u64),
}

/// Trajectories that were named, then first guesses.
pub(super) fn starts(settings: &DesignSettings, robot: &Robot) -> Result<Vec<Start>, Error> {
    let given = settings.from.iter().map(|name| Ok(Start::Given(name.clone(), trajectory::load(name, None, robot)?)));
    given.chain((0..settings.starts).map(|number| Ok(Start::Drawn(number)))).collect()
}

/// The results of the starts.
pub(super) struct Found {
    pub(super) designs: Vec<Design>,
    pub(super) baseline: Option<Design>,
    pub(super) interrupted: bool,
}

/// Searches from every start on all cores; the result does not depend on their number. Starts that were not begun when an
/// observer ended the work are left out.
pub(super) fn search(
    problem: &DesignProblem,
    starts: &[Start],
    settings: &DesignSettings,
    observer: &dyn Observer,
) -> Result<Found, Error> {
    let seed = Seed::new(settings.seed);
    let watched = problem.watched_by(observer);
    let counter = Counter::new(observer, Work::Starts, starts.len());
    let from = |start: &Start| match start {
        Start::Given(name, trajectory) => {
            design_from(watched, trajectory).map_err(|error| Error::new(format!("{name}: {error}")))
        }
        Start::Drawn(number) => design(watched, seed, *number).map_err(Error::of),
    };
    let begun = starts.par_iter().map(|start| {
        let design = counter.goes_on().then(|| from(start)).transpose()?;
        counter.add();
        Ok(design)
    });
    let designs = begun.collect::<Result<Vec<Option<Design>>, Error>>()?;
    let designs: Vec<Design> = designs.into_iter().flatten().collect();
    let baseline = if settings.baseline && counter.goes_on() {
        Some(random_design(watched, seed, 0).map_err(Error::of)?)
    } else {
        None
    };
    let ended = |design: &Design| design.termination == Termination::Interrupted;
    let interrupted = designs.len() < starts.len() || designs.iter().chain(&baseline).any(ended);
    Ok(Found { designs, baseline, interrupted })
}
