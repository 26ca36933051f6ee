//! Fortran records: a 4-byte length, the bytes, the length again (also in 64-bit files).

use super::words::{Format, Words};

/// Reads consecutive records.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    file: &'a [u8],
    pub pos: usize,
    pub format: Format,
}

/// A physical record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Physical<'a> {
    /// Offset of the record's bytes in the file.
    pub offset: usize,
    pub bytes: &'a [u8],
}

/// Reason why there is no further record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// The file ends where a record may start.
    End,
    /// The file ends within a record, whose bytes extend from `offset` to the end of the file.
    Short { offset: usize, stated: usize },
    /// A length is impossible, or the two lengths differ.
    Marks {
        offset: usize,
        before: i64,
        after: i64,
    },
    /// A key (a record of one word) was expected.
    NotKey { offset: usize, bytes: usize },
}

impl Stop {
    /// Returns the byte offset of the error.
    pub(super) fn offset(&self, file: &[u8]) -> usize {
        match self {
            Self::End => file.len(),
            Self::Short { offset, .. }
            | Self::Marks { offset, .. }
            | Self::NotKey { offset, .. } => *offset,
        }
    }
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::End => f.write_str("the file ends"),
            Self::Short { stated, .. } => {
                write!(f, "the file ends within a record of {stated} bytes")
            }
            Self::Marks { before, after, .. } => {
                write!(f, "a record's two lengths are {before} and {after}")
            }
            Self::NotKey { bytes, .. } => write!(
                f,
                "found a record of {bytes} bytes, expected a key of one word"
            ),
        }
    }
}

impl<'a> Cursor<'a> {
    pub(super) fn new(file: &'a [u8], format: Format) -> Self {
        Cursor {
            file,
            pos: 0,
            format,
        }
    }

    /// Returns the next record.
    pub(super) fn next(&mut self) -> Result<Physical<'a>, Stop> {
        let left = self.file.get(self.pos..).unwrap_or(&[]);
        if left.is_empty() {
            return Err(Stop::End);
        }
        let Some(mark) = left.first_chunk::<4>() else {
            return Err(Stop::Short {
                offset: self.pos,
                stated: 4,
            });
        };
        let before = self.format.mark(*mark);
        let offset = self.pos.saturating_add(4);
        let Ok(n) = usize::try_from(before) else {
            return Err(Stop::Marks {
                offset: self.pos,
                before: before.into(),
                after: 0,
            });
        };
        let rest = left.get(4..).unwrap_or(&[]);
        let Some((bytes, after)) = rest.split_at_checked(n) else {
            return Err(Stop::Short { offset, stated: n });
        };
        let Some(after) = after.first_chunk::<4>() else {
            return Err(Stop::Short { offset, stated: n });
        };
        let after = self.format.mark(*after);
        if after != before {
            return Err(Stop::Marks {
                offset: self.pos,
                before: before.into(),
                after: after.into(),
            });
        }
        self.pos = offset.saturating_add(n).saturating_add(4);
        Ok(Physical { offset, bytes })
    }

    /// Returns the next record as a key.
    pub(super) fn key(&mut self) -> Result<i64, Stop> {
        let record = self.next()?;
        let words = Words::new(record.bytes, self.format);
        match words.int(0) {
            Some(key) if record.bytes.len() == self.format.bytes() => Ok(key),
            _ => Err(Stop::NotKey {
                offset: record.offset,
                bytes: record.bytes.len(),
            }),
        }
    }

    /// Returns the bytes of a record that the end of the file cuts.
    pub(super) fn cut_short(&self, offset: usize) -> &'a [u8] {
        self.file.get(offset..).unwrap_or(&[])
    }
}
