//! Continuations that do not stand below their card: found by name when all lines are read.

use std::collections::HashMap;
use std::sync::atomic::AtomicUsize;

use super::assemble::Assembler;
use super::fault::{Fault, Wrong};
use super::fields::note_fault;
use super::line::{Line, text_of};
use super::part::{Deferred, Orphan, Part, Span};
use super::source::{Note, Source};
use crate::place::Place;

/// Joins deferred cards with their continuations and reads them.
///
/// A continuation goes to the card that names it, else (with a note) to the card directly above it.
pub(super) fn resolve(
    deferred: &[Deferred],
    orphans: &mut [Orphan],
    sources: &[Source],
    budget: &AtomicUsize,
) -> Part {
    let mut by_label: HashMap<Vec<u8>, Vec<usize>> = HashMap::new();
    for (i, orphan) in orphans.iter().enumerate().rev() {
        by_label.entry(orphan.label.clone()).or_default().push(i);
    }
    let mut chains: Vec<Vec<Span>> = Vec::with_capacity(deferred.len());
    let mut found: Vec<bool> = Vec::with_capacity(deferred.len());
    for card in deferred {
        let mut lines = card.lines.clone();
        let mut label = card.label.clone();
        let mut any = false;
        while !label.is_empty()
            && let Some(i) = by_label.get_mut(&label).and_then(Vec::pop)
            && let Some(orphan) = orphans.get_mut(i)
        {
            orphan.used = true;
            any = true;
            lines.extend_from_slice(&orphan.lines);
            label.clone_from(&orphan.next);
        }
        chains.push(lines);
        found.push(any);
    }
    let mut rest = Part::default();
    for orphan in orphans.iter_mut().filter(|o| !o.used) {
        let at = orphan.lines.first().map_or(Place::default(), |s| s.at);
        match orphan.follows {
            Some(card) if found.get(card) == Some(&false) => {
                if let Some(chain) = chains.get_mut(card) {
                    chain.extend_from_slice(&orphan.lines);
                }
                let text = format!(
                    "the continuation `{}` does not bear the name its card asks for",
                    text_of(&orphan.label)
                );
                rest.notes.push(Note { at, text });
            }
            _ => {
                let what = Wrong::Orphan {
                    label: text_of(&orphan.label),
                };
                note_fault(
                    &mut rest.faults,
                    Fault {
                        at,
                        card: String::new(),
                        field: None,
                        what,
                    },
                );
            }
        }
    }
    for chain in &chains {
        let part = read_chain(chain, sources, budget);
        super::merge::append(&mut rest, part);
    }
    rest
}

fn read_chain(chain: &[Span], sources: &[Source], budget: &AtomicUsize) -> Part {
    let Some((first, more)) = chain.split_first() else {
        return Part::default();
    };
    let mut assembler = Assembler::new(first.at.source, budget);
    let line = |span: &Span| {
        let text = sources
            .get(span.at.source.0 as usize)
            .and_then(|s| s.bytes.get(span.start..span.end))
            .unwrap_or_default();
        Line {
            text,
            start: span.start,
            end: span.end,
            number: span.at.line,
        }
    };
    assembler.line(line(first));
    for span in more {
        assembler.attach_line(line(span));
    }
    assembler.emit();
    assembler.part
}
