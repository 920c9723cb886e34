//! Robots: a bundled name, a robot file with what lies beside it, or a chain in a URDF or MJCF tree.

mod assumed_file;
mod begun_file;
mod find;
mod held_shapes;
mod loaded_robot;
mod package_path;
mod tree;

pub use assumed_file::{AssumedFile, assume};
pub use begun_file::begin;
pub use find::{find, load};
pub use held_shapes::{HeldShape, HeldShapes, ShapeLeftOut};
pub use loaded_robot::{ChainSource, LoadedRobot};
pub use package_path::PackagePath;
