//! Between the optimiser's variables and the motion: a Fourier trajectory is linear in its coefficients.
//!
//! Joint j owns the block `x_j = (a_1, b_1, …, a_H, b_H, q0)`, each divided by a scale of the joint's own size (its
//! speed limit for a and b, half its range for q0), so that a step of one means something similar in every variable:
//!
//! ```text
//! q_j(θ) = B_q(θ) S_j x_j      q̇_j(θ) = B_v(θ) S_j x_j      q̈_j(θ) = B_a(θ) S_j x_j          θ = ωt
//! B_q = ( sin lθ/(ω l), −cos lθ/(ω l), …, 1 )    B_v = ( cos lθ, sin lθ, …, 0 )    B_a = ( −ω l sin lθ, ω l cos lθ, …, 0 )
//! ```

use std::f64::consts::{PI, TAU};

use super::{ExcitationError, FourierJoint, FourierTrajectory, PeriodicTrajectory};
use crate::dynamics::States;
use crate::model::{Limits, Robot};

/// Which of the three derivatives a row belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// q.
    Position,
    /// q̇.
    Velocity,
    /// q̈.
    Acceleration,
}

impl Quantity {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Acceleration];
}

/// Period, harmonics and scales of a family of Fourier trajectories of one robot.
#[derive(Clone, Debug)]
pub struct FourierBasis {
    period_s: f64,
    harmonics: usize,
    names: Vec<String>,
    /// Scale of a and b, and of q0, for each joint.
    scales: Vec<(f64, f64)>,
}

impl FourierBasis {
    /// The family of `robot`'s trajectories with this period (s) and number of harmonics.
    ///
    /// # Errors
    /// [`ExcitationError::Problem`] if the period is not a finite number above zero or there is no harmonic.
    pub fn new(robot: &Robot, period_s: f64, harmonics: usize) -> Result<Self, ExcitationError> {
        if !(period_s.is_finite() && period_s > 0.0) {
            return Err(ExcitationError::Problem {
                quantity: "period".into(),
                found: format!("{period_s} s"),
                expected: "a finite number above zero".into(),
            });
        }
        if harmonics == 0 {
            return Err(ExcitationError::Problem {
                quantity: "number of harmonics".into(),
                found: "0".into(),
                expected: "at least one".into(),
            });
        }
        let omega = TAU / period_s;
        Ok(Self {
            period_s,
            harmonics,
            names: robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            scales: robot.joints().iter().map(|joint| scales(&joint.limits, omega)).collect(),
        })
    }

