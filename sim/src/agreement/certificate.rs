//! The certificate: what was measured, and whether it is enough.

use armid::model::StandardParameters;
use armid::model::term::ROTOR;

use super::case::Case;
use super::free_motion::{CERTIFIED, FreeMotion, StepError, distance, order};
use super::{Tolerance, closed_loop, equations};
use crate::Engine;
use crate::engine::EngineError;

/// How far engines agree on one robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Agreement {
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints.
    pub joints: Vec<String>,
    /// How long free motion lasts, s.
    pub horizon_s: f64,
    /// The step at which energy and pairs are compared in free motion, s.
    pub step_s: f64,
    /// Largest travel of a joint in free motion, rad (m).
    pub travel: f64,
    /// Error of the reference that free motion is compared with, rad (m).
    pub reference_error: f64,
    /// The engines that were there.
    pub engines: Vec<EngineAgreement>,
    /// Every two of them.
    pub pairs: Vec<PairDifference>,
    /// The engines that cannot simulate this robot here.
    pub absent: Vec<Absent>,
    /// The engines whose motion did not go on to the end.
    pub failed: Vec<Absent>,
}

/// What one engine does.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EngineAgreement {
    /// Which engine.
    pub engine: Engine,
    /// Largest torque by which its equations of motion differ from the core's, relative to the largest torque.
    pub equations: f64,
    /// Error of free motion, the coarsest step first.
    pub errors: Vec<StepError>,
    /// Order of convergence by the three finest steps above rounding; `None` where rounding leaves fewer.
    pub order: Option<f64>,
    /// Error of free motion at the certificate's step, relative to the largest travel.
    pub free: f64,
    /// Largest change of energy in free motion at that step, relative to the energy that moved.
    pub energy: f64,
}

/// How far two engines are apart.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PairDifference {
    /// Which two.
    pub engines: (Engine, Engine),
    /// Largest distance of a joint in free motion, rad (m).
    pub free: f64,
    /// Largest distance of each joint in the recorded period of the closed loop, rad (m); n.
    pub closed_loop: Vec<f64>,
    /// Largest difference of each joint's effort there, N·m (N); n.
    pub closed_loop_effort: Vec<f64>,
}

impl PairDifference {
    /// The largest distance of any joint in the closed loop, rad (m).
    pub fn largest(&self) -> f64 {
        // NaN must not be lost on the way.
        self.closed_loop.iter().fold(0.0, |most, &d| if d <= most { most } else { d })
    }
}

/// An engine that is not compared.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Absent {
    /// Which engine.
    pub engine: Engine,
    /// Why.
    pub reason: String,
}

/// A tolerance that is not kept.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Breach {
    /// Which engine.
    pub engine: Engine,
    /// Which quantity.
    pub quantity: String,
    /// What was found; `None` where it could not be measured.
    pub found: Option<f64>,
    /// The smallest and the largest that is allowed.
    pub allowed: (f64, f64),
}

/// Measures how far these engines agree.
///
/// An engine that cannot simulate the robot is absent, one that breaks off has failed, each with the reason; the others
/// are compared.
pub fn agree(case: &Case<'_>, engines: &[Engine]) -> Agreement {
    let mut smooth = case.truth.clone();
    for drive in &mut smooth.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    let motion = FreeMotion::new(case.robot, &smooth, case.seed);
    let (mut absent, mut failed) = (Vec::new(), Vec::new());
    let mut present = Vec::new();
    for &engine in engines {
        if let Err(EngineError { engine, reason }) = engine.plant(case.robot, case.truth) {
            absent.push(Absent { engine, reason });
            continue;
        }
        match measure(case, &smooth, &motion, engine) {
            Ok(measured) => present.push(measured),
            Err(EngineError { engine, reason }) => failed.push(Absent { engine, reason }),
        }
    }
    let mut pairs = Vec::new();
    for (i, (first, free_first, loop_first)) in present.iter().enumerate() {
        for (second, free_second, loop_second) in &present[i + 1..] {
            let free = free_first.iter().zip(free_second).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
            pairs.push(PairDifference {
                engines: (first.engine, second.engine),
                free,
                closed_loop: by_joint(&loop_first.q, &loop_second.q),
                closed_loop_effort: by_joint(&loop_first.tau, &loop_second.tau),
            });
        }
    }
    Agreement {
        robot: case.robot.name().to_owned(),
        joints: case.robot.joints().iter().map(|joint| joint.name.clone()).collect(),
        horizon_s: FreeMotion::horizon_s(),
        step_s: FreeMotion::step_s(CERTIFIED),
        travel: motion.travel,
        reference_error: motion.reference_error,
        engines: present.into_iter().map(|(engine, ..)| engine).collect(),
        pairs,
        absent,
        failed,
    }
}

type Measured = (EngineAgreement, Vec<Vec<Vec<f64>>>, closed_loop::Performed);

fn measure(
    case: &Case<'_>,
    smooth: &StandardParameters,
    motion: &FreeMotion<'_>,
    engine: Engine,
) -> Result<Measured, EngineError> {
    let followed = motion.follow(engine)?;
    // Below this an error is the reference's or rounding's.
    let floor = motion.reference_error.max(f64::EPSILON * motion.travel.max(1.0));
    let own = EngineAgreement {
        engine,
        equations: equations::residual(engine, case.robot, smooth, case.seed)?,
        order: order(&followed.errors, floor),
        free: followed.errors[CERTIFIED as usize].error / motion.travel,
        energy: followed.energy,
        errors: followed.errors,
    };
    Ok((own, followed.positions, closed_loop::perform(engine, case)?))
}

/// Largest difference of each column.
fn by_joint(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<f64> {
    let mut most = vec![0.0_f64; a.first().map_or(0, Vec::len)];
    for (a, b) in a.iter().zip(b) {
        for ((most, a), b) in most.iter_mut().zip(a).zip(b) {
            let d = (a - b).abs();
            *most = if d <= *most { *most } else { d };
        }
    }
    most
}

impl Agreement {
    /// Whether every engine that is there went on to the end and kept its tolerances.
    pub fn holds(&self) -> bool {
        self.failed.is_empty() && self.breaches().is_empty()
    }

    /// Every tolerance that is not kept; empty where the engines agree.
    pub fn breaches(&self) -> Vec<Breach> {
        let mut breaches = Vec::new();
        let mut judge = |engine, quantity: &str, found: Option<f64>, (low, high): (f64, f64)| {
            if !found.is_some_and(|found| found >= low && found <= high) {
                breaches.push(Breach { engine, quantity: quantity.to_owned(), found, allowed: (low, high) });
            }
        };
        for own in &self.engines {
            let tolerance = Tolerance::for_engine(own.engine);
            judge(own.engine, "order of convergence", own.order, tolerance.order);
            judge(own.engine, "torque residual", Some(own.equations), (0.0, tolerance.equations));
            judge(own.engine, "error of free motion", Some(own.free), (0.0, tolerance.free));
            judge(own.engine, "energy balance", Some(own.energy), (0.0, tolerance.energy));
        }
        for pair in &self.pairs {
            let (first, second) = pair.engines;
            let allowed = Tolerance::for_engine(first).closed_loop + Tolerance::for_engine(second).closed_loop;
            judge(
                second,
                &format!("distance to {} in the closed loop", first.name()),
                Some(pair.largest()),
                (0.0, allowed),
            );
        }
        breaches
    }
}
