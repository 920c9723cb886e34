//! The records of an MCAP file, chunks unpacked; any bytes are safe to read.
//!
//! The reader of the `mcap` crate does not check two lengths: that of a record inside a chunk that is not compressed, which may
//! claim more than the chunk, and one near 2⁶⁴. Both are looked at before it sees them.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult, parse_record};

/// Longest record beyond the length of the file itself: compressed ones may be longer than their file.
const LONGEST_RECORD: usize = 16 << 20;
/// Bytes in front of every record: what it is, and its length.
const FRAME: usize = 9;

/// The records of a file, in order.
pub(crate) struct Records<'a> {
    rest: &'a [u8],
    reader: LinearReader,
}

impl<'a> Records<'a> {
    /// The records in `bytes`, with or without the end of an MCAP file; `crcs` checks those of its chunks.
    ///
    /// # Errors
    /// [`McapError`] where a record is longer than the chunk around it.
    pub(crate) fn new(bytes: &'a [u8], crcs: bool) -> McapResult<Self> {
        check_chunks(bytes)?;
        let options = LinearReaderOptions::default()
            .with_skip_end_magic(true)
            .with_validate_chunk_crcs(crcs)
            .with_record_length_limit(bytes.len().saturating_add(LONGEST_RECORD));
        Ok(Self { rest: bytes, reader: LinearReader::new_with_options(options) })
    }
}

impl Iterator for Records<'_> {
    type Item = McapResult<Record<'static>>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.reader.next_event()? {
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    return Some(parse_record(opcode, data).map(Record::into_owned));
                }
                Ok(LinearReadEvent::ReadRequest(wanted)) => {
                    let (now, rest) = self.rest.split_at(wanted.min(self.rest.len()));
                    self.reader.insert(now.len()).copy_from_slice(now);
                    self.reader.notify_read(now.len());
                    self.rest = rest;
                }
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

/// The number of so many little-endian bytes at `at`, if they are there.
fn number(bytes: &[u8], at: usize, length: usize) -> Option<u64> {
    let field = bytes.get(at..at.checked_add(length)?)?;
    Some(field.iter().rev().fold(0, |number, &byte| (number << 8) | u64::from(byte)))
}

/// What a record is and where its content ends, as it claims.
fn frame(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let length = usize::try_from(number(bytes, at.checked_add(1)?, 8)?).unwrap_or(usize::MAX);
    Some((bytes[at], (at + FRAME).saturating_add(length)))
}

/// The records of a chunk that is not compressed, as far as it is there: where they begin and where they end.
fn plain_records(bytes: &[u8], chunk: usize) -> Option<(usize, usize)> {
    // Two times, uncompressed size and checksum, name of the compression, compressed size.
    let name = chunk + FRAME + 28;
    if number(bytes, name, 4)? != 0 {
        return None;
    }
    let size = usize::try_from(number(bytes, name + 4, 8)?).unwrap_or(usize::MAX);
    Some((name + 12, (name + 12).saturating_add(size)))
}

/// Every record of a chunk that is not compressed ends inside its chunk. What is cut off is left to the reader.
fn check_chunks(bytes: &[u8]) -> McapResult<()> {
    let mut at = mcap::MAGIC.len();
    while let Some((opcode, end)) = frame(bytes, at) {
        if opcode == op::CHUNK
            && let Some((mut record, last)) = plain_records(bytes, at)
        {
            while record < last && record + FRAME <= bytes.len() {
                let Some((_, next)) = frame(bytes, record).filter(|_| record + FRAME <= last) else {
                    return Err(McapError::UnexpectedEoc);
                };
                if next > last {
                    return Err(McapError::UnexpectedEoc);
                }
                record = next;
            }
        }
        at = end;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with one chunk that is not compressed and holds one record of `claims` bytes, of which two are there.
    fn file(claims: u64) -> Vec<u8> {
        let mut records = vec![op::METADATA];
        records.extend(claims.to_le_bytes());
        records.extend([0, 0]);
        let mut chunk = vec![0; 28];
        chunk.extend([0; 4]);
        chunk.extend((records.len() as u64).to_le_bytes());
        chunk.extend(records);
        let mut file = mcap::MAGIC.to_vec();
        file.push(op::CHUNK);
        file.extend((chunk.len() as u64).to_le_bytes());
        file.extend(chunk);
        // Enough behind it for a record that claims too much.
        file.extend([0; 64]);
        file
    }

    #[test]
    fn a_record_longer_than_its_chunk_is_refused() {
        assert!(Records::new(&file(2), true).is_ok());
        for claims in [3, 40, 1 << 40, u64::MAX - 8, u64::MAX] {
            assert!(matches!(Records::new(&file(claims), true), Err(McapError::UnexpectedEoc)), "{claims}");
        }
    }

    #[test]
    fn a_record_that_claims_the_world_is_refused_without_asking_for_it() {
        for claims in [1_u64 << 40, u64::MAX - 8, u64::MAX] {
            let mut file = mcap::MAGIC.to_vec();
            file.push(op::METADATA);
            file.extend(claims.to_le_bytes());
            let mut records = Records::new(&file, true).unwrap();
            assert!(matches!(records.next(), Some(Err(McapError::RecordTooLarge { .. }))), "{claims}");
        }
    }
}
