//! Tables and their records, from the keys between the physical records.
//!
//! A file is an optional header (key 3 + date, key 7 + tape label, key 2 + version label, key -1), then tables. A table is key 2 + name, key -1, key
//! 7 + trailer, and records. Record n starts with the keys -n, 1 and type (0 table, 1 matrix column). The data follow after positive keys; solvers
//! split long records into several such pieces. The first record is the sub-table name. Key 0 ends the table. MSC 2020 and later put key 6 + 24 bytes
//! (solver version) after the version label and after each name.

use super::fortran::{Cursor, Physical, Stop};
use super::words::{Format, Words};
use crate::results::{Damage, Note};

/// Kind of a table, from its name and keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TableKind {
    /// Identification records with rows after each.
    Results,
    /// Bulk data: GEOM1 to GEOM4, EPT, MPT, and their variants.
    Geometry,
    /// Columns of a matrix.
    Matrix,
    /// A table of another kind; skipped.
    Unknown,
}

/// A table of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableEntry {
    /// Name, trimmed (`OUGV1`).
    pub name: String,
    /// Name in the table's first record, trimmed; often the name without its last letter.
    pub subtable: String,
    /// The seven words of the trailer.
    pub trailer: [i64; 7],
    /// Kind of the content.
    pub kind: TableKind,
    /// Offset of the first byte.
    pub offset: usize,
    /// Records after the sub-table name.
    pub(super) records: std::ops::Range<usize>,
}

/// A range of bytes of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    pub offset: usize,
    pub len: usize,
}

/// A logical record: its pieces from `first` on, up to the first piece of the next record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    pub first_piece: usize,
    pub pieces: usize,
    pub bytes: usize,
}

/// Tables, records and damage from one pass over a file.
#[derive(Clone, Debug)]
pub(super) struct Container {
    pub tape_label: Option<String>,
    pub version_label: Option<String>,
    pub tables: Vec<TableEntry>,
    pub records: Vec<Record>,
    pub pieces: Vec<Piece>,
    pub notes: Vec<Note>,
    /// Places at which the file contradicts itself, or ends too early.
    pub damage: Vec<Damage>,
    /// Offset at which reading stopped before the end of the file, and the reason.
    pub stopped: Option<(usize, String)>,
}

/// Error within a table: a broken chain of records, or invalid keys.
enum Trouble {
    Stop(Stop),
    Key {
        offset: usize,
        key: i64,
        expected: &'static str,
    },
}

/// Item between the ends of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Item {
    Zero,
    Header,
    Table,
}

impl From<Stop> for Trouble {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

/// Reads the tables and records of `file`.
pub(super) fn read_container(file: &[u8], format: Format) -> Container {
    let mut c = Container {
        tape_label: None,
        version_label: None,
        tables: Vec::new(),
        records: Vec::new(),
        pieces: Vec::new(),
        notes: Vec::new(),
        damage: Vec::new(),
        stopped: None,
    };
    let mut cursor = Cursor::new(file, format);
    let mut closed = false;
    loop {
        let start = cursor.pos;
        match c.read_item(&mut cursor) {
            Ok(item) => closed = item == Item::Zero,
            Err(Trouble::Stop(Stop::End)) if cursor.pos == start => {
                if !closed {
                    // OUTPUT2 files without a header may end here.
                    let what =
                        "the file ends without the closing key 0; further tables may be missing";
                    if c.version_label.is_some() {
                        c.harm(what.to_owned());
                    } else {
                        c.note(what.to_owned());
                    }
                }
                break;
            }
            Err(Trouble::Stop(stop)) => {
                c.note_stop(file, &stop);
                break;
            }
            Err(Trouble::Key {
                offset,
                key,
                expected,
            }) => {
                c.harm(format!("unexpected key {key} at byte {offset}, expected {expected}; went on with the next table"));
                if !skip_to_table(&mut cursor, file, start) {
                    break;
                }
            }
        }
    }
    c
}

impl Container {
    /// Reads a header, a table, or the key 0 between and after tables.
    fn read_item(&mut self, cursor: &mut Cursor<'_>) -> Result<Item, Trouble> {
        let start = cursor.pos;
        match cursor.key()? {
            0 => Ok(Item::Zero),
            2 => self.read_table(cursor, start).map(|()| Item::Table),
            3 => self.read_header(cursor).map(|()| Item::Header),
            key => Err(Trouble::Key {
                offset: start,
                key,
                expected: "0, 2 (table) or 3 (header)",
            }),
        }
    }

