//! Batches of a Feather file: lists of buffers, and their bytes decompressed.

use crate::series::error::SeriesError;
use crate::series::record::arrow::{ColumnStorage, Field, content, fields, message};
use crate::series::record::flat_buffer::Buffer;
use std::borrow::Cow;
use std::io::Read;
use std::ops::Range;

/// First and last bytes of a file.
pub(super) const MAGIC: &[u8] = b"ARROW1";
/// Kind of a message that contains a batch of rows, and of one that contains a dictionary.
const ROWS: u8 = 3;
const DICTIONARY: u8 = 2;

/// Compression of buffers.
#[derive(Clone, Copy)]
pub(super) enum Codec {
    Lz4,
    Zstandard,
}

/// Rows that are stored together.
pub(super) struct Batch {
    pub rows: usize,
    pub codec: Option<Codec>,
    /// Bytes of the buffers of each field.
    buffers: Vec<Vec<Range<usize>>>,
}

impl Batch {
    /// Returns the buffers of a field, decompressed.
    pub(super) fn field_buffers<'a>(
        &self,
        at: usize,
        file: &'a [u8],
    ) -> Result<Vec<Cow<'a, [u8]>>, SeriesError> {
        let buffers = self.buffers.get(at).map(Vec::as_slice).unwrap_or_default();
        let raw = buffers.iter().map(|r| self.buffer_bytes(file, r));
        raw.map(|b| b.ok_or_else(|| read_error("a compressed column is damaged")))
            .collect()
    }

    /// Returns the bytes of a buffer. A compressed one begins with its length; the length -1 marks one that is stored as it is.
    fn buffer_bytes<'a>(&self, file: &'a [u8], range: &Range<usize>) -> Option<Cow<'a, [u8]>> {
        let part = file.get(range.clone())?;
        let Some(codec) = self.codec.filter(|_| !part.is_empty()) else {
            return Some(Cow::Borrowed(part));
        };
        let (length, packed) = part.split_first_chunk()?;
        let length = match i64::from_le_bytes(*length) {
            -1 => return Some(Cow::Borrowed(packed)),
            n => u64::try_from(n).ok()?,
        };
        let mut out = Vec::new();
        let most = length.checked_add(1)?;
        let read = match codec {
            Codec::Lz4 => lz4_flex::frame::FrameDecoder::new(packed)
                .take(most)
                .read_to_end(&mut out),
            Codec::Zstandard => zstd::stream::read::Decoder::with_buffer(packed)
                .ok()?
                .take(most)
                .read_to_end(&mut out),
        };
        read.ok()?;
        (out.len() as u64 == length).then_some(Cow::Owned(out))
    }
}

/// Returns the columns, the batches and the dictionaries in the list at the end of a file. `None` if the list is damaged.
pub(super) fn parts(file: &[u8]) -> Option<(Vec<Field>, Vec<Batch>, Vec<(usize, Batch)>)> {
    let end = file.len().checked_sub(MAGIC.len() + 4)?;
    let length = Buffer(file).word(end)? as usize;
    let list = Buffer(file.get(end.checked_sub(length)?..end)?);
    let root = list.follow(0)?;
    let fields = fields(list, list.child(root, 1)?)?;
    let mut batches = Vec::new();
    for block in list.list(root, 3, 24)? {
        let (buffer, kind, table, body) = read_block(file, list, block)?;
        batches.push(batch(buffer, table, body, &fields).filter(|_| kind == ROWS)?);
    }
    let mut dictionaries = Vec::new();
    for block in list.list(root, 2, 24)? {
        let (buffer, kind, table, body) = read_block(file, list, block)?;
        let id = buffer.field(table, 0);
        let id = id.map_or(Some(0), |at| buffer.size(at))?;
        // Dictionaries whose entries are neither text nor numbers are not read.
        let values = fields
            .iter()
            .find_map(|f| f.dictionary.filter(|d| d.0 == id));
        let Some((_, stored)) = values.filter(|v| v.1 != ColumnStorage::Other) else {
            continue;
        };
        let field = Field {
            name: String::new(),
            unit: String::new(),
            stored,
            buffers: 2 + usize::from(matches!(stored, ColumnStorage::Text { .. })),
            is_view: stored == ColumnStorage::TextView,
            has_validity: true,
            dictionary: None,
            children: Vec::new(),
        };
        let read = batch(buffer, buffer.child(table, 1)?, body, &[field]);
        dictionaries.push((id, read.filter(|_| kind == DICTIONARY)?));
    }
    Some((fields, batches, dictionaries))
}

