//! The search over nodes and parameters, in stages.
//!
//! Each stage weighs gaps by 10^{2k} over their size at its beginning, so that in the last the intervals are one motion, and residuals
//! by theirs. Only in the first, where nodes still lie on what was measured, residuals say nothing of that: they count by a part of
//! their output's spread.

use nalgebra::DVector;

use super::interval::{Interval, Point, Weights};
use super::step::step;
use crate::estimation::error::EstimationError;

/// Stages, and the factor of the weight of gaps between them.
const STAGES: i32 = 5;
const FACTOR: f64 = 100.0;
/// Steps of a stage at most, as of the full ones after them; evaluations of all intervals in all stages.
const STEPS: usize = 30;
const EVALUATIONS: usize = 150;
/// Damping at the least, so that combinations that nothing depends on stay where they are, at the most, and the factor between.
const LEAST_DAMPING: f64 = 1e-8;
const MOST_DAMPING: f64 = 1e4;
const DAMPING_FACTOR: f64 = 10.0;
/// Part of the cost that a step must gain for another one to be tried.
const GAIN: f64 = 1e-4;
/// Part of a stage's first cost at which nothing is left of it but rounding.
const NOTHING: f64 = 1e-24;
/// Largest gap, over the spread of that number along the motion, at which intervals are one motion.
pub(super) const CLOSED: f64 = 1e-6;
/// Size of a residual in the first stage, and at the least in the others, over the spread of its output.
const FIRST_RESIDUAL: f64 = 1e-2;
const LEAST_RESIDUAL: f64 = 1e-8;
/// Spread of an output or a number of the state, over that of the largest of its kind, below which it counts as that.
const LEAST_SHARE: f64 = 1e-6;

/// Where a search ended.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) point: Point,
    /// Largest gap, over the spread of that number along the motion.
    pub(super) gap: f64,
}

/// Linearises all intervals at a point, or says why it cannot be simulated.
pub(super) type LinearisePoint<'a> = dyn Fn(&Point) -> Result<Vec<Interval>, EstimationError> + 'a;

/// Follows steps from a point whose intervals are known. Outputs, in turn, have these standard deviations along the motion; states are
/// groups of `group` numbers of one kind.
pub(super) fn search(
    start: (Point, Vec<Interval>),
    (outputs, group): (&DVector<f64>, usize),
    linearise: &LinearisePoint<'_>,
    is_rejected: impl Fn(&EstimationError) -> bool + Copy,
) -> Result<Found, EstimationError> {
    let (mut reached, mut left) = (start, EVALUATIONS);
    let (outputs, spread) = (at_least_a_share(outputs, outputs.len()), spread(&reached.0, group));
    let weights = |(point, at): &(Point, Vec<Interval>), stage: i32| {
        let sizes = if stage == 0 { &outputs * FIRST_RESIDUAL } else { residual_sizes(at, &outputs) };
        let gaps = gap_size(point, at, &spread).max(CLOSED);
        Weights {
            outputs: sizes.map(|size| 1.0 / size),
            gap: spread.map(|spread| FACTOR.powi(stage) / (gaps * spread)),
            light_gap: spread.map(|spread| 1.0 / (FIRST_RESIDUAL * spread)),
        }
    };
    for stage in 0..STAGES {
        if stage > 0 && largest_gap(&reached, &spread) <= CLOSED {
            break;
        }
        let weights = weights(&reached, stage);
        reached = descended(reached, &weights, &mut left, linearise, is_rejected)?;
    }
    let weights = Weights { gap: spread.map(|spread| 1.0 / (CLOSED * spread)), ..weights(&reached, 1) };
    let reached = full_steps(reached, &weights, &spread, linearise, is_rejected)?;
    let gap = largest_gap(&reached, &spread);
    Ok(Found { point: reached.0, gap })
}

/// Damped steps by these weights until they gain little, no step lowers the cost, or no evaluation is `left`.
fn descended(
    (mut point, mut at): (Point, Vec<Interval>),
    weights: &Weights,
    left: &mut usize,
    linearise: &LinearisePoint<'_>,
    is_rejected: impl Fn(&EstimationError) -> bool,
) -> Result<(Point, Vec<Interval>), EstimationError> {
    let mut cost = cost(&point, &at, weights);
    let nothing = cost * NOTHING;
    let (mut damping, mut steps) = (LEAST_DAMPING, 0);
    while *left > 0 && damping <= MOST_DAMPING && steps < STEPS {
        *left -= 1;
        let trial = point.moved_by(&step(&point, &at, weights, damping));
        match linearise(&trial) {
            Ok(found) => {
                let trial_cost = self::cost(&trial, &found, weights);
                if trial_cost < cost {
                    let gain = 1.0 - trial_cost / cost;
                    (point, at, cost) = (trial, found, trial_cost);
                    steps += 1;
                    if gain < GAIN || cost <= nothing {
                        break;
                    }
                    damping = (damping / (DAMPING_FACTOR * DAMPING_FACTOR)).max(LEAST_DAMPING);
                } else {
                    damping *= DAMPING_FACTOR;
                }
            }
            Err(error) if is_rejected(&error) => damping *= DAMPING_FACTOR,
            Err(error) => return Err(error),
        }
    }
    Ok((point, at))
}

