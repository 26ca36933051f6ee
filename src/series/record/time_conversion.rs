//! Stored times brought to seconds from one beginning: times in another unit, times since 1970, times of day that pass midnight.

use super::column::Column;
use super::reader::{Block, OtherChannel, Pick, RecordReader, Sink, Times};
use super::span::typical_steps;
use super::time_unit::{DAY, TimeUnit};
use crate::series::error::SeriesError;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// A reader whose times are brought to seconds.
struct SecondsReader {
    inner: Box<dyn RecordReader>,
    /// Stored time of the beginning.
    origin: f64,
    /// Seconds in one stored time.
    second: f64,
    /// Seconds to add to the times of day of each piece; empty for other times.
    later_s: Vec<f64>,
    times: Times,
}

/// Returns the reader with its times in seconds, and the unit of the times if it was recognised by their size. `time_unit_s` is the unit in seconds,
/// for a file that states no unit.
///
/// # Errors
/// Times that can't be read, and a file that states another unit than `time_unit_s`.
pub(super) fn with_times_in_seconds(
    reader: Box<dyn RecordReader>,
    time_unit_s: Option<f64>,
) -> Result<(Box<dyn RecordReader>, Option<TimeUnit>), SeriesError> {
    if let Some((stated, of_job)) = reader.stated_time_unit_s().zip(time_unit_s)
        && (stated / of_job - 1.0).abs() > 1e-9
    {
        return Err(SeriesError::Broken {
            wrong: format!(
                "the file states its times in units of {stated} s, the job states `time_unit` of {of_job} s"
            ),
            remedy: "correct the wrong one: the unit of the column of times, or `time_unit` of the job",
        });
    }
    let (rounding_s, epoch_s, unit_stated) = match reader.times() {
        Times::Stored {
            rounding_s,
            epoch_s,
            unit_stated,
        } => (rounding_s, epoch_s, unit_stated),
        Times::Even { .. } => return Ok((in_stated_unit(reader, time_unit_s), None)),
        Times::None { .. } => return Ok((reader, None)),
    };
    if reader.are_times_of_day() {
        return Ok((past_midnight(reader)?, None));
    }
    if unit_stated || epoch_s.is_some() {
        return Ok((reader, None));
    }
    let (origin, second, unit) = match time_unit_s {
        Some(second) => (0.0, second, None),
        None => {
            let step = typical_steps(&*reader, rounding_s)?.map(|scale| scale.typical);
            let found = first_time(&*reader)?.zip(step);
            let found = found.and_then(|(t, step)| Some((t, TimeUnit::from_times(t, step)?)));
            let Some((first, unit)) = found else {
                return Ok((reader, None));
            };
            (first, unit.seconds(), Some(unit))
        }
    };
    // 64-bit numbers are accurate to half of their last bit.
    let digits = 0.5 * f64::EPSILON * origin.abs();
    let times = Times::Stored {
        rounding_s: (rounding_s + digits) * second,
        epoch_s: unit.map(|u| u.since_1970(origin)),
        unit_stated: true,
    };
    let inner = SecondsReader {
        inner: reader,
        origin,
        second,
        later_s: Vec::new(),
        times,
    };
    Ok((Box::new(inner), unit))
}

/// Returns a reader of even steps with its times in seconds, where the file states no unit and the job does.
fn in_stated_unit(
    reader: Box<dyn RecordReader>,
    time_unit_s: Option<f64>,
) -> Box<dyn RecordReader> {
    match (reader.times(), time_unit_s) {
        (
            Times::Even {
                start_s,
                step_s,
                samples,
                unit_stated: false,
            },
            Some(second),
        ) => Box::new(SecondsReader {
            inner: reader,
            origin: 0.0,
            second,
            later_s: Vec::new(),
            times: Times::Even {
                start_s: start_s * second,
                step_s: step_s * second,
                samples,
                unit_stated: true,
            },
        }),
        _ => reader,
    }
}

fn first_time(reader: &dyn RecordReader) -> Result<Option<f64>, SeriesError> {
    let mut first = None;
    for piece in 0..reader.n_pieces() {
        reader.head(piece, &[Pick::Time], &mut |block| {
            first = block.values.first().copied();
            ControlFlow::Break(())
        })?;
        if first.is_some() {
            break;
        }
    }
    Ok(first)
}

/// Returns whether midnight is between two times of day that follow each other: the second is more than half a day before the first.
fn passes_midnight(before: f64, next: f64) -> bool {
    before - next > 0.5 * DAY
}

/// The reader of a record that passes midnight, its times counting on; any other as it is.
fn past_midnight(reader: Box<dyn RecordReader>) -> Result<Box<dyn RecordReader>, SeriesError> {
    let of_piece = |piece: usize| {
        let (mut first, mut last, mut passed) = (None, None, 0_u32);
        reader.read(piece, &[Pick::Time], &mut |block| {
            for t in block.values {
                passed += u32::from(last.is_some_and(|last| passes_midnight(last, *t)));
                first = first.or(Some(*t));
                last = Some(*t);
            }
            ControlFlow::Continue(())
        })?;
        Ok((first, last, passed))
    };
    let pieces: Result<Vec<_>, SeriesError> = (0..reader.n_pieces())
        .into_par_iter()
        .map(of_piece)
        .collect();
    let (mut later_s, mut days, mut before) = (Vec::new(), 0_u32, None);
    for (first, last, passed) in pieces? {
        if let (Some(before), Some(first)) = (before, first) {
            days += u32::from(passes_midnight(before, first));
        }
        later_s.push(f64::from(days) * DAY);
        days += passed;
        before = last.or(before);
    }
    if days == 0 {
        return Ok(reader);
    }
    Ok(Box::new(SecondsReader {
        times: reader.times(),
        inner: reader,
        origin: 0.0,
        second: 1.0,
        later_s,
    }))
}

