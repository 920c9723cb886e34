//! Limits of jerk, and of acceleration and jerk on the ramps, as linear rows at their true peaks.
//!
//! ```text
//! q̈ = r″ σ̇² + r′ σ̈        q⃛ = r‴ σ̇³ + 3 r″ σ̇ σ̈ + r′ σ⃛        |q̈| ≤ u q̈_max,   |q⃛| ≤ u q⃛_max
//! ```
//! The path r is linear in the variables, and σ is the timeline's own, so these rows are constant as well. On the period
//! σ̇ = 1, and acceleration is left to [`LimitRows`](super::LimitRows).

use super::basis::MotionBasis;
use super::limits::WorstUse;
use super::margins::Margins;
use crate::linalg::dot;
use crate::model::{Joint, Limits, Robot};
use crate::optimiser::{CurvePoint, LinearLimits, Row, RowSource, climb};
use crate::trajectory::{PeriodicTrajectory, Segment, Timeline};

/// Grid points of a period for each variable of the joint with the most, and of the ramps as densely.
const GRID_PER_VARIABLE: usize = 8;

/// Part of the permitted value above which a peak of the grid is refined.
const NEAR: f64 = 0.9;

/// How well the time of a peak is then known, in steps of the grid: that leaves 1e-9 of its value.
const REFINED: f64 = 1e-4;

/// What is limited on a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Watched {
    Acceleration,
    Jerk,
}

/// One limited quantity of one joint on one segment.
#[derive(Clone, Debug)]
struct Path {
    joint: usize,
    watched: Watched,
    segment: Segment,
    limit: f64,
    /// Rows on the grid, both ends of the segment among them, one after the other.
    grid: Vec<f64>,
    count: usize,
}

/// The limits of acceleration and jerk that the period's own rows do not hold.
#[derive(Clone, Debug)]
pub(crate) struct PathRows {
    basis: MotionBasis,
    timeline: Timeline,
    paths: Vec<Path>,
    center: Vec<f64>,
    tolerance: f64,
}

/// Weights of velocity, acceleration and jerk of the motion in what is watched.
fn weights(timeline: &Timeline, watched: Watched, segment: Segment, part: f64) -> (f64, [f64; 3]) {
    let point = timeline.point(segment, part);
    let (speed, acceleration) = (point.path_speed, point.path_acceleration);
    let weights = match watched {
        Watched::Acceleration => [acceleration, speed * speed, 0.0],
        Watched::Jerk => [point.path_jerk, 3.0 * speed * acceleration, speed * speed * speed],
    };
    (point.phase, weights)
}

impl PathRows {
    /// The limits of `robot`, of which the part of `margins` may be used.
    pub(crate) fn new(
        robot: &Robot,
        basis: &MotionBasis,
        timeline: Timeline,
        margins: &Margins,
        tolerance: f64,
    ) -> Self {
        let most = (0..basis.dof()).map(|joint| basis.range(joint).len()).max().unwrap_or(0);
        let mut rows =
            Self { basis: basis.clone(), timeline, paths: Vec::new(), center: vec![0.0; basis.variables()], tolerance };
        for (joint, j) in robot.joints().iter().enumerate().filter(|(joint, _)| !basis.range(*joint).is_empty()) {
            for &segment in timeline.segments() {
                for (watched, limit) in [(Watched::Acceleration, j.limits.acceleration), (Watched::Jerk, j.limits.jerk)]
                {
                    let held_elsewhere = segment == Segment::Period && watched == Watched::Acceleration;
                    if held_elsewhere || !limit.is_finite() {
                        continue;
                    }
                    let count = timeline.samples(segment, GRID_PER_VARIABLE * most) + 1;
                    let mut path =
                        Path { joint, watched, segment, limit: margins.acceleration * limit, grid: Vec::new(), count };
                    for k in 0..count {
                        path.grid.extend(rows.row(&path, k as f64 / (count - 1) as f64));
                    }
                    rows.paths.push(path);
                }
            }
        }
        rows
    }

    /// The row of what a path limits, after a part of its segment.
    fn row(&self, path: &Path, part: f64) -> Vec<f64> {
        let (phase, weights) = weights(&self.timeline, path.watched, path.segment, part);
        let mut sum = vec![0.0; self.basis.range(path.joint).len()];
        for (order, weight) in weights.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0) {
            for (sum, entry) in sum.iter_mut().zip(self.basis.derivative_row(path.joint, order + 1, phase)) {
                *sum += weight * entry;
            }
        }
        sum
    }
}

