//! Tables as loggers, measuring programs and spreadsheets write them, read a piece at a time.
//!
//! Fields are separated by comma, semicolon or tab; the last two allow a decimal comma. Text is UTF-8, UTF-16 or an eight-bit code. Supported are
//! lines before the header, a row of units after it, units in the header, and quoted fields. Times are in seconds, in a stated unit, a date and time
//! in one column or in two adjacent columns, or a time of day.

mod date;
mod end;
mod layout;
mod mark;
#[cfg(test)]
mod tests;
mod text;

pub use end::{is_cut, unsure_end};
pub use layout::{Layout, is_units};
pub use text::{has_bare_returns, table_text};

use super::column::Column;
use super::reader::{BLOCK, Block, Bytes, Pick, RecordReader, Sink, Times};
use crate::series::error::SeriesError;
use crate::series::number::{DecimalMark, number, short_number};
use layout::TimeKind;
use text::Encoding;

/// Bytes of a piece.
const PIECE: usize = 4 << 20;

/// A text table that is read as a record.
pub struct Csv {
    bytes: Bytes,
    layout: Layout,
    pieces: Vec<(usize, usize)>,
    columns: Vec<Column>,
    /// Field of each column.
    fields: Vec<usize>,
    /// Begin of the last line, if this line was left out.
    left_out: Option<usize>,
}

impl Csv {
    /// Returns the table in a file.
    ///
    /// # Errors
    /// No header, a header without rows, a time column in a unit that is not a unit of time.
    pub fn new(bytes: Bytes) -> Result<Self, SeriesError> {
        let layout = Layout::detect((*bytes).as_ref())?;
        let left_out = unsure_end((*bytes).as_ref()).filter(|at| *at > layout.start);
        let whole = (*bytes).as_ref();
        let whole = left_out.and_then(|at| whole.get(..at)).unwrap_or(whole);
        let pieces = layout.encoding.pieces(whole, layout.start, PIECE);
        let (fields, columns) = layout
            .columns
            .iter()
            .enumerate()
            .filter(|(i, c)| !layout.is_of_time(*i) && !c.name.is_empty())
            .map(|(i, c)| (i, c.clone()))
            .unzip();
        Ok(Self {
            bytes,
            layout,
            pieces,
            columns,
            fields,
            left_out,
        })
    }

    /// Destinations of the fields: for each field of a row, the indices among the picks.
    fn places(&self, picks: &[Pick]) -> Vec<Vec<usize>> {
        let mut places = vec![Vec::new(); self.layout.columns.len()];
        for (j, pick) in picks.iter().enumerate() {
            let field = match pick {
                Pick::Time => self.layout.time.map(|t| t.0),
                Pick::Column(c) => self.fields.get(*c).copied(),
                Pick::Nothing => None,
            };
            if let Some(list) = field.and_then(|f| places.get_mut(f)) {
                list.push(j);
            }
        }
        places
    }
}

impl RecordReader for Csv {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn times(&self) -> Times {
        match self.layout.time {
            Some((_, kind)) => Times::Stored {
                rounding_s: self.layout.rounding_s,
                epoch_s: match kind {
                    TimeKind::Date { epoch_s } | TimeKind::DateBeside { epoch_s } => Some(epoch_s),
                    TimeKind::Number { .. } | TimeKind::OfDay { .. } => None,
                },
                unit_stated: self.layout.unit_stated,
            },
            None => Times::None { samples: None },
        }
    }

    fn stated_time_unit_s(&self) -> Option<f64> {
        match self.layout.time {
            Some((_, TimeKind::Number { factor })) if self.layout.unit_stated => Some(factor),
            _ => None,
        }
    }

    fn are_times_of_day(&self) -> bool {
        matches!(self.layout.time, Some((_, TimeKind::OfDay { .. })))
    }

    fn left_out(&self) -> Option<usize> {
        let before = (*self.bytes).as_ref().get(..self.left_out?)?;
        Some(self.layout.encoding.lines(before) + 1)
    }

    fn n_pieces(&self) -> usize {
        self.pieces.len()
    }

