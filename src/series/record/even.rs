//! A record on even steps: stored samples, NaN in gaps, interpolated samples where the stored ones are uneven.

use super::clock::{Clock, Evenness, Steps, clock_of, counts};
use super::column::Column;
use super::reader::{BLOCK, Block, OtherChannel, Pick, RecordReader, Sink, Times};
use super::time_conversion::with_times_in_seconds;
use crate::series::error::SeriesError;
use std::ops::ControlFlow;

/// A checked record.
pub struct Record {
    reader: Box<dyn RecordReader>,
    /// Clock of the record.
    pub clock: Clock,
    steps: Option<Steps>,
    /// First sample of each piece on even steps, and the number of samples.
    starts: Vec<usize>,
}

/// How much of a piece is decoded.
#[derive(Clone, Copy)]
enum Extent {
    Whole,
    /// A block of stored rows, which give a block of samples or more where the stored ones are taken.
    Head,
}

impl Record {
    /// Returns the record of a reader after a pass over its times. The job may declare its rate, Hz, and the seconds in one unit of its times. The
    /// declared unit applies if the file states no unit of time.
    ///
    /// # Errors
    /// No samples, no rate or a rate other than the declared one. Times that are missing or do not ascend, or a hole longer than the record.
    pub fn new(
        reader: Box<dyn RecordReader>,
        declared_hz: Option<f64>,
        time_unit_s: Option<f64>,
    ) -> Result<Self, SeriesError> {
        let (reader, unit) = with_times_in_seconds(reader, time_unit_s)?;
        let (mut clock, steps) = clock_of(&*reader, declared_hz)?;
        clock.unit = unit;
        let starts = match &steps {
            Some(steps) => starts_of_times(&clock, steps),
            None => {
                let mut starts = vec![0];
                let mut sum = 0;
                for n in counts(&*reader)? {
                    sum += n;
                    starts.push(sum);
                }
                starts
            }
        };
        Ok(Self {
            reader,
            clock,
            steps,
            starts,
        })
    }

    /// Returns whether the file or its format states the unit of its times.
    pub fn is_time_unit_stated(&self) -> bool {
        match self.reader.times() {
            Times::Stored {
                unit_stated,
                epoch_s,
                ..
            } => unit_stated || epoch_s.is_some(),
            Times::Even { unit_stated, .. } => unit_stated,
            Times::None { .. } => true,
        }
    }

    /// Returns the last line of the file if it may be cut and is therefore left out.
    pub fn left_out(&self) -> Option<usize> {
        self.reader.left_out()
    }

    /// Returns the columns, in file order.
    pub fn columns(&self) -> &[Column] {
        self.reader.columns()
    }

    /// Returns the name of the group of a column. It is empty if the format or the file has no groups.
    pub fn group(&self, column: usize) -> &str {
        self.reader.group(column)
    }

    /// Returns the channels of the file that are not among the columns, in file order.
    pub fn other_channels(&self) -> &[OtherChannel] {
        self.reader.other_channels()
    }

    /// Returns the number of pieces in which the record is read.
    pub fn n_pieces(&self) -> usize {
        self.reader.n_pieces()
    }

    /// Returns the samples of a piece: its first sample, and the first sample of the next piece.
    pub fn span(&self, piece: usize) -> (usize, usize) {
        let at = |i: usize| self.starts.get(i).copied().unwrap_or(self.clock.samples);
        (at(piece), at(piece + 1))
    }

    /// Returns the line in the file of a stored row, counted from 0.
    pub fn line_of_row(&self, row: usize) -> usize {
        let mut before = 0;
        let spans = self.steps.iter().flat_map(|s| &s.spans);
        for (piece, s) in spans.enumerate() {
            if row < before + s.rows {
                return self.reader.line(piece, row - before, row);
            }
            before += s.rows;
        }
        row + 1
    }

    /// Decodes a piece into blocks of consecutive samples. [`Block::first`] counts from the beginning of the record. A block contains a stored number
    /// for each of `columns` (`None` gives NaN).
    ///
    /// # Errors
    /// Data that can't be decoded, with its place.
    pub fn read(
        &self,
        piece: usize,
        columns: &[Option<usize>],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        self.take(Extent::Whole, piece, columns, sink)
    }

    /// Decodes only the first block of a piece, in the form of [`Record::read`].
    ///
    /// # Errors
    /// Errors of [`Record::read`].
    pub fn head(
        &self,
        piece: usize,
        columns: &[Option<usize>],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        self.take(Extent::Head, piece, columns, &mut |block| {
            let _ = sink(block);
            ControlFlow::Break(())
        })
    }

    fn take(
        &self,
        extent: Extent,
        piece: usize,
        columns: &[Option<usize>],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        let mut picks: Vec<Pick> = columns
            .iter()
            .map(|c| c.map_or(Pick::Nothing, Pick::Column))
            .collect();
        let start = self.span(piece).0;
        let resampled = matches!(self.clock.evenness, Evenness::Resampled { .. });
        match &self.steps {
            Some(steps) if resampled || self.clock.n_gaps > 0 => {
                picks.push(Pick::Time);
                if resampled {
                    self.read_uneven(steps, piece, &picks, sink)
                } else {
                    self.read_gaps(steps, extent, piece, &picks, sink)
                }
            }
            _ => self.read_stored(extent, piece, &picks, &mut |block| {
                sink(Block {
                    first: start + block.first,
                    ..block
                })
            }),
        }
    }

    /// Stored rows of a piece.
    fn read_stored(
        &self,
        extent: Extent,
        piece: usize,
        picks: &[Pick],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        match extent {
            Extent::Whole => self.reader.read(piece, picks, sink),
            Extent::Head => self.reader.head(piece, picks, sink),
        }
    }

