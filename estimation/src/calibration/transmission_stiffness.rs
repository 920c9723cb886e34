//! Stiffness of each transmission, where positions are measured before it, at the motor, and behind it, at the link.
//!
//! ```text
//! τ_m = J θ̈ + f_v θ̇ + f_c s(θ̇) + f_0 + K δ        δ = θ − C q_link        τ_m = C⁻ᵀ τ
//! ```
//! τ_m is the measured torque of a motor after its gear, θ its measured angle, `K δ` what goes through the transmission. The equation is that of the motor
//! alone, whatever the links are: its rotor and its friction are estimated beside K, and an offset between the two encoders is in `f_0`.
//!
//! **Which side carries noise.** δ is the small difference of two encoders: its noise and its steps would draw K towards zero in a least-squares fit
//! (an error in a variable), and those of τ_m the reciprocal of K in a fit of δ. Both are kept out by an instrument, the torque ẑ that an estimated rigid
//! model gives along the motion, which has neither:
//!
//! ```text
//! Z = [ẑ θ̈ θ̇ s(θ̇) 1]        δ̂ = Z (ZᵀZ)⁻¹ Zᵀ δ        (K, J, f) = argmin |τ_m − X̂ (K, J, f)|²        X̂ = [δ̂ θ̈ θ̇ s(θ̇) 1]
//! ```
//! Two-stage least squares: consistent for any noise of δ and τ_m, and for a model that errs, which makes it a weaker instrument only. The covariance is the
//! sandwich with the correlation in time of the residual `τ_m − K δ − …`, in which both noises are.
//!
//! **What is decided.** K is stated where δ answers to the torque: the F of ẑ in the first stage is above 10 (below it the second stage is biased and its intervals
//! too short) and less probable than 5 % over the number of motors. A wind-up below what the encoders resolve does not. Where ẑ is
//! a combination of θ̈ and friction, a joint of constant inertia without gravity, `K δ` and `J θ̈` are one and the same: no motion tells them apart.
//!
//! On the simulated A460 with springs of 2 mrad at the ratings and steps of 12 µrad at the links, five of six K are inside their intervals, within 0.3 %; the wrist's last, wound up
//! by a third of a step, is 11 % too low: steps above the wind-up are no noise but a function of the motion.
//!
//! Fails there, where a gap or a loop of hysteresis is as large as δ (K is then that of a line through it), and where δ̇ counts: a damper between motor and link goes into
//! friction and rotor.
//!
//! References: J. D. Sargan, "The estimation of economic relationships using instrumental variables", Econometrica 26(3), 1958; D. Staiger, J. H.
//! Stock, "Instrumental variables regression with weak instruments", Econometrica 65(3), 1997 (F above 10); M. W. Spong, J. Dyn. Syst. Meas. Control
//! 109(4), 1987 (the equation).

use nalgebra::{DMatrix, DVector};

use super::error::CalibrationError;
use crate::estimation::Measured;
use crate::experiment::Transmission;
use crate::linalg::LeastSquares;
use crate::model::{JointKind, Robot, smooth_sign};
use crate::signal::{LagProducts, NoiseModel, Samples};
use crate::statistics::{f_tail, root_mean_square, student_quantile};

/// Probability that a transmission is stated whose wind-up does not answer, over all motors.
const LEVEL: f64 = 0.05;

/// F of the first stage below which the instrument is weak.
const WEAK: f64 = 10.0;

/// Part of the instrument that is no combination of the other columns, below which it is one of them.
const ALIKE: f64 = 1e-3;

/// Columns of one motor before they are equations: torque, wind-up, instrument, acceleration, velocity, direction.
const SERIES: usize = 6;

/// Whether the data decide a stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StiffnessVerdict {
    /// It is stated.
    Decided,
    /// The wind-up does not stand out from the noise and the steps of the encoders.
    Hidden,
    /// The motion does not tell it from the inertia of the rotor.
    LikeRotor,
}

