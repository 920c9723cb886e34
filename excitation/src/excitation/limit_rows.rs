//! Limits of position, velocity and acceleration as linear rows, at the true extrema of a trial step.
//!
//! ```text
//! row(θ)ᵀ (x + d) ≤ limit   for all θ        →        row(θ*)ᵀ d ≤ limit − row(θ*)ᵀ x   at each local peak θ* of x + d
//! ```
//! The rows are constant, and each touches the variables of one joint only. Peaks are found on a grid of the joint's
//! own shapes and polished by Newton steps, so that a limit holds between samples, not only on them.

use std::f64::consts::TAU;

use super::basis::MotionBasis;
use super::limits::permitted;
use super::margins::Margins;
use super::sampled::ShapeTable;
use crate::linalg::dot;
use crate::model::{Joint, Robot};
use crate::optimiser::{LinearLimits, Row, RowSource};
use crate::trajectory::Quantity;

/// The limits of a robot as a source of rows around the current variables.
#[derive(Clone, Debug)]
pub struct LimitRows {
    basis: MotionBasis,
    /// Interval of each quantity of each joint, already inside the limit by the margin.
    intervals: Vec<[(f64, f64); 3]>,
    /// The shapes of the basis on a grid of their own.
    tables: Vec<ShapeTable>,
    center: Vec<f64>,
    /// Excess that counts as none, relative to the size of the interval.
    tolerance: f64,
}

impl LimitRows {
    /// The limits of `robot`, of which the parts `margins` may be used; excess up to `tolerance` relative to the limit
    /// counts as none.
    pub fn new(robot: &Robot, basis: &MotionBasis, margins: &Margins, tolerance: f64) -> Self {
        let interval = |joint: &Joint| Quantity::ALL.map(|of| permitted(&joint.limits, of, margins.part(of)));
        let intervals = robot.joints().iter().map(interval).collect();
        let tables = basis.shapes.iter().map(|shape| ShapeTable::new(&**shape, shape.grid())).collect();
        Self { basis: basis.clone(), intervals, tables, center: vec![0.0; basis.variables()], tolerance }
    }

    /// One row, at a phase, for the upper (`sign` = 1) or lower (−1) end of the interval.
    fn row(&self, joint: usize, quantity: Quantity, phase: f64, sign: f64) -> Row {
        let normal = self.basis.row(joint, quantity, phase, sign);
        let start = self.basis.range(joint).start;
        let (low, high) = self.intervals[joint][quantity as usize];
        let end = if sign > 0.0 { high } else { -low };
        let now = dot(&normal, &self.center[start..]);
        Row { start, normal, bound: end - now }
    }

    /// Rows at the local peaks of `sign · values` that exceed the interval; values are those on the grid, between the last
    /// and the first of them once more.
    fn peaks(&self, joint: usize, quantity: Quantity, sign: f64, x: &[f64], values: &[f64], rows: &mut Vec<Row>) {
        let (low, high) = self.intervals[joint][quantity as usize];
        let end = if sign > 0.0 { high } else { -low };
        let size = if low.is_finite() && high.is_finite() { 0.5 * (high - low) } else { end.abs().max(1.0) };
        let count = values.len() - 2;
        let mut room = vec![0.0; x.len()];
        for (k, around) in values.windows(3).enumerate() {
            let [before, here, after] = [sign * around[0], sign * around[1], sign * around[2]];
            if here < before || here <= after {
                continue;
            }
            // The vertex of the parabola through three points, with room for its error.
            let (slope, curvature) = (0.5 * (after - before), before - 2.0 * here + after);
            let shift = if curvature < 0.0 { (-slope / curvature).clamp(-1.0, 1.0) } else { 0.0 };
            let estimate = here + 0.5 * slope * shift;
            if estimate + 0.05 * (estimate - before.min(after)) <= end {
                continue;
            }
            let step = TAU / count as f64;
            let polished = self.polish(joint, quantity, sign, x, step * (k as f64 + shift), step);
            let mut value = |phase: f64| {
                self.basis.fill_derivative_row(joint, quantity as usize, phase, &mut room);
                sign * dot(&room, x)
            };
            // At a knot a spline's acceleration has a corner, which no Newton step finds; the grid holds all knots.
            let corner = step * k as f64;
            let phase = if value(corner) > value(polished) { corner } else { polished };
            let row = self.row(joint, quantity, phase, sign);
            let value = dot(&row.normal, x);
            if value - end > self.tolerance * size {
                rows.push(row);
            }
        }
    }

