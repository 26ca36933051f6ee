//! Names of continuations: field 10 of a line, and field 1 of the line that continues it.

use std::collections::HashSet;

use super::line::{Lines, trim, without_comment};
use super::part::Span;
use super::source::{Chunk, Source};
use super::split::{Lead, cut};
use crate::place::{Place, SourceIx};

/// Names of continuations, in upper case.
pub(super) type ContinuationNames = HashSet<Vec<u8>>;

/// Returns the name without the marks of columns 1 and 73, which do not belong to it. MSC Nastran writes names that begin with `+`.
pub(super) fn strip_marks(label: &[u8]) -> &[u8] {
    match label {
        [b'+' | b'*', rest @ ..] => strip_marks(trim(rest)),
        other => other,
    }
}

/// Returns whether a mark in column 73 shows that the name after it is the name of a continuation.
pub(super) fn is_marked(label: &[u8]) -> bool {
    matches!(label, [b'+' | b'*', ..]) && !strip_marks(label).is_empty()
}

/// Returns the name in field 10 if column 73 contains a mark other than `+` or `*`.
fn behind_mark(label: &[u8]) -> &[u8] {
    match label {
        [b'+' | b'*', ..] | [] => &[],
        [_, rest @ ..] => strip_marks(trim(rest)),
    }
}

/// Returns the name in upper case: names are compared without regard to case.
pub(super) fn key(name: &[u8]) -> Vec<u8> {
    name.to_ascii_uppercase()
}

/// Returns whether field 10 asks for the continuation of this name.
pub(super) fn asks(label: &[u8], wanted: &[u8]) -> bool {
    let is = |name: &[u8]| name.eq_ignore_ascii_case(wanted);
    !wanted.is_empty() && (is(strip_marks(label)) || is(behind_mark(label)))
}

/// Returns the name of the continuation that a finished card still asks for: one after `+` or `*`, or any that is claimed.
#[inline]
pub(super) fn claim<'a>(label: &'a [u8], claimed: &ContinuationNames) -> Option<&'a [u8]> {
    if let [] | [b'+' | b'*'] = label {
        return None;
    }
    let name = strip_marks(label);
    if name.is_empty() || name.len() < label.len() {
        return Some(name).filter(|n| !n.is_empty());
    }
    if claimed.is_empty() {
        return None;
    }
    let names = [name, behind_mark(label)];
    names.into_iter().find(|n| claimed.contains(&key(n)))
}

/// A line that names a continuation in field 10.
pub(super) struct Asker {
    pub name: Vec<u8>,
    pub at: Place,
    /// The continuation, if it is on the next line.
    pub continuation: Option<Place>,
}

/// Returns every line that asks for one of these names, in file order.
pub(super) fn askers(
    names: &ContinuationNames,
    chunks: &[Chunk],
    sources: &[Source],
) -> Vec<Asker> {
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
                && strip_marks(cut.head).eq_ignore_ascii_case(&asker.name)
            {
                asker.continuation = Some(at);
            }
            fields.clear();
            let label = cut.fields(&mut fields);
            let asked = [strip_marks(label), behind_mark(label)];
            let named = asked.into_iter().filter(|n| !n.is_empty());
            let name = named.map(key).find(|n| names.contains(n));
            waits = name.is_some();
            found.extend(name.map(|name| Asker {
                name,
                at,
                continuation: None,
            }));
        }
    }
    found
}

/// Returns the names of continuations that the card above them does not ask for.
pub(super) fn find_unclaimed(loose: &[Span], sources: &[Source]) -> ContinuationNames {
    let name = |span: &Span| {
        let text = span.text(sources);
        key(strip_marks(cut(without_comment(text)).head))
    };
    loose.iter().map(name).collect()
}