/// The transmission of one motor.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransmissionStiffness {
    /// Name of the joint of the motor.
    pub joint: String,
    /// Unit of the stiffness.
    pub unit: String,
    /// Unit of the rotor's inertia.
    pub rotor_unit: String,
    /// Unit of the wind-up.
    pub wind_up_unit: String,
    /// Unit of the residual.
    pub residual_unit: String,
    /// What the data decide.
    pub verdict: StiffnessVerdict,
    /// K, where it is decided.
    pub stiffness: Option<Measured>,
    /// J after the gear, kg·m² (kg), where K is decided.
    pub rotor: Option<Measured>,
    /// RMS of the wind-up about its mean, means over blocks, rad (m).
    pub wind_up_rms: f64,
    /// RMS of that part of it that does not answer to the torque, rad (m).
    pub wind_up_noise: f64,
    /// F of the wind-up's answer to the torque, with one and `freedom` degrees of freedom; `None` where it is like the rotor.
    pub f: Option<f64>,
    /// Probability of an F as large without an answer.
    pub p_value: Option<f64>,
    /// RMS residual of the motor's equation, N·m (N).
    pub residual_rms: Option<f64>,
    /// Independent equations beyond the coefficients.
    pub freedom: f64,
}

/// The stiffness of every transmission. `samples` hold the measured positions of the links; `modelled` is the torque of the joints by an estimated rigid
/// model along the samples, N × n row-major, N·m (N), as [`predict`](crate::estimation::predict) gives it.
///
/// # Errors
/// [`CalibrationError::Unfit`] where there are no positions of the links, or tables and robot do not belong together.
pub fn transmission_stiffness(
    robot: &Robot,
    samples: &Samples,
    modelled: &[f64],
) -> Result<Vec<TransmissionStiffness>, CalibrationError> {
    let n = robot.dof();
    let Some(links) = &samples.link_q else {
        let expected = "one for each joint and sample beside that of its motor";
        return Err(CalibrationError::unfit("positions of the links", "none", expected));
    };
    for (quantity, found) in [
        ("joints of the samples", samples.dof()),
        ("modelled torques of a sample", modelled.len() / samples.len().max(1)),
    ] {
        if found != n {
            return Err(CalibrationError::unfit(quantity, found, "as many as the robot has joints"));
        }
    }
    (0..n).map(|motor| Motor::new(robot, samples, links, modelled, motor).stiffness(robot)).collect()
}

/// The equations of one motor.
struct Motor {
    index: usize,
    /// Means over blocks, M × [`SERIES`]; zero where there is no equation.
    means: DMatrix<f64>,
    equations: usize,
    wraps: bool,
}

impl Motor {
    fn new(robot: &Robot, samples: &Samples, links: &[f64], modelled: &[f64], index: usize) -> Self {
        let n = robot.dof();
        let transmission = Transmission::new(robot);
        let turn = robot.joints()[index].drive.coulomb_velocity;
        let of_motor = |joints: &[f64]| {
            let mut motors = vec![0.0; n];
            transmission.motor_motion(joints, &mut motors);
            motors[index]
        };
        let torque = |joints: &[f64]| {
            let mut motors = vec![0.0; n];
            transmission.motor_torque(joints, &mut motors);
            motors[index]
        };
        let states = &samples.states;
        let series: Vec<f64> = (0..samples.len())
            .flat_map(|k| {
                let row = k * n..(k + 1) * n;
                let speed = of_motor(states.qd(k));
                let wind_up = of_motor(states.q(k)) - of_motor(&links[row.clone()]);
                let instrument = torque(&modelled[row]);
                [torque(samples.tau(k)), wind_up, instrument, of_motor(states.qdd(k)), speed, smooth_sign(speed, turn)]
            })
            .collect();
        let mut means = DMatrix::from_row_slice(samples.blocks(), SERIES, &samples.block_means(&series, SERIES));
        // A motor that drives several joints has equations where none of them turns over.
        let drives = |joint: usize| robot.coupling().map_or(joint == index, |c| c[(index, joint)] != 0.0);
        let mut equations = 0;
        for (m, used) in samples.used.chunks_exact(n).enumerate() {
            if (0..n).all(|joint| !drives(joint) || used[joint]) {
                equations += 1;
            } else {
                means.row_mut(m).fill(0.0);
            }
        }
        Self { index, means, equations, wraps: samples.period_s.is_some() }
    }

    /// The columns behind the first of a stage: acceleration, velocity, direction, one; zero where there is no equation.
    fn with_rest(&self, first: &DVector<f64>) -> DMatrix<f64> {
        let one = |m: usize| if self.means.row(m).iter().any(|x| *x != 0.0) { 1.0 } else { 0.0 };
        DMatrix::from_fn(first.len(), 5, |m, c| match c {
            0 => first[m],
            1..=3 => self.means[(m, c + 2)],
            _ => one(m),
        })
    }

