//! Speeds of the laws of friction, which enter the equations in another way than in proportion: that in which Coulomb friction sets in, and that
//! at which friction falls (Stribeck).
//!
//! ```text
//! y = W(v) β + ε        v_i of joint i: v_s in tanh(q̇/v_s), or v_S in exp(−(q̇/v_S)²)        min over v of ρ(v) = min over β of ‖Σ^{-½}(y − W(v) β)‖²
//! y ≈ W(v) β + Σ_i D_i δ_i        D_i = Σ_columns φ ∂w/∂ln v_i        v_i ← v_i exp(α δ_i)
//! ```
//! Variable projection: β is solved again for every v, and Gauss–Newton moves v alone. The derivative of each joint's columns, times
//! the coefficients that the fit has at v, is one column more; its coefficient δ_i is the step of ln v_i. α is halved until ρ falls. The search
//! begins with the stated speeds or with those multiples of them by 3 and 9 that have a lower ρ, joint by joint (with parts of the joint's largest speed
//! where none is stated), and keeps between a thousandth of a joint's largest speed (or a half, for the onset a quarter, of the lowest speed among its
//! equations, where that is more) and the largest. At the minimum δ = 0, and the covariance of the same equations is that of (β, ln v): with the
//! correlation of the noise and the [`discrepancy`](super::discrepancy) that any weighted estimate has. Intervals are those of ln v_i, so that their
//! ends are positive.
//!
//! Weights are the scatter over periods; where there is none, the residual of the fit, found again at the speeds that came out. The torque of the
//! links in friction of the load is that of the fit, found again at the speeds until both rest.
//!
//! A speed exists where there is friction that has one. Where the amplitude of a joint is not told from zero at 0.1 % over all joints (stricter
//! than 5 %, since the largest of many speeds' amplitudes is tested), where ln v_i has a standard deviation above a half, or where the search ended at
//! a bound, the data do not show it: the joint keeps the stated speed, and the others are sought again without it.
//!
//! Assumes exact states: the velocity of a recording is filtered where a joint turns round, and what that moves is in no interval (on
//! the simulated A460 with all equations, 1 to 10 % of the speed). Fails where equations are left out below a speed of the size of v_i:
//! what is left of the column is then alike for many speeds. A minimum is a local one, beyond those starting points.
//!
//! References: G. H. Golub, V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least squares problems whose variables
//! separate", SIAM J. Numer. Anal. 10(2), 1973; L. Kaufman, "A variable projection method for solving separable nonlinear least squares
//! problems", BIT 15, 1975, for the derivative that leaves out how β moves.

use super::error::EstimationError;
use super::measured::Measured;
use super::observation::Observation;
use super::selection::{HeldOutChange, TermEvidence, Verdict, change_between};
use super::speed_columns::SpeedColumns;
use super::speed_search::{Search, change};
use super::termination::Termination;
use super::{load_fit, load_friction};
use crate::base::BaseReduction;
use crate::model::term::ShapeParameter;
use crate::model::{Columns, Robot};
use crate::observer::Observer;
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Level of the test that an amplitude is not zero, over all joints.
const LEVEL: f64 = 0.001;
/// Largest standard deviation of the logarithm of a speed that is one.
const LARGEST_STD: f64 = 0.5;
/// Times that the torque of the links is found again, and change of the speeds with which both rest.
const LOADS: usize = 10;
const AT_REST: f64 = 1e-4;

/// The speed of one joint's friction.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FrictionSpeed {
    /// Joint, from one.
    pub joint: usize,
    /// The speed of the robot file, rad/s (m/s).
    pub stated: f64,
    /// The speed that was found, rad/s (m/s); `None` where the data do not show it.
    pub speed: Option<Measured>,
    /// The coefficient of the first column with that speed (Coulomb friction, or static above it), N·m (N), its standard deviation with that of the
    /// speed; `None` as above.
    pub amplitude: Option<Measured>,
}

/// The speeds of all joints that have a column with one.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FrictionSpeeds {
    /// Which speed it is.
    #[serde(skip)]
    pub shape: ShapeParameter,
    /// Joint by joint.
    pub joints: Vec<FrictionSpeed>,
    /// √(ρ/equations) by the stated speeds and by those found, with the same weights.
    pub weighted_rms: [f64; 2],
    /// How torque that was not fitted is predicted with the stated speeds and with those found; `None` where a part of the recording does not
    /// determine the parameters, or no speed was found.
    pub held_out: Option<HeldOutChange>,
    /// How the search ended.
    pub termination: Termination,
}

impl FrictionSpeeds {
    /// Joints, from one, whose speed the data do not determine.
    pub fn joints_not_shown(&self) -> Vec<usize> {
        self.joints.iter().filter(|joint| joint.speed.is_none()).map(|joint| joint.joint).collect()
    }

    /// Whether torque that was not fitted is predicted better with these speeds, by its 95 % interval.
    pub fn predict_better(&self) -> bool {
        self.held_out.is_some_and(|change| change.is_improvement())
    }

