//! A Fourier series that starts and stops at rest.
//!
//! ```text
//! q(t) = F(t) + s T A(u) + c T² B(u)            u = t/T ∈ [0, 1],   s = −F'(0) = −Σ a_l,   c = −F''(0) = −Σ b_l ω l
//! A(u) = u − 10u³ + 15u⁴ − 6u⁵                  A = A'' = 0 and A' = 1 at both ends
//! B(u) = ½ u² (1 − u)²                          B = B' = 0 and B'' = 1 at both ends
//! ```
//! F is `radkhah2007`'s series with its coefficients a, b and q0. The quintic takes away the velocity and the acceleration
//! with which the series begins and ends, so the motion is at rest there, at a position that it returns to. It is
//! linear in the same coefficients, and repeats with continuous acceleration.
//!
//! Reference: K.-J. Park, "Fourier-based optimal excitation trajectories for the dynamic identification of robots",
//! Robotica 24(5), 2006, where the polynomial serves the same end.

use super::curve::Curve;
use super::definition::{PeriodicMotion, Trajectory};
use super::fourier::{FourierJoint, FourierTrajectory};
use super::piecewise::{derivative, horner};

/// A(u) in ascending powers.
pub(super) const SLOPE: [f64; 6] = [0.0, 1.0, 0.0, -10.0, 15.0, -6.0];

/// B(u) in ascending powers.
pub(super) const CURVATURE: [f64; 6] = [0.0, 0.0, 0.5, -1.0, 0.5, 0.0];

/// A Fourier series of all joints with the polynomial that lets it start and stop at rest.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{FourierJoint, FourierQuinticTrajectory, FourierTrajectory, Trajectory};
/// let joint = FourierJoint { name: "joint1".into(), a: vec![0.5], b: vec![0.3], q0: 0.2 };
/// let motion = FourierQuinticTrajectory::from(FourierTrajectory::new(10.0, vec![joint]).unwrap());
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// motion.evaluate(0.0, &mut q, &mut qd, &mut qdd);
/// assert!(qd[0].abs() < 1e-15 && qdd[0].abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct FourierQuinticTrajectory {
    /// The series F.
    pub series: FourierTrajectory,
}

impl FourierQuinticTrajectory {
    /// `s T` and `c T²` of a joint, rad: what A and B are multiplied with.
    fn ends(&self, joint: usize) -> (f64, f64) {
        let FourierJoint { a, b, .. } = &self.series.joints[joint];
        let (period, omega) = (self.series.period_s, self.series.omega());
        let curvature: f64 = b.iter().enumerate().map(|(l, b)| b * omega * (l + 1) as f64).sum();
        (-period * a.iter().sum::<f64>(), -period * period * curvature)
    }

    /// The polynomial of a joint in ascending powers of u, rad.
    fn polynomial(&self, joint: usize) -> Vec<f64> {
        let (slope, curvature) = self.ends(joint);
        SLOPE.iter().zip(&CURVATURE).map(|(a, b)| slope * a + curvature * b).collect()
    }
}

impl From<FourierTrajectory> for FourierQuinticTrajectory {
    fn from(series: FourierTrajectory) -> Self {
        Self { series }
    }
}

impl Trajectory for FourierQuinticTrajectory {
    fn dof(&self) -> usize {
        self.series.dof()
    }

    fn period_s(&self) -> f64 {
        self.series.period_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.series.evaluate(t, q, qd, qdd);
        let period = self.series.period_s;
        let turns = t / period;
        let u = turns - turns.floor();
        let jet = |polynomial: &[f64]| {
            let first = derivative(polynomial);
            let second = derivative(&first);
            [horner(polynomial, u), horner(&first, u) / period, horner(&second, u) / (period * period)]
        };
        let (a, b) = (jet(&SLOPE), jet(&CURVATURE));
        for joint in 0..self.dof() {
            let (slope, curvature) = self.ends(joint);
            q[joint] += slope * a[0] + curvature * b[0];
            qd[joint] += slope * a[1] + curvature * b[1];
            qdd[joint] += slope * a[2] + curvature * b[2];
        }
    }
}

impl PeriodicMotion for FourierQuinticTrajectory {
    fn names(&self) -> Vec<&str> {
        self.series.names()
    }

    fn curve(&self, joint: usize, order: usize) -> Curve {
        let mut polynomial = self.polynomial(joint);
        for _ in 0..order {
            polynomial = derivative(&polynomial).iter().map(|c| c / self.series.period_s).collect();
        }
        Curve::Mixed(self.series.wave(joint, order), polynomial)
    }

    fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
        self.series.adjust(joint, factor, shift);
    }

    fn slow_down(&mut self, part: f64) {
        self.series.slow_down(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::table_one;

    #[test]
    fn identity_starts_and_stops_at_rest_where_it_began() {
        let motion = FourierQuinticTrajectory::from(table_one::corrected());
        let at = |t: f64| {
            let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            motion.evaluate(t, &mut q, &mut qd, &mut qdd);
            (q, qd, qdd)
        };
        let (first, last) = (at(0.0), at(10.0 - 1e-9));
        for i in 0..6 {
            assert!(first.1[i].abs() < 1e-13 && first.2[i].abs() < 1e-12, "{first:?}");
            // 1 ns before the end: a jerk of 50 rad/s³ leaves 5e-8 rad/s².
            assert!(last.1[i].abs() < 1e-12 && last.2[i].abs() < 1e-7, "{last:?}");
            assert!((first.0[i] - last.0[i]).abs() < 1e-12);
        }
        // It is not the series alone: that one starts at speed.
        assert!(motion.series.sample(1).qd(0).iter().any(|speed| speed.abs() > 0.1));
    }

    #[test]
    fn analytic_end_conditions_of_the_two_polynomials() {
        let jet = |p: &[f64], u: f64| {
            let first = derivative(p);
            [horner(p, u), horner(&first, u), horner(&derivative(&first), u)]
        };
        for u in [0.0, 1.0] {
            assert_eq!(jet(&SLOPE, u), [0.0, 1.0, 0.0]);
            assert_eq!(jet(&CURVATURE, u), [0.0, 0.0, 1.0]);
        }
    }
}
