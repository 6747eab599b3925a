//! scenarios: rows of a study as Parquet. In: columns and rows. Out: the same bytes for the same rows; and back.

use crate::parquet_pages;
use bytes::Bytes;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, ParquetMetaDataReader};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{ChunkReader, FileReader, RowGroupReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, PrimitiveTypeBuilder, Type};
use std::io::Write;
use std::sync::Arc;
use windfall_model::study::{Cell, CellKind, Column, Row};

/// A kind of table: its name, and that of its first column, the number of a row.
#[derive(Clone, Copy)]
pub(crate) struct TableKind {
    name: &'static str,
    number: &'static str,
}

/// Draws of a study.
const STUDY: TableKind = TableKind { name: "windfall_study", number: "draw" };
/// Results of many campaigns.
pub(crate) const CAMPAIGNS: TableKind = TableKind { name: "windfall_campaigns", number: "campaign" };

fn field(name: &str, physical: Physical, repetition: Repetition) -> PrimitiveTypeBuilder<'_> {
    Type::primitive_type_builder(name, physical).with_repetition(repetition)
}

fn schema(kind: TableKind, columns: &[Column]) -> Result<Type> {
    let mut fields = vec![Arc::new(field(kind.number, Physical::INT64, Repetition::REQUIRED).build()?)];
    for c in columns {
        let built = match c.kind {
            CellKind::Number => field(&c.name, Physical::DOUBLE, Repetition::OPTIONAL).build()?,
            CellKind::Flag => field(&c.name, Physical::BOOLEAN, Repetition::OPTIONAL).build()?,
            CellKind::Word => {
                field(&c.name, Physical::BYTE_ARRAY, Repetition::REQUIRED).with_logical_type(Some(LogicalType::String)).build()?
            }
        };
        fields.push(Arc::new(built));
    }
    Type::group_type_builder(kind.name).with_fields(fields).build()
}

/// A Parquet file under way.
pub(crate) struct RowWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
}

impl<W: Write + Send> RowWriter<W> {
    pub(crate) fn new(sink: W, columns: &[Column]) -> Result<Self> {
        Self::of(STUDY, sink, columns)
    }
    fn of(kind: TableKind, sink: W, columns: &[Column]) -> Result<Self> {
        let mut properties = WriterProperties::builder()
            .set_created_by("windfall".to_owned())
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_offset_index_disabled(true)
            .set_statistics_enabled(EnabledStatistics::Chunk);
        for c in columns.iter().filter(|c| c.kind == CellKind::Word) {
            properties = properties.set_column_dictionary_enabled(ColumnPath::new(vec![c.name.clone()]), true);
        }
        let file = SerializedFileWriter::new(sink, Arc::new(schema(kind, columns)?), Arc::new(properties.build()))?;
        Ok(Self { file })
    }
    /// Adds rows as one group.
    pub(crate) fn group(&mut self, rows: &[Row]) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        let mut index = 0;
        while let Some(mut column) = group.next_column()? {
            let cell = |r: &Row| r.cells.get(index - 1).cloned();
            match column.untyped() {
                ColumnWriter::Int64ColumnWriter(w) => {
                    w.write_batch(&rows.iter().map(|r| r.draw.cast_signed()).collect::<Vec<_>>(), None, None)?;
                }
                ColumnWriter::DoubleColumnWriter(w) => {
                    let all = rows.iter().map(|r| if let Some(Cell::Number(x)) = cell(r) { x } else { None });
                    let (values, levels) = split(all);
                    w.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::BoolColumnWriter(w) => {
                    let all = rows.iter().map(|r| if let Some(Cell::Flag(x)) = cell(r) { x } else { None });
                    let (values, levels) = split(all);
                    w.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::ByteArrayColumnWriter(w) => {
                    let word = |r: &Row| if let Some(Cell::Word(x)) = cell(r) { x } else { String::new() };
                    w.write_batch(&rows.iter().map(|r| ByteArray::from(word(r).into_bytes())).collect::<Vec<_>>(), None, None)?;
                }
                _ => return Err(ParquetError::General("a study has no such column".to_owned())),
            }
            column.close()?;
            index += 1;
        }
        group.close()?;
        Ok(())
    }
    pub(crate) fn finish(self) -> Result<W> {
        self.file.into_inner()
    }
}

/// What is there, and for each place whether it is.
fn split<T>(all: impl Iterator<Item = Option<T>>) -> (Vec<T>, Vec<i16>) {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for x in all {
        levels.push(i16::from(x.is_some()));
        values.extend(x);
    }
    (values, levels)
}

/// Rows of one group as a whole file.
pub(crate) fn encode(columns: &[Column], rows: &[Row]) -> Result<Vec<u8>> {
    encode_as(STUDY, columns, rows)
}

/// The same for a table of any kind.
pub(crate) fn encode_as(kind: TableKind, columns: &[Column], rows: &[Row]) -> Result<Vec<u8>> {
    let mut writer = RowWriter::of(kind, Vec::new(), columns)?;
    writer.group(rows)?;
    writer.finish()
}

/// What the decoder makes of damaged bytes, its panics included.
fn guarded<T>(decode: impl FnOnce() -> Result<T>) -> Result<T> {
    crate::formats::guarded(|| Ok(decode())).unwrap_or_else(|reason| Err(ParquetError::General(reason)))
}

/// Any Parquet file, which may be damaged.
pub(crate) fn open<R: ChunkReader + 'static>(from: R) -> Result<SerializedFileReader<R>> {
    let metadata = guarded(|| ParquetMetaDataReader::new().parse_and_finish(&from))?;
    sound(&metadata, &from)?;
    guarded(|| SerializedFileReader::new(from))
}

