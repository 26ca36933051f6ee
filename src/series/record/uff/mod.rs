//! Universal file, data sets 58 and 58b: time histories, a data set a channel.

mod dataset;
mod fault;
#[cfg(test)]
mod tests;

use super::column::Column;
use super::reader::{BLOCK, Block, Bytes, OtherChannel, Pick, RecordReader, Sink, Times};
use super::simultaneous_channels::{Sampling, sampled_together};
use crate::series::error::SeriesError;
use dataset::{Dataset, Samples, datasets};
use fault::read_error;

/// Samples a piece.
const PIECE: usize = 65_536;

/// Returns whether the bytes begin as a universal file: a line with -1 alone, then the number of a data set.
pub(super) fn is_uff(bytes: &[u8]) -> bool {
    let mut lines = bytes
        .get(..200.min(bytes.len()))
        .unwrap_or_default()
        .split(|b| *b == b'\n');
    let first = lines.find(|l| !l.trim_ascii().is_empty());
    let second = lines.next().map(<[u8]>::trim_ascii);
    first.is_some_and(|l| l.trim_ascii() == b"-1" && l.starts_with(b"    "))
        && second.is_some_and(|l| l.first().is_some_and(u8::is_ascii_digit))
}

/// A universal file as a record.
pub(super) struct Uff {
    bytes: Bytes,
    columns: Vec<Column>,
    sets: Vec<Dataset>,
    times: (f64, f64, usize),
    unit_stated: bool,
    others: Vec<OtherChannel>,
}

impl Uff {
    /// Reads the time histories of one clock: the clock of `wanted`, or the clock of most histories if `wanted` is empty.
    ///
    /// # Errors
    /// A file that can't be read or holds no time histories, wanted channels of another clock.
    pub(super) fn new(bytes: Bytes, wanted: &[String]) -> Result<Self, SeriesError> {
        let all = datasets((*bytes).as_ref())?;
        let named_twice = |w: &&String| all.iter().filter(|d| d.twice.as_ref() == Some(*w)).count();
        if let Some(name) = wanted.iter().find(|w| named_twice(w) > 0) {
            return Err(read_error(format!(
                "the file contains `{name}` {} times, and the intended data set is ambiguous",
                named_twice(&name)
            )));
        }
        let sampling = |d: &Dataset| Sampling {
            start_s: d.start_s,
            step_s: d.step_s,
            samples: d.samples,
            times: None,
            unit_stated: d.unit_stated,
        };
        let channels = all.iter().map(|d| (d.column.name.as_str(), sampling(d)));
        let found = sampled_together(&channels.collect::<Vec<_>>(), wanted)?;
        let Some((main, together)) = found else {
            return Err(match all.is_empty() {
                true => read_error("it contains no time histories"),
                false => SeriesError::Empty,
            });
        };
        let times = (main.start_s, main.step_s, main.samples);
        let unit_stated = main.unit_stated;
        let (mut sets, mut others) = (Vec::new(), Vec::new());
        for (set, together) in all.into_iter().zip(together) {
            match together {
                true => sets.push(set),
                false => others.push(OtherChannel {
                    group: String::new(),
                    name: set.column.name,
                    unit: set.column.unit,
                    samples: set.samples,
                    rate_hz: Some(1.0 / set.step_s),
                }),
            }
        }
        Ok(Self {
            bytes,
            columns: sets.iter().map(|d| d.column.clone()).collect(),
            sets,
            times,
            unit_stated,
            others,
        })
    }
}

impl RecordReader for Uff {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn other_channels(&self) -> &[OtherChannel] {
        &self.others
    }

    fn times(&self) -> Times {
        let (start_s, step_s, samples) = self.times;
        Times::Even {
            start_s,
            step_s,
            samples,
            unit_stated: self.unit_stated,
        }
    }

    fn n_pieces(&self) -> usize {
        self.times.2.div_ceil(PIECE)
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        Some(self.times.2.saturating_sub(piece * PIECE).min(PIECE))
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let begin = piece * PIECE;
        let end = (begin + PIECE).min(self.times.2);
        let file: &[u8] = (*self.bytes).as_ref();
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK * k];
        for from in (begin..end).step_by(BLOCK) {
            let to = (from + BLOCK).min(end);
            for (j, pick) in picks.iter().enumerate() {
                let slots = values.iter_mut().skip(j).step_by(k.max(1));
                let set = match pick {
                    Pick::Column(c) => self.sets.get(*c),
                    _ => None,
                };
                for (slot, i) in slots.zip(from..to) {
                    *slot = match (pick, set.map(|s| &s.data)) {
                        (Pick::Time, _) => self.times.0 + self.times.1 * i as f64,
                        (_, Some(Samples::Text(v))) => v.get(i).copied().unwrap_or(f64::NAN),
                        (_, Some(Samples::Binary(b))) => b.value(file, i),
                        (_, None) => f64::NAN,
                    };
                }
            }
            let block = Block {
                first: from - begin,
                rows: to - from,
                values: values.get(..(to - from) * k).unwrap_or_default(),
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}
