//! Joins continuations that are not below their card: they are found by name after all lines are read.

use std::collections::{HashMap, HashSet};
use std::sync::atomic::AtomicUsize;

use super::assemble::Assembler;
use super::continuation_name::{ContinuationNames, askers};
use super::fault::{DeckFaultKind, Fault};
use super::fields::note_fault;
use super::line::{Line, text_of};
use super::part::{DeferredCard, OrphanContinuation, Part, Span};
use super::source::{Chunk, Source};
use crate::place::Place;

/// Cards that wait for continuations, continuations that wait for cards, and the text of both.
pub(super) struct PendingContinuations<'a> {
    pub deferred: &'a [DeferredCard],
    pub orphans: &'a mut [OrphanContinuation],
    pub chunks: &'a [Chunk],
    pub sources: &'a [Source],
}

/// Joins deferred cards with their continuations and reads them.
///
/// A continuation belongs to the card that names it; a card of the same file is preferred. A name that occurs twice, or that no card has, is a fault.
/// A card that asks for a name that no continuation has is a fault, too.
pub(super) fn resolve(loose: PendingContinuations<'_>, budget: &AtomicUsize) -> Part {
    let PendingContinuations {
        deferred,
        orphans,
        chunks,
        sources,
    } = loose;
    let mut rest = Part::default();
    let ambiguous = refuse_ambiguous(deferred, orphans, sources, &mut rest);
    let mut by_label: HashMap<Vec<u8>, Vec<usize>> = HashMap::new();
    for (i, orphan) in orphans.iter().enumerate() {
        by_label.entry(orphan.label.clone()).or_default().push(i);
    }
    let mut chains: Vec<Vec<Span>> = Vec::with_capacity(deferred.len());
    let mut found: Vec<bool> = Vec::with_capacity(deferred.len());
    for card in deferred {
        let mut lines = card.lines.clone();
        let mut label = card.label.clone();
        let mut any = false;
        let mut asks = true;
        while !ambiguous.contains(&label)
            && let Some(i) = by_label
                .get_mut(&label)
                .and_then(|list| next_of(list, orphans, &lines))
            && let Some(orphan) = orphans.get_mut(i)
        {
            orphan.used = true;
            any = true;
            asks = orphan.asks;
            lines.extend_from_slice(&orphan.lines);
            label.clone_from(&orphan.next);
        }
        if any && asks && !label.is_empty() && !ambiguous.contains(&label) {
            let at = lines.last().map_or(Place::default(), |s| s.at);
            let label = text_of(&label);
            refuse(&mut rest, at, DeckFaultKind::NoContinuation { label });
        }
        chains.push(lines);
        found.push(any);
    }
    let unused = |o: &&mut OrphanContinuation| !o.used && !ambiguous.contains(&o.label);
    for orphan in orphans.iter_mut().filter(unused) {
        let at = orphan.lines.first().map_or(Place::default(), |s| s.at);
        let label = text_of(&orphan.label);
        refuse(&mut rest, at, DeckFaultKind::Orphan { label });
    }
    let names = deferred.iter().map(|d| &d.label);
    let names: ContinuationNames = names.filter(|l| !ambiguous.contains(*l)).cloned().collect();
    let shared = refuse_shared(&names, chunks, sources, &mut rest);
    let known = |label: &Vec<u8>| ambiguous.contains(label) || shared.contains(label);
    for (card, _) in deferred.iter().zip(&found).filter(|(_, found)| !**found) {
        if let Some(line) = card.lines.last().filter(|_| !known(&card.label)) {
            let label = text_of(&card.label);
            refuse(&mut rest, line.at, DeckFaultKind::NoContinuation { label });
        }
    }
    for chain in &chains {
        let part = read_chain(chain, sources, budget);
        super::merge::append(&mut rest, part);
    }
    rest
}

/// Returns the next continuation of a list; a continuation of the same file as the last line is preferred.
fn next_of(list: &mut Vec<usize>, orphans: &[OrphanContinuation], lines: &[Span]) -> Option<usize> {
    let source = lines.last().map(|s| s.at.source);
    let of_file = |i: &usize| {
        orphans
            .get(*i)
            .and_then(OrphanContinuation::first_place)
            .map(|at| at.source)
            == source
    };
    let k = list.iter().position(of_file).unwrap_or(0);
    (k < list.len()).then(|| list.remove(k))
}

