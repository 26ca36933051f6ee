//! The clock of a record: one pass over its times tells rate, span, gaps, and whether the steps are even.

use super::reader::{Pick, RecordReader, Times};
use crate::series::error::SeriesError;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Largest departure of a step from the typical one that still counts as even: jitter of a logger's clock, which moves a reading by
/// a fiftieth of what changes in a step.
const EVEN: f64 = 0.02;
/// A step longer than this many typical ones is a gap: at least one sample is missing.
const GAP: f64 = 1.5;
/// Largest relative departure of the times' rate from the declared one.
const RATE: f64 = 1e-3;
/// Gaps that are kept by place; further ones are counted.
const LISTED: usize = 1000;
/// Samples that gaps may add, for each sample there is, and beyond that as many as an hour at 1 kHz has. More is a wrong time.
const MOST_ADDED: f64 = 100.0;
const ALWAYS_ALLOWED: f64 = 3.6e6;
/// Rows of whole numbers of seconds, unit unstated, from which on they are taken for milliseconds or counts.
const TELLING: usize = 100;

/// Samples that are missing between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Stored rows before it.
    pub after_row: usize,
    /// Time of the last sample before, s.
    pub from_s: f64,
    /// Time of the first sample after, s.
    pub to_s: f64,
    /// Samples of even steps that fall in between.
    pub missing: usize,
}

/// Whether samples stand where they were stored.
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

/// When samples were taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample, s; 0 for a file with absolute times.
    pub start_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Samples on even steps, missing ones among them.
    pub samples: usize,
    /// Rows in the file.
    pub rows: usize,
    /// Even or resampled.
    pub evenness: Evenness,
    /// Samples missing in gaps.
    pub missing: usize,
    /// The first thousand gaps.
    pub gaps: Vec<Gap>,
    /// How many gaps there are.
    pub n_gaps: usize,
    /// Absolute time of the first sample, s since 1970, where the file has it.
    pub epoch_s: Option<f64>,
    /// Times are whole numbers of an unstated unit, one or more apart: they may be milliseconds, or counts.
    pub doubtful_unit: bool,
}

impl Clock {
    /// Span of the record, s.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// Time of sample `i`, s.
    pub fn time_s(&self, i: usize) -> f64 {
        self.start_s + i as f64 / self.rate_hz
    }
}

/// What a pass over the times of a piece tells.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Rows.
    pub rows: usize,
    /// Time of the first row, s.
    pub first: f64,
    /// Time of the last, s.
    pub last: f64,
    gaps: Vec<Gap>,
    n_gaps: usize,
    /// Samples missing within.
    pub missing: f64,
    /// Sum and number of the steps that are no gaps.
    steps: (f64, usize),
    /// Largest departure beyond rounding of a step, or of a gap from whole steps, s, and the rows before it.
    largest: (f64, usize),
    whole_numbers: bool,
}

/// What is remembered of stored times to put samples on even steps.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// A piece each.
    pub spans: Vec<Span>,
    /// The typical step, s; infinite where there is none.
    pub typical: f64,
}

impl Steps {
    /// Samples missing between two times that follow each other.
    pub(super) fn missing_between(&self, a: f64, b: f64) -> usize {
        if b - a > GAP * self.typical {
            ((b - a) / self.typical).round() as usize - 1
        } else {
            0
        }
    }
}

/// The clock of a reader, and the steps of its stored times.
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
            unit_stated,
        } => {
            let (mut clock, steps) = stored(reader, rounding_s, declared_hz)?;
            clock.epoch_s = epoch_s;
            clock.doubtful_unit &= !unit_stated && epoch_s.is_none();
            Ok((clock, Some(steps)))
        }
    }
}

/// Rows of each piece.
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
        missing: 0,
        gaps: Vec::new(),
        n_gaps: 0,
        epoch_s: None,
        doubtful_unit: false,
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

