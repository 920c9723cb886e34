//! Bytes to values.

use super::CdrError;

/// Bytes that are being read.
pub(super) struct Decoder<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Decoder<'a> {
    /// A decoder of what follows the encapsulation.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, CdrError> {
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

    /// `count` entries of `size` bytes each. Nothing is allocated before they are known to be there.
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

    pub(super) fn u32(&mut self, what: &'static str) -> Result<u32, CdrError> {
        let bytes = self.take(what, 4, 1)?;
        let bytes = [bytes[0], bytes[1], bytes[2], bytes[3]];
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    pub(super) fn i32(&mut self, what: &'static str) -> Result<i32, CdrError> {
        Ok(self.u32(what)?.cast_signed())
    }

    pub(super) fn text(&mut self, what: &'static str) -> Result<String, CdrError> {
        let length = self.u32(what)? as usize;
        let bytes = self.take(what, 1, length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        String::from_utf8(text.to_vec()).map_err(|_| CdrError::Text { what })
    }

    pub(super) fn list(&mut self, what: &'static str) -> Result<Vec<f64>, CdrError> {
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
