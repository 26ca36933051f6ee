//! Clock of a record: one pass over its times determines rate, span, gaps, and whether the steps are even.

use super::reader::{Pick, RecordReader, Times};
use super::span::{EVEN, Gap, LISTED, Scale, Span, Stretch, TimeFault, Walk, span, typical_steps};
use super::time_unit::TimeUnit;
use crate::series::error::SeriesError;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Largest relative departure of the times' rate from the declared one.
const RATE: f64 = 1e-3;
/// Samples that gaps may add, for each sample there is, and beyond that as many as an hour at 1 kHz has. More is a wrong time.
const MOST_ADDED: f64 = 100.0;
const ALWAYS_ALLOWED: f64 = 3.6e6;

/// Relation of the samples to their stored times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evenness {
    /// Every sample is the stored one.
    Even,
    /// Steps differ by more than 2 %: samples are interpolated between the stored ones.
    Resampled {
        /// Largest departure of a step from the typical one, as a share of it.
        largest: f64,
        /// Stored rows before that step.
        row: usize,
    },
}

/// Change of the logger's rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateChange {
    /// Time of the change, s.
    pub at_s: f64,
    /// Samples per second before and after the change.
    pub rates_hz: [f64; 2],
}

impl RateChange {
    /// Describes the time of the change and both rates.
    pub fn words(&self) -> String {
        let rounded = |x: f64, parts: f64| (x * parts).round() / parts;
        let [from, to] = self.rates_hz.map(|r| rounded(r, 1e4));
        let at = rounded(self.at_s, 1e6);
        format!("the sample rate changes at {at} s, from {from} Hz to {to} Hz")
    }

    /// Returns the change of rate at a stretch whose rate is unusual, in a record that begins at `start_s`.
    fn from_stretch(stretch: Stretch, start_s: f64, usual_s: f64) -> Self {
        let (usual, other) = (1.0 / usual_s, 1.0 / stretch.step_s);
        match stretch.from_s > start_s {
            true => Self {
                at_s: stretch.from_s,
                rates_hz: [usual, other],
            },
            false => Self {
                at_s: stretch.to_s,
                rates_hz: [other, usual],
            },
        }
    }
}

/// Times of the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample, s. It is 0 for a file with absolute times.
    pub start_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Number of samples on even steps, including missing samples.
    pub samples: usize,
    /// Rows in the file.
    pub rows: usize,
    /// Whether the samples are even or resampled.
    pub evenness: Evenness,
    /// First change of the rate. The record then has the fastest rate, or a rate in between if the rates differ by less than a half.
    pub change: Option<RateChange>,
    /// Number of samples that are missing in gaps.
    pub missing: usize,
    /// The first thousand gaps.
    pub gaps: Vec<Gap>,
    /// Number of gaps.
    pub n_gaps: usize,
    /// Absolute time of the first sample, s since 1970, if the file states it.
    pub epoch_s: Option<f64>,
    /// Unit of the stored times, recognised by their size. `None` if the file states the unit, or if the size does not show it.
    pub unit: Option<TimeUnit>,
}

impl Clock {
    /// Returns the span of the record, s.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// Returns the time of sample `i`, s.
    pub fn time_s(&self, i: usize) -> f64 {
        self.start_s + i as f64 / self.rate_hz
    }
}

/// Steps of stored times, which place samples on even steps.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// Steps and gaps of each piece.
    pub spans: Vec<Span>,
    /// Steps for comparison. They are infinite if the record has a single time.
    pub scale: Scale,
}

impl Steps {
    /// Returns the number of samples that are missing between two successive times.
    pub(super) fn missing_between(&self, a: f64, b: f64) -> usize {
        if self.scale.is_gap(b - a) {
            ((b - a) / self.scale.typical).round() as usize - 1
        } else {
            0
        }
    }
}

