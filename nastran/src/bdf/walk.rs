//! Walks through a deck and its included files in reading order: which lines belong to which section.

use std::collections::BTreeMap;

use super::chunk::{CHUNK_BYTES, Chunk};
use super::deck::{Note, Position, Seams, Source};
use super::fault::{Fault, Wrong};
use super::fields::{excerpt, note_fault};
use super::include::{IncludeRequest, Loader};
use super::line::{Line, Lines, is_blank, text_of, trim, without_comment};
use crate::place::{Place, SourceIx};

/// Files included within files.
const MAX_DEPTH: usize = 32;
/// INCLUDE statements of a deck.
const MAX_INCLUDES: usize = 10_000;
/// Bytes of files that are included more than once, counted from the second time.
const MAX_REPEATED: usize = 16 << 20;
/// Lines of one INCLUDE statement.
const MAX_NAME_LINES: usize = 16;

/// The sections of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    /// No statement has shown yet whether the deck has other sections than bulk data.
    Unknown,
    Executive,
    Case,
    Bulk,
    /// Bulk data of a superelement or auxiliary model: kept, not read.
    Part,
}

/// A line of executive or case control.
#[derive(Clone, Debug)]
pub(super) struct Statement {
    pub at: Place,
    /// Offset of the line and of the next.
    pub start: usize,
    pub end: usize,
    /// Without comment, not trimmed on the left.
    pub text: String,
}

/// Sections told apart.
pub(super) struct Walk<'l> {
    loader: &'l mut dyn Loader,
    pub sources: Vec<Source>,
    section: Section,
    pub executive: Vec<Statement>,
    pub case: Vec<Statement>,
    pub chunks: Vec<Chunk>,
    pub faults: Vec<Fault>,
    pub notes: Vec<Note>,
    pub seams: Seams,
    /// Files being read, outermost first.
    stack: Vec<u32>,
    by_path: BTreeMap<String, u32>,
    includes: usize,
    repeated: usize,
    done: bool,
}

/// A line of bulk data that is no card.
enum Special {
    Include,
    Begin,
    EndData,
}

/// Walks through the deck.
pub(super) fn walk<'l>(main_path: &str, bytes: Vec<u8>, loader: &'l mut dyn Loader) -> Walk<'l> {
    let mut walk = Walk {
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
        seams: Seams::default(),
        stack: Vec::new(),
        by_path: BTreeMap::from([(main_path.to_owned(), 0)]),
        includes: 0,
        repeated: 0,
        done: false,
    };
    walk.file(0);
    walk
}

impl Walk<'_> {
    fn bytes(&self, source: u32) -> &[u8] {
        self.sources
            .get(source as usize)
            .map(|s| s.bytes.as_slice())
            .unwrap_or_default()
    }

    fn fault(&mut self, at: Place, what: Wrong) {
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

    /// One line of executive or case control (INCLUDE: its lines).
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
                if is_bulk && self.seams.bulk_line.is_none() {
                    self.seams.bulk_line = Some(position);
                }
                return after;
            }
            b"CEND" => {
                self.section = Section::Case;
                self.seams.case_start = Some(Position {
                    source: source as usize,
                    offset: after.0,
                });
                return after;
            }
            // a deck without BEGIN BULK ends here
            b"ENDDATA" => {
                self.seams.enddata = Some(position);
                self.done = true;
                return after;
            }
            b"" => return after,
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

    /// BEGIN BULK, or a part of its own; whether it is the main bulk data.
    fn begin(&mut self, source: u32, text: &str, number: u32) -> bool {
        let upper = text.to_ascii_uppercase();
        let what = upper
            .split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|w| !w.is_empty())
            .nth(1)
            .unwrap_or("BULK");
        let number_is_zero = upper.rsplit('=').next().is_some_and(|n| n.trim() == "0");
        if what == "BULK" && !upper.contains('=') || number_is_zero {
            self.section = Section::Bulk;
            return true;
        }
        self.section = Section::Part;
        let at = Place {
            source: SourceIx(source),
            line: number,
        };
        self.notes.push(Note {
            at,
            text: format!("`{}` is kept but not read", text.trim()),
        });
        false
    }

    /// Bulk data up to the next INCLUDE, BEGIN or ENDDATA, which is dealt with.
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
            Special::Include => self.include(source, start, line),
            Special::Begin => {
                let text = text_of(without_comment(
                    self.bytes(source).get(start..end).unwrap_or_default(),
                ));
                let is_bulk = self.begin(source, &text, line);
                if is_bulk && self.seams.bulk_line.is_none() {
                    self.seams.bulk_line = Some(Position {
                        source: source as usize,
                        offset: start,
                    });
                }
                (end, line.saturating_add(1))
            }
            Special::EndData => {
                self.seams.enddata = Some(Position {
                    source: source as usize,
                    offset: start,
                });
                self.done = true;
                if self.stack.len() > 1 {
                    let at = Place {
                        source: SourceIx(source),
                        line,
                    };
                    let text = "ENDDATA of an included file ends the deck: what follows its INCLUDE is not read".to_owned();
                    self.notes.push(Note { at, text });
                }
                (end, line.saturating_add(1))
            }
        }
    }

    /// The statement that begins at `at`; returns where the next line begins.
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
                self.fault(place, Wrong::IncludeName { found });
                return after;
            }
        };
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            if self.includes == MAX_INCLUDES + 1 {
                self.fault(
                    place,
                    Wrong::IncludeCount {
                        limit: MAX_INCLUDES,
                    },
                );
            }
            return after;
        }
        if self.stack.len() > MAX_DEPTH {
            self.fault(place, Wrong::IncludeDepth { limit: MAX_DEPTH });
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
                    self.fault(place, Wrong::IncludeCycle { name: request.name });
                } else if self.repeated > MAX_REPEATED {
                    self.fault(
                        place,
                        Wrong::IncludeCount {
                            limit: MAX_INCLUDES,
                        },
                    );
                } else {
                    self.file(ix);
                }
            }
            Err(why) if matches!(self.section, Section::Executive | Section::Case) => {
                let text = format!("the included file `{}` is left out: {why}", request.name);
                self.notes.push(Note { at: place, text });
            }
            Err(why) => self.fault(
                place,
                Wrong::IncludeNotFound {
                    name: request.name,
                    why,
                },
            ),
        }
        after
    }
}

