//! Performing an experiment: what is asked for, what carries it out, and what it leaves behind.
//!
//! ```text
//! ExperimentPlan ── Arm ──→ Recording          Arm = Servo<P: Plant> | a real robot | Replay
//!
//!                 ┌────────────────────── Servo ─────────────────────┐
//! command r(t) ─→ │ PID ─ current limit ─ Kt, gear, coupling ─ Plant │
//!                 │  └──────── encoder counts ←──────────────────┘   │ ─→ q̂, î at rate_hz
//! ```
//! A [`Plant`] turns torque into motion; a [`Servo`] puts the controller and the sensors of a real arm around it, so
//! that a simulated experiment and a real one differ in nothing that a later stage can see. Which of them performs a
//! plan is one option for the user and one type here.
//!
//! Time: sample k is taken at `t = k / rate_hz` after the beginning; torques are held over a servo step. Wall time
//! plays no part. Every random number comes from the servo's seed and run.

mod arm;
mod command;
mod command_table;
mod continuation;
mod controller;
mod cycle;
mod cycle_group;
mod effects;
mod expectation;
mod joint_loop;
mod joint_loops;
mod layout;
mod limit_check;
mod loop_slopes;
mod motor_load;
mod motors;
mod normals;
mod phase;
mod plan;
mod plan_error;
mod plan_mismatch;
mod plant;
mod raw_sample;
mod received_state;
mod recorder;
mod recording;
mod replay;
mod sensing;
mod servo;
mod servo_error;
mod tracking;
mod transmission;
mod trip;
pub mod hinges;

pub use arm::{Arm, ArmError, DivergenceError, Ending, Flow, Sink};
pub use command::Command;
pub use command_table::CommandTable;
pub use continuation::{Continuation, ContinuationError, Joined};
pub use controller::JointPid;
pub use cycle::{Cycle, Next, TrueState};
pub use cycle_group::CycleGroup;
pub use effects::{ActualArm, EffectEntry, EffectKind, Effects, ExpectedEffectError, Level};
pub use expectation::Expectation;
pub use joint_loop::JointLoop;
pub use joint_loops::Runs;
pub use layout::Layout;
pub use loop_slopes::LoopSlopes;
pub use motor_load::{MotorLoad, gain_pose};
pub use phase::{Phase, PhaseSpan};
pub use plan::ExperimentPlan;
pub use plan_error::PlanError;
pub use plan_mismatch::PlanMismatchError;
pub use plant::{Plant, PlantError};
pub use raw_sample::RawSample;
pub use received_state::ReceivedState;
pub use recorder::{Discarding, Recorder, record, record_watched};
pub use recording::Recording;
pub use replay::Replay;
pub use sensing::Sensing;
pub use servo::Servo;
pub use servo_error::ServoError;
pub use tracking::Tracking;
pub use transmission::Transmission;
pub use trip::{Rest, SafeAction, TripReport};
