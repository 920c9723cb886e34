//! Parquet as a table: columns of numbers, and lists of as many in every row, whose values become columns of their own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use armid::provenance::sha256_of_bytes;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::error::Error;
use crate::table::{ColumnTable, LogTable, MOST_COLUMNS};

/// How such a file begins, and ends.
pub(super) const MAGIC: &[u8] = b"PAR1";
/// Rows that are decoded at once.
const BATCH: usize = 1 << 14;

/// Reads one file.
///
/// # Errors
/// [`Error`] where it is no Parquet, or is compressed in a way that is not read.
pub(super) fn table(path: &Path, bytes: Vec<u8>) -> Result<LogTable, Error> {
    let name = path.display().to_string();
    let sha256 = sha256_of_bytes(&bytes);
    let columns = columns(&name, bytes)?;
    Ok(LogTable::Columns(columns_of(ColumnTable::new(name, sha256), columns)))
}

/// The columns of a file, added to a table.
pub(super) fn columns_of(mut table: ColumnTable, columns: Vec<ParquetColumn>) -> ColumnTable {
    for column in columns {
        match column.values {
            Ok(values) if column.width == 0 => table.add(&column.name, values, column.unit),
            Ok(values) => table.add_array(&column.name, &values, column.width),
            Err(what) => table.add_other(&column.name, what),
        }
    }
    table
}

/// A column of a file.
#[derive(Clone, Debug)]
pub(super) struct ParquetColumn {
    pub(super) name: String,
    /// Values row after row, NaN where there is none, or what it holds instead of numbers.
    pub(super) values: Result<Vec<f64>, String>,
    /// Values in the list of each row; zero where it is no list.
    pub(super) width: usize,
    /// The unit of stamps.
    pub(super) unit: Option<&'static str>,
}

/// Every column of a file that `name` calls, in its order.
///
/// # Errors
/// As [`table`].
pub(super) fn columns(name: &str, bytes: Vec<u8>) -> Result<Vec<ParquetColumn>, Error> {
    let fault = |error: ParquetError| {
        let message = format!("{name} cannot be read as Parquet: {error}");
        Error::new(message).help("plain, snappy, gzip and zstd columns are read: write the file with one of them")
    };
    // The library panics where sizes and places in a file contradict each other.
    let decoded = catch_unwind(AssertUnwindSafe(|| {
        let size = bytes.len();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes))?;
        check_places(&reader, size)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        (0..schema.num_columns()).map(|at| column(&reader, at, &schema.column(at))).collect()
    }));
    decoded.unwrap_or_else(|_| Err(contradiction())).map_err(fault)
}

/// Whether every column is inside the file.
fn check_places(reader: &SerializedFileReader<bytes::Bytes>, size: usize) -> ParquetResult<()> {
    let chunks = reader.metadata().row_groups().iter().flat_map(|group| group.columns());
    for chunk in chunks {
        let first = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
        let end = first.checked_add(chunk.compressed_size());
        if first < 0
            || chunk.compressed_size() < 0
            || end.is_none_or(|end| usize::try_from(end).map_or(true, |end| end > size))
        {
            return Err(contradiction());
        }
    }
    Ok(())
}

fn contradiction() -> ParquetError {
    ParquetError::General("its sizes and places contradict each other".to_owned())
}

/// Present values of a column, and the levels of all.
#[derive(Default)]
struct Leaf {
    values: Vec<f64>,
    definition: Vec<i16>,
    repetition: Vec<i16>,
    /// What stamps count from.
    first: Option<i64>,
}

