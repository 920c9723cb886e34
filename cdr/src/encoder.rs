//! Values to bytes: the data model of serde in plain CDR, little endian.

use serde::ser::{self, Impossible, Serialize};

use super::CdrError;

/// The message as bytes, the four of the encapsulation first.
///
/// Structures and tuples are their fields one after the other, sequences and strings have their 32-bit length in front.
///
/// # Errors
/// [`CdrError::Long`] where a sequence or a string has 2³² entries or more, [`CdrError::Unsupported`] for what no ROS 2
/// message holds: options, enumerations, maps.
pub fn encode<T: Serialize + ?Sized>(message: &T) -> Result<Vec<u8>, CdrError> {
    let mut encoder = Encoder { bytes: vec![0, 1, 0, 0], what: "the message" };
    message.serialize(&mut encoder)?;
    Ok(encoder.bytes)
}

/// Little-endian bytes under way, encapsulation first.
struct Encoder {
    bytes: Vec<u8>,
    /// The field that is written.
    what: &'static str,
}

impl Encoder {
    /// A number at the next multiple of its size, counted after the encapsulation.
    fn put<const N: usize>(&mut self, number: [u8; N]) {
        let end = 4 + (self.bytes.len() - 4).next_multiple_of(N);
        self.bytes.resize(end, 0);
        self.bytes.extend_from_slice(&number);
    }

    /// The number of entries that follow.
    fn length(&mut self, length: usize) -> Result<(), CdrError> {
        let count = u32::try_from(length).map_err(|_| CdrError::Long { what: self.what, length })?;
        self.put(count.to_le_bytes());
        Ok(())
    }

    fn unsupported<T>(&self, kind: &'static str) -> Result<T, CdrError> {
        Err(CdrError::Unsupported { what: self.what, kind })
    }
}

macro_rules! numbers {
    ($($method:ident: $number:ty),*) => {
        $(fn $method(self, value: $number) -> Result<(), CdrError> {
            self.put(value.to_le_bytes());
            Ok(())
        })*
    };
}

macro_rules! sequences {
    ($($method:ident($($argument:ty),*));*) => {
        $(fn $method(self, $(_: $argument),*) -> Result<Self, CdrError> {
            Ok(self)
        })*
    };
}

macro_rules! unsupported {
    ($($method:ident($($argument:ty),*) -> $ok:ty: $kind:literal;)*) => {
        $(fn $method(self, $(_: $argument),*) -> Result<$ok, CdrError> {
            self.unsupported($kind)
        })*
    };
}

impl ser::Serializer for &mut Encoder {
    type Ok = ();
    type Error = CdrError;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Impossible<(), CdrError>;
    type SerializeMap = Impossible<(), CdrError>;
    type SerializeStruct = Self;
    type SerializeStructVariant = Impossible<(), CdrError>;

    numbers! {
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64,
        serialize_f32: f32, serialize_f64: f64
    }

    fn serialize_bool(self, value: bool) -> Result<(), CdrError> {
        self.put([u8::from(value)]);
        Ok(())
    }

    fn serialize_str(self, text: &str) -> Result<(), CdrError> {
        self.length(text.len() + 1)?;
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
        Ok(())
    }

    fn serialize_seq(self, length: Option<usize>) -> Result<Self, CdrError> {
        match length {
            Some(length) => self.length(length).map(|()| self),
            None => self.unsupported("a list of unknown length"),
        }
    }

    sequences! {
        serialize_tuple(usize); serialize_tuple_struct(&'static str, usize); serialize_struct(&'static str, usize)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), CdrError> {
        value.serialize(self)
    }

    unsupported! {
        serialize_char(char) -> (): "a character";
        serialize_bytes(&[u8]) -> (): "bytes";
        serialize_none() -> (): "an option";
        serialize_unit() -> (): "a unit";
        serialize_unit_struct(&'static str) -> (): "a unit";
        serialize_unit_variant(&'static str, u32, &'static str) -> (): "an enumeration";
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> Impossible<(), CdrError>: "an enumeration";
        serialize_map(Option<usize>) -> Impossible<(), CdrError>: "a map";
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> Impossible<(), CdrError>: "an enumeration";
    }

    fn serialize_some<T: Serialize + ?Sized>(self, _: &T) -> Result<(), CdrError> {
        self.unsupported("an option")
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: &T,
    ) -> Result<(), CdrError> {
        self.unsupported("an enumeration")
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

/// Entries one after the other, each in its own alignment.
macro_rules! entries {
    ($($of:ident::$method:ident($($name:ident)?);)*) => {
        $(impl ser::$of for &mut Encoder {
            type Ok = ();
            type Error = CdrError;

            fn $method<T: Serialize + ?Sized>(&mut self, $($name: &'static str,)? value: &T) -> Result<(), CdrError> {
                $(self.what = $name;)?
                value.serialize(&mut **self)
            }

            fn end(self) -> Result<(), CdrError> {
                Ok(())
            }
        })*
    };
}

entries! {
    SerializeSeq::serialize_element();
    SerializeTuple::serialize_element();
    SerializeTupleStruct::serialize_field();
    SerializeStruct::serialize_field(name);
}
