//! Content of a piece of bulk data, before the pieces are joined.

use super::deck::OtherCard;
use super::fault::Fault;
use super::names::Label;
use super::source::{Note, Source};
use crate::cards::Cards;
use crate::place::Place;

/// A card name in upper case, padded with zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub(super) struct Name(pub [u8; 8]);

impl Name {
    /// Returns the name; `None` for text that is not a name. A name has at most 8 letters and digits and begins with a letter.
    pub(super) fn new(head: &[u8]) -> Option<Name> {
        if head.is_empty() || head.len() > 8 || !head.first().is_some_and(u8::is_ascii_alphabetic) {
            return None;
        }
        let mut name = [0; 8];
        for (to, &from) in name.iter_mut().zip(head) {
            if !from.is_ascii_alphanumeric() && from != b'_' {
                return None;
            }
            *to = from.to_ascii_uppercase();
        }
        Some(Name(name))
    }

    pub(super) fn as_bytes(&self) -> &[u8] {
        let n = self.0.iter().position(|&c| c == 0).unwrap_or(8);
        self.0.get(..n).unwrap_or_default()
    }
}

/// Content of a piece of bulk data.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub cards: Cards,
    pub counts: Vec<(Name, usize)>,
    pub others: Vec<OtherCard>,
    pub faults: Vec<Fault>,
    pub notes: Vec<Note>,
    pub labels: Vec<Label>,
    pub deferred: Vec<DeferredCard>,
    pub orphans: Vec<OrphanContinuation>,
    /// Named continuations below a card that does not name them: their cards are elsewhere, or missing.
    pub loose: Vec<Span>,
}

impl Part {
    pub(super) fn count(&mut self, name: Name) {
        // Cards of one name often follow each other, so the entry used last is moved to the end.
        match self.counts.iter().rposition(|(n, _)| *n == name) {
            Some(i) => {
                if let Some((_, n)) = self.counts.get_mut(i) {
                    *n += 1;
                }
                let last = self.counts.len() - 1;
                self.counts.swap(i, last);
            }
            None => self.counts.push((name, 1)),
        }
    }
}

/// A physical line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub at: Place,
    pub start: usize,
    pub end: usize,
}

impl Span {
    /// Returns the line's bytes.
    pub(super) fn text<'a>(&self, sources: &'a [Source]) -> &'a [u8] {
        sources
            .get(self.at.source.0 as usize)
            .and_then(|s| s.bytes.get(self.start..self.end))
            .unwrap_or_default()
    }
}

/// A card that names a continuation which did not follow.
#[derive(Clone, Debug)]
pub(super) struct DeferredCard {
    pub label: Vec<u8>,
    pub lines: Vec<Span>,
}

/// Continuation lines that name a card that was not above them.
#[derive(Clone, Debug)]
pub(super) struct OrphanContinuation {
    pub label: Vec<u8>,
    /// Name in field 10 of the last line.
    pub next: Vec<u8>,
    /// Whether a mark shows that this name is the name of a continuation.
    pub asks: bool,
    pub lines: Vec<Span>,
    pub used: bool,
}

impl OrphanContinuation {
    /// Returns the place of the first line.
    pub(super) fn first_place(&self) -> Option<Place> {
        self.lines.first().map(|s| s.at)
    }
}
