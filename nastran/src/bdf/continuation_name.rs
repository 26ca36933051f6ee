//! Names of continuations: field 10 of a line, field 1 of the line that continues it.

use std::collections::HashSet;

use super::line::{Lines, trim, without_comment};
use super::part::Span;
use super::source::{Chunk, Source};
use super::split::{Lead, cut};
use crate::place::{Place, SourceIx};

/// Names that a card asks for whose continuation stands below another card.
pub(super) type Claimed = HashSet<Vec<u8>>;

/// Returns the name without the marks of columns 1 and 73, which are no part of it. MSC Nastran writes names that begin with `+`.
pub(super) fn bare(label: &[u8]) -> &[u8] {
    match label {
        [b'+' | b'*', rest @ ..] => bare(trim(rest)),
        other => other,
    }
}

/// Returns the name in field 10 where column 73 holds another mark than `+` or `*`.
fn behind_mark(label: &[u8]) -> &[u8] {
    match label {
        [b'+' | b'*', ..] | [] => &[],
        [_, rest @ ..] => bare(trim(rest)),
    }
}

/// Whether field 10 asks for the continuation of this name.
pub(super) fn asks(label: &[u8], wanted: &[u8]) -> bool {
    !wanted.is_empty() && (bare(label) == wanted || behind_mark(label) == wanted)
}

/// Returns the name of the continuation that a finished card still asks for: one after `+` or `*`, or any that is claimed.
#[inline]
pub(super) fn claim<'a>(label: &'a [u8], claimed: &Claimed) -> Option<&'a [u8]> {
    if let [] | [b'+' | b'*'] = label {
        return None;
    }
    let name = bare(label);
    if name.is_empty() || name.len() < label.len() {
        return Some(name).filter(|n| !n.is_empty());
    }
    let names = [name, behind_mark(label)];
    names.into_iter().find(|n| claimed.contains(*n))
}

/// A line that names a continuation in field 10.
pub(super) struct Asker {
    pub name: Vec<u8>,
    pub at: Place,
    /// The continuation, where it is on the next line.
    pub continuation: Option<Place>,
}

/// Returns every line that asks for one of these names, in file order.
pub(super) fn askers(names: &Claimed, chunks: &[Chunk], sources: &[Source]) -> Vec<Asker> {
    let mut found: Vec<Asker> = Vec::new();
    let mut fields = Vec::new();
    for chunk in chunks {
        let bytes = sources
            .get(chunk.source as usize)
            .map(|s| s.bytes.as_slice())
            .unwrap_or_default();
        let mut waits = false;
        for line in Lines::new(bytes, chunk.start, chunk.end, chunk.line) {
            let body = without_comment(line.text);
            if trim(body).is_empty() {
                continue;
            }
            let at = Place {
                source: SourceIx(chunk.source),
                line: line.number,
            };
            let cut = cut(body);
            if waits
                && cut.lead == Lead::Continuation
                && let Some(asker) = found.last_mut()
                && bare(cut.head) == asker.name
            {
                asker.continuation = Some(at);
            }
            fields.clear();
            let label = cut.fields(&mut fields);
            let asked = [bare(label), behind_mark(label)];
            let name = asked.into_iter().find(|n| names.contains(*n));
            waits = name.is_some();
            found.extend(name.map(|name| Asker {
                name: name.to_vec(),
                at,
                continuation: None,
            }));
        }
    }
    found
}

/// Returns the names of these continuations that cards elsewhere ask for in vain.
pub(super) fn claimed_elsewhere(loose: &[Span], chunks: &[Chunk], sources: &[Source]) -> Claimed {
    let name = |span: &Span| {
        let text = span.text(sources);
        bare(cut(without_comment(text)).head).to_vec()
    };
    if loose.is_empty() {
        return Claimed::default();
    }
    let names: Claimed = loose.iter().map(name).collect();
    let askers = askers(&names, chunks, sources).into_iter();
    askers
        .filter(|a| a.continuation.is_none())
        .map(|a| a.name)
        .collect()
}
