//! Files of meshes: STL, OBJ and COLLADA. Their points alone are read, m: a collision check takes the hull.

mod collada;
mod file;
mod obj;
mod stl;

pub use file::{parse, read};
