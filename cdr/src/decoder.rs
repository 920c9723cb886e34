//! Bytes to values: plain CDR of either byte order in the data model of serde.

use serde::de::{self, DeserializeOwned, DeserializeSeed, SeqAccess, Visitor};

use super::CdrError;

/// The message in some bytes. Bytes after it are padding.
///
/// # Errors
/// [`CdrError`] with the field and the place where the bytes are no such message. Nothing is allocated for a list before
/// there are bytes for its entries.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CdrError> {
    T::deserialize(&mut Decoder::new(bytes)?)
}

/// Bytes that are being read.
struct Decoder<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
    /// The field that is read.
    what: &'static str,
}

impl<'a> Decoder<'a> {
    /// A decoder of what follows the encapsulation.
    fn new(bytes: &'a [u8]) -> Result<Self, CdrError> {
        let Some((head, body)) = bytes.split_at_checked(4) else {
            return Err(CdrError::Short { what: "the encapsulation", at: 0, needed: 4, left: bytes.len() });
        };
        let little = match u16::from_be_bytes([head[0], head[1]]) {
            0 => false,
            1 => true,
            found => return Err(CdrError::Encapsulation { found }),
        };
        Ok(Self { body, at: 0, little, what: "the message" })
    }

    /// `count` bytes from the next multiple of `size`.
    fn take(&mut self, size: usize, count: usize) -> Result<&'a [u8], CdrError> {
        let start = self.at.next_multiple_of(size);
        let left = self.body.len().saturating_sub(start);
        if count > left {
            return Err(CdrError::Short { what: self.what, at: start + 4, needed: count, left });
        }
        self.at = start + count;
        Ok(&self.body[start..self.at])
    }

    /// The bytes of a number, little endian.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        let little = self.little;
        let mut number = [0; N];
        number.copy_from_slice(self.take(N, N)?);
        if !little {
            number.reverse();
        }
        Ok(number)
    }

    /// The number of entries that follow, of at least one byte each.
    fn length(&mut self) -> Result<usize, CdrError> {
        let count = u32::from_le_bytes(self.number()?) as usize;
        let left = self.body.len() - self.at;
        if count > left {
            return Err(CdrError::Short { what: self.what, at: self.at + 4, needed: count, left });
        }
        Ok(count)
    }

    fn unsupported<T>(&self, kind: &'static str) -> Result<T, CdrError> {
        Err(CdrError::Unsupported { what: self.what, kind })
    }
}

macro_rules! numbers {
    ($($method:ident: $visit:ident, $number:ty);*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, CdrError> {
            visitor.$visit(<$number>::from_le_bytes(self.number()?))
        })*
    };
}

macro_rules! unsupported {
    ($($method:ident($($argument:ty),*): $kind:literal;)*) => {
        $(fn $method<V: Visitor<'de>>(self, $(_: $argument,)* _: V) -> Result<V::Value, CdrError> {
            self.unsupported($kind)
        })*
    };
}

impl<'de> de::Deserializer<'de> for &mut Decoder<'_> {
    type Error = CdrError;

    numbers! {
        deserialize_i8: visit_i8, i8; deserialize_i16: visit_i16, i16; deserialize_i32: visit_i32, i32;
        deserialize_i64: visit_i64, i64; deserialize_u8: visit_u8, u8; deserialize_u16: visit_u16, u16;
        deserialize_u32: visit_u32, u32; deserialize_u64: visit_u64, u64; deserialize_f32: visit_f32, f32;
        deserialize_f64: visit_f64, f64
    }

    unsupported! {
        deserialize_any(): "a value of unknown type";
        deserialize_ignored_any(): "a value of unknown type";
        deserialize_char(): "a character";
        deserialize_bytes(): "bytes";
        deserialize_byte_buf(): "bytes";
        deserialize_option(): "an option";
        deserialize_unit(): "a unit";
        deserialize_unit_struct(&'static str): "a unit";
        deserialize_map(): "a map";
        deserialize_enum(&'static str, &'static [&'static str]): "an enumeration";
        deserialize_identifier(): "an identifier";
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, CdrError> {
        let [byte] = self.number()?;
        match byte {
            0 | 1 => visitor.visit_bool(byte == 1),
            found => Err(CdrError::Bool { what: self.what, found }),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, CdrError> {
        let length = self.length()?;
        let bytes = self.take(1, length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        visitor.visit_str(std::str::from_utf8(text).map_err(|_| CdrError::Text { what: self.what })?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, CdrError> {
        self.deserialize_str(visitor)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, CdrError> {
        let left = self.length()?;
        visitor.visit_seq(Entries { decoder: self, left, names: &[] })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, left: usize, visitor: V) -> Result<V::Value, CdrError> {
        visitor.visit_seq(Entries { decoder: self, left, names: &[] })
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        left: usize,
        visitor: V,
    ) -> Result<V::Value, CdrError> {
        self.deserialize_tuple(left, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, CdrError> {
        visitor.visit_seq(Entries { decoder: self, left: names.len(), names })
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, CdrError> {
        visitor.visit_newtype_struct(self)
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

/// What is left of a list, a tuple or a structure.
struct Entries<'d, 'a> {
    decoder: &'d mut Decoder<'a>,
    left: usize,
    /// Names of the fields of a structure.
    names: &'static [&'static str],
}

impl<'de> SeqAccess<'de> for Entries<'_, '_> {
    type Error = CdrError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, CdrError> {
        if self.left == 0 {
            return Ok(None);
        }
        if let Some(name) = self.names.len().checked_sub(self.left).and_then(|index| self.names.get(index)) {
            self.decoder.what = name;
        }
        self.left -= 1;
        seed.deserialize(&mut *self.decoder).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left)
    }
}
