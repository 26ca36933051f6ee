//! Feather with a column for each channel and a row for each sample, in batches of rows. It is the file format of Arrow, plain or compressed by LZ4
//! or Zstandard.

mod batch;
#[cfg(test)]
mod tests;
mod values;

use super::arrow::{ColumnStorage, Field};
use super::column::Column;
use super::flat_buffer::Buffer;
use super::reader::{BLOCK, Block, Bytes, Pick, RecordReader, Sink, Times};
use super::tile::Tile;
use super::typed_columns::{Meaning, Precision, TimeColumn, TypedChannels};
use crate::series::error::SeriesError;
use batch::{Batch, MAGIC, parts, read_error};
use std::borrow::Cow;
use std::ops::{ControlFlow, Range};
use values::{Values, is_valid};

/// Rows of a batch without compression that are a piece.
const PIECE: usize = 262_144;

/// A Feather file as a record.
///
/// # Reference
/// Apache Arrow, Columnar format 1.5: IPC file format; File.fbs, Message.fbs, Schema.fbs.
pub struct Feather {
    bytes: Bytes,
    columns: Vec<Column>,
    /// Field of the file and the worth of one stored unit, a column each.
    leaves: Vec<(usize, f64)>,
    fields: Vec<Field>,
    batches: Vec<Batch>,
    /// Batches of dictionaries, each with the identifier of its dictionary.
    dictionaries: Vec<(usize, Batch)>,
    pieces: Vec<(usize, Range<usize>)>,
    time: Option<(usize, f64)>,
    times: Times,
    /// Time that is taken off stored times, s.
    epoch: f64,
}

impl Feather {
    /// Returns the table in a file. Only columns of numbers are channels. A null is NaN. [`TypedChannels::from_columns`] determines the column of
    /// time.
    ///
    /// # Errors
    /// A file that is cut off or damaged.
    pub fn new(bytes: Bytes) -> Result<Self, SeriesError> {
        let file: &[u8] = (*bytes).as_ref();
        if !file.ends_with(MAGIC) {
            return Err(read_error("it is cut off"));
        }
        let (fields, batches, dictionaries) =
            parts(file).ok_or_else(|| read_error("its list of columns or batches is damaged"))?;
        let numbers = fields.iter().enumerate();
        let typed = TypedChannels::from_columns(
            numbers.filter_map(|(at, f)| Some((at, &*f.name, f.meaning()?, &*f.unit))),
        );
        let (leaves, columns) = typed.channels.into_iter().unzip();
        let pieces = batches.iter().enumerate().flat_map(|(b, batch)| {
            // A compressed batch is decompressed as a whole.
            let step = if batch.codec.is_some() {
                usize::MAX
            } else {
                PIECE
            };
            let starts = (0..batch.rows).step_by(step);
            starts.map(move |from| (b, from..batch.rows.min(from.saturating_add(step))))
        });
        let mut read = Self {
            columns,
            leaves,
            pieces: pieces.collect(),
            times: Times::None {
                samples: Some(batches.iter().map(|b| b.rows).sum()),
            },
            fields,
            batches,
            dictionaries,
            time: None,
            epoch: 0.0,
            bytes,
        };
        if let Some(time) = typed.time {
            read.set_time(&time)?;
        }
        Ok(read)
    }

    fn set_time(&mut self, time: &TimeColumn) -> Result<(), SeriesError> {
        let factor = time.factor()?;
        self.time = Some((time.at, factor));
        if time.is_instant() && self.n_pieces() > 0 {
            let mut first = None;
            self.head(0, &[Pick::Time], &mut |block| {
                first = block.values.first().copied();
                ControlFlow::Break(())
            })?;
            self.epoch = first.filter(|t| t.is_finite()).unwrap_or(0.0);
        }
        let stored = self.fields.get(time.at).map(Field::values);
        let precision = match stored {
            Some(ColumnStorage::Integer { .. }) => Precision::Integer,
            Some(ColumnStorage::Real { bytes: 4 }) => Precision::Single,
            _ => Precision::Double,
        };
        self.times = time.times(precision, factor, self.epoch);
        Ok(())
    }

    /// Returns the texts of the column with this name, one for each row, blank for a null. `None` if no column of text has this name.
    ///
    /// # Errors
    /// Buffers that can't be read.
    pub(super) fn texts(&self, name: &str) -> Result<Option<Vec<String>>, SeriesError> {
        let is_it = |f: &Field| {
            let is_text = matches!(
                f.values(),
                ColumnStorage::Text { .. } | ColumnStorage::TextView
            );
            f.name.eq_ignore_ascii_case(name) && is_text
        };
        let Some(at) = self.fields.iter().position(is_it) else {
            return Ok(None);
        };
        let Some(field) = self.fields.get(at) else {
            return Ok(None);
        };
        let mut out = Vec::new();
        let Some((id, stored)) = field.dictionary else {
            for batch in &self.batches {
                self.add_texts(batch, at, field.stored, &mut out)?;
            }
            return Ok(Some(out));
        };
        let mut words = Vec::new();
        for (_, batch) in self.dictionaries.iter().filter(|d| d.0 == id) {
            self.add_texts(batch, 0, stored, &mut words)?;
        }
        for batch in &self.batches {
            let mut numbers = vec![f64::NAN; batch.rows];
            let values = self.values(batch, at, field.stored)?;
            values.write_rows(0, 1.0, 0.0, &mut numbers);
            let word = |n: f64| words.get(n as usize).filter(|_| n >= 0.0).cloned();
            out.extend(numbers.into_iter().map(|n| word(n).unwrap_or_default()));
        }
        Ok(Some(out))
    }

