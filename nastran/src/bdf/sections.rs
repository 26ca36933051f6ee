//! Sections of a deck and its included files, in reading order: executive control, case control, bulk data.

use std::collections::BTreeMap;

use super::bulk_scan::{BulkStatement, first_word, scan};
use super::fault::{DeckFaultKind, Fault};
use super::fields::note_fault;
use super::include::{IncludeRequest, LoadedFile, Loader};
use super::include_statement::include_name;
use super::line::{Lines, text_of, without_comment};
use super::missing_sections::{PARTS, is_bulk_entry, missing_statement};
use super::source::{Chunk, Note, Position, SectionBounds, Source};
use crate::place::{Place, SourceIx};

/// Largest depth of files that include each other.
const MAX_DEPTH: usize = 32;
/// Largest number of INCLUDE statements of a deck.
const MAX_INCLUDES: usize = 10_000;
/// Largest number of bytes from files that are included more than once, counted from the second time.
const MAX_REPEATED: usize = 16 << 20;

/// The sections of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    /// No statement has shown yet whether the deck has other sections than bulk data.
    Unknown,
    Executive,
    Case,
    Bulk,
    /// Bulk data of a superelement or auxiliary model: kept as text.
    Part,
}

/// A line of executive or case control.
#[derive(Clone, Debug)]
pub(super) struct Statement {
    pub at: Place,
    /// Offsets of the line and of the next line.
    pub start: usize,
    pub end: usize,
    /// Text without comment, not trimmed on the left.
    pub text: String,
}

/// Reader that separates the sections of a deck.
pub(super) struct Sections<'l> {
    loader: &'l mut dyn Loader,
    pub sources: Vec<Source>,
    section: Section,
    pub executive: Vec<Statement>,
    pub case: Vec<Statement>,
    pub chunks: Vec<Chunk>,
    pub faults: Vec<Fault>,
    pub notes: Vec<Note>,
    /// First lines of bulk data that is kept as text.
    pub parts: Vec<Note>,
    pub bounds: SectionBounds,
    /// Files being read, outermost first.
    stack: Vec<u32>,
    by_path: BTreeMap<String, u32>,
    includes: usize,
    repeated: usize,
    done: bool,
}

/// Reads the sections of the deck in `bytes`, each INCLUDE replaced by the text of its file.
pub(super) fn read_sections<'l>(
    main_path: &str,
    bytes: Vec<u8>,
    loader: &'l mut dyn Loader,
) -> Sections<'l> {
    let mut sections = Sections {
        loader,
        sources: vec![Source {
            path: main_path.to_owned(),
            bytes,
        }],
        section: Section::Unknown,
        executive: Vec::new(),
        case: Vec::new(),
        chunks: Vec::new(),
        faults: Vec::new(),
        notes: Vec::new(),
        parts: Vec::new(),
        bounds: SectionBounds::default(),
        stack: Vec::new(),
        by_path: BTreeMap::from([(main_path.to_owned(), 0)]),
        includes: 0,
        repeated: 0,
        done: false,
    };
    sections.file(0);
    sections.refuse_cards_above_bulk();
    sections.note_missing_end();
    sections
}

