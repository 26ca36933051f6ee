//! Parquet with a column for each channel and a row for each sample. It is read by parts of row groups, column by column, page by page.

use super::arrow::notes;
use super::column::{Column, is_time};
use super::pages::Pages;
use super::parquet_bytes::ParquetBytes;
use super::reader::{BLOCK, Block, Pick, RecordReader, Sink, Times};
use super::rows::{SharedRows, Strips};
use super::source::Source;
use super::strip::{Strip, read_error, texts};
use super::tile::Tile;
use super::typed_columns::{Meaning, Precision, TimeColumn, TypedChannels};
use crate::series::error::SeriesError;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as Kind};
use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Rows of a row group that are a piece: few enough that a file of one group is read by several threads.
const PIECE: usize = 262_144;
/// Pieces that decode their rows together: the page on their border is decoded once.
const TOGETHER: usize = 2;

/// A Parquet file as a record.
pub struct Parquet {
    whole: Arc<ParquetBytes>,
    metadata: ParquetMetaData,
    columns: Vec<Column>,
    /// Leaf in the file and value of one stored unit, for each column.
    leaves: Vec<(usize, f64)>,
    time: Option<(usize, f64)>,
    times: Times,
    /// Time that is subtracted from stored times, s.
    epoch: f64,
    pieces: Vec<Part>,
    /// Units of pieces that are decoded together.
    units: Vec<Unit>,
    /// Decoded rows, and reused memory of earlier rows: to free and allocate it again costs as much as decoding.
    shared: SharedRows,
}

/// Rows of a row group.
#[derive(Clone, Copy)]
struct Part {
    group: usize,
    /// First row of the part in its group.
    from: usize,
    rows: usize,
    /// Unit of the part.
    unit: usize,
}

/// Pieces of a row group that follow each other.
#[derive(Clone, Copy)]
struct Unit {
    group: usize,
    from: usize,
    rows: usize,
    pieces: usize,
}

impl Parquet {
    /// Opens the table in a file. A column of time (`time`, `t`, `timestamp`) gives the times. Without it, the first column of timestamps or
    /// durations gives them, such as the index that pandas writes. Only columns of numbers are read. A null is NaN.
    ///
    /// # Errors
    /// A file that is cut off or damaged.
    pub fn new(source: Source) -> Result<Self, SeriesError> {
        let whole = Arc::new(ParquetBytes::from_source(source));
        let metadata = ParquetMetaDataReader::new()
            .parse_and_finish(&*whole)
            .map_err(read_error)?;
        let schema = metadata.file_metadata().schema_descr();
        let notes = notes(metadata.file_metadata());
        let columns = schema.columns().iter().enumerate();
        // A nested leaf is named by the last part of its path. Groups other than the root are not tables of channels.
        let typed = TypedChannels::from_columns(columns.filter_map(|(leaf, c)| {
            let meaning = column_meaning(c).filter(|_| c.max_rep_level() == 0)?;
            let is_outermost = c.path().parts().len() == 1;
            let meaning = match notes.durations.get(c.name()) {
                Some(worth) if is_outermost => Meaning::Duration(*worth),
                _ => meaning,
            };
            let unit = notes.units.get(c.name()).filter(|_| is_outermost);
            Some((leaf, c.name(), meaning, unit.map_or("", String::as_str)))
        }));
        let (leaves, columns) = typed.channels.into_iter().unzip();
        let (mut pieces, mut units): (Vec<Part>, Vec<Unit>) = (Vec::new(), Vec::new());
        for (g, group) in metadata.row_groups().iter().enumerate() {
            let rows = usize::try_from(group.num_rows()).unwrap_or(0);
            let parts = rows.div_ceil(PIECE).max(1);
            let each = rows.div_ceil(parts).max(1);
            for from in (0..rows).step_by(each) {
                let n = each.min(rows - from);
                match units
                    .last_mut()
                    .filter(|u| u.group == g && u.pieces < TOGETHER)
                {
                    Some(unit) => {
                        unit.rows += n;
                        unit.pieces += 1;
                    }
                    None => units.push(Unit {
                        group: g,
                        from,
                        rows: n,
                        pieces: 1,
                    }),
                }
                pieces.push(Part {
                    group: g,
                    from,
                    rows: n,
                    unit: units.len() - 1,
                });
            }
        }
        let rows = pieces.iter().map(|p| p.rows).sum();
        let mut file = Self {
            whole,
            metadata,
            columns,
            leaves,
            time: None,
            times: Times::None {
                samples: Some(rows),
            },
            epoch: 0.0,
            pieces,
            units,
            shared: SharedRows::default(),
        };
        if let Some(time) = typed.time {
            file.set_time(&time)?;
        }
        Ok(file)
    }

