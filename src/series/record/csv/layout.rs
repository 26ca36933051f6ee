//! How a table is laid out: what divides fields, which lines come first, where its times are.

use super::date;
use super::mark;
use super::text::{Encoding, decode_field, field_end, has_bare_returns, is_empty_line, trim_field};
use crate::series::error::SeriesError;
use crate::series::number::{DecimalMark, number};
use crate::series::record::column::{
    Clash, Column, is_time, name_and_unit, seconds_in, states_no_unit, take_unit_below,
};

/// Lines looked at for the header.
const MOST_LINES: usize = 200;
/// Bytes looked at for it: a million names of some length.
const MOST_BYTES: usize = 64 << 20;

/// Content of a time field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeKind {
    /// A number.
    Number {
        /// Seconds in one unit of the number.
        factor: f64,
    },
    /// Date and time.
    Date {
        /// Date and time of the first row, s since 1970.
        epoch_s: f64,
    },
    /// Date or time of day; the next field contains the second of them.
    DateBeside {
        /// Date and time of the first row, s since 1970.
        epoch_s: f64,
    },
    /// Time of day.
    OfDay {
        /// Time of day of the first row, s.
        first_s: f64,
    },
}

/// The layout of a table.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Encoding of the text.
    pub encoding: Encoding,
    /// Delimiter of fields.
    pub delimiter: u8,
    /// The mark between the whole part and the fraction of a number.
    pub mark: DecimalMark,
    /// Name and unit of each field.
    pub columns: Vec<Column>,
    /// Field with the time, and the content of this field.
    pub time: Option<(usize, TimeKind)>,
    /// Whether the unit of time is stated.
    pub unit_stated: bool,
    /// Half of the last digit of the written times, s.
    pub rounding_s: f64,
    /// First byte of the first row.
    pub start: usize,
}

/// A line of the beginning.
struct Line {
    /// Begin and end of the piece in the file.
    from: usize,
    to: usize,
    text: Vec<u8>,
}

impl Layout {
    /// Detects the layout of a file.
    ///
    /// The first row is the first line with a number (or date) in its first field or its time field. It also has as many fields as the line before
    /// it, which is the header, or a row of units below the header.
    ///
    /// # Errors
    /// No header, a header without rows, times in an unknown unit.
    pub fn detect(bytes: &[u8]) -> Result<Self, SeriesError> {
        let (encoding, begin) = Encoding::detect(bytes);
        if has_bare_returns(bytes) {
            return Err(SeriesError::Line {
                line: 1,
                what: "its lines end with a carriage return alone".into(),
                remedy: "save it with the line ends of Windows (CR LF) or Unix (LF)",
            });
        }
        let lines = first_lines(encoding, bytes, begin);
        let delimiter = delimiter_of(&lines);
        let mark = DecimalMark::from_delimiter(delimiter);
        let fields: Vec<Vec<&[u8]>> = lines.iter().map(|l| split(&l.text, delimiter)).collect();
        let header = header_of(&fields, mark)?;
        let names = fields.get(header).map_or(&[][..], Vec::as_slice);
        let mut columns: Vec<Column> = names
            .iter()
            .map(|f| name_and_unit(&decode_field(f)))
            .collect();
        let units = fields
            .get(header + 1)
            .filter(|f| is_units(f, &columns, mark));
        let row = header + 1 + usize::from(units.is_some());
        // A delimiter at the end of every line is not a column.
        if columns.len() > 1 && columns.last().is_some_and(|c| c.name.is_empty()) {
            let rows = fields.get(row..).unwrap_or_default();
            if rows.iter().all(|r| r.last().is_none_or(|f| f.is_empty())) {
                columns.pop();
            }
        }
        if let Some(units) = units {
            for (c, unit) in columns.iter_mut().zip(units) {
                take_unit_below(c, &decode_field(unit));
            }
        }
        let first = fields.get(row).ok_or(SeriesError::Empty)?;
        let start = lines.get(row).map_or(bytes.len(), |l| l.from);
        let time = time_field(&columns, first, mark);
        let rows = fields.get(row..).unwrap_or_default();
        let mark = mark::find_decimal_mark(rows, mark).map_err(|(at, what)| {
            let from = lines.get(row + at).map_or(0, |l| l.from);
            SeriesError::Line {
                line: encoding.lines(bytes.get(..from).unwrap_or_default()) + 1,
                what,
                remedy: mark::REMEDY,
            }
        })?;
        let mut layout = Self {
            encoding,
            delimiter,
            mark,
            columns,
            time: None,
            unit_stated: false,
            rounding_s: 0.0,
            start,
        };
        if let Some(at) = time {
            let rows = fields.get(row..).unwrap_or_default();
            layout.set_time(at, rows)?;
        }
        Ok(layout)
    }

    /// Returns whether this field is a time and not a channel: the time, or the part of it in the next field.
    pub fn is_of_time(&self, field: usize) -> bool {
        match self.time {
            Some((at, TimeKind::DateBeside { .. })) => field == at || field == at + 1,
            Some((at, _)) => field == at,
            None => false,
        }
    }

