//! Index of result blocks: the records that contain rows, and their quantity.

use super::container::{Container, TableEntry, TableKind};
use super::ident::{IDENT_WORDS, Ident, read_ident};
use super::rows::{Layout, layout};
use super::words::{Format, Words};
use crate::results::{Analysis, Block, Damage, Note, Quantity};

/// Position of the rows of a block, and the data needed to decode them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub table: usize,
    pub record: usize,
    pub table_code: i32,
    pub random: bool,
    /// Entity of a SORT2 record that contains a single step, so that its rows can be decoded like SORT1 rows.
    pub entity: Option<u32>,
    pub layout: Option<Layout>,
}

/// Result blocks of a file, in file order.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub blocks: Vec<Block>,
    pub spans: Vec<Span>,
    /// Record of the grid point weight.
    pub weight: Option<usize>,
}

/// Lists the blocks, sets the kind of every table, and adds notes on skipped tables.
pub(super) fn index(file: &[u8], format: Format, c: &mut Container) -> Index {
    let mut out = Index::default();
    let mut tables = std::mem::take(&mut c.tables);
    for (t, table) in tables.iter_mut().enumerate() {
        if table.kind == TableKind::Matrix {
            note_once(c, &table.name, "a matrix; skipped");
            continue;
        }
        if is_geometry(&table.name) {
            table.kind = TableKind::Geometry;
            continue;
        }
        if index_table(file, format, c, &mut out, t, table) {
            table.kind = TableKind::Results;
        } else if !is_known(&table.name) {
            note_once(c, &table.name, "unknown table; skipped");
        }
    }
    c.tables = tables;
    out
}

/// Adds the blocks of one table; returns false if the table has no identification record.
fn index_table(
    file: &[u8],
    format: Format,
    c: &mut Container,
    out: &mut Index,
    t: usize,
    table: &TableEntry,
) -> bool {
    let first_block = out.blocks.len();
    let (mut found, mut stray) = (false, None);
    let mut r = table.records.start;
    while r < table.records.end {
        let Some(ident) = ident_at(file, format, c, r) else {
            stray = stray.or(Some(r));
            r = r.saturating_add(1);
            continue;
        };
        found = true;
        let rows = r.saturating_add(1);
        r = r.saturating_add(2);
        let Some(record) = (rows < table.records.end)
            .then(|| c.records.get(rows))
            .flatten()
        else {
            c.damage.push(Damage {
                at: format!("table {}, subcase {}", table.name, ident.subcase),
                what: "an identification record without rows".to_owned(),
            });
            continue;
        };
        if ident.table_code == 13 {
            out.weight = out.weight.or(Some(rows));
            continue;
        }
        let words = record.bytes / format.bytes();
        let (block, span) = describe(table, t, rows, words, ident);
        if let Some(why) = passed_over(&block, &span) {
            note_once(c, &table.name, &why);
        } else if span
            .layout
            .is_some_and(|l| !words.is_multiple_of(l.wide.max(1)))
        {
            c.damage.push(Damage {
                at: format!("table {}, subcase {}", table.name, block.subcase),
                what: format!(
                    "{words} words are not a whole number of rows of {}",
                    block.num_wide
                ),
            });
        }
        out.blocks.push(block);
        out.spans.push(span);
    }
    // In a table with readable results, rows without an identification record show damage. It is reported, so that the rows are not lost without
    // notice.
    let mut blocks = out.blocks.iter().skip(first_block);
    if let Some(r) = stray
        && blocks.any(|b| b.quantity != Quantity::Other)
    {
        let number = r.saturating_sub(table.records.start).saturating_add(3);
        c.damage.push(Damage {
            at: format!("table {}, record {number}", table.name),
            what: "no identification record precedes these rows".to_owned(),
        });
    }
    found
}

fn ident_at(file: &[u8], format: Format, c: &Container, record: usize) -> Option<Ident> {
    let record = c.records.get(record)?;
    if record.bytes != IDENT_WORDS.checked_mul(format.bytes())? {
        return None;
    }
    let piece = c.pieces.get(record.first_piece)?;
    let bytes = file.get(piece.offset..piece.offset.checked_add(piece.len)?)?;
    read_ident(Words::new(bytes, format))
}

fn describe(
    table: &TableEntry,
    t: usize,
    record: usize,
    words: usize,
    ident: Ident,
) -> (Block, Span) {
    let quantity = ident.quantity(&table.name);
    let element = ident.element_type(quantity);
    let layout = layout(quantity, element, ident.num_wide);
    let wide = usize::try_from(ident.num_wide).unwrap_or(0);
    let block = Block {
        table: table.name.clone(),
        quantity,
        analysis: ident.analysis,
        subcase: ident.subcase,
        mode: ident.mode,
        step: ident.step,
        element,
        form: ident.form(quantity),
        von_mises: ident.stress_code & 1 != 0,
        complex: ident.complex,
        sort2: ident.sort2,
        num_wide: ident.num_wide,
        entries: words.checked_div(wide).unwrap_or(0),
        titles: ident.titles,
    };
    let entity = ident
        .entity
        .filter(|_| block.sort2 && block.analysis == Analysis::Statics);
    (
        block,
        Span {
            table: t,
            record,
            table_code: ident.table_code,
            random: ident.random,
            entity,
            layout,
        },
    )
}

/// Returns why the rows of a block are not decoded; `None` if they are decoded.
fn passed_over(block: &Block, span: &Span) -> Option<String> {
    if block.complex {
        Some("complex results; listed, not decoded".to_owned())
    } else if block.sort2 && span.entity.is_none() {
        Some("SORT2 results; listed, not decoded".to_owned())
    } else if block.quantity == Quantity::Other {
        Some(format!(
            "results of table code {}; listed, not decoded",
            span.table_code
        ))
    } else if span.layout.is_none() {
        let element = block.element.map_or(0, |e| e.0);
        Some(format!(
            "rows of element type {element} with {} words; listed, not decoded",
            block.num_wide
        ))
    } else {
        None
    }
}

fn note_once(c: &mut Container, table: &str, message: &str) {
    let subject = format!("table {table}");
    if !c
        .notes
        .iter()
        .any(|n| n.subject == subject && n.message == message)
    {
        c.notes.push(Note {
            subject,
            message: message.to_owned(),
        });
    }
}

/// Returns whether a table contains bulk data, with any solver's suffix (`GEOM1S` after superelement partitioning, `GEOM1N` ..).
fn is_geometry(name: &str) -> bool {
    ["GEOM1", "GEOM2", "GEOM3", "GEOM4"]
        .iter()
        .any(|head| name.starts_with(head))
        || matches!(name, "EPT" | "EPTS" | "MPT" | "MPTS")
}

/// Returns whether a table is known and contains no results and no cards that would be lost; it is skipped without a note.
fn is_known(name: &str) -> bool {
    matches!(
        name,
        "PVT0"
            | "PVT"
            | "CASECC"
            | "CASEXX"
            | "EQEXIN"
            | "EQEXINS"
            | "GPL"
            | "GPLS"
            | "GPDT"
            | "GPDTS"
            | "BGPDT"
            | "BGPDTS"
            | "CSTM"
            | "CSTMS"
            | "DYNAMIC"
            | "DYNAMICS"
            | "DIT"
            | "DITS"
            | "EDT"
            | "EDTS"
            | "EDOM"
            | "CONTACT"
            | "VIEWTB"
            | "QUALINFO"
            | "SIL"
            | "SILS"
    )
}
