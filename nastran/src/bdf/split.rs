//! Splits a physical line of bulk data into fields.

use super::line::{is_blank, trim};
use super::number::{Number, read_number};

/// Format of the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// 8 columns a field.
    Small,
    /// 16 columns a field, 4 fields a line.
    Large,
    /// Separated by commas.
    Free,
    /// Separated by commas, 4 fields a line.
    FreeLarge,
}

/// The first field of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lead {
    /// A card name.
    Name,
    /// A continuation, its name in field 1 possibly blank.
    Continuation,
    /// `=` or `=(n)`: a repetition of the card above.
    Replica,
    /// Data that continues a line that ended in a comma.
    Data,
}

/// A line cut into its parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut<'a> {
    pub format: Format,
    pub lead: Lead,
    /// Field 1, trimmed, without the `*` after a name.
    pub head: &'a [u8],
    /// The line without its comment.
    body: &'a [u8],
    /// Offset of the first byte after field 1 and its comma (free format only).
    rest: usize,
}

/// Cuts a line that contains more than blanks; `body` has no comment.
pub(super) fn cut(body: &[u8]) -> Cut<'_> {
    let comma = memchr::memchr(b',', body);
    if let Some(comma) = comma {
        let head = trim(body.get(..comma).unwrap_or_default());
        if head.len() <= 16 && !head.iter().any(|&c| is_blank(c)) {
            return cut_free_line(body, head, comma + 1);
        }
    }
    if let Some(head) = repetition(body) {
        return Cut {
            format: Format::Small,
            lead: Lead::Replica,
            head,
            body,
            rest: 0,
        };
    }
    let tabs = memchr::memchr(b'\t', body.get(..8.min(body.len())).unwrap_or_default());
    let head = trim(
        body.get(..tabs.unwrap_or(8).min(body.len()))
            .unwrap_or(body),
    );
    let lead = lead(head, Lead::Name);
    match (lead, memchr::memchr(b'*', head)) {
        (Lead::Replica, _) | (_, None) => Cut {
            format: Format::Small,
            lead,
            head,
            body,
            rest: 0,
        },
        (Lead::Continuation, Some(0)) => Cut {
            format: Format::Large,
            lead,
            head,
            body,
            rest: 0,
        },
        (Lead::Continuation, Some(_)) => Cut {
            format: Format::Small,
            lead,
            head,
            body,
            rest: 0,
        },
        (_, Some(star)) => Cut {
            format: Format::Large,
            lead,
            head: trim(head.get(..star).unwrap_or(head)),
            body,
            rest: 0,
        },
    }
}

/// Returns `=(n)` or `=n`, which may be longer than a field.
fn repetition(body: &[u8]) -> Option<&[u8]> {
    let token = body.split(|&c| is_blank(c)).find(|t| !t.is_empty())?;
    matches!(token, [b'=', b'(' | b'0'..=b'9', ..]).then_some(token)
}

fn cut_free_line<'a>(body: &'a [u8], head: &'a [u8], rest: usize) -> Cut<'a> {
    let lead = lead(head, Lead::Name);
    let starred = match lead {
        Lead::Name => head.strip_suffix(b"*"),
        Lead::Continuation if head.first() == Some(&b'*') => Some(head),
        _ => None,
    };
    match starred {
        Some(head) => Cut {
            format: Format::FreeLarge,
            lead,
            head: trim(head),
            body,
            rest,
        },
        None => Cut {
            format: Format::Free,
            lead,
            head,
            body,
            rest,
        },
    }
}

fn lead(head: &[u8], otherwise: Lead) -> Lead {
    match head.first() {
        None | Some(b'+' | b'*') => Lead::Continuation,
        Some(b'=') => Lead::Replica,
        Some(b'0'..=b'9' | b'.' | b'-') => Lead::Data,
        Some(_) => otherwise,
    }
}

/// Returns whether a keyword continues a list of ids after a trailing comma, although it begins with a letter.
pub(super) fn is_list_word(head: &[u8]) -> bool {
    [
        b"THRU".as_slice(),
        b"BY",
        b"EXCEPT",
        b"UM",
        b"ALPHA",
        b"ENDT",
    ]
    .iter()
    .any(|w| head.eq_ignore_ascii_case(w))
}

impl<'a> Cut<'a> {
    /// Returns whether field 1 is blank and text of field 2 precedes the first comma, so that the commas may belong to the text.
    #[inline]
    pub(super) fn field_1_is_blank(&self) -> bool {
        let is_free = matches!(self.format, Format::Free | Format::FreeLarge);
        is_free
            && match self.body {
                [b'\t', ..] => true,
                [b' ', ..] => self.rest > 9 && self.body.iter().take(8).all(|&c| is_blank(c)),
                _ => false,
            }
    }

