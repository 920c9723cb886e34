//! Tables of text in gzip.

use std::io::Read;
use std::path::Path;

use armid::input::size::TEXT_BYTES;
use armid::provenance::sha256_of_bytes;
use flate2::read::MultiGzDecoder;

use crate::error::Error;
use crate::table::LogTable;
use crate::text::Text;

/// How such a file begins.
pub(super) const MAGIC: &[u8] = &[0x1F, 0x8B];

/// Reads the table that a file holds.
///
/// # Errors
/// [`Error`] where it cannot be unpacked, or holds no table.
pub(super) fn table(path: &Path, bytes: &[u8]) -> Result<LogTable, Error> {
    let name = path.display().to_string();
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(TEXT_BYTES.most + 1).read_to_end(&mut unpacked);
    read.map_err(|error| Error::new(format!("{name} cannot be unpacked: {error}")))?;
    TEXT_BYTES.check(&name, unpacked.len() as f64).map_err(Error::from)?;
    LogTable::of_unpacked(Text::of_bytes(path, unpacked)?, sha256_of_bytes(bytes))
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::path::Path;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::table;

    #[test]
    fn identity_a_table_in_gzip_is_the_table() {
        let text = "t,q1,tau1\n0,1,2\n0.1,3,4\n";
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(text.as_bytes()).unwrap();
        let packed = packed.finish().unwrap();
        let read = table(Path::new("r.csv.gz"), &packed).unwrap();
        assert_eq!((read.names().join(","), read.rows()), ("t,q1,tau1".to_owned(), Some(2)));
        let fault = table(Path::new("r.csv.gz"), &packed[..packed.len() - 12]).unwrap_err().to_string();
        assert!(fault.starts_with("r.csv.gz cannot be unpacked"), "{fault}");
    }
}
