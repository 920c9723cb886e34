//! Which bytes carry a message?
//!
//! Plain CDR, in which ROS 2 sends and stores its messages: four bytes that name the byte order, then each number at a
//! multiple of its own size (counted after those four), strings and sequences with a 32-bit length before them, strings
//! with a zero at the end. Little endian is written, both orders are read.
//!
//! [`encode`] and [`decode`] take any type that serde writes and reads as numbers, strings, sequences and structures.
//! The messages that armid stores are here, those that it only sends are in `armid-hardware`. Bytes that are no message
//! are refused with the field and the place.
//!
//! Reference: OMG, *Common Object Request Broker Architecture*, part 2, section 9.3 (CDR transfer syntax), and *DDS
//! Interoperability Wire Protocol (DDSI-RTPS)* 2.5, section 10 (the encapsulation).

mod decoder;
mod encoder;
mod error;
mod float_array;
mod joint_state;
mod time;
mod transforms;

pub use decoder::decode;
pub use encoder::encode;
pub use error::CdrError;
pub use float_array::FloatArray;
pub use joint_state::JointState;
pub use time::Time;
pub use transforms::{Transform, Transforms};