/// Refuses the names that several cards and several continuations of a file have, and returns them.
fn refuse_ambiguous(
    deferred: &[DeferredCard],
    orphans: &[OrphanContinuation],
    sources: &[Source],
    rest: &mut Part,
) -> HashSet<Vec<u8>> {
    let mut askers: HashMap<&[u8], Vec<Place>> = HashMap::new();
    let cards = deferred
        .iter()
        .map(|d| (d.label.as_slice(), d.lines.last()));
    let chained = orphans.iter().map(|o| (o.next.as_slice(), o.lines.last()));
    for (label, line) in cards.chain(chained) {
        askers.entry(label).or_default().extend(line.map(|s| s.at));
    }
    let mut ambiguous = HashSet::new();
    let mut first: HashMap<(&[u8], u32), Place> = HashMap::new();
    for orphan in orphans {
        let (Some(at), Some(all)) = (orphan.first_place(), askers.get(orphan.label.as_slice()))
        else {
            continue;
        };
        let own: Vec<Place> = all
            .iter()
            .copied()
            .filter(|p| p.source == at.source)
            .collect();
        let asked = if own.is_empty() { all } else { &own };
        let before = first.get(&(&*orphan.label, at.source.0)).copied();
        let why = match (asked.as_slice(), before) {
            ([a, b, ..], _) => format!("{} both name it", lines(*a, *b, at, sources)),
            (_, Some(before)) => format!("its name is also on line {}", before.line),
            _ => {
                first.insert((&*orphan.label, at.source.0), at);
                continue;
            }
        };
        ambiguous.insert(orphan.label.clone());
        let label = text_of(&orphan.label);
        refuse(rest, at, DeckFaultKind::Ambiguous { label, why });
    }
    ambiguous
}

/// Refuses a continuation below its card that another card of the same file names, too. Returns the names.
fn refuse_shared(
    names: &ContinuationNames,
    chunks: &[Chunk],
    sources: &[Source],
    rest: &mut Part,
) -> HashSet<Vec<u8>> {
    let mut shared = HashSet::new();
    if names.is_empty() {
        return shared;
    }
    let all = askers(names, chunks, sources);
    let mut holders = HashMap::new();
    for a in &all {
        if let Some(at) = a.continuation {
            let key = (a.name.as_slice(), a.at.source);
            holders.entry(key).or_insert((a.at, at));
        }
    }
    for waiting in all.iter().filter(|a| a.continuation.is_none()) {
        let key = (waiting.name.as_slice(), waiting.at.source);
        if let Some(&(holder, at)) = holders.get(&key) {
            let both = lines(waiting.at.min(holder), waiting.at.max(holder), at, sources);
            let why = format!("{both} both name it");
            let label = text_of(&waiting.name);
            refuse(rest, at, DeckFaultKind::Ambiguous { label, why });
            shared.insert(waiting.name.clone());
        }
    }
    shared
}

/// Describes two lines in text, with the file if it differs from the continuation's file.
fn lines(a: Place, b: Place, at: Place, sources: &[Source]) -> String {
    let of = |p: Place| match sources.get(p.source.0 as usize) {
        Some(s) if p.source != at.source => format!(" of `{}`", s.path),
        _ => String::new(),
    };
    format!("lines {}{} and {}{}", a.line, of(a), b.line, of(b))
}

fn refuse(rest: &mut Part, at: Place, what: DeckFaultKind) {
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

fn read_chain(chain: &[Span], sources: &[Source], budget: &AtomicUsize) -> Part {
    let Some((first, more)) = chain.split_first() else {
        return Part::default();
    };
    let claimed = ContinuationNames::default();
    let mut assembler = Assembler::new(first.at.source, budget, &claimed);
    let line = |span: &Span| Line {
        text: span.text(sources),
        start: span.start,
        end: span.end,
        number: span.at.line,
    };
    assembler.line(line(first));
    for span in more {
        assembler.attach_line(line(span));
    }
    assembler.emit();
    assembler.part
}