    fn set_time(&mut self, time: &TimeColumn) -> Result<(), SeriesError> {
        let schema = self.metadata.file_metadata().schema_descr();
        let kind = schema.column(time.at).physical_type();
        let factor = time.factor()?;
        self.time = Some((time.at, factor));
        if time.is_instant() {
            let mut first = None;
            for piece in 0..self.pieces.len() {
                self.head(piece, &[Pick::Time], &mut |block| {
                    first = block.values.first().copied();
                    ControlFlow::Break(())
                })?;
                if first.is_some() {
                    break;
                }
            }
            self.epoch = first.filter(|t| t.is_finite()).unwrap_or(0.0);
        }
        let precision = match kind {
            Kind::INT32 | Kind::INT64 => Precision::Integer,
            Kind::FLOAT => Precision::Single,
            _ => Precision::Double,
        };
        self.times = time.times(precision, factor, self.epoch);
        Ok(())
    }

    /// Returns the texts of the column with this name, one for each row, blank for a null. `None` if no column of text has this name.
    ///
    /// # Errors
    /// Pages that can't be decoded, or too few of them.
    pub(super) fn texts(&self, name: &str) -> Result<Option<Vec<String>>, SeriesError> {
        let schema = self.metadata.file_metadata().schema_descr();
        let is_it = |c: &ColumnDescPtr| {
            c.name().eq_ignore_ascii_case(name)
                && c.max_rep_level() == 0
                && c.physical_type() == Kind::BYTE_ARRAY
        };
        let Some(leaf) = schema.columns().iter().position(is_it) else {
            return Ok(None);
        };
        let most = self.descriptor(leaf).max_def_level();
        let mut out = Vec::new();
        for (g, group) in self.metadata.row_groups().iter().enumerate() {
            let end = out.len() + usize::try_from(group.num_rows()).unwrap_or(0);
            if let ColumnReader::ByteArrayColumnReader(mut reader) = self.column(g, leaf, 0)? {
                texts(&mut reader, most, end, &mut out)?;
            }
            if out.len() != end {
                let wrong = "a column ends before its row group";
                return Err(read_error(ParquetError::EOF(wrong.into())));
            }
        }
        Ok(Some(out))
    }

    /// A reader of one column of a row group, its first `from` rows passed over.
    fn column(&self, group: usize, leaf: usize, from: usize) -> Result<ColumnReader, SeriesError> {
        let cut = || read_error(ParquetError::General("a column is outside the file".into()));
        let group = self.metadata.row_groups().get(group).ok_or_else(cut)?;
        let chunk = group.columns().get(leaf).ok_or_else(cut)?;
        let places = [
            chunk.dictionary_page_offset(),
            Some(chunk.data_page_offset()),
            Some(chunk.compressed_size()),
        ];
        if places.into_iter().flatten().any(|n| n < 0) {
            return Err(cut());
        }
        let rows = usize::try_from(group.num_rows()).map_err(|_| cut())?;
        let pages =
            SerializedPageReader::new(self.whole.clone(), chunk, rows, None).map_err(read_error)?;
        let descriptor = self.descriptor(leaf);
        let pages = Pages::new(pages, &descriptor);
        let mut reader = get_column_reader(descriptor, Box::new(pages));
        if from > 0 {
            skip(&mut reader, from)?;
        }
        Ok(reader)
    }
}

impl RecordReader for Parquet {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn times(&self) -> Times {
        self.times
    }

    fn n_pieces(&self) -> usize {
        self.pieces.len()
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        self.pieces.get(piece).map(|p| p.rows)
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let Some(&part) = self.pieces.get(piece) else {
            return Ok(());
        };
        let Some(&unit) = self.units.get(part.unit).filter(|u| u.pieces > 1) else {
            return self.read_alone(part, picks, sink);
        };
        let most = rayon::current_num_threads();
        let rows = self.shared.rows(part.unit, unit.pieces, picks, most);
        let decoded = rows.decode_columns(&mut |j, strip| {
            let Some(pick) = picks.get(j) else {
                return true;
            };
            let done = self.decode(*pick, (unit.group, unit.from, unit.rows), strip);
            done.is_ok()
        });
        // If the rows of the other piece are damaged, the rows of this piece may still be readable.
        let Some(strips) = decoded else {
            return self.read_alone(part, picks, sink);
        };
        self.lay_out(&strips, part.from - unit.from, part.rows, picks, sink);
        self.shared.done_with(&rows, strips);
        Ok(())
    }

    fn head(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        match self.pieces.get(piece) {
            Some(part) => {
                let rows = part.rows.min(BLOCK);
                self.read_alone(Part { rows, ..*part }, picks, sink)
            }
            None => Ok(()),
        }
    }
}

impl Parquet {
    /// Decodes the rows of one part separately from other pieces.
    fn read_alone(&self, part: Part, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let mut strips = self.shared.spare();
        strips.resize_with(picks.len(), Strip::default);
        for (pick, strip) in picks.iter().zip(&mut strips) {
            self.decode(*pick, (part.group, part.from, part.rows), strip)?;
        }
        self.lay_out(&strips, 0, part.rows, picks, sink);
        self.shared.take_back(strips);
        Ok(())
    }

    /// Returns the leaf of a pick, the value of a stored unit, and the subtracted offset. The result is `None` if there is nothing to decode.
    fn leaf_of_pick(&self, pick: Pick) -> Option<(usize, f64, f64)> {
        match pick {
            Pick::Nothing => None,
            Pick::Column(c) => self.leaves.get(c).map(|(leaf, worth)| (*leaf, *worth, 0.0)),
            Pick::Time => self.time.map(|(leaf, worth)| (leaf, worth, self.epoch)),
        }
    }

