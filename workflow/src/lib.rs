//! What the command `armid` does, as functions: settings in, a plain answer out.
//!
//! | to | call |
//! |---|---|
//! | evaluate the equations of motion | [`dynamics()`], [`regressor`] |
//! | find the base parameters | [`reduce`] |
//! | simulate a loaded robot | [`simulated_arm`], [`simulate`] |
//! | design a trajectory, write its set-points | [`design::design`], [`SetPoints`] |
//! | identify a log | [`identification::identify`] |
//! | predict another log | [`validate`], [`validate_model`] |
//! | write a model or source code | [`export::export`], [`export::export_source`] |
//! | draw a page | [`report`] |
//! | find what the last link carries, or torque constants by a known load | [`payload()`], [`drive_gains()`] |
//! | find motion and estimator for an arm before it moves | [`advice::advise`] |
//! | design, perform and identify until targets are met | [`campaign::Campaign`] |
//! | perform a study | [`study::perform`], [`study::merge`] |
//!
//! From a robot to its parameters, on a simulated arm:
//!
//! ```
//! use armid::excitation::CriterionKind;
//! use armid::experiment::ExperimentPlan;
//! use armid::observer::Unobserved;
//! use armid_io::{LogSettings, robot};
//! use armid_workflow::design::{DesignGoal, DesignSettings, design};
//! use armid_workflow::identification::{IdentifySettings, identify};
//! use armid_workflow::{SimulationSettings, simulate};
//!
//! let loaded = robot::find("planar-2r")?;
//! let goal = DesignGoal::Arm(CriterionKind::DOptimal.into());
//! let settings = DesignSettings { starts: 1, evaluations: 20, baseline: false, ..DesignSettings::new(goal) };
//! let designed = design(&loaded, &settings, &Unobserved)?.ok_or("nobody ended the search")?;
//! let plan = ExperimentPlan::new(designed.best.trajectory);
//! let log = simulate(&loaded, &plan, &SimulationSettings::default(), &Unobserved)?.log();
//! let log = log.process(loaded, &LogSettings::default())?;
//! let answer = identify(log, None, &IdentifySettings::default(), &Unobserved)?;
//! assert!(answer.is_sound() && answer.estimates[0].used.used.total < Some(0.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Work that takes long reports to an [`Observer`](armid::observer::Observer), which may end it. Nothing here knows a terminal.

pub mod advice;
pub mod campaign;
mod counter;
pub mod design;
mod drive_gains;
mod dynamics;
pub mod export;
pub mod identification;
mod log_source;
pub mod numbers;
mod payload;
mod reduction;
pub mod report;
mod set_points;
mod simulation;
pub mod study;
mod validation;

pub use drive_gains::{DriveGainsAnswer, drive_gains};
pub use dynamics::{DynamicsAnswer, Quantity, dynamics, parameters_of, regressor};
pub use log_source::{LogSource, NamedLogs};
pub use payload::{PayloadAnswer, PayloadSide, columns_of, payload};
pub use reduction::{ReductionAnswer, ReductionSettings, reduce};
pub use set_points::{PointFormat, SetPoints};
pub use simulation::{Simulated, SimulationSettings, simulate, simulated_arm};
pub use validation::{ValidationAnswer, ValidationVerdict, validate, validate_model};
