//! Edits of a deck: cards replaced, removed, added.

use super::super::continuation_name::strip_marks;
use super::super::deck::Deck;
use super::super::line::{Line, Lines, trim, without_comment};
use super::super::source::Position;
use super::super::split::{Lead, cut, is_list_word};
use crate::place::Place;

/// Why an edit cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// No card begins at the place.
    #[error("no card begins at line {}: read the deck again before editing it", .0.line)]
    NoCard(Place),
    /// The card is made by replication, or others are made from it.
    #[error("the card at line {} is part of a replication: write the cards out first", .0.line)]
    Replicated(Place),
    /// Continuation lines are elsewhere in the deck.
    #[error("the continuations of the card at line {} are elsewhere: put them below it first", .0.line)]
    ContinuationsApart(Place),
}

/// Bytes of a source replaced by others.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Patch {
    source: usize,
    start: usize,
    end: usize,
    /// Lines ended by `\n`, written with the line ending of the file.
    text: String,
    /// Whether the patch follows other patches at the same bytes.
    is_last: bool,
}

/// Edits of one deck. The deck stays unchanged; [`write_edited`] applies the edits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edits {
    patches: Vec<Patch>,
}

/// Returns the files of the deck as they were read: path and bytes, the main deck first.
pub fn write_deck(deck: &Deck) -> Vec<(String, Vec<u8>)> {
    write_edited(deck, &Edits::default())
}

/// Returns the files of the deck with the edits made. Lines that no edit touches keep every byte.
///
/// # Example
/// ```
/// use nastran::bdf::{Edits, MemoryLoader, read_deck, write_deck, write_edited};
///
/// let text = "$ rails\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.  $ front\nPSHELL,1,1,6.,1\nENDDATA\n";
/// let deck = read_deck("frame.bdf", text.into(), &mut MemoryLoader::default());
/// assert_eq!(write_deck(&deck), [("frame.bdf".to_owned(), text.as_bytes().to_vec())]);
///
/// let mut edits = Edits::default();
/// edits.replace_card(&deck, deck.cards.pshells[0].at, "PSHELL,1,1,8.,1")?;
/// let (_, edited) = &write_edited(&deck, &edits)[0];
/// assert_eq!(String::from_utf8_lossy(edited), text.replace("6.", "8."));
/// # Ok::<(), nastran::bdf::EditError>(())
/// ```
pub fn write_edited(deck: &Deck, edits: &Edits) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::with_capacity(deck.sources.len());
    for (ix, source) in deck.sources.iter().enumerate() {
        let mut patches: Vec<&Patch> = edits.patches.iter().filter(|p| p.source == ix).collect();
        patches.sort_by_key(|p| (p.start, p.is_last, p.end));
        let ending = line_ending(&source.bytes);
        let mut bytes = Vec::with_capacity(source.bytes.len() + 64);
        let mut at = 0;
        for patch in patches {
            bytes.extend_from_slice(source.bytes.get(at..patch.start).unwrap_or_default());
            if !patch.text.is_empty()
                && !matches!(bytes.last(), None | Some(b'\n' | b'\r'))
                && patch.start > 0
            {
                bytes.extend_from_slice(ending.as_bytes());
            }
            bytes.extend_from_slice(patch.text.replace('\n', ending).as_bytes());
            at = at.max(patch.end);
        }
        bytes.extend_from_slice(source.bytes.get(at..).unwrap_or_default());
        files.push((source.path.clone(), bytes));
    }
    files
}

/// Returns the line ending of a file, by its first line.
fn line_ending(bytes: &[u8]) -> &'static str {
    match memchr::memchr2(b'\n', b'\r', bytes) {
        Some(i) if bytes.get(i) == Some(&b'\r') => {
            if bytes.get(i + 1) == Some(&b'\n') {
                "\r\n"
            } else {
                "\r"
            }
        }
        _ => "\n",
    }
}

