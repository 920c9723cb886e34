//! The search for a design from several starts.

use armid::excitation::{Design, DesignProblem, Termination, design, design_from, random_design};
use armid::observer::{Observer, Work};
use armid::seed::Seed;
use armid_io::{Error, trajectory};
use rayon::prelude::*;

use super::settings::DesignSettings;
use crate::counter::Counter;

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
    settings: &DesignSettings,
    observer: &dyn Observer,
) -> Result<Found, Error> {
    let seed = Seed::new(settings.seed);
    let watched = problem.watched_by(observer);
    let named = settings.from.iter().map(|name| Ok((name, trajectory::load(name, None, problem.robot())?)));
    let named = named.collect::<Result<Vec<_>, Error>>()?;
    let starts = named.len() + settings.starts as usize;
    let counter = Counter::new(observer, Work::Starts, starts);
    let counted = |search: &dyn Fn() -> Result<Design, Error>| {
        let design = counter.goes_on().then(search).transpose()?;
        counter.add();
        Ok(design)
    };
    let given = named.par_iter().map(|(name, trajectory)| {
        counted(&|| design_from(watched, trajectory).map_err(|error| Error::new(format!("{name}: {error}"))))
    });
    let drawn = (0..settings.starts).into_par_iter();
    let begun = given.chain(drawn.map(|number| counted(&|| design(watched, seed, number).map_err(Error::new))));
    let designs = begun.collect::<Result<Vec<Option<Design>>, Error>>()?;
    let designs: Vec<Design> = designs.into_iter().flatten().collect();
    let baseline = if settings.baseline && counter.goes_on() {
        Some(random_design(watched, seed, 0).map_err(Error::new)?)
    } else {
        None
    };
    let ended = |design: &Design| design.termination == Termination::Interrupted;
    let interrupted = designs.len() < starts || designs.iter().chain(&baseline).any(ended);
    Ok(Found { designs, baseline, interrupted })
}
