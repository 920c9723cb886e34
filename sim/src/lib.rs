//! Plants: engines that turn joint torques into motion, behind [`armid::experiment::Plant`], and how far they agree.
//!
//! | to | begin at |
//! |---|---|
//! | simulate an arm with its servo, effects and motors | [`SimulatedArm`] |
//! | simulate a plant by any engine | [`Engine::plant`], inside an [`armid::experiment::Servo`] |
//! | simulate many runs at once, by the project's equations | [`AnalyticPlant`], [`record_runs`], [`AnalyticBatch`] |
//! | simulate by an independent engine | [`RapierPlant`], [`MujocoPlant`] |
//! | write an arm as MJCF | [`mjcf`], [`mjcf_for_exchange`] |
//! | compare the engines | [`agreement::agree`] |
//! | identify by simulation, in closed loop with the known servo | [`closed_loop`] |
//!
//! One experiment on two engines that share no code:
//!
//! ```
//! use armid::experiment::{ExperimentPlan, Servo, record};
//! use armid::model::bundled;
//! use armid::model::format::{parse_nominal, parse_robot};
//! use armid::trajectory::{FourierJoint, FourierTrajectory};
//! use armid_sim::Engine;
//!
//! let robot = parse_robot(bundled()[3].robot)?;
//! let parameters = parse_nominal(bundled()[3].nominal, &robot)?.parameters;
//! let series = |name: &str| FourierJoint { name: name.into(), a: vec![0.2], b: vec![0.1], q0: 0.0 };
//! let joints = robot.joints().iter().map(|joint| series(&joint.name)).collect();
//! let plan = ExperimentPlan::new(FourierTrajectory { period_s: 2.0, joints }).with_periods(1);
//!
//! let mut ends = Vec::new();
//! for engine in [Engine::Analytic, Engine::Rapier] {
//!     let mut servo = Servo::new(&robot, &parameters, engine.plant(&robot, &parameters)?)?;
//!     let (recording, ending) = record(&mut servo, &plan)?;
//!     assert!(ending.is_complete() && recording.periods() == 1);
//!     ends.push(recording.q[recording.q.len() - 1]);
//! }
//! assert!((ends[0] - ends[1]).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![deny(unsafe_code)]

pub mod agreement;
mod analytic;
mod closed_loop;
mod engine;
mod mujoco;
mod rapier;
mod simulated_arm;

pub use analytic::{AnalyticBatch, AnalyticError, AnalyticPlant, BatchRun, MOST_JOINTS, perform_runs, record_runs};
pub use closed_loop::{SimulatedLoop, closed_loop};
pub use engine::{Engine, EngineError};
pub use mujoco::{
    MujocoError, MujocoModel, MujocoPlant, MujocoScheme, MujocoStatus, MujocoStepper, mjcf, mjcf_for_exchange,
};
pub use rapier::{DEFAULT_SUBSTEPS, RapierError, RapierPlant};
pub use simulated_arm::{SimulatedArm, SimulationError};
