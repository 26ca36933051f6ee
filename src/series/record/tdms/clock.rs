//! Times of the samples of a channel, as its properties or a channel of times state them.

use super::fault::read_error;
use super::segments::{Channel, Kind, Value};
use crate::series::error::SeriesError;
use crate::series::record::column::{is_time, seconds_in};
use crate::series::record::simultaneous_channels::Sampling;

/// Clocks of computers are read in steps of a 64th of a second.
const COMPUTER_CLOCK_S: f64 = 1.0 / 64.0;
/// Share by which two statements of one rate may differ.
const SAME_RATE: f64 = 0.01;

/// Returns the times of the samples of each channel. Channels that state a step have even steps from their start. Other channels take the times of
/// the time channel in their group, or of the first time channel in the file.
pub(super) fn samplings(all: &[Channel], file: &[u8]) -> Vec<Sampling> {
    let is_clock = |c: &Channel| step(c).is_none() && is_named_time(c, all);
    let clocks: Vec<(usize, &Channel)> = all.iter().enumerate().filter(|c| is_clock(c.1)).collect();
    // Two groups whose times are equal have one clock.
    let clock_of = |c: &Channel| {
        let long = |k: &&(usize, &Channel)| k.1.samples == c.samples;
        let own = clocks.iter().filter(long).find(|k| k.1.group == c.group);
        let (at, clock) = own.or_else(|| clocks.iter().find(long))?;
        let same = clocks
            .iter()
            .filter(long)
            .find(|k| k.1.is_equal(clock, file));
        Some(same.map_or(*at, |k| k.0))
    };
    let begin = all.iter().filter_map(|c| c.time("wf_start_time")).min();
    let since = |c: &Channel| match (begin, c.time("wf_start_time")) {
        (Some(begin), Some(start)) => start.seconds_since(begin),
        _ => 0.0,
    };
    let sampling = |c: &Channel| match step(c) {
        Some(step_s) => Sampling {
            start_s: since(c) + second(c) * c.number("wf_start_offset").unwrap_or(0.0),
            step_s,
            samples: c.samples,
            times: None,
            unit_stated: !axis_unit(c).is_empty(),
        },
        None => Sampling {
            start_s: 0.0,
            step_s: 0.0,
            samples: c.samples,
            times: clock_of(c),
            unit_stated: false,
        },
    };
    all.iter().map(sampling).collect()
}

/// Returns whether a channel contains times, by its kind or its name.
fn is_named_time(c: &Channel, all: &[Channel]) -> bool {
    let first = all.iter().find(|o| o.group == c.group);
    let is_first = first.is_some_and(|f| f.name == c.name);
    c.kind == Kind::Time || is_time(&c.name, is_first)
}

/// Returns the time between samples, s, where the channel states one.
fn step(c: &Channel) -> Option<f64> {
    let step = c.number("wf_increment").filter(|s| *s > 0.0)?;
    Some(second(c) * step)
}

/// Returns the unit of the axis of a waveform; empty where it states none.
fn axis_unit(c: &Channel) -> &str {
    c.text("wf_xunit_string").unwrap_or_default().trim()
}

/// Returns the seconds in one unit of the axis of a waveform.
fn second(c: &Channel) -> f64 {
    seconds_in(axis_unit(c)).unwrap_or(1.0)
}

/// Returns name and unit of the axis of a waveform, for messages.
pub(super) fn axis(c: &Channel) -> String {
    let name = c.text("wf_xname").unwrap_or_default().trim();
    format!("`{name} [{}]`", axis_unit(c))
}

/// Returns whether the axis of a channel is time. Its unit must be a unit of time. Without a unit, its name must be a name of time, or empty.
pub(super) fn is_over_time(c: &Channel) -> bool {
    if step(c).is_none() || !axis_unit(c).is_empty() {
        return seconds_in(axis_unit(c)).is_some();
    }
    let name = c.text("wf_xname").unwrap_or_default().trim();
    let words = name.to_lowercase();
    let contains = ["time", "zeit"].iter().any(|w| words.contains(w));
    contains || matches!(words.as_str(), "" | "t" | "x")
}

