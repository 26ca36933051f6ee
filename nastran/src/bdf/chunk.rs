//! Reads chunks of bulk data, many in parallel.

use std::sync::atomic::AtomicUsize;

use rayon::prelude::*;

use super::assemble::Assembler;
use super::continuation_name::ContinuationNames;
use super::line::Lines;
use super::merge::append;
use super::part::Part;
use super::source::{Chunk, Source};
use crate::place::SourceIx;

/// Size in bytes after which a chunk ends at the next card.
pub(super) const CHUNK_BYTES: usize = 192 << 10;

/// Number of chunks in memory at once, in addition to the cards that are joined.
const BATCH: usize = 32;

/// Reads all chunks, and joins their parts in order.
pub(super) fn read_chunks(
    chunks: &[Chunk],
    sources: &[Source],
    budget: &AtomicUsize,
    claimed: &ContinuationNames,
) -> Part {
    let mut all = Part::default();
    for batch in chunks.chunks(BATCH) {
        let parts: Vec<Part> = if batch.len() == 1 {
            batch
                .iter()
                .map(|c| read_chunk(c, sources, budget, claimed))
                .collect()
        } else {
            batch
                .par_iter()
                .map(|c| read_chunk(c, sources, budget, claimed))
                .collect()
        };
        for part in parts {
            append(&mut all, part);
        }
    }
    all
}

fn read_chunk(
    chunk: &Chunk,
    sources: &[Source],
    budget: &AtomicUsize,
    claimed: &ContinuationNames,
) -> Part {
    let bytes = sources
        .get(chunk.source as usize)
        .map(|s| s.bytes.as_slice())
        .unwrap_or_default();
    let mut assembler = Assembler::new(SourceIx(chunk.source), budget, claimed);
    for line in Lines::new(bytes, chunk.start, chunk.end, chunk.line) {
        assembler.line(line);
    }
    assembler.finish();
    assembler.part
}
