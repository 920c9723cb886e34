//! All limits of a problem in one place: as rows for the optimiser, and exactly at the end.

use super::basis::MotionBasis;
use super::certificate::Certificate;
use super::clearance::{ClearanceLimits, Scene};
use super::effort::{Channel, EffortLimits};
use super::error::ExcitationError;
use super::limit_kind::LimitKind;
use super::limit_rows::LimitRows;
use super::limits::{WorstUse, shrink_into_limits};
use super::margins::Margins;
use super::path_rows::{PathRows, use_on_ramps};
use super::problem::DesignProblem;
use super::rms_speed::RmsSpeed;
use super::termination::Termination;
use crate::model::Robot;
use crate::optimiser::{CombinedLimits, LinearLimits, Row, RowSource, SmoothLimits};
use crate::seed::Seed;
use crate::trajectory::{PeriodicTrajectory, Timeline};

/// Excess over the permitted torque, already a little below the allowed one, that counts as none.
pub(crate) const EXCESS_TOLERANCE: f64 = 1e-4;

/// What the optimiser keeps away from a linear limit, relative, so that its own tolerance never exceeds it.
const INSIDE: f64 = 1e-6;

/// The optimiser's tolerance for linear limits, relative.
const ROW_TOLERANCE: f64 = 1e-7;

/// Torque is sampled this many times as finely as the criterion.
const TORQUE_SAMPLES: usize = 2;

/// A first guess is not shrunk below this part of itself.
const START_FACTOR: f64 = 0.2;

/// Halvings in the search for what must be left of it.
const START_HALVINGS: usize = 7;

/// What a design is shrunk by at first where the optimiser's tolerances left something, and the halvings after that.
const FINISH: (f64, usize) = (1e-6, 3);

/// Other first guesses that are tried where one does not keep its clearances.
const START_ATTEMPTS: u64 = 16;

/// Samples of a period, and of the ramps as densely, at which the search for their peaks begins.
const RAMP_SAMPLES: usize = 500;

/// All linear limits.
pub(crate) struct AllRows {
    period: LimitRows,
    paths: PathRows,
}

impl RowSource for AllRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        self.period.violated(step, rows);
        self.paths.violated(step, rows);
    }
}

impl LinearLimits for AllRows {
    fn recenter(&mut self, x: &[f64]) {
        self.period.recenter(x);
        self.paths.recenter(x);
    }
}

/// The limits of a design problem.
pub(crate) struct Feasibility {
    robot: Robot,
    pub(crate) basis: MotionBasis,
    margins: Margins,
    pub(crate) linear: AllRows,
    timeline: Timeline,
    pub(crate) smooth: CombinedLimits,
    /// Without a payload, and with it where there is one.
    efforts: Vec<EffortLimits>,
    samples: usize,
    rms_speed: Option<f64>,
}

impl Feasibility {
    pub(crate) fn new(problem: &DesignProblem) -> Result<Self, ExcitationError> {
        let basis = problem.basis().clone();
        let robot = problem.inner_robot.clone();
        let allowed = &problem.limits().margins;
        let part = 1.0 - INSIDE;
        let margins = Margins {
            position: part * allowed.position,
            velocity: part * allowed.velocity,
            acceleration: part * allowed.acceleration,
            torque: (1.0 - 2.0 * EXCESS_TOLERANCE) * allowed.torque,
        };
        let samples = TORQUE_SAMPLES * problem.samples();
        let models = problem.efforts().into_iter().chain(problem.payload_efforts());
        let of = |model| {
            let timeline = problem.timeline(basis.period_s());
            EffortLimits::new(model, &Channel::all(&robot), &basis, timeline, samples, margins.torque)
        };
        let efforts: Vec<EffortLimits> = models.map(of).collect();
        let mut smooth = CombinedLimits::default();
        for effort in &efforts {
            smooth.limits.push(Box::new(effort.clone()));
        }
        if let Some(clearance) = problem.limits().clearance_m {
            let scene = Scene::new(&robot);
            if !scene.pairs.is_empty() {
                smooth.limits.push(Box::new(ClearanceLimits::new(scene, &basis, samples, clearance)));
            }
        }
        let rms_speed = problem.limits().rms_speed;
        if let Some(most) = rms_speed {
            smooth.limits.push(Box::new(RmsSpeed::new(&robot, &basis, samples, (1.0 - 2.0 * EXCESS_TOLERANCE) * most)));
        }
        let timeline = problem.timeline(basis.period_s());
        let linear = AllRows {
            period: LimitRows::new(&robot, &basis, &margins, ROW_TOLERANCE),
            paths: PathRows::new(&robot, &basis, timeline, &margins, ROW_TOLERANCE),
        };
        Ok(Self { robot, basis, margins, timeline, linear, smooth, efforts, samples, rms_speed })
    }