/// Cuts bulk data into chunks; stops at the first INCLUDE, BEGIN or ENDDATA and returns it with start, end and line.
fn scan(
    bytes: &[u8],
    source: u32,
    at: usize,
    number: u32,
    mut chunks: Option<&mut Vec<Chunk>>,
) -> Option<(Special, usize, usize, u32)> {
    let mut chunk = Chunk {
        source,
        start: at,
        end: at,
        line: number,
    };
    let mut close = |chunk: &Chunk, end: usize| {
        if let Some(chunks) = chunks.as_mut()
            && end > chunk.start
        {
            chunks.push(Chunk { end, ..*chunk });
        }
    };
    let mut before: &[u8] = &[];
    for line in Lines::new(bytes, at, bytes.len(), number) {
        if let Some(special) = special(line.text) {
            close(&chunk, line.start);
            return Some((special, line.start, line.end, line.number));
        }
        if line.start - chunk.start >= CHUNK_BYTES
            && line.text.first().is_some_and(u8::is_ascii_alphabetic)
            && is_closed(before)
        {
            close(&chunk, line.start);
            chunk = Chunk {
                source,
                start: line.start,
                end: line.start,
                line: line.number,
            };
        }
        before = line.text;
    }
    close(&chunk, bytes.len());
    None
}

/// Whether a card may begin after this line: it is no comment and does not end in a comma.
fn is_closed(line: &[u8]) -> bool {
    let body = without_comment(line);
    body.iter()
        .rev()
        .find(|&&c| !is_blank(c))
        .is_some_and(|&c| c != b',')
}

#[inline]
fn special(line: &[u8]) -> Option<Special> {
    let first = *line.first()?;
    if !matches!(
        first,
        b'E' | b'e' | b'I' | b'i' | b'B' | b'b' | b' ' | b'\t'
    ) {
        return None;
    }
    let start = line.iter().position(|&c| !is_blank(c))?;
    if !matches!(line.get(start)?, b'E' | b'e' | b'I' | b'i' | b'B' | b'b') {
        return None;
    }
    match first_word(line).as_slice() {
        b"ENDDATA" => Some(Special::EndData),
        b"INCLUDE" => Some(Special::Include),
        b"BEGIN" => Some(Special::Begin),
        _ => None,
    }
}

/// The first word in upper case, at most 12 letters; empty for blank lines and comments.
pub(super) fn first_word(line: &[u8]) -> Vec<u8> {
    let line = trim(line);
    line.iter()
        .take(12)
        .take_while(|c| c.is_ascii_alphanumeric())
        .map(u8::to_ascii_uppercase)
        .collect()
}

/// The statement without its comment; a `$` within quotes is text.
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
    // an unclosed quote is an apostrophe
    if quote.is_some() {
        without_comment(line)
    } else {
        line
    }
}

/// Whether the file has sections before bulk data, by statements that no bulk data has.
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

/// The file name of an INCLUDE statement, which may go on over several lines.
fn include_name(lines: &mut Lines) -> Result<String, String> {
    let first = lines.next().map(|l: Line| l.text).unwrap_or_default();
    let rest = trim(trim(first).get(7..).unwrap_or_default());
    let rest = rest.strip_prefix(b"=").map_or(rest, trim);
    match rest.first() {
        Some(&quote @ (b'\'' | b'"')) => {
            let mut name = Vec::new();
            let mut part = rest.get(1..).unwrap_or_default();
            for _ in 0..MAX_NAME_LINES {
                if let Some(end) = memchr::memchr(quote, part) {
                    name.extend_from_slice(trim(part.get(..end).unwrap_or_default()));
                    return Ok(text_of(&name));
                }
                name.extend_from_slice(trim(part));
                // a comma at the end of a line only says that the name goes on
                if name.last() == Some(&b',') {
                    name.pop();
                }
                let Some(next) = lines.next() else {
                    break;
                };
                part = next.text;
            }
            Err(excerpt(rest))
        }
        Some(_) => {
            let mut name = Vec::new();
            let mut part = without_comment_after_blank(rest);
            for _ in 0..MAX_NAME_LINES {
                match trim(part) {
                    [head @ .., b','] => name.extend_from_slice(head),
                    all => {
                        name.extend_from_slice(all);
                        break;
                    }
                }
                part = lines.next().map(|l: Line| l.text).unwrap_or_default();
            }
            if name.is_empty() {
                Err(String::new())
            } else {
                Ok(text_of(&name))
            }
        }
        None => Err(String::new()),
    }
}

/// A `$` that follows a blank begins a comment; at the start of a name it is a symbol.
fn without_comment_after_blank(s: &[u8]) -> &[u8] {
    match memchr::memmem::find(s, b" $") {
        Some(i) => s.get(..i).unwrap_or(s),
        None => s,
    }
}
