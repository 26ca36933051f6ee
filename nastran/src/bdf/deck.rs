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

/// A card without a dedicated struct, kept word for word.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherCard {
    /// Upper case, without `*`.
    pub name: String,
    /// First field where that is an integer from 0: the id of an element or a set.
    pub first: Option<u32>,
    /// First line of the card.
    pub at: Place,
    /// Bytes of its first line to the end of its last, comments between included.
    pub(super) start: usize,
    pub(super) end: usize,
}

/// A deck: its bytes, its typed cards, and everything that is wrong with it.
#[derive(Clone, Debug, Default)]
pub struct Deck {
    /// The files, the first deck first; places point here.
    pub sources: Vec<Source>,
    /// Typed cards.
    pub cards: Cards,
    /// Number of cards by name, replicated cards included; ENDDATA counts 1.
    pub counts: BTreeMap<String, usize>,
    /// Cards without a struct, in file order.
    pub others: Vec<OtherCard>,
    /// Case control.
    pub case_control: CaseControl,
    /// Solution number, also where SOL names it (`SESTATIC` is 101).
    pub sol: Option<u32>,
    /// SOL as written.
    pub sol_text: Option<String>,
    /// Place of SOL.
    pub sol_at: Place,
    /// The approach that APP states, upper case, such as HEAT.
    pub approach: Option<(String, Place)>,
    /// Statements above CEND that change the solution sequence or start from an earlier run: their first word in upper case.
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
    /// Whether the text contains nothing of a deck: no section, no card with a struct.
    pub(super) fn is_empty(&self) -> bool {
        self.bounds == SectionBounds::default()
            && self.sol_text.is_none()
            && self.case_control.lines.is_empty()
            && self.cards == Cards::default()
            && self.others.iter().all(|c| c.first.is_none())
    }

    /// The text of a card that has no struct; bytes that are not UTF-8 as Latin-1.
    pub fn text(&self, card: &OtherCard) -> String {
        let source = self.sources.get(card.at.source.0 as usize);
        text_of(
            source
                .and_then(|s| s.bytes.get(card.start..card.end))
                .unwrap_or_default(),
        )
    }

    /// Returns the fields behind the name of a card that has no struct, trimmed, upper case; blank fields are empty.
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

    /// The file's path at a place.
    pub fn path(&self, at: Place) -> &str {
        self.sources
            .get(at.source.0 as usize)
            .map_or("", |s| s.path.as_str())
    }

    /// The name that a comment gives this property, component or material.
    pub fn label(&self, kind: NameOwner, id: u32) -> Option<&str> {
        self.labels
            .iter()
            .find(|l| l.kind == kind && l.id == id)
            .map(|l| l.name.as_str())
    }

    /// The value of a parameter: case control above the subcases wins over bulk data, later over earlier.
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
