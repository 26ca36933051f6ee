//! Parquet: a column a channel, a row a sample; read by parts of row groups, column by column, a page at a time.

use super::arrow::durations;
use super::column::{Column, is_time, name_and_unit, seconds_in};
use super::pages::Pages;
use super::reader::{BLOCK, Block, Bytes, Pick, RecordReader, Sink, Times};
use super::source::Source;
use super::strip::{Room, Strip, broken};
use super::tile::Tile;
use crate::series::error::SeriesError;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as Kind};
use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Rows of a row group that are a piece: few enough that a file of one group is read by several threads, enough that a page on the
/// border, which both neighbours decode, costs little.
const PIECE: usize = 262_144;

/// A Parquet file as a record.
pub struct Parquet {
    whole: Arc<Whole>,
    metadata: ParquetMetaData,
    columns: Vec<Column>,
    /// Leaf of the file and the worth of one stored unit, a column each.
    leaves: Vec<(usize, f64)>,
    time: Option<(usize, f64)>,
    times: Times,
    /// What is taken off stored times, s.
    epoch: f64,
    /// Row group, first row in it, rows.
    pieces: Vec<(usize, usize, usize)>,
    /// Room of pieces that were decoded before, for the next ones: memory that is given back and taken anew costs as much as decoding.
    room: Mutex<Vec<Room>>,
}

/// What an index column says beside its values: a plain number, or a point in time.
#[derive(Clone, Copy, PartialEq)]
enum Meaning {
    Number(f64),
    Instant(f64),
    /// Time that has passed.
    Duration(f64),
}

impl Parquet {
    /// The table in a file. A column of time (`time`, `t`, `timestamp`) gives the times; else the first column of timestamps or durations, such
    /// as the index that pandas writes. Columns of numbers alone are read; a null is NaN.
    ///
    /// # Errors
    /// A file that is cut off or damaged.
    pub fn new(source: Source) -> Result<Self, SeriesError> {
        let whole = Arc::new(Whole::of(source));
        let metadata = ParquetMetaDataReader::new()
            .parse_and_finish(&*whole)
            .map_err(broken)?;
        let schema = metadata.file_metadata().schema_descr();
        let durations = durations(metadata.file_metadata());
        let mut time: Option<(usize, Meaning, String, bool)> = None;
        let mut found = Vec::new();
        for (leaf, c) in schema.columns().iter().enumerate() {
            let (0, Some(meaning)) = (c.max_rep_level(), meaning(c)) else {
                continue;
            };
            let meaning = match durations.get(c.name()) {
                Some(worth) if c.path().parts().len() == 1 => Meaning::Duration(*worth),
                _ => meaning,
            };
            // The name of a nested leaf is its last word; groups other than the root are no tables of channels.
            let column = name_and_unit(c.name());
            let named = is_time(&column.name, leaf == 0);
            if named && time.as_ref().is_none_or(|t| !t.3) {
                time = Some((leaf, meaning, column.unit.clone(), true));
            } else if !matches!(meaning, Meaning::Number(_)) && time.is_none() {
                time = Some((leaf, meaning, column.unit.clone(), false));
            }
            found.push((leaf, meaning, column));
        }
        let at = time.as_ref().map(|t| t.0);
        let (leaves, columns) = found
            .into_iter()
            // A row number that pandas or others left over is no channel.
            .filter(|(leaf, _, c)| Some(*leaf) != at && !c.name.starts_with("__index_level_"))
            .map(|(leaf, m, c)| (leaf, worth(m), c))
            .map(|(leaf, worth, c)| ((leaf, worth), c))
            .unzip();
        let mut pieces = Vec::new();
        for (g, group) in metadata.row_groups().iter().enumerate() {
            let rows = usize::try_from(group.num_rows()).unwrap_or(0);
            let parts = rows.div_ceil(PIECE).max(1);
            let each = rows.div_ceil(parts).max(1);
            for from in (0..rows).step_by(each) {
                pieces.push((g, from, each.min(rows - from)));
            }
        }
        let rows = pieces.iter().map(|p| p.2).sum();
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
            room: Mutex::default(),
        };
        if let Some((leaf, meaning, unit, _)) = time {
            file.set_time(leaf, meaning, &unit)?;
        }
        Ok(file)
    }

    fn set_time(&mut self, leaf: usize, meaning: Meaning, unit: &str) -> Result<(), SeriesError> {
        let schema = self.metadata.file_metadata().schema_descr();
        let kind = schema.column(leaf).physical_type();
        let factor = match meaning {
            // What type the column has says more than its name.
            Meaning::Instant(worth) | Meaning::Duration(worth) => worth,
            Meaning::Number(worth) => {
                let s = seconds_in(unit).ok_or_else(|| SeriesError::Broken {
                    wrong: format!("`{unit}` is no unit of time"),
                    remedy: "give times in s or ms",
                })?;
                worth * s
            }
        };
        self.time = Some((leaf, factor));
        let instant = matches!(meaning, Meaning::Instant(_));
        let duration = matches!(meaning, Meaning::Duration(_));
        if instant {
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
        let (integers, reals) = (
            matches!(kind, Kind::INT32 | Kind::INT64),
            kind == Kind::FLOAT,
        );
        self.times = Times::Stored {
            // A stored unit is rounded to a half; seconds since 1970 in 64 bits are good to a quarter of a microsecond; a real of 32
            // bits to 2^-24 of itself, of which the end of a day's record is taken.
            rounding_s: match (instant, integers, reals) {
                (true, ..) => 0.5 * factor + 2.5e-7,
                (false, true, _) => 0.5 * factor,
                (false, _, true) => 86_400.0 * 6e-8 * factor,
                _ => 0.0,
            },
            epoch_s: instant.then_some(self.epoch),
            unit_stated: instant || duration || !unit.is_empty(),
        };
        Ok(())
    }

    /// A reader of one column of a row group, its first `from` rows passed over.
    fn column(&self, group: usize, leaf: usize, from: usize) -> Result<ColumnReader, SeriesError> {
        let cut = || {
            broken(ParquetError::General(
                "a column lies outside of the file".into(),
            ))
        };
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
            SerializedPageReader::new(self.whole.clone(), chunk, rows, None).map_err(broken)?;
        let descriptor = self.descriptor(leaf);
        let pages = Pages::of(pages, &descriptor);
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
        self.pieces.get(piece).map(|p| p.2)
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.read_rows(piece, usize::MAX, picks, sink)
    }

    fn head(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.read_rows(piece, BLOCK, picks, sink)
    }
}

