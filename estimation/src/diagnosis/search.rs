//! The search for the mistake.

use nalgebra::Vector3;

use super::evidence::{DEGREE, Instants, Model};
use super::mistake::Mistake;
use super::slope::Slopes;
use crate::base::BaseError;
use crate::model::{Columns, Robot, StandardParameters};
use crate::signal::Samples;

/// A cost from which on a log is suspect: a residual of 2.2 % of the torque at every joint.
const SUSPECT: f64 = 5e-4;
/// The cost after a correction over that before, at most.
const MUCH_BETTER: f64 = 0.5;
/// What a correction with a free factor must be better by than one without.
const HANDICAP: f64 = 1.5;
/// Costs that are taken as equal.
const EQUAL: f64 = 1.1;
/// A joint that moves less than this, rad or m, stands still.
const REST: f64 = 2e-3;
/// A motion of which no joint has a larger range, rad or m, is looked at as one in radians that were taken for degrees.
const SMALL: f64 = 0.12;
/// A factor this near to one is no mistake.
const SAME: f64 = 0.05;
/// Degrees that the zeros of joints differ by between conventions.
const OFFSETS: [f64; 3] = [90.0, -90.0, 180.0];
/// Factors from which the search of one begins.
const FACTORS: [f64; 12] = [0.25, 0.36, 0.5, 0.63, 0.8, 1.25, 1.6, 2.0, 2.8, 4.0, 0.1, 10.0];

/// What mistakes are looked for in.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The samples that are fitted.
    pub samples: &'a Samples,
    /// Samples that are only predicted; the last fifth of the others where it is `None`.
    pub held_out: Option<&'a Samples>,
    /// The parameters of the robot file, where it states any.
    pub nominal: Option<&'a StandardParameters>,
}

/// A mistake that a log seems to have been made with.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Suspicion {
    /// What is wrong.
    #[serde(flatten)]
    pub mistake: Mistake,
    /// Cost of the fit as the log stands.
    pub cost: f64,
    /// Cost after the correction; that before where it is no matter of a fit.
    pub corrected_cost: f64,
}

/// Joints that stand still, counted from one.
pub fn standing_joints(samples: &Samples) -> Vec<usize> {
    let n = samples.dof();
    (0..n).filter(|&i| range(&samples.states.q, i, n) < REST).map(|i| i + 1).collect()
}

/// Largest less smallest of one joint's entries of a table with n in a row.
fn range(table: &[f64], joint: usize, n: usize) -> f64 {
    let column = table.iter().skip(joint).step_by(n);
    let ends = column.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
    ends.1 - ends.0
}

/// Looks for a mistake that the samples of a log were made with; `None` where the log is explained as it stands, or no mistake
/// that is known explains it much better. Joints at rest are found by [`standing_joints`].
///
/// # Errors
/// [`BaseError`] where the robot has no base parameters of these columns.
pub fn diagnose(robot: &Robot, columns: Columns, log: &Evidence<'_>) -> Result<Option<Suspicion>, BaseError> {
    let samples = log.samples;
    let model = Model::new(robot.clone(), columns)?;
    let instants = Instants::of(samples);
    let cost = model.cost(&instants);
    let (n, standing) = (samples.dof(), standing_joints(samples));
    let silent = (0..n).find(|&i| range(&samples.tau, i, n) == 0.0 && !standing.contains(&(i + 1)));
    if let Some(i) = silent {
        return Ok(Some(Suspicion { mistake: Mistake::NoEffort { joint: i + 1 }, cost, corrected_cost: cost }));
    }
    let after = |mistake: &Mistake| model.cost(&instants.corrected(mistake, robot));
    // A fit explains small motions by parameters that no arm has: whether the large ones are explained too is what counts.
    if (0..n).all(|i| range(&samples.states.q, i, n) < SMALL) {
        let corrected_cost = after(&Mistake::Radians);
        if corrected_cost < cost.max(SUSPECT) / MUCH_BETTER {
            return Ok(Some(Suspicion { mistake: Mistake::Radians, cost, corrected_cost }));
        }
    }
    // The robot file says nothing of the torque of a motion that its joints cannot make.
    let mistake = of_all_efforts(&model, &instants, log.nominal).filter(|_| model.beyond_limits(&instants) == 0.0);
    if let Some(mistake) = mistake {
        return Ok(Some(Suspicion { mistake, cost, corrected_cost: after(&mistake) }));
    }
    if cost < SUSPECT {
        return Ok(None);
    }
    let mut best: Option<(Mistake, f64, f64)> = None;
    let (fitted, others) = match log.held_out {
        Some(held_out) => (instants.clone(), Instants::of(held_out)),
        None => instants.split(),
    };
    let predicted = |mistake: Option<&Mistake>| {
        let of = |part: &Instants| mistake.map_or_else(|| part.clone(), |mistake| part.corrected(mistake, robot));
        model.predicted(&of(&fitted), &of(&others))
    };
    let as_it_stands = predicted(None);
    for mistake in plain(robot) {
        // An exchange fits what it should not: it must predict better as well.
        if !mistake.is_exchange() || predicted(Some(&mistake)) < as_it_stands {
            offer(&mut best, mistake, after(&mistake), 1.0);
        }
    }
    for (direction, gravity) in directions(robot.gravity()) {
        let turned = Model::new(robot.clone().with_gravity(gravity), columns)?;
        offer(&mut best, Mistake::Gravity { direction }, turned.cost(&instants), 1.0);
    }
    if matches!(best, Some((Mistake::Degrees, ..))) && robot.joints().iter().all(|joint| joint.drive.gear == 1.0) {
        let (times, found) = best_factor(|times| after(&Mistake::PositionUnit { factor: times * DEGREE }));
        offer(&mut best, Mistake::PositionUnit { factor: times * DEGREE }, found, HANDICAP);
    }
    // Factors are looked for where nothing simpler explains the log.
    let explained = best.is_some_and(|(_, found, _)| found < SUSPECT);
    let joints = if explained { 0 } else { robot.dof() };
    for joint in 1..=joints {
        let (factor, found) = best_factor(|factor| after(&Mistake::EffortScale { joint, factor }));
        offer(&mut best, Mistake::EffortScale { joint, factor }, found, HANDICAP);
        let (factor, found) = best_factor(|factor| after(&Mistake::PositionScale { joint, factor }));
        offer(&mut best, Mistake::PositionScale { joint, factor }, found, HANDICAP);
    }
    let named = best.filter(|(mistake, found, _)| *found < MUCH_BETTER * cost && !is_near_one(mistake));
    Ok(named.map(|(mistake, found, _)| Suspicion {
        mistake: which_sign(mistake, found, &after),
        cost,
        corrected_cost: found,
    }))
}