/// Returns the clock of a reader, and the steps of its stored times.
///
/// # Errors
/// No samples, no rate, a rate other than the declared one, times that are missing or do not ascend.
pub(super) fn clock_of(
    reader: &dyn RecordReader,
    declared_hz: Option<f64>,
) -> Result<(Clock, Option<Steps>), SeriesError> {
    match reader.times() {
        Times::Even {
            start_s,
            step_s,
            samples,
            ..
        } => {
            let rate = if step_s > 0.0 && step_s.is_finite() {
                declared_or(1.0 / step_s, declared_hz)?
            } else {
                declared_hz.ok_or(SeriesError::NoRate)?
            };
            Ok((even(start_s, rate, samples)?, None))
        }
        Times::None { samples } => {
            let rate = declared_hz.ok_or(SeriesError::NoRate)?;
            let samples = match samples {
                Some(n) => n,
                None => counts(reader)?.iter().sum(),
            };
            Ok((even(0.0, rate, samples)?, None))
        }
        Times::Stored {
            rounding_s,
            epoch_s,
            ..
        } => {
            let (mut clock, steps) = read_stored_clock(reader, rounding_s, declared_hz)?;
            clock.epoch_s = epoch_s;
            Ok((clock, Some(steps)))
        }
    }
}

/// Returns the rows of each piece.
pub(super) fn counts(reader: &dyn RecordReader) -> Result<Vec<usize>, SeriesError> {
    (0..reader.n_pieces())
        .into_par_iter()
        .map(|piece| {
            if let Some(rows) = reader.rows(piece) {
                return Ok(rows);
            }
            let mut rows = 0;
            reader.read(piece, &[Pick::Nothing], &mut |block| {
                rows += block.rows;
                ControlFlow::Continue(())
            })?;
            Ok(rows)
        })
        .collect()
}

fn even(start_s: f64, rate_hz: f64, samples: usize) -> Result<Clock, SeriesError> {
    if samples == 0 {
        return Err(SeriesError::Empty);
    }
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(SeriesError::NoRate);
    }
    Ok(Clock {
        start_s,
        rate_hz,
        samples,
        rows: samples,
        evenness: Evenness::Even,
        change: None,
        missing: 0,
        gaps: Vec::new(),
        n_gaps: 0,
        epoch_s: None,
        unit: None,
    })
}

/// The declared rate, where it agrees with the one found.
fn declared_or(found_hz: f64, declared_hz: Option<f64>) -> Result<f64, SeriesError> {
    match declared_hz {
        Some(declared) if !((found_hz / declared - 1.0).abs() <= RATE) => Err(SeriesError::Rate {
            found_hz,
            declared_hz: declared,
        }),
        Some(declared) => Ok(declared),
        None => Ok(found_hz),
    }
}

fn read_stored_clock(
    reader: &dyn RecordReader,
    rounding: f64,
    declared_hz: Option<f64>,
) -> Result<(Clock, Steps), SeriesError> {
    let scale = typical_steps(reader, rounding)?;
    let (spans, rows) = spans_of(reader, scale)?;
    let start = spans.iter().find(|s| s.rows > 0).map_or(0.0, |s| s.first);
    let Some(scale) = scale else {
        let rate = declared_hz.ok_or(SeriesError::NoRate);
        return if rows == 0 {
            Err(SeriesError::Empty)
        } else if rows == 1 && declared_hz.is_none() {
            Err(SeriesError::Line {
                line: reader.line(0, 0, 0),
                what: "one sample: the time between samples is unknown".into(),
                remedy: "give two rows or more, or name the column of a single state `run`",
            })
        } else {
            let scale = Scale::without_gaps();
            Ok((even(start, rate?, rows)?, Steps { spans, scale }))
        };
    };
    let Some(stretch) = Stretch::join_pieces(spans.iter().filter_map(|s| s.stretch)) else {
        let clock = join_spans(&spans, scale, declared_hz)?;
        return Ok((clock, Steps { spans, scale }));
    };
    // Compare the steps with the typical steps of all rates.
    let change = RateChange::from_stretch(stretch, start, scale.usual);
    let scale = scale.with_rates(spans.iter().filter_map(|s| s.others).flatten());
    let (spans, _) = spans_of(reader, Some(scale))?;
    let clock = Clock {
        change: Some(change),
        ..join_spans(&spans, scale, declared_hz)?
    };
    Ok((clock, Steps { spans, scale }))
}