impl LinearLimits for PathRows {
    fn recenter(&mut self, x: &[f64]) {
        self.center.copy_from_slice(x);
    }
}

impl RowSource for PathRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        let moved: Vec<f64> = self.center.iter().zip(step).map(|(c, d)| c + d).collect();
        for path in &self.paths {
            let range = self.basis.range(path.joint);
            let x = &moved[range.clone()];
            let values: Vec<f64> = path.grid.chunks_exact(range.len()).map(|row| dot(row, x)).collect();
            for sign in [1.0, -1.0] {
                for part in peaks(&values, sign, NEAR * path.limit) {
                    let value = |part: f64| sign * dot(&self.row(path, part), x);
                    let top = refine(value, part, 1.0 / (path.count - 1) as f64);
                    if top.value - path.limit > self.tolerance * path.limit {
                        let normal: Vec<f64> = self.row(path, top.place).iter().map(|entry| sign * entry).collect();
                        let now = dot(&normal, &self.center[range.clone()]);
                        rows.push(Row { start: range.start, normal, bound: path.limit - now });
                    }
                }
            }
        }
    }
}

/// Parts of a segment at which `sign · values`, on an even grid with both ends, has a local peak above `threshold`.
fn peaks(values: &[f64], sign: f64, threshold: f64) -> impl Iterator<Item = f64> + '_ {
    let last = values.len() - 1;
    (0..=last).filter_map(move |k| {
        let at = |k: usize| sign * values[k];
        let rises = k == 0 || at(k) >= at(k - 1);
        let falls = k == last || at(k) > at(k + 1);
        (rises && falls && at(k) > threshold).then_some(k as f64 / last as f64)
    })
}

/// The top around a peak of a grid with this step, inside the segment.
fn refine(mut value: impl FnMut(f64) -> f64, part: f64, step: f64) -> CurvePoint {
    let from = CurvePoint { place: part, value: value(part) };
    climb(value, from, (part - step).max(0.0)..(part + step).min(1.0), REFINED * step)
}

/// The worst uses of one joint's acceleration and jerk limits on the ramps around a trajectory of any family; `None`
/// where there are no ramps or no such limit.
pub(crate) fn use_on_ramps(
    limits: &Limits,
    trajectory: &PeriodicTrajectory,
    joint: usize,
    timeline: Timeline,
    samples: usize,
) -> [Option<WorstUse>; 2] {
    let mut worst: [Option<WorstUse>; 2] = [None, None];
    let curves = [1, 2, 3].map(|order| trajectory.derivative(joint, order));
    let limited = [(Watched::Acceleration, limits.acceleration), (Watched::Jerk, limits.jerk)];
    for (worst, (watched, limit)) in worst.iter_mut().zip(limited).filter(|(_, (_, limit))| limit.is_finite()) {
        for &segment in timeline.segments().iter().filter(|segment| **segment != Segment::Period) {
            let value = |part: f64| {
                let (phase, weights) = weights(&timeline, watched, segment, part);
                curves.iter().zip(weights).map(|(curve, weight)| weight * curve.value(phase)).sum::<f64>()
            };
            let count = timeline.samples(segment, samples);
            let values: Vec<f64> = (0..=count).map(|k| value(k as f64 / count as f64)).collect();
            for sign in [1.0, -1.0] {
                for part in peaks(&values, sign, 0.0) {
                    let top = refine(|part| sign * value(part), part, 1.0 / count as f64);
                    let (t, value) = (timeline.time_s(segment, top.place), sign * top.value);
                    let here = WorstUse { ratio: top.value / limit, joint, t, value, limit: sign * limit };
                    *worst = WorstUse::worst_of_both(*worst, Some(here));
                }
            }
        }
    }
    worst
}

