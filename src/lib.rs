//! armid identifies the dynamic parameters of robot arms, and shows by simulation which design and which estimator
//! to trust before the robot moves.
//!
//! The modules read as the method section of a paper; each imports only from those above it:
//!
//! ```text
//! Robot → JointTorqueRegressor → BaseReduction → Design → ExperimentPlan → Recording → Samples → Observation → Estimate → StudyResult
//! ```
//!
//! | to | begin at |
//! |---|---|
//! | describe a robot | [`model::Robot`], [`model::format`] for TOML, URDF and MJCF |
//! | evaluate its dynamics | [`dynamics::Dynamics`], [`regressor::JointTorqueRegressor`] |
//! | find the base parameters | [`base::reduce`] |
//! | design a trajectory | [`excitation::DesignProblem`], [`excitation::design()`] |
//! | perform it | [`experiment::ExperimentPlan`] and [`experiment::record`] on any [`experiment::Arm`]; a simulated one is a [`experiment::Servo`] around a [`experiment::Plant`] |
//! | process what was recorded | [`signal::process`] |
//! | identify and validate | [`estimation::Identification`] |
//! | find a mistake in a log or a robot file | [`diagnosis::diagnose`] |
//! | measure torque constants and friction | [`calibration`] |
//! | compare methods | [`study`] |
//! | watch long work and end it | [`observer::Observer`] |
//! | add a torque term, an estimator, a criterion, a trajectory, a plant or an arm | its trait, and its laws in [`conformance`] |
//!
//! From a robot to its base parameters and their estimate:
//!
//! ```
//! use armid::dynamics::Dynamics;
//! use armid::estimation::{EstimatorKind, Identification};
//! use armid::model::format::{parse_nominal, parse_robot};
//! use armid::model::{Columns, bundled};
//! use armid::signal::Samples;
//! use armid::study::radkhah2007::table_one;
//! use armid::trajectory::PeriodicTrajectory;
//!
//! let robot = parse_robot(bundled()[0].robot)?;
//! let identification = Identification::new(&robot, Columns::RIGID)?;
//! assert_eq!((robot.name(), robot.dof(), identification.base().rank()), ("crs-a460", 6, 36));
//!
//! // Samples come from `signal::process`, or from a log through `armid-io`; here exact torques along a trajectory.
//! let truth = parse_nominal(bundled()[0].nominal, &robot)?.parameters.links_alone();
//! let states = PeriodicTrajectory::from(table_one::corrected()).sample(500);
//! let (mut dynamics, mut tau) = (Dynamics::new(&robot, &truth), vec![0.0; 500 * 6]);
//! for (k, tau) in tau.chunks_exact_mut(6).enumerate() {
//!     dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
//! }
//! let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 6], 50.0);
//!
//! let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator())?;
//! let exact = identification.base().beta(&truth.vector(&robot, Columns::RIGID));
//! assert!((estimate.beta() - exact).amax() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! The crate `armid-io` reads and writes files: its first page goes from a log to parameters in a few lines. `armid-sim` has
//! simulated arms, and `examples/` one short program for each task.
//!
//! [`model::Robot`], [`experiment::Recording`], [`signal::Samples`], [`base::BaseReduction`], [`estimation::Estimate`] and
//! [`excitation::Design`] are plain values: serde writes and reads them, and what is read goes through the same checks as
//! what is made.
//!
//! Conventions (fixed in `NOTATION.md`): SI units; six-dimensional vectors with the angular part first; the ten
//! parameters of a link are `m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz` in the link's own frame.
//! The library does no input or output and reads no clock.
#![forbid(unsafe_code)]

#[doc(inline)]
pub use armid_estimation::{calibration, diagnosis, estimation};
#[doc(inline)]
pub use armid_excitation::excitation;
#[doc(inline)]
pub use armid_measurement::{experiment, signal};
use armid_mechanics::plain;
#[doc(inline)]
pub use armid_mechanics::{
    base, chains, codegen, dynamics, input, lanes, linalg, model, number, observer, optimiser, provenance, regressor,
    remedy, seed, spatial, statistics, trajectory,
};

pub mod study;
pub mod conformance;
