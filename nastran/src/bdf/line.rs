//! Physical lines of a text file, with any kind of line ending.

/// A line without its ending.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    /// Bytes, without the line ending.
    pub text: &'a [u8],
    /// Offset of the first byte.
    pub start: usize,
    /// Offset after the line ending.
    pub end: usize,
    /// Number, from 1 in the file.
    pub number: u32,
}

/// Iterates over lines that end in LF, CR LF or CR.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
    next_number: u32,
}

impl<'a> Lines<'a> {
    /// Iterates over the lines of `bytes[start..end]`; the first line has the given number.
    pub(super) fn new(bytes: &'a [u8], start: usize, end: usize, number: u32) -> Self {
        let end = end.min(bytes.len());
        Lines {
            bytes,
            at: start.min(end),
            end,
            next_number: number,
        }
    }

    /// Returns the offset of the next line.
    pub(super) fn offset(&self) -> usize {
        self.at
    }

    /// Returns the number of the next line.
    pub(super) fn number(&self) -> u32 {
        self.next_number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    #[inline]
    fn next(&mut self) -> Option<Line<'a>> {
        let rest = self.bytes.get(self.at..self.end)?;
        if rest.is_empty() {
            return None;
        }
        let start = self.at;
        let (length, ending) = match memchr::memchr2(b'\n', b'\r', rest) {
            None => (rest.len(), 0),
            Some(i) if rest.get(i) == Some(&b'\r') && rest.get(i + 1) == Some(&b'\n') => (i, 2),
            Some(i) => (i, 1),
        };
        self.at = start + length + ending;
        let number = self.next_number;
        self.next_number = number.saturating_add(1);
        Some(Line {
            text: rest.get(..length).unwrap_or(rest),
            start,
            end: self.at,
            number,
        })
    }
}

/// Returns whether a byte counts as blank: space, tab and control characters.
#[inline]
pub(super) fn is_blank(c: u8) -> bool {
    c <= b' '
}

/// Returns the slice without blanks at its ends.
#[inline]
pub(super) fn trim(mut s: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = s {
        if !is_blank(*first) {
            break;
        }
        s = rest;
    }
    while let [rest @ .., last] = s {
        if !is_blank(*last) {
            break;
        }
        s = rest;
    }
    s
}

/// Returns the line up to a `$` comment.
#[inline]
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    match memchr::memchr(b'$', line) {
        Some(i) => line.get(..i).unwrap_or(line),
        None => line,
    }
}

/// Returns the slice as text; bytes that are not UTF-8 are read as Latin-1.
pub(super) fn text_of(s: &[u8]) -> String {
    match std::str::from_utf8(s) {
        Ok(t) => t.to_owned(),
        Err(_) => s.iter().map(|&c| char::from(c)).collect(),
    }
}
