//! `std_msgs/msg/Float64MultiArray`, for numbers without a message of their own.

use super::{CdrError, decode, encode};

/// A dimension of a `std_msgs/msg/MultiArrayLayout`: label, size, stride.
type Dimension = (String, u32, u32);

/// Numbers without dimensions: what the message is mostly used for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloatArray {
    /// The numbers.
    pub data: Vec<f64>,
}

impl FloatArray {
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

    /// The message as bytes, without dimensions.
    ///
    /// # Errors
    /// [`CdrError::Long`] where there are 2³² numbers or more.
    pub fn encode(&self) -> Result<Vec<u8>, CdrError> {
        let dimensions: [Dimension; 0] = [];
        encode(&(dimensions.as_slice(), 0_u32, &self.data))
    }

    /// The message in some bytes; its dimensions are read past.
    ///
    /// # Errors
    /// [`CdrError`] where the bytes are not such a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, CdrError> {
        let (_, _, data): (Vec<Dimension>, u32, Vec<f64>) = decode(bytes)?;
        Ok(Self { data })
    }
}

#[cfg(test)]
mod tests {
    use super::FloatArray;

    #[test]
    fn analytic_bytes_of_a_message() {
        let mut bytes: Vec<u8> = vec![0, 1, 0, 0];
        bytes.extend([0, 0, 0, 0, 0, 0, 0, 0]); // 0: no dimensions, offset 0
        bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]); // 8: one number, and 4 bytes up to the next f64
        bytes.extend(0.25_f64.to_le_bytes());
        assert_eq!(FloatArray { data: vec![0.25] }.encode().unwrap(), bytes);
        assert_eq!(FloatArray::decode(&bytes).unwrap().data, [0.25]);
        for length in 0..bytes.len() {
            assert!(FloatArray::decode(&bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn dimensions_are_read_past() {
        let mut bytes: Vec<u8> = vec![0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, b'v', 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0];
        bytes.extend([0, 0, 0, 0, 1, 0, 0, 0]); // 20: offset, one number; 28 is no multiple of 8
        bytes.extend([0, 0, 0, 0]);
        bytes.extend(7.0_f64.to_le_bytes());
        assert_eq!(FloatArray::decode(&bytes).unwrap().data, [7.0]);
    }
}