/// Sizes, places and counts that cannot be: the decoder takes them as they are.
fn sound<R: ChunkReader>(metadata: &ParquetMetaData, from: &R) -> Result<()> {
    let place = |c: &ColumnChunkMetaData| {
        let [first, length] =
            [c.dictionary_page_offset().unwrap_or(c.data_page_offset()), c.compressed_size()].map(u64::try_from);
        let (first, length) = (first.ok()?, length.ok()?);
        let inside = c.num_values() >= 0 && c.data_page_offset() >= 0 && first.checked_add(length)? <= from.len();
        inside.then_some((first, usize::try_from(length).ok()?))
    };
    for group in metadata.row_groups() {
        for c in group.columns() {
            let Some((first, length)) = place(c).filter(|_| group.num_rows() >= 0) else {
                return Err(ParquetError::General("a column lies outside the file; it may be cut short".to_owned()));
            };
            if !parquet_pages::are_sound(&from.get_bytes(first, length)?) {
                return Err(ParquetError::General("a page states more than it can have".to_owned()));
            }
        }
    }
    Ok(())
}

/// All rows of a file made by [`encode`] with these columns.
pub(crate) fn decode(columns: &[Column], bytes: Vec<u8>) -> Result<Vec<Row>> {
    let file = open(Bytes::from(bytes))?;
    same_columns(&file, columns)?;
    let mut rows: Vec<Row> = draws(&file)?.into_iter().map(|draw| Row { draw, cells: Vec::new() }).collect();
    for (i, c) in columns.iter().enumerate() {
        for (row, cell) in rows.iter_mut().zip(column(&file, i + 1, c.kind)?) {
            row.cells.push(cell);
        }
    }
    if let Some(short) = rows.iter().find(|r| r.cells.len() != columns.len()) {
        return Err(ParquetError::General(format!("draw {} lacks cells", short.draw)));
    }
    Ok(rows)
}

/// Columns of a file made by a study, whatever the study.
pub(crate) fn columns_of<R: ChunkReader + 'static>(file: &SerializedFileReader<R>) -> Result<Vec<Column>> {
    let schema = file.metadata().file_metadata().schema_descr();
    let kind = |physical| match physical {
        Physical::DOUBLE => Ok(CellKind::Number),
        Physical::BOOLEAN => Ok(CellKind::Flag),
        Physical::BYTE_ARRAY => Ok(CellKind::Word),
        _ => Err(ParquetError::General("has a column that no study has".to_owned())),
    };
    let one = |i| Ok(Column { name: schema.column(i).name().to_owned(), kind: kind(schema.column(i).physical_type())? });
    (1..schema.num_columns()).map(one).collect()
}

pub(crate) fn same_columns<R: ChunkReader + 'static>(file: &SerializedFileReader<R>, columns: &[Column]) -> Result<()> {
    let schema = file.metadata().file_metadata().schema_descr();
    let names = (0..schema.num_columns()).map(|i| schema.column(i).name().to_owned());
    if names.eq([STUDY.number.to_owned()].into_iter().chain(columns.iter().map(|c| c.name.clone()))) {
        return Ok(());
    }
    Err(ParquetError::General("its columns are not those of this study".to_owned()))
}

pub(crate) fn draws<R: ChunkReader + 'static>(file: &SerializedFileReader<R>) -> Result<Vec<u64>> {
    let mut all = Vec::new();
    each_draw(file, &mut |draw| all.push(draw))?;
    Ok(all)
}