/// Full steps while each is shorter than half of the one before: a cost that gaps weigh heavily on lets no step follow their curve.
fn full_steps(
    (mut point, mut at): (Point, Vec<Interval>),
    weights: &Weights,
    spread: &DVector<f64>,
    linearise: &LinearisePoint<'_>,
    is_rejected: impl Fn(&EstimationError) -> bool,
) -> Result<(Point, Vec<Interval>), EstimationError> {
    let mut length_before = f64::INFINITY;
    for _ in 0..STEPS {
        let moved = step(&point, &at, weights, LEAST_DAMPING);
        let length = moved.nodes.iter().map(|x| x.component_div(spread).norm_squared()).sum::<f64>().sqrt();
        if length == 0.0 || length > 0.5 * length_before {
            break;
        }
        let trial = point.moved_by(&moved);
        match linearise(&trial) {
            Ok(found) => (point, at, length_before) = (trial, found, length),
            Err(error) if is_rejected(&error) => break,
            Err(error) => return Err(error),
        }
    }
    Ok((point, at))
}

fn cost(point: &Point, intervals: &[Interval], weights: &Weights) -> f64 {
    let of = |(j, interval): (usize, &Interval)| interval.squares(point.nodes.get(j + 1), weights);
    intervals.iter().enumerate().map(of).map(|(residual, gap)| residual + gap).sum()
}

/// Standard deviation of each number of the state over the nodes.
fn spread(point: &Point, group: usize) -> DVector<f64> {
    let count = point.nodes.len() as f64;
    let size = point.nodes.first().map_or(0, DVector::len);
    let mean = point.nodes.iter().fold(DVector::zeros(size), |sum, x| sum + x) / count;
    let square = point.nodes.iter().fold(DVector::zeros(size), |sum, x| sum + (x - &mean).map(|v| v * v)) / count;
    at_least_a_share(&square.map(f64::sqrt), group)
}

/// These numbers, none below a share of the largest of its group.
fn at_least_a_share(sizes: &DVector<f64>, group: usize) -> DVector<f64> {
    let largest = |i: usize| {
        let first = i - i % group;
        sizes.iter().skip(first).take(group).fold(f64::MIN_POSITIVE, |most, size| most.max(*size))
    };
    DVector::from_fn(sizes.len(), |i, _| sizes[i].max(LEAST_SHARE * largest(i)))
}

fn gaps<'a>(point: &'a Point, intervals: &'a [Interval]) -> impl Iterator<Item = DVector<f64>> + 'a {
    intervals.iter().enumerate().filter_map(|(j, interval)| interval.gap(point.nodes.get(j + 1)))
}

fn largest_gap((point, intervals): &(Point, Vec<Interval>), spread: &DVector<f64>) -> f64 {
    gaps(point, intervals).fold(0.0, |most, gap| gap.component_div(spread).amax().max(most))
}

/// Root mean square of the gaps, over the spread of each number.
fn gap_size(point: &Point, intervals: &[Interval], spread: &DVector<f64>) -> f64 {
    let add = |(sum, count), gap: DVector<f64>| (sum + gap.component_div(spread).norm_squared(), count + gap.len());
    let (sum, count): (f64, usize) = gaps(point, intervals).fold((0.0, 0), add);
    (sum / count.max(1) as f64).sqrt()
}

/// Root mean square of each output's residual.
fn residual_sizes(intervals: &[Interval], outputs: &DVector<f64>) -> DVector<f64> {
    let count = outputs.len();
    let mut squares: DVector<f64> = DVector::zeros(count);
    let mut rows = 0_usize;
    for interval in intervals {
        for (row, r) in interval.residual.iter().enumerate() {
            squares[row % count] += r * r;
        }
        rows += interval.residual.len() / count;
    }
    squares.zip_map(outputs, |square, output| (square / rows.max(1) as f64).sqrt().max(LEAST_RESIDUAL * output))
}
