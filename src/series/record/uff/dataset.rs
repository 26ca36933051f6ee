//! One data set 58: its head, and where its numbers are.

use super::fault::read_error;
use crate::series::error::SeriesError;
use crate::series::record::column::{Column, seconds_in};
use std::collections::BTreeSet;

/// Lines of text before the numbers.
const HEAD: usize = 11;
/// Code of time among the types of abscissa.
const TIME: i64 = 17;
/// Codes of a general response and of a time response among the types of function.
const RESPONSES: [i64; 2] = [0, 1];

/// Numbers in the stored form of the file.
#[derive(Clone, Copy, Debug)]
pub struct Binary {
    at: usize,
    double: bool,
    big: bool,
}

impl Binary {
    /// Returns number `i` of the data set.
    pub fn value(&self, file: &[u8], i: usize) -> f64 {
        let size = if self.double { 8 } else { 4 };
        match file.get(self.at + i * size..self.at + (i + 1) * size) {
            Some(&[a, b, c, d]) if self.big => f64::from(f32::from_be_bytes([a, b, c, d])),
            Some(&[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            Some(&[a, b, c, d, e, f, g, h]) if self.big => {
                f64::from_be_bytes([a, b, c, d, e, f, g, h])
            }
            Some(&[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        }
    }
}

/// The numbers of a data set.
#[derive(Clone, Debug)]
pub enum Samples {
    /// Text, read.
    Text(Vec<f64>),
    /// In the file.
    Binary(Binary),
}

/// A time history on even steps.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Name and unit.
    pub column: Column,
    /// Unit as the file states it.
    unit: String,
    /// Texts that may be the name: the first line of the head, the label of the numbers, grid and direction.
    titles: [String; 3],
    /// Name that several data sets have. [`Self::column`] adds a number to it.
    pub twice: Option<String>,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Time between samples, s.
    pub step_s: f64,
    /// Whether the file states the unit of its times.
    pub unit_stated: bool,
    /// Number of samples.
    pub samples: usize,
    /// Samples of the time history.
    pub data: Samples,
}

/// Walks through the lines of a file.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|r| !r.is_empty())?;
        let n = memchr::memchr(b'\n', rest);
        self.at += n.map_or(rest.len(), |n| n + 1);
        let line = rest.get(..n.unwrap_or(rest.len()))?;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

/// Returns the time histories of a file. Other data sets are ignored.
///
/// # Errors
/// A file that is cut off, time histories on uneven steps or of complex numbers.
pub fn datasets(bytes: &[u8]) -> Result<Vec<Dataset>, SeriesError> {
    let mut lines = Lines { bytes, at: 0 };
    let mut out: Vec<Dataset> = Vec::new();
    while let Some(line) = lines.next() {
        if line.trim_ascii() != b"-1" {
            continue;
        }
        let Some(kind) = lines.next() else { break };
        let word = text(kind);
        let mut words = word.split_whitespace();
        let number = words.next().unwrap_or_default();
        if number == "58" || number == "58b" {
            let layout: Vec<i64> = words.map_while(|w| w.parse().ok()).collect();
            let binary = number.ends_with('b').then_some(layout);
            if let Some(set) = history(&mut lines, binary.as_deref(), out.len())? {
                out.push(set);
            }
        }
        // Skip the lines up to the end of this data set.
        if !lines.by_ref().any(|l| l.trim_ascii() == b"-1") {
            return Err(read_error("the file is cut off: a data set has no end"));
        }
    }
    // Programs put the channel name in different title lines. Take the first title that distinguishes most channels, and add a number to a name that
    // occurs twice.
    let names: [Vec<&str>; 3] =
        [0, 1, 2].map(|t| out.iter().map(|d| d.titles[t].as_str()).collect());
    let distinct = |names: &Vec<&str>| match names.contains(&"") {
        true => 0,
        false => names.iter().collect::<BTreeSet<_>>().len(),
    };
    let most = (0..2).max_by_key(|t| (distinct(&names[*t]), 1 - t));
    let title = (0..3)
        .find(|t| distinct(&names[*t]) == out.len())
        .or(most.filter(|t| distinct(&names[*t]) > 1));
    let title = names[title.unwrap_or(0)].clone();
    let is_twice = |name: &str| title.iter().filter(|n| **n == name).count() > 1;
    let names: Vec<(String, bool)> = title
        .iter()
        .map(|n| ((*n).to_owned(), is_twice(n)))
        .collect();
    for (i, (d, (name, twice))) in out.iter_mut().zip(names).enumerate() {
        let column = match twice {
            true => format!("{name}#{}", i + 1),
            false => name.clone(),
        };
        d.column = Column::of_channel(&column, &d.unit);
        d.twice = twice.then_some(name);
    }
    Ok(out)
}

fn text(line: &[u8]) -> String {
    match std::str::from_utf8(line) {
        Ok(t) => t.to_owned(),
        Err(_) => line.iter().map(|b| char::from(*b)).collect(),
    }
}

/// The history whose head begins at the next line; `None` where it is no time history.
fn history(
    lines: &mut Lines,
    binary: Option<&[i64]>,
    before: usize,
) -> Result<Option<Dataset>, SeriesError> {
    let head: Vec<String> = lines.by_ref().take(HEAD).map(text).collect();
    let field = |line: usize, from: usize, to: usize| -> String {
        let l = head.get(line).map(String::as_str).unwrap_or_default();
        l.chars()
            .skip(from)
            .take(to - from)
            .collect::<String>()
            .trim()
            .to_owned()
    };
    let whole = |line, from, to| field(line, from, to).parse::<i64>().ok();
    let real = |line, from, to| {
        field(line, from, to)
            .replace(['D', 'd'], "E")
            .parse::<f64>()
            .ok()
    };
    let bytes_of_data = binary.map(|l| l.get(3).copied().unwrap_or(0).max(0) as usize);
    let at = lines.at;
    if let Some(n) = bytes_of_data {
        lines.at = at.saturating_add(n);
        if lines.at > lines.bytes.len() {
            return Err(read_error("the file is cut off"));
        }
    }
    let function = whole(5, 0, 5).unwrap_or(-1);
    if !RESPONSES.contains(&function) || whole(7, 0, 10) != Some(TIME) {
        return Ok(None);
    }
    let bad = |what: &str| read_error(format!("data set {}: {what}", before + 1));
    let double = match whole(6, 0, 10) {
        Some(2) => false,
        Some(4) => true,
        _ => return Err(bad("its numbers are not real")),
    };
    let samples = whole(6, 10, 20).and_then(|n| usize::try_from(n).ok());
    let samples = samples.ok_or_else(|| bad("the number of samples is missing"))?;
    if whole(6, 20, 30) != Some(1) {
        return Err(bad("its steps are uneven"));
    }
    let stated = |t: String| Some(t).filter(|t| !t.is_empty() && !t.eq_ignore_ascii_case("none"));
    let time_unit = stated(field(7, 47, 67)).unwrap_or_default();
    let second = seconds_in(&time_unit).ok_or_else(|| {
        bad(&format!(
            "`{time_unit}` of its abscissa is not a unit of time"
        ))
    })?;
    let start_s = second * real(6, 30, 43).unwrap_or(0.0);
    let step_s = real(6, 43, 56).filter(|s| *s > 0.0);
    let step_s = second * step_s.ok_or_else(|| bad("the time between samples is missing"))?;
    let data = match (binary, bytes_of_data) {
        (Some(layout), Some(n)) => {
            let big = match layout.first() {
                Some(1) => false,
                Some(2) => true,
                _ => return Err(bad("its byte order is not stated")),
            };
            if layout.get(1) != Some(&2) {
                return Err(bad("its numbers are not IEEE 754"));
            }
            let size = if double { 8 } else { 4 };
            if samples.checked_mul(size).is_none_or(|b| b > n) {
                return Err(bad("fewer bytes than samples"));
            }
            Samples::Binary(Binary { at, double, big })
        }
        _ => Samples::Text(
            numbers(lines, samples, double).ok_or_else(|| bad("fewer numbers than samples"))?,
        ),
    };
    let direction = match whole(5, 51, 55) {
        Some(1) => "+X".to_owned(),
        Some(2) => "+Y".to_owned(),
        Some(3) => "+Z".to_owned(),
        Some(-1) => "-X".to_owned(),
        Some(-2) => "-Y".to_owned(),
        Some(-3) => "-Z".to_owned(),
        other => other.unwrap_or(0).to_string(),
    };
    let titles = [
        stated(field(0, 0, 80)).unwrap_or_default(),
        stated(field(8, 26, 46)).unwrap_or_default(),
        format!("{}:{direction}", field(5, 41, 51)),
    ];
    Ok(Some(Dataset {
        column: Column::of_channel("", ""),
        unit: stated(field(8, 47, 67)).unwrap_or_default(),
        titles,
        twice: None,
        start_s,
        step_s,
        unit_stated: !time_unit.is_empty(),
        samples,
        data,
    }))
}

/// Numbers in fields of 13 (single) or 20 characters (double).
fn numbers(lines: &mut Lines, samples: usize, double: bool) -> Option<Vec<f64>> {
    let width = if double { 20 } else { 13 };
    let mut out = Vec::new();
    while out.len() < samples {
        let begin = lines.at;
        let line = lines.next()?;
        if line.trim_ascii() == b"-1" {
            lines.at = begin;
            return None;
        }
        for field in line
            .chunks(width)
            .map(<[u8]>::trim_ascii)
            .filter(|f| !f.is_empty())
        {
            out.push(
                std::str::from_utf8(field)
                    .ok()?
                    .replace(['D', 'd'], "E")
                    .parse()
                    .ok()?,
            );
        }
    }
    out.truncate(samples);
    Some(out)
}
