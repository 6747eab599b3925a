//! scenarios: run files in Parquet. In: the bytes. Out: named columns of numbers, or the fault by column.

use super::guarded;
use crate::columns::{Columns, fault};
use crate::error::ReadError;
use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::Result;
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::path::Path;

/// Reads all columns of numbers of a flat table; a null is NaN, what is no number is left out.
pub(super) fn read(path: &Path, bytes: Vec<u8>) -> std::result::Result<Columns, ReadError> {
    let broken = |key: &str, e: &str| {
        let remedy = "Parquet of numbers in flat columns, without compression or with snappy, gzip, lz4 or zstd";
        ReadError::Faults(vec![fault(path, None, key, "", &format!("cannot be read as Parquet: {e}"), remedy)])
    };
    let reader = crate::parquet_rows::open(Bytes::from(bytes)).map_err(|e| broken("", &e.to_string()))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let (mut names, mut data, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..schema.num_columns() {
        let column = schema.column(i);
        let name = column.path().string();
        let read = || numbers(&reader, i, column.max_def_level(), column.max_rep_level()).map_err(|e| e.to_string());
        match guarded(read) {
            Ok(Some(values)) => {
                names.push(name);
                data.push(values);
            }
            Ok(None) => left.push(name),
            Err(e) => return Err(broken(&name, &e)),
        }
    }
    let rows = data.first().map_or(0, Vec::len);
    if rows == 0 {
        return Err(ReadError::Faults(vec![fault(path, None, "", "", "has no rows", "one row per sample")]));
    }
    if let Some(i) = data.iter().position(|c| c.len() != rows) {
        let found = format!("has {} rows where {} has {rows}", data[i].len(), names[0]);
        return Err(broken(&names[i], &found));
    }
    let mut columns = Columns::new(names, data, (1..=rows).collect());
    columns.leave_out(&left);
    Ok(columns)
}

/// One column over all groups of rows; `None` when it is nested or not of numbers.
fn numbers(file: &SerializedFileReader<Bytes>, place: usize, def: i16, rep: i16) -> Result<Option<Vec<f64>>> {
    if rep > 0 || def > 1 {
        return Ok(None);
    }
    let mut all = Vec::new();
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        match group.get_column_reader(place)? {
            ColumnReader::DoubleColumnReader(r) => add::<DoubleType>(r, rows, def, &mut all, |x| x)?,
            ColumnReader::FloatColumnReader(r) => add::<FloatType>(r, rows, def, &mut all, f64::from)?,
            ColumnReader::Int32ColumnReader(r) => add::<Int32Type>(r, rows, def, &mut all, f64::from)?,
            #[expect(clippy::cast_precision_loss, reason = "no sample needs more than 53 bits")]
            ColumnReader::Int64ColumnReader(r) => add::<Int64Type>(r, rows, def, &mut all, |x| x as f64)?,
            _ => return Ok(None),
        }
    }
    Ok(Some(all))
}

fn add<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    def: i16,
    all: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<()> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    reader.read_records(rows, (def > 0).then_some(&mut levels), None, &mut values)?;
    let finite = |x: f64| if x.is_finite() { x } else { f64::NAN };
    let mut values = values.into_iter().map(|v| finite(number(v)));
    if def == 0 {
        all.extend(values);
    } else {
        all.extend(levels.iter().map(|l| if *l > 0 { values.next().unwrap_or(f64::NAN) } else { f64::NAN }));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::basic::Compression;
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::fs::File;
    use std::sync::Arc;

    /// Nulls, whole numbers and floats in two groups of rows come back as numbers and NaN, whatever the compression.
    #[test]
    fn law_numbers_of_any_type_and_nulls() {
        let schema = Arc::new(
            parse_message_type("message run { required double t_s; optional float X_m; required int64 n; }").expect("a schema"),
        );
        let dir = tempfile::tempdir().expect("a folder");
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::GZIP(Default::default()),
            Compression::LZ4_RAW,
            Compression::ZSTD(Default::default()),
        ] {
            let path = dir.path().join("run.parquet");
            let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
            let mut file =
                SerializedFileWriter::new(File::create(&path).expect("writable"), schema.clone(), properties).expect("new");
            for g in 0..2 {
                let t = f64::from(g);
                let mut group = file.next_row_group().expect("group");
                let mut next = |w: &mut dyn FnMut(&mut parquet::file::writer::SerializedColumnWriter<'_>)| {
                    let mut c = group.next_column().expect("column").expect("column");
                    w(&mut c);
                    c.close().expect("closed");
                };
                next(&mut |c| assert_eq!(c.typed::<DoubleType>().write_batch(&[t, t + 0.5], None, None).expect("written"), 2));
                next(&mut |c| assert_eq!(c.typed::<FloatType>().write_batch(&[2.5], Some(&[0, 1]), None).expect("written"), 1));
                next(&mut |c| assert_eq!(c.typed::<Int64Type>().write_batch(&[7, -7], None, None).expect("written"), 2));
                group.close().expect("closed");
            }
            file.close().expect("closed");
            let read = crate::formats::read_columns(&path).expect("numbers");
            assert_eq!(read.get("t_s"), Some(&[0.0, 0.5, 1.0, 1.5][..]));
            assert_eq!(read.get("n"), Some(&[7.0, -7.0, 7.0, -7.0][..]));
            let x = read.get("X_m").expect("a column");
            assert!(x[0].is_nan() && x[1].to_bits() == 2.5_f64.to_bits() && x[2].is_nan() && x.len() == 4);
        }
    }

    #[test]
    fn law_what_is_no_parquet_is_a_fault_with_the_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("run.parquet");
        std::fs::write(&path, "t_s,X_m\n0,1\n").expect("writable");
        let message = crate::formats::read_columns(&path).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(message.contains("run.parquet") && message.contains("cannot be read as Parquet"), "{message}");
    }
}