/// The worst uses of all joints, as [`use_on_ramps`].
pub(crate) fn worst_on_ramps(
    robot: &Robot,
    trajectory: &PeriodicTrajectory,
    timeline: Timeline,
    samples: usize,
) -> [Option<WorstUse>; 2] {
    let own = |(joint, j): (usize, &Joint)| use_on_ramps(&j.limits, trajectory, joint, timeline, samples);
    let uses = robot.joints().iter().enumerate().map(own);
    uses.fold([None; 2], |worst, own| [0, 1].map(|k| WorstUse::worst_of_both(worst[k], own[k])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{DesignSpace, radkhah2007_start};
    use crate::seed::Seed;
    use crate::trajectory::{Family, Trajectory};

    #[test]
    fn identity_ramp_accelerations_and_jerks_are_differences_of_positions() {
        let robot = chains::crs_a460();
        let motion: PeriodicTrajectory = radkhah2007_start(&robot, 10.0, 5, Seed::new(3), 0).unwrap().into();
        let timeline = Timeline { period_s: 10.0, ramp_s: Some(1.5) };
        let position = |segment: Segment, t: f64, joint: usize| {
            let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            let phase = timeline.point(segment, t / 1.5).phase;
            motion.evaluate(phase / motion.omega(), &mut q, &mut qd, &mut qdd);
            q[joint]
        };
        for (segment, t, joint) in [(Segment::RampIn, 0.4, 0), (Segment::RampIn, 1.2, 3), (Segment::RampOut, 0.5, 1)] {
            let h = 2e-3;
            let q: Vec<f64> = (-2..=2).map(|k| position(segment, t + f64::from(k) * h, joint)).collect();
            let second = (16.0 * (q[1] + q[3]) - (q[0] + q[4]) - 30.0 * q[2]) / (12.0 * h * h);
            let third = (q[4] - 2.0 * q[3] + 2.0 * q[1] - q[0]) / (2.0 * h * h * h);
            for (watched, expected) in [(Watched::Acceleration, second), (Watched::Jerk, third)] {
                let (phase, weights) = weights(&timeline, watched, segment, t / 1.5);
                let found: f64 = (0..3).map(|i| weights[i] * motion.derivative(joint, i + 1).value(phase)).sum();
                // h² times a fifth derivative of some hundreds, and rounding over h³.
                assert!((found - expected).abs() < 1e-3 * (1.0 + found.abs()), "{watched:?} {found} {expected}");
            }
        }
    }

    #[test]
    fn identity_rows_hold_what_the_ramps_and_the_jerk_ask() {
        let robot = chains::crs_a460().with_joints(|joint| joint.limits.jerk = 20.0).unwrap();
        let basis = MotionBasis::new(&robot, &DesignSpace::new(Family::Fourier, 10.0, vec![5; 6])).unwrap();
        let motion: PeriodicTrajectory = radkhah2007_start(&robot, 10.0, 5, Seed::new(3), 0).unwrap().into();
        let timeline = Timeline { period_s: 10.0, ramp_s: Some(0.4) };
        let mut source = PathRows::new(&robot, &basis, timeline, &Margins::default(), 1e-7);
        let x = basis.coefficients(&motion).unwrap();
        source.recenter(&x);
        let mut rows = Vec::new();
        source.violated(&vec![0.0; x.len()], &mut rows);
        let [acceleration, jerk] = worst_on_ramps(&robot, &motion, timeline, 500);
        let on_period = crate::excitation::limits::worst_jerk(&robot, &motion).unwrap();
        // The largest excess of the rows of all joints is that of the trajectory itself.
        let most = |limit: f64| {
            let excess = rows.iter().filter(|row| {
                let now = dot(&row.normal, &x[row.start..]);
                ((now + row.bound) - limit).abs() < 1e-9
            });
            excess.map(|row| -row.bound / limit + 1.0).fold(0.0, f64::max)
        };
        assert!((most(20.0) - jerk.unwrap().ratio.max(on_period.ratio)).abs() < 1e-6, "{} {jerk:?}", most(20.0));
        assert!((most(12.566) - acceleration.unwrap().ratio).abs() < 1e-6, "{} {acceleration:?}", most(12.566));
        for used in [acceleration.unwrap(), jerk.unwrap()] {
            assert!((used.value / used.limit - used.ratio).abs() < 1e-12, "{used:?}");
        }
        // A row for each excess, and none for what is inside.
        assert!(rows.iter().all(|row| row.bound < 0.0));
        // Both rows were needed.
        assert!(acceleration.unwrap().ratio > 1.1 && jerk.unwrap().ratio > 1.1, "{acceleration:?} {jerk:?}");
    }
}