impl Sections<'_> {
    fn bytes(&self, source: u32) -> &[u8] {
        self.sources
            .get(source as usize)
            .map(|s| s.bytes.as_slice())
            .unwrap_or_default()
    }

    fn fault(&mut self, at: Place, what: DeckFaultKind) {
        note_fault(
            &mut self.faults,
            Fault {
                at,
                card: "INCLUDE".to_owned(),
                field: None,
                what,
            },
        );
    }

    /// Refuses bulk data in case control, where BEGIN BULK is missing. Adds one fault, at the first entry; the entries are not read.
    fn refuse_cards_above_bulk(&mut self) {
        if self.bounds.bulk_line.is_some() || !self.parts.is_empty() || !self.chunks.is_empty() {
            return;
        }
        if let Some(first) = self.case.iter().position(|s| is_bulk_entry(&s.text)) {
            let why = "BEGIN BULK, which ends case control, is missing above";
            let entry = self.case.split_off(first);
            let fault = entry
                .first()
                .map(|s| missing_statement("BEGIN BULK", s.at, &s.text, why));
            self.faults.extend(fault);
        }
    }

    /// Reports bulk data that no ENDDATA closes. If the file ends within a line, it is cut, which is a fault; otherwise a note is added.
    fn note_missing_end(&mut self) {
        if self.done || self.bounds.bulk_line.is_none() {
            return;
        }
        let bytes = self.bytes(0);
        let line = bytes.iter().filter(|&&b| b == b'\n').count();
        let at = Place {
            source: SourceIx(0),
            line: u32::try_from(line).unwrap_or(u32::MAX),
        };
        if bytes.last().is_some_and(|&b| b != b'\n') {
            note_fault(
                &mut self.faults,
                Fault {
                    at: Place {
                        line: at.line.saturating_add(1),
                        ..at
                    },
                    card: "ENDDATA".to_owned(),
                    field: None,
                    what: DeckFaultKind::CutShort,
                },
            );
        } else {
            let text = "the deck ends without ENDDATA: if it was cut, cards are missing".to_owned();
            self.notes.push(Note { at, text });
        }
    }

    fn note_differing_path(&mut self, at: Place, loaded: &LoadedFile) {
        self.notes.extend(loaded.differing_path.as_ref().map(|differing_path| Note {
            at,
            text: format!(
                "INCLUDE reads `{}`, and not `{differing_path}`, whose contents differ: delete or rename one of the two",
                loaded.path
            ),
        }));
    }

    fn file(&mut self, source: u32) {
        self.stack.push(source);
        let bytes = self.bytes(source);
        let mut at = if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
            3
        } else {
            0
        };
        let mut number = 1;
        if self.section == Section::Unknown {
            self.section = first_section(bytes);
        }
        while !self.done && at < self.bytes(source).len() {
            (at, number) = match self.section {
                Section::Bulk | Section::Part | Section::Unknown => self.bulk(source, at, number),
                Section::Executive | Section::Case => self.control(source, at, number),
            };
        }
        self.stack.pop();
    }

    /// Reads one line of executive or case control (for INCLUDE, all its lines).
    fn control(&mut self, source: u32, at: usize, number: u32) -> (usize, u32) {
        let bytes = self.bytes(source);
        let Some(line) = Lines::new(bytes, at, bytes.len(), number).next() else {
            return (bytes.len(), number);
        };
        let after = (line.end, number.saturating_add(1));
        let word = first_word(line.text);
        let position = Position {
            source: source as usize,
            offset: line.start,
        };
        match word.as_slice() {
            b"INCLUDE" => return self.include(source, line.start, number),
            b"BEGIN" => {
                let is_bulk = self.begin(source, &text_of(without_comment(line.text)), number);
                if is_bulk && self.bounds.bulk_line.is_none() {
                    self.bounds.bulk_line = Some(position);
                }
                return after;
            }
            b"CEND" => {
                self.section = Section::Case;
                self.bounds.case_start = Some(Position {
                    source: source as usize,
                    offset: after.0,
                });
                return after;
            }
            // A deck without BEGIN BULK ends here.
            b"ENDDATA" => {
                self.bounds.enddata = Some(position);
                self.done = true;
                return after;
            }
            b"" if without_comment(line.text).iter().all(|c| *c <= b' ') => return after,
            _ => {}
        }
        let statement = Statement {
            at: Place {
                source: SourceIx(source),
                line: number,
            },
            start: line.start,
            end: line.end,
            text: text_of(statement_text(line.text)),
        };
        if self.section == Section::Executive {
            self.executive.push(statement)
        } else {
            self.case.push(statement)
        }
        after
    }

    /// Begins the bulk data at BEGIN BULK, or a separate part of it. Returns whether it is the main bulk data.
    fn begin(&mut self, source: u32, text: &str, number: u32) -> bool {
        let upper = text.to_ascii_uppercase();
        let what = upper
            .split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|w| !w.is_empty())
            .nth(1)
            .unwrap_or("BULK");
        let at = Place {
            source: SourceIx(source),
            line: number,
        };
        if self.section == Section::Executive {
            let why = "CEND, which ends executive control, is missing above";
            note_fault(&mut self.faults, missing_statement("CEND", at, text, why));
        }
        let is_known = PARTS.contains(&what);
        if !is_known {
            let why = "no part of bulk data has this name, BEGIN BULK is needed";
            note_fault(&mut self.faults, missing_statement("BEGIN", at, text, why));
        }
        let number_is_zero = upper.rsplit('=').next().is_some_and(|n| n.trim() == "0");
        if what == "BULK" && !upper.contains('=') || number_is_zero || !is_known {
            self.section = Section::Bulk;
            return true;
        }
        self.section = Section::Part;
        let text = text.trim();
        self.notes.push(Note {
            at,
            text: format!(
                "`{text}` begins bulk data that is not read: the model lacks its definitions"
            ),
        });
        self.parts.push(Note {
            at,
            text: text.to_ascii_uppercase(),
        });
        false
    }

    /// Reads bulk data up to the next INCLUDE, BEGIN or ENDDATA, and handles this statement.
    fn bulk(&mut self, source: u32, at: usize, number: u32) -> (usize, u32) {
        let read = self.section != Section::Part;
        let mut chunks = std::mem::take(&mut self.chunks);
        let found = scan(
            self.bytes(source),
            source,
            at,
            number,
            if read { Some(&mut chunks) } else { None },
        );
        self.chunks = chunks;
        if self.section == Section::Unknown && !self.chunks.is_empty() {
            self.section = Section::Bulk;
        }
        let Some((special, start, end, line)) = found else {
            return (self.bytes(source).len(), number);
        };
        match special {
            BulkStatement::Include => self.include(source, start, line),
            BulkStatement::Begin => {
                let text = text_of(without_comment(
                    self.bytes(source).get(start..end).unwrap_or_default(),
                ));
                let is_bulk = self.begin(source, &text, line);
                if is_bulk && self.bounds.bulk_line.is_none() {
                    self.bounds.bulk_line = Some(Position {
                        source: source as usize,
                        offset: start,
                    });
                }
                (end, line.saturating_add(1))
            }
            BulkStatement::EndData => {
                self.bounds.enddata = Some(Position {
                    source: source as usize,
                    offset: start,
                });
                self.done = true;
                if self.stack.len() > 1 {
                    let at = Place {
                        source: SourceIx(source),
                        line,
                    };
                    let text = "ENDDATA of an included file ends the deck: the lines after its INCLUDE are not read".to_owned();
                    self.notes.push(Note { at, text });
                }
                (end, line.saturating_add(1))
            }
        }
    }

    /// Reads the statement that begins at `at`; returns where the next line begins.
    fn include(&mut self, source: u32, at: usize, number: u32) -> (usize, u32) {
        let place = Place {
            source: SourceIx(source),
            line: number,
        };
        let bytes = self.bytes(source);
        let mut lines = Lines::new(bytes, at, bytes.len(), number);
        let name = include_name(&mut lines);
        let after = (lines.offset(), lines.number());
        let name = match name {
            Ok(name) => name,
            Err(found) => {
                self.fault(place, DeckFaultKind::IncludeName { found });
                return after;
            }
        };
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            if self.includes == MAX_INCLUDES + 1 {
                self.fault(
                    place,
                    DeckFaultKind::IncludeCount {
                        limit: MAX_INCLUDES,
                    },
                );
            }
            return after;
        }
        if self.stack.len() > MAX_DEPTH {
            self.fault(place, DeckFaultKind::IncludeDepth { limit: MAX_DEPTH });
            return after;
        }
        let path = |ix: u32| {
            self.sources
                .get(ix as usize)
                .map_or_else(String::new, |s| s.path.clone())
        };
        let request = IncludeRequest {
            name,
            first_deck: path(0),
            includer: path(source),
        };
        match self.loader.load(&request) {
            Ok(loaded) => {
                self.note_differing_path(place, &loaded);
                let ix = match self.by_path.get(&loaded.path) {
                    Some(&ix) => {
                        self.repeated = self.repeated.saturating_add(loaded.bytes.len());
                        ix
                    }
                    None => {
                        let ix = u32::try_from(self.sources.len()).unwrap_or(u32::MAX);
                        self.by_path.insert(loaded.path.clone(), ix);
                        self.sources.push(Source {
                            path: loaded.path,
                            bytes: loaded.bytes,
                        });
                        ix
                    }
                };
                if self.stack.contains(&ix) {
                    self.fault(place, DeckFaultKind::IncludeCycle { name: request.name });
                } else if self.repeated > MAX_REPEATED {
                    self.fault(
                        place,
                        DeckFaultKind::IncludeCount {
                            limit: MAX_INCLUDES,
                        },
                    );
                } else {
                    self.file(ix);
                }
            }
            Err(why) => self.fault(
                place,
                DeckFaultKind::IncludeNotFound {
                    name: request.name,
                    why,
                },
            ),
        }
        after
    }
}

/// Returns the statement without its comment; a `$` within quotes is text.
fn statement_text(line: &[u8]) -> &[u8] {
    let mut quote = None;
    for (i, &c) in line.iter().enumerate() {
        match (quote, c) {
            (None, b'$') => return line.get(..i).unwrap_or(line),
            (None, b'\'' | b'"') => quote = Some(c),
            (Some(q), _) if q == c => quote = None,
            _ => {}
        }
    }
    // A quotation mark that is not closed is an apostrophe.
    if quote.is_some() {
        without_comment(line)
    } else {
        line
    }
}

/// Returns whether the file has sections before bulk data, found by statements that bulk data cannot contain.
fn first_section(bytes: &[u8]) -> Section {
    let mut begin = false;
    for line in Lines::new(bytes, 0, bytes.len(), 1) {
        match first_word(line.text).as_slice() {
            b"CEND" | b"SOL" => return Section::Executive,
            b"BEGIN" => {
                begin = true;
                break;
            }
            b"ENDDATA" => break,
            _ => {}
        }
    }
    if begin {
        Section::Case
    } else {
        Section::Unknown
    }
}