    /// The first guess number `index`, inside the limits. Where clearances are asked for and it does not keep them, a few
    /// others are drawn in its place: the first that does, or the one that lacks least.
    pub(crate) fn first_guess(
        &mut self,
        problem: &DesignProblem,
        seed: Seed,
        index: u64,
    ) -> Result<PeriodicTrajectory, ExcitationError> {
        let mut best = self.bring_inside(problem.start(seed, index)?);
        let attempts = if problem.limits().clearance_m.is_some() { START_ATTEMPTS } else { 0 };
        let mut least = self.smooth.excess(&self.basis.coefficients(&best)?);
        for attempt in 0..attempts {
            if least <= EXCESS_TOLERANCE {
                break;
            }
            let other = self.bring_inside(problem.start(seed.child("first guess", index), attempt)?);
            let excess = self.smooth.excess(&self.basis.coefficients(&other)?);
            if excess < least {
                (best, least) = (other, excess);
            }
        }
        Ok(best)
    }

    /// Brings a first guess inside all limits: joint by joint, then all amplitudes by one factor until torque holds.
    ///
    /// Where that would leave hardly any motion, only the other limits are brought to hold: the optimiser finds its
    /// way back inside more easily than away from rest.
    pub(crate) fn bring_inside(&mut self, mut trajectory: PeriodicTrajectory) -> PeriodicTrajectory {
        self.shrink_for_motion(&mut trajectory);
        self.shrink_for_torque(trajectory, self.samples, START_FACTOR, (1.0 - START_FACTOR, START_HALVINGS))
    }

    /// The last exact correction: what the optimiser's tolerances left is shrunk away.
    pub(crate) fn finish(&mut self, mut trajectory: PeriodicTrajectory) -> PeriodicTrajectory {
        self.shrink_for_motion(&mut trajectory);
        // Ten times the optimiser's own grid, and refined in time.
        self.shrink_for_torque(trajectory, 10 * self.samples, 0.0, FINISH)
    }

    /// Brings every joint inside its limits of position, velocity, acceleration and jerk, ramps included, and all inside the RMS speed.
    fn shrink_for_motion(&self, trajectory: &mut PeriodicTrajectory) {
        shrink_into_limits(&self.robot, trajectory, &self.margins);
        for (j, joint) in self.robot.joints().iter().enumerate() {
            let uses = use_on_ramps(&joint.limits, trajectory, j, self.timeline, RAMP_SAMPLES);
            let most =
                uses.into_iter().flatten().map(|used| used.ratio / self.margins.acceleration).fold(0.0, f64::max);
            if most > 1.0 {
                trajectory.adjust(j, 1.0 / most, 0.0);
            }
        }
        if let Some(most) = self.rms_speed {
            let factor = RmsSpeed::factor(&self.robot, trajectory, RAMP_SAMPLES, most);
            (0..trajectory.dof()).for_each(|joint| trajectory.adjust(joint, factor, 0.0));
        }
    }