    /// Returns whether rows have times and not names of runs: there is a column of time, and no column `run`.
    pub fn is_record(&self) -> bool {
        self.time.is_some() && !self.columns.iter().any(|c| c.name == "run")
    }

    fn set_time(&mut self, at: usize, rows: &[Vec<&[u8]>]) -> Result<(), SeriesError> {
        let column = self.columns.get(at);
        if let Some(clashing) = column.filter(|c| c.clash() == Some(Clash::Size)) {
            return Err(SeriesError::Line {
                line: 1,
                what: format!("time: {}", clashing.clash_words()),
                remedy: "correct the wrong one",
            });
        }
        let unit = column.map_or("", |c| c.unit.as_str());
        let values = || rows.iter().filter_map(|r| r.get(at)).copied();
        let first = values().next().unwrap_or_default();
        let next = rows.first().and_then(|r| r.get(at + 1)).copied();
        let dated = date::seconds(first).map(|epoch_s| TimeKind::Date { epoch_s });
        let dated = dated.or_else(|| {
            let epoch_s = date::parse_date_and_time(first, next?)?;
            Some(TimeKind::DateBeside { epoch_s })
        });
        let dated = dated.or_else(|| {
            let first_s = date::of_day(first)?;
            Some(TimeKind::OfDay { first_s })
        });
        let (kind, digits, factor) = match dated {
            Some(kind) => {
                let both = |r: &Vec<&[u8]>| {
                    let of = |i: usize| r.get(i).map_or(0, |f| date::decimals(f));
                    match kind {
                        TimeKind::DateBeside { .. }
                            if r.get(at).is_some_and(|f| !f.contains(&b':')) =>
                        {
                            of(at + 1)
                        }
                        _ => of(at),
                    }
                };
                (kind, rows.iter().map(both).max().unwrap_or(0), 1.0)
            }
            None => {
                let factor = seconds_in(unit).ok_or_else(|| SeriesError::Line {
                    line: 1,
                    what: format!("`{unit}` is not a unit of time"),
                    remedy: "give times in s or ms",
                })?;
                let digits = values().map(decimals).max().unwrap_or(0);
                (TimeKind::Number { factor }, digits, factor)
            }
        };
        self.unit_stated = !unit.is_empty() || matches!(kind, TimeKind::OfDay { .. });
        self.rounding_s = 0.5 * factor * 10_f64.powi(-(digits.min(300) as i32));
        if matches!(kind, TimeKind::Date { .. } | TimeKind::DateBeside { .. }) {
            // Seconds since 1970 in 64 bits are accurate to a quarter of a microsecond.
            self.rounding_s += 2.5e-7;
        }
        self.time = Some((at, kind));
        Ok(())
    }
}

/// Returns the field of the times. It is the first field with a name of time that contains a time. Otherwise it is a date in the first field,
/// whatever its name. For a date and a time of day in two fields, it is the first of the two.
fn time_field(columns: &[Column], row: &[&[u8]], mark: DecimalMark) -> Option<usize> {
    let field = |i: usize| row.get(i).copied().unwrap_or_default();
    let pair = |i: usize| date::parse_date_and_time(field(i), field(i + 1)).is_some();
    let named = || (0..columns.len()).filter(|i| columns[*i].is_time(*i == 0));
    if let Some(at) = named().find(|i| pair(*i) || i.checked_sub(1).is_some_and(pair)) {
        return if pair(at) {
            Some(at)
        } else {
            at.checked_sub(1)
        };
    }
    let found = named().find(|i| holds_value(field(*i), mark));
    let dated = pair(0) || date::seconds(field(0)).is_some();
    found.or_else(|| named().next()).or(dated.then_some(0))
}

/// Decimals of a number as written: `1.50e-3` has five.
fn decimals(field: &[u8]) -> usize {
    let field = trim_field(field);
    let (digits, power) = match field.iter().position(|b| matches!(b, b'e' | b'E')) {
        Some(n) => {
            let power = field.get(n + 1..).unwrap_or_default();
            let power = std::str::from_utf8(power)
                .ok()
                .and_then(|t| t.parse::<i32>().ok());
            (field.get(..n).unwrap_or_default(), power.unwrap_or(0))
        }
        None => (field, 0),
    };
    let after = digits
        .iter()
        .position(|b| matches!(b, b'.' | b','))
        .map_or(0, |n| digits.len() - n - 1);
    usize::try_from(after as i32 - power).unwrap_or(0)
}

/// The lines of header and first rows, without empty lines and comments.
fn first_lines(encoding: Encoding, bytes: &[u8], begin: usize) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut at = begin;
    while at < bytes.len() && lines.len() < MOST_LINES && at < MOST_BYTES {
        let end = encoding.line_end(bytes, at);
        let text = encoding
            .text(bytes.get(at..end).unwrap_or_default())
            .trim_ascii_end()
            .to_vec();
        if !is_empty_line(&text) {
            lines.push(Line {
                from: at,
                to: end,
                text,
            });
        }
        at = end;
    }
    // The last line may be cut off by the end of the file. It is checked when it is read.
    debug_assert!(lines.iter().all(|l| l.from < l.to));
    lines
}

