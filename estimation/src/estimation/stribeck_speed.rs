//! The speed at which friction falls: Stribeck velocities, which enter the equations in another way than in proportion.
//!
//! ```text
//! y = W(v) β + ε        v_S,i = v_i of joint i        min over v of ρ(v) = min over β of ‖Σ^{-½}(y − W(v) β)‖²
//! y ≈ W(v) β + Σ_i D_i δ_i        D_i = φ_i ∂w_i/∂ln v_i = φ_i 2 (q̇_i/v_i)² w_i        v_i ← v_i exp(α δ_i)
//! ```
//! Variable projection: β is solved again for every v, and Gauss–Newton moves v alone. The derivative of each Stribeck column, times
//! the amplitude φ_i that the fit has at v, is one column more; its coefficient δ_i is the step of ln v_i. α is halved until ρ falls. The search
//! begins with the speeds of the robot file or with those multiples of them by 3 and 9 that have a lower ρ, joint by joint, and keeps
//! between a thousandth of a joint's largest speed (or half of the lowest speed among its equations, where that is more) and the
//! largest. At the minimum δ = 0, and the covariance of the same equations is that of (β, ln v): with the correlation of the noise and the
//! [`discrepancy`](super::discrepancy) that any weighted estimate has. Intervals are those of ln v_i, so that their ends are positive.
//!
//! Weights are the scatter over periods; where there is none, the residual of the fit, found again at the speeds that came out.
//!
//! A speed exists where there is friction that falls. Where the amplitude of a joint is not told from zero at 0.1 % over all joints (stricter
//! than 5 %, since the largest of many speeds' amplitudes is tested), where ln v_i has a standard deviation above a half, or where the search ended at
//! a bound, the joint is undecided: it keeps the speed of the robot file, and the others are sought again without it.
//!
//! Assumes exact states: the velocity of a recording is filtered where a joint turns round, and what that moves is in no interval (on
//! the simulated A460 with all equations, 1 to 10 % of the speed). Fails where equations are left out below a speed of the size of v_i:
//! what is left of the column is then alike for many speeds. A minimum is a local one, beyond those starting points.
//!
//! References: G. H. Golub, V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least squares problems whose variables
//! separate", SIAM J. Numer. Anal. 10(2), 1973; L. Kaufman, "A variable projection method for solving separable nonlinear least squares
//! problems", BIT 15, 1975, for the derivative that leaves out how β moves.

use super::stribeck_columns::StribeckColumns;
use super::stribeck_search::{Search, SpeedValue};
use super::{EstimationError, Observation, Termination};
use crate::model::Robot;
use crate::model::term::Stribeck;
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Level of the test that an amplitude is not zero, over all joints.
const LEVEL: f64 = 0.001;
/// Largest standard deviation of the logarithm of a speed that is one.
const LARGEST_STD: f64 = 0.5;

/// Friction that falls as one joint starts to move.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StribeckSpeed {
    /// Joint, from one.
    pub joint: usize,
    /// The speed of the robot file, rad/s (m/s).
    pub stated: f64,
    /// The speed that was found, rad/s (m/s); `None` where the data do not decide it.
    pub speed: Option<SpeedValue>,
    /// Static above Coulomb friction, N·m (N), its standard deviation with that of the speed; `None` as above.
    pub amplitude: Option<SpeedValue>,
}

/// The speeds of all joints that have a Stribeck column.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StribeckSpeeds {
    /// Joint by joint.
    pub joints: Vec<StribeckSpeed>,
    /// √(ρ/equations) by the speeds of the robot file, each joint's within its bounds, and by those found, with the same weights.
    pub weighted_rms: [f64; 2],
    /// How the search ended.
    pub termination: Termination,
}

impl StribeckSpeeds {
    /// Joints, from one, whose speed the data do not decide.
    #[must_use]
    pub fn undecided(&self) -> Vec<usize> {
        self.joints.iter().filter(|joint| joint.speed.is_none()).map(|joint| joint.joint).collect()
    }

    /// The robot with the speeds that were found.
    ///
    /// # Panics
    /// If the robot has fewer joints than this is of.
    #[must_use]
    pub fn robot(&self, robot: &Robot) -> Robot {
        let mut drives: Vec<_> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
        for joint in &self.joints {
            if let Some(speed) = joint.speed {
                drives[joint.joint - 1].shapes.insert(Stribeck::VELOCITY.key.to_owned(), speed.value);
            }
        }
        robot.clone().with_drives(drives)
    }
}

/// The speeds of the Stribeck columns of an observation, `None` where it has none.
pub(super) fn stribeck_speeds(
    robot: &Robot,
    observation: &Observation,
    samples: &Samples,
) -> Result<Option<StribeckSpeeds>, EstimationError> {
    let columns = StribeckColumns::of(robot, observation, samples);
    if columns.joints.is_empty() {
        return Ok(None);
    }
    let stated: Vec<f64> =
        columns.joints.iter().map(|of| robot.joints()[of.joint].drive.shape(&Stribeck::VELOCITY)).collect();
    let kept: Vec<f64> =
        columns.joints.iter().zip(&stated).map(|(of, speed)| speed.clamp(of.bounds[0], of.bounds[1])).collect();
    let mut search = Search::new(observation, samples, &columns);
    loop {
        let (speeds, termination) = search.ended(&kept)?;
        let found = search.values(&speeds)?;
        let t = student_quantile(1.0 - 0.5 * LEVEL / kept.len() as f64, found.degrees_of_freedom);
        let before = search.sought.clone();
        for (i, value) in found.values.iter().enumerate() {
            let inside = speeds[i] > columns.joints[i].bounds[0] && speeds[i] < columns.joints[i].bounds[1];
            search.sought[i] &= value.is_some_and(|[speed, amplitude]| {
                inside && amplitude.value.abs() > t * amplitude.std && speed.std < LARGEST_STD * speed.value
            });
        }
        if search.sought != before {
            continue;
        }
        let equations = observation.equations().max(1) as f64;
        let weighted_rms = [search.misfit(&kept)?, search.misfit(&speeds)?].map(|rho| (rho / equations).sqrt());
        let joint = |(i, value): (usize, &Option<[SpeedValue; 2]>)| StribeckSpeed {
            joint: columns.joints[i].joint + 1,
            stated: stated[i],
            speed: value.map(|[speed, _]| speed),
            amplitude: value.map(|[_, amplitude]| amplitude),
        };
        let joints = found.values.iter().enumerate().map(joint).collect();
        return Ok(Some(StribeckSpeeds { joints, weighted_rms, termination }));
    }
}
