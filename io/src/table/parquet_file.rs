//! A Parquet file that grows row by row and is read by other tools; the same rows give the same bytes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result as ParquetResult;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::error::Error;
use crate::output::GrowingFile;

/// So many rows are held until they are written together.
const GROUP: usize = 1 << 16;

/// What a column holds.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// 64-bit integers.
    Integer,
    /// Doubles, or nothing.
    Number,
    /// UTF-8.
    Text,
}

/// One value of a row. A text that stands in many rows is held once.
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    Integer(i64),
    Number(Option<f64>),
    Text(ByteArray),
}

/// The rows of one column that are not written yet.
#[derive(Debug)]
enum Column {
    Integer(Vec<i64>),
    Number { present: Vec<f64>, levels: Vec<i16> },
    Text(Vec<ByteArray>),
}

/// A file under way.
pub(crate) struct ParquetFile {
    path: PathBuf,
    writer: SerializedFileWriter<GrowingFile>,
    columns: Vec<Column>,
    rows: usize,
    groups: usize,
}

impl ParquetFile {
    /// Begins a file with these columns.
    ///
    /// # Errors
    /// [`Error`] where it cannot be made.
    pub(crate) fn create(path: &Path, columns: &[(&str, Kind)]) -> Result<Self, Error> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("armid ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let file = GrowingFile::create(path)?;
        let writer = schema(columns)
            .and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)))
            .map_err(|error| unwritable(path, error))?;
        let columns = columns.iter().map(|(_, kind)| Column::new(*kind)).collect();
        Ok(Self { path: path.to_path_buf(), writer, columns, rows: 0, groups: 0 })
    }

    /// Adds a row, one cell for each column.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written, or a cell is not of its column's kind.
    pub(crate) fn add(&mut self, row: impl IntoIterator<Item = Cell>) -> Result<(), Error> {
        let mut cells = row.into_iter();
        for column in &mut self.columns {
            match (column, cells.next()) {
                (Column::Integer(values), Some(Cell::Integer(value))) => values.push(value),
                (Column::Number { present, levels }, Some(Cell::Number(value))) => {
                    levels.push(i16::from(value.is_some()));
                    present.extend(value);
                }
                (Column::Text(values), Some(Cell::Text(value))) => values.push(value),
                _ => return Err(Error::new(format!("{}: a row does not fit its columns", self.path.display()))),
            }
        }
        self.rows += 1;
        if self.rows == GROUP { self.write_group() } else { Ok(()) }
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub(crate) fn finish(mut self) -> Result<(), Error> {
        if self.rows > 0 || self.groups == 0 {
            self.write_group()?;
        }
        let file = self.writer.into_inner().map_err(|error| unwritable(&self.path, error))?;
        file.finish().map_err(|error| Error::unwritable(&self.path, &error))
    }

    fn write_group(&mut self) -> Result<(), Error> {
        write_columns(&mut self.writer, &mut self.columns).map_err(|error| unwritable(&self.path, error))?;
        self.rows = 0;
        self.groups += 1;
        Ok(())
    }
}

impl Column {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Integer => Self::Integer(Vec::new()),
            Kind::Number => Self::Number { present: Vec::new(), levels: Vec::new() },
            Kind::Text => Self::Text(Vec::new()),
        }
    }
}

/// Writes the rows of all columns as one row group, and empties them.
fn write_columns(writer: &mut SerializedFileWriter<GrowingFile>, columns: &mut [Column]) -> ParquetResult<()> {
    let mut group = writer.next_row_group()?;
    for column in columns {
        let Some(mut writer) = group.next_column()? else { break };
        match column {
            Column::Integer(values) => {
                writer.typed::<Int64Type>().write_batch(values, None, None)?;
                values.clear();
            }
            Column::Number { present, levels } => {
                writer.typed::<DoubleType>().write_batch(present, Some(levels), None)?;
                present.clear();
                levels.clear();
            }
            Column::Text(values) => {
                writer.typed::<ByteArrayType>().write_batch(values, None, None)?;
                values.clear();
            }
        }
        writer.close()?;
    }
    group.close()?;
    Ok(())
}

fn schema(columns: &[(&str, Kind)]) -> ParquetResult<Type> {
    let field = |&(name, kind): &(&str, Kind)| {
        let builder = match kind {
            Kind::Integer => Type::primitive_type_builder(name, PhysicalType::INT64),
            Kind::Number => Type::primitive_type_builder(name, PhysicalType::DOUBLE),
            Kind::Text => Type::primitive_type_builder(name, PhysicalType::BYTE_ARRAY)
                .with_logical_type(Some(LogicalType::String)),
        };
        let repetition = if matches!(kind, Kind::Number) { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        Ok(Arc::new(builder.with_repetition(repetition).build()?))
    };
    Type::group_type_builder("armid").with_fields(columns.iter().map(field).collect::<ParquetResult<Vec<_>>>()?).build()
}

fn unwritable(path: &Path, error: parquet::errors::ParquetError) -> Error {
    Error::unwritable(path, &std::io::Error::other(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    fn written(path: &Path, rows: usize) -> Vec<u8> {
        let columns = [("run", Kind::Integer), ("rmse_nm", Kind::Number), ("status", Kind::Text)];
        let before = std::fs::read(path).ok();
        let mut file = ParquetFile::create(path, &columns).unwrap();
        let texts = ["ok", "diverged"].map(ByteArray::from);
        for row in 0..rows {
            let number = (row % 3 != 2).then_some(row as f64 / 4.0);
            file.add([Cell::Integer(row as i64), Cell::Number(number), Cell::Text(texts[row % 2].clone())]).unwrap();
        }
        assert!(file.add([Cell::Integer(1)]).is_err());
        drop(file);
        // What was not finished has changed nothing.
        assert_eq!(std::fs::read(path).ok(), before);
        let mut file = ParquetFile::create(path, &columns).unwrap();
        for row in 0..rows {
            let number = (row % 3 != 2).then_some(row as f64 / 4.0);
            file.add([Cell::Integer(row as i64), Cell::Number(number), Cell::Text(texts[row % 2].clone())]).unwrap();
        }
        file.finish().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn identity_rows_read_back_from_all_groups() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        for rows in [0, 5, 2 * GROUP + 7] {
            let bytes = written(&path, rows);
            assert_eq!(bytes, written(&path, rows));
            let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
            assert_eq!(reader.metadata().num_row_groups(), rows.div_ceil(GROUP).max(1));
            let mut count = 0;
            for (index, row) in reader.get_row_iter(None).unwrap().enumerate() {
                let row = row.unwrap();
                assert_eq!(row.get_long(0).unwrap(), index as i64);
                assert_eq!(row.get_double(1).ok(), (index % 3 != 2).then_some(index as f64 / 4.0));
                assert_eq!(row.get_string(2).unwrap(), ["ok", "diverged"][index % 2]);
                count += 1;
            }
            assert_eq!(count, rows);
        }
    }
}
