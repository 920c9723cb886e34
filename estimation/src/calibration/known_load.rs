//! Torque constants without motor voltages: from the torque that a known payload adds.
//!
//! ```text
//! τ̂_k = N_k Kt°_k i_k = (Kt°_k / Kt_k) (Y_k φ + s Y_load,k φ_load)        s = 0 without the payload, 1 with it
//! ```
//! `Kt°` is that of the robot file and `Y_k φ` is the arm's own torque, whose parameters are unknown and scaled alike.
//! Each joint is an equation of its own: its base columns, and one column that is known in N·m and whose coefficient is
//! `Kt°/Kt`. Both recordings enter together, so that the arm need not follow its command alike in both.
//!
//! A joint with a vertical axis shows the payload through its inertia only: its interval is wider.
//!
//! Reference: M. Gautier, S. Briot, "Global identification of joint drive gains and dynamic parameters of robots", ASME J.
//! Dyn. Syst. Meas. Control 136(5), 2014.

use std::fmt;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::error::CalibrationError;
use crate::base::{BaseReduction, Method};
use crate::estimation::Measured;
use crate::linalg::{LeastSquares, LeastSquaresError, RankTolerance};
use crate::model::{Columns, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;
use crate::spatial::Inertia;

/// The result for one joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct KnownLoad {
    /// Name of the joint.
    pub joint: String,
    /// Torque constant of its motor, N·m/A.
    pub torque_constant: Measured,
    /// The value in the robot file, N·m/A.
    pub assumed: f64,
    /// RMS of the torque that the payload adds, N·m (N).
    pub load_rms: f64,
    /// RMS residual of the equations, N·m (N) with the assumed constant.
    pub residual_rms: f64,
}

/// A joint whose torque constant a payload does not show.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HiddenLoad {
    /// Name of the joint.
    pub joint: String,
    /// RMS of the torque that the payload adds, N·m (N).
    pub load_rms: f64,
    /// Unit of it.
    pub unit: String,
    /// Why that is not enough.
    pub reason: String,
}

impl HiddenLoad {
    /// Advice.
    pub const fn advice(&self) -> &'static str {
        "attach the payload further from this joint's axis, take a heavier one, or move the joint more; or measure the \
         back-EMF"
    }
}

impl fmt::Display for HiddenLoad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { joint, load_rms, unit, reason } = self;
        write!(
            f,
            "joint \"{joint}\": the payload adds {load_rms:.3} {unit} RMS, which does not identify the torque constant: {reason}"
        )
    }
}

/// The torque constants of a robot's motors from a known payload, joint by joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct KnownLoads {
    /// The joints whose torque constants it shows.
    pub shown: Vec<KnownLoad>,
    /// The others.
    pub hidden: Vec<HiddenLoad>,
}

/// A payload about the origin of the last link's frame, from its mass (kg), its centre there (m), and its moments of
/// inertia about that centre along the frame's axes (kg·m²).
pub fn payload(mass_kg: f64, centre_m: [f64; 3], inertia_kg_m2: [f64; 3]) -> Inertia {
    let about = Matrix3::from_diagonal(&Vector3::from(inertia_kg_m2));
    Inertia::from_com(mass_kg, Vector3::from(centre_m), about)
}

/// Measures every torque constant from the samples of one motion without and with a payload that sits in the last link,
/// `load` about the origin of that link's frame.
///
/// # Errors
/// [`CalibrationError`] where samples and robot do not belong together, or motors are coupled. A joint in which the
/// payload does not show is no error: it is listed among the hidden ones.
pub fn known_load(
    robot: &Robot,
    without: &Samples,
    with: &Samples,
    load: &Inertia,
) -> Result<KnownLoads, CalibrationError> {
    let n = robot.dof();
    if without.dof() != n || with.dof() != n {
        let found = format!("of {} and {} joints", without.dof(), with.dof());
        return Err(CalibrationError::unfit("samples", found, "samples of the robot"));
    }
    if let Some(joint) = (0..n).find(|&joint| robot.is_coupled(joint)) {
        let found = format!("joint \"{}\" is driven by several", robot.joints()[joint].name);
        return Err(CalibrationError::unfit("motors", found, "one motor for each joint; use the back-EMF"));
    }
    let regressor = JointTorqueRegressor::new(robot, Columns::RIGID_ROTOR_FRICTION).expect("columns of motion");
    let parts = [Part::new(&regressor, without, 0.0), Part::new(&regressor, with, 1.0)];
    let phi = DVector::from_row_slice(&load.to_array());
    let mut found = KnownLoads { shown: Vec::new(), hidden: Vec::new() };
    for joint in 0..n {
        match one(robot, &regressor, &parts, &phi, joint) {
            Ok(shown) => found.shown.push(shown),
            Err(hidden) => found.hidden.push(hidden),
        }
    }
    Ok(found)
}

