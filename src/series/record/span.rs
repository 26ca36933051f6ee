//! Steps, gaps and rates of the stored times of one piece.

use super::reader::{Pick, RecordReader};
use crate::series::error::SeriesError;
use std::ops::ControlFlow;

/// Largest departure of a step from the typical step that still counts as even.
///
/// Consider a sine with `m` samples a period. Jitter `e` moves a reading by at most `2 pi e / m` of the amplitude. Linear interpolation between
/// samples cuts off up to `(2 pi / m)^2 / 8`. Below `e = pi / (4 m)`, .02 for 40 samples, the stored samples are nearer to the truth than
/// interpolated ones.
pub const EVEN: f64 = 0.02;
/// Number of typical steps from which a step counts as a gap, in which at least one sample is missing.
pub(super) const GAP: f64 = 1.5;
/// Number of gaps whose place is stored. Further gaps are only counted.
pub(super) const LISTED: usize = 1000;

/// Steps whose mean is the rate of the logger there: twenty, so that their mean is known well where times are rounded.
const WINDOW: usize = 20;
/// Share of their mean by which steps of one rate differ: none is twice as long, as it is where a sample is lost.
const SAME_STEP_REL: f64 = 0.25;
/// Share by which another rate differs from the usual one: clocks drift by far less.
const OTHER: f64 = 0.1;

/// A stretch of a record with another rate of the logger than the typical rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Time of the first sample, s.
    pub from_s: f64,
    /// Time of the last sample of the stretch, or of the piece in which it begins, s.
    pub to_s: f64,
    /// Step of time, s.
    pub step_s: f64,
}

impl Stretch {
    /// Returns the first stretch of consecutive pieces, with its continuation in the next pieces.
    pub(super) fn join_pieces(mut list: impl Iterator<Item = Self>) -> Option<Self> {
        let mut first = list.next()?;
        for next in list {
            // The last rows of a piece may not fill a window.
            if next.from_s - first.to_s > 2.0 * WINDOW as f64 * next.step_s {
                break;
            }
            first.to_s = next.to_s;
        }
        Some(first)
    }
}

/// Typical and longest steps of a record, for comparison with its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Typical step, s. With several rates, it is the step of the fastest rate.
    pub typical: f64,
    /// Longest step of any rate, s. A step that is half as long again is a gap.
    pub longest: f64,
    /// The mean of [`WINDOW`] steps in the first rows, s.
    pub usual: f64,
    /// Largest rounding error of a time, s.
    pub rounding: f64,
}

impl Scale {
    /// Returns the scale of a record with a single time: no step is a gap.
    pub(super) fn without_gaps() -> Self {
        Self {
            typical: f64::INFINITY,
            longest: f64::INFINITY,
            usual: f64::INFINITY,
            rounding: 0.0,
        }
    }

    /// Returns this scale with the steps of further rates.
    pub(super) fn with_rates(self, others: impl Iterator<Item = f64>) -> Self {
        let [low, high] = others.fold([self.usual; 2], |[low, high], step| {
            [low.min(step), high.max(step)]
        });
        Self {
            typical: low,
            longest: high,
            ..self
        }
    }

    /// Returns whether a step is a gap.
    pub(super) fn is_gap(&self, step: f64) -> bool {
        step > GAP * self.longest
    }
}

/// Gap of missing samples between two stored samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Number of stored rows before the gap.
    pub after_row: usize,
    /// Time of the last sample before the gap, s.
    pub from_s: f64,
    /// Time of the first sample after the gap, s.
    pub to_s: f64,
    /// Number of samples on even steps that are missing in the gap.
    pub missing: usize,
}

/// Steps, gaps and rates of the times of a piece.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Number of rows.
    pub rows: usize,
    /// Time of the first row, s.
    pub first: f64,
    /// Time of the last row, s.
    pub last: f64,
    /// First gaps within the piece.
    pub gaps: Vec<Gap>,
    /// Number of gaps.
    pub n_gaps: usize,
    /// Number of samples that are missing in the gaps.
    pub missing: f64,
    /// Sum and number of the steps that are not gaps.
    pub steps: (f64, usize),
    /// Largest departure beyond rounding of a step from the typical step, or of a gap from whole steps, s. The second value is the number of rows
    /// before it.
    pub largest: (f64, usize),
    /// The first stretch of another rate.
    pub stretch: Option<Stretch>,
    /// Shortest and longest step of other rates, s.
    pub others: Option<[f64; 2]>,
}

/// Returns two typical steps of the first rows: the median of single steps, and the lower quartile of the mean steps over [`WINDOW`] rows. If two
/// rates share the first rows, the quartile belongs to one of them. The result is `None` with fewer than two rows.
pub(super) fn typical_steps(
    reader: &dyn RecordReader,
    rounding: f64,
) -> Result<Option<Scale>, SeriesError> {
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
    let steps = |rows: usize| {
        let pairs = times.iter().zip(times.iter().skip(rows));
        let steps = pairs.map(|(a, b)| (b - a) / rows as f64);
        steps.filter(|s| *s > 0.0).collect::<Vec<f64>>()
    };
    let Some(typical) = lower_quantile(steps(1), 2) else {
        return Ok(None);
    };
    Ok(Some(Scale {
        typical,
        longest: typical,
        usual: lower_quantile(steps(WINDOW), 4).unwrap_or(typical),
        rounding,
    }))
}

