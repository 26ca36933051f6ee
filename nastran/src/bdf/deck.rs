//! A deck as it was read.

use std::collections::BTreeMap;

use super::case::CaseControl;
use super::fault::Fault;
use super::line::{is_blank, text_of, without_comment};
use super::names::{Label, NameOwner};
use super::source::{Note, SectionBounds, Source};
use super::split::{Lead, cut};
use crate::cards::{Cards, Param};
use crate::place::Place;

/// A card without a dedicated struct, kept as text.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherCard {
    /// Upper case, without `*`.
    pub name: String,
    /// First field if it is an integer from 0: the id of an element or a set.
    pub first: Option<u32>,
    /// First line of the card.
    pub at: Place,
    /// Bytes from the first line to the end of the last line, comments between them included.
    pub(super) start: usize,
    pub(super) end: usize,
}

/// A deck: its bytes, its typed cards, and all its faults.
#[derive(Clone, Debug, Default)]
pub struct Deck {
    /// The files, the main deck first; places refer to this list.
    pub sources: Vec<Source>,
    /// Typed cards.
    pub cards: Cards,
    /// Number of cards by name, replicated cards included; ENDDATA counts 1.
    pub counts: BTreeMap<String, usize>,
    /// Cards without a struct, in file order.
    pub others: Vec<OtherCard>,
    /// Case control.
    pub case_control: CaseControl,
    /// Solution number, also for a named SOL (`SESTATIC` is 101).
    pub sol: Option<u32>,
    /// SOL as written.
    pub sol_text: Option<String>,
    /// Place of SOL.
    pub sol_at: Place,
    /// The approach that APP states, upper case, such as HEAT.
    pub approach: Option<(String, Place)>,
    /// Statements above CEND that change the solution sequence or start from an earlier run: the first keyword of each, in upper case.
    pub program_changes: Vec<Note>,
    /// Bulk data of superelements and other models that is kept and not read: its place, and its first line in upper case.
    pub parts: Vec<Note>,
    /// Faults of the deck.
    pub faults: Vec<Fault>,
    /// Further notes on the deck.
    pub notes: Vec<Note>,
    /// Names in comments.
    pub labels: Vec<Label>,
    pub(super) bounds: SectionBounds,
}

impl Deck {
    /// Returns whether the text contains no part of a deck: no section, and no card with a struct.
    pub(super) fn is_empty(&self) -> bool {
        self.bounds == SectionBounds::default()
            && self.sol_text.is_none()
            && self.case_control.lines.is_empty()
            && self.cards == Cards::default()
            && self.others.iter().all(|c| c.first.is_none())
    }

    /// Returns the text of a card that has no struct; bytes that are not UTF-8 are read as Latin-1.
    pub fn text(&self, card: &OtherCard) -> String {
        let source = self.sources.get(card.at.source.0 as usize);
        text_of(
            source
                .and_then(|s| s.bytes.get(card.start..card.end))
                .unwrap_or_default(),
        )
    }

    /// Returns the fields after the name of a card that has no struct, trimmed and in upper case; blank fields are empty.
    pub fn fields(&self, card: &OtherCard) -> Vec<String> {
        let source = self.sources.get(card.at.source.0 as usize);
        let bytes = source.and_then(|s| s.bytes.get(card.start..card.end));
        let lines = bytes.unwrap_or_default().split(|&c| c == b'\n');
        let mut fields = Vec::new();
        for line in lines
            .map(without_comment)
            .filter(|l| !l.iter().all(|&c| is_blank(c)))
        {
            let cut = cut(line);
            match cut.lead {
                Lead::Data => cut.data(&mut fields),
                _ => drop(cut.fields(&mut fields)),
            }
        }
        let upper = |f: &&[u8]| text_of(f).to_ascii_uppercase();
        fields.iter().map(upper).collect()
    }

    /// Returns the path of the file of a place.
    pub fn path(&self, at: Place) -> &str {
        self.sources
            .get(at.source.0 as usize)
            .map_or("", |s| s.path.as_str())
    }

    /// Returns the name that a comment gives this property, component or material.
    pub fn label(&self, kind: NameOwner, id: u32) -> Option<&str> {
        self.labels
            .iter()
            .find(|l| l.kind == kind && l.id == id)
            .map(|l| l.name.as_str())
    }

    /// Returns the value of a parameter. Case control above the subcases takes precedence over bulk data; a later value takes precedence over an
    /// earlier one.
    pub fn param(&self, name: &str) -> Option<&Param> {
        let bulk = self
            .cards
            .params
            .iter()
            .rev()
            .find(|p| p.name == name)
            .map(|p| &p.card);
        self.case_control
            .global
            .params
            .iter()
            .rev()
            .find(|p| p.name == name)
            .or(bulk)
    }
}
