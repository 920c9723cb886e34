//! The files of armid as values, and the way from a log to parameters in a few lines.
//!
//! | from | to | by |
//! |---|---|---|
//! | a name or a file | [`LoadedRobot`]: robot, nominal parameters, text | [`robot::find`], [`robot::load`] |
//! | MCAP, bags, and tables as text, gzip, NumPy or Parquet | [`Log`] | [`Log::read`], [`log::parse_csv`], [`log::parse_mcap`] |
//! | tables of any shape | [`Log`] | [`log::find`], [`log::parse_tables`] with a [`log::Mapping`] |
//! | meshes of a URDF | shapes that a clearance is held against | [`LoadedRobot::hold_collision_shapes`], [`mesh::read`] |
//! | a URDF | a `robot.toml`, a folder to begin with | [`robot::begin`], [`starter::Starter`] |
//! | a log and a robot | [`ProcessedLog`]: samples with their noise | [`Log::process`] |
//! | samples | an estimate with its intervals and findings | [`ProcessedLog::identify`] |
//! | an estimate and another log | how well it predicts | [`ProcessedLog::validate`] |
//! | `T.toml`, a bundled name | a trajectory and its certificate | [`trajectory::load`], [`trajectory::certificate`] |
//! | `experiment.toml` | [`Experiment`]: plan, sensing, effects | [`experiment::load`] |
//! | an experiment on any arm | a recording on disk | [`recording::McapSink`], [`recording::CsvSink`] |
//! | `E.json` | an estimate, or the prior of a design | [`estimate::read`], [`prior::set_prior`] |
//! | `study.toml`, a folder | a plan, the work as it gets done, the results | [`study`] |
//!
//! Reduction ([`armid::base::reduce`]), design ([`armid::excitation::design`]) and everything else that computes is in
//! [`armid`] itself. Every fault of a file is an [`Error`] with its kind, its place and what helps. Every file
//! that is written at once goes through [`output`], whole or not at all, through a power cut too.
//!
//! The whole way, from a log to parameters and a check of them:
//!
//! ```
//! use armid::estimation::EstimatorKind;
//! use armid::model::Columns;
//! use armid_io::{LogSettings, Text, log, robot};
//! # use std::fmt::Write;
//! # fn simulated(phase: f64) -> Result<Text, Box<dyn std::error::Error>> {
//! #     let loaded = robot::find("planar-2r")?;
//! #     let truth = loaded.truth()?.parameters;
//! #     let mut dynamics = armid::dynamics::Dynamics::new(&loaded.robot, &truth);
//! #     let mut csv = "t,q1,q2,tau1,tau2\n".to_owned();
//! #     let (mut noise, mut tau) = (1_u64, [0.0; 2]);
//! #     for k in 0..2500 {
//! #         let t = k as f64 / 250.0;
//! #         let [mut q, mut qd, mut qdd] = [[0.0; 2]; 3];
//! #         for j in 0..2 {
//! #             for l in 1..=4 {
//! #                 let w = std::f64::consts::PI * l as f64;
//! #                 let (s, c) = (w * t + phase * (j + l) as f64 + j as f64).sin_cos();
//! #                 (q[j], qd[j], qdd[j]) = (q[j] + 0.2 * s, qd[j] + 0.2 * w * c, qdd[j] - 0.2 * w * w * s);
//! #             }
//! #         }
//! #         dynamics.inverse(&q, &qd, &qdd, &mut tau);
//! #         for x in tau.iter_mut() {
//! #             noise = noise.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
//! #             *x += 1e-3 * ((noise >> 40) as f64 / (1_u64 << 24) as f64 - 0.5);
//! #         }
//! #         writeln!(csv, "{t},{},{},{},{}", q[0], q[1], tau[0], tau[1])?;
//! #     }
//! #     Ok(Text::new("log.csv", csv))
//! # }
//! # let (text, other) = (simulated(1.0)?, simulated(2.0)?);
//! let settings = LogSettings::periodic(2.0);
//! let measured = log::parse_csv(text)?.process(robot::find("planar-2r")?, &settings)?;
//! let estimate = measured.identify(Columns::RIGID_ROTOR_FRICTION, EstimatorKind::Wls)?;
//! for parameter in &estimate.base {
//!     println!("{} = {} ± {} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
//! }
//! let unused = log::parse_csv(other)?.process(robot::find("planar-2r")?, &settings)?;
//! assert!(unused.validate(&estimate, "the estimate")?.is_within(0.01));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! With files, [`Log::read`] takes the place of [`log::parse_csv`]. `examples/` has one program for each of: the whole method
//! from design to validation, identify from a CSV, design for one's own robot, an estimator of one's own, an arm of one's
//! own, a small study.
#![forbid(unsafe_code)]

pub mod bundled_experiments;
pub mod error;
pub mod estimate;
pub mod experiment;
pub mod inputs;
pub mod log;
pub mod mesh;
pub mod output;
pub mod prior;
pub mod recording;
pub mod robot;
pub mod starter;
pub mod study;
pub mod suggestion;
pub mod table;
pub mod text;
pub mod trajectory;

pub use error::{Error, ErrorKind};
pub use experiment::Experiment;
pub use inputs::Inputs;
pub use log::{Log, LogSettings, ProcessedLog};
pub use robot::LoadedRobot;
pub use text::Text;
