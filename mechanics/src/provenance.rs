//! What produced a value: enough to make it again, and nothing that changes from one machine or day to the next.

use sha2::{Digest, Sha256};

use crate::seed::Seed;

/// What produced a stored value. Wall times and dates are not part of it: equal provenance means equal bytes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Provenance {
    /// Version of armid.
    pub version: String,
    /// Name of the robot.
    pub robot: String,
    /// SHA-256 of the text of the robot file.
    pub robot_sha256: String,
    /// Seed of every random stream, where any was drawn.
    pub seed: Option<Seed>,
}

impl Provenance {
    /// Provenance of a value that was computed from `robot_text` by this version of armid.
    pub fn new(robot: &str, robot_text: &str, seed: Option<Seed>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            robot: robot.to_owned(),
            robot_sha256: sha256(robot_text),
            seed,
        }
    }
}

/// SHA-256 of a text, as lower-case hexadecimal digits.
pub fn sha256(text: &str) -> String {
    sha256_of_bytes(text.as_bytes())
}

/// SHA-256 of bytes, as lower-case hexadecimal digits.
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn published_sha256_of_abc() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(super::sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
