//! A long record in CSV, read piece by piece.

use crate::app::fault::Fault;
use crate::series::number::{DecimalMark, number, short_number};

/// Header of a record and where its rows begin.
pub(super) struct Layout {
    /// Column names but time.
    pub names: Vec<String>,
    /// Which column is time.
    pub time: usize,
    /// Delimiter.
    pub delimiter: u8,
    /// First byte of the first row.
    pub start: usize,
}

/// Names of a time column.
const TIME: [&str; 4] = ["time", "t", "t_s", "time_s"];

/// Whether the bytes are a table with a time column and no `run` column.
pub(super) fn is_record(bytes: &[u8]) -> bool {
    let names = header(bytes).1;
    names.iter().any(|n| TIME.contains(&n.as_str())) && !names.iter().any(|n| n == "run")
}

/// End of the header line, its fields, the delimiter.
fn header(bytes: &[u8]) -> (usize, Vec<String>, u8) {
    let mut at = if bytes.starts_with(b"\xef\xbb\xbf") {
        3
    } else {
        0
    };
    while let Some(rest) = bytes.get(at..) {
        let n = rest
            .iter()
            .take(1 << 16)
            .position(|b| *b == b'\n')
            .map_or(rest.len().min(1 << 16), |n| n + 1);
        let line = String::from_utf8_lossy(rest.get(..n).unwrap_or_default()).into_owned();
        at += n;
        if n == 0 || !(line.trim().is_empty() || line.starts_with('#')) {
            let delimiter = [b',', b';', b'\t']
                .into_iter()
                .max_by_key(|d| (line.bytes().filter(|b| b == d).count(), *d == b','))
                .unwrap_or(b',');
            let names = line
                .trim()
                .split(delimiter as char)
                .map(|f| f.trim().trim_matches('"').to_owned())
                .collect();
            return (at, names, delimiter);
        }
    }
    (at, Vec::new(), b',')
}

/// The layout of a record.
pub(super) fn layout(bytes: &[u8]) -> Option<Layout> {
    let (start, all, delimiter) = header(bytes);
    let time = all.iter().position(|n| TIME.contains(&n.as_str()))?;
    let names = all
        .into_iter()
        .enumerate()
        .filter(|(i, _)| *i != time)
        .map(|(_, n)| n)
        .collect();
    Some(Layout {
        names,
        time,
        delimiter,
        start,
    })
}

/// Ends of pieces of about `size` bytes that end with whole lines.
pub(super) fn pieces(bytes: &[u8], start: usize, size: usize) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut from = start;
    while from < bytes.len() {
        let target = (from + size).min(bytes.len());
        let rest = bytes.get(target..).unwrap_or_default();
        let to = rest
            .iter()
            .position(|b| *b == b'\n')
            .map_or(bytes.len(), |n| target + n + 1);
        out.push((from, to));
        from = to;
    }
    out
}

/// Times and numbers of a piece, numbers in the order of `columns` (`None`: NaN). Blank fields are NaN.
///
/// # Errors
/// The first field that is no number, or a row of another length, with its line in the file.
pub(super) fn read_piece(
    file: &str,
    bytes: &[u8],
    piece: (usize, usize),
    l: &Layout,
    columns: &[Option<usize>],
    times: &mut Vec<f64>,
    out: &mut Vec<f64>,
) -> Result<(), Fault> {
    let n = l.names.len() + 1;
    let mark = DecimalMark::beside(l.delimiter);
    let mut row = vec![f64::NAN; n];
    let text = bytes.get(piece.0..piece.1).unwrap_or_default();
    let line_of = |within: usize| {
        1 + bytes
            .get(..piece.0 + within)
            .unwrap_or_default()
            .iter()
            .filter(|b| **b == b'\n')
            .count() as u32
    };
    // Columns count without time.
    let picked: Vec<Option<usize>> = columns
        .iter()
        .map(|c| c.map(|c| if c >= l.time { c + 1 } else { c }))
        .collect();
    let mut at = 0;
    while at < text.len() {
        let here = at;
        if let Some(end) = blank_or_comment(text, at) {
            at = end;
            continue;
        }
        let mut count = 0;
        loop {
            let rest = text.get(at..).unwrap_or_default();
            let (value, used) = match field(rest, l.delimiter, mark) {
                Ok(found) => found,
                Err(shown) => {
                    return Err(Fault::at(
                        file,
                        line_of(here),
                        "field",
                        format!("`{shown}` is no number"),
                        "write numbers with a decimal point",
                    ));
                }
            };
            if let Some(v) = row.get_mut(count) {
                *v = value;
            }
            count += 1;
            at += used;
            let next = text.get(at);
            at += 1;
            if next != Some(&l.delimiter) {
                break;
            }
        }
        if count != n {
            let wrong = format!("{count} fields, the header has {n}");
            return Err(Fault::at(
                file,
                line_of(here),
                "row",
                wrong,
                "give every row as many fields as the header",
            ));
        }
        times.push(row[l.time]);
        out.extend(picked.iter().map(|c| c.map_or(f64::NAN, |c| row[c])));
    }
    Ok(())
}

/// Where the line that begins at `at` ends, if it holds nothing or a comment.
fn blank_or_comment(text: &[u8], at: usize) -> Option<usize> {
    let rest = text.get(at..)?;
    let first = rest.iter().position(|b| !matches!(b, b' ' | b'\r'));
    match first.and_then(|n| rest.get(n)) {
        Some(b'\n') | None => {}
        Some(b'#') if first == Some(0) => {}
        _ => return None,
    }
    let end = rest.iter().position(|b| *b == b'\n');
    Some(end.map_or(text.len(), |n| at + n + 1))
}

/// Value of the field at the beginning of `rest` and its length up to the delimiter, the end of the line or of the text.
fn field(rest: &[u8], delimiter: u8, mark: DecimalMark) -> Result<(f64, usize), String> {
    let blank = |from: usize| {
        let it = rest.get(from..).unwrap_or_default().iter();
        it.take_while(|b| **b == b' ' || **b == b'\r').count()
    };
    let before = blank(0);
    if let Some((v, n)) = short_number(rest.get(before..).unwrap_or_default(), mark) {
        let used = before + n + blank(before + n);
        match rest.get(used) {
            Some(b) if *b == delimiter || *b == b'\n' => return Ok((v, used)),
            None => return Ok((v, used)),
            _ => {}
        }
    }
    let used = rest
        .iter()
        .position(|b| *b == delimiter || *b == b'\n')
        .unwrap_or(rest.len());
    let text = rest.get(..used).unwrap_or_default();
    let value = number(text, mark)
        .ok_or_else(|| String::from_utf8_lossy(text.trim_ascii()).into_owned())?;
    Ok((value, used))
}