impl Parquet {
    /// The first rows of a piece, `most` or all that it has: column by column, so that one page is in memory at a time, then in blocks.
    fn read_rows(
        &self,
        piece: usize,
        most: usize,
        picks: &[Pick],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        let Some(&(group, from, rows)) = self.pieces.get(piece) else {
            return Ok(());
        };
        let rows = rows.min(most);
        let mut room = self.room().pop().unwrap_or_default();
        room.strips.resize_with(picks.len(), Strip::default);
        let mut columns = Vec::new();
        for (j, (pick, strip)) in picks.iter().zip(&mut room.strips).enumerate() {
            let (leaf, worth, off) = match pick {
                Pick::Nothing => continue,
                Pick::Column(c) => match self.leaves.get(*c) {
                    Some((leaf, worth)) => (*leaf, *worth, 0.0),
                    None => continue,
                },
                Pick::Time => match self.time {
                    Some((leaf, worth)) => (leaf, worth, self.epoch),
                    None => continue,
                },
            };
            let mut reader = self.column(group, leaf, from)?;
            strip.decode(&mut reader, &self.descriptor(leaf), rows, &mut room.buffers)?;
            columns.push((j, worth, off));
        }
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK.min(rows) * k];
        let mut tile = Tile::new();
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            for (j, worth, off) in &columns {
                let place = tile.column(*j, count, &mut values, k);
                if let Some(strip) = room.strips.get(*j) {
                    strip.put(first, *worth, *off, place);
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
        self.room().push(room);
        Ok(())
    }

    fn descriptor(&self, leaf: usize) -> ColumnDescPtr {
        self.metadata.file_metadata().schema_descr().column(leaf)
    }

    fn room(&self) -> MutexGuard<'_, Vec<Room>> {
        self.room.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn worth(m: Meaning) -> f64 {
    match m {
        Meaning::Number(w) | Meaning::Instant(w) | Meaning::Duration(w) => w,
    }
}

/// What a stored value is; `None` for what is no number.
fn meaning(c: &ColumnDescriptor) -> Option<Meaning> {
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
        (Kind::BOOLEAN | Kind::FLOAT | Kind::DOUBLE, _) => Some(Meaning::Number(1.0)),
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
        _ => Ok(rows),
    };
    skipped.map(|_| ()).map_err(broken)
}

/// The bytes of the file as this library asks for them: of a file in memory a page is a part of it, not a copy.
struct Whole {
    source: Source,
    shared: bytes::Bytes,
    pages: Arc<Mutex<Vec<Vec<u8>>>>,
}

/// Bytes of a page read from a file. Its memory goes back to the pages that were decoded, for the next ones.
struct Lent {
    memory: Vec<u8>,
    length: usize,
    pages: Arc<Mutex<Vec<Vec<u8>>>>,
}

/// Memory of larger pages is given back to the system.
const LARGE_PAGE: usize = 8 << 20;

impl AsRef<[u8]> for Lent {
    fn as_ref(&self) -> &[u8] {
        self.memory.get(..self.length).unwrap_or_default()
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        if self.memory.len() <= LARGE_PAGE {
            let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
            pages.push(std::mem::take(&mut self.memory));
        }
    }
}

/// Lends the bytes of the file.
struct Owner(Bytes);

impl AsRef<[u8]> for Owner {
    fn as_ref(&self) -> &[u8] {
        (*self.0).as_ref()
    }
}

impl Whole {
    fn of(source: Source) -> Self {
        let shared = match &source {
            Source::Memory(bytes) => bytes::Bytes::from_owner(Owner(bytes.clone())),
            Source::File(_) => bytes::Bytes::new(),
        };
        Self {
            source,
            shared,
            pages: Arc::default(),
        }
    }

