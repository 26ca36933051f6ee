//! Bytes of a table: how they are coded, where lines and fields end.

use std::borrow::Cow;

/// Characters of Windows-1252 from 0x80 on, where it differs from Latin-1; a space where it has none.
const WINDOWS_1252: &str = "€ ‚ƒ„…†‡ˆ‰Š‹Œ Ž  ‘’“”•–—˜™š›œ žŸ";

/// Returns text in the eight-bit code of Windows (1252); `None` for bytes that no text has.
fn eight_bit_text(bytes: &[u8]) -> Option<String> {
    let character = |b: &u8| match b {
        b'\t' | b'\r' | b'\n' | 0x20..=0x7e | 0xa0.. => Some(char::from(*b)),
        0x80..=0x9f => {
            let c = WINDOWS_1252.chars().nth(usize::from(b - 0x80));
            c.filter(|c| *c != ' ')
        }
        _ => None,
    };
    bytes.iter().map(character).collect()
}

/// Returns a table as text. The encoding is UTF-8 or UTF-16, with or without byte order mark, otherwise the eight-bit code of Windows. The result is
/// `None` for bytes that no text contains.
pub fn table_text(bytes: &[u8]) -> Option<String> {
    let (encoding, begin) = Encoding::detect(bytes);
    let raw = bytes.get(begin..)?;
    let text = match encoding {
        Encoding::Bytes => Cow::Borrowed(raw),
        Encoding::Utf16Le | Encoding::Utf16Be => encoding.text(raw),
    };
    match std::str::from_utf8(&text) {
        Ok(text) => Some(text.to_owned()),
        Err(_) => eight_bit_text(&text),
    }
}

/// Encoding of a text.
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
    /// Returns the encoding of these bytes, and the position where the text begins.
    pub fn detect(bytes: &[u8]) -> (Self, usize) {
        match bytes {
            [0xef, 0xbb, 0xbf, ..] => (Self::Bytes, 3),
            [0xff, 0xfe, ..] => (Self::Utf16Le, 2),
            [0xfe, 0xff, ..] => (Self::Utf16Be, 2),
            _ => (Self::by_zeros(bytes), 0),
        }
    }

    /// Returns the encoding of text without a byte order mark. In UTF-16, one byte of each pair is zero. Other encodings have no zero bytes.
    fn by_zeros(bytes: &[u8]) -> Self {
        /// Characters looked at, and how many of four must be ASCII or Latin.
        const BEGINNING: usize = 64;
        const OF_FOUR: usize = 3;
        let beginning = bytes.chunks_exact(2).take(BEGINNING);
        let pairs = beginning.len();
        let [first, second] = [0, 1].map(|i| {
            let pairs = beginning.clone();
            pairs.filter(|pair| pair.get(i) == Some(&0)).count()
        });
        let most = |n: usize| pairs >= 2 && 4 * n >= OF_FOUR * pairs;
        match (first, second) {
            (0, n) if most(n) => Self::Utf16Le,
            (n, 0) if most(n) => Self::Utf16Be,
            _ => Self::Bytes,
        }
    }

    /// Returns the bytes of an end of line.
    pub fn unit(self) -> usize {
        match self {
            Self::Bytes => 1,
            Self::Utf16Le | Self::Utf16Be => 2,
        }
    }

    /// Returns the text as bytes in which ASCII characters are unchanged.
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

    /// Returns the end of the line that contains byte `at`, including its line end.
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

    /// Returns the ends of lines.
    pub fn lines(self, bytes: &[u8]) -> usize {
        match self {
            Self::Bytes => memchr::memchr_iter(b'\n', bytes).count(),
            Self::Utf16Le => bytes.chunks_exact(2).filter(|b| *b == [b'\n', 0]).count(),
            Self::Utf16Be => bytes.chunks_exact(2).filter(|b| *b == [0, b'\n']).count(),
        }
    }

    /// Returns the pieces of about `size` bytes that end with whole lines.
    pub fn pieces(self, bytes: &[u8], start: usize, size: usize) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        let mut from = start;
        while from < bytes.len() {
            // The size is a whole number of characters.
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

/// Returns whether the lines of a file end with a carriage return alone, as old Macintosh programs write them.
pub fn has_bare_returns(bytes: &[u8]) -> bool {
    /// Bytes looked at: the first lines of any table.
    const BEGINNING: usize = 1 << 20;
    let beginning = bytes.get(..BEGINNING).unwrap_or(bytes);
    let (encoding, _) = Encoding::detect(bytes);
    let of = |end: u8| match encoding {
        Encoding::Bytes => memchr::memchr(end, beginning).is_some(),
        Encoding::Utf16Le => beginning.chunks_exact(2).any(|b| b == [end, 0]),
        Encoding::Utf16Be => beginning.chunks_exact(2).any(|b| b == [0, end]),
    };
    !of(b'\n') && of(b'\r')
}

/// Returns whether a line holds nothing or a comment.
pub fn is_empty_line(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.first() == Some(&b'#')
}

/// Returns the end of the line that begins at `at`, if the line is empty or a comment.
pub fn skip_empty(text: &[u8], at: usize) -> Option<usize> {
    let rest = text.get(at..)?;
    let first = rest.iter().position(|b| !matches!(b, b' ' | b'\r'));
    match first.and_then(|n| rest.get(n)) {
        Some(b'\n' | b'#') | None => {}
        _ => return None,
    }
    Some(memchr::memchr(b'\n', rest).map_or(text.len(), |n| at + n + 1))
}

/// Returns the length of the field at the beginning of `rest`, quotes included.
pub fn field_end(rest: &[u8], delimiter: u8) -> usize {
    let mut from = 0;
    if let Some(open) = rest.iter().position(|b| *b != b' ')
        && rest.get(open) == Some(&b'"')
    {
        // A quote inside a field is doubled. The search stops at the end of the line.
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

/// Returns a field without spaces around it and without quotes.
pub fn trim_field(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    field
        .strip_prefix(b"\"")
        .and_then(|f| f.strip_suffix(b"\""))
        .map_or(field, <[u8]>::trim_ascii)
}

/// Returns the text of a field without quotes: UTF-8, or else an eight-bit code. A quotation mark within the field is doubled in the file.
pub fn decode_field(field: &[u8]) -> String {
    match std::str::from_utf8(field) {
        Ok(t) => t.replace("\"\"", "\""),
        Err(_) => field.iter().map(|b| char::from(*b)).collect(),
    }
}
