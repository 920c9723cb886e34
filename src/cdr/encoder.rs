//! Values to bytes.

use super::CdrError;

/// Little-endian bytes under way, encapsulation first.
pub(super) struct Encoder {
    bytes: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { bytes: vec![0, 1, 0, 0] }
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.bytes
    }

    /// Zeros up to a multiple of `size`, counted after the encapsulation.
    fn align(&mut self, size: usize) {
        while !(self.bytes.len() - 4).is_multiple_of(size) {
            self.bytes.push(0);
        }
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// The number of entries that follow.
    pub(super) fn length(&mut self, what: &'static str, length: usize) -> Result<(), CdrError> {
        self.u32(u32::try_from(length).map_err(|_| CdrError::Long { what, length })?);
        Ok(())
    }

    pub(super) fn text(&mut self, what: &'static str, text: &str) -> Result<(), CdrError> {
        self.length(what, text.len() + 1)?;
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
        Ok(())
    }

    pub(super) fn list(&mut self, what: &'static str, values: &[f64]) -> Result<(), CdrError> {
        self.length(what, values.len())?;
        for value in values {
            self.align(8);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
        Ok(())
    }
}
