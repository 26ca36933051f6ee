//! Records of cards: cards of fixed length with several possible widths, and cards of varying length.

use super::fields::Fields;
use super::unread_records::{Code, UnreadRecord, classify_unread_record};
use crate::cards::{Cards, UnreadEntry};
use crate::op2::words::Words;
use crate::place::{Place, PlacedCard};
use crate::results::Note;

/// Cards read so far, and notes on skipped content.
#[derive(Clone, Debug, Default)]
pub(in crate::op2) struct Geometry {
    pub(in crate::op2) cards: Cards,
    pub(in crate::op2) notes: Vec<Note>,
}

/// A record without its code.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record<'a> {
    pub(super) words: Words<'a>,
    pub(super) table: &'a str,
    /// Number of words of each card, and double precision, if the code states them.
    pub(super) stated: Option<(usize, bool)>,
}

impl<'a> Record<'a> {
    fn is_double(&self) -> bool {
        self.stated.is_some_and(|s| s.1)
    }

    /// Returns all words as fields, for cards of varying length.
    pub(super) fn fields(&self) -> Fields<'a> {
        Fields::new(self.words, self.is_double())
    }

    /// Returns the number of words after the last `mark` in the record, that is after a card's terminator; at most two.
    pub(super) fn tail(&self, mark: i64) -> usize {
        let n = self.words.len();
        (0..n.min(3))
            .find(|back| n.checked_sub(back + 1).and_then(|i| self.words.int(i)) == Some(mark))
            .unwrap_or(0)
    }
}

impl Geometry {
    pub(super) fn note(&mut self, table: &str, message: String) {
        self.notes.push(Note {
            subject: format!("table {table}"),
            message,
        });
    }

    /// Adds the entries of a record without a reader if they act, or a note if they act only if case control selects them.
    pub(super) fn add_unread_entries(&mut self, code: Code, record: Record<'_>) {
        match classify_unread_record(code, record.table, record.words, record.stated.map(|s| s.0)) {
            UnreadRecord::Acting(entries) => {
                let entries = entries.into_iter().map(Self::place);
                self.cards.unread.extend(entries);
            }
            UnreadRecord::Selected(name) => {
                let message = format!(
                    "{name} is not read: case control selects it, and the file contains no case control that is read"
                );
                self.note(record.table, message);
            }
            UnreadRecord::WithoutInfluence => {}
        }
    }

    /// Adds an entry and a note for cards of a record that are omitted.
    fn left_out(&mut self, card: &str, table: &str, message: String) {
        self.note(table, message);
        self.cards.unread.push(Self::place(UnreadEntry {
            name: card.to_owned(),
            id: None,
            is_load: false,
        }));
    }

    pub(super) fn place<T>(card: T) -> PlacedCard<T> {
        PlacedCard {
            card,
            at: Place::default(),
        }
    }

    /// Adds cards of a fixed number of words. This number differs between solvers and versions. The first of `widths` with which all cards are valid
    /// is used, otherwise the width with the fewest invalid cards. Invalid cards are omitted with a note.
    pub(super) fn add_fixed_cards<T>(
        &mut self,
        record: Record<'_>,
        card: &str,
        widths: &[usize],
        parse: impl Fn(&mut Fields<'_>) -> Option<T>,
        list: impl Fn(&mut Cards) -> &mut Vec<PlacedCard<T>>,
    ) {
        let n_words = record.words.len();
        let stated = record
            .stated
            .map(|s| s.0)
            .filter(|w| *w > 0 && n_words.is_multiple_of(*w));
        let widths: Vec<(usize, bool)> = match stated {
            Some(width) => vec![(width, record.is_double())],
            None => widths.iter().map(|w| (*w, record.is_double())).collect(),
        };
        let mut best: Option<(usize, Vec<PlacedCard<T>>)> = None;
        for (width, double) in widths {
            let left_over = usize::from(!n_words.is_multiple_of(width.max(1)));
            let mut failed = left_over;
            let mut cards = Vec::with_capacity(n_words / width.max(1));
            for words in record.words.entries(width) {
                match parse(&mut Fields::new(words, double)) {
                    Some(card) => cards.push(Self::place(card)),
                    None => failed = failed.saturating_add(1),
                }
            }
            if best.as_ref().is_none_or(|b| failed < b.0) {
                best = Some((failed, cards));
            }
            if failed == 0 {
                break;
            }
        }
        let Some((failed, mut cards)) = best else {
            return;
        };
        if failed > 0 {
            let message = format!(
                "{card}: {failed} of {} cards are not valid and were left out",
                cards.len().saturating_add(failed)
            );
            self.left_out(card, record.table, message);
        }
        list(&mut self.cards).append(&mut cards);
    }

    /// Adds cards of varying length; stops with a note at the first invalid card.
    pub(super) fn add_varying_cards<T>(
        &mut self,
        record: Record<'_>,
        card: &str,
        parse: impl Fn(&mut Fields<'_>) -> Option<T>,
        list: impl Fn(&mut Cards) -> &mut Vec<PlacedCard<T>>,
    ) {
        let mut fields = record.fields();
        while fields.words_left() > 0 {
            match parse(&mut fields) {
                Some(card) => list(&mut self.cards).push(Self::place(card)),
                None => {
                    let message = format!(
                        "{card}: the record is not valid from word {} of {} on; the rest was left out",
                        record.words.len().saturating_sub(fields.words_left()),
                        record.words.len()
                    );
                    self.left_out(card, record.table, message);
                    return;
                }
            }
        }
    }
}
