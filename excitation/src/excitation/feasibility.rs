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
use crate::optimiser::{CombinedLimits, LinearLimits, Row, RowSource, SmoothLimits, nearest_inside};
use crate::seed::Seed;
use crate::trajectory::{PeriodicTrajectory, Timeline};

/// Excess over the permitted torque, already a little below the allowed one, that counts as none.
pub(crate) const EXCESS_TOLERANCE: f64 = 1e-4;

/// What is kept away from a linear limit, relative, so that the tolerance of [`FINAL`] never exceeds it; that of a search may.
const INSIDE: f64 = 1e-6;

/// How closely limits are looked at.
struct Accuracy {
    /// Torque is sampled this many times as finely as the criterion.
    samples: usize,
    /// Excess over a linear limit, relative, that counts as none.
    rows: f64,
}

/// During a search. With rows held to 1e-7 its quadratic programs would exchange three times as many of them.
const SEARCH: Accuracy = Accuracy { samples: 2, rows: 1e-4 };

/// Of the motion that it ends with.
const FINAL: Accuracy = Accuracy { samples: 20, rows: 1e-7 };

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
    pub(crate) fn new(problem: &DesignProblem) -> Self {
        Self::with(problem, SEARCH)
    }

    fn with(problem: &DesignProblem, accuracy: Accuracy) -> Self {
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
        let samples = accuracy.samples * problem.samples();
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
            period: LimitRows::new(&robot, &basis, &margins, accuracy.rows),
            paths: PathRows::new(&robot, &basis, timeline, &margins, accuracy.rows),
        };
        Self { robot, basis, margins, timeline, linear, smooth, efforts, samples, rms_speed }
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
        self.shrink_for_torque(trajectory, START_FACTOR, (1.0 - START_FACTOR, START_HALVINGS))
    }

    /// The motion of a search's end, exactly inside: what the search's tolerances left outside linear limits is shrunk away, joint by
    /// joint. Where another limit is still exceeded, the nearest motion inside all of them takes its place.
    ///
    /// Smaller amplitudes would not do for torque: where gravity and friction fill a limit, hardly any motion is left until a
    /// thousandth of excess is gone.
    pub(crate) fn finished(problem: &DesignProblem, x: &[f64]) -> Result<PeriodicTrajectory, ExcitationError> {
        let mut limits = Self::with(problem, FINAL);
        let mut trajectory = limits.basis.trajectory(x);
        limits.shrink_for_motion(&mut trajectory);
        if limits.smooth.excess(&limits.basis.coefficients(&trajectory)?) <= EXCESS_TOLERANCE {
            return Ok(trajectory);
        }
        if let Some(x) = nearest_inside(x, &mut limits.linear, &mut limits.smooth, 0.5 * EXCESS_TOLERANCE) {
            trajectory = limits.basis.trajectory(&x);
            limits.shrink_for_motion(&mut trajectory);
        }
        Ok(limits.shrink_for_torque(trajectory, 0.0, FINISH))
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

    /// Whether torques and currents are inside, within the tolerance.
    fn holds(&mut self, trajectory: &PeriodicTrajectory) -> bool {
        self.efforts.iter_mut().all(|effort| effort.holds(trajectory, self.samples, 1.0 + EXCESS_TOLERANCE))
    }

    /// Shrinks all amplitudes by the largest factor that brings torque inside: first by `1 − gap`, then by gaps four times
    /// as large until it is inside, then between by so many halvings.
    ///
    /// A trajectory that would have to shrink below `least` stays as it is.
    fn shrink_for_torque(
        &mut self,
        trajectory: PeriodicTrajectory,
        least: f64,
        (mut gap, halvings): (f64, usize),
    ) -> PeriodicTrajectory {
        if self.holds(&trajectory) {
            return trajectory;
        }
        let (mut inside, mut outside) = (1.0 - gap, 1.0);
        while !self.holds(&scaled(&trajectory, inside)) {
            if inside <= least {
                return trajectory;
            }
            gap *= 4.0;
            (outside, inside) = (inside, (1.0 - gap).max(least));
        }
        for _ in 0..halvings {
            let middle = 0.5 * (inside + outside);
            if self.holds(&scaled(&trajectory, middle)) {
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
    use crate::excitation::{CriterionKind, DesignLimits, DesignSpace};
    use crate::model::{Columns, Joint};
    use crate::trajectory::Family;

    #[test]
    fn identity_where_no_first_guess_keeps_its_clearance_the_one_that_lacks_least_is_taken() {
        // No motion of this arm keeps its forearm so far from its base.
        let limits = DesignLimits { clearance_m: Some(0.4), ..DesignLimits::motion() };
        let problem = DesignProblem::new(chains::crs_a460(), Columns::RIGID, CriterionKind::DOptimal, limits).unwrap();
        let mut feasibility = Feasibility::new(&problem);
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

    #[test]
    fn identity_a_motion_that_gravity_holds_outside_is_moved_inside_and_not_shrunk_to_rest() {
        // So slowly that the shoulder's torque is that of its load, held around the horizontal, and of friction.
        let with_shoulder = |torque: f64| {
            let shoulder = |joint: &mut Joint| {
                if joint.name == "shoulder" {
                    (joint.limits.position, joint.limits.torque) = ((-3.0, 3.0), torque);
                }
            };
            chains::crs_a460().with_joints(shoulder).unwrap()
        };
        let limits = DesignLimits { nominal: Some(chains::crs_a460_nominal()), ..DesignLimits::motion() };
        let problem_of = |robot: Robot| {
            let mut problem =
                DesignProblem::new(robot, Columns::RIGID, CriterionKind::DOptimal, limits.clone()).unwrap();
            problem.set_space(DesignSpace::new(Family::Fourier, 500.0, vec![5; 6])).unwrap();
            problem
        };
        let problem = problem_of(with_shoulder(100.0));
        let mut motion = Feasibility::new(&problem).bring_inside(problem.start(Seed::new(7), 0).unwrap());
        let states = motion.sample(100);
        for (joint, held) in [(1, std::f64::consts::FRAC_PI_2), (2, 0.0)] {
            let mean = (0..100).map(|k| states.q(k)[joint]).sum::<f64>() / 100.0;
            motion.adjust(joint, 0.2, held - mean);
        }
        let used = Certificate::new(&problem, &motion).unwrap().worst.torque.unwrap();
        let problem = problem_of(with_shoulder(used.value.abs() / (problem.limits().margins.torque * 1.001)));
        let x = problem.basis().coefficients(&motion).unwrap();
        let moved = |to: &PeriodicTrajectory| {
            let to = problem.basis().coefficients(to).unwrap();
            let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
            (square(&x.iter().zip(&to).map(|(x, y)| x - y).collect::<Vec<_>>()) / square(&x)).sqrt()
        };
        let finished = Feasibility::finished(&problem, &x).unwrap();
        let shrunk = Feasibility::with(&problem, FINAL).shrink_for_torque(motion, 0.0, FINISH);
        for motion in [&finished, &shrunk] {
            let used = Certificate::new(&problem, motion).unwrap().worst.torque.unwrap().ratio;
            let most = problem.limits().margins.torque;
            assert!(used <= most && used > 0.999 * most, "{used}");
        }
        assert!(moved(&finished) < 0.002 && moved(&shrunk) > 0.05, "{} {}", moved(&finished), moved(&shrunk));
    }
}
