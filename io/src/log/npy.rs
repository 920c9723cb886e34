//! NumPy's arrays, alone (`.npy`) or by name in an archive (`.npz`, stored or deflated).
//!
//! ```text
//! \x93NUMPY  version  length of the heading  {'descr': '<f8', 'fortran_order': False, 'shape': (N, n)}  values
//! ```
//! An array of N values is a column, one of N × n values is n of them. Values may be floats of 32 and 64 bits, integers and Booleans, of
//! either byte order. Pickled objects are not read.

use std::io::{Cursor, Read};
use std::path::Path;

use armid::input::size::RECORDING_BYTES;
use armid::provenance::sha256_of_bytes;
use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::Error;
use crate::table::{ColumnTable, LogTable};

/// How an array begins.
pub(super) const ARRAY: &[u8] = b"\x93NUMPY";
/// How an archive begins.
pub(super) const ARCHIVE: &[u8] = b"PK\x03\x04";

/// Longest heading of an array, bytes: it holds a type and a shape.
const HEADING: usize = 1 << 14;

/// Reads one array, whose name is that of the file.
///
/// # Errors
/// [`Error`] where it is no array.
pub(super) fn array(path: &Path, bytes: Vec<u8>) -> Result<LogTable, Error> {
    let name = path.display().to_string();
    let mut table = ColumnTable::new(&name, sha256_of_bytes(&bytes));
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    add(&mut table, &stem, &bytes).map_err(|fault| Error::new(format!("{name}: {fault}")))?;
    Ok(LogTable::Columns(table))
}

/// Reads an archive of arrays.
///
/// # Errors
/// [`Error`] where it is none, or holds no array.
pub(super) fn archive(path: &Path, bytes: Vec<u8>) -> Result<LogTable, Error> {
    let name = path.display().to_string();
    let fault = |error: ZipError| Error::new(format!("{name} cannot be read as a NumPy archive: {error}"));
    let mut table = ColumnTable::new(&name, sha256_of_bytes(&bytes));
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(fault)?;
    let (mut others, mut held) = (Vec::new(), 0);
    for at in 0..archive.len() {
        let member = archive.by_index(at).map_err(fault)?;
        let called = member.name().map_err(fault)?.into_owned();
        let Some(array) = called.strip_suffix(".npy") else {
            others.push(called);
            continue;
        };
        let mut bytes = Vec::new();
        let left = RECORDING_BYTES.most.saturating_sub(held);
        member
            .take(left + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| Error::new(format!("{name}: {called} cannot be unpacked: {error}")))?;
        held += bytes.len() as u64;
        RECORDING_BYTES.check(&name, held as f64).map_err(Error::from)?;
        add(&mut table, array, &bytes).map_err(|fault| Error::new(format!("{name}: {called}: {fault}")))?;
    }
    if table.width() == 0 {
        let found = if others.is_empty() { "nothing".to_owned() } else { others.join(", ") };
        return Err(Error::unknown(format!("{name} is an archive without arrays (.npy), found {found}")));
    }
    Ok(LogTable::Columns(table))
}

/// Adds the array in these bytes to a table.
fn add(table: &mut ColumnTable, name: &str, bytes: &[u8]) -> Result<(), String> {
    let (heading, values) = heading(bytes)?;
    let shape = heading.shape;
    if shape.is_empty() || shape.len() > 2 {
        let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
        let what =
            if shape.is_empty() { "a single value".to_owned() } else { format!("an array of {}", sizes.join(" × ")) };
        table.add_other(name, format!("{what}, expected N or N × joints"));
        return Ok(());
    }
    let Some(read) = number(&heading.kind) else {
        table.add_other(name, format!("values of the type {}, expected floats or integers", heading.kind));
        return Ok(());
    };
    let size = size_of(&heading.kind);
    let count = shape.iter().try_fold(1_usize, |all, n| all.checked_mul(*n));
    if count.and_then(|count| count.checked_mul(size)) != Some(values.len()) {
        let expected = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
        return Err(format!("{} bytes of values, expected {expected} of {size} bytes each", values.len()));
    }
    let values: Vec<f64> = values.chunks_exact(size).map(read).collect();
    match shape[..] {
        [rows, width] if heading.fortran => {
            let by_rows: Vec<f64> =
                (0..rows).flat_map(|row| values.iter().skip(row).step_by(rows.max(1)).copied()).collect();
            table.add_array(name, &by_rows, width);
        }
        [_, width] => table.add_array(name, &values, width),
        _ => table.add(name, values, None),
    }
    Ok(())
}

