//! Public view of an OP2 file.

use std::borrow::Cow;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::container::{Container, Piece, Record, TableEntry, TableKind, read_container};
use super::error::{Op2Error, UnsupportedRows};
use super::geom::{Geometry, read_params, read_record, tidy};
use super::index::{Index, Span, index};
use super::rows::decode;
use super::weight::read_weight;
use super::words::{ByteOrder, Format, Words};
use crate::cards::Cards;
use crate::results::{Block, GridPointWeight, Note, Quantity, Rows, SalvagedFile};

/// Solver that wrote a file, by its labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Solver {
    Msc,
    Nx,
    Optistruct,
    Autodesk,
    Mystran,
    /// The file has no header, or an unknown label.
    Unknown,
}

/// Index of an OP2 file from one pass over the file; rows are decoded on request.
#[derive(Clone, Debug)]
pub struct Op2<'a> {
    file: &'a [u8],
    format: Format,
    /// Solver that wrote the file.
    pub solver: Solver,
    /// Version label of the header (`XXXXXXXX`, `NX2019.2`); `None` for a file without a header.
    pub version_label: Option<String>,
    /// Bytes of a word, 4 or 8.
    pub word_bytes: usize,
    /// Order of the bytes in a word.
    pub byte_order: ByteOrder,
    /// Every table, in file order.
    pub tables: Vec<TableEntry>,
    /// Every result block, in file order.
    pub blocks: Vec<Block>,
    /// Notes on skipped content.
    pub notes: Vec<Note>,
    spans: Vec<Span>,
    weight: Option<usize>,
    records: Vec<Record>,
    pieces: Vec<Piece>,
}