/// The number that one in `part` is below.
fn lower_quantile(mut numbers: Vec<f64>, part: usize) -> Option<f64> {
    let at = numbers.len() / part;
    let fits = at < numbers.len();
    fits.then(|| *numbers.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// An impossible time.
pub(super) enum TimeFault {
    Missing,
    Back { time_s: f64, before_s: f64 },
    Read(SeriesError),
}

impl TimeFault {
    /// Returns the error at a line.
    pub(super) fn error_at_line(self, line: usize) -> SeriesError {
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

/// Analysis of the steps seen so far.
pub(super) struct Walk {
    scale: Scale,
    pub gaps: Vec<Gap>,
    pub n_gaps: usize,
    pub missing: f64,
    pub steps: (f64, usize),
    pub largest: (f64, usize),
    pub stretch: Option<Stretch>,
    pub others: Option<[f64; 2]>,
    /// The latest times: those in the last full window and in the window that is being filled.
    times: Vec<f64>,
    /// Steps in the window that is being filled.
    filled: usize,
}

impl Walk {
    pub(super) fn new(scale: Scale) -> Self {
        Self {
            scale,
            gaps: Vec::new(),
            n_gaps: 0,
            missing: 0.0,
            steps: (0.0, 0),
            largest: (0.0, 0),
            stretch: None,
            others: None,
            times: Vec::with_capacity(2 * WINDOW + 1),
            filled: 0,
        }
    }

    /// Records a window whose steps have another rate.
    fn note_rate(&mut self, a: f64, b: f64) {
        if self.times.is_empty() {
            self.times.push(a);
        }
        self.times.push(b);
        self.filled += 1;
        if self.filled < WINDOW {
            return;
        }
        self.filled = 0;
        if let Some(found) = self.another_rate() {
            let step = found.step_s;
            match &mut self.stretch {
                Some(first) if first.to_s >= found.from_s => first.to_s = found.to_s,
                Some(_) => {}
                none => *none = Some(found),
            }
            let [low, high] = self.others.unwrap_or([step; 2]);
            self.others = Some([low.min(step), high.max(step)]);
        }
        let before = self.times.len().saturating_sub(WINDOW + 1);
        self.times.drain(..before);
    }

    /// The window that is full, where it is of another rate; it begins where the steps before it are of that rate already.
    fn another_rate(&self) -> Option<Stretch> {
        let Scale {
            usual, rounding, ..
        } = self.scale;
        let first = self.times.len().checked_sub(WINDOW + 1)?;
        let (before, window) = (self.times.get(..=first)?, self.times.get(first..)?);
        let (from, to) = (*window.first()?, *window.last()?);
        let mean = (to - from) / WINDOW as f64;
        let step = |w: &[f64]| w.last().zip(w.first()).map_or(0.0, |(b, a)| b - a);
        let alike = (SAME_STEP_REL * mean).max(EVEN * mean + 2.0 * rounding);
        let is_alike = |w: &[f64]| (step(w) - mean).abs() <= alike;
        // Both ends of each mean are rounded.
        let off = OTHER * usual + 4.0 * rounding / WINDOW as f64;
        if (mean - usual).abs() <= off || !window.windows(2).all(is_alike) {
            return None;
        }
        let is_of_it = |w: &&[f64]| (step(w) > 0.5 * (usual + mean)) == (mean > usual);
        let already = before.windows(2).rev().take_while(is_of_it).count();
        Some(Stretch {
            from_s: before.iter().rev().nth(already).copied().unwrap_or(from),
            to_s: to,
            step_s: mean,
        })
    }

    /// Takes the step from `a` to `b`. `rows` is the number of rows before it.
    pub(super) fn step(&mut self, a: f64, b: f64, rows: usize) {
        let step = b - a;
        let Scale {
            typical, rounding, ..
        } = self.scale;
        self.note_rate(a, b);
        let whole = if self.scale.is_gap(step) {
            (step / typical).round()
        } else {
            // Only typical steps contribute to the rate.
            if step <= GAP * typical {
                self.steps.0 += step;
                self.steps.1 += 1;
            }
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
        // Both ends of a step are rounded. A gap of many steps is compared with a multiple of the typical step, whose error grows with the number of
        // steps.
        let off = (step - whole * typical).abs() - 2.0 * rounding;
        let off = if whole > 1.0 { off / whole } else { off };
        if off > self.largest.0 {
            self.largest = (off, rows);
        }
    }
}

/// Returns the span of a piece, or the first wrong row in the piece.
pub(super) fn span(
    reader: &dyn RecordReader,
    piece: usize,
    scale: Option<Scale>,
) -> Result<Span, (usize, TimeFault)> {
    let mut walk = Walk::new(scale.unwrap_or(Scale::without_gaps()));
    let (mut rows, mut first, mut last) = (0, f64::NAN, f64::NAN);
    let mut wrong = None;
    let read = reader.read(piece, &[Pick::Time], &mut |block| {
        for &t in block.values {
            if !t.is_finite() {
                wrong = Some((rows, TimeFault::Missing));
            } else if rows > 0 && !(t > last) {
                let back = TimeFault::Back {
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
            } else if scale.is_some() {
                walk.step(last, t, rows);
            }
            last = t;
            rows += 1;
        }
        ControlFlow::Continue(())
    });
    read.map_err(|e| (rows, TimeFault::Read(e)))?;
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
            stretch: walk.stretch,
            others: walk.others,
        }),
    }
}
