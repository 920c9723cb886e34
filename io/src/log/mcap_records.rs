//! The records of an MCAP file, chunks unpacked; any bytes are safe to read.
//!
//! The reader of the `mcap` crate does not check two lengths: that of a record inside a chunk that is not compressed, which may
//! claim more than the chunk, and one near 2⁶⁴. Both are looked at before it sees them.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult, parse_record};

/// Longest record beyond the length of the file itself: compressed ones may be longer than their file.
const LONGEST_RECORD: usize = 16 << 20;
/// Bytes that a file of any size may unpack to, and those for each of its own. Joint states with even stamps and values that never
/// change are packed to a few hundredths; no log of an arm comes near a thousandth.
const UNPACKED: u64 = 64 << 20;
const UNPACKED_PER_BYTE: u64 = 1000;
/// Bytes in front of every record: what it is, and its length.
const FRAME: usize = 9;

/// The records of a file, in order.
pub(crate) struct Records<'a> {
    rest: &'a [u8],
    reader: LinearReader,
    /// Bytes of the file.
    length: u64,
    /// Records that were read, and their bytes.
    read: (u64, u64),
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
        let reader = LinearReader::new_with_options(options);
        Ok(Self { rest: bytes, reader, length: bytes.len() as u64, read: (0, 0) })
    }
}

impl Iterator for Records<'_> {
    type Item = McapResult<Record<'static>>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.reader.next_event()? {
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    self.read = (self.read.0 + 1, self.read.1 + (FRAME + data.len()) as u64);
                    if let Some(fault) = too_much(self.length, self.read) {
                        return Some(Err(fault));
                    }
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

/// Why no file of this length holds so many records, or so many bytes in them: packed, each record takes more than a byte.
fn too_much(length: u64, (records, unpacked): (u64, u64)) -> Option<McapError> {
    let most = UNPACKED.saturating_add(UNPACKED_PER_BYTE.saturating_mul(length));
    let fault = if records > length {
        format!("its {length} bytes unpack to more than {length} records, expected at most one for each byte")
    } else if unpacked > most {
        format!(
            "its {length} bytes unpack to more than {most}, expected at most {UNPACKED_PER_BYTE} for each byte and \
             {UNPACKED} besides"
        )
    } else {
        return None;
    };
    Some(McapError::DecompressionError(fault))
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
    use std::io::Cursor;

    use mcap::write::PrivateRecordOptions;
    use mcap::{Compression, WriteOptions};

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

    /// A file whose records, private ones of these contents, are packed in one chunk.
    fn packed<'a>(contents: impl Iterator<Item = &'a [u8]>) -> Vec<u8> {
        let options = WriteOptions::new().compression(Some(Compression::Zstd)).chunk_size(None);
        let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
        for content in contents {
            writer.write_private_record(0x80, content, PrivateRecordOptions::IncludeInChunks.into()).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    #[test]
    fn a_file_that_unpacks_to_the_world_is_refused() {
        let long = vec![0; 1 << 20];
        let (empty, long): (&[u8], &[u8]) = (&[], &long);
        let limits = "expected at most 1000 for each byte and 67108864 besides";
        for (content, count, words) in
            [(empty, 1 << 20, "records, expected at most one for each byte"), (long, 400, limits)]
        {
            let file = packed(std::iter::repeat_n(content, count));
            let fault = Records::new(&file, true).unwrap().find_map(Result::err).unwrap().to_string();
            assert!(fault.contains(words), "{} bytes: {fault}", file.len());
        }
        // Values that differ from record to record, and long records of zeros, are read.
        let numbers: Vec<[u8; 4]> = (0..50_000_u32).map(u32::to_le_bytes).collect();
        let is_private = |record: &McapResult<Record<'_>>| matches!(record, Ok(Record::Unknown { .. }));
        let numbered = packed(numbers.iter().map(<[u8; 4]>::as_slice));
        assert_eq!(Records::new(&numbered, true).unwrap().filter(is_private).count(), numbers.len());
        let zeros = packed(std::iter::repeat_n(long, 60));
        assert_eq!(Records::new(&zeros, true).unwrap().filter(is_private).count(), 60);
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