    /// Number of joints n.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.scales.len()
    }

    /// Number of harmonics H.
    #[must_use]
    pub const fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// Period T, s.
    #[must_use]
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Fundamental angular frequency ω, rad/s.
    #[must_use]
    pub fn omega(&self) -> f64 {
        TAU / self.period_s
    }

    /// Variables of one joint, 2H + 1.
    #[must_use]
    pub const fn block(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Number of variables, n (2H + 1).
    #[must_use]
    pub fn variables(&self) -> usize {
        self.dof() * self.block()
    }

    /// The trajectory of the variables `x`.
    #[must_use]
    pub fn trajectory(&self, x: &[f64]) -> PeriodicTrajectory {
        let joints = x.chunks_exact(self.block()).zip(&self.scales).zip(&self.names).map(|((x, scale), name)| {
            let (pairs, q0) = x.split_at(2 * self.harmonics);
            FourierJoint {
                name: name.clone(),
                a: pairs.iter().step_by(2).map(|a| a * scale.0).collect(),
                b: pairs.iter().skip(1).step_by(2).map(|b| b * scale.0).collect(),
                q0: q0[0] * scale.1,
            }
        });
        FourierTrajectory { period_s: self.period_s, joints: joints.collect() }.into()
    }

    /// The variables of a trajectory; harmonics that it lacks are zero.
    ///
    /// # Errors
    /// [`ExcitationError::Trajectory`] if its joints, its period or its harmonics are not of this family.
    pub fn coefficients(&self, trajectory: &PeriodicTrajectory) -> Result<Vec<f64>, ExcitationError> {
        let fault = |quantity: &str, found: String, expected: String| {
            Err(ExcitationError::Trajectory { quantity: quantity.into(), found, expected })
        };
        let PeriodicTrajectory::Fourier(trajectory) = trajectory else {
            return fault("family", "another one".into(), "a Fourier series".into());
        };
        if trajectory.joints.len() != self.dof() {
            return fault("number of joints", trajectory.joints.len().to_string(), self.dof().to_string());
        }
        if (trajectory.period_s - self.period_s).abs() > 1e-12 * self.period_s {
            return fault("period", format!("{} s", trajectory.period_s), format!("{} s", self.period_s));
        }
        if trajectory.harmonics() > self.harmonics {
            let expected = format!("at most {}", self.harmonics);
            return fault("number of harmonics", trajectory.harmonics().to_string(), expected);
        }
        let mut x = vec![0.0; self.variables()];
        for ((x, joint), scale) in x.chunks_exact_mut(self.block()).zip(&trajectory.joints).zip(&self.scales) {
            for (l, (a, b)) in joint.a.iter().zip(&joint.b).enumerate() {
                x[2 * l] = a / scale.0;
                x[2 * l + 1] = b / scale.0;
            }
            x[2 * self.harmonics] = joint.q0 / scale.1;
        }
        Ok(x)
    }

    /// Scale of the velocity amplitudes of joint `index`, and its mean position, from its block of variables.
    pub(crate) fn scaled_mean(&self, index: usize, block: &[f64]) -> (f64, f64) {
        let (scale, q0_scale) = self.scales[index];
        (scale, q0_scale * block[2 * self.harmonics])
    }

    /// The row of one quantity of joint `index` at phase `phase`, times `sign`: 2H + 1 coefficients.
    #[must_use]
    pub fn row(&self, index: usize, quantity: Quantity, phase: f64, sign: f64) -> Vec<f64> {
        let mut weights = [0.0; 3];
        weights[quantity as usize] = sign;
        self.combined_row(index, phase, weights)
    }

    /// The weighted sum of the rows of position, velocity and acceleration of joint `index` at phase `phase`.
    #[must_use]
    pub fn combined_row(&self, index: usize, phase: f64, weights: [f64; 3]) -> Vec<f64> {
        let (scale, q0_scale) = self.scales[index];
        let [position, velocity, acceleration] = weights;
        let mut row = vec![0.0; self.block()];
        let (s1, c1) = libm::sincos(phase);
        let (mut s, mut c) = (s1, c1);
        for l in 0..self.harmonics {
            let w = self.omega() * (l + 1) as f64;
            let turned = position / w - acceleration * w;
            row[2 * l] = scale * (s * turned + c * velocity);
            row[2 * l + 1] = scale * (s * velocity - c * turned);
            (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
        }
        row[2 * self.harmonics] = position * q0_scale;
        row
    }
}

/// A size for a joint's velocity amplitudes and for its mean position.
fn scales(limits: &Limits, omega: f64) -> (f64, f64) {
    let half = 0.5 * (limits.position.1 - limits.position.0);
    let range = if half.is_finite() { half } else { PI };
    let speed = limits.velocity.min(limits.acceleration / omega).min(range * omega);
    (speed, range)
}

/// The rows of all motions at the samples `θ_k = 2π k / N`, ready for many evaluations.
#[derive(Clone, Debug)]
pub struct SampledBasis {
    basis: FourierBasis,
    samples: usize,
    /// cos lθ and sin lθ, N × 2H row-major.
    waves: Vec<f64>,
}

impl SampledBasis {
    /// `samples` samples of a family.
    #[must_use]
    pub fn new(basis: FourierBasis, samples: usize) -> Self {
        let harmonics = basis.harmonics();
        let mut waves = Vec::with_capacity(2 * samples * harmonics);
        for k in 0..samples {
            for l in 1..=harmonics {
                // k l modulo N keeps the argument within one turn.
                let (s, c) = libm::sincos(TAU * ((k * l) % samples) as f64 / samples as f64);
                waves.extend([c, s]);
            }
        }
        Self { basis, samples, waves }
    }

    /// The family.
    #[must_use]
    pub const fn basis(&self) -> &FourierBasis {
        &self.basis
    }

    /// Number of samples N.
    #[must_use]
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Fills `states` (N samples of n joints) with the motion of the variables `x`.
    pub fn states(&self, x: &[f64], states: &mut States) {
        let (n, harmonics) = (self.basis.dof(), self.basis.harmonics());
        let omega = self.basis.omega();
        let mut scaled = vec![(0.0, 0.0); harmonics];
        for (j, x) in x.chunks_exact(self.basis.block()).enumerate() {
            let (scale, q0_scale) = self.basis.scales[j];
            for (l, pair) in scaled.iter_mut().enumerate() {
                *pair = (scale * x[2 * l], scale * x[2 * l + 1]);
            }
            let q0 = q0_scale * x[2 * harmonics];
            for (k, waves) in self.waves.chunks_exact(2 * harmonics).enumerate() {
                let (mut q, mut qd, mut qdd) = (q0, 0.0, 0.0);
                for (l, (&(a, b), wave)) in scaled.iter().zip(waves.chunks_exact(2)).enumerate() {
                    let w = omega * (l + 1) as f64;
                    let (c, s) = (wave[0], wave[1]);
                    let turned = a * s - b * c;
                    q += turned / w;
                    qd += a * c + b * s;
                    qdd -= turned * w;
                }
                states.q[k * n + j] = q;
                states.qd[k * n + j] = qd;
                states.qdd[k * n + j] = qdd;
            }
        }
    }

    /// Derivatives of a scalar with respect to the samples (N × n row-major each) pulled back to the variables.
    ///
    /// ```text
    /// ∂f/∂x_j = S_jᵀ Σ_k B_q(θ_k)ᵀ ∂f/∂q_kj + B_v(θ_k)ᵀ ∂f/∂q̇_kj + B_a(θ_k)ᵀ ∂f/∂q̈_kj
    /// ```
    pub fn pull_back(&self, sensitivity: &States, gradient: &mut [f64]) {
        let (n, harmonics) = (self.basis.dof(), self.basis.harmonics());
        let omega = self.basis.omega();
        for (j, g) in gradient.chunks_exact_mut(self.basis.block()).enumerate() {
            let (scale, q0_scale) = self.basis.scales[j];
            g.fill(0.0);
            for (k, waves) in self.waves.chunks_exact(2 * harmonics).enumerate() {
                let at = k * n + j;
                let (dq, dqd, dqdd) = (sensitivity.q[at], sensitivity.qd[at], sensitivity.qdd[at]);
                for (l, wave) in waves.chunks_exact(2).enumerate() {
                    let w = omega * (l + 1) as f64;
                    let (c, s) = (wave[0], wave[1]);
                    let turned = dq / w - dqdd * w;
                    g[2 * l] += s * turned + c * dqd;
                    g[2 * l + 1] += s * dqd - c * turned;
                }
                g[2 * harmonics] += dq;
            }
            for g in &mut g[..2 * harmonics] {
                *g *= scale;
            }
            g[2 * harmonics] *= q0_scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::chains;
    use crate::excitation::Trajectory;
    use crate::seed::Seed;
    use rand::RngExt;

    fn family() -> (FourierBasis, Vec<f64>) {
        let mut rng = Seed::new(3).stream("basis", 0);
        let (robot, _) = chains::random_robot(&mut rng, 4);
        let basis = FourierBasis::new(&robot, 7.0, 3).unwrap();
        let x = (0..basis.variables()).map(|_| rng.random_range(-1.0..1.0)).collect();
        (basis, x)
    }

    #[test]
    fn identity_sampled_states_equal_the_trajectory() {
        let (basis, x) = family();
        let trajectory = basis.trajectory(&x);
        let sampled = SampledBasis::new(basis.clone(), 23);
        let mut states = States::with_len(4, 23);
        sampled.states(&x, &mut states);
        let expected = trajectory.sample(23);
        for (found, expected) in [(&states.q, &expected.q), (&states.qd, &expected.qd), (&states.qdd, &expected.qdd)] {
            for (x, y) in found.iter().zip(expected) {
                assert!((x - y).abs() < 1e-12);
            }
        }
        let back = basis.coefficients(&trajectory).unwrap();
        assert!(back.iter().zip(&x).all(|(x, y)| (x - y).abs() < 1e-15));
    }

    #[test]
    fn identity_rows_equal_the_evaluation() {
        let (basis, x) = family();
        let trajectory = basis.trajectory(&x);
        let (mut q, mut qd, mut qdd) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        trajectory.evaluate(1.3, &mut q, &mut qd, &mut qdd);
        for j in 0..4 {
            let x = &x[j * basis.block()..(j + 1) * basis.block()];
            for (quantity, expected) in Quantity::ALL.into_iter().zip([q[j], qd[j], qdd[j]]) {
                let row = basis.row(j, quantity, basis.omega() * 1.3, -1.0);
                let found: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
                assert!((found + expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn identity_pull_back_is_the_transpose_of_the_states() {
        // ⟨s, states(x)⟩ = ⟨pull_back(s), x⟩ for every s and x.
        let (basis, x) = family();
        let sampled = SampledBasis::new(basis, 23);
        let mut states = States::with_len(4, 23);
        sampled.states(&x, &mut states);
        let mut rng = Seed::new(3).stream("sensitivity", 0);
        let mut weights = States::with_len(4, 23);
        for w in weights.q.iter_mut().chain(&mut weights.qd).chain(&mut weights.qdd) {
            *w = rng.random_range(-1.0..1.0);
        }
        let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
        let left = dot(&weights.q, &states.q) + dot(&weights.qd, &states.qd) + dot(&weights.qdd, &states.qdd);
        let mut gradient = vec![0.0; x.len()];
        sampled.pull_back(&weights, &mut gradient);
        assert!((left - dot(&gradient, &x)).abs() < 1e-11 * (1.0 + left.abs()));
    }
}
