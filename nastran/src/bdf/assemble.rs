//! Joins physical lines into cards, with continuations and replication.

use std::sync::atomic::AtomicUsize;

use super::continuation_name::{ContinuationNames, asks, claim, is_marked, key, strip_marks};
use super::emit::emit;
use super::fault::{DeckFaultKind, Fault};
use super::fields::{excerpt, note_fault};
use super::line::{Line, trim, without_comment};
use super::names::NameReader;
use super::part::{DeferredCard, Name, OrphanContinuation, Part, Span};
use super::replicate::{self, Template};
use super::split::{Cut, Lead, cut, is_list_word};
use crate::place::{Place, SourceIx};

/// Unfinished content of the lines since the last finished card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Open {
    Nothing,
    Card,
    /// Fields with `=` and `*(n)`, to be filled from the card before.
    Replica,
    /// Continuation lines of a card that is elsewhere.
    Orphan,
}

/// Reads consecutive lines and fills a [`Part`].
pub(super) struct Assembler<'a, 'b> {
    source: SourceIx,
    budget: &'b AtomicUsize,
    /// Names of continuations that belong to a card other than the card above them.
    claimed: &'b ContinuationNames,
    pub part: Part,
    open: Open,
    name: Name,
    fields: Vec<&'a [u8]>,
    /// Name in field 10 of the last line.
    label: &'a [u8],
    /// The last line ended in a comma.
    comma: bool,
    spans: Vec<Span>,
    /// The finished card before, for replication.
    before_name: Name,
    before: Vec<&'a [u8]>,
    template: Option<Template>,
    names: NameReader,
}

impl<'a, 'b> Assembler<'a, 'b> {
    pub(super) fn new(
        source: SourceIx,
        budget: &'b AtomicUsize,
        claimed: &'b ContinuationNames,
    ) -> Self {
        Assembler {
            source,
            budget,
            claimed,
            part: Part::default(),
            open: Open::Nothing,
            name: Name::default(),
            fields: Vec::with_capacity(64),
            label: &[],
            comma: false,
            spans: Vec::new(),
            before_name: Name::default(),
            before: Vec::with_capacity(64),
            template: None,
            names: NameReader::default(),
        }
    }

    fn span(&self, line: &Line) -> Span {
        Span {
            at: Place {
                source: self.source,
                line: line.number,
            },
            start: line.start,
            end: line.start + line.text.len(),
        }
    }

    /// Reads the next line.
    #[inline]
    pub(super) fn line(&mut self, line: Line<'a>) {
        let body = without_comment(line.text);
        if body.iter().all(|&c| c <= b' ') {
            if body.len() < line.text.len() {
                let at = Place {
                    source: self.source,
                    line: line.number,
                };
                self.names.comment(
                    line.text.get(body.len()..).unwrap_or_default(),
                    at,
                    &mut self.part.labels,
                );
            }
            return;
        }
        let cut = cut(body);
        match cut.lead {
            Lead::Name | Lead::Data if cut.field_1_is_blank() && self.goes_on_with(&cut) => {
                self.continuation(&cut.with_blank_field_1(), &line)
            }
            Lead::Name if self.comma && is_list_word(cut.head) => self.data(&cut, &line),
            Lead::Name => self.card(&cut, &line),
            Lead::Continuation => self.continuation(&cut, &line),
            Lead::Replica => self.replica(&cut, &line),
            Lead::Data => self.data(&cut, &line),
        }
    }

    fn card(&mut self, cut: &Cut<'a>, line: &Line) {
        self.finish();
        let Some(name) = Name::new(cut.head) else {
            return self.not_a_card(line);
        };
        self.open = Open::Card;
        self.name = name;
        self.spans.push(self.span(line));
        self.label = cut.fields(&mut self.fields);
        self.comma = cut.is_open();
        self.names
            .card(name.as_bytes(), &self.fields, &mut self.part.labels);
    }