    fn add_texts(
        &self,
        batch: &Batch,
        at: usize,
        stored: ColumnStorage,
        out: &mut Vec<String>,
    ) -> Result<(), SeriesError> {
        let buffers: Vec<Cow<'_, [u8]>> = batch.field_buffers(at, (*self.bytes).as_ref())?;
        let [validity, places, data @ ..] = buffers.as_slice() else {
            return Err(read_error("a column of text has no buffers"));
        };
        let places = Buffer(places);
        let text = |i: usize| {
            let bytes = match stored {
                ColumnStorage::TextView => {
                    let at = i.checked_mul(16)?;
                    let length = places.word(at)? as usize;
                    let (data, from) = match length {
                        0..=12 => (places.0, at + 4),
                        _ => {
                            let data = data.get(places.word(at + 8)? as usize)?;
                            (&**data, places.word(at + 12)? as usize)
                        }
                    };
                    data.get(from..from.checked_add(length)?)?
                }
                ColumnStorage::Text { bytes: 8 } => {
                    let end = places.size(8 * i + 8)?;
                    data.first()?.get(places.size(8 * i)?..end)?
                }
                _ => {
                    let end = places.word(4 * i + 4)? as usize;
                    data.first()?.get(places.word(4 * i)? as usize..end)?
                }
            };
            Some(String::from_utf8_lossy(bytes).into_owned())
        };
        for i in 0..batch.rows {
            let text = match is_valid(validity, i) {
                true => text(i).ok_or_else(|| read_error("a text is outside its column"))?,
                false => String::new(),
            };
            out.push(text);
        }
        Ok(())
    }

    /// Returns the stored values of a field in a batch. Dictionary values are not looked up.
    fn values<'a>(
        &'a self,
        batch: &Batch,
        at: usize,
        stored: ColumnStorage,
    ) -> Result<Values<'a>, SeriesError> {
        let buffers = batch.field_buffers(at, (*self.bytes).as_ref())?;
        let [validity, data]: [Cow<'a, [u8]>; 2] = buffers
            .try_into()
            .map_err(|_| read_error("a column of numbers has too few buffers"))?;
        let needed = match stored {
            ColumnStorage::Bits => Some(batch.rows.div_ceil(8)),
            ColumnStorage::Integer { bytes, .. } | ColumnStorage::Real { bytes } => {
                batch.rows.checked_mul(bytes)
            }
            _ => None,
        };
        let is_whole = needed.is_some_and(|n| data.len() >= n)
            && (validity.is_empty() || validity.len() >= batch.rows.div_ceil(8));
        match is_whole {
            true => Ok(Values {
                stored,
                validity,
                data,
                dictionary: None,
            }),
            false => Err(read_error("a column ends before its batch")),
        }
    }

    /// Returns the numbers of a field in a batch.
    fn numbers(&self, batch: &Batch, at: usize) -> Result<Option<Values<'_>>, SeriesError> {
        let Some(field) = self.fields.get(at) else {
            return Ok(None);
        };
        let mut values = self.values(batch, at, field.stored)?;
        if let Some((id, stored)) = field.dictionary {
            let mut all = Vec::new();
            for (_, batch) in self.dictionaries.iter().filter(|d| d.0 == id) {
                let entries = self.values(batch, 0, stored)?;
                let first = all.len();
                all.resize(first + batch.rows, f64::NAN);
                entries.write_rows(0, 1.0, 0.0, all.get_mut(first..).unwrap_or_default());
            }
            values.dictionary = Some(all);
        }
        Ok(Some(values))
    }
}

impl RecordReader for Feather {
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
        self.pieces.get(piece).map(|p| p.1.len())
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let Some((batch, rows)) = self.pieces.get(piece) else {
            return Ok(());
        };
        let Some(batch) = self.batches.get(*batch) else {
            return Ok(());
        };
        let mut columns = Vec::new();
        for (j, pick) in picks.iter().enumerate() {
            let stored = match pick {
                Pick::Nothing => None,
                Pick::Column(c) => self.leaves.get(*c).map(|(at, worth)| (*at, *worth, 0.0)),
                Pick::Time => self.time.map(|(at, worth)| (at, worth, self.epoch)),
            };
            let Some((at, worth, off)) = stored else {
                continue;
            };
            if let Some(values) = self.numbers(batch, at)? {
                columns.push((j, values, worth, off));
            }
        }
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK.min(rows.len()) * k];
        let mut tile = Tile::new();
        for from in rows.clone().step_by(BLOCK) {
            let count = BLOCK.min(rows.end - from);
            for (j, column, worth, off) in &columns {
                let place = tile.column(*j, count, &mut values, k);
                column.write_rows(from, *worth, *off, place);
            }
            tile.lay_out(&mut values, k);
            let block = Block {
                first: from - rows.start,
                rows: count,
                values: values.get(..count * k).unwrap_or_default(),
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}

impl Field {
    /// Storage of the column's values, or of its dictionary's values.
    fn values(&self) -> ColumnStorage {
        self.dictionary.map_or(self.stored, |d| d.1)
    }

    /// Meaning of its values; `None` for a column that is no channel.
    fn meaning(&self) -> Option<Meaning> {
        match self.values() {
            ColumnStorage::Integer { meaning, .. } => Some(meaning),
            ColumnStorage::Bits | ColumnStorage::Real { .. } => Some(Meaning::Number(1.0)),
            ColumnStorage::Text { .. } | ColumnStorage::TextView | ColumnStorage::Other => None,
        }
    }
}
