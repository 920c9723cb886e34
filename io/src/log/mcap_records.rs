//! The records of an MCAP file, chunks unpacked; any bytes are safe to read.
//!
//! The reader of the `mcap` crate does not check two lengths: that of a record inside a chunk that is not compressed, which may
//! claim more than the chunk, and one near 2⁶⁴. Both are looked at before it sees them.

use std::io::{self, BufReader, Read, Seek, SeekFrom};

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

/// The records of a file, in order. Of the file, what is longest in memory is one chunk.
pub(crate) struct Records<R> {
    source: BufReader<R>,
    reader: LinearReader,
    /// Bytes of the file, and those that are not read yet.
    length: u64,
    rest: u64,
    /// Records that were read, and their bytes.
    read: (u64, u64),
}

impl<R: Read + Seek> Records<R> {
    /// The records of a file, with or without the end of an MCAP file; `crcs` checks those of its chunks.
    ///
    /// # Errors
    /// [`McapError`] where a record is longer than the chunk around it, or the file cannot be read.
    pub(crate) fn new(mut source: R, crcs: bool) -> McapResult<Self> {
        let length = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        Frames { source: BufReader::new(&mut source), at: 0, length }.check_chunks()?;
        source.rewind()?;
        let longest = usize::try_from(length).unwrap_or(usize::MAX).saturating_add(LONGEST_RECORD);
        let options = LinearReaderOptions::default()
            .with_skip_end_magic(true)
            .with_validate_chunk_crcs(crcs)
            .with_record_length_limit(longest);
        let reader = LinearReader::new_with_options(options);
        Ok(Self { source: BufReader::new(source), reader, length, rest: length, read: (0, 0) })
    }

    /// Gives the reader bytes of the file, no more than there are.
    fn read_on(&mut self, wanted: usize) -> io::Result<()> {
        let wanted = wanted.min(usize::try_from(self.rest).unwrap_or(usize::MAX));
        self.source.read_exact(self.reader.insert(wanted))?;
        self.reader.notify_read(wanted);
        self.rest -= wanted as u64;
        Ok(())
    }
}

impl<R: Read + Seek> Iterator for Records<R> {
    type Item = McapResult<Record<'static>>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let wanted = match self.reader.next_event()? {
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    self.read = (self.read.0 + 1, self.read.1 + (FRAME + data.len()) as u64);
                    if let Some(fault) = too_much(self.length, self.read) {
                        return Some(Err(fault));
                    }
                    return Some(parse_record(opcode, data).map(Record::into_owned));
                }
                Ok(LinearReadEvent::ReadRequest(wanted)) => wanted,
                Err(error) => return Some(Err(error)),
            };
            if let Err(error) = self.read_on(wanted) {
                return Some(Err(error.into()));
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

/// A walk along the records of a file, by what each claims.
struct Frames<R> {
    source: R,
    at: u64,
    length: u64,
}

impl<R: Read + Seek> Frames<BufReader<R>> {
    /// So many bytes at a place, if they are there.
    fn bytes<const N: usize>(&mut self, at: u64) -> McapResult<Option<[u8; N]>> {
        if at.checked_add(N as u64).is_none_or(|end| end > self.length) {
            return Ok(None);
        }
        let mut bytes = [0; N];
        // Within the file, so no difference of places is beyond an i64.
        self.source.seek_relative(at as i64 - self.at as i64)?;
        self.source.read_exact(&mut bytes)?;
        self.at = at + N as u64;
        Ok(Some(bytes))
    }

    /// What a record is and where its content ends, as it claims.
    fn frame(&mut self, at: u64) -> McapResult<Option<(u8, u64)>> {
        let Some([opcode, length @ ..]) = self.bytes::<FRAME>(at)? else { return Ok(None) };
        Ok(Some((opcode, (at + FRAME as u64).saturating_add(u64::from_le_bytes(length)))))
    }

    /// The records of a chunk that is not compressed, as far as it is there: where they begin and where they end.
    fn plain_records(&mut self, chunk: u64) -> McapResult<Option<(u64, u64)>> {
        // Two times, uncompressed size and checksum, name of the compression, compressed size.
        let name = chunk + FRAME as u64 + 28;
        let (compression, size) = (self.bytes::<4>(name)?, self.bytes::<8>(name + 4)?);
        Ok(match (compression, size) {
            (Some([0, 0, 0, 0]), Some(size)) => Some((name + 12, (name + 12).saturating_add(u64::from_le_bytes(size)))),
            _ => None,
        })
    }

    /// Every record of a chunk that is not compressed ends inside its chunk. What is cut off is left to the reader.
    fn check_chunks(mut self) -> McapResult<()> {
        let mut at = mcap::MAGIC.len() as u64;
        while let Some((opcode, end)) = self.frame(at)? {
            if opcode == op::CHUNK
                && let Some((mut record, last)) = self.plain_records(at)?
            {
                while record < last && record + FRAME as u64 <= self.length {
                    let inside = self.frame(record)?.filter(|_| record + FRAME as u64 <= last);
                    match inside {
                        Some((_, next)) if next <= last => record = next,
                        _ => return Err(McapError::UnexpectedEoc),
                    }
                }
            }
            at = end;
        }
        Ok(())
    }
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
            let fault = Records::new(Cursor::new(&file), true).unwrap().find_map(Result::err).unwrap().to_string();
            assert!(fault.contains(words), "{} bytes: {fault}", file.len());
        }
        // Values that differ from record to record, and long records of zeros, are read.
        let numbers: Vec<[u8; 4]> = (0..50_000_u32).map(u32::to_le_bytes).collect();
        let is_private = |record: &McapResult<Record<'_>>| matches!(record, Ok(Record::Unknown { .. }));
        let numbered = packed(numbers.iter().map(<[u8; 4]>::as_slice));
        assert_eq!(Records::new(Cursor::new(&numbered), true).unwrap().filter(is_private).count(), numbers.len());
        let zeros = packed(std::iter::repeat_n(long, 60));
        assert_eq!(Records::new(Cursor::new(&zeros), true).unwrap().filter(is_private).count(), 60);
    }

    #[test]
    fn a_record_longer_than_its_chunk_is_refused() {
        assert!(Records::new(Cursor::new(file(2)), true).is_ok());
        for claims in [3, 40, 1 << 40, u64::MAX - 8, u64::MAX] {
            assert!(matches!(Records::new(Cursor::new(file(claims)), true), Err(McapError::UnexpectedEoc)), "{claims}");
        }
    }

    #[test]
    fn a_record_that_claims_the_world_is_refused_without_asking_for_it() {
        for claims in [1_u64 << 40, u64::MAX - 8, u64::MAX] {
            let mut file = mcap::MAGIC.to_vec();
            file.push(op::METADATA);
            file.extend(claims.to_le_bytes());
            let mut records = Records::new(Cursor::new(&file), true).unwrap();
            assert!(matches!(records.next(), Some(Err(McapError::RecordTooLarge { .. }))), "{claims}");
        }
    }
}
