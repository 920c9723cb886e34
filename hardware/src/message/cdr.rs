//! Messages to and from bytes, as they travel: four bytes that name the byte order, then plain CDR.
//!
//! Reference: OMG, *DDS Interoperability Wire Protocol (DDSI-RTPS)* 2.5, section 10, and *CORBA* part 2, section 9.3.

use ros2_client::Message;
use rustdds::RepresentationIdentifier;
use rustdds::serialization::{deserialize_from_cdr_with_rep_id, to_writer_with_rep_id};

/// Why bytes are no message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The four bytes in front are missing or name another encoding.
    #[error("the encapsulation is {found:02x?}, expected 00 00 or 00 01 (plain CDR) and two bytes more")]
    Encapsulation {
        /// The first four bytes, as far as there are any.
        found: Vec<u8>,
    },
    /// The rest is no such message.
    #[error("{reason}, in {length} bytes after the encapsulation")]
    Body {
        /// What the decoder says.
        reason: String,
        /// Bytes after the encapsulation.
        length: usize,
    },
}

/// The message as bytes, little endian, encapsulation first.
///
/// # Errors
/// [`CdrError::Body`] where a list has more than 2³² entries.
pub fn encode<M: Message>(message: &M) -> Result<Vec<u8>, CdrError> {
    let mut body = Vec::new();
    to_writer_with_rep_id(&mut body, message, RepresentationIdentifier::CDR_LE)
        .map_err(|error| CdrError::Body { reason: error.to_string(), length: body.len() })?;
    // The body is aligned to its own beginning, so the encapsulation goes in front of it afterwards.
    Ok([&[0, 1, 0, 0], body.as_slice()].concat())
}

/// The message in some bytes, of either byte order.
///
/// # Errors
/// [`CdrError`] where the bytes are none.
pub fn decode<M: Message>(bytes: &[u8]) -> Result<M, CdrError> {
    let order = match bytes {
        [0, 0, _, _, ..] => RepresentationIdentifier::CDR_BE,
        [0, 1, _, _, ..] => RepresentationIdentifier::CDR_LE,
        _ => return Err(CdrError::Encapsulation { found: bytes[..bytes.len().min(4)].to_vec() }),
    };
    let body = &bytes[4..];
    match deserialize_from_cdr_with_rep_id(body, order) {
        Ok((message, _)) => Ok(message),
        Err(error) => Err(CdrError::Body { reason: error.to_string(), length: body.len() }),
    }
}
