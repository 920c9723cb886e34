//! Robots and their parameters as text: TOML, URDF and MJCF. Text in, value out; nothing here opens a file.
//!
//! | text | function | value |
//! |---|---|---|
//! | `robot.toml` | [`parse_robot`], [`parse_robot_model`] | [`Robot`](super::Robot), [`RobotModel`] |
//! | `truth.toml`, `published.toml`, an export | [`parse_parameters`] | [`ParameterFile`] |
//! | `nominal.toml` | [`parse_nominal`] | [`NominalParameters`] |
//! | name → value, TOML or JSON | [`parse_parameter_map`] | [`StandardParameters`](super::StandardParameters) |
//! | URDF | [`parse_urdf`], [`parse_urdf_as_written`] | [`ImportedModel`] |
//! | MJCF | [`parse_mjcf`] | [`ImportedModel`] |
//!
//! [`write_parameters`] and [`write_urdf`] go the other way, [`write_robot`] begins a `robot.toml` over a URDF; [`edit_urdf`] and [`edit_mjcf`] put parameters into a file that
//! is there, [`note`] a comment on top of it.
//!
//! Keys carry their unit as a suffix. A link is called after the joint that moves it, the one that stands still is
//! `base`. Every fault is a [`FormatError`] that says what was found, what was expected, and the line and column.

mod arm;
mod base_table;
mod chain;
mod collision;
mod coupling_table;
mod dh_robot;
mod drive_table;
mod element;
mod embedded_urdf;
mod error;
mod joint_tables;
mod mjcf;
mod mjcf_edit;
mod mjcf_settings;
mod parameter_file;
mod parameter_map;
mod parameter_writer;
mod point_tables;
mod reading;
mod relative_uncertainty;
mod robot_file;
mod robot_model;
mod robot_writer;
mod servo_table;
mod shape_parameters;
mod shape_tables;
mod shared_inertias;
mod term_keys;
mod text_edit;
mod tree;
mod uncertainty_table;
mod urdf;
mod urdf_edit;
mod urdf_robot;
mod urdf_writer;
#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a number of the text is read to its last bit")]
mod fault_tests;
#[cfg(test)]
#[allow(clippy::float_cmp, reason = "right angles and small sums are exact")]
mod mjcf_tests;
#[cfg(test)]
mod mutation_tests;
#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a number of the text is read to its last bit")]
mod urdf_robot_tests;
#[cfg(test)]
#[allow(clippy::float_cmp, reason = "right angles and small sums are exact")]
mod urdf_tests;

pub use collision::{CollisionShape, Geometry};
pub use embedded_urdf::{UrdfReference, embed_urdf, named_urdf};
pub use error::FormatError;
pub use mjcf::parse_mjcf;
pub use mjcf_edit::edit_mjcf;
pub use parameter_file::{NominalParameters, Note, ParameterFile, parse_nominal, parse_parameters};
pub use parameter_map::{law_map, parse_parameter_map};
pub use parameter_writer::write_parameters;
pub use relative_uncertainty::RelativeUncertainty;
pub use robot_file::{parse_robot, parse_robot_model};
pub use robot_model::RobotModel;
pub use robot_writer::write_robot;
pub use text_edit::{EditedText, note};
pub use tree::{ChainEnds, ImportedModel, SnappedJoint};
pub use urdf::{parse_urdf, parse_urdf_as_written};
pub use urdf_edit::edit_urdf;
pub use urdf_writer::{write_urdf, write_urdf_to_view};
