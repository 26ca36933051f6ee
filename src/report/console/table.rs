//! A table in aligned columns. Short rows are next to each other in blocks, so that many of them fit.

use super::content::{Console, ConsoleTable};
use super::wrap::{cut_to_width, wrap_lines};

/// Spaces between columns.
const GAP: &str = "  ";
/// Spaces between blocks of rows.
const BLOCK_GAP: &str = "    ";
/// Lines that are kept for a table, however many findings there are.
const KEPT: usize = 17;
/// Columns that a text in the last column needs to be wrapped there.
const TEXT: usize = 30;
/// Columns that a cell keeps when it is cut.
const CELL: usize = 8;

/// Returns the number of lines with which some table fits, at most [`KEPT`].
pub(super) fn least_lines(tables: &[ConsoleTable], width: usize) -> usize {
    if tables.iter().all(|t| t.rows.is_empty()) {
        return 0;
    }
    let fits = |lines: &usize| {
        let mut few = tables.iter().filter(|t| t.rows.len() <= KEPT * width);
        few.any(|t| format_whole_table(t, width, Some(*lines)).is_some())
    };
    (2..KEPT).find(fits).unwrap_or(KEPT)
}

/// Returns the lines of the first table that fits. If none fits, returns the first rows of the last table and the number of rows left out.
pub(super) fn lines(console: &Console, width: usize, limit: Option<usize>) -> Vec<String> {
    let tables = || console.tables.iter().filter(|t| !t.rows.is_empty());
    let Some(last) = tables().next_back() else {
        return Vec::new();
    };
    let laid = tables().find_map(|t| format_whole_table(t, width, limit));
    laid.unwrap_or_else(|| format_first_rows(last, console.file, width, limit))
}

/// Columns of a table: width, and whether they end at the right.
struct Columns {
    widths: Vec<usize>,
    is_number: Vec<bool>,
}

impl Columns {
    fn from_table(table: &ConsoleTable) -> Self {
        let n = table.rows.iter().map(Vec::len).max().unwrap_or(0);
        let n = n.max(table.head.len());
        let cells = |c: usize| table.rows.iter().filter_map(move |r| r.get(c));
        let width = |c: usize| {
            let all = cells(c).chain(table.head.get(c));
            all.map(|t| t.chars().count()).max().unwrap_or(0)
        };
        // The values of a list of fields differ in kind. No column is therefore aligned as numbers.
        let is_list = table.head.is_empty();
        let is_number = |c: usize| c > 0 && !is_list && cells(c).all(|t| is_number(t));
        Self {
            widths: (0..n).map(width).collect(),
            is_number: (0..n).map(is_number).collect(),
        }
    }

    fn total(&self) -> usize {
        let gaps = GAP.len() * self.widths.len().saturating_sub(1);
        self.widths.iter().sum::<usize>() + gaps
    }

    /// Returns the number of blocks of rows that fit next to each other.
    fn blocks(&self, width: usize) -> usize {
        (width + BLOCK_GAP.len()) / (self.total() + BLOCK_GAP.len())
    }

    /// A row in its columns.
    fn row(&self, cells: &[String]) -> String {
        let cell = |(c, width): (usize, &usize)| {
            let text = cells.get(c).map_or("", |t| t.as_str());
            let text = cut_to_width(text, *width);
            match self.is_number.get(c) {
                Some(true) => format!("{text:>width$}"),
                _ => format!("{text:<width$}"),
            }
        };
        let row: Vec<String> = self.widths.iter().enumerate().map(cell).collect();
        row.join(GAP)
    }
}

/// Returns whether a cell is a number, a dash or nothing.
fn is_number(text: &str) -> bool {
    let first = text.trim_start_matches(['±', '+', '-', ' ']).chars().next();
    first.is_none_or(|c| c.is_ascii_digit() || c == '∞')
}