    /// Returns whether a line with a blank field 1 before its commas continues the open card. It does if the card contains text, or if the line is
    /// not a card.
    fn goes_on_with(&self, cut: &Cut<'a>) -> bool {
        let open = self.open == Open::Card && !self.comma;
        open && (holds_text(self.name.as_bytes()) || Name::new(cut.head).is_none())
    }

    fn not_a_card(&mut self, line: &Line) {
        // An included file may be any file of the machine, so the message does not quote its lines.
        let found = if self.source == SourceIx(0) {
            excerpt(trim(line.text))
        } else {
            String::new()
        };
        let what = DeckFaultKind::NotACard { found };
        let at = Place {
            source: self.source,
            line: line.number,
        };
        note_fault(
            &mut self.part.faults,
            Fault {
                at,
                card: String::new(),
                field: None,
                what,
            },
        );
    }

    fn continuation(&mut self, cut: &Cut<'a>, line: &Line) {
        let wanted = strip_marks(cut.head);
        let asked = wanted.is_empty() || asks(self.label, wanted);
        match self.open {
            Open::Card | Open::Replica if asked || self.takes(wanted) => {
                if !asked {
                    self.part.loose.push(self.span(line));
                }
                self.attach(cut, line)
            }
            Open::Orphan if asked => self.extend_orphan(cut, line),
            _ => self.begin_orphan(cut, line),
        }
    }

    /// Returns whether the open card accepts a continuation of another name: the card asks for no continuation, and no other card asks for this name.
    fn takes(&self, wanted: &[u8]) -> bool {
        let is_free =
            !matches!(self.label, [b'+' | b'*', ..]) || strip_marks(self.label).is_empty();
        is_free && (self.claimed.is_empty() || !self.claimed.contains(&key(wanted)))
    }

    /// Appends a continuation to the card that is open.
    pub(super) fn attach(&mut self, cut: &Cut<'a>, line: &Line) {
        let width = cut.width();
        while !self.fields.len().is_multiple_of(width) {
            self.fields.push(&[]);
        }
        self.spans.push(self.span(line));
        self.label = cut.fields(&mut self.fields);
        self.comma = cut.is_open();
    }

    /// Attaches a continuation line without comparing names.
    pub(super) fn attach_line(&mut self, line: Line<'a>) {
        let mut cut = cut(without_comment(line.text));
        if cut.lead != Lead::Continuation && cut.field_1_is_blank() {
            cut = cut.with_blank_field_1();
        }
        self.attach(&cut, &line);
    }

    fn begin_orphan(&mut self, cut: &Cut<'a>, line: &Line) {
        self.finish();
        let label = key(strip_marks(cut.head));
        let mut scratch = Vec::new();
        self.label = cut.fields(&mut scratch);
        let next = key(strip_marks(self.label));
        let asks = is_marked(self.label);
        self.part.orphans.push(OrphanContinuation {
            label,
            next,
            asks,
            lines: vec![self.span(line)],
            used: false,
        });
        self.open = Open::Orphan;
    }

    fn extend_orphan(&mut self, cut: &Cut<'a>, line: &Line) {
        let mut scratch = Vec::new();
        self.label = cut.fields(&mut scratch);
        let span = self.span(line);
        if let Some(orphan) = self.part.orphans.last_mut() {
            orphan.lines.push(span);
            orphan.next = key(strip_marks(self.label));
            orphan.asks = is_marked(self.label);
        }
    }

    /// Appends a line that begins with data to the card whose last line ended in a comma.
    fn data(&mut self, cut: &Cut<'a>, line: &Line) {
        if self.open != Open::Card || !self.comma {
            self.finish();
            return self.not_a_card(line);
        }
        if self.fields.last().is_some_and(|f| f.is_empty()) {
            self.fields.pop();
        }
        self.spans.push(self.span(line));
        cut.data(&mut self.fields);
        self.label = &[];
        self.comma = self.fields.last().is_some_and(|f| f.is_empty());
    }