    fn series(&self, column: usize) -> DVector<f64> {
        self.means.column(column).into_owned()
    }

    /// RMS over the equations.
    fn rms(&self, series: &DVector<f64>) -> f64 {
        root_mean_square(series.as_slice()) * (series.len() as f64 / self.equations.max(1) as f64).sqrt()
    }

    /// Noise of a residual with its correlation in time.
    fn noise(&self, residual: &DVector<f64>, fitted: usize) -> NoiseModel {
        let left = self.equations.saturating_sub(fitted).max(1) as f64;
        let mut products = LagProducts::new(residual.as_slice(), 1, self.wraps);
        NoiseModel::adaptive(|l| products.product(l) / left, residual.len() / 4, self.wraps, left)
    }

    fn stiffness(&self, robot: &Robot) -> Result<TransmissionStiffness, CalibrationError> {
        let joint = &robot.joints()[self.index];
        let (torque, wind_up, instrument) = (self.series(0), self.series(1), self.series(2));
        let mean = wind_up.sum() / self.equations.max(1) as f64;
        let about = DVector::from_fn(wind_up.len(), |m, _| if wind_up[m] == 0.0 { 0.0 } else { wind_up[m] - mean });
        let [unit, rotor_unit, wind_up_unit, residual_unit] = match joint.kind {
            JointKind::Revolute => ["N·m/rad", "kg·m²", "rad", "N·m"],
            JointKind::Prismatic => ["N/m", "kg", "m", "N"],
        }
        .map(str::to_owned);
        let mut answer = TransmissionStiffness {
            joint: joint.name.clone(),
            unit,
            rotor_unit,
            wind_up_unit,
            residual_unit,
            verdict: StiffnessVerdict::LikeRotor,
            stiffness: None,
            rotor: None,
            wind_up_rms: self.rms(&about),
            wind_up_noise: self.rms(&about),
            f: None,
            p_value: None,
            residual_rms: None,
            freedom: 0.0,
        };
        // What of the instrument the other columns do not have.
        let z = self.with_rest(&instrument);
        let rest = z.columns(1, 4).into_owned();
        let Ok(other) = LeastSquares::solve(&rest, &instrument) else { return Ok(answer) };
        if (&instrument - &rest * other.solution()).norm() <= ALIKE * instrument.norm() {
            return Ok(answer);
        }
        let Ok(first) = LeastSquares::solve(&z, &wind_up) else { return Ok(answer) };
        let answered = &z * first.solution();
        let unanswered = &wind_up - &answered;
        let noise = self.noise(&unanswered, z.ncols());
        let variance = first.sandwich(&(z.transpose() * noise.apply(&z)))[(0, 0)];
        let f = first.solution()[0].powi(2) / variance.max(f64::MIN_POSITIVE);
        let p_value = f_tail(f, 1.0, noise.degrees_of_freedom);
        (answer.f, answer.p_value, answer.freedom) = (Some(f), Some(p_value), noise.degrees_of_freedom);
        answer.wind_up_noise = self.rms(&unanswered);
        answer.verdict = StiffnessVerdict::Hidden;
        if f < WEAK || p_value > LEVEL / robot.dof() as f64 {
            return Ok(answer);
        }
        let x = self.with_rest(&answered);
        let Ok(second) = LeastSquares::solve(&x, &torque) else { return Ok(answer) };
        let residual = &torque - self.with_rest(&wind_up) * second.solution();
        let noise = self.noise(&residual, x.ncols());
        let covariance = second.sandwich(&(x.transpose() * noise.apply(&x)));
        let measured = |at: usize| {
            let std = covariance[(at, at)].max(0.0).sqrt();
            Measured::new(second.solution()[at], std, noise.degrees_of_freedom)
        };
        let stiffness = measured(0);
        // An answer of the wrong sign, or one that could be any, is none.
        if stiffness.value > student_quantile(0.975, noise.degrees_of_freedom) * stiffness.std {
            answer.verdict = StiffnessVerdict::Decided;
            (answer.stiffness, answer.rotor) = (Some(stiffness), Some(measured(1)));
            (answer.residual_rms, answer.freedom) = (Some(self.rms(&residual)), noise.degrees_of_freedom);
        }
        Ok(answer)
    }
}