    /// Stored samples with NaN in between where some are missing; the last pick is the time.
    fn read_gaps(
        &self,
        steps: &Steps,
        extent: Extent,
        piece: usize,
        picks: &[Pick],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        let k = picks.len() - 1;
        let mut out = Rows::new(self.span(piece).0, k);
        let before = steps.spans.get(..piece).unwrap_or_default();
        let mut last = before
            .iter()
            .rev()
            .find(|s| s.rows > 0)
            .map_or(f64::NAN, |s| s.last);
        self.read_stored(extent, piece, picks, &mut |block| {
            for row in block.values.chunks_exact(k + 1) {
                let Some((&t, values)) = row.split_last() else {
                    continue;
                };
                for _ in 0..steps.missing_between(last, t) {
                    out.push(std::iter::repeat_n(f64::NAN, k), sink)?;
                }
                out.push(values.iter().copied(), sink)?;
                last = t;
            }
            ControlFlow::Continue(())
        })?;
        let _ = out.finish(sink);
        Ok(())
    }

    /// Samples on even steps by straight lines between stored ones, NaN in gaps; the last pick is the time.
    fn read_uneven(
        &self,
        steps: &Steps,
        piece: usize,
        picks: &[Pick],
        sink: &mut Sink,
    ) -> Result<(), SeriesError> {
        let k = picks.len() - 1;
        let (begin, end) = self.span(piece);
        let mut out = Rows::new(begin, k);
        let mut next = begin;
        let mut before: Option<Vec<f64>> = None;
        let mut between = |row: &[f64]| -> ControlFlow<()> {
            let (Some(a), Some(&tb)) = (&before, row.last()) else {
                before = Some(row.to_vec());
                return ControlFlow::Continue(());
            };
            let ta = a.last().copied().unwrap_or(tb);
            let gap = steps.missing_between(ta, tb) > 0;
            while next < end {
                let t = self.clock.time_s(next);
                let share = ((t - ta) / (tb - ta)).max(0.0);
                // The last row may be a rounding error before the time of the last sample.
                if share > 1.0 + 1e-6 {
                    break;
                }
                let keep = !(1e-6..=1.0 - 1e-6).contains(&share);
                let line = a.iter().zip(row).take(k).map(|(a, b)| {
                    if keep {
                        if share < 0.5 { *a } else { *b }
                    } else if gap {
                        f64::NAN
                    } else {
                        a + (b - a) * share
                    }
                });
                out.push(line, sink)?;
                next += 1;
            }
            before = Some(row.to_vec());
            ControlFlow::Continue(())
        };
        let mut stopped = false;
        self.reader.read(piece, picks, &mut |block| {
            for row in block.values.chunks_exact(k + 1) {
                if between(row).is_break() {
                    stopped = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        })?;
        // Continue up to the first row of the next piece that has rows.
        let following =
            (piece + 1..self.n_pieces()).find(|p| steps.spans.get(*p).is_some_and(|s| s.rows > 0));
        if let Some(p) = following.filter(|_| !stopped) {
            self.reader.head(p, picks, &mut |block| {
                if let Some(row) = block.values.get(..k + 1) {
                    let _ = between(row);
                }
                ControlFlow::Break(())
            })?;
        }
        if !stopped {
            let _ = out.finish(sink);
        }
        Ok(())
    }
}

/// Rows on their way to a sink.
struct Rows {
    first: usize,
    k: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Rows {
    fn new(first: usize, k: usize) -> Self {
        Self {
            first,
            k,
            rows: 0,
            values: Vec::with_capacity(BLOCK * k),
        }
    }

    fn push(&mut self, row: impl Iterator<Item = f64>, sink: &mut Sink) -> ControlFlow<()> {
        self.values.extend(row);
        self.rows += 1;
        if self.rows == BLOCK {
            self.finish(sink)
        } else {
            ControlFlow::Continue(())
        }
    }

    fn finish(&mut self, sink: &mut Sink) -> ControlFlow<()> {
        if self.rows == 0 {
            return ControlFlow::Continue(());
        }
        debug_assert_eq!(self.values.len(), self.rows * self.k);
        let block = Block {
            first: self.first,
            rows: self.rows,
            values: &self.values,
        };
        let flow = sink(block);
        self.first += self.rows;
        self.rows = 0;
        self.values.clear();
        flow
    }
}

/// First sample of each piece, and the number of samples.
fn starts_of_times(clock: &Clock, steps: &Steps) -> Vec<usize> {
    let mut starts = Vec::with_capacity(steps.spans.len() + 1);
    if let Evenness::Resampled { .. } = clock.evenness {
        // A piece contains the steps from its first time to the first time of the next piece.
        for (i, s) in steps.spans.iter().enumerate() {
            let at = if i == 0 || s.rows == 0 {
                starts.last().copied().unwrap_or(0)
            } else {
                (((s.first - clock.start_s) * clock.rate_hz - 1e-6).ceil() as usize)
                    .min(clock.samples)
            };
            starts.push(at);
        }
        // A piece without rows begins where the next piece begins.
        let mut next = clock.samples;
        for (start, s) in starts.iter_mut().zip(&steps.spans).rev() {
            if s.rows == 0 {
                *start = next;
            }
            next = *start;
        }
    } else {
        let (mut sum, mut last) = (0, f64::NAN);
        for s in &steps.spans {
            starts.push(sum);
            if s.rows > 0 {
                sum += steps.missing_between(last, s.first) + s.rows + s.missing as usize;
                last = s.last;
            }
        }
    }
    starts.push(clock.samples);
    starts
}
