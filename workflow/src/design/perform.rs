//! One design, from a robot to an answer.

use std::time::Instant;

use armid::excitation::{best_of, nearest_of};
use armid::observer::Observer;
use armid_io::robot::HeldShapes;
use armid_io::{Error, LoadedRobot};

use super::answer::{DesignAnswer, Gain};
use super::problem::problem;
use super::search::{Found, search};
use super::settings::{DesignGoal, DesignSettings};

/// Designs a trajectory: the best of all starts within all limits, or where none is, the nearest to them. `None` where an
/// observer ended the work before a first design.
///
/// Equal robots and settings give equal bits for any number of threads.
///
/// # Errors
/// [`Error`] where the settings do not fit the robot, or a file that they name cannot be used.
pub fn design(
    loaded: &LoadedRobot,
    settings: &DesignSettings,
    observer: &dyn Observer,
) -> Result<Option<DesignAnswer>, Error> {
    let mut loaded = loaded.clone();
    let shapes = match settings.limits.clearance_m {
        Some(clearance) => loaded.hold_collision_shapes(&settings.packages, clearance)?,
        None => HeldShapes::default(),
    };
    let problem = problem(&loaded, settings)?;
    let began = Instant::now();
    let Found { designs, baseline, interrupted } = search(&problem, settings, observer)?;
    let seconds = began.elapsed().as_secs_f64();
    let Some(best) = best_of(&designs).or_else(|| nearest_of(&designs)).cloned() else { return Ok(None) };
    let gain = Gain::of(&problem, &best, settings.prior.len()).map_err(Error::new)?;
    let load = match &settings.goal {
        DesignGoal::Load(load) => Some(*load),
        DesignGoal::Arm(_) => None,
    };
    Ok(Some(DesignAnswer {
        seed: settings.seed,
        problem,
        designs,
        baseline,
        best,
        seconds,
        interrupted,
        remarks: loaded.remarks,
        shapes,
        load,
        gain,
    }))
}