/// Returns the delimiter that divides most lines, into most parts. If equal, semicolon and tab precede comma, which may be a decimal mark.
fn delimiter_of(lines: &[Line]) -> u8 {
    let score = |d: u8| {
        let counts = lines
            .iter()
            .map(|l| l.text.iter().filter(|b| **b == d).count());
        let with = counts.clone().filter(|n| *n > 0).count();
        let most = counts.max().unwrap_or(0);
        (with, most)
    };
    let (semicolon, tab, comma) = (score(b';'), score(b'\t'), score(b','));
    let half = lines.len().div_ceil(2);
    if semicolon.0 >= half && semicolon.0 >= tab.0 {
        b';'
    } else if tab.0 >= half {
        b'\t'
    } else if comma.0 > 0 || semicolon.0 + tab.0 == 0 {
        b','
    } else if semicolon.0 >= tab.0 {
        b';'
    } else {
        b'\t'
    }
}

fn split(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
    let mut out = Vec::new();
    let mut at = 0;
    loop {
        let rest = line.get(at..).unwrap_or_default();
        let n = field_end(rest, delimiter);
        out.push(trim_field(rest.get(..n).unwrap_or_default()));
        at += n + 1;
        if rest.get(n) != Some(&delimiter) {
            return out;
        }
    }
}

/// Returns whether a field holds a number or a date.
fn holds_value(field: &[u8], mark: DecimalMark) -> bool {
    number(field, mark).is_some_and(f64::is_finite) || is_moment(field)
}

/// Returns whether a field holds a date and time, or a time of day.
fn is_moment(field: &[u8]) -> bool {
    date::seconds(field).is_some() || date::of_day(field).is_some()
}

/// The line that names the columns: of the lines before the first row, the first with as many fields as the row.
fn header_of(fields: &[Vec<&[u8]>], mark: DecimalMark) -> Result<usize, SeriesError> {
    let values = |f: &Vec<&[u8]>| f.iter().filter(|f| holds_value(f, mark)).count();
    let Some(first) = fields.first() else {
        return Err(SeriesError::Line {
            line: 1,
            what: "the file is empty".into(),
            remedy: "give a header line and rows",
        });
    };
    let named = |f: &[&[u8]]| {
        f.iter().enumerate().any(|(i, n)| {
            is_time(&name_and_unit(&decode_field(n)).name, i == 0)
                || decode_field(n).eq_ignore_ascii_case("run")
        })
    };
    // Names may be numbers (`time,14,15`). A line with a column of time is the header if the next line has about as many fields.
    let followed = fields.windows(2).position(|w| match w {
        [a, b] => a.len() > 1 && named(a) && a.len().abs_diff(b.len()) <= 1,
        _ => false,
    });
    if let Some(header) = followed {
        return Ok(header);
    }
    let plain = first.len() > 1 && values(first) == 0;
    if plain && fields.get(1).is_some_and(|s| s.len() == first.len()) {
        return Ok(0);
    }
    let row = fields
        .iter()
        .position(|f| f.len() > 1 && 2 * values(f) > f.len())
        .or_else(|| fields.iter().position(|f| f.len() == 1 && values(f) == 1));
    let Some(row) = row else {
        return if fields.len() == 1 || first.len() == 1 {
            Err(SeriesError::Empty)
        } else {
            Ok(0)
        };
    };
    if named(first) {
        return Ok(0);
    }
    let n = fields.get(row).map_or(0, Vec::len);
    (0..row)
        .find(|i| {
            fields
                .get(*i)
                .is_some_and(|f| f.len() == n && values(f) == 0)
        })
        .ok_or_else(|| SeriesError::Line {
            line: 1,
            what: "no line names the columns".into(),
            remedy: "begin with a header line: `time` and one name for each channel",
        })
}

/// Whether these fields are a row of units below a header. There are as many fields as columns, none is a number, and some contain text. If a column
/// `run` exists, a name in it makes the row a run.
pub fn is_units(fields: &[&[u8]], columns: &[Column], mark: DecimalMark) -> bool {
    let word = |f: &[u8]| !f.is_empty() && number(f, mark).is_none() && !is_moment(f);
    let states_none = |f: &[u8]| states_no_unit(&decode_field(f));
    let of_time = |f: &[u8]| {
        let unit = decode_field(f);
        let unit = unit.trim_matches(['[', ']', '(', ')']);
        !unit.is_empty() && seconds_in(unit).is_some()
    };
    if fields.len() != columns.len() || !fields.iter().all(|f| f.is_empty() || word(f)) {
        return false;
    }
    if let Some(run) = columns.iter().position(Column::is_run) {
        let mut others = fields.iter().enumerate().filter(|(at, _)| *at != run);
        return fields.get(run).is_some_and(|f| states_none(f)) && others.any(|(_, f)| word(f));
    }
    // A row of text contains units only if its first field is empty or `-`, or if any field is a unit of time.
    fields.iter().any(|f| word(f))
        && (fields.first().is_some_and(|f| states_none(f)) || fields.iter().any(|f| of_time(f)))
}
