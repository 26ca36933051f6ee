//! A record from the bytes of a CSV file.

use super::channels::{Channel, Channels, SeriesError};
use super::number::{DecimalMark, number};

/// Largest relative departure of a time step from the median that still counts as even (clock jitter of printed times).
const STEP_TOLERANCE: f64 = 0.02;
/// Largest relative departure of the time column's rate from the declared one.
const RATE_TOLERANCE: f64 = 1e-3;

/// The record in a table with one header line: a column a channel, a row a sample.
///
/// A column `t` or `time` (s) gives the sample rate; without it `declared_hz` does. Comma, semicolon and tab separate (beside the
/// last two a number may have a decimal comma); a header
/// `a_body [m/s2]` or `a_body (m/s2)` carries a unit. An empty field, `NaN` or `NA` is a missing sample (NaN).
///
/// # Errors
/// [`SeriesError`] naming the line: ragged rows, text where a number belongs, uneven time steps, a rate other than the declared one.
pub fn read_csv(bytes: &[u8], declared_hz: Option<f64>) -> Result<Channels, SeriesError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut lines = bytes
        .split(|&b| b == b'\n')
        .enumerate()
        .map(|(i, l)| (i + 1, trim(l)))
        .filter(|(_, l)| !l.is_empty());
    let (_, header) = lines.next().ok_or(SeriesError::Line {
        line: 1,
        what: "the file is empty".into(),
        remedy: "give a header line and rows",
    })?;
    let separator = [b';', b'\t', b',']
        .into_iter()
        .find(|s| header.contains(s))
        .unwrap_or(b',');
    let mark = DecimalMark::beside(separator);
    let names: Vec<(String, String)> = header
        .split(|&b| b == separator)
        .map(name_and_unit)
        .collect();
    let mut columns: Vec<Vec<f64>> = names
        .iter()
        .map(|_| Vec::with_capacity(bytes.len() / header.len().max(1)))
        .collect();
    let mut line_numbers = Vec::new();
    for (line, text) in lines {
        let mut n = 0;
        for field in text.split(|&b| b == separator) {
            let Some(column) = columns.get_mut(n) else {
                n += 1;
                continue;
            };
            column.push(number(field, mark).ok_or_else(|| SeriesError::Line {
                line,
                what: format!(
                    "`{}` in column `{}` is not a number",
                    String::from_utf8_lossy(field),
                    names[n].0
                ),
                remedy: "write a number with a decimal point, or leave the field empty",
            })?);
            n += 1;
        }
        if n != names.len() {
            return Err(SeriesError::Line {
                line,
                what: format!("{n} fields, the header has {}", names.len()),
                remedy: "channels of different length do not fit one table: cut or resample them first",
            });
        }
        line_numbers.push(line);
    }
    let time_at = names
        .iter()
        .position(|(n, _)| matches!(n.to_ascii_lowercase().as_str(), "t" | "time"));
    let (rate_hz, start_s) = match time_at {
        Some(i) => rate_of(&columns[i], &line_numbers, declared_hz)?,
        None => (declared_hz.ok_or(SeriesError::NoRate)?, 0.0),
    };
    let list = names
        .into_iter()
        .zip(columns)
        .enumerate()
        .filter(|(i, _)| Some(*i) != time_at)
        .map(|(_, ((name, unit), samples))| Channel {
            name,
            unit,
            samples,
        })
        .collect();
    Ok(Channels {
        start_s,
        ..Channels::from_list(rate_hz, list)?
    })
}

/// Rate and first time of a time column, `lines` its lines.
pub(super) fn rate_of(
    t: &[f64],
    lines: &[usize],
    declared_hz: Option<f64>,
) -> Result<(f64, f64), SeriesError> {
    let (Some(&first), Some(&last)) = (t.first(), t.last()) else {
        return Ok((declared_hz.ok_or(SeriesError::NoRate)?, 0.0));
    };
    if t.len() < 2 {
        return Ok((declared_hz.ok_or(SeriesError::NoRate)?, first));
    }
    let mut steps: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    // Printed times carry a rounding error of half their last digit; a tenth of a step is far above it and below a lost sample.
    let allowed = median.abs() * if median > 0.0 { 0.5 } else { STEP_TOLERANCE };
    let uneven = t
        .windows(2)
        .position(|w| !((w[1] - w[0] - median).abs() <= allowed) || !(median > 0.0));
    let whole = (last - first) / (t.len() - 1) as f64;
    if let Some(i) =
        uneven.or_else(|| ((whole - median).abs() > STEP_TOLERANCE * median).then_some(0))
    {
        return Err(SeriesError::UnevenTime {
            line: lines.get(i + 1).copied().unwrap_or(0),
            found_s: t[i + 1] - t[i],
            expected_s: median,
        });
    }
    let found_hz = 1.0 / whole;
    match declared_hz {
        Some(declared) if (found_hz / declared - 1.0).abs() > RATE_TOLERANCE => {
            Err(SeriesError::Rate {
                found_hz,
                declared_hz: declared,
            })
        }
        Some(declared) => Ok((declared, first)),
        None => Ok((found_hz, first)),
    }
}

/// Name and unit of a header.
pub(super) fn name_and_unit(field: &[u8]) -> (String, String) {
    let text = String::from_utf8_lossy(trim(field))
        .trim_matches('"')
        .to_owned();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let (Some(a), true) = (text.find(open), text.ends_with(close)) {
            return (
                text[..a].trim().to_owned(),
                text[a + 1..text.len() - 1].trim().to_owned(),
            );
        }
    }
    (text, String::new())
}

fn trim(bytes: &[u8]) -> &[u8] {
    bytes.trim_ascii()
}
