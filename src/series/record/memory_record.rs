//! A record in memory as a reader: what small files and formats without parts become.

use super::column::Column;
use super::reader::{BLOCK, Block, OtherChannel, Pick, RecordReader, Sink, Times};
use crate::series::error::SeriesError;

/// Samples a piece.
const PIECE: usize = 65_536;

/// Columns in memory.
pub struct MemoryRecord {
    /// Names and units.
    pub columns: Vec<Column>,
    /// Samples of each channel. All channels have one length.
    pub samples: Vec<Vec<f64>>,
    /// Time of each sample, s, if [`MemoryRecord::times`] states that times are stored. Otherwise empty.
    pub stored: Vec<f64>,
    /// Source of the times.
    pub times: Times,
    /// Channels of the file that are not among the columns.
    pub others: Vec<OtherChannel>,
}

impl MemoryRecord {
    fn n_rows(&self) -> usize {
        self.samples
            .iter()
            .map(Vec::len)
            .chain(Some(self.stored.len()))
            .max()
            .unwrap_or(0)
    }

    fn value(&self, pick: Pick, row: usize) -> f64 {
        let stored = match (pick, self.times) {
            (
                Pick::Time,
                Times::Even {
                    start_s, step_s, ..
                },
            ) => Some(start_s + step_s * row as f64),
            (Pick::Time, _) => self.stored.get(row).copied(),
            (Pick::Column(c), _) => self.samples.get(c).and_then(|s| s.get(row)).copied(),
            (Pick::Nothing, _) => None,
        };
        stored.unwrap_or(f64::NAN)
    }
}

impl RecordReader for MemoryRecord {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn other_channels(&self) -> &[OtherChannel] {
        &self.others
    }

    fn times(&self) -> Times {
        self.times
    }

    fn n_pieces(&self) -> usize {
        self.n_rows().div_ceil(PIECE)
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        Some(self.n_rows().saturating_sub(piece * PIECE).min(PIECE))
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let begin = piece * PIECE;
        let end = (begin + PIECE).min(self.n_rows());
        let mut values = Vec::with_capacity(BLOCK * picks.len());
        for from in (begin..end).step_by(BLOCK) {
            let to = (from + BLOCK).min(end);
            values.clear();
            values
                .extend((from..to).flat_map(|row| picks.iter().map(move |p| self.value(*p, row))));
            let block = Block {
                first: from - begin,
                rows: to - from,
                values: &values,
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}