/// Returns the lines of a table with all its rows; `None` where they do not fit.
fn format_whole_table(
    table: &ConsoleTable,
    width: usize,
    limit: Option<usize>,
) -> Option<Vec<String>> {
    let mut lines = headline(table, width);
    let head = usize::from(!table.head.is_empty());
    let columns = Columns::from_table(table);
    let n = table.rows.len();
    let room = match limit {
        None => n,
        Some(limit) => limit.checked_sub(lines.len() + head).filter(|r| *r > 0)?,
    };
    let blocks = n.div_ceil(room.max(1)).max(1);
    if blocks <= columns.blocks(width) {
        lines.extend(in_blocks(table, &columns, &table.rows, blocks));
        return Some(lines);
    }
    let text = wrapped_last(table, &columns, width)?;
    (limit.is_none() || text.len() <= room + head).then(|| {
        lines.extend(text);
        lines
    })
}

fn headline(table: &ConsoleTable, width: usize) -> Vec<String> {
    wrap_lines(&table.title, width, 2)
}

/// Returns the rows in blocks next to each other, under their heads.
fn in_blocks(
    table: &ConsoleTable,
    columns: &Columns,
    rows: &[Vec<String>],
    blocks: usize,
) -> Vec<String> {
    let height = rows.len().div_ceil(blocks);
    // Use fewer blocks if the last would be empty.
    let blocks = rows.len().div_ceil(height.max(1));
    let head = (!table.head.is_empty()).then(|| vec![columns.row(&table.head); blocks]);
    let line = |r: usize| -> Vec<String> {
        let of_block = |b: usize| rows.get(b * height + r).map(|row| columns.row(row));
        (0..blocks).filter_map(of_block).collect()
    };
    let lines = head.into_iter().chain((0..height).map(line));
    lines
        .map(|l| l.join(BLOCK_GAP).trim_end().to_owned())
        .collect()
}

/// Rows whose last column is text, which goes on under itself; `None` where there is no room for it.
fn wrapped_last(table: &ConsoleTable, columns: &Columns, width: usize) -> Option<Vec<String>> {
    let last = columns.widths.len().checked_sub(1)?;
    if columns.is_number.get(last).copied().unwrap_or(true) {
        return None;
    }
    let before = columns.total() - columns.widths.get(last)?;
    let room = width.checked_sub(before).filter(|r| *r >= TEXT)?;
    let narrow = Columns {
        widths: columns
            .widths
            .iter()
            .take(last)
            .copied()
            .chain([room])
            .collect(),
        is_number: columns.is_number.clone(),
    };
    let mut lines = Vec::new();
    for row in std::iter::once(&table.head)
        .filter(|h| !h.is_empty())
        .chain(&table.rows)
    {
        let text = row.get(last).map_or(Vec::new(), |t| wrap_lines(t, room, 0));
        for i in 0..text.len().max(1) {
            let first = |c: &String| if i == 0 { c.clone() } else { String::new() };
            let mut cells: Vec<String> = row.iter().take(last).map(first).collect();
            cells.resize(last, String::new());
            cells.push(text.get(i).cloned().unwrap_or_default());
            lines.push(narrow.row(&cells).trim_end().to_owned());
        }
    }
    Some(lines)
}

/// Formats the first rows of a table and the number of rows left out. Columns are cut to the width.
fn format_first_rows(
    table: &ConsoleTable,
    file: Option<&str>,
    width: usize,
    limit: Option<usize>,
) -> Vec<String> {
    let mut lines = headline(table, width);
    let mut columns = Columns::from_table(table);
    while columns.total() > width {
        match columns.widths.iter_mut().max_by_key(|w| **w) {
            Some(widest) if *widest > CELL => *widest -= 1,
            _ => {
                if columns.widths.pop().is_none() {
                    return lines;
                }
            }
        }
    }
    let head = usize::from(!table.head.is_empty());
    let height = limit.map_or(table.rows.len(), |l| {
        l.saturating_sub(lines.len() + head + 1).max(1)
    });
    let blocks = columns.blocks(width).max(1);
    let shown = table.rows.len().min(height * blocks);
    let rows = table.rows.get(..shown).unwrap_or_default();
    lines.extend(in_blocks(
        table,
        &columns,
        rows,
        shown.div_ceil(height.max(1)),
    ));
    let more = table.rows.len() - shown;
    if more > 0 {
        let place = file.map_or(": -v prints them".to_owned(), |f| format!(" in {f}"));
        lines.push(format!("and {more} more{place}"));
    }
    lines
}
