//! The real arm: its ROS 2 interface, the guard that every command passes, and a simulated robot controller.
//!
//! Nothing else in armid can move a real arm, and nothing here moves one except through the guard.
//!
//! | to | begin at |
//! |---|---|
//! | perform experiments on a real arm | [`guarded_ros2`], with [`link::LinkSettings`] and [`guard::GuardSettings`] |
//! | see what it would check, and how soon it stops the arm | [`guard`], [`guard::Trip`] |
//! | guard any other arm | [`guard::Guarded`] |
//! | look at a robot without moving it | [`link::look`], [`link::peers`], [`monitor::Monitor`] |
//! | rehearse without a robot | [`computer::RobotController`] around a plant, [`computer::serve()`] |
//! | encode and decode its messages | [`message`] |
//!
//! A simulated arm in place of a real one, behind the guard:
//!
//! ```
//! use armid::conformance::chains::planar_2r;
//! use armid::experiment::{Ending, ExperimentPlan, Servo, record};
//! # use armid::experiment::{Plant, PlantError};
//! use armid::model::StandardParameters;
//! use armid::model::term::ROTOR;
//! use armid::trajectory::{FourierJoint, FourierTrajectory};
//! use armid_hardware::guard::{GuardSettings, Guarded, Mode};
//! # /// Two flywheels of 2 kg·m².
//! # struct FlyWheels([f64; 2], [f64; 2]);
//! # impl Plant for FlyWheels {
//! #     fn dof(&self) -> usize { 2 }
//! #     fn state(&self) -> (&[f64], &[f64]) { (&self.0, &self.1) }
//! #     fn reset(&mut self, q: &[f64], qd: &[f64]) {
//! #         self.0.copy_from_slice(q);
//! #         self.1.copy_from_slice(qd);
//! #     }
//! #     fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
//! #         for i in 0..2 {
//! #             self.1[i] += dt * tau[i] / 2.0;
//! #             self.0[i] += dt * self.1[i];
//! #         }
//! #         Ok(())
//! #     }
//! # }
//!
//! let robot = planar_2r();
//! let mut nominal = StandardParameters::zero(2);
//! nominal.drives.iter_mut().for_each(|drive| drive[ROTOR] = 2.0);
//! let series = |name: &str| FourierJoint { name: name.into(), a: vec![0.4], b: vec![0.1], q0: 0.3 };
//! let trajectory = FourierTrajectory { period_s: 2.0, joints: vec![series("shoulder"), series("elbow")] };
//! let plan = ExperimentPlan::new(trajectory).with_periods(1);
//!
//! let perform = |settings: &GuardSettings| -> Result<Ending, Box<dyn std::error::Error>> {
//!     let servo = Servo::new(&robot, &nominal, FlyWheels([0.0; 2], [0.0; 2]))?;
//!     let (_, ending) = record(&mut Guarded::new(servo, &robot, settings, Mode::Trajectory), &plan)?;
//!     Ok(ending)
//! };
//! assert!(perform(&GuardSettings::default())?.is_complete());
//! // No servo follows its command within 0.01 degrees all the time: the guard ends the motion.
//! let strict = GuardSettings { following_error_deg: 0.01, ..GuardSettings::default() };
//! assert!(matches!(perform(&strict)?, Ending::Tripped { .. }));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod computer;
pub mod guard;
pub mod link;
pub mod message;
pub mod monitor;
mod ros2;

pub use ros2::{GUARD_STATE, GuardedRos2, guarded_ros2};