    fn line(&self, piece: usize, row_in_piece: usize, _row: usize) -> usize {
        let Some(&(from, to)) = self.pieces.get(piece) else {
            return 0;
        };
        let bytes = (*self.bytes).as_ref();
        let encoding = self.layout.encoding;
        let before = encoding.lines(bytes.get(..from).unwrap_or_default());
        let text = encoding.text(bytes.get(from..to).unwrap_or_default());
        let mut rows = 0;
        for (n, line) in text.split(|b| *b == b'\n').enumerate() {
            if !text::is_empty_line(line) {
                if rows == row_in_piece {
                    return before + n + 1;
                }
                rows += 1;
            }
        }
        before + 1
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let Some(&(from, to)) = self.pieces.get(piece) else {
            return Ok(());
        };
        let raw = (*self.bytes).as_ref().get(from..to).unwrap_or_default();
        let text = self.layout.encoding.text(raw);
        let places = self.places(picks);
        // If only the time is picked, the fields after it are skipped.
        let last = match (picks, self.layout.time) {
            ([Pick::Time | Pick::Nothing], Some((field, _))) => field,
            _ => usize::MAX,
        };
        let parser = Parser {
            layout: &self.layout,
            places: &places,
            last,
        };
        let k = picks.len();
        let mut values = Vec::with_capacity(BLOCK * k);
        let (mut at, mut rows, mut first) = (0, 0, 0);
        while at < text.len() {
            let here = at;
            if let Some(next) = text::skip_empty(&text, at) {
                at = next;
                continue;
            }
            let begin = values.len();
            values.resize(begin + k, f64::NAN);
            let slots = values.get_mut(begin..).unwrap_or_default();
            at = parser.row(&text, at, slots).map_err(|(what, remedy)| {
                let bytes = (*self.bytes).as_ref();
                let before = self
                    .layout
                    .encoding
                    .lines(bytes.get(..from).unwrap_or_default());
                let within = Encoding::Bytes.lines(text.get(..here).unwrap_or_default());
                SeriesError::Line {
                    line: before + within + 1,
                    what,
                    remedy,
                }
            })?;
            rows += 1;
            if rows == BLOCK {
                let flow = sink(Block {
                    first,
                    rows,
                    values: &values,
                });
                if flow.is_break() {
                    return Ok(());
                }
                first += rows;
                rows = 0;
                values.clear();
            }
        }
        if rows > 0 {
            let _ = sink(Block {
                first,
                rows,
                values: &values,
            });
        }
        Ok(())
    }
}

/// Seconds from the first row to the date or time of day at the beginning of `rest`, and the length of the field.
fn moment(rest: &[u8], delimiter: u8, kind: TimeKind) -> Result<(f64, usize), CsvRowFault> {
    let used = text::field_end(rest, delimiter);
    let shown = text::trim_field(rest.get(..used).unwrap_or_default());
    let found = match kind {
        TimeKind::Date { epoch_s } => date::seconds(shown).map(|s| s - epoch_s),
        TimeKind::DateBeside { epoch_s } => {
            let next = rest.get(used + 1..).unwrap_or_default();
            let next = next.get(..text::field_end(next, delimiter));
            date::parse_date_and_time(shown, text::trim_field(next.unwrap_or_default()))
                .map(|s| s - epoch_s)
        }
        TimeKind::OfDay { first_s } => date::of_day(shown).map(|s| s - first_s),
        TimeKind::Number { .. } => None,
    };
    match found {
        Some(s) => Ok((s, used)),
        None if shown.is_empty() => Ok((f64::NAN, used)),
        None => Err((
            format!(
                "`{}` is not a date and time",
                String::from_utf8_lossy(shown)
            ),
            "write it as in the first row, such as 2026-05-01 12:00:00.002",
        )),
    }
}

/// Message about a wrong row, and its remedy.
type CsvRowFault = (String, &'static str);

/// Reads rows of one table.
struct Parser<'a> {
    layout: &'a Layout,
    places: &'a [Vec<usize>],
    /// The last field that matters.
    last: usize,
}

