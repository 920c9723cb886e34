//! Peak torque under the ratings: smooth limits of the trajectory, at the true peaks in time.
//!
//! ```text
//! |τ_i(t)| ≤ u r_i  for all t        τ = Y(q, q̇, q̈) φ_nominal, friction included        u = part of the rating r_i
//! ∂τ_i/∂x = Σ_j B_q(θ)ᵀ ∂τ_i/∂q_j + B_v(θ)ᵀ ∂τ_i/∂q̇_j + B_a(θ)ᵀ ∂τ_i/∂q̈_j          (regressor adjoint with G = e_i φᵀ)
//! ```
//! Torque is evaluated on a grid, and each local peak near the rating is refined in time, so the linearised rows stand
//! where torque is largest. At a peak the time derivative vanishes, and the partial derivatives are the total ones.
//! At a reversal Coulomb friction turns within milliseconds; there, too, only the peak beside it counts.

use std::f64::consts::TAU;

use super::PeriodicTrajectory;
use super::basis::MotionBasis;
use super::limits::WorstUse;
use super::optimiser::{Row, SmoothLimits};
use super::sampled::SampledBasis;
use super::trajectory::Trajectory;
use crate::dynamics::{Dynamics, States};
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;

/// Local peaks below this part of the permitted torque get no row.
const NEAR: f64 = 0.6;

/// Local peaks above this part are refined in time.
const REFINE: f64 = 0.95;

/// A local peak of one joint's torque.
#[derive(Clone, Copy, Debug)]
struct Peak {
    joint: usize,
    sign: f64,
    phase: f64,
    /// Torque over permitted torque.
    ratio: f64,
}

/// The ratings of a robot for one nominal parameter set.
#[derive(Clone, Debug)]
pub struct TorqueLimits {
    dynamics: Dynamics,
    regressor: JointTorqueRegressor,
    phi: Vec<f64>,
    /// Permitted torque of each joint, N·m.
    permitted: Vec<f64>,
    sampled: SampledBasis,
    states: States,
    /// Torque at the samples, N × n.
    tau: Vec<f64>,
    /// The point they belong to.
    at: Vec<f64>,
}

impl TorqueLimits {
    /// The part `use_at_most` of the ratings of `robot`, for torque computed with `nominal` on a grid of `samples`.
    ///
    /// # Panics
    /// If `nominal` is not of as many joints as the robot.
    #[must_use]
    pub fn new(
        robot: &Robot,
        nominal: &StandardParameters,
        basis: &MotionBasis,
        samples: usize,
        use_at_most: f64,
    ) -> Self {
        let n = robot.dof();
        let columns = Columns::RigidRotorFriction;
        Self {
            dynamics: Dynamics::new(robot, nominal),
            regressor: JointTorqueRegressor::new(robot, columns),
            phi: nominal.vector(robot, columns).iter().copied().collect(),
            permitted: robot.joints().iter().map(|joint| use_at_most * joint.limits.torque).collect(),
            sampled: SampledBasis::new(basis.clone(), samples),
            states: States::with_len(n, samples),
            tau: vec![0.0; n * samples],
            at: Vec::new(),
        }
    }

    /// The largest use of the permitted torque by a trajectory of any family, on a grid of `samples`, refined in time.
    pub fn worst(&mut self, trajectory: &PeriodicTrajectory, samples: usize) -> WorstUse {
        let states = trajectory.sample(samples);
        let tau = self.torques(&states);
        let peaks = self.peaks(trajectory, &tau, f64::NEG_INFINITY);
        let mut worst = WorstUse::NONE;
        for peak in peaks {
            worst = worst.worst_of(WorstUse {
                ratio: peak.ratio,
                joint: peak.joint,
                t: peak.phase / trajectory.omega(),
                value: peak.sign * peak.ratio * self.permitted[peak.joint],
                limit: peak.sign * self.permitted[peak.joint],
            });
        }
        worst
    }