impl SecondsReader {
    /// Hands blocks on with their times in seconds.
    fn convert_times(
        &self,
        piece: usize,
        picks: &[Pick],
        sink: &mut Sink,
        read: &dyn Fn(&mut Sink) -> Result<(), SeriesError>,
    ) -> Result<(), SeriesError> {
        let places = picks.iter().enumerate();
        let places: Vec<usize> = places
            .filter_map(|(j, p)| (*p == Pick::Time).then_some(j))
            .collect();
        if places.is_empty() {
            return read(sink);
        }
        let is_of_day = !self.later_s.is_empty();
        let mut later_s = self.later_s.get(piece).copied().unwrap_or(0.0);
        let mut before: Option<f64> = None;
        let mut values = Vec::new();
        read(&mut |block| {
            values.clear();
            values.extend_from_slice(block.values);
            for row in values.chunks_exact_mut(picks.len()) {
                let stored = places.first().and_then(|j| row.get(*j)).copied();
                let stored = stored.unwrap_or(f64::NAN);
                if is_of_day && before.is_some_and(|b| passes_midnight(b, stored)) {
                    later_s += DAY;
                }
                before = Some(stored);
                let seconds = (stored - self.origin) * self.second + later_s;
                for j in &places {
                    if let Some(slot) = row.get_mut(*j) {
                        *slot = seconds;
                    }
                }
            }
            sink(Block {
                values: &values,
                ..block
            })
        })
    }
}

impl RecordReader for SecondsReader {
    fn columns(&self) -> &[Column] {
        self.inner.columns()
    }

    fn group(&self, column: usize) -> &str {
        self.inner.group(column)
    }

    fn other_channels(&self) -> &[OtherChannel] {
        self.inner.other_channels()
    }

    fn times(&self) -> Times {
        self.times
    }

    fn n_pieces(&self) -> usize {
        self.inner.n_pieces()
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.convert_times(piece, picks, sink, &|sink| {
            self.inner.read(piece, picks, sink)
        })
    }

    fn head(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.convert_times(piece, picks, sink, &|sink| {
            self.inner.head(piece, picks, sink)
        })
    }

    fn left_out(&self) -> Option<usize> {
        self.inner.left_out()
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        self.inner.rows(piece)
    }

    fn line(&self, piece: usize, row_in_piece: usize, row: usize) -> usize {
        self.inner.line(piece, row_in_piece, row)
    }
}

#[cfg(test)]
mod tests {
    use crate::series::record::{Options, Record, open_record};
    use std::sync::Arc;

    fn record(text: &str, options: &Options) -> Record {
        open_record(Arc::new(text.as_bytes().to_vec()), options).unwrap()
    }

    #[test]
    fn numbers_of_days_and_times_since_1970_are_seconds_from_the_first() {
        let rows = |time: &dyn Fn(i32) -> String| {
            let row = |i: i32| format!("{},{i}\n", time(i));
            format!("time,P01\n{}", (0..500).map(row).collect::<String>())
        };
        let at = |i: i32| f64::from(i) * 0.01;
        let noon = 20_574.5 * 86_400.0;
        for text in [
            rows(&|i| format!("{:.10}", 46_143.5 + at(i) / 86_400.0)),
            rows(&|i| format!("{:.3}", noon + at(i))),
            rows(&|i| format!("{:.0}", (noon + at(i)) * 1e3)),
            rows(&|i| format!("{:.0}", (noon + at(i)) * 1e6)),
            rows(&|i| format!("{:.0}", (noon + at(i)) * 1e9)),
        ] {
            let record = record(&text, &Options::default());
            // Steps of 10 ms, times rounded to 4 microseconds at most.
            assert!((record.clock.rate_hz - 100.0).abs() < 1e-3, "{text:.60}");
            assert_eq!((record.clock.samples, record.clock.start_s), (500, 0.0));
            assert!((record.clock.epoch_s.unwrap() - noon).abs() < 1e-4);
            assert!(record.clock.unit.is_some() && record.clock.n_gaps == 0);
        }
    }

    #[test]
    fn a_unit_that_the_job_states_goes_before_what_is_recognised() {
        let text = "time,P01\n0,1\n10,2\n20,3\n";
        let options = Options {
            time_unit_s: Some(1e-3),
            ..Options::default()
        };
        assert!((record(text, &options).clock.rate_hz - 100.0).abs() < 1e-9);
        assert!((record(text, &Options::default()).clock.rate_hz - 0.1).abs() < 1e-12);
        // The file states another unit.
        let stated = text.replace("time", "time [s]");
        assert!(open_record(Arc::new(stated.into_bytes()), &options).is_err());
    }

    #[test]
    fn times_of_day_count_on_after_midnight() {
        let mut text = "time,P01\n".to_owned();
        for i in 0..40 {
            let s = (86_390 + i) % 86_400;
            text += &format!("{:02}:{:02}:{:02},{i}\n", s / 3600, s / 60 % 60, s % 60);
        }
        let record = record(&text, &Options::default());
        assert_eq!(record.clock.samples, 40);
        assert!((record.clock.rate_hz - 1.0).abs() < 1e-12);
        assert_eq!(record.clock.n_gaps, 0);
        // A step back by an hour is not midnight.
        let back = "time,P01\n12:00:00,1\n12:00:01,2\n11:00:02,3\n";
        assert!(open_record(Arc::new(back.as_bytes().to_vec()), &Options::default()).is_err());
    }
}