/// What stands in front of the values.
struct Heading {
    kind: String,
    fortran: bool,
    shape: Vec<usize>,
}

/// The heading of an array, and its values.
fn heading(bytes: &[u8]) -> Result<(Heading, &[u8]), String> {
    let broken = || "no array of NumPy: its heading is not whole".to_owned();
    let rest = bytes.strip_prefix(ARRAY).ok_or_else(broken)?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        [version, ..] => return Err(format!("version {version} of NumPy's format, expected 1, 2 or 3")),
        [] => return Err(broken()),
    };
    if length > HEADING || length > rest.len() {
        return Err(broken());
    }
    let (text, values) = rest.split_at(length);
    let text = std::str::from_utf8(text).map_err(|_| broken())?;
    let of = |key: &str| text.split_once(&format!("'{key}':")).map(|(_, value)| value.trim_start());
    let (kind, fortran, shape) = (of("descr"), of("fortran_order"), of("shape"));
    let (Some(kind), Some(fortran), Some(shape)) = (kind, fortran, shape) else { return Err(broken()) };
    let kind = match kind.strip_prefix('\'').and_then(|kind| kind.split_once('\'')) {
        Some((kind, _)) => kind.to_owned(),
        // A list of named fields.
        None => "record".to_owned(),
    };
    let sizes = shape.strip_prefix('(').and_then(|shape| shape.split_once(')')).ok_or_else(broken)?.0;
    let sizes = sizes.split(',').map(str::trim).filter(|size| !size.is_empty());
    let shape = sizes.map(|size| size.trim_end_matches('L').parse()).collect::<Result<Vec<usize>, _>>();
    Ok((Heading { kind, fortran: fortran.starts_with("True"), shape: shape.map_err(|_| broken())? }, values))
}

/// Bytes of a value.
fn size_of(kind: &str) -> usize {
    kind[2..].parse().unwrap_or(1)
}