impl Parser<'_> {
    /// Reads the row that begins at `at` into `slots`, and returns the beginning of the next line.
    fn row(&self, text: &[u8], mut at: usize, slots: &mut [f64]) -> Result<usize, CsvRowFault> {
        let n = self.layout.columns.len();
        let delimiter = self.layout.delimiter;
        let mut field = 0;
        loop {
            let rest = text.get(at..).unwrap_or_default();
            let wanted = self.places.get(field).filter(|p| !p.is_empty());
            let used = match wanted {
                Some(places) => {
                    let (value, used) = self.value(rest, field)?;
                    for j in places {
                        if let Some(slot) = slots.get_mut(*j) {
                            *slot = value;
                        }
                    }
                    used
                }
                None => text::field_end(rest, delimiter),
            };
            at += used;
            if field == self.last {
                let rest = text.get(at..).unwrap_or_default();
                return Ok(at + memchr::memchr(b'\n', rest).map_or(rest.len(), |n| n + 1));
            }
            field += 1;
            let next = text.get(at);
            at += 1;
            if next != Some(&delimiter) {
                break;
            }
            // A delimiter at the end of every line is not a field.
            if field == n && matches!(text.get(at), None | Some(b'\n' | b'\r')) {
                let rest = text.get(at..).unwrap_or_default();
                at += memchr::memchr(b'\n', rest).map_or(rest.len(), |n| n + 1);
                break;
            }
        }
        if field == n {
            Ok(at)
        } else {
            Err((
                format!("the row has {field} fields, the header has {n}"),
                "give every row as many fields as the header, and check whether the file is cut off",
            ))
        }
    }

    /// Refuses a number in the form of thousands if no row of the beginning determines the decimal mark.
    #[inline(always)]
    fn check_mark(&self, rest: &[u8], used: usize) -> Result<(), CsvRowFault> {
        if self.layout.mark != DecimalMark::CommaOrPoint {
            return Ok(());
        }
        let field = text::trim_field(rest.get(..used).unwrap_or_default());
        match mark::may_be_thousands(field) {
            true => Err((mark::in_words(field), mark::REMEDY)),
            false => Ok(()),
        }
    }

    /// Value of the field at the beginning of `rest`, and its length up to the delimiter or the end of the line.
    fn value(&self, rest: &[u8], field: usize) -> Result<(f64, usize), CsvRowFault> {
        let delimiter = self.layout.delimiter;
        let mark = self.layout.mark;
        let time = self.layout.time.filter(|t| t.0 == field).map(|t| t.1);
        let factor = match time {
            Some(TimeKind::Number { factor }) => factor,
            Some(kind) => return moment(rest, delimiter, kind),
            None => 1.0,
        };
        let before = rest.iter().take_while(|b| **b == b' ').count();
        if let Some((v, n)) = short_number(rest.get(before..).unwrap_or_default(), mark) {
            let mut used = before + n;
            while let Some(b' ' | b'\r') = rest.get(used) {
                used += 1;
            }
            match rest.get(used) {
                None => {
                    self.check_mark(rest, used)?;
                    return Ok((v * factor, used));
                }
                Some(b) if *b == delimiter || *b == b'\n' => {
                    self.check_mark(rest, used)?;
                    return Ok((v * factor, used));
                }
                _ => {}
            }
        }
        let used = text::field_end(rest, delimiter);
        let shown = text::trim_field(rest.get(..used).unwrap_or_default());
        self.check_mark(shown, shown.len())?;
        match number(shown, mark) {
            Some(v) => Ok((v * factor, used)),
            None => {
                let name = self
                    .layout
                    .columns
                    .get(field)
                    .map_or("", |c| c.name.as_str());
                let ambiguous = time.is_some() && date::is_ambiguous(shown);
                let mut shown = String::from_utf8_lossy(shown).into_owned();
                if let Some((end, _)) = shown.char_indices().nth(40) {
                    shown.truncate(end);
                }
                if ambiguous {
                    return Err((
                        format!(
                            "`{shown}` in column `{name}` is a date with an ambiguous order of day and month"
                        ),
                        "write dates as 2026-03-01 10:00:00.002, or give times in seconds",
                    ));
                }
                Err((
                    format!("`{shown}` in column `{name}` is not a number"),
                    "write a number with a decimal point, or leave the field empty",
                ))
            }
        }
    }
}