    fn torques(&mut self, states: &States) -> Vec<f64> {
        let n = self.permitted.len();
        let mut tau = vec![0.0; n * states.len()];
        for (k, tau) in tau.chunks_exact_mut(n).enumerate() {
            self.dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
        tau
    }

    /// Evaluates the torque at the samples of `x`, unless it is there already.
    fn move_to(&mut self, x: &[f64]) {
        if self.at == x {
            return;
        }
        let mut states = std::mem::take(&mut self.states);
        self.sampled.states(x, &mut states);
        self.tau = self.torques(&states);
        self.states = states;
        self.at = x.to_vec();
    }

    /// Local peaks above `threshold` of a sampled torque, refined in time where they come near the rating.
    fn peaks(&mut self, trajectory: &PeriodicTrajectory, tau: &[f64], threshold: f64) -> Vec<Peak> {
        let n = self.permitted.len();
        let count = tau.len() / n;
        let mut peaks = Vec::new();
        for joint in 0..n {
            let permitted = self.permitted[joint];
            if !permitted.is_finite() {
                continue;
            }
            for sign in [1.0, -1.0] {
                let ratio = |k: usize| sign * tau[(k % count) * n + joint] / permitted;
                // The largest sample counts even where a constant torque has no peak.
                let top = (0..count).fold(0, |top, k| if ratio(k) > ratio(top) { k } else { top });
                for k in 0..count {
                    let (before, here, after) = (ratio(k + count - 1), ratio(k), ratio(k + 1));
                    let is_peak = k == top || (here >= before && here > after);
                    if !is_peak || here <= threshold {
                        continue;
                    }
                    let step = TAU / count as f64;
                    let peak = Peak { joint, sign, phase: k as f64 * step, ratio: here };
                    peaks.push(if here > REFINE { self.refine(trajectory, peak, step) } else { peak });
                }
            }
        }
        peaks
    }

    /// Golden section around a peak on the grid.
    fn refine(&mut self, trajectory: &PeriodicTrajectory, peak: Peak, step: f64) -> Peak {
        let n = self.permitted.len();
        let (mut q, mut qd, mut qdd, mut tau) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut ratio = |phase: f64| {
            trajectory.evaluate(phase / trajectory.omega(), &mut q, &mut qd, &mut qdd);
            self.dynamics.inverse(&q, &qd, &qdd, &mut tau);
            peak.sign * tau[peak.joint] / self.permitted[peak.joint]
        };
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let (mut low, mut high) = (peak.phase - step, peak.phase + step);
        let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let mut values = inner.map(&mut ratio);
        let mut best = peak;
        // 14 sections leave a thousandth of the step.
        for _ in 0..14 {
            let upper = values[1] > values[0];
            let (phase, value) = (inner[usize::from(upper)], values[usize::from(upper)]);
            if value > best.ratio {
                best = Peak { phase, ratio: value, ..best };
            }
            if upper {
                low = inner[0];
                inner = [inner[1], low + GOLDEN * (high - low)];
                values = [values[1], ratio(inner[1])];
            } else {
                high = inner[1];
                inner = [high - GOLDEN * (high - low), inner[0]];
                values = [ratio(inner[0]), values[0]];
            }
        }
        best
    }

    /// The peaks of the point `x` above `threshold`.
    fn peaks_at(&mut self, x: &[f64], threshold: f64) -> (PeriodicTrajectory, Vec<Peak>) {
        self.move_to(x);
        let trajectory = self.sampled.basis().trajectory(x);
        let tau = std::mem::take(&mut self.tau);
        let peaks = self.peaks(&trajectory, &tau, threshold);
        self.tau = tau;
        (trajectory, peaks)
    }
}

impl SmoothLimits for TorqueLimits {
    fn excess(&mut self, x: &[f64]) -> f64 {
        let (_, peaks) = self.peaks_at(x, REFINE);
        let mut worst = vec![0.0_f64; self.permitted.len()];
        for peak in peaks {
            worst[peak.joint] = worst[peak.joint].max(peak.ratio - 1.0);
        }
        worst.iter().sum()
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<Row>) {
        let (trajectory, peaks) = self.peaks_at(x, NEAR);
        let (n, p) = (self.permitted.len(), self.phi.len());
        let mut g = vec![0.0; n * p];
        let mut state = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let mut slopes = state.clone();
        for peak in peaks {
            let [q, qd, qdd] = &mut state;
            trajectory.evaluate(peak.phase / trajectory.omega(), q, qd, qdd);
            g.fill(0.0);
            let scale = peak.sign / self.permitted[peak.joint];
            for (g, phi) in g[peak.joint * p..(peak.joint + 1) * p].iter_mut().zip(&self.phi) {
                *g = scale * phi;
            }
            let [dq, dqd, dqdd] = &mut slopes;
            for slope in [&mut *dq, &mut *dqd, &mut *dqdd] {
                slope.fill(0.0);
            }
            self.regressor.adjoint(q, qd, qdd, &g, dq, dqd, dqdd);
            let mut normal = Vec::with_capacity(x.len());
            for j in 0..n {
                normal.extend(self.sampled.basis().combined_row(j, peak.phase, [dq[j], dqd[j], dqdd[j]]));
            }
            rows.push(Row { start: 0, normal, bound: 1.0 - peak.ratio });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Family, fixtures, paper_start};
    use crate::seed::Seed;

    #[test]
    fn identity_rows_are_the_slopes_of_the_peaks() {
        let robot = fixtures::crs_a460();
        let basis = MotionBasis::new(&robot, Family::Fourier, 10.0, &[5; 6], &[None; 6]).unwrap();
        let start = paper_start(&robot, 10.0, 5, Seed::new(2), 1).unwrap().into();
        let x = basis.coefficients(&start).unwrap();
        let mut limits = TorqueLimits::new(&robot, &fixtures::crs_a460_nominal(), &basis, 200, 0.5);
        let mut rows = Vec::new();
        limits.linearise(&x, &mut rows);
        let (_, peaks) = limits.peaks_at(&x, NEAR);
        assert!(rows.len() == peaks.len() && rows.len() > 10);
        let ratio = |limits: &mut TorqueLimits, x: &[f64], peak: &Peak| {
            let trajectory = limits.sampled.basis().trajectory(x);
            let (mut q, mut qd, mut qdd, mut tau) = ([0.0; 6], [0.0; 6], [0.0; 6], [0.0; 6]);
            trajectory.evaluate(peak.phase / trajectory.omega(), &mut q, &mut qd, &mut qdd);
            limits.dynamics.inverse(&q, &qd, &qdd, &mut tau);
            peak.sign * tau[peak.joint] / limits.permitted[peak.joint]
        };
        for (row, peak) in rows.iter().zip(&peaks) {
            assert!((row.bound - (1.0 - peak.ratio)).abs() < 1e-12);
            for i in (0..x.len()).step_by(5) {
                let mut at = |h: f64| {
                    let mut moved = x.clone();
                    moved[i] += h;
                    ratio(&mut limits, &moved, peak)
                };
                let h = 1e-4;
                let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                assert!((difference - row.normal[i]).abs() < 1e-7, "{difference} {}", row.normal[i]);
            }
        }
    }
}