    fn replica(&mut self, cut: &Cut<'a>, line: &Line) {
        self.finish();
        self.names.forget();
        if self.before_name == Name::default() {
            let what = DeckFaultKind::Replication {
                found: excerpt(trim(line.text)),
                why: "no card is above it",
            };
            let at = Place {
                source: self.source,
                line: line.number,
            };
            return note_fault(
                &mut self.part.faults,
                Fault {
                    at,
                    card: String::new(),
                    field: None,
                    what,
                },
            );
        }
        self.spans.push(self.span(line));
        match replicate::count(cut.head) {
            Some(n) => self.repeat(n),
            None => {
                self.open = Open::Replica;
                self.label = cut.fields(&mut self.fields);
                self.comma = cut.is_open();
            }
        }
    }

    /// Ends the card that is open, if one is.
    pub(super) fn finish(&mut self) {
        match std::mem::replace(&mut self.open, Open::Nothing) {
            Open::Nothing | Open::Orphan => {}
            Open::Card => {
                if let Some(label) = claim(self.label, self.claimed) {
                    self.part.deferred.push(DeferredCard {
                        label: key(label),
                        lines: self.spans.clone(),
                    });
                } else {
                    self.emit();
                }
                self.before_name = self.name;
                std::mem::swap(&mut self.before, &mut self.fields);
                self.template = None;
            }
            Open::Replica => {
                let before = match self.template.take() {
                    Some(t) => t.card,
                    None => self.before.iter().map(|f| f.to_vec()).collect(),
                };
                let steps = self.fields.iter().map(|f| f.to_vec()).collect();
                self.template = Some(Template {
                    card: before,
                    steps,
                });
                self.repeat(1);
            }
        }
        self.fields.clear();
        self.spans.clear();
        self.label = &[];
        self.comma = false;
    }

    /// Makes `n` cards from the template, each from the card before.
    fn repeat(&mut self, n: usize) {
        let at = self.spans.first().map_or(
            Place {
                source: self.source,
                line: 0,
            },
            |s| s.at,
        );
        let card = super::line::text_of(self.before_name.as_bytes());
        let Some(mut template) = self.template.take() else {
            let what = DeckFaultKind::Replication {
                found: "=(n)".to_owned(),
                why: "no line with increments is above it",
            };
            note_fault(
                &mut self.part.faults,
                Fault {
                    at,
                    card: card.clone(),
                    field: None,
                    what,
                },
            );
            self.spans.clear();
            return;
        };
        // A count that exceeds the memory budget is treated as wrong, and no card is made.
        let n = match replicate::spend(self.budget, &template, n) {
            Ok(()) => n,
            Err(what) => {
                note_fault(
                    &mut self.part.faults,
                    Fault {
                        at,
                        card: card.clone(),
                        field: None,
                        what,
                    },
                );
                0
            }
        };
        for _ in 0..n {
            if let Err(what) = template.advance() {
                note_fault(
                    &mut self.part.faults,
                    Fault {
                        at,
                        card: card.clone(),
                        field: None,
                        what,
                    },
                );
                break;
            }
            let list: Vec<&[u8]> = template.card.iter().map(Vec::as_slice).collect();
            emit(
                self.budget,
                &mut self.part,
                self.before_name,
                at,
                &list,
                &self.spans,
            );
        }
        self.template = Some(template);
        self.spans.clear();
    }

    /// Adds the open card to the part.
    pub(super) fn emit(&mut self) {
        let at = self.spans.first().map_or(
            Place {
                source: self.source,
                line: 0,
            },
            |s| s.at,
        );
        emit(
            self.budget,
            &mut self.part,
            self.name,
            at,
            &self.fields,
            &self.spans,
        );
    }
}

/// Returns whether the card contains text instead of fields, so that commas in its continuations are not separators.
fn holds_text(name: &[u8]) -> bool {
    matches!(
        name,
        b"DEQATN" | b"ADAPT" | b"OUTPUT" | b"OUTRCV" | b"PBMSECT" | b"PBRSECT"
    )
}