    /// Returns the line in fields of 8 columns, with field 1 blank.
    pub(super) fn with_blank_field_1(&self) -> Cut<'a> {
        Cut {
            format: Format::Small,
            lead: Lead::Continuation,
            head: &[],
            body: self.body,
            rest: 0,
        }
    }

    /// Returns the number of fields of a full line.
    pub(super) fn width(&self) -> usize {
        match self.format {
            Format::Small | Format::Free => 8,
            Format::Large | Format::FreeLarge => 4,
        }
    }

    /// Returns whether the line ends in a comma, so that the next line may continue with data.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.format, Format::Free | Format::FreeLarge)
            && self.body.iter().rev().find(|&&c| !is_blank(c)) == Some(&b',')
    }

    /// Appends the fields after field 1, and returns the continuation name of field 10 (empty if blank).
    #[inline]
    pub(super) fn fields(&self, out: &mut Vec<&'a [u8]>) -> &'a [u8] {
        match self.format {
            Format::Small | Format::Large => self.split_fixed_fields(out),
            Format::Free | Format::FreeLarge => self.split_free_fields(out),
        }
    }

    #[inline]
    fn split_fixed_fields(&self, out: &mut Vec<&'a [u8]>) -> &'a [u8] {
        if memchr::memchr(b'\t', self.body).is_some() {
            return self.split_tabbed_fields(out);
        }
        let body = self.body;
        let slice = |from: usize, to: usize| {
            trim(
                body.get(from.min(body.len())..to.min(body.len()))
                    .unwrap_or_default(),
            )
        };
        let width = self.width();
        let columns = 64 / width;
        for k in 0..width {
            out.push(slice(8 + k * columns, 8 + (k + 1) * columns));
        }
        slice(72, 80)
    }

    /// Appends the fields of a line with tabs. A tab moves to the next column after a multiple of 8.
    fn split_tabbed_fields(&self, out: &mut Vec<&'a [u8]>) -> &'a [u8] {
        // Byte offsets of columns 0, 8, 16 .. 80.
        let mut starts = [self.body.len(); 11];
        let mut column = 0_usize;
        for (i, &c) in self.body.iter().enumerate() {
            if column.is_multiple_of(8)
                && let Some(start) = starts.get_mut(column / 8)
                && *start == self.body.len()
            {
                *start = i;
            }
            column = if c == b'\t' {
                (column / 8 + 1) * 8
            } else {
                column + 1
            };
        }
        let slice = |from: usize, to: usize| {
            let start = starts.get(from).copied().unwrap_or(self.body.len());
            let end = starts.get(to).copied().unwrap_or(self.body.len());
            trim(self.body.get(start..end).unwrap_or_default())
        };
        let step = 8 / self.width();
        for k in 0..self.width() {
            out.push(slice(1 + k * step, 1 + (k + 1) * step));
        }
        slice(9, 10)
    }

    fn split_free_fields(&self, out: &mut Vec<&'a [u8]>) -> &'a [u8] {
        let rest = self.body.get(self.rest..).unwrap_or_default();
        let width = self.width();
        let first = out.len();
        let mut start = 0;
        for comma in memchr::memchr_iter(b',', rest) {
            out.push(trim(rest.get(start..comma).unwrap_or_default()));
            start = comma + 1;
        }
        out.push(trim(rest.get(start..).unwrap_or_default()));
        // Commas after the line's last field are superfluous.
        while out.len() > first + width && out.last().is_some_and(|f| f.is_empty()) {
            out.pop();
        }
        let is_last = out.len() == first + width + 1;
        if let Some(&label) = out.get(first + width)
            && is_label(label, is_last)
        {
            out.remove(first + width);
            return label;
        }
        &[]
    }

    /// Appends the tokens of a line that continues with data.
    pub(super) fn data(&self, out: &mut Vec<&'a [u8]>) {
        for field in self.body.split(|&c| c == b',') {
            out.push(trim(field));
        }
    }
}

/// Returns whether the token after the last field is a continuation name instead of data.
fn is_label(token: &[u8], is_last: bool) -> bool {
    match token.first() {
        Some(b'+' | b'*') => match read_number(token) {
            None => true,
            Some(Number::Integer(_)) => is_last,
            Some(Number::Real(_)) => false,
        },
        _ => false,
    }
}
