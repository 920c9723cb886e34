//! Arguments that several commands take.

mod choices;
mod guard_arguments;
mod known_load_arguments;
mod limit_arguments;
mod log_arguments;
mod mesh_arguments;
mod parameter_map;
mod payload_arguments;
mod robot_arguments;

pub(crate) use choices::{columns, estimator, one_of};
pub(crate) use guard_arguments::GuardArguments;
pub(crate) use known_load_arguments::KnownLoadArguments;
pub(crate) use limit_arguments::LimitArguments;
pub(crate) use log_arguments::LogArguments;
pub(crate) use mesh_arguments::MeshArguments;
pub(crate) use parameter_map::read_parameter_map;
pub(crate) use payload_arguments::PayloadArguments;
pub(crate) use robot_arguments::{ChainArguments, RobotArguments};