/// The block means of one recording.
struct Part<'a> {
    samples: &'a Samples,
    /// Stacked regressor, Mn × p.
    w: DMatrix<f64>,
    tau: Vec<f64>,
    load: f64,
}

impl<'a> Part<'a> {
    fn new(regressor: &JointTorqueRegressor, samples: &'a Samples, load: f64) -> Self {
        let n = samples.dof();
        let stacked = regressor.stack(&samples.states);
        let (blocks, block) = (samples.blocks(), samples.block);
        let share = 1.0 / block as f64;
        let w = DMatrix::from_fn(blocks * n, stacked.ncols(), |row, column| {
            let (m, joint) = (row / n, row % n);
            (m * block..(m + 1) * block).map(|k| share * stacked[(k * n + joint, column)]).sum()
        });
        Self { samples, w, tau: samples.block_means(&samples.tau, n), load }
    }

    /// Rows of a joint that are an equation.
    fn rows(&self, joint: usize) -> impl Iterator<Item = usize> {
        let n = self.samples.dof();
        (0..self.samples.blocks()).map(move |m| m * n + joint).filter(|&row| self.samples.used[row])
    }
}

fn one(
    robot: &Robot,
    regressor: &JointTorqueRegressor,
    parts: &[Part<'_>; 2],
    phi: &DVector<f64>,
    joint: usize,
) -> Result<KnownLoad, HiddenLoad> {
    let rows: Vec<(&Part<'_>, usize)> =
        parts.iter().flat_map(|part| part.rows(joint).map(move |row| (part, row))).collect();
    let p = regressor.cols();
    let last = 10 * (robot.dof() - 1);
    let own = DMatrix::from_fn(rows.len(), p, |k, column| rows[k].0.w[(rows[k].1, column)]);
    let base = BaseReduction::from_stack(regressor.parameters(), &own, Method::Qr);
    let kept = base.select_columns(&own);
    let load =
        DVector::from_fn(rows.len(), |k, _| rows[k].0.load * (0..10).map(|i| own[(k, last + i)] * phi[i]).sum::<f64>());
    let w =
        DMatrix::from_fn(
            rows.len(),
            kept.ncols() + 1,
            |k, column| {
                if column < kept.ncols() { kept[(k, column)] } else { load[k] }
            },
        );
    let y = DVector::from_iterator(rows.len(), rows.iter().map(|(part, row)| part.tau[*row]));
    let name = robot.joints()[joint].name.clone();
    let loaded = rows.iter().filter(|(part, _)| part.load > 0.0).count().max(1);
    let load_rms = load.norm() / (loaded as f64).sqrt();
    let unit = robot.joints()[joint].kind.effort_unit().to_owned();
    let hidden = |reason: String| HiddenLoad { joint: name.clone(), load_rms, unit: unit.clone(), reason };
    // What is left of terms that cancel is rounding.
    let terms = |k: usize| (0..10).map(|i| (own[(k, last + i)] * phi[i]).powi(2)).sum::<f64>();
    let size = (0..rows.len()).map(|k| rows[k].0.load * terms(k)).sum::<f64>().sqrt();
    if load.norm() <= RankTolerance::default().independent * size {
        return Err(hidden("it causes no torque at the joint".to_owned()));
    }
    let fit = LeastSquares::solve(&w, &y).map_err(|fault| match fault {
        LeastSquaresError::Dependent { column, .. } if column == kept.ncols() => {
            hidden("it cannot be distinguished from the joint's own torque on this motion".to_owned())
        }
        fault => hidden(fault.to_string()),
    })?;
    let residual = &y - &w * fit.solution();
    let freedom = (w.nrows() - w.ncols()) as f64;
    let variance = residual.norm_squared() / freedom;
    let gain = fit.solution()[kept.ncols()];
    let spread = (variance * fit.inverse_information()[(kept.ncols(), kept.ncols())]).sqrt();
    let drive = &robot.joints()[joint].drive;
    let inverse = Measured::new(gain, spread, freedom);
    if inverse.ci95[0] <= 0.0 {
        // As well no payload: no torque constant is too large.
        let [low, high] = inverse.ci95;
        return Err(hidden(format!("its share in what was measured is {gain:.2}, 95 % from {low:.2} to {high:.2}")));
    }
    // Kt = Kt° / gain: the ends of the interval go through the same function, the deviation to first order.
    let through = |gain: f64| drive.torque_constant / gain;
    let ends = [through(inverse.ci95[1]), through(inverse.ci95[0])];
    Ok(KnownLoad {
        joint: name.clone(),
        torque_constant: Measured {
            value: through(gain),
            std: drive.torque_constant * spread / (gain * gain),
            ci95: ends,
        },
        assumed: drive.torque_constant,
        load_rms,
        residual_rms: (residual.norm_squared() / rows.len() as f64).sqrt(),
    })
}
