//! What a pass over the times of one piece tells.

use super::reader::{Pick, RecordReader};
use crate::series::error::SeriesError;
use std::ops::ControlFlow;

/// A step longer than this many typical ones is a gap: at least one sample is missing.
pub(super) const GAP: f64 = 1.5;
/// Gaps that are kept by place; further ones are counted.
pub(super) const LISTED: usize = 1000;

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

/// What a pass over the times of a piece tells.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Rows.
    pub rows: usize,
    /// Time of the first row, s.
    pub first: f64,
    /// Time of the last, s.
    pub last: f64,
    /// The first gaps within.
    pub gaps: Vec<Gap>,
    /// How many there are.
    pub n_gaps: usize,
    /// Samples missing within.
    pub missing: f64,
    /// Sum and number of the steps that are no gaps.
    pub steps: (f64, usize),
    /// Largest departure beyond rounding of a step, or of a gap from whole steps, s, and the rows before it.
    pub largest: (f64, usize),
    /// Whether every time is a whole number.
    pub whole_numbers: bool,
}

/// The median step of the first rows; `None` with fewer than two.
pub(super) fn typical_step(reader: &dyn RecordReader) -> Result<Option<f64>, SeriesError> {
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
pub(super) enum Wrong {
    Missing,
    Back { time_s: f64, before_s: f64 },
    Read(SeriesError),
}

impl Wrong {
    /// As an error at a line.
    pub(super) fn at(self, line: usize) -> SeriesError {
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
pub(super) struct Walk {
    typical: f64,
    rounding: f64,
    pub gaps: Vec<Gap>,
    pub n_gaps: usize,
    pub missing: f64,
    pub steps: (f64, usize),
    pub largest: (f64, usize),
}

impl Walk {
    pub(super) fn new(typical: f64, rounding: f64) -> Self {
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
    pub(super) fn step(&mut self, a: f64, b: f64, rows: usize) {
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

/// The span of a piece; else the row in it that is wrong.
pub(super) fn span(
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
