//! ROS 2's `sensor_msgs/msg/JointState` as CDR, the bytes in which ROS 2 stores it.
//!
//! Plain CDR, little endian: four bytes that say so, then each number at a multiple of its own size (counted after those
//! four), texts and lists with a 32-bit length before them, texts with a zero at the end. Both byte orders are read.
//! Reference: OMG, *Common Object Request Broker Architecture*, part 2, section 9.3 (CDR transfer syntax).

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

/// Positions, velocities and efforts of some joints at one time; a list may be empty where it is not known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointState {
    /// Time, ns since the clock's zero.
    pub stamp_ns: u64,
    /// Frame that the data are in; mostly empty.
    pub frame_id: String,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Positions, rad (m).
    pub position: Vec<f64>,
    /// Velocities, rad/s (m/s).
    pub velocity: Vec<f64>,
    /// Efforts, A or N·m (N).
    pub effort: Vec<f64>,
}

/// Why bytes are no such message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// They end too early.
    #[error("byte {at}: {needed} more bytes are needed for {what}, {left} are left")]
    Short {
        /// What was to be read.
        what: &'static str,
        /// Where, bytes from the beginning.
        at: usize,
        /// Bytes that it takes.
        needed: usize,
        /// Bytes that are there.
        left: usize,
    },
    /// The four bytes in front name another encoding.
    #[error("encapsulation is {found:#06x}, expected 0x0000 or 0x0001 (plain CDR)")]
    Encapsulation {
        /// The first two bytes.
        found: u16,
    },
    /// A text is none.
    #[error("{what} is no UTF-8 text")]
    Text {
        /// Which one.
        what: &'static str,
    },
}

impl JointState {
    /// The message as bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Encoder { bytes: vec![0, 1, 0, 0] };
        // The definition's seconds are signed: time past 2038 wraps, as it does in ROS.
        let sec = (self.stamp_ns / 1_000_000_000) as u32;
        out.u32(sec);
        out.u32((self.stamp_ns % 1_000_000_000) as u32);
        out.text(&self.frame_id);
        out.u32(self.name.len() as u32);
        for name in &self.name {
            out.text(name);
        }
        for list in [&self.position, &self.velocity, &self.effort] {
            out.list(list);
        }
        out.bytes
    }

    /// The message in some bytes.
    ///
    /// # Errors
    /// [`CdrError`] where they are none.
    pub fn decode(bytes: &[u8]) -> Result<Self, CdrError> {
        let mut input = Decoder::new(bytes)?;
        let sec = u64::from(input.u32("seconds")?);
        let nanosec = u64::from(input.u32("nanoseconds")?);
        let frame_id = input.text("frame_id")?;
        let count = input.u32("number of names")?;
        let mut name = Vec::new();
        for _ in 0..count {
            name.push(input.text("name")?);
        }
        let position = input.list("positions")?;
        let velocity = input.list("velocities")?;
        let effort = input.list("efforts")?;
        Ok(Self { stamp_ns: sec * 1_000_000_000 + nanosec, frame_id, name, position, velocity, effort })
    }
}

pub(crate) struct Encoder {
    pub(crate) bytes: Vec<u8>,
}

impl Encoder {
    /// Zeros up to a multiple of `size`, counted after the encapsulation.
    fn align(&mut self, size: usize) {
        while !(self.bytes.len() - 4).is_multiple_of(size) {
            self.bytes.push(0);
        }
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    pub(crate) fn list(&mut self, values: &[f64]) {
        self.u32(values.len() as u32);
        for value in values {
            self.align(8);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
}

pub(crate) struct Decoder<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Decoder<'a> {
    /// A decoder of what follows the encapsulation.
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, CdrError> {
        let Some((head, body)) = bytes.split_at_checked(4) else {
            return Err(CdrError::Short { what: "the encapsulation", at: 0, needed: 4, left: bytes.len() });
        };
        let little = match u16::from_be_bytes([head[0], head[1]]) {
            0 => false,
            1 => true,
            found => return Err(CdrError::Encapsulation { found }),
        };
        Ok(Self { body, at: 0, little })
    }

    fn take(&mut self, what: &'static str, size: usize, count: usize) -> Result<&'a [u8], CdrError> {
        let start = if count == 0 { self.at } else { self.at.next_multiple_of(size) };
        let needed = size.saturating_mul(count);
        let left = self.body.len().saturating_sub(start);
        if needed > left {
            return Err(CdrError::Short { what, at: start + 4, needed, left });
        }
        self.at = start + needed;
        Ok(&self.body[start..self.at])
    }

    pub(crate) fn u32(&mut self, what: &'static str) -> Result<u32, CdrError> {
        let bytes = self.take(what, 4, 1)?;
        let bytes = [bytes[0], bytes[1], bytes[2], bytes[3]];
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    pub(crate) fn text(&mut self, what: &'static str) -> Result<String, CdrError> {
        let length = self.u32(what)? as usize;
        let bytes = self.take(what, 1, length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        String::from_utf8(text.to_vec()).map_err(|_| CdrError::Text { what })
    }

    pub(crate) fn list(&mut self, what: &'static str) -> Result<Vec<f64>, CdrError> {
        let count = self.u32(what)? as usize;
        let bytes = self.take(what, 8, count)?;
        let number = |bytes: &[u8]| {
            let mut eight = [0; 8];
            eight.copy_from_slice(bytes);
            if self.little { f64::from_le_bytes(eight) } else { f64::from_be_bytes(eight) }
        };
        Ok(bytes.chunks_exact(8).map(number).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::{CdrError, JointState};

    fn message() -> JointState {
        JointState {
            stamp_ns: 3_000_000_005,
            frame_id: String::new(),
            name: vec!["a".into(), "elbow".into()],
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
        assert_eq!(message().encode(), bytes);
    }

    #[test]
    fn identity_decode_undoes_encode() {
        assert_eq!(JointState::decode(&message().encode()).unwrap(), message());
        assert_eq!(JointState::decode(&JointState::default().encode()).unwrap(), JointState::default());
    }

    #[test]
    fn every_cut_is_a_fault_and_none_a_panic() {
        let bytes = message().encode();
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
        assert_eq!((found.stamp_ns, found.name, found.position), (3_000_000_005, vec!["a".to_owned()], vec![0.25]));
    }
}