    fn read_header(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Trouble> {
        cursor.next()?; // date
        loop {
            let at = cursor.pos;
            match cursor.key()? {
                -1 => return Ok(()),
                key @ 1.. => {
                    let words = Words::new(cursor.next()?.bytes, cursor.format);
                    let label = words.text(0, words.len());
                    match key {
                        2 => self.version_label = Some(label),
                        7 => self.tape_label = Some(label),
                        _ => {}
                    }
                }
                key => {
                    return Err(Trouble::Key {
                        offset: at,
                        key,
                        expected: "-1 after the header",
                    });
                }
            }
        }
    }

    fn read_table(&mut self, cursor: &mut Cursor<'_>, start: usize) -> Result<(), Trouble> {
        let format = cursor.format;
        let name = Words::new(cursor.next()?.bytes, format);
        let mut table = TableEntry {
            name: name.text(0, name.len()),
            subtable: String::new(),
            trailer: [0; 7],
            kind: TableKind::Unknown,
            offset: start,
            records: self.records.len()..self.records.len(),
        };
        let outcome = self.read_records(cursor, &mut table);
        // An empty record precedes the key 0 that ends a table.
        if self.records.len() > table.records.start
            && self.records.last().is_some_and(|r| r.bytes == 0)
        {
            self.records.pop();
        }
        table.records.end = self.records.len();
        self.tables.push(table);
        outcome
    }

    fn read_records(
        &mut self,
        cursor: &mut Cursor<'_>,
        table: &mut TableEntry,
    ) -> Result<(), Trouble> {
        let format = cursor.format;
        let mut number = 0_i64;
        loop {
            let at = cursor.pos;
            match cursor.key()? {
                0 => return Ok(()),
                -1 if number == 0 => {
                    number = 1;
                    let key = cursor.key()?;
                    if key < 1 {
                        return Err(Trouble::Key {
                            offset: at,
                            key,
                            expected: "7 before the trailer",
                        });
                    }
                    let words = Words::new(cursor.next()?.bytes, format);
                    for (i, t) in table.trailer.iter_mut().enumerate() {
                        *t = words.int(i).unwrap_or(0);
                    }
                }
                key if key < 0 => {
                    if number == 0 || key == -1 {
                        return Err(Trouble::Key {
                            offset: at,
                            key,
                            expected: "-1 after the table name",
                        });
                    }
                    // Records are numbered consecutively. A gap is a lost record; a smaller number is a record that is repeated or misplaced.
                    let expected = number.saturating_add(1);
                    number = key.unsigned_abs().try_into().unwrap_or(i64::MAX);
                    if number != expected {
                        self.damage.push(Damage {
                            at: format!("table {}", table.name),
                            what: format!("record {number} was found, expected record {expected}"),
                        });
                    }
                    let one = cursor.key()?;
                    let kind = cursor.key()?;
                    if one != 1 {
                        return Err(Trouble::Key {
                            offset: at,
                            key: one,
                            expected: "1 at the start of a record",
                        });
                    }
                    if kind == 1 {
                        table.kind = TableKind::Matrix;
                    }
                    if number > 2 && table.kind != TableKind::Matrix {
                        self.records.push(Record {
                            first_piece: self.pieces.len(),
                            pieces: 0,
                            bytes: 0,
                        });
                    }
                }
                _ => {
                    let piece = match cursor.next() {
                        Err(Stop::Short { offset, stated }) => {
                            let bytes = cursor.cut_short(offset);
                            self.store(number, table, Physical { offset, bytes });
                            return Err(Stop::Short { offset, stated }.into());
                        }
                        other => other?,
                    };
                    if number == 2 {
                        let words = Words::new(piece.bytes, format);
                        table.subtable = words.text(0, 2);
                    }
                    self.store(number, table, piece);
                }
            }
        }
    }

    /// Adds a piece to the current record; matrices are not kept.
    fn store(&mut self, number: i64, table: &TableEntry, piece: Physical<'_>) {
        let len = piece.bytes.len();
        if number <= 2 || table.kind == TableKind::Matrix || len == 0 {
            return;
        }
        if let Some(record) = self.records.last_mut() {
            record.pieces = record.pieces.saturating_add(1);
            record.bytes = record.bytes.saturating_add(len);
            self.pieces.push(Piece {
                offset: piece.offset,
                len,
            });
        }
    }

    fn note_stop(&mut self, file: &[u8], stop: &Stop) {
        let offset = stop.offset(file);
        self.harm(format!(
            "{stop} at byte {offset} of {}; the tables before it were read",
            file.len()
        ));
        self.stopped = Some((offset, stop.to_string()));
    }

    fn note(&mut self, message: String) {
        let subject = self.describe_position();
        self.notes.push(Note { subject, message });
    }

    fn harm(&mut self, what: String) {
        let at = self.describe_position();
        self.damage.push(Damage { at, what });
    }

    /// Describes the last table and record that were read.
    fn describe_position(&self) -> String {
        self.tables.last().map_or_else(
            || "file".to_owned(),
            |t| format!("table {}, record {}", t.name, t.records.len()),
        )
    }
}

/// Moves to the next position after `from` that looks like a table: key 2, a name, key -1 or 6.
fn skip_to_table(cursor: &mut Cursor<'_>, file: &[u8], from: usize) -> bool {
    cursor.pos = from;
    let _ = cursor.next();
    loop {
        let at = cursor.pos;
        if at >= file.len() {
            return false;
        }
        let mut probe = *cursor;
        if matches!(probe.key(), Ok(2))
            && is_name(probe.next().ok(), cursor.format)
            && matches!(probe.key(), Ok(-1 | 6))
        {
            cursor.pos = at;
            return true;
        }
        cursor.pos = at;
        if cursor.next().is_err() {
            return false;
        }
    }
}

/// Returns whether a record is a table name: two words of printable characters that start with a letter.
fn is_name(record: Option<Physical<'_>>, format: Format) -> bool {
    record.is_some_and(|r| {
        r.bytes.len() == 2 * format.bytes()
            && r.bytes.first().is_some_and(u8::is_ascii_alphabetic)
            && r.bytes
                .iter()
                .all(|c| c.is_ascii_graphic() || matches!(c, b' ' | 0))
    })
}