/// Shows the number of every draw, one group of rows in memory at a time.
pub(crate) fn each_draw<R: ChunkReader + 'static>(file: &SerializedFileReader<R>, see: &mut dyn FnMut(u64)) -> Result<()> {
    for group in 0..file.num_row_groups() {
        let values = guarded(|| {
            let group = file.get_row_group(group)?;
            let rows = count(group.as_ref());
            let mut values: Vec<i64> = Vec::new();
            match group.get_column_reader(0)? {
                ColumnReader::Int64ColumnReader(mut r) => r.read_records(rows, None, None, &mut values)?,
                _ => return Err(ParquetError::General("column draw is not of whole numbers".to_owned())),
            };
            Ok(values)
        })?;
        values.into_iter().for_each(|d| see(d.cast_unsigned()));
    }
    Ok(())
}

fn count(group: &dyn RowGroupReader) -> usize {
    usize::try_from(group.metadata().num_rows()).unwrap_or(0)
}

/// Cells of the column at this place of the file.
pub(crate) fn column<R: ChunkReader + 'static>(
    file: &SerializedFileReader<R>,
    place: usize,
    kind: CellKind,
) -> Result<Vec<Cell>> {
    let mut all = Vec::new();
    each_cell(file, place, kind, &mut |cell| all.push(cell))?;
    Ok(all)
}

/// Shows every cell of the column at this place of the file, one group of rows in memory at a time.
pub(crate) fn each_cell<R: ChunkReader + 'static>(
    file: &SerializedFileReader<R>,
    place: usize,
    kind: CellKind,
    see: &mut dyn FnMut(Cell),
) -> Result<()> {
    for group in 0..file.num_row_groups() {
        guarded(|| cells(file.get_row_group(group)?.as_ref(), place, kind))?.into_iter().for_each(&mut *see);
    }
    Ok(())
}

fn cells(group: &dyn RowGroupReader, place: usize, kind: CellKind) -> Result<Vec<Cell>> {
    let rows = count(group);
    let mut levels = Vec::new();
    match (group.get_column_reader(place)?, kind) {
        (ColumnReader::DoubleColumnReader(mut r), CellKind::Number) => {
            let mut values: Vec<f64> = Vec::new();
            r.read_records(rows, Some(&mut levels), None, &mut values)?;
            Ok(join(values, &levels).map(Cell::Number).collect())
        }
        (ColumnReader::BoolColumnReader(mut r), CellKind::Flag) => {
            let mut values: Vec<bool> = Vec::new();
            r.read_records(rows, Some(&mut levels), None, &mut values)?;
            Ok(join(values, &levels).map(Cell::Flag).collect())
        }
        (ColumnReader::ByteArrayColumnReader(mut r), CellKind::Word) => {
            let mut values: Vec<ByteArray> = Vec::new();
            r.read_records(rows, None, None, &mut values)?;
            values.iter().map(|v| Ok(Cell::Word(v.as_utf8()?.to_owned()))).collect()
        }
        _ => Err(ParquetError::General(format!("column {place} is not of the kind that the study has"))),
    }
}

fn join<T>(values: Vec<T>, levels: &[i16]) -> impl Iterator<Item = Option<T>> {
    let mut values = values.into_iter();
    levels.iter().map(move |l| if *l > 0 { values.next() } else { None })
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn table() -> (Vec<Column>, Vec<Row>) {
        let column = |name: &str, kind| Column { name: name.to_owned(), kind };
        let columns = vec![column("failure", CellKind::Word), column("a.b.c", CellKind::Number), column("seen", CellKind::Flag)];
        let odd = [0.1 + 0.2, -0.0, f64::MIN_POSITIVE / 4.0, f64::MAX];
        let cells = |i: usize| {
            vec![
                Cell::Word(if i.is_multiple_of(2) { String::new() } else { format!("simulate: “{i}”\nnext") }),
                Cell::Number(odd.get(i).copied()),
                Cell::Flag((i != 2).then_some(i == 1)),
            ]
        };
        (columns, (0..6).map(|i| Row { draw: 7 + i as u64, cells: cells(i) }).collect())
    }

    #[test]
    fn law_rows_come_back_bit_for_bit_and_give_the_same_bytes() {
        let (columns, rows) = table();
        let bytes = encode(&columns, &rows).expect("rows fit their columns");
        let back = decode(&columns, bytes.clone()).expect("own file");
        assert_eq!(back, rows);
        let bits = |r: &Row| r.cells[1].number().map(f64::to_bits);
        assert!(back.iter().zip(&rows).all(|(a, b)| bits(a) == bits(b)), "the sign of zero too");
        assert_eq!(bytes, encode(&columns, &back).expect("same rows"));
        assert!(decode(&columns[..2], bytes).is_err(), "other columns");
    }
}