impl<'a> Op2<'a> {
    /// Indexes the tables and blocks of a whole file; no row is decoded.
    ///
    /// # Errors
    ///
    /// [`Op2Error::Damaged`] for a file that is cut short or contradicts itself, and every error of [`Op2::salvage`].
    pub fn read(file: &'a [u8]) -> Result<Op2<'a>, Op2Error> {
        Self::salvage(file)?
            .require_undamaged()
            .map_err(Op2Error::Damaged)
    }

    /// Indexes the readable part of a file that may be cut or damaged, with the damage. Tables may be missing, and the last block may lack rows.
    ///
    /// # Errors
    ///
    /// [`Op2Error::NotOp2`], or [`Op2Error::NoTable`] if not even one table could be read.
    pub fn salvage(file: &'a [u8]) -> Result<SalvagedFile<Op2<'a>>, Op2Error> {
        let first = || file.get(..file.len().min(8)).unwrap_or(&[]).to_vec();
        let format = Format::detect(file).ok_or_else(|| Op2Error::NotOp2 { first: first() })?;
        let mut c: Container = read_container(file, format);
        if c.tables.is_empty() {
            if let Some((offset, what)) = c.stopped {
                return Err(Op2Error::NoTable { offset, what });
            }
            if c.version_label.is_none() {
                return Err(Op2Error::NotOp2 { first: first() });
            }
        }
        let Index {
            blocks,
            spans,
            weight,
        } = index(file, format, &mut c);
        let damage = std::mem::take(&mut c.damage);
        let op2 = Op2 {
            file,
            format,
            solver: solver(&c),
            version_label: c.version_label,
            word_bytes: format.bytes(),
            byte_order: format.order,
            tables: c.tables,
            blocks,
            notes: c.notes,
            spans,
            weight,
            records: c.records,
            pieces: c.pieces,
        };
        Ok(SalvagedFile { file: op2, damage })
    }

    /// Returns the rows of block `block` (an index of [`Op2::blocks`]).
    ///
    /// # Errors
    ///
    /// [`Op2Error::Unsupported`] for complex, SORT2 and random results and for unknown layouts; [`Op2Error::BadId`] in a damaged record;
    /// [`Op2Error::NoBlock`].
    pub fn rows(&self, block: usize) -> Result<Rows, Op2Error> {
        let (Some(b), Some(span)) = (self.blocks.get(block), self.spans.get(block)) else {
            return Err(Op2Error::NoBlock {
                block,
                count: self.blocks.len(),
            });
        };
        let place = |why| self.unsupported_error(b, span, why);
        if b.complex {
            return Err(place(UnsupportedRows::Complex));
        }
        if b.sort2 && span.entity.is_none() {
            return Err(place(UnsupportedRows::Sort2));
        }
        if span.random {
            return Err(place(UnsupportedRows::Random));
        }
        let Some(layout) = span.layout else {
            return Err(place(match (b.quantity, b.element) {
                (Quantity::Other, _) => UnsupportedRows::Quantity {
                    table_code: span.table_code,
                },
                (_, Some(element)) => UnsupportedRows::Layout {
                    element,
                    num_wide: b.num_wide,
                },
                (_, None) => UnsupportedRows::Nodal {
                    num_wide: b.num_wide,
                },
            }));
        };
        let bytes = self.record_bytes(span.record);
        decode(Words::new(&bytes, self.format), layout, span.entity).map_err(|bad| {
            let (record, offset) = self.locate(span);
            Op2Error::BadId {
                table: b.table.clone(),
                record,
                offset,
                row: bad.row,
                found: bad.found,
            }
        })
    }

    /// Returns the solver's mass matrix, if the file contains table OGPWG.
    pub fn grid_point_weight(&self) -> Option<GridPointWeight> {
        let rows = self.weight?;
        let ident = self.record_bytes(rows.checked_sub(1)?);
        let reference = Words::new(&ident, self.format)
            .int(2)
            .and_then(|v| u32::try_from(v).ok())
            .unwrap_or(0);
        read_weight(Words::new(&self.record_bytes(rows), self.format), reference)
    }

    /// Returns the cards of the geometry blocks, and notes on skipped content. A card in two tables (`GEOM1` and `GEOM1S`) is returned once. Cards
    /// that the solver derives from other cards (PSHELL of a PCOMP, PBAR of a PBARL) are omitted.
    pub fn cards(&self) -> (Cards, Vec<Note>) {
        let mut out = Geometry::default();
        let mut seen: HashSet<(usize, u64)> = HashSet::new();
        for table in &self.tables {
            let parameters = matches!(table.name.as_str(), "PVT0" | "PVT" | "PVTS");
            for record in table.records.clone() {
                let bytes = self.record_bytes(record);
                let words = Words::new(&bytes, self.format);
                if parameters {
                    read_params(words, &mut out);
                } else if table.kind == TableKind::Geometry
                    && seen.insert((bytes.len(), fingerprint(&bytes)))
                {
                    read_record(&table.name, words, &mut out);
                }
            }
        }
        tidy(&mut out);
        (out.cards, out.notes)
    }

    /// Returns the bytes of a record: borrowed if the record is one piece, otherwise joined.
    fn record_bytes(&self, record: usize) -> Cow<'a, [u8]> {
        let Some(r) = self.records.get(record) else {
            return Cow::Borrowed(&[]);
        };
        let end = r.first_piece.saturating_add(r.pieces);
        let pieces = self.pieces.get(r.first_piece..end).unwrap_or(&[]);
        let bytes = |p: &Piece| {
            self.file
                .get(p.offset..p.offset.saturating_add(p.len))
                .unwrap_or(&[])
        };
        match pieces {
            [] => Cow::Borrowed(&[]),
            [one] => Cow::Borrowed(bytes(one)),
            many => {
                let mut all = Vec::with_capacity(r.bytes);
                many.iter().for_each(|p| all.extend_from_slice(bytes(p)));
                Cow::Owned(all)
            }
        }
    }

    /// Returns the record number within the table (3 is the first after the sub-table name) and the byte offset.
    fn locate(&self, span: &Span) -> (usize, usize) {
        let first = self.tables.get(span.table).map_or(0, |t| t.records.start);
        let offset = self
            .records
            .get(span.record)
            .and_then(|r| self.pieces.get(r.first_piece))
            .map_or(0, |p| p.offset);
        (span.record.saturating_sub(first).saturating_add(3), offset)
    }

    fn unsupported_error(&self, block: &Block, span: &Span, why: UnsupportedRows) -> Op2Error {
        let (record, offset) = self.locate(span);
        Op2Error::Unsupported {
            table: block.table.clone(),
            record,
            offset,
            why,
        }
    }
}

/// Returns a hash that identifies a record, so that a record that is written twice is read once.
fn fingerprint(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

/// Identifies the solver by the version label. MYSTRAN uses MSC's label; its sub-table records, which contain no name, identify it.
fn solver(c: &Container) -> Solver {
    let Some(label) = c.version_label.as_deref() else {
        return Solver::Unknown;
    };
    if label.starts_with("NX") || label.starts_with("MODEP") {
        Solver::Nx
    } else if label.starts_with("OS") {
        Solver::Optistruct
    } else if label.starts_with("NE ") {
        Solver::Autodesk
    } else if label.starts_with("MYSTRAN")
        || (!c.tables.is_empty() && c.tables.iter().all(|t| t.subtable.is_empty()))
    {
        Solver::Mystran
    } else if label.starts_with("XXXX") || label.starts_with('V') || label.starts_with("AERO") {
        Solver::Msc
    } else {
        Solver::Unknown
    }
}