/// A span for each piece, and the rows of all.
///
/// # Errors
/// Times that are missing or do not ascend.
fn spans_of(
    reader: &dyn RecordReader,
    scale: Option<Scale>,
) -> Result<(Vec<Span>, usize), SeriesError> {
    let mut spans = Vec::with_capacity(reader.n_pieces());
    let found: Vec<Result<Span, (usize, TimeFault)>> = (0..reader.n_pieces())
        .into_par_iter()
        .map(|p| span(reader, p, scale))
        .collect();
    let (mut rows, mut before): (usize, Option<f64>) = (0, None);
    for (piece, result) in found.into_iter().enumerate() {
        let line = |row| reader.line(piece, row, rows + row);
        let s: Span = result.map_err(|(row, wrong)| wrong.error_at_line(line(row)))?;
        if let Some(last) = before.filter(|_| s.rows > 0)
            && !(s.first > last)
        {
            return Err(SeriesError::NotAscending {
                line: line(0),
                time_s: s.first,
                before_s: last,
            });
        }
        if s.rows > 0 {
            before = Some(s.last);
        }
        rows += s.rows;
        spans.push(s);
    }
    Ok((spans, rows))
}

/// Joins the spans and the steps between them.
fn join_spans(
    spans: &[Span],
    scale: Scale,
    declared_hz: Option<f64>,
) -> Result<Clock, SeriesError> {
    let typical = scale.typical;
    let mut all = Walk::new(scale);
    let (mut gaps, mut n_gaps, mut missing): (Vec<Gap>, usize, f64) = (Vec::new(), 0, 0.0);
    let (mut rows, mut sum, mut number, mut largest) = (0, 0.0, 0, (0.0_f64, 0));
    let mut last: Option<f64> = None;
    for s in spans.iter().filter(|s| s.rows > 0) {
        if let Some(last) = last {
            all.step(last, s.first, rows);
        }
        gaps.append(&mut all.gaps);
        gaps.extend(s.gaps.iter().map(|g| Gap {
            after_row: g.after_row + rows,
            ..*g
        }));
        gaps.truncate(LISTED);
        n_gaps += s.n_gaps;
        missing += s.missing;
        sum += s.steps.0;
        number += s.steps.1;
        if s.largest.0 > largest.0 {
            largest = (s.largest.0, s.largest.1 + rows);
        }
        rows += s.rows;
        last = Some(s.last);
    }
    n_gaps += all.n_gaps;
    missing += all.missing;
    if all.largest.0 > largest.0 {
        largest = all.largest;
    }
    let step = (sum + all.steps.0) / (number + all.steps.1).max(1) as f64;
    let start = spans.iter().find(|s| s.rows > 0).map_or(0.0, |s| s.first);
    let end = last.unwrap_or(start);
    // A stretch at a far lower rate needs as many added samples as a gap.
    let between = match scale.longest > typical {
        true => (end - start) / step - rows as f64,
        false => 0.0,
    };
    let added = missing.max(between);
    if added > MOST_ADDED * rows as f64 + ALWAYS_ALLOWED {
        let worst = gaps.iter().max_by_key(|g| g.missing);
        return Err(SeriesError::Hole {
            from_s: worst.map_or(start, |g| g.from_s),
            to_s: worst.map_or(end, |g| g.to_s),
            missing: added as u64,
        });
    }
    // Rounding can hide that steps differ, but not that rates differ.
    let differ = largest.0.max(scale.longest - typical);
    let evenness = if differ <= EVEN * typical {
        Evenness::Even
    } else {
        Evenness::Resampled {
            largest: differ / typical,
            row: largest.1,
        }
    };
    let samples = match evenness {
        Evenness::Even => rows + missing as usize,
        // The last sample is at the last stored time, within rounding.
        Evenness::Resampled { .. } => ((end - start) / step + 1e-6).floor() as usize + 1,
    };
    let rate_hz = declared_or(1.0 / step, declared_hz)?;
    Ok(Clock {
        rows,
        missing: missing as usize,
        gaps,
        n_gaps,
        evenness,
        ..even(start, rate_hz, samples)?
    })
}
