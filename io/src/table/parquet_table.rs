//! Columns of equal length as a Parquet file that other tools open; the same columns give the same bytes.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result as ParquetResult;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// One column; `None` is a null.
#[derive(Clone, Debug)]
pub(crate) enum Column {
    /// 64-bit integers.
    Integer(Vec<i64>),
    /// Doubles.
    Number(Vec<Option<f64>>),
    /// UTF-8.
    Text(Vec<String>),
}

/// A table under way: names and columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParquetTable {
    columns: Vec<(String, Column)>,
}

impl ParquetTable {
    /// The same table with one more column.
    #[must_use]
    pub(crate) fn with(mut self, name: impl Into<String>, column: Column) -> Self {
        self.columns.push((name.into(), column));
        self
    }

    /// Writes the table as one row group.
    pub(crate) fn write(&self, out: &mut dyn Write) -> ParquetResult<()> {
        let mut bytes = Vec::new();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("armid ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(self.schema()?), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for (_, column) in &self.columns {
            if let Some(mut writer) = group.next_column()? {
                match column {
                    Column::Integer(values) => {
                        writer.typed::<Int64Type>().write_batch(values, None, None)?;
                    }
                    Column::Number(values) => {
                        let present: Vec<f64> = values.iter().copied().flatten().collect();
                        let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
                        writer.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
                    }
                    Column::Text(values) => {
                        let texts: Vec<ByteArray> = values.iter().map(|text| ByteArray::from(text.as_str())).collect();
                        writer.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
                    }
                }
                writer.close()?;
            }
        }
        group.close()?;
        writer.close()?;
        out.write_all(&bytes)?;
        Ok(())
    }

    fn schema(&self) -> ParquetResult<Type> {
        let fields = self
            .columns
            .iter()
            .map(|(name, column)| {
                let builder = match column {
                    Column::Integer(_) => Type::primitive_type_builder(name, PhysicalType::INT64),
                    Column::Number(_) => Type::primitive_type_builder(name, PhysicalType::DOUBLE),
                    Column::Text(_) => Type::primitive_type_builder(name, PhysicalType::BYTE_ARRAY)
                        .with_logical_type(Some(LogicalType::String)),
                };
                let repetition =
                    if matches!(column, Column::Number(_)) { Repetition::OPTIONAL } else { Repetition::REQUIRED };
                Ok(Arc::new(builder.with_repetition(repetition).build()?))
            })
            .collect::<ParquetResult<Vec<_>>>()?;
        Type::group_type_builder("armid").with_fields(fields).build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    #[test]
    fn identity_rows_read_back() {
        let table = ParquetTable::default()
            .with("run", Column::Integer(vec![1, 2]))
            .with("rmse_nm", Column::Number(vec![Some(0.25), None]))
            .with("status", Column::Text(vec!["ok".into(), "diverged".into()]));
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        let mut again = Vec::new();
        table.write(&mut again).unwrap();
        assert_eq!(bytes, again);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        std::fs::write(&path, &bytes).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!((rows[0].get_long(0).unwrap(), rows[0].get_double(1).unwrap()), (1, 0.25));
        assert_eq!(rows[1].get_string(2).unwrap(), "diverged");
        assert!(rows[1].get_double(1).is_err());
    }
}
