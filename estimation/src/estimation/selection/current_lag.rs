//! The equations of a recording whose torque leads the one that acts.
//!
//! ```text
//! y = W β + Σ_m T_m S_m Ẇ β + ε        S_m = Cᵀ e_m e_mᵀ C⁻ᵀ        c_m = S_m Ẇ β̂
//! y + Σ_m T̂_m c_m = (W + Σ_m T̂_m S_m Ẇ) β + Σ_m T_m c_m + ε          repeated until T̂ rests: Gauss–Newton
//! Ẇ = (W(x + h ẋ/2) − W(x − h ẋ/2))/h        x = (q, q̇, q̈), h from sample to sample
//! ```
//! `T_m` is the time by which the reported torque of motor m leads ([`CURRENT_LAG`](crate::model::term::CURRENT_LAG)), C the coupling of the motors; without one
//! S_m takes row m alone. The equations are linear in β and in T but not in both, so that they are made again with β̂ and T̂ by the product rule:
//! at rest their solution is that of the equations as they are, and its covariance the right one to first order. The change of the torque is that
//! of the *model* along the measured motion. No measured torque is differenced, whose noise would be in the column.
//!
//! The differences over one sample count each jump of friction once, wherever in the sample the joint turns; on a tone of angular
//! frequency ω they are too small by (ωh)²/24. Fourier coefficients of a torque that jumps would ring over the whole period: they give q⃛ alone
//! ([`Samples::jerk`]).
//!
//! Noise of the positions is largest in q⃛ and draws T towards zero; what [`Samples::jerk`] leaves of that is 4 % of a lag of 3 ms on the simulated A460, and a fifth on
//! the planar arm, which moves slowly over coarse encoders: its intervals do not hold that.
//!
//! Fails where the lag is not small against the motion, (ωT)²/2 being what a delay leaves (a lag of first order leaves nothing), and in a torque
//! that was filtered otherwise than the positions, which is a lag like any other.

use nalgebra::{DMatrix, DVector};

use crate::dynamics::States;
use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::model::Robot;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// Rounds until a lag must rest.
const ROUNDS: usize = 12;

/// Change of a lag, as a share of it and in s, with which it rests.
const REST: (f64, f64) = (1e-4, 1e-7);

/// Lags and parameters at which the equations are made.
pub(super) struct LaggedTorque {
    regressor: JointTorqueRegressor,
    kept: Vec<usize>,
    /// S_m, n × n each.
    shares: Vec<DMatrix<f64>>,
    beta: DVector<f64>,
    /// T̂ of each motor, s.
    pub(super) lags: Vec<f64>,
}

impl LaggedTorque {
    /// No lags, beside the torque of `beta` on the base of `observation`.
    pub(super) fn new(robot: &Robot, observation: &Observation, beta: &[f64]) -> Self {
        Self {
            regressor: observation.joint_regressor(robot),
            kept: observation.base.kept.clone(),
            shares: shares(robot),
            beta: DVector::from_column_slice(beta),
            lags: vec![0.0; robot.dof()],
        }
    }

    /// The lags of all motors that the equations come to rest at, from none and `beta`; `None` where they do not rest.
    ///
    /// # Errors
    /// [`EstimationError`] where the equations have no answer.
    pub(super) fn at_rest(
        robot: &Robot,
        observation: &Observation,
        samples: &Samples,
        beta: &[f64],
    ) -> Result<Option<Self>, EstimationError> {
        let mut lagged = Self::new(robot, observation, beta);
        let rates = lagged.rates(samples);
        for _ in 0..ROUNDS {
            let solution = lagged.solution(observation, &rates)?;
            let (beta, lags) = solution.as_slice().split_at(beta.len());
            let rests = lagged.lags.iter().zip(lags).all(|(old, new)| (new - old).abs() <= REST.0 * new.abs() + REST.1);
            (lagged.beta, lagged.lags) = (DVector::from_column_slice(beta), lags.to_vec());
            if rests {
                return Ok(Some(lagged));
            }
        }
        Ok(None)
    }

    /// β and T of the equations made at the present ones.
    fn solution(&self, observation: &Observation, rates: &DMatrix<f64>) -> Result<DVector<f64>, EstimationError> {
        let (b, n) = (observation.regressor.ncols(), self.shares.len());
        let mut equations = observation.clone();
        self.add_change(rates, &mut equations);
        equations.regressor = equations.regressor.insert_columns(b, n, 0.0);
        equations.regressor.columns_mut(b, n).copy_from(&self.columns(rates));
        equations.blank();
        Ok(LinearFit::weighted(&Factorisation::new(&equations)?)?.fit.solution().clone())
    }

    /// Ẇ of samples, means over blocks, (n·M) × b.
    pub(super) fn rates(&self, samples: &Samples) -> DMatrix<f64> {
        let step = 1.0 / samples.rate_hz;
        let jerk = samples.jerk();
        let states = &samples.states;
        let moved = |by: f64| {
            let along = |x: &[f64], rate: &[f64]| x.iter().zip(rate).map(|(x, rate)| x + by * rate).collect();
            States {
                dof: states.dof,
                q: along(&states.q, &states.qd),
                qd: along(&states.qd, &states.qdd),
                qdd: along(&states.qdd, &jerk),
            }
        };
        let stack = |states: &States| self.regressor.stack_means(states, &self.kept, samples.block);
        (stack(&moved(0.5 * step)) - stack(&moved(-0.5 * step))) / step
    }

    /// c_m of each motor, (n·M) × n.
    pub(super) fn columns(&self, rates: &DMatrix<f64>) -> DMatrix<f64> {
        let n = self.shares.len();
        let change = rates * &self.beta;
        let mut columns = DMatrix::zeros(rates.nrows(), n);
        for (m, share) in self.shares.iter().enumerate() {
            for first in (0..rates.nrows()).step_by(n) {
                let part = share * change.rows(first, n);
                columns.view_mut((first, m), (n, 1)).copy_from(&part);
            }
        }
        columns
    }

    /// Adds `Σ_m T̂_m S_m Ẇ` to the regressor, and `Σ_m T̂_m c_m` to the torque.
    pub(super) fn add_change(&self, rates: &DMatrix<f64>, to: &mut Observation) {
        let n = self.shares.len();
        let share = self.shares.iter().zip(&self.lags).fold(DMatrix::zeros(n, n), |sum, (s, lag)| sum + s * *lag);
        for first in (0..rates.nrows()).step_by(n) {
            let mut part = to.regressor.view_mut((first, 0), (n, rates.ncols()));
            part += &share * rates.rows(first, n);
        }
        to.y += self.columns(rates) * DVector::from_column_slice(&self.lags);
    }
}

/// S_m of each motor.
fn shares(robot: &Robot) -> Vec<DMatrix<f64>> {
    let n = robot.dof();
    let forward = robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
    // A robot's coupling is invertible by construction.
    let inverse = forward.clone().try_inverse().unwrap_or_else(|| DMatrix::identity(n, n));
    (0..n).map(|m| forward.row(m).transpose() * inverse.column(m).transpose()).collect()
}
