//! Spreadsheets as tables: the first sheet of an XLSX file becomes CSV text, so that every reader of tables accepts it.
//!
//! Cells come one after the other and are kept only as text. An address far to the right or below costs only its separators, and these are bounded.
//! The unpacked size that the archive states is bounded before anything is unpacked.

/// Bytes that an archive may unpack to.
#[cfg(feature = "xlsx")]
const MOST_UNPACKED: u64 = 1 << 30;
/// Largest number of bytes of the text of a sheet.
#[cfg(feature = "xlsx")]
const MOST_TEXT: usize = 256 << 20;

/// Rows and columns of a sheet. An address beyond them is damaged: an address of many digits wraps in the reader of cells and would change its place.
#[cfg(feature = "xlsx")]
const MOST_CELLS: (u32, u32) = (1 << 20, 1 << 14);

/// Returns whether the bytes begin as an archive, which XLSX is.
pub(crate) fn is_sheet(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Converts the first sheet to CSV, with a line for each row, empty rows included. Each row has as many fields as the first row, in quotes if
/// necessary. A cell with an error such as `#N/A` is blank.
///
/// # Errors
/// Reason why the sheet cannot be read.
#[cfg(feature = "xlsx")]
pub(crate) fn csv_of_sheet(bytes: &[u8]) -> Result<String, String> {
    use calamine::{DataRef, Reader, Xlsx, XlsxError};
    let unpacked = unpacked_size(bytes).ok_or("an archive whose list of contents is damaged")?;
    if unpacked > MOST_UNPACKED {
        return Err(format!("a spreadsheet of {} MB, unpacked", unpacked >> 20));
    }
    let fail = |e: XlsxError| format!("a spreadsheet that cannot be read ({e})");
    let mut book = Xlsx::new(std::io::Cursor::new(bytes)).map_err(fail)?;
    let names = book.sheet_names();
    let first = names.first().ok_or("a spreadsheet without a sheet")?;
    let mut cells = book.worksheet_cells_reader(first).map_err(fail)?;
    let mut lines = Lines::default();
    while let Some(cell) = cells.next_cell().map_err(fail)? {
        let text = match cell.get_value() {
            DataRef::Int(n) => n.to_string(),
            DataRef::Float(x) => x.to_string(),
            DataRef::String(s) => s.clone(),
            DataRef::SharedString(s) => (*s).to_owned(),
            DataRef::Bool(b) => b.to_string(),
            DataRef::DateTime(t) => moment(t),
            DataRef::DateTimeIso(t) | DataRef::DurationIso(t) => t.clone(),
            DataRef::Error(_) | DataRef::Empty => continue,
        };
        lines.add(cell.get_position(), &text)?;
    }
    lines.end(0)?;
    Ok(lines.text)
}

/// Returns the names of the sheets of a spreadsheet; an empty list for another file.
#[cfg(feature = "xlsx")]
pub(crate) fn sheet_names(bytes: &[u8]) -> Vec<String> {
    use calamine::{Reader, Xlsx};
    if !is_sheet(bytes) || unpacked_size(bytes).is_none_or(|n| n > MOST_UNPACKED) {
        return Vec::new();
    }
    Xlsx::new(std::io::Cursor::new(bytes)).map_or_else(|_| Vec::new(), |b| b.sheet_names())
}

/// Returns an empty list, because this build reads no spreadsheets.
#[cfg(not(feature = "xlsx"))]
pub(crate) fn sheet_names(_: &[u8]) -> Vec<String> {
    Vec::new()
}

/// Returns a cell formatted as a date or a time as text: date and time of day. The text is the time of day alone if the cell contains less than two
/// days. A number of days would be read as a number in the unit of its column.
#[cfg(feature = "xlsx")]
fn moment(cell: &calamine::ExcelDateTime) -> String {
    use calamine::{ExcelDateTime, ExcelDateTimeType::DateTime};
    const MICROSECONDS: f64 = 86_400e6;
    /// Days below which programs show the time of day alone.
    const OF_DAY: f64 = 2.0;
    let days = cell.as_f64();
    let (whole, of_day) = (days.floor(), days - days.floor());
    let us = (of_day * MICROSECONDS).round();
    let (whole, us) = match us < MICROSECONDS {
        true => (whole, us as u64),
        false => (whole + 1.0, 0),
    };
    let (seconds, us) = (us / 1_000_000, us % 1_000_000);
    let (hour, minute, second) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    let time = format!("{hour:02}:{minute:02}:{second:02}.{us:06}");
    if cell.is_duration() || (0.0..OF_DAY).contains(&days) {
        return time;
    }
    let is_from_1904 = *cell == ExcelDateTime::new(days, DateTime, true);
    let at_noon = ExcelDateTime::new(whole + 0.5, DateTime, is_from_1904);
    let (year, month, day, ..) = at_noon.to_ymd_hms_milli();
    format!("{year:04}-{month:02}-{day:02} {time}")
}

/// Returns the error that this build cannot read a spreadsheet.
#[cfg(not(feature = "xlsx"))]
pub(crate) fn csv_of_sheet(_: &[u8]) -> Result<String, String> {
    Err("a spreadsheet, which this build cannot read (feature `xlsx`)".to_owned())
}

/// CSV text, written cell by cell.
#[cfg(feature = "xlsx")]
#[derive(Default)]
struct Lines {
    text: String,
    /// Row and column of the last cell.
    last: Option<(u32, u32)>,
    /// Column of the last cell of the first row that has any.
    width: Option<u32>,
}

#[cfg(feature = "xlsx")]
impl Lines {
    fn add(&mut self, (row, column): (u32, u32), text: &str) -> Result<(), String> {
        if row >= MOST_CELLS.0 || column >= MOST_CELLS.1 {
            return Err("a spreadsheet with a cell beyond the last row or column".to_owned());
        }
        let before = match self.last {
            Some(last) if last >= (row, column) => {
                return Err("a spreadsheet whose cells are out of order".to_owned());
            }
            Some((r, c)) if r == row => c,
            Some((r, _)) => {
                self.end(row - r)?;
                0
            }
            None => {
                self.push('\n', row)?;
                0
            }
        };
        self.push(',', column - before)?;
        self.last = Some((row, column));
        if text.contains([',', ';', '\t', '"', '\n', '\r', '#']) {
            self.text.push('"');
            self.text
                .push_str(&text.replace('"', "\"\"").replace(['\n', '\r'], " "));
            self.text.push('"');
        } else {
            self.text.push_str(text);
        }
        Ok(())
    }

    /// Ends a row that has cells, and leaves `rows - 1` empty ones.
    fn end(&mut self, rows: u32) -> Result<(), String> {
        let Some((_, column)) = self.last else {
            return Ok(());
        };
        let width = *self.width.get_or_insert(column);
        self.push(',', width.saturating_sub(column))?;
        self.push('\n', rows.max(1))
    }

    fn push(&mut self, c: char, n: u32) -> Result<(), String> {
        if self.text.len() + n as usize > MOST_TEXT {
            return Err(format!("a sheet of more than {} MB", MOST_TEXT >> 20));
        }
        self.text.extend(std::iter::repeat_n(c, n as usize));
        Ok(())
    }
}

/// Returns the number of bytes that the members of an archive unpack to, as stated in its list at the end.
///
/// # Reference
/// PKWARE, APPNOTE.TXT - .ZIP File Format Specification, 4.3.12 and 4.3.16.
#[cfg(feature = "xlsx")]
fn unpacked_size(bytes: &[u8]) -> Option<u64> {
    const END: &[u8] = b"PK\x05\x06";
    const MEMBER: &[u8] = b"PK\x01\x02";
    let word = |at: usize| {
        let b: [u8; 4] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(u32::from_le_bytes(b))
    };
    let half = |at: usize| {
        let b: [u8; 2] = bytes.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(u16::from_le_bytes(b))
    };
    let end = memchr::memmem::rfind(bytes, END)?;
    let (members, mut at) = (half(end + 10)?, word(end + 16)? as usize);
    let mut sum = 0;
    for _ in 0..members {
        if !bytes.get(at..)?.starts_with(MEMBER) {
            return None;
        }
        sum += u64::from(word(at + 24)?);
        let more: usize = [28, 30, 32]
            .iter()
            .map(|o| half(at + o).map(usize::from))
            .sum::<Option<usize>>()?;
        at += 46 + more;
    }
    Some(sum)
}

#[cfg(all(test, feature = "xlsx"))]
mod tests {
    use super::*;

    #[test]
    fn cells_of_dates_and_times_are_text() {
        use calamine::{ExcelDateTime, ExcelDateTimeType as Kind};
        // 1 May 2026 is day 46,143 of spreadsheets; 12:00:00.25 is .500002893518.. of a day.
        let quarter = 46_143.5 + 0.25 / 86_400.0;
        for (days, kind, expected) in [
            (quarter, Kind::DateTime, "2026-05-01 12:00:00.250000"),
            (46_143.0, Kind::DateTime, "2026-05-01 00:00:00.000000"),
            (0.999_988_425_926, Kind::DateTime, "23:59:59.000000"),
            (1.0, Kind::DateTime, "00:00:00.000000"),
            (0.5, Kind::TimeDelta, "12:00:00.000000"),
        ] {
            assert_eq!(moment(&ExcelDateTime::new(days, kind, false)), expected);
        }
        // Workbooks that count days from 1904 have the same day 1,462 days earlier.
        let from_1904 = ExcelDateTime::new(46_143.0 - 1462.0, Kind::DateTime, true);
        assert_eq!(moment(&from_1904), "2026-05-01 00:00:00.000000");
    }

    #[test]
    fn cells_beyond_the_last_row_or_column_are_refused() {
        let mut lines = Lines::default();
        assert!(lines.add((0, 0), "run").is_ok());
        assert!(lines.add((1, (1 << 14) - 1), "1").is_ok());
        for beyond in [(1 << 20, 0), (2, 1 << 14), (u32::MAX, u32::MAX)] {
            assert!(lines.add(beyond, "1").is_err(), "{beyond:?}");
        }
    }
}