/// A sign or a unit that all efforts share, which no fit shows: by the robot file's torque, or the sign by friction alone.
fn of_all_efforts(model: &Model, instants: &Instants, nominal: Option<&StandardParameters>) -> Option<Mistake> {
    let slopes = nominal.map(|nominal| Slopes::new(&model.robot, nominal, instants));
    if let Some(mistake) = slopes.as_ref().and_then(Slopes::unit) {
        return Some(mistake);
    }
    let slope = slopes.as_ref().and_then(Slopes::sign);
    let (below, above) = model.friction_signs(instants);
    // With gravity the wrong way round slopes are negative and friction is not.
    let by_slope = slope.is_some_and(|slope| slope < 0.0) && below >= above;
    let by_friction = slope.is_none() && below >= 3 * above.max(1) && 2 * below > model.robot.dof();
    (by_slope || by_friction).then_some(Mistake::EffortsReversed { slope })
}

/// Takes a candidate, its cost and what its cost is multiplied by. Candidates come the simplest first: a later one must be
/// clearly better.
fn offer(best: &mut Option<(Mistake, f64, f64)>, mistake: Mistake, found: f64, handicap: f64) {
    if best.is_none_or(|(_, _, least)| found * handicap * EQUAL < least) {
        *best = Some((mistake, found, found * handicap));
    }
}

/// A sign of which it does not show whether it is the position's or the effort's.
fn which_sign(mistake: Mistake, found: f64, after: &dyn Fn(&Mistake) -> f64) -> Mistake {
    let (joint, other) = match mistake {
        Mistake::PositionSign { joint } => (joint, Mistake::EffortSign { joint }),
        Mistake::EffortSign { joint } => (joint, Mistake::PositionSign { joint }),
        other => return other,
    };
    if after(&other) < EQUAL * found { Mistake::EitherSign { joint } } else { mistake }
}

fn is_near_one(mistake: &Mistake) -> bool {
    matches!(mistake, Mistake::EffortScale { factor, .. } | Mistake::PositionScale { factor, .. }
        if (factor - 1.0).abs() < SAME)
}

/// Mistakes without a free factor, the most frequent first.
fn plain(robot: &Robot) -> Vec<Mistake> {
    let n = robot.dof();
    let mut all = vec![Mistake::Degrees];
    if robot.joints().iter().any(|joint| joint.drive.gear != 1.0) {
        all.extend([Mistake::MotorAngles, Mistake::MotorTorques]);
    }
    all.extend([1e-3, 0.01].map(|factor| Mistake::EffortUnit { factor }));
    all.extend((1..=n).flat_map(|joint| [Mistake::EffortSign { joint }, Mistake::PositionSign { joint }]));
    for a in 1..=n {
        for b in a + 1..=n {
            let joints = [a, b];
            all.extend([
                Mistake::JointsSwapped { joints },
                Mistake::EffortsSwapped { joints },
                Mistake::PositionsSwapped { joints },
            ]);
        }
    }
    all.extend((1..=n).flat_map(|joint| OFFSETS.map(|degrees| Mistake::ZeroOffset { joint, degrees })));
    all
}

/// The directions along the axes of the base that gravity does not have, with its strength.
fn directions(gravity: Vector3<f64>) -> Vec<([i8; 3], Vector3<f64>)> {
    let strength = gravity.norm();
    let all: [[i8; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    all.into_iter()
        .map(|direction| (direction, Vector3::from_iterator(direction.iter().map(|&x| f64::from(x))) * strength))
        .filter(|(_, turned)| strength > 0.0 && (turned - gravity).norm() > 0.1 * strength)
        .collect()
}

/// The factor of least cost: the best of a list, then by steps on a logarithmic scale, each 0.6 of the one before. It is
/// given to the last step, `0.12 · 0.6⁸ = 0.2 %`.
fn best_factor(cost: impl Fn(f64) -> f64) -> (f64, f64) {
    let (mut factor, mut least) = (1.0, f64::INFINITY);
    for start in FACTORS {
        let found = cost(start);
        if found < least {
            (factor, least) = (start, found);
        }
    }
    let mut step = 0.12;
    for _ in 0..9 {
        for way in [libm::exp(step), libm::exp(-step)] {
            let found = cost(factor * way);
            if found < least {
                (factor, least) = (factor * way, found);
            }
        }
        step *= 0.6;
    }
    (factor, least)
}