/// What reads a value of this type; `None` where it is no number that is read.
fn number(kind: &str) -> Option<fn(&[u8]) -> f64> {
    macro_rules! of {
        ($type:ty, $from:ident) => {
            |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, |bytes| <$type>::$from(bytes) as f64)
        };
    }
    let either: [fn(&[u8]) -> f64; 2] = match kind.get(1..)? {
        "f8" => [of!(f64, from_le_bytes), of!(f64, from_be_bytes)],
        "f4" => [of!(f32, from_le_bytes), of!(f32, from_be_bytes)],
        "i8" => [of!(i64, from_le_bytes), of!(i64, from_be_bytes)],
        "i4" => [of!(i32, from_le_bytes), of!(i32, from_be_bytes)],
        "i2" => [of!(i16, from_le_bytes), of!(i16, from_be_bytes)],
        "i1" => [of!(i8, from_le_bytes); 2],
        "u8" => [of!(u64, from_le_bytes), of!(u64, from_be_bytes)],
        "u4" => [of!(u32, from_le_bytes), of!(u32, from_be_bytes)],
        "u2" => [of!(u16, from_le_bytes), of!(u16, from_be_bytes)],
        "u1" | "b1" => [of!(u8, from_le_bytes); 2],
        _ => return None,
    };
    match kind.as_bytes()[0] {
        b'<' | b'|' => Some(either[0]),
        b'>' => Some(either[1]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::path::Path;

    use zip::CompressionMethod;
    use zip::write::{SimpleFileOptions, ZipWriter};

    use super::{ARRAY, LogTable, archive, array};

    /// An array as NumPy writes it.
    fn written(kind: &str, fortran: &str, shape: &str, values: &[u8]) -> Vec<u8> {
        let heading = format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        [ARRAY, &[1, 0], &(heading.len() as u16).to_le_bytes(), heading.as_bytes(), values].concat()
    }

    fn read(bytes: Vec<u8>) -> Result<(Vec<String>, Vec<f64>), String> {
        let table = array(Path::new("q.npy"), bytes).map_err(|error| error.to_string())?;
        let all: Vec<usize> = (0..table.width()).collect();
        Ok((table.names(), table.values(&all).map_err(|error| error.to_string())?))
    }

    #[test]
    fn values_of_every_type_order_and_shape_are_read() {
        let of = |values: &[f64]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let (names, values) = read(written("<f8", "False", "(2, 2)", &of(&[1.0, 2.0, 3.0, 4.0]))).unwrap();
        assert_eq!((names, values), (vec!["q_0".to_owned(), "q_1".to_owned()], vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(read(written("<f8", "True", "(2, 2)", &of(&[1.0, 3.0, 2.0, 4.0]))).unwrap().1, [1.0, 2.0, 3.0, 4.0]);
        let single: Vec<u8> = [1.5_f32, -2.0].iter().flat_map(|x| x.to_be_bytes()).collect();
        assert_eq!(read(written(">f4", "False", "(2,)", &single)).unwrap(), (vec!["q".to_owned()], vec![1.5, -2.0]));
        let whole: Vec<u8> = [7_i64, -9].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(read(written("<i8", "False", "(2,)", &whole)).unwrap().1, [7.0, -9.0]);
        assert_eq!(read(written("|b1", "False", "(2,)", &[1, 0])).unwrap().1, [1.0, 0.0]);
        for (kind, shape, values, wanted) in [
            ("<f8", "(3,)", &of(&[1.0])[..], "8 bytes of values, expected 3 of 8 bytes each"),
            ("|O", "(1,)", &[0; 8], "q holds values of the type |O"),
            ("<f8", "()", &[0; 8], "q holds a single value"),
            ("<f8", "(1, 1, 1)", &[0; 8], "q holds an array of 1 × 1 × 1"),
            ("<f8", "(1, 99999999999999999999)", &[0; 8], "its heading is not whole"),
            ("<f8", "(4294967296, 4294967296)", &[0; 8], "8 bytes of values"),
        ] {
            let fault = read(written(kind, "False", shape, values)).unwrap_err();
            assert!(fault.contains(wanted), "{wanted} not in {fault}");
        }
    }

    #[test]
    fn identity_stored_and_deflated_members_are_the_same_columns() {
        let packed = |method, members: &[(&str, Vec<u8>)]| {
            let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
            for (name, bytes) in members {
                zip.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
                zip.write_all(bytes).unwrap();
            }
            zip.finish().unwrap().into_inner()
        };
        let q: Vec<u8> = (0..200).flat_map(|k| f64::from(k).to_le_bytes()).collect();
        let members = [
            ("t.npy", written("|u1", "False", "(100,)", &[7; 100])),
            ("q.npy", written("<f8", "False", "(100, 2)", &q)),
        ];
        for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
            let table = archive(Path::new("r.npz"), packed(method, &members)).unwrap();
            assert_eq!(table.names(), ["t", "q_0", "q_1"]);
            assert_eq!(table.values(&[0, 2]).unwrap()[..4], [7.0, 1.0, 7.0, 3.0]);
            assert!(matches!(table, LogTable::Columns(_)));
        }
        let other = packed(CompressionMethod::Stored, &[("xl/workbook.xml", Vec::new())]);
        let fault = archive(Path::new("r.xlsx"), other).unwrap_err().to_string();
        assert_eq!(fault, "r.xlsx is an archive without arrays (.npy), found xl/workbook.xml");
    }
}
