//! Words of a record: 4 or 8 bytes in either byte order.

/// Order of the bytes in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum ByteOrder {
    Little,
    Big,
}

/// Storage format of the words of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub order: ByteOrder,
    pub wide: bool,
}

impl Format {
    /// Returns the bytes of a word: 4 or 8.
    pub(super) fn bytes(self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    /// Detects the format of a file from the length of its first record. The record is a key of one word, so its length is 4 or 8 in one of the two
    /// byte orders.
    pub(super) fn detect(file: &[u8]) -> Option<Format> {
        let first = *file.first_chunk::<4>()?;
        match (u32::from_le_bytes(first), u32::from_be_bytes(first)) {
            (4, _) => Some(Format {
                order: ByteOrder::Little,
                wide: false,
            }),
            (8, _) => Some(Format {
                order: ByteOrder::Little,
                wide: true,
            }),
            (_, 4) => Some(Format {
                order: ByteOrder::Big,
                wide: false,
            }),
            (_, 8) => Some(Format {
                order: ByteOrder::Big,
                wide: true,
            }),
            _ => None,
        }
    }

    /// Reads a 4-byte integer, as in the record marks of both word sizes.
    pub(super) fn mark(self, bytes: [u8; 4]) -> i32 {
        match self.order {
            ByteOrder::Little => i32::from_le_bytes(bytes),
            ByteOrder::Big => i32::from_be_bytes(bytes),
        }
    }
}

/// A sequence of words.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    pub format: Format,
}

impl<'a> Words<'a> {
    /// Wraps the complete words of `bytes`; an incomplete word at the end is omitted.
    pub(super) fn new(bytes: &'a [u8], format: Format) -> Self {
        let whole = bytes.len() - bytes.len() % format.bytes();
        Words {
            bytes: bytes.get(..whole).unwrap_or(bytes),
            format,
        }
    }

    /// Returns the number of words.
    pub(super) fn len(&self) -> usize {
        self.bytes.len() / self.format.bytes()
    }

    /// Returns words `from .. from + n`; `None` if there are fewer.
    pub(super) fn part(&self, from: usize, n: usize) -> Option<Words<'a>> {
        let w = self.format.bytes();
        let a = from.checked_mul(w)?;
        let b = n.checked_mul(w)?.checked_add(a)?;
        Some(Words {
            bytes: self.bytes.get(a..b)?,
            format: self.format,
        })
    }

    /// Returns the words from `from` on; empty past the end.
    pub(super) fn rest(&self, from: usize) -> Words<'a> {
        let a = from.saturating_mul(self.format.bytes());
        Words {
            bytes: self.bytes.get(a..).unwrap_or(&[]),
            format: self.format,
        }
    }

    /// Splits the words into entries of `n` words each; an incomplete entry at the end is omitted.
    pub(super) fn entries(&self, n: usize) -> impl ExactSizeIterator<Item = Words<'a>> + use<'a> {
        let format = self.format;
        let size = n.max(1).saturating_mul(format.bytes());
        self.bytes
            .chunks_exact(size)
            .map(move |bytes| Words { bytes, format })
    }

    /// Returns the bytes of word `i`.
    fn bytes_at(&self, i: usize) -> Option<&'a [u8]> {
        let w = self.format.bytes();
        let a = i.checked_mul(w)?;
        self.bytes.get(a..a.checked_add(w)?)
    }

    /// Returns word `i` as an integer.
    #[inline]
    pub(super) fn int(&self, i: usize) -> Option<i64> {
        let raw = self.bytes_at(i)?;
        Some(match self.format {
            Format {
                order: ByteOrder::Little,
                wide: false,
            } => i64::from(i32::from_le_bytes(*raw.first_chunk()?)),
            Format {
                order: ByteOrder::Big,
                wide: false,
            } => i64::from(i32::from_be_bytes(*raw.first_chunk()?)),
            Format {
                order: ByteOrder::Little,
                wide: true,
            } => i64::from_le_bytes(*raw.first_chunk()?),
            Format {
                order: ByteOrder::Big,
                wide: true,
            } => i64::from_be_bytes(*raw.first_chunk()?),
        })
    }

    /// Returns word `i` as a real; 32-bit values are widened exactly.
    #[inline]
    pub(super) fn real_at(&self, i: usize) -> Option<f64> {
        let raw = self.bytes_at(i)?;
        Some(match self.format {
            Format {
                order: ByteOrder::Little,
                wide: false,
            } => f64::from(f32::from_le_bytes(*raw.first_chunk()?)),
            Format {
                order: ByteOrder::Big,
                wide: false,
            } => f64::from(f32::from_be_bytes(*raw.first_chunk()?)),
            Format {
                order: ByteOrder::Little,
                wide: true,
            } => f64::from_le_bytes(*raw.first_chunk()?),
            Format {
                order: ByteOrder::Big,
                wide: true,
            } => f64::from_be_bytes(*raw.first_chunk()?),
        })
    }

    /// Returns the 8-byte real that starts at word `i`: one word of a 64-bit file, two words of a 32-bit file.
    pub(super) fn double_at(&self, i: usize) -> Option<f64> {
        let a = i.checked_mul(self.format.bytes())?;
        let raw = *self.bytes.get(a..)?.first_chunk()?;
        Some(match self.format.order {
            ByteOrder::Little => f64::from_le_bytes(raw),
            ByteOrder::Big => f64::from_be_bytes(raw),
        })
    }

    /// Appends words `from .. from + n` as reals; appends nothing if there are fewer words.
    #[inline]
    pub(super) fn push_reals(&self, from: usize, n: usize, out: &mut Vec<f64>) {
        let Some(Words { bytes, .. }) = self.part(from, n) else {
            return;
        };
        match self.format {
            Format {
                order: ByteOrder::Little,
                wide: false,
            } => {
                out.extend(
                    bytes
                        .as_chunks()
                        .0
                        .iter()
                        .map(|b| f64::from(f32::from_le_bytes(*b))),
                );
            }
            Format {
                order: ByteOrder::Big,
                wide: false,
            } => {
                out.extend(
                    bytes
                        .as_chunks()
                        .0
                        .iter()
                        .map(|b| f64::from(f32::from_be_bytes(*b))),
                );
            }
            Format {
                order: ByteOrder::Little,
                wide: true,
            } => {
                out.extend(bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)));
            }
            Format {
                order: ByteOrder::Big,
                wide: true,
            } => {
                out.extend(bytes.as_chunks().0.iter().map(|b| f64::from_be_bytes(*b)));
            }
        }
    }

    /// Returns the characters of words `from .. from + n`, trimmed. A word of a 64-bit file contains 4 characters and 4 blanks (`XXXX    XXXX    `),
    /// or 8 characters. Characters that are not printable become blanks.
    pub(super) fn text(&self, from: usize, n: usize) -> String {
        let Some(Words { bytes, .. }) = self.part(from, n) else {
            return String::new();
        };
        let (words, _) = bytes.as_chunks::<8>();
        let spread = self.format.wide
            && words
                .iter()
                .all(|w| w.iter().skip(4).all(|c| matches!(c, b' ' | 0)));
        let printable = |c: &u8| {
            if c.is_ascii_graphic() {
                char::from(*c)
            } else {
                ' '
            }
        };
        let text: String = if spread {
            words
                .iter()
                .flat_map(|w| w.iter().take(4))
                .map(printable)
                .collect()
        } else {
            bytes.iter().map(printable).collect()
        };
        text.trim().to_owned()
    }
}
