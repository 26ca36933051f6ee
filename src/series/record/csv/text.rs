//! Bytes of a table: how they are coded, where lines and fields end.

use std::borrow::Cow;

/// How text is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// A byte a character where it matters here: UTF-8 and eight-bit codes.
    Bytes,
    /// Two bytes, the low one first.
    Utf16Le,
    /// Two bytes, the high one first.
    Utf16Be,
}

impl Encoding {
    /// How these bytes are coded, and where the text begins.
    pub fn of(bytes: &[u8]) -> (Self, usize) {
        match bytes {
            [0xef, 0xbb, 0xbf, ..] => (Self::Bytes, 3),
            [0xff, 0xfe, ..] => (Self::Utf16Le, 2),
            [0xfe, 0xff, ..] => (Self::Utf16Be, 2),
            _ => (Self::Bytes, 0),
        }
    }

    /// Bytes of an end of line.
    pub fn unit(self) -> usize {
        match self {
            Self::Bytes => 1,
            Self::Utf16Le | Self::Utf16Be => 2,
        }
    }

    /// The text as bytes that hold ASCII as such.
    pub fn text(self, raw: &[u8]) -> Cow<'_, [u8]> {
        let unit = match self {
            Self::Bytes => return Cow::Borrowed(raw),
            Self::Utf16Le => u16::from_le_bytes,
            Self::Utf16Be => u16::from_be_bytes,
        };
        let units = raw.chunks_exact(2).map(|b| match b {
            [a, b] => unit([*a, *b]),
            _ => 0,
        });
        let text: String = char::decode_utf16(units)
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        Cow::Owned(text.into_bytes())
    }

    /// Where the line that holds byte `at` ends, its end of line included.
    pub fn line_end(self, bytes: &[u8], at: usize) -> usize {
        let rest = bytes.get(at..).unwrap_or_default();
        let pair = |end: [u8; 2]| {
            rest.chunks_exact(2)
                .position(|b| b == end)
                .map_or(bytes.len(), |n| at + 2 * n + 2)
        };
        match self {
            Self::Bytes => memchr::memchr(b'\n', rest).map_or(bytes.len(), |n| at + n + 1),
            Self::Utf16Le => pair([b'\n', 0]),
            Self::Utf16Be => pair([0, b'\n']),
        }
    }

    /// Ends of lines.
    pub fn lines(self, bytes: &[u8]) -> usize {
        match self {
            Self::Bytes => memchr::memchr_iter(b'\n', bytes).count(),
            Self::Utf16Le => bytes.chunks_exact(2).filter(|b| *b == [b'\n', 0]).count(),
            Self::Utf16Be => bytes.chunks_exact(2).filter(|b| *b == [0, b'\n']).count(),
        }
    }

    /// Pieces of about `size` bytes that end with whole lines.
    pub fn pieces(self, bytes: &[u8], start: usize, size: usize) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        let mut from = start;
        while from < bytes.len() {
            // From the start by a whole number of characters.
            let to = match from + size {
                target if target >= bytes.len() => bytes.len(),
                target => self.line_end(bytes, target),
            };
            out.push((from, to));
            from = to;
        }
        out
    }
}

/// Whether a line holds nothing or a comment.
pub fn is_empty_line(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.first() == Some(&b'#')
}

/// Where the line that begins at `at` ends, if it holds nothing or a comment.
pub fn skip_empty(text: &[u8], at: usize) -> Option<usize> {
    let rest = text.get(at..)?;
    let first = rest.iter().position(|b| !matches!(b, b' ' | b'\r'));
    match first.and_then(|n| rest.get(n)) {
        Some(b'\n' | b'#') | None => {}
        _ => return None,
    }
    Some(memchr::memchr(b'\n', rest).map_or(text.len(), |n| at + n + 1))
}

/// Length of the field at the beginning of `rest`, quotes included.
pub fn field_end(rest: &[u8], delimiter: u8) -> usize {
    let mut from = 0;
    if let Some(open) = rest.iter().position(|b| *b != b' ')
        && rest.get(open) == Some(&b'"')
    {
        // A quote within is doubled; a line is never longer than itself.
        from = open + 1;
        while let Some(n) = memchr::memchr2(b'"', b'\n', rest.get(from..).unwrap_or_default()) {
            from += n;
            match (rest.get(from), rest.get(from + 1)) {
                (Some(b'"'), Some(b'"')) => from += 2,
                (Some(b'"'), _) => {
                    from += 1;
                    break;
                }
                _ => break,
            }
        }
    }
    let rest_of = rest.get(from..).unwrap_or_default();
    memchr::memchr2(delimiter, b'\n', rest_of).map_or(rest.len(), |n| from + n)
}

/// A field without spaces around it and without its quotes.
pub fn bare(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    field
        .strip_prefix(b"\"")
        .and_then(|f| f.strip_suffix(b"\""))
        .map_or(field, <[u8]>::trim_ascii)
}

/// Text of a field: UTF-8, else an eight-bit code.
pub fn shown(field: &[u8]) -> String {
    match std::str::from_utf8(field) {
        Ok(t) => t.to_owned(),
        Err(_) => field.iter().map(|b| char::from(*b)).collect(),
    }
}