impl Edits {
    /// Replaces the bytes by `text` (whole lines).
    pub(super) fn patch(&mut self, source: usize, start: usize, end: usize, text: &str) {
        let mut text = text.to_owned();
        if !text.is_empty() && !text.ends_with('\n') {
            text.push('\n');
        }
        let is_last = false;
        self.patches.push(Patch {
            source,
            start,
            end,
            text,
            is_last,
        });
    }

    /// Adds ENDDATA at the end of the main deck, after all other edits.
    pub(super) fn end_with_enddata(&mut self, deck: &Deck) {
        let end = deck.sources.first().map_or(0, |s| s.bytes.len());
        self.patch(0, end, end, "ENDDATA");
        if let Some(patch) = self.patches.last_mut() {
            patch.is_last = true;
        }
    }

    /// Replaces the card that begins at `at` by `text`; comments between the card's lines remain.
    ///
    /// # Errors
    ///
    /// The card is replicated, or its lines are not consecutive.
    pub fn replace_card(&mut self, deck: &Deck, at: Place, text: &str) -> Result<(), EditError> {
        let mut text = Some(text);
        for (start, end) in card_lines(deck, at)? {
            self.patch(
                at.source.0 as usize,
                start,
                end,
                text.take().unwrap_or_default(),
            );
        }
        Ok(())
    }

    /// Removes the card that begins at `at`; comments remain.
    ///
    /// # Errors
    ///
    /// The card is replicated, or its lines are not consecutive.
    pub fn remove_card(&mut self, deck: &Deck, at: Place) -> Result<(), EditError> {
        self.replace_card(deck, at, "")
    }

    /// Adds cards (whole lines) before ENDDATA, or at the end of the main deck if it has no ENDDATA.
    pub fn insert_cards(&mut self, deck: &Deck, text: &str) {
        let end = deck.sources.first().map_or(0, |s| s.bytes.len());
        let Position { source, offset } = deck.bounds.enddata.unwrap_or(Position {
            source: 0,
            offset: end,
        });
        self.patch(source, offset, offset, text);
    }
}

/// Returns start and end, line ending included, of the physical lines of the card that begins at `at`.
fn card_lines(deck: &Deck, at: Place) -> Result<Vec<(usize, usize)>, EditError> {
    let bytes = deck
        .sources
        .get(at.source.0 as usize)
        .map(|s| s.bytes.as_slice())
        .unwrap_or_default();
    let skip = if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
        3
    } else {
        0
    };
    let mut lines = Lines::new(bytes, skip, bytes.len(), 1).skip_while(|l| l.number < at.line);
    let is_empty = |l: &Line| trim(without_comment(l.text)).is_empty();
    let first = lines
        .next()
        .filter(|l| l.number == at.line && !is_empty(l))
        .ok_or(EditError::NoCard(at))?;
    let first_cut = cut(without_comment(first.text));
    match first_cut.lead {
        Lead::Name => {}
        Lead::Replica => return Err(EditError::Replicated(at)),
        _ => return Err(EditError::NoCard(at)),
    }
    let mut scratch = Vec::new();
    let mut label = first_cut.fields(&mut scratch);
    let mut open = first_cut.is_open();
    let mut spans = vec![(first.start, first.end)];
    for line in lines.filter(|l| !is_empty(l)) {
        let cut = cut(without_comment(line.text));
        let (wanted, have) = (strip_marks(cut.head), strip_marks(label));
        let named = matches!(label.first(), Some(b'+' | b'*'));
        let fits = wanted.is_empty() || have.is_empty() || wanted == have || !named;
        match cut.lead {
            Lead::Continuation if fits => label = cut.fields(&mut scratch),
            Lead::Data if open => {}
            Lead::Name if open && is_list_word(cut.head) => {}
            Lead::Replica => return Err(EditError::Replicated(at)),
            _ => break,
        }
        open = cut.is_open();
        spans.push((line.start, line.end));
    }
    // The named continuation is not on the next line.
    if matches!(label, [b'+' | b'*', rest @ ..] if !trim(rest).is_empty()) {
        return Err(EditError::ContinuationsApart(at));
    }
    Ok(spans)
}