/// Returns the message of a block: its bytes, the kind and the table of its content, and the bytes of the file that follow it.
fn read_block<'a>(
    file: &'a [u8],
    list: Buffer<'_>,
    block: usize,
) -> Option<(Buffer<'a>, u8, usize, Range<usize>)> {
    let at = list.size(block)?;
    let body = at.checked_add(list.word(block + 8)? as usize)?;
    let end = body.checked_add(list.size(block + 16)?)?;
    let buffer = Buffer(file.get(at..body)?);
    let (kind, table) = content(buffer, message(buffer, 0)?)?;
    file.get(body..end)?;
    Some((buffer, kind, table, body..end))
}

/// Returns a batch whose buffers are in the bytes `body` of the file.
fn batch(buffer: Buffer<'_>, table: usize, body: Range<usize>, fields: &[Field]) -> Option<Batch> {
    let rows = buffer.field(table, 0);
    let rows = rows.map_or(Some(0), |at| buffer.size(at))?;
    let codec = match buffer.child(table, 3) {
        None => None,
        Some(c) => match buffer.field(c, 0).map_or(Some(0), |at| buffer.byte(at))? {
            0 => Some(Codec::Lz4),
            1 => Some(Codec::Zstandard),
            _ => return None,
        },
    };
    let nodes = buffer.list(table, 1, 16)?.into_iter();
    let nodes = nodes.map(|at| Some((buffer.size(at)?, buffer.size(at + 8)?)));
    let ranges = buffer.list(table, 2, 16)?.into_iter();
    let ranges = ranges.map(|at| {
        let from = body.start.checked_add(buffer.size(at)?)?;
        let to = from.checked_add(buffer.size(at + 8)?)?;
        (to <= body.end).then_some(from..to)
    });
    let more = buffer.list(table, 4, 8)?.into_iter();
    let mut parts = (
        nodes.collect::<Option<Vec<_>>>()?.into_iter(),
        ranges.collect::<Option<Vec<_>>>()?.into_iter(),
        more.map(|at| buffer.size(at))
            .collect::<Option<Vec<_>>>()?
            .into_iter(),
    );
    let buffers = fields.iter().map(|f| take(f, Some(rows), &mut parts));
    let buffers = buffers.collect::<Option<_>>()?;
    let is_over = parts.0.next().is_none() && parts.1.next().is_none() && parts.2.next().is_none();
    is_over.then_some(Batch {
        rows,
        codec,
        buffers,
    })
}

/// Lengths of columns with their numbers of nulls, buffers, and numbers of further buffers of views.
type Parts = (
    std::vec::IntoIter<(usize, usize)>,
    std::vec::IntoIter<Range<usize>>,
    std::vec::IntoIter<usize>,
);

/// Returns the buffers of a field of `rows` rows. `parts` keeps the buffers of later fields; the buffers of children are skipped.
fn take(field: &Field, rows: Option<usize>, parts: &mut Parts) -> Option<Vec<Range<usize>>> {
    let (length, nulls) = parts.0.next()?;
    if rows.is_some_and(|n| n != length) {
        return None;
    }
    let more = match field.is_view {
        true => parts.2.next()?,
        false => 0,
    };
    let mut own = Vec::new();
    for _ in 0..field.buffers.checked_add(more)? {
        own.push(parts.1.next()?);
    }
    let is_marked = own.first().is_some_and(|validity| !validity.is_empty());
    if field.has_validity && nulls > 0 && !is_marked {
        return None;
    }
    for child in &field.children {
        take(child, None, parts)?;
    }
    Some(own)
}

pub(super) fn read_error(what: &str) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be read as Feather ({what})"),
        remedy: "write it again, columns of numbers and one `time` in seconds",
    }
}