fn column(
    reader: &SerializedFileReader<bytes::Bytes>,
    at: usize,
    descriptor: &ColumnDescriptor,
) -> ParquetResult<ParquetColumn> {
    let parts: Vec<&str> = descriptor.path().parts().iter().map(String::as_str).collect();
    let depth = descriptor.max_rep_level();
    // A list is a group around a repeated group around its element.
    let named = if depth > 0 { parts.len().saturating_sub(2).max(1) } else { parts.len() };
    let unit = match (descriptor.logical_type_ref(), descriptor.converted_type()) {
        (Some(LogicalType::Timestamp(stamp)), _) => Some(match stamp.unit {
            TimeUnit::MILLIS => "ms",
            TimeUnit::MICROS => "us",
            TimeUnit::NANOS => "ns",
        }),
        (_, ConvertedType::TIMESTAMP_MILLIS) => Some("ms"),
        (_, ConvertedType::TIMESTAMP_MICROS) => Some("us"),
        _ => None,
    };
    let of = |values, width| ParquetColumn { name: parts[..named].join("."), values, width, unit };
    let other = |what: &str| Ok(of(Err(what.to_owned()), 0));
    if depth > 1 {
        return other("lists of lists");
    }
    if descriptor.converted_type() == ConvertedType::DECIMAL {
        return other("decimals");
    }
    let mut leaf = Leaf::default();
    for group in 0..reader.num_row_groups() {
        match reader.get_row_group(group)?.get_column_reader(at)? {
            ColumnReader::BoolColumnReader(values) => leaf.read(values, |_, x| f64::from(u8::from(*x)))?,
            ColumnReader::Int32ColumnReader(values) => leaf.read(values, |_, x| f64::from(*x))?,
            ColumnReader::Int64ColumnReader(values) if unit.is_some() => {
                // Since the first: nanoseconds of a clock have more digits than a double.
                leaf.read(values, |first, x| (i128::from(*x) - i128::from(*first.get_or_insert(*x))) as f64)?;
            }
            ColumnReader::Int64ColumnReader(values) => leaf.read(values, |_, x| *x as f64)?,
            ColumnReader::FloatColumnReader(values) => leaf.read(values, |_, x| f64::from(*x))?,
            ColumnReader::DoubleColumnReader(values) => leaf.read(values, |_, x| *x)?,
            ColumnReader::Int96ColumnReader(_) => return other("stamps of 96 bits"),
            ColumnReader::ByteArrayColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => {
                return other("texts or bytes");
            }
        }
    }
    Ok(match leaf.rows(descriptor) {
        Ok((values, width)) => of(Ok(values), width),
        Err(what) => of(Err(what), 0),
    })
}

impl Leaf {
    fn read<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        number: impl Fn(&mut Option<i64>, &T::T) -> f64,
    ) -> ParquetResult<()> {
        loop {
            let mut values: Vec<T::T> = Vec::new();
            let (definition, repetition) = (&mut self.definition, &mut self.repetition);
            let (records, _, _) = reader.read_records(BATCH, Some(definition), Some(repetition), &mut values)?;
            self.values.extend(values.iter().map(|value| number(&mut self.first, value)));
            if records == 0 {
                return Ok(());
            }
        }
    }

    /// Values row after row, and the length of each row's list; zero where the column holds none.
    fn rows(&self, descriptor: &ColumnDescriptor) -> Result<(Vec<f64>, usize), String> {
        let most = descriptor.max_def_level();
        let mut values = self.values.iter().copied();
        if descriptor.max_rep_level() == 0 {
            let present = |level: &i16| if *level == most { values.next().unwrap_or(f64::NAN) } else { f64::NAN };
            return Ok((if most == 0 { values.collect() } else { self.definition.iter().map(present).collect() }, 0));
        }
        // Below this level a row has no list, or an empty one.
        let least = most - i16::from(descriptor.self_type().is_optional());
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (definition, repetition) in self.definition.iter().zip(&self.repetition) {
            if *repetition == 0 {
                rows.push(Vec::new());
            }
            let Some(row) = rows.last_mut().filter(|_| *definition >= least) else { continue };
            row.push(if *definition == most { values.next().unwrap_or(f64::NAN) } else { f64::NAN });
        }
        let width = rows.iter().map(Vec::len).max().unwrap_or(0);
        if rows.iter().any(|row| !row.is_empty() && row.len() != width) {
            return Err("lists of unlike length".to_owned());
        }
        if width == 0 {
            return Err("empty lists".to_owned());
        }
        if width > MOST_COLUMNS {
            return Err(format!("lists of {width} values, expected at most {MOST_COLUMNS}"));
        }
        let missing = vec![f64::NAN; width];
        Ok((rows.iter().flat_map(|row| if row.is_empty() { &missing } else { row }).copied().collect(), width))
    }
}