    /// Shrinks all amplitudes by the largest factor that brings torque inside: first by `1 − gap`, then by gaps four times
    /// as large until it is inside, then between by so many halvings.
    ///
    /// A trajectory that would have to shrink below `least` stays as it is.
    fn shrink_for_torque(
        &mut self,
        trajectory: PeriodicTrajectory,
        samples: usize,
        least: f64,
        (mut gap, halvings): (f64, usize),
    ) -> PeriodicTrajectory {
        let efforts = &mut self.efforts;
        let mut holds = |candidate: &PeriodicTrajectory| {
            efforts.iter_mut().all(|effort| effort.holds(candidate, samples, 1.0 + EXCESS_TOLERANCE))
        };
        if holds(&trajectory) {
            return trajectory;
        }
        let (mut inside, mut outside) = (1.0 - gap, 1.0);
        while !holds(&scaled(&trajectory, inside)) {
            if inside <= least {
                return trajectory;
            }
            gap *= 4.0;
            (outside, inside) = (inside, (1.0 - gap).max(least));
        }
        for _ in 0..halvings {
            let middle = 0.5 * (inside + outside);
            if holds(&scaled(&trajectory, middle)) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        scaled(&trajectory, inside)
    }

    /// What is still exceeded most by a trajectory and its certificate, if anything.
    pub(crate) fn verdict(
        &self,
        problem: &DesignProblem,
        trajectory: &PeriodicTrajectory,
        certificate: &Certificate,
    ) -> Option<Termination> {
        let worst = &certificate.worst;
        let loaded = problem.payload_use(trajectory).unwrap_or_default();
        let with_payload = [
            (LimitKind::Torque, loaded.torque.map(|used| used.peak)),
            (LimitKind::TorqueRms, loaded.torque.map(|used| used.mean_square)),
            (LimitKind::Current, loaded.current.map(|used| used.peak)),
            (LimitKind::CurrentRms, loaded.current.map(|used| used.mean_square)),
        ];
        let certified = LimitKind::ALL.map(|limit| (limit, worst.for_limit(limit)));
        let limits = certified.into_iter().chain(with_payload).filter_map(|(limit, worst)| {
            let part = limit.permitted(&problem.limits().margins);
            let worst = worst.filter(|worst| worst.ratio > part)?;
            let joint = self.robot.joints()[worst.joint].name.clone();
            Some((worst.ratio / part, Termination::Infeasible { limit, joint, worst }))
        });
        let clearance = worst.clearance.as_ref().zip(problem.limits().clearance_m).and_then(|(nearest, required)| {
            let short = required - nearest.distance_m;
            let worst = WorstUse {
                ratio: 1.0 + short,
                joint: self.robot.joint_index(&nearest.pair[1]).unwrap_or(0),
                t: nearest.t,
                value: nearest.distance_m,
                limit: required,
            };
            let joint = nearest.pair.join(" to ");
            (short > 0.0)
                .then_some((1.0 + short, Termination::Infeasible { limit: LimitKind::Clearance, joint, worst }))
        });
        // What the problem lacks most: a design that cannot hold one limit often lets others slip a little as well.
        let exceeded = limits.chain(clearance).max_by(|x, y| x.0.total_cmp(&y.0));
        exceeded.map(|(_, termination)| termination)
    }
}

/// All amplitudes times a factor; the mean positions stay.
fn scaled(trajectory: &PeriodicTrajectory, factor: f64) -> PeriodicTrajectory {
    let mut scaled = trajectory.clone();
    for joint in 0..scaled.dof() {
        scaled.adjust(joint, factor, 0.0);
    }
    scaled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{CriterionKind, DesignLimits};
    use crate::model::Columns;

    #[test]
    fn identity_where_no_first_guess_keeps_its_clearance_the_one_that_lacks_least_is_taken() {
        // No motion of this arm keeps its forearm so far from its base.
        let limits = DesignLimits { clearance_m: Some(0.4), ..DesignLimits::motion() };
        let problem = DesignProblem::new(chains::crs_a460(), Columns::RIGID, CriterionKind::DOptimal, limits).unwrap();
        let mut feasibility = Feasibility::new(&problem).unwrap();
        let (seed, index) = (Seed::new(7), 0);
        let excess = |feasibility: &mut Feasibility, guess: &PeriodicTrajectory| {
            let x = feasibility.basis.coefficients(guess).unwrap();
            feasibility.smooth.excess(&x)
        };
        let starts = (0..START_ATTEMPTS).map(|attempt| problem.start(seed.child("first guess", index), attempt));
        let all: Vec<f64> = std::iter::once(problem.start(seed, index))
            .chain(starts)
            .map(|start| {
                let guess = feasibility.bring_inside(start.unwrap());
                excess(&mut feasibility, &guess)
            })
            .collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > EXCESS_TOLERANCE && least < all[0], "{all:?}");
        let taken = feasibility.first_guess(&problem, seed, index).unwrap();
        assert_eq!(excess(&mut feasibility, &taken), least);
    }
}
