//! Cuts bulk data into chunks, up to the next line that is not a card.

use super::chunk::CHUNK_BYTES;
use super::line::{Lines, is_blank, trim, without_comment};
use super::source::Chunk;

/// A line of bulk data that is not a card.
pub(super) enum BulkStatement {
    Include,
    Begin,
    EndData,
}

/// Cuts bulk data into chunks; stops at the first INCLUDE, BEGIN or ENDDATA and returns it with start, end and line.
pub(super) fn scan(
    bytes: &[u8],
    source: u32,
    at: usize,
    number: u32,
    mut chunks: Option<&mut Vec<Chunk>>,
) -> Option<(BulkStatement, usize, usize, u32)> {
    let mut chunk = Chunk {
        source,
        start: at,
        end: at,
        line: number,
    };
    let mut close = |chunk: &Chunk, end: usize| {
        if let Some(chunks) = chunks.as_mut()
            && end > chunk.start
        {
            chunks.push(Chunk { end, ..*chunk });
        }
    };
    let mut before: &[u8] = &[];
    for line in Lines::new(bytes, at, bytes.len(), number) {
        if let Some(special) = parse_special_statement(line.text) {
            close(&chunk, line.start);
            return Some((special, line.start, line.end, line.number));
        }
        if line.start - chunk.start >= CHUNK_BYTES
            && line.text.first().is_some_and(u8::is_ascii_alphabetic)
            && is_closed(before)
        {
            close(&chunk, line.start);
            chunk = Chunk {
                source,
                start: line.start,
                end: line.start,
                line: line.number,
            };
        }
        before = line.text;
    }
    close(&chunk, bytes.len());
    None
}

/// Returns whether a card may begin after this line: the line is not a comment and does not end in a comma.
fn is_closed(line: &[u8]) -> bool {
    let body = without_comment(line);
    body.iter()
        .rev()
        .find(|&&c| !is_blank(c))
        .is_some_and(|&c| c != b',')
}

#[inline]
fn parse_special_statement(line: &[u8]) -> Option<BulkStatement> {
    let first = *line.first()?;
    if !matches!(
        first,
        b'E' | b'e' | b'I' | b'i' | b'B' | b'b' | b' ' | b'\t'
    ) {
        return None;
    }
    let start = line.iter().position(|&c| !is_blank(c))?;
    if !matches!(line.get(start)?, b'E' | b'e' | b'I' | b'i' | b'B' | b'b') {
        return None;
    }
    match first_word(line).as_slice() {
        b"ENDDATA" => Some(BulkStatement::EndData),
        b"INCLUDE" => Some(BulkStatement::Include),
        b"BEGIN" => Some(BulkStatement::Begin),
        _ => None,
    }
}

/// Returns the first word in upper case, at most 12 letters; empty for blank lines and comments.
pub(super) fn first_word(line: &[u8]) -> Vec<u8> {
    let line = trim(line);
    line.iter()
        .take(12)
        .take_while(|c| c.is_ascii_alphanumeric())
        .map(u8::to_ascii_uppercase)
        .collect()
}