fn stored(
    reader: &dyn RecordReader,
    rounding: f64,
    declared_hz: Option<f64>,
) -> Result<(Clock, Steps), SeriesError> {
    let typical = typical_step(reader)?;
    let mut spans = Vec::with_capacity(reader.n_pieces());
    let found: Vec<Result<Span, (usize, Wrong)>> = (0..reader.n_pieces())
        .into_par_iter()
        .map(|p| span(reader, p, typical, rounding))
        .collect();
    let (mut rows, mut before): (usize, Option<f64>) = (0, None);
    for (piece, result) in found.into_iter().enumerate() {
        let line = |row| reader.line(piece, row, rows + row);
        let s: Span = result.map_err(|(row, wrong)| wrong.at(line(row)))?;
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
    let Some(step) = typical else {
        let start = spans.iter().find(|s| s.rows > 0).map_or(0.0, |s| s.first);
        let rate = declared_hz.ok_or(SeriesError::NoRate);
        return if rows == 0 {
            Err(SeriesError::Empty)
        } else {
            let steps = Steps {
                spans,
                typical: f64::INFINITY,
            };
            Ok((even(start, rate?, rows)?, steps))
        };
    };
    let clock = together(&spans, step, rounding, declared_hz)?;
    let steps = Steps {
        spans,
        typical: step,
    };
    Ok((clock, steps))
}

/// Joins the spans and the steps between them.
fn together(
    spans: &[Span],
    typical: f64,
    rounding: f64,
    declared_hz: Option<f64>,
) -> Result<Clock, SeriesError> {
    let mut all = Walk::new(typical, rounding);
    let (mut gaps, mut n_gaps, mut missing): (Vec<Gap>, usize, f64) = (Vec::new(), 0, 0.0);
    let (mut rows, mut sum, mut number, mut largest) = (0, 0.0, 0, (0.0_f64, 0));
    let mut whole = true;
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
        whole &= s.whole_numbers;
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
    if missing > MOST_ADDED * rows as f64 + ALWAYS_ALLOWED {
        let worst = gaps.iter().max_by_key(|g| g.missing);
        return Err(SeriesError::Hole {
            from_s: worst.map_or(start, |g| g.from_s),
            to_s: worst.map_or(end, |g| g.to_s),
            missing: missing as u64,
        });
    }
    let evenness = if largest.0 <= EVEN * typical {
        Evenness::Even
    } else {
        Evenness::Resampled {
            largest: largest.0 / typical,
            row: largest.1,
        }
    };
    let samples = match evenness {
        Evenness::Even => rows + missing as usize,
        // The last stored time is reached but for what rounding moved it.
        Evenness::Resampled { .. } => ((end - start) / step + 1e-6).floor() as usize + 1,
    };
    let rate_hz = declared_or(1.0 / step, declared_hz)?;
    Ok(Clock {
        rows,
        missing: missing as usize,
        gaps,
        n_gaps,
        evenness,
        doubtful_unit: whole && typical >= 1.0 && rows >= TELLING,
        ..even(start, rate_hz, samples)?
    })
}

/// The median step of the first rows; `None` with fewer than two.
fn typical_step(reader: &dyn RecordReader) -> Result<Option<f64>, SeriesError> {
    /// Rows looked at.
    const ROWS: usize = 4096;
    let mut times: Vec<f64> = Vec::new();
    for piece in 0..reader.n_pieces() {
        reader.read(piece, &[Pick::Time], &mut |block| {
            times.extend_from_slice(block.values);
            if times.len() < ROWS {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        })?;
        if times.len() >= ROWS {
            break;
        }
    }
    let mut steps: Vec<f64> = times
        .windows(2)
        .filter_map(|w| match w {
            [a, b] => Some(b - a).filter(|s| *s > 0.0),
            _ => None,
        })
        .collect();
    if steps.is_empty() {
        return Ok(None);
    }
    let middle = steps.len() / 2;
    Ok(Some(
        *steps.select_nth_unstable_by(middle, f64::total_cmp).1,
    ))
}

/// A time that can't be.
enum Wrong {
    Missing,
    Back { time_s: f64, before_s: f64 },
    Read(SeriesError),
}

impl Wrong {
    fn at(self, line: usize) -> SeriesError {
        match self {
            Self::Missing => SeriesError::NoTime { line },
            Self::Back { time_s, before_s } => SeriesError::NotAscending {
                line,
                time_s,
                before_s,
            },
            Self::Read(e) => e,
        }
    }
}

/// Steps seen so far.
struct Walk {
    typical: f64,
    rounding: f64,
    gaps: Vec<Gap>,
    n_gaps: usize,
    missing: f64,
    steps: (f64, usize),
    largest: (f64, usize),
}

impl Walk {
    fn new(typical: f64, rounding: f64) -> Self {
        Self {
            typical,
            rounding,
            gaps: Vec::new(),
            n_gaps: 0,
            missing: 0.0,
            steps: (0.0, 0),
            largest: (0.0, 0),
        }
    }

    /// Takes the step from `a` to `b`; `rows` stand before it.
    fn step(&mut self, a: f64, b: f64, rows: usize) {
        let step = b - a;
        let whole = if step > GAP * self.typical {
            (step / self.typical).round()
        } else {
            self.steps.0 += step;
            self.steps.1 += 1;
            1.0
        };
        if whole > 1.0 {
            self.n_gaps += 1;
            self.missing += whole - 1.0;
            if self.gaps.len() < LISTED {
                self.gaps.push(Gap {
                    after_row: rows,
                    from_s: a,
                    to_s: b,
                    missing: (whole - 1.0) as usize,
                });
            }
        }
        // Both ends of a step are rounded. A gap of many steps is held against the typical one, whose own error grows with them.
        let off = (step - whole * self.typical).abs() - 2.0 * self.rounding;
        let off = if whole > 1.0 { off / whole } else { off };
        if off > self.largest.0 {
            self.largest = (off, rows);
        }
    }
}

fn span(
    reader: &dyn RecordReader,
    piece: usize,
    typical: Option<f64>,
    rounding: f64,
) -> Result<Span, (usize, Wrong)> {
    let mut walk = Walk::new(typical.unwrap_or(f64::INFINITY), rounding);
    let (mut rows, mut first, mut last) = (0, f64::NAN, f64::NAN);
    let mut wrong = None;
    let mut whole_numbers = true;
    let read = reader.read(piece, &[Pick::Time], &mut |block| {
        for &t in block.values {
            if !t.is_finite() {
                wrong = Some((rows, Wrong::Missing));
            } else if rows > 0 && !(t > last) {
                let back = Wrong::Back {
                    time_s: t,
                    before_s: last,
                };
                wrong = Some((rows, back));
            }
            if wrong.is_some() {
                return ControlFlow::Break(());
            }
            if rows == 0 {
                first = t;
            } else if typical.is_some() {
                walk.step(last, t, rows);
            }
            whole_numbers &= t.fract() == 0.0;
            last = t;
            rows += 1;
        }
        ControlFlow::Continue(())
    });
    read.map_err(|e| (rows, Wrong::Read(e)))?;
    match wrong {
        Some(w) => Err(w),
        None => Ok(Span {
            rows,
            first,
            last,
            gaps: walk.gaps,
            n_gaps: walk.n_gaps,
            missing: walk.missing,
            steps: walk.steps,
            largest: walk.largest,
            whole_numbers,
        }),
    }
}
