//! ROS 2's `std_msgs/msg/Float64MultiArray` as CDR, for numbers without a message of their own.

use super::joint_state::{CdrError, Decoder, Encoder};

/// Name of the message type.
pub const NAME: &str = "std_msgs/msg/Float64MultiArray";

/// Its definition, with those that it needs, in the format `ros2msg`.
pub const DEFINITION: &str = "\
std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
";

/// The message of some numbers, without dimensions.
#[must_use]
pub fn encode(data: &[f64]) -> Vec<u8> {
    let mut out = Encoder { bytes: vec![0, 1, 0, 0] };
    out.u32(0);
    out.u32(0);
    out.list(data);
    out.bytes
}

/// The numbers of a message; its dimensions are read past.
///
/// # Errors
/// [`CdrError`] where the bytes are no such message.
pub fn decode(bytes: &[u8]) -> Result<Vec<f64>, CdrError> {
    let mut input = Decoder::new(bytes)?;
    for _ in 0..input.u32("number of dimensions")? {
        input.text("label")?;
        input.u32("size")?;
        input.u32("stride")?;
    }
    input.u32("offset")?;
    input.list("data")
}

#[cfg(test)]
mod tests {
    use super::{decode, encode};

    #[test]
    fn analytic_bytes_of_a_message() {
        let mut bytes: Vec<u8> = vec![0, 1, 0, 0];
        bytes.extend([0, 0, 0, 0, 0, 0, 0, 0]); // 0: no dimensions, offset 0
        bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]); // 8: one number, and 4 bytes up to the next f64
        bytes.extend(0.25_f64.to_le_bytes());
        assert_eq!(encode(&[0.25]), bytes);
        assert_eq!(decode(&bytes).unwrap(), [0.25]);
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn dimensions_are_read_past() {
        let mut bytes: Vec<u8> = vec![0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, b'v', 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0];
        bytes.extend([0, 0, 0, 0, 1, 0, 0, 0]); // 20: offset, one number; 28 is no multiple of 8
        bytes.extend([0, 0, 0, 0]);
        bytes.extend(7.0_f64.to_le_bytes());
        assert_eq!(decode(&bytes).unwrap(), [7.0]);
    }
}