    /// Decodes rows of a pick, a page at a time. The tuple contains the row group, the first row in it, and the number of rows.
    fn decode(
        &self,
        pick: Pick,
        (group, from, rows): (usize, usize, usize),
        strip: &mut Strip,
    ) -> Result<(), SeriesError> {
        let Some((leaf, ..)) = self.leaf_of_pick(pick) else {
            return Ok(());
        };
        let mut reader = self.column(group, leaf, from)?;
        let column = self.descriptor(leaf);
        self.shared
            .with_buffers(|b| strip.decode(&mut reader, &column, rows, b))
    }

    /// Hands out decoded rows, `rows` from number `from` on, in blocks.
    fn lay_out(&self, strips: &Strips, from: usize, rows: usize, picks: &[Pick], sink: &mut Sink) {
        let stored = picks.iter().enumerate();
        let stored = stored.filter_map(|(j, pick)| Some((j, self.leaf_of_pick(*pick)?)));
        let columns: Vec<(usize, f64, f64)> = stored.map(|(j, (_, w, off))| (j, w, off)).collect();
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK.min(rows) * k];
        let mut tile = Tile::new();
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            for (j, worth, off) in &columns {
                let place = tile.column(*j, count, &mut values, k);
                if let Some(strip) = strips.get(*j) {
                    strip.write_rows(from + first, *worth, *off, place);
                }
            }
            tile.lay_out(&mut values, k);
            let block = Block {
                first,
                rows: count,
                values: values.get(..count * k).unwrap_or_default(),
            };
            if sink(block).is_break() {
                break;
            }
        }
    }

    /// Checks the types of the wanted columns, and of a time column if the rate is not known otherwise.
    ///
    /// # Errors
    /// A column of a type that is not read.
    pub(super) fn check_types(
        &self,
        wanted: &[String],
        needs_time: bool,
    ) -> Result<(), SeriesError> {
        let schema = self.metadata.file_metadata().schema_descr();
        let needs_time = needs_time && self.time.is_none();
        let is_asked =
            |name: &str| wanted.iter().any(|w| w == name) || needs_time && is_time(name, false);
        let unread = schema
            .columns()
            .iter()
            .find(|c| column_meaning(c).is_none() && is_asked(c.name()));
        match unread {
            Some(c) => Err(SeriesError::Broken {
                wrong: format!("column `{}` contains {}", c.name(), type_words(c)),
                remedy: "write it as numbers (float64), times as timestamps or seconds",
            }),
            None => Ok(()),
        }
    }

    fn descriptor(&self, leaf: usize) -> ColumnDescPtr {
        self.metadata.file_metadata().schema_descr().column(leaf)
    }
}

/// Returns what a column of a type that is not read contains.
fn type_words(c: &ColumnDescriptor) -> String {
    match (c.physical_type(), c.logical_type_ref()) {
        (_, Some(LogicalType::Date)) => "dates without a time of day".to_owned(),
        (_, Some(LogicalType::Decimal(_))) => "decimal numbers as bytes (DECIMAL)".to_owned(),
        (_, Some(LogicalType::String)) => "text".to_owned(),
        (kind, _) => format!("values of the type {kind}, which are not supported as numbers"),
    }
}

/// Returns the meaning of a stored value; `None` if it is not a number.
fn column_meaning(c: &ColumnDescriptor) -> Option<Meaning> {
    let of_unit = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    };
    match (c.physical_type(), c.logical_type_ref()) {
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Timestamp(t))) => {
            Some(Meaning::Instant(of_unit(&t.unit)))
        }
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Time(t))) => {
            Some(Meaning::Instant(of_unit(&t.unit)))
        }
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Decimal(d))) => {
            Some(Meaning::Number(10_f64.powi(-d.scale)))
        }
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Date)) => None,
        (Kind::INT32 | Kind::INT64, _) => Some(match c.converted_type() {
            ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS => Meaning::Instant(1e-3),
            ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS => Meaning::Instant(1e-6),
            _ => Meaning::Number(1.0),
        }),
        (Kind::BOOLEAN | Kind::FLOAT | Kind::DOUBLE, _)
        | (Kind::FIXED_LEN_BYTE_ARRAY, Some(LogicalType::Float16)) => Some(Meaning::Number(1.0)),
        _ => None,
    }
}

fn skip(reader: &mut ColumnReader, rows: usize) -> Result<(), SeriesError> {
    let skipped = match reader {
        ColumnReader::BoolColumnReader(r) => r.skip_records(rows),
        ColumnReader::Int32ColumnReader(r) => r.skip_records(rows),
        ColumnReader::Int64ColumnReader(r) => r.skip_records(rows),
        ColumnReader::FloatColumnReader(r) => r.skip_records(rows),
        ColumnReader::DoubleColumnReader(r) => r.skip_records(rows),
        ColumnReader::FixedLenByteArrayColumnReader(r) => r.skip_records(rows),
        _ => Ok(rows),
    };
    skipped.map(|_| ()).map_err(read_error)
}
