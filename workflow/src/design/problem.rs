//! From settings to a design problem.

use std::path::Path;
use std::sync::Arc;

use armid::base::{Method, reduce};
use armid::excitation::criterion::PayloadOptimal;
use armid::excitation::{
    Criterion, DesignBudget, DesignLimits, DesignProblem, DesignSpace, EvaluationMotions, ExpectedEffects,
};
use armid::experiment::Effects;
use armid::input::size::{DESIGNS, HARMONICS, PERIOD_S};
use armid::model::{Columns, Robot};
use armid::remedy::{Remedy, Setting, Task};
use armid::seed::Seed;
use armid::study::{ExperimentSettings, MotionKind, motions_to_predict};
use armid_io::prior::set_prior;
use armid_io::{Error, LoadedRobot, trajectory};

use super::settings::{DesignGoal, DesignSettings};

/// The problem of these settings on a robot whose collision shapes are held.
pub(super) fn problem(loaded: &LoadedRobot, settings: &DesignSettings) -> Result<DesignProblem, Error> {
    check_sizes(settings)?;
    let robot = settings.robot(loaded)?;
    let nominal = loaded.guess();
    let mut limits =
        DesignLimits::for_robot(&robot, nominal, loaded.uncertainty.as_ref(), &settings.limits).map_err(Error::new)?;
    if let DesignGoal::Load(load) = &settings.goal {
        limits.payload = Some(load.body()?);
    }
    let criterion = criterion(&settings.goal, &robot, settings.columns)?;
    let mut problem = DesignProblem::new(robot, settings.columns, criterion, limits).map_err(Error::new)?;
    problem.set_space(space(settings, problem.robot())?).map_err(Error::new)?;
    let iterations = settings.iterations.unwrap_or(usize::MAX);
    let budget = DesignBudget { evaluations: settings.evaluations, iterations, ..DesignBudget::default() };
    problem.set_budget(budget).map_err(Error::new)?;
    // A load is estimated with rows that are weighted by their noise.
    let is_of_load = matches!(settings.goal, DesignGoal::Load(_));
    if settings.weighted || (is_of_load && effort_noise(problem.robot()).is_ok()) {
        problem.set_noise(effort_noise(problem.robot())?).map_err(Error::new)?;
    }
    if let DesignGoal::Arm(criterion) = &settings.goal {
        declare_use(&**criterion, settings, loaded, &mut problem)?;
    }
    if !settings.prior.is_empty() {
        let criterion = &problem.objective().criterion;
        if !criterion.is_weighted() {
            let message = format!(
                "earlier estimates with criterion {}, expected one of the information: d-optimal, a-optimal, e-optimal, \
                 i-optimal, model-error or measured-torque",
                criterion.name()
            );
            return Err(Error::new(message));
        }
        set_prior(&mut problem, loaded, &settings.prior)?;
    }
    Ok(problem)
}

/// How much is asked for, before anything is made of it.
fn check_sizes(settings: &DesignSettings) -> Result<(), Error> {
    settings.harmonics.iter().try_for_each(|&one| HARMONICS.check_count("number of harmonics", one))?;
    if settings.period_s.is_finite() {
        PERIOD_S.check("period", settings.period_s)?;
    }
    DESIGNS.check("number of starts", settings.starts as f64)?;
    if settings.starts == 0 && settings.from.is_empty() {
        return Err(Error::new("the number of starts is 0, expected at least 1, or a trajectory from which to start"));
    }
    Ok(())
}

fn space(settings: &DesignSettings, robot: &Robot) -> Result<DesignSpace, Error> {
    let harmonics = match settings.harmonics.as_slice() {
        [every] => vec![*every; robot.dof()],
        each => each.to_vec(),
    };
    let mut space = DesignSpace::new(settings.family, settings.period_s, harmonics);
    for (name, place) in &settings.frozen {
        let names: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let Some(index) = names.iter().position(|known| known == name) else {
            let message = format!("the joint to hold still is \"{name}\", expected one of {}", names.join(", "));
            return Err(Error::new(message));
        };
        space.frozen[index] = Some(*place);
    }
    Ok(space)
}

