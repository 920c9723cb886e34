//! `sensor_msgs/msg/JointState`.

use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{CdrError, Time, decode, encode};

/// Positions, velocities and efforts of some joints at one time, in any order; a list may be empty where it is not known.
///
/// ```
/// use armid_cdr::{JointState, Time};
/// let state = JointState { stamp: Time { sec: 3, nanosec: 5 }, name: ["elbow".into()].into(), ..JointState::default() };
/// assert_eq!(JointState::decode(&state.encode()?)?, state);
/// # Ok::<(), armid_cdr::CdrError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When the data were taken, by the sender's clock.
    pub stamp: Time,
    /// Frame that the data are in; mostly empty.
    pub frame_id: String,
    /// Names of the joints; messages that have the same may hold them together.
    #[serde(serialize_with = "serialize_names", deserialize_with = "deserialize_names")]
    pub name: Arc<[String]>,
    /// Positions, rad (m).
    pub position: Vec<f64>,
    /// Velocities, rad/s (m/s).
    pub velocity: Vec<f64>,
    /// Efforts, N·m (N), or motor currents, A, where the driver maps them onto effort.
    pub effort: Vec<f64>,
}

impl JointState {
    /// Name of the message type.
    pub const NAME: &str = "sensor_msgs/msg/JointState";

    /// Its definition, with those that it needs, in the format `ros2msg`.
    pub const DEFINITION: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

    /// The message as bytes.
    ///
    /// # Errors
    /// [`CdrError::Long`] where a sequence or a string has 2³² entries or more.
    pub fn encode(&self) -> Result<Vec<u8>, CdrError> {
        encode(self)
    }

    /// The message in some bytes.
    ///
    /// # Errors
    /// [`CdrError`] where the bytes are not such a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, CdrError> {
        decode(bytes)
    }

    /// Holds the names together with the message `before` where it has the same.
    #[must_use]
    pub fn sharing_names(mut self, before: Option<&Self>) -> Self {
        if let Some(before) = before.filter(|before| before.name == self.name) {
            self.name = Arc::clone(&before.name);
        }
        self
    }
}

fn serialize_names<S: Serializer>(names: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    names.serialize(serializer)
}

fn deserialize_names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<[String]>, D::Error> {
    Vec::deserialize(deserializer).map(Arc::from)
}

#[cfg(test)]
mod tests {
    use super::{CdrError, JointState, Time};

    fn message() -> JointState {
        JointState {
            stamp: Time { sec: 3, nanosec: 5 },
            frame_id: String::new(),
            name: ["a".into(), "elbow".into()].into(),
            position: vec![0.25, -1.0],
            velocity: Vec::new(),
            effort: vec![f64::MIN_POSITIVE, 2.0],
        }
    }

    /// Written by hand after the rules of CDR: alignment counts from the end of the encapsulation.
    #[test]
    fn analytic_bytes_of_a_message() {
        let mut bytes: Vec<u8> = vec![0, 1, 0, 0];
        bytes.extend([3, 0, 0, 0, 5, 0, 0, 0]); //           0: stamp
        bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]); //           8: "" and 3 bytes up to the next u32
        bytes.extend([2, 0, 0, 0]); //                      16: two names
        bytes.extend([2, 0, 0, 0, b'a', 0, 0, 0]); //       20
        bytes.extend([6, 0, 0, 0, b'e', b'l', b'b', b'o', b'w', 0, 0, 0]); // 28
        bytes.extend([2, 0, 0, 0, 0, 0, 0, 0]); //          40: two positions, and 4 bytes up to the next f64
        bytes.extend(0.25_f64.to_le_bytes()); //            48
        bytes.extend((-1.0_f64).to_le_bytes());
        bytes.extend([0, 0, 0, 0]); //                      64: no velocities
        bytes.extend([2, 0, 0, 0]); //                      68: two efforts, at 72 already
        bytes.extend(f64::MIN_POSITIVE.to_le_bytes());
        bytes.extend(2.0_f64.to_le_bytes());
        assert_eq!(message().encode().unwrap(), bytes);
    }

    #[test]
    fn identity_decode_undoes_encode() {
        assert_eq!(JointState::decode(&message().encode().unwrap()).unwrap(), message());
        assert_eq!(JointState::decode(&JointState::default().encode().unwrap()).unwrap(), JointState::default());
    }

    #[test]
    fn every_cut_is_a_fault_and_none_a_panic() {
        let bytes = message().encode().unwrap();
        for length in 0..bytes.len() {
            assert!(matches!(JointState::decode(&bytes[..length]), Err(CdrError::Short { .. })), "{length}");
        }
        let mut huge = bytes.clone();
        huge[20..24].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(JointState::decode(&huge).is_err());
        let mut parameter_list = bytes;
        parameter_list[1] = 3;
        assert_eq!(JointState::decode(&parameter_list), Err(CdrError::Encapsulation { found: 3 }));
    }

    #[test]
    fn big_endian_is_read_too() {
        let mut bytes: Vec<u8> = vec![0, 0, 0, 0];
        bytes.extend([0, 0, 0, 3, 0, 0, 0, 5, 0, 0, 0, 1, 0, 0, 0, 0]);
        bytes.extend([0, 0, 0, 1, 0, 0, 0, 2, b'a', 0, 0, 0]);
        bytes.extend([0, 0, 0, 1]);
        bytes.extend(0.25_f64.to_be_bytes());
        bytes.extend([0, 0, 0, 0, 0, 0, 0, 0]);
        let found = JointState::decode(&bytes).unwrap();
        assert_eq!(
            (found.stamp.ns(), found.name, found.position),
            (3_000_000_005, ["a".to_owned()].into(), vec![0.25])
        );
    }
}