    /// What they are as a candidate of a selection.
    pub fn evidence(&self) -> TermEvidence {
        let coefficients = self.joints.iter().filter(|joint| joint.speed.is_some()).count();
        let verdict = match (coefficients, self.predict_better()) {
            (0, _) => Verdict::NotSupported,
            (_, true) => Verdict::Supported,
            (_, false) => Verdict::Undecided,
        };
        TermEvidence { verdict, coefficients, held_out: self.held_out, ..TermEvidence::untested("onset") }
    }

    /// The robot with the speeds that were found.
    ///
    /// # Panics
    /// If the robot has fewer joints than this is of.
    pub fn robot(&self, robot: &Robot) -> Robot {
        let speeds = self.joints.iter().filter_map(|of| of.speed.map(|speed| (of.joint - 1, speed.value)));
        with_speeds(robot, self.shape, speeds)
    }

    /// The speeds of a base of these columns; `None` where no column has one.
    pub(super) fn find(
        robot: &Robot,
        columns: Columns,
        base: &BaseReduction,
        samples: &Samples,
        shape: ShapeParameter,
        observer: &dyn Observer,
    ) -> Result<Option<Self>, EstimationError> {
        let equations_of = |robot: &Robot| Equations::of(robot, columns, base, samples);
        let begun = equations_of(robot)?;
        let joints = SpeedColumns::of(robot, &begun.linear, samples, shape).joints;
        let joints: Vec<usize> = joints.iter().map(|of| of.joint).collect();
        if joints.is_empty() {
            return Ok(None);
        }
        let stated: Vec<f64> = joints.iter().map(|&joint| robot.joints()[joint].drive.shape(&shape)).collect();
        let mut sought = vec![true; joints.len()];
        loop {
            let (mut equations, mut from) = (begun.clone(), stated.clone());
            for round in 1.. {
                let sought_columns = SpeedColumns::of(robot, &equations.linear, samples, shape);
                let mut search = Search::new(&equations.at_load, samples, &sought_columns, &sought, observer);
                let (speeds, termination) = search.ended(&from)?;
                let moved = with_speeds(robot, shape, joints.iter().copied().zip(speeds.iter().copied()));
                let is_linear = equations.linear.linear_at.is_none();
                let next = equations_of(&moved)?;
                let rests = is_linear || change(&from, &speeds) <= AT_REST || round == LOADS;
                if !rests {
                    (equations, from) = (next, speeds);
                    continue;
                }
                let found = search.values(&speeds, &next.linear)?;
                let t = student_quantile(1.0 - 0.5 * LEVEL / joints.len() as f64, found.degrees_of_freedom);
                let before = sought.clone();
                for (i, value) in found.values.iter().enumerate() {
                    let [least, largest] = sought_columns.joints[i].bounds;
                    let inside = speeds[i] > least && speeds[i] < largest;
                    sought[i] &= value.is_some_and(|[speed, amplitude]| {
                        inside && amplitude.value.abs() > t * amplitude.std && speed.std < LARGEST_STD * speed.value
                    });
                }
                if sought != before {
                    break;
                }
                let count = begun.linear.equations().max(1) as f64;
                let weighted_rms = [search.misfit(&stated)?, search.misfit(&speeds)?].map(|rho| (rho / count).sqrt());
                let held_out = if sought.contains(&true) { change_between(&begun.linear, &next.linear)? } else { None };
                let joint = |(i, value): (usize, &Option<[Measured; 2]>)| FrictionSpeed {
                    joint: joints[i] + 1,
                    stated: stated[i],
                    speed: value.map(|[speed, _]| speed),
                    amplitude: value.map(|[_, amplitude]| amplitude),
                };
                let joints = found.values.iter().enumerate().map(joint).collect();
                return Ok(Some(Self { shape, joints, weighted_rms, held_out, termination }));
            }
        }
    }
}

/// The equations at some speeds.
#[derive(Clone)]
struct Equations {
    /// As all estimators have them.
    linear: Observation,
    /// With the torque of the links as it is there, in friction of the load: linear in the coefficients.
    at_load: Observation,
}

impl Equations {
    fn of(robot: &Robot, columns: Columns, base: &BaseReduction, samples: &Samples) -> Result<Self, EstimationError> {
        // Far from the speeds of the arm the load need not come to rest any closer.
        let regressor = load_friction::regressor_of(robot, columns)?;
        let linear = load_fit::observe_to(robot, &regressor, base, samples, load_fit::REST_OF_TESTS)?;
        let at_load = match linear.linear_at {
            Some(_) => Observation::stacked(robot, &linear.joint_regressor(robot), base, samples, None)?.0,
            None => linear.clone(),
        };
        Ok(Self { linear, at_load })
    }
}

fn with_speeds(robot: &Robot, shape: ShapeParameter, speeds: impl Iterator<Item = (usize, f64)>) -> Robot {
    let mut drives: Vec<_> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
    for (joint, speed) in speeds {
        drives[joint].set_shape(&shape, speed);
    }
    robot.clone().with_drives(drives)
}