/// What is minimised: the criterion of the goal, or that of a load.
fn criterion(goal: &DesignGoal, robot: &Robot, columns: Columns) -> Result<Arc<dyn Criterion>, Error> {
    let DesignGoal::Arm(criterion) = goal else {
        let base = reduce(robot, columns, Method::Structural, Seed::new(0))
            .map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
        return match PayloadOptimal::new(&base) {
            Some(criterion) => Ok(Arc::new(criterion)),
            None => {
                let name = robot.name();
                Err(Error::new(format!("the joints of robot \"{name}\" show nothing of a load on the last link")))
            }
        };
    };
    Ok(Arc::clone(criterion))
}

/// What the estimate is for, and what is expected of the arm.
fn declare_use(
    criterion: &dyn Criterion,
    settings: &DesignSettings,
    loaded: &LoadedRobot,
    problem: &mut DesignProblem,
) -> Result<(), Error> {
    let expects_effects = criterion.expects_effects();
    let refused = |found: &str, expected: &str| -> Result<(), Error> {
        Err(Error::new(format!("{found} with criterion {}, expected {expected}", criterion.name())))
    };
    if !settings.expected.is_none() && !expects_effects {
        return refused("expected effects", "model-error or measured-torque");
    }
    if !settings.predict.is_empty() {
        if !criterion.asks_for_prediction() {
            return refused("motions to predict", "i-optimal, model-error or measured-torque");
        }
        let motions = motions(settings, loaded, problem.robot())?;
        problem.set_evaluation(motions).map_err(Error::new)?;
    }
    if !expects_effects {
        return Ok(());
    }
    let Some(nominal) = loaded.guess() else {
        let expected = "one of the others: the torque of effects is found by them";
        return refused("a robot without nominal parameters", expected);
    };
    // Noise against bias: both in N·m.
    problem.set_noise(effort_noise(problem.robot())?).map_err(Error::new)?;
    let robot = problem.robot();
    let rows = robot.dof() as f64 * settings.period_s * robot.servo().rate_hz * settings.periods as f64;
    let declared = settings.expected.clone();
    let effects = if declared.is_none() { Effects::expected_by(criterion) } else { declared };
    let expected = effects.expected(robot, nominal);
    let expected = expected.map_err(|error| Error::new(format!("expected effects: {error}")))?;
    let expected = ExpectedEffects { are_carried: criterion.predicts_measured_torque(), ..expected };
    problem.set_rows(rows).map_err(Error::new)?;
    problem.set_expected(expected).map_err(Error::new)
}

/// The motions of the kind that is named, or those that are.
fn motions(settings: &DesignSettings, loaded: &LoadedRobot, robot: &Robot) -> Result<EvaluationMotions, Error> {
    let Some(kind) =
        settings.predict.first().filter(|_| settings.predict.len() == 1).and_then(|name| MotionKind::moving(name))
    else {
        let load = |name: &String| {
            let expected = "expected the file or name of a trajectory, or one of random, slow, point-to-point";
            trajectory::load(name, None, robot)
                .map_err(|error| if Path::new(name).exists() { error } else { error.help(expected) })
        };
        let motions = settings.predict.iter().map(load).collect::<Result<_, Error>>()?;
        return EvaluationMotions::new(motions, robot.dof()).map_err(Error::new);
    };
    let Some(nominal) = loaded.guess() else {
        let message =
            format!("{} motions of a robot without nominal parameters, expected trajectories to predict", kind.title());
        return Err(Error::new(message));
    };
    let experiment = ExperimentSettings {
        period_s: settings.period_s,
        harmonics: settings.harmonics.iter().copied().max().unwrap_or(1),
        rate_hz: robot.servo().rate_hz,
        periods: settings.periods,
        discarded_periods: 0,
    };
    motions_to_predict(kind, robot, nominal, &experiment, Seed::new(settings.seed)).map_err(Error::new)
}

/// Standard deviation of one sample of each joint's effort by the noise of its current sensor.
fn effort_noise(robot: &Robot) -> Result<Vec<f64>, Error> {
    let noise: Vec<f64> =
        robot.joints().iter().map(|joint| joint.drive.current_noise * joint.drive.torque_per_ampere()).collect();
    match robot.joints().iter().zip(&noise).find(|(_, noise)| **noise <= 0.0) {
        Some((joint, _)) => {
            let message = format!(
                "equations are to be weighted by the noise of currents, and that of joint \"{}\" has none in the robot file",
                joint.name
            );
            let help = Remedy::from("current_noise_a of a drive states it; ").perform(Task::Robot, "ROBOT");
            let help = help.option(Setting::Output, "robot.toml").say(" begins a robot file");
            Err(Error::new(message).help(help))
        }
        None => Ok(noise),
    }
}