/// Refuses a channel whose segments do not follow each other: its times begin again, or its time between samples changes.
///
/// # Errors
/// A part that begins elsewhere than where the part before it ends.
pub(super) fn check_restarts(c: &Channel) -> Result<(), SeriesError> {
    let Some(step_s) = step(c) else {
        return Ok(());
    };
    let begin = c.time("wf_start_time");
    let offset = c.number("wf_start_offset").unwrap_or(0.0);
    let (mut start, mut now) = (begin, offset);
    for (i, restart) in c.restarts.iter().enumerate() {
        match (restart.key.as_str(), &restart.value) {
            ("wf_start_time", Value::Time(t)) => start = Some(*t),
            ("wf_start_offset", Value::Number(v)) => now = *v,
            ("wf_increment", Value::Number(v)) if (v * second(c) / step_s - 1.0).abs() > 1e-9 => {
                return Err(read_error(format!(
                    "the time between samples of `{}` changes at sample {} from {step_s} s to {} s",
                    c.name,
                    restart.first + 1,
                    v * second(c)
                )));
            }
            _ => {}
        }
        // A start and an offset that change at one sample are one restart.
        let next = c.restarts.get(i + 1);
        if next.is_some_and(|n| n.first == restart.first) {
            continue;
        }
        let since = match (begin, start) {
            (Some(begin), Some(start)) => start.seconds_since(begin),
            _ => 0.0,
        };
        let begins = since + second(c) * (now - offset);
        let ends = restart.first as f64 * step_s;
        if (begins - ends).abs() > step_s.max(COMPUTER_CLOCK_S) {
            return Err(read_error(format!(
                "`{}` has two parts with a time step between them: the second begins {begins} s after the first sample, and the first part \
                 of {} samples ends after {ends} s",
                c.name, restart.first
            )));
        }
    }
    Ok(())
}

/// Refuses channels with even steps if a channel of times in their group states another rate.
///
/// # Errors
/// A time channel that contradicts the increment of the waveforms.
pub(super) fn check_clocks(
    all: &[Channel],
    together: &[bool],
    main: Sampling,
    file: &[u8],
) -> Result<(), SeriesError> {
    if main.times.is_some() || main.step_s <= 0.0 || main.samples < 2 {
        return Ok(());
    }
    let read: Vec<&Channel> = all
        .iter()
        .zip(together)
        .filter_map(|(c, t)| t.then_some(c))
        .collect();
    let is_of_read = |c: &&Channel| {
        c.samples == main.samples
            && is_named_time(c, all)
            && read.iter().any(|r| r.group == c.group && r.name != c.name)
    };
    for c in all.iter().filter(is_of_read) {
        let [first, last] = [0, c.samples - 1].map(|i| {
            let mut value = [f64::NAN];
            c.decode(file, i, i + 1, value.iter_mut());
            let [value] = value;
            value
        });
        let mean = (last - first) / (c.samples - 1) as f64;
        let unit = if c.kind == Kind::Time { "s" } else { c.unit() };
        let stated = if unit.is_empty() {
            "(without a unit)"
        } else {
            unit
        };
        let units: &[&str] = match unit {
            "" => &["s", "ms", "us", "ns"],
            _ => &[unit],
        };
        let agrees = |unit: &&str| {
            seconds_in(unit).is_some_and(|s| (mean * s / main.step_s - 1.0).abs() < SAME_RATE)
        };
        if mean > 0.0 && !units.iter().any(agrees) {
            return Err(read_error(format!(
                "the times of channel `{}` are {mean} {stated} apart, and `wf_increment` of the other channels is {} s",
                c.name, main.step_s
            )));
        }
    }
    Ok(())
}