    /// Newton steps to a local peak of `sign · quantity` from a phase near it, each of at most `reach`. The limit is held
    /// wherever they end: the row of any phase is a true one, and the next program asks again for the rows it breaks.
    fn polish(&self, joint: usize, quantity: Quantity, sign: f64, x: &[f64], from: f64, reach: f64) -> f64 {
        let (omega, order) = (self.basis.omega(), quantity as usize);
        let (mut phase, mut room) = (from, vec![0.0; x.len()]);
        let mut derivative = |order: usize, phase: f64| {
            self.basis.fill_derivative_row(joint, order, phase, &mut room);
            dot(&room, x)
        };
        for _ in 0..4 {
            let (slope, curvature) = (derivative(order + 1, phase), derivative(order + 2, phase));
            if sign * curvature >= 0.0 {
                break;
            }
            let step = (-omega * slope / curvature).clamp(-reach, reach);
            phase += step;
            if step.abs() < 1e-9 {
                break;
            }
        }
        phase
    }
}

/// How high the peaks of `values` and of their negatives can come at most, by a look at all values without a branch. The vertex of the
/// parabola through a peak and its neighbours is above it by at most an eighth of the larger difference, and a twentieth of the whole is
/// added as room.
fn highest_peaks(values: &[f64]) -> [f64; 2] {
    const ROOM: f64 = 0.2;
    let least = |a: f64, b: f64| if a < b { a } else { b };
    let most = |a: f64, b: f64| if a > b { a } else { b };
    let (mut up, mut down) = ([f64::NEG_INFINITY; WIDE], [f64::NEG_INFINITY; WIDE]);
    let mut look = |before: &[f64], here: &[f64], after: &[f64]| {
        for (k, (up, down)) in up.iter_mut().zip(&mut down).enumerate().take(here.len()) {
            let (before, here, after) = (before[k], here[k], after[k]);
            *up = most(*up, here + ROOM * (here - least(before, after)));
            *down = most(*down, ROOM * (most(before, after) - here) - here);
        }
    };
    let count = values.len() - 2;
    let whole = count - count % WIDE;
    for k in (0..whole).step_by(WIDE) {
        look(&values[k..k + WIDE], &values[k + 1..k + 1 + WIDE], &values[k + 2..k + 2 + WIDE]);
    }
    look(&values[whole..count], &values[whole + 1..=count], &values[whole + 2..]);
    [up, down].map(|peaks| peaks.into_iter().fold(f64::NEG_INFINITY, most))
}

/// Running maxima of [`highest_peaks`].
const WIDE: usize = 4;

impl RowSource for LimitRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        let (mut values, mut closed) = (Vec::new(), Vec::new());
        let moved: Vec<f64> = self.center.iter().zip(step).map(|(c, d)| c + d).collect();
        for joint in 0..self.basis.dof() {
            let range = self.basis.range(joint);
            if range.is_empty() {
                continue;
            }
            let coefficients = self.basis.unscaled(joint, &moved);
            for quantity in Quantity::ALL {
                self.tables[self.basis.joints[joint].shape].motion(quantity as usize, &coefficients, &mut values);
                closed.clear();
                closed.extend(values.last());
                closed.extend_from_slice(&values);
                closed.extend(values.first());
                let (low, high) = self.intervals[joint][quantity as usize];
                let [up, down] = highest_peaks(&closed);
                for (sign, highest, end) in [(1.0, up, high), (-1.0, down, -low)] {
                    if highest >= end {
                        self.peaks(joint, quantity, sign, &moved[range.clone()], &closed, rows);
                    }
                }
            }
        }
    }
}

impl LinearLimits for LimitRows {
    fn recenter(&mut self, x: &[f64]) {
        self.center.copy_from_slice(x);
    }
}