    /// Bytes from `start` on, at most so many; all of these where `all`.
    fn taken(&self, start: u64, most: usize, all: bool) -> Result<bytes::Bytes, ParquetError> {
        let left = self
            .source
            .size()
            .checked_sub(start)
            .ok_or_else(|| ParquetError::EOF(format!("byte {start} lies beyond the end")))?;
        let length = most.min(usize::try_from(left).unwrap_or(usize::MAX));
        if all && length < most {
            return Err(ParquetError::EOF("the file ends early".into()));
        }
        match &self.source {
            Source::Memory(_) => {
                let start = start as usize;
                Ok(self.shared.slice(start..start + length))
            }
            Source::File(file) => {
                let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
                let mut memory = pages.pop().unwrap_or_default();
                drop(pages);
                memory.resize(memory.len().max(length), 0);
                let out = memory.get_mut(..length).unwrap_or_default();
                file.read_at(start, out)
                    .map_err(|e| ParquetError::General(e.to_string()))?;
                Ok(bytes::Bytes::from_owner(Lent {
                    memory,
                    length,
                    pages: Arc::clone(&self.pages),
                }))
            }
        }
    }
}

impl Length for Whole {
    fn len(&self) -> u64 {
        self.source.size()
    }
}

/// Reads on from a place: the header of a page.
struct Reading {
    whole: Arc<Whole>,
    at: u64,
    ahead: bytes::Bytes,
}

impl std::io::Read for Reading {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        /// Bytes fetched at a time: a header with its statistics.
        const AHEAD: usize = 512;
        if self.ahead.is_empty() {
            let more = self.whole.taken(self.at, AHEAD.max(out.len()), false);
            self.ahead = more.map_err(std::io::Error::other)?;
            self.at += self.ahead.len() as u64;
        }
        let n = self.ahead.len().min(out.len());
        let taken = self.ahead.split_to(n);
        for (slot, b) in out.iter_mut().zip(&taken) {
            *slot = *b;
        }
        Ok(n)
    }
}

impl ChunkReader for Whole {
    type T = Reading;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        self.taken(start, 0, true)?;
        Ok(Reading {
            whole: Arc::new(Self {
                source: self.source.clone(),
                shared: self.shared.clone(),
                pages: Arc::clone(&self.pages),
            }),
            at: start,
            ahead: bytes::Bytes::new(),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<bytes::Bytes, ParquetError> {
        self.taken(start, length, true)
    }
}
